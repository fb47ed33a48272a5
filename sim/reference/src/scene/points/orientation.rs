//! Are a cloud's normals those of a closed surface, all pointing out of it?
//!
//! Only then may points that face away be left out: on a cloud whose normals point anyhow, half of the front would go
//! with them, and an open sheet would vanish when seen from behind. Two figures decide, both measured on a sample:
//!
//! - **agreement**: of the pairs of a point and its nearest neighbours, the share whose normals point to the same side,
//!   n . n' > 0. Normals with random signs have 1/2.
//! - **outward**: the flux of the places through the surface, sum (p - c) . n / sum |p - c| with c the middle of the
//!   cloud. A sphere has 1, one with normals pointing inwards -1, a flat sheet 0. By Gauss' theorem it is three volumes
//!   over the mean distance and area, so it is positive for every closed surface with normals outwards, convex or not.

use super::SurfacePoint;
use super::neighbours::Neighbours;
use crate::vector::{self, Vector};

/// Least agreement of a cloud with consistent normals.
const LEAST_AGREEMENT: f64 = 0.95;
/// Least outward flux of a closed surface.
const LEAST_OUTWARD: f64 = 0.2;
/// Neighbours that a point is compared with.
const NEIGHBOURS: usize = 4;
/// Points that are looked at; their neighbours are searched among all.
const SAMPLE: usize = 4_000;

/// Share of the points that lie in the flat base of a figure, at least; no other side may have half as many.
const LEAST_BASE: f64 = 0.02;
/// Share of the height that a base is thick.
const BASE_HEIGHT: f64 = 0.03;
/// Share of the points beyond the ends of the height: strays.
const STRAYS: f64 = 0.002;
/// Cosine of the angle to the vertical of a base's normals.
const DOWNWARDS: f64 = 0.9;

/// Up of a cloud: +z, as scanners have it, unless it is a body that stands on a flat base on another side, as scanned
/// figures do.
pub fn up(points: &[SurfacePoint]) -> Vector {
    const USUAL: Vector = [0.0, 0.0, 1.0];
    if outward(points) < LEAST_OUTWARD {
        return USUAL;
    }
    let mut sides = Vec::with_capacity(6);
    for axis in 0..3 {
        let mut along: Vec<f64> = points.iter().map(|point| point.centre[axis]).collect();
        along.sort_by(f64::total_cmp);
        let stray = (along.len() as f64 * STRAYS) as usize;
        let (Some(low), Some(high)) = (along.get(stray), along.iter().rev().nth(stray)) else {
            continue;
        };
        let thick = BASE_HEIGHT * (high - low);
        for (sign, end) in [(1.0, *low), (-1.0, -*high)] {
            let is_base = |point: &&SurfacePoint| {
                sign * point.centre[axis] < end + thick && sign * point.normal[axis] < -DOWNWARDS
            };
            let base = points.iter().filter(is_base).count();
            let mut side = [0.0; 3];
            side[axis] = sign;
            sides.push((base as f64 / points.len() as f64, side));
        }
    }
    sides.sort_by(|a, b| b.0.total_cmp(&a.0));
    match sides[..] {
        [(most, side), (second, _), ..] if most > LEAST_BASE && most > 2.0 * second => side,
        _ => USUAL,
    }
}

/// Flux of the places outwards, -1 to 1.
fn outward(points: &[SurfacePoint]) -> f64 {
    let mut sum = [0.0; 3];
    for point in points {
        sum = vector::add(sum, point.centre);
    }
    let middle = vector::scale(1.0 / points.len().max(1) as f64, sum);
    let (mut flux, mut most) = (0.0, 0.0);
    for point in points {
        let from = vector::subtract(point.centre, middle);
        // The area that the point stands for.
        let [a, b] = point.frame;
        let area = vector::length(vector::cross(a, b));
        let normal = vector::length(point.normal).max(f64::MIN_POSITIVE);
        flux += area * vector::dot(from, point.normal) / normal;
        most += area * vector::length(from);
    }
    share(flux, most)
}

fn share(part: f64, whole: f64) -> f64 {
    if whole > 0.0 { part / whole } else { 0.0 }
}

