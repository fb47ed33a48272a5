//! The usual formulas of a float rasterizer of 3D Gaussians, in any kind of number.
//!
//! Covariance from the axes, T = J W, T V T^T + h I, the determinant as a c - b^2, the conic by division.
//! [`single`](super::single) has them in single precision, [`formats`](super::formats) in formats of any width.

use super::{Culled, PixelBox};
use crate::camera::Camera;
use crate::rules::Rules;
use crate::scene::Splat;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A kind of number, to which every operation rounds.
pub trait Number:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// Its value.
    fn value(self) -> f64;

    /// The square root.
    fn sqrt(self) -> Self;

    /// The smaller of two.
    fn min(self, other: Self) -> Self {
        if other.value() < self.value() {
            other
        } else {
            self
        }
    }

    /// The larger of two.
    fn max(self, other: Self) -> Self {
        if other.value() > self.value() {
            other
        } else {
            self
        }
    }
}

impl Number for f32 {
    fn value(self) -> f64 {
        self.into()
    }

    fn sqrt(self) -> f32 {
        self.sqrt()
    }
}

/// A footprint in one kind of number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlainFootprint<N> {
    /// Centre, pixels.
    pub centre: [N; 2],
    /// Centre in camera space, scene units; its z is the depth.
    pub position: [N; 3],
    /// Vxx, Vxy, Vyy, square pixels, and the determinant.
    pub variance: [N; 4],
    /// a, b, c of r = a dx^2 + 2 b dx dy + c dy^2.
    pub conic: [N; 3],
    /// Opacity at r = 0.
    pub peak: N,
}

impl<N: Number> PlainFootprint<N> {
    /// The pixels outside of which the opacity is below the smallest that the rules draw, two pixels wider for
    /// rounding.
    pub fn bounds(&self, camera: &Camera, rules: &Rules) -> PixelBox {
        let single = |number: N| number.value() as f32;
        let faint = 2.0 * (single(self.peak) / rules.alpha_min as f32).ln().max(0.0);
        let cutoff = faint.min(rules.cutoff as f32);
        let range = |centre: N, variance: N, size: usize| {
            let half = (cutoff * single(variance)).sqrt() + 2.0;
            // Casts from float to integer saturate.
            let first = (single(centre) - half).max(0.0) as usize;
            let last = (single(centre) + half).max(0.0) as usize;
            (first, last.saturating_add(1).min(size))
        };
        let (x0, x1) = range(self.centre[0], self.variance[0], camera.width);
        let (y0, y1) = range(self.centre[1], self.variance[2], camera.height);
        PixelBox { x0, y0, x1, y1 }
    }
}

/// The radial index at an offset from the centre.
pub(super) fn radial<N: Number>([a, b, c]: [N; 3], dx: N, dy: N) -> N {
    a * dx * dx + (b + b) * dx * dy + c * dy * dy
}

/// Projects one splat, whose weight is as the rules need it; `n` brings a double to the kind of number.
pub(super) fn project<N: Number>(
    splat: &Splat,
    camera: &Camera,
    rules: &Rules,
    n: impl Fn(f64) -> N,
) -> Result<PlainFootprint<N>, Culled> {
    let rotation = camera.rotation.map(|row| row.map(&n));
    let centre = splat.centre.map(&n);
    let t: [N; 3] =
        std::array::from_fn(|row| dot(rotation[row], centre) + n(camera.translation[row]));
    let z = t[2];
    if !z.value().is_finite() || z.value() <= n(camera.near).value() {
        return Err(Culled::Near);
    }
    if z.value() >= camera.far {
        return Err(Culled::Far);
    }
    let focal = [n(camera.fx), n(camera.fy)];
    let distance = if camera.orthographic { n(1.0) } else { z };
    let slope = slopes(t, camera, rules, &n);
    let gain = focal.map(|f| f / distance);
    let rows: [[N; 3]; 2] = [0, 1].map(|i| {
        std::array::from_fn(|k| gain[i] * rotation[i][k] - gain[i] * slope[i] * rotation[2][k])
    });
    let [p, q, s] = splat.axes.map(|axis| axis.map(&n));
    let covariance: [[N; 3]; 3] =
        [0, 1, 2].map(|i| [0, 1, 2].map(|j: usize| p[i] * p[j] + q[i] * q[j] + s[i] * s[j]));
    let spread = |i: usize, j: usize| dot(rows[i], covariance.map(|line| dot(line, rows[j])));
    let low_pass = n(rules.low_pass);
    let (sharp_a, b, sharp_c) = (spread(0, 0), spread(0, 1), spread(1, 1));
    let (a, c) = (sharp_a + low_pass, sharp_c + low_pass);
    let determinant = a * c - b * b;
    if !(determinant.value().is_finite() && determinant.value() > 0.0) {
        return Err(Culled::Degenerate);
    }
    let peak = if rules.normalised {
        let slant = (slope[0] * slope[0] + slope[1] * slope[1] + n(1.0)).sqrt();
        n(splat.weight) * gain[0] * gain[1] * slant
            / (n(std::f64::consts::TAU) * determinant.sqrt())
    } else if rules.compensated {
        let kept = (sharp_a * sharp_c - b * b) / determinant;
        n(splat.weight) * kept.max(n(0.0)).sqrt()
    } else {
        n(splat.weight)
    };
    if !(peak.value() > 0.0 && peak.value() >= rules.alpha_min) {
        return Err(Culled::Transparent);
    }
    Ok(PlainFootprint {
        centre: [
            focal[0] * t[0] / distance + n(camera.cx),
            focal[1] * t[1] / distance + n(camera.cy),
        ],
        position: t,
        variance: [a, b, c, determinant],
        conic: [c / determinant, -b / determinant, a / determinant],
        peak,
    })
}

/// The slopes of the Jacobian, clamped to the widened frustum if the rules say so; 0 in parallel projection.
fn slopes<N: Number>(t: [N; 3], camera: &Camera, rules: &Rules, n: impl Fn(f64) -> N) -> [N; 2] {
    let frustum = [
        (camera.width, camera.cx, camera.fx),
        (camera.height, camera.cy, camera.fy),
    ];
    [0, 1].map(|i| {
        let (size, centre, focal) = frustum[i];
        let (size, centre, focal) = (n(size as f64), n(centre), n(focal));
        let slope = t[i] / t[2];
        match (camera.orthographic, rules.clamp_jacobian) {
            (true, _) => n(0.0),
            (false, false) => slope,
            (false, true) => {
                let margin = n(0.15) * size / focal;
                let clamped = slope.min((size - centre) / focal + margin);
                clamped.max(-(centre / focal + margin))
            }
        }
    })
}

pub(super) fn dot<N: Number>(a: [N; 3], b: [N; 3]) -> N {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