/// Share of neighbouring pairs whose normals point to the same side.
fn agreement(points: &[SurfacePoint]) -> f64 {
    let places: Vec<Vector> = points.iter().map(|point| point.centre).collect();
    let tree = Neighbours::new(&places);
    let every = points.len().div_ceil(SAMPLE).max(1);
    let (mut pairs, mut agreeing) = (0usize, 0usize);
    for index in (0..points.len()).step_by(every) {
        for other in tree.nearest(index, NEIGHBOURS) {
            pairs += 1;
            let cosine = vector::dot(points[index].normal, points[other].normal);
            agreeing += usize::from(cosine > 0.0);
        }
    }
    share(agreeing as f64, pairs as f64)
}

/// A closed surface with normals outwards, as far as these figures can tell.
pub fn is_closed_outwards(points: &[SurfacePoint]) -> bool {
    outward(points) >= LEAST_OUTWARD && agreement(points) >= LEAST_AGREEMENT
}

#[cfg(test)]
mod tests {
    use super::super::synthetic::{Paint, sheet, sphere};
    use super::*;

    const PAINT: Paint = Paint {
        colour: [0.5; 3],
        opacity: 1.0,
        material: 0,
    };

    fn ball(turned: impl Fn(usize) -> bool) -> Vec<SurfacePoint> {
        let mut points = sphere([5.0, -3.0, 2.0], 1.5, 3_000, PAINT);
        for (index, point) in points.iter_mut().enumerate() {
            // Outwards whatever the generator does, then turned.
            let out = vector::subtract(point.centre, [5.0, -3.0, 2.0]);
            let sign = if turned(index) { -1.0 } else { 1.0 };
            point.normal = vector::scale(sign / vector::length(out), out);
        }
        points
    }

    fn ground() -> Vec<SurfacePoint> {
        let axes = [[1.0, 0.0, 0.2], [0.0, 1.0, 0.1]];
        sheet([0.0; 3], axes, 0.05, |_, _| PAINT)
    }

    #[test]
    fn a_ball_is_closed_outwards() {
        let points = ball(|_| false);
        assert!(agreement(&points) > 0.999 && outward(&points) > 0.99);
        assert!(is_closed_outwards(&points));
    }

    #[test]
    fn a_body_stands_on_its_flat_base_and_nothing_else_does() {
        let whole = sphere([5.0, -3.0, 2.0], 1.5, 3_000, PAINT);
        assert_eq!(up(&whole), [0.0, 0.0, 1.0]);
        for (axis, sign) in [(0, 1.0), (1, 1.0), (1, -1.0), (2, -1.0)] {
            let mut side = [0.0; 3];
            side[axis] = sign;
            let mut cut = whole.clone();
            let middle: Vector = [5.0, -3.0, 2.0];
            for point in &mut cut {
                if sign * (point.centre[axis] - middle[axis]) < -0.9 {
                    point.centre[axis] = middle[axis] - 0.9 * sign;
                    point.normal = vector::scale(-1.0, side);
                }
            }
            assert_eq!(up(&cut), side);
        }
        assert_eq!(up(&ground()), [0.0, 0.0, 1.0]);
    }

    #[test]
    fn normals_inwards_or_anyhow_are_not() {
        let inwards = ball(|_| true);
        assert!(outward(&inwards) < -0.99 && !is_closed_outwards(&inwards));
        // A ratio near the golden one would follow the spiral on which the points lie.
        let coin = |index: usize| {
            let mixed = (index as u64 + 1).wrapping_mul(0xff51_afd7_ed55_8ccd);
            let mixed = (mixed ^ mixed >> 33).wrapping_mul(0xc4ce_b9fe_1a85_ec53);
            mixed >> 40 & 1 == 0
        };
        let anyhow = ball(coin);
        assert!((agreement(&anyhow) - 0.5).abs() < 0.1);
        assert!(!is_closed_outwards(&anyhow));
        assert!(!is_closed_outwards(&ball(|index| index % 20 == 0)));
    }

    #[test]
    fn an_open_sheet_is_not() {
        assert!(agreement(&ground()) > 0.99);
        assert!(!is_closed_outwards(&ground()));
    }
}
