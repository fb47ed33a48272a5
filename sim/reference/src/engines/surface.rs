//! Surface splatting in double precision, from the formulas of SURF: the counterpart of the kernel's systems 2 and 9 to
//! 12.
//!
//! Screen-space basis function (SURF eq. 8), attributes filtered and divided by the weight sum (eq. 9), depth of the
//! tangent plane, accumulation by a depth threshold (section 4) or in layers (section 6, eq. 12), Phong shading per
//! pixel and coverage from the weight sum (section 7). The other way to the same ellipse, by intersecting pixel rays
//! with the tangent plane (section 4), is in the engine's tests, which hold both against each other.

use super::float::{screen_position, within_depths};
use super::{Counts, Culled, PixelBox, in_bands};
use crate::camera::Camera;
use crate::picture::Picture;
use crate::scene::points::{Material, SurfacePoint, SurfaceScene};
use crate::surface::{Buffer, Style};
use crate::vector::{self, Vector};
use rayon::prelude::*;

/// Samples of less weight belong to no surface. Seen from far away a splat at a silhouette weighs next to nothing, and
/// would join what lies in front of it with what lies behind. It is what a kernel with sums of 24 fraction bits rounds
/// to 0; the largest weight is 1.
const LEAST_WEIGHT: f64 = 1.0 / (1 << 25) as f64;

/// A surface splat on the screen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceFootprint {
    /// Centre, pixels.
    pub centre: [f64; 2],
    /// Camera-space z of the centre.
    pub depth: f64,
    /// Change of the tangent plane's depth per column and row, as the filtered kernel sees it.
    pub gradient: [f64; 2],
    /// Conic (A, B, C): r = A x^2 + 2 B x y + C y^2.
    pub conic: [f64; 3],
    /// Weight at r = 0.
    pub peak: f64,
    /// Pixels that may lie inside the cut-off.
    pub bounds: PixelBox,
    /// Unit normal in camera space.
    pub normal: Vector,
    /// Premultiplied colour.
    pub colour: [f64; 3],
    /// Opacity.
    pub opacity: f64,
    /// Row of the material table.
    pub material: u8,
}

/// The columns of M = J W S, pixels, and the depth components of W S.
pub fn screen_axes(point: &SurfacePoint, camera: &Camera) -> ([[f64; 2]; 2], [f64; 2]) {
    let [x, y, z] = camera.to_camera(point.centre);
    let turned = point
        .frame
        .map(|axis| vector::transform(&camera.rotation, axis));
    let column = |[dx, dy, dz]: Vector| {
        if camera.orthographic {
            [camera.fx * dx, camera.fy * dy]
        } else {
            [
                camera.fx * (dx / z - x * dz / (z * z)),
                camera.fy * (dy / z - y * dz / (z * z)),
            ]
        }
    };
    (turned.map(column), turned.map(|axis| axis[2]))
}

/// Projects one point.
pub fn project(
    point: &SurfacePoint,
    camera: &Camera,
    style: &Style,
) -> Result<SurfaceFootprint, Culled> {
    let position = camera.to_camera(point.centre);
    if !vector::is_finite(position) {
        return Err(Culled::NonFinite);
    }
    let centre = screen_position(within_depths(position, camera)?, camera);
    let ([m1, m2], [z1, z2]) = screen_axes(point, camera);
    let h = style.low_pass;
    let area = m1[0] * m2[1] - m1[1] * m2[0];
    let squares = |k: usize| m1[k] * m1[k] + m2[k] * m2[k];
    let [xx, yy] = [squares(0) + h, squares(1) + h];
    let xy = m1[0] * m1[1] + m2[0] * m2[1];
    let determinant = area * area + h * (squares(0) + squares(1)) + h * h;
    if !(determinant > 0.0 && determinant.is_finite()) {
        return Err(Culled::Degenerate);
    }
    let conic = [yy / determinant, -xy / determinant, xx / determinant];
    // Covariance of depth and screen position, and its regression.
    let covariance = [m1[0] * z1 + m2[0] * z2, m1[1] * z1 + m2[1] * z2];
    let gradient = [
        conic[0] * covariance[0] + conic[1] * covariance[1],
        conic[1] * covariance[0] + conic[2] * covariance[1],
    ];
    let peak = point.weight * area.abs() / determinant.sqrt();
    if peak <= 0.0 {
        return Err(Culled::Transparent);
    }
    let half = [xx, yy].map(|spread| (style.cutoff * spread).sqrt());
    let bounds = PixelBox::around(centre, half, camera);
    if bounds.is_empty() {
        return Err(Culled::OutsideViewport);
    }
    let (normal, back) = facing_normal(point, position, camera);
    if back && style.cull_backfaces {
        return Err(Culled::Backface);
    }
    Ok(SurfaceFootprint {
        centre,
        depth: position[2],
        gradient,
        conic,
        peak,
        bounds,
        normal,
        colour: point.colour.map(|c| c * point.opacity),
        opacity: point.opacity,
        material: point.material,
    })
}

/// The normal in camera space, turned towards the eye, and whether it had pointed away.
fn facing_normal(point: &SurfacePoint, position: Vector, camera: &Camera) -> (Vector, bool) {
    let normal = vector::transform(&camera.rotation, point.normal);
    let away = vector::dot(normal, camera.ray(position)) > 0.0;
    (vector::scale(if away { -1.0 } else { 1.0 }, normal), away)
}

/// Weighted sums of one surface at one pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FloatFragment {
    /// Sum of the weights.
    pub weight: f64,
    /// Weighted premultiplied colour.
    pub colour: [f64; 3],
    /// Weighted opacity.
    pub opacity: f64,
    /// Weighted normal.
    pub normal: Vector,
    /// Least and greatest depth.
    pub range: [f64; 2],
    /// Material of the nearest sample.
    pub material: u8,
}

impl FloatFragment {
    fn of(weight: f64, depth: f64, splat: &SurfaceFootprint) -> FloatFragment {
        FloatFragment {
            weight,
            colour: splat.colour.map(|c| weight * c),
            opacity: weight * splat.opacity,
            normal: vector::scale(weight, splat.normal),
            range: [depth, depth],
            material: splat.material,
        }
    }

    fn sum(&self, other: &FloatFragment) -> FloatFragment {
        let nearer = if self.range[0] <= other.range[0] {
            self
        } else {
            other
        };
        FloatFragment {
            weight: self.weight + other.weight,
            colour: vector::add(self.colour, other.colour),
            opacity: self.opacity + other.opacity,
            normal: vector::add(self.normal, other.normal),
            range: self.both_ranges(other),
            material: nearer.material,
        }
    }

    fn both_ranges(&self, other: &FloatFragment) -> [f64; 2] {
        let ([near, far], [first, last]) = (self.range, other.range);
        [near.min(first), far.max(last)]
    }

    /// SURF eq. 12 in premultiplied form, `self` in front.
    fn over(&self, back: &FloatFragment) -> FloatFragment {
        let weight = self.weight.max(back.weight);
        let (front_alpha, back_alpha) = (self.opacity / self.weight, back.opacity / back.weight);
        let blend = |front: f64, behind: f64| {
            weight * (front / self.weight + (1.0 - front_alpha) * behind / back.weight)
        };
        let turn = |front: f64, behind: f64| {
            weight
                * (front_alpha * front / self.weight
                    + (1.0 - front_alpha) * back_alpha * behind / back.weight)
        };
        FloatFragment {
            weight,
            colour: [0, 1, 2].map(|c: usize| blend(self.colour[c], back.colour[c])),
            opacity: blend(self.opacity, back.opacity),
            normal: [0, 1, 2].map(|c: usize| turn(self.normal[c], back.normal[c])),
            range: self.both_ranges(back),
            material: self.material,
        }
    }
}

/// What a pixel has gathered, nearest first.
pub type FragmentList = Vec<FloatFragment>;

/// Accumulate, replace or discard (SURF 4).
fn accumulate(pixel: &mut FragmentList, sample: FloatFragment, threshold: f64) {
    let Some(kept) = pixel.first_mut() else {
        pixel.push(sample);
        return;
    };
    match sample.range[0] - kept.range[0] {
        behind if behind > threshold => {}
        behind if behind < -threshold => *kept = sample,
        _ => *kept = kept.sum(&sample),
    }
}

/// Accumulate or separate, insert, merge the nearest pair (SURF 6).
fn layer(pixel: &mut FragmentList, sample: FloatFragment, threshold: f64, count: usize) {
    let gap = |a: &FloatFragment, b: &FloatFragment| {
        (b.range[0] - a.range[1]).max(a.range[0] - b.range[1])
    };
    // A sample may bridge fragments that were apart: everything within reach becomes one.
    let mut grown = sample;
    while let Some(index) = pixel.iter().position(|kept| gap(kept, &grown) <= threshold) {
        grown = pixel.remove(index).sum(&grown);
    }
    let place = pixel.partition_point(|kept| kept.range[0] <= grown.range[0]);
    pixel.insert(place, grown);
    if pixel.len() > count {
        let gaps = pixel.windows(2).map(|pair| gap(&pair[0], &pair[1]));
        let nearest = gaps
            .enumerate()
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .map_or(0, |(index, _)| index);
        let back = pixel.remove(nearest + 1);
        pixel[nearest] = pixel[nearest].over(&back);
    }
}

/// A picture with what it was resolved from.
#[derive(Clone, Debug)]
pub struct FloatSurfaceDrawing {
    /// The picture.
    pub picture: Picture,
    /// What became of the points.
    pub counts: Counts,
    /// Fragments of every pixel, row-major.
    pub fragments: Vec<FragmentList>,
}

/// Draws the scene in its own order.
pub fn draw(scene: &SurfaceScene, camera: &Camera, style: &Style) -> FloatSurfaceDrawing {
    let projected: Vec<Result<SurfaceFootprint, Culled>> = scene
        .points
        .par_iter()
        .map(|point| project(point, camera, style))
        .collect();
    let mut counts = Counts::of_projected(&projected);
    let footprints: Vec<&SurfaceFootprint> = projected.iter().flatten().collect();
    let mut fragments = vec![FragmentList::new(); camera.width * camera.height];
    counts.covered_pixels = in_bands(&mut fragments, camera.width, |rows, pixels| {
        let touches = |f: &&&SurfaceFootprint| !f.bounds.intersection(&rows).is_empty();
        let visible = footprints.iter().filter(touches);
        visible.map(|f| gather(f, pixels, rows, style)).sum()
    });
    let mut picture = Picture::new(camera.width, camera.height);
    let outputs = picture.pixels.par_iter_mut().zip(&fragments).enumerate();
    outputs.for_each(|(index, (out, pixel))| {
        let place = [
            (index % camera.width) as f64 + 0.5,
            (index / camera.width) as f64 + 0.5,
        ];
        *out = resolve(pixel, place, camera, scene, style);
    });
    FloatSurfaceDrawing {
        picture,
        counts,
        fragments,
    }
}

/// Gathers one splat into a band of rows; returns the pixels inside its cut-off.
fn gather(
    splat: &SurfaceFootprint,
    pixels: &mut [FragmentList],
    rows: PixelBox,
    style: &Style,
) -> u64 {
    let mut covered = 0;
    let [a, b, c] = splat.conic;
    let inside = splat.bounds.intersection(&rows);
    for y in inside.y0..inside.y1 {
        for x in inside.x0..inside.x1 {
            let dx = x as f64 + 0.5 - splat.centre[0];
            let dy = y as f64 + 0.5 - splat.centre[1];
            let r = a * dx * dx + 2.0 * b * dx * dy + c * dy * dy;
            if r >= style.cutoff || r.is_nan() {
                continue;
            }
            covered += 1;
            let weight = splat.peak * (-0.5 * r).exp();
            if weight < LEAST_WEIGHT {
                continue;
            }
            let depth = splat.depth + splat.gradient[0] * dx + splat.gradient[1] * dy;
            let sample = FloatFragment::of(weight, depth, splat);
            let pixel = &mut pixels[(y - rows.y0) * rows.x1 + x];
            match style.buffer {
                Buffer::Accumulation => accumulate(pixel, sample, style.threshold),
                Buffer::Layers(count) => layer(pixel, sample, style.threshold, count),
            }
        }
    }
    covered
}

/// Divides, shades, covers and composites a pixel's fragments.
fn resolve(
    pixel: &FragmentList,
    place: [f64; 2],
    camera: &Camera,
    scene: &SurfaceScene,
    style: &Style,
) -> [f64; 4] {
    let mut colour = [0.0; 3];
    let mut transmittance = 1.0;
    for fragment in pixel {
        let divided = fragment.colour.map(|c| c / fragment.weight);
        let opacity = fragment.opacity / fragment.weight;
        let shaded = match style.light {
            Some(light) => {
                let material = scene.materials.get(usize::from(fragment.material));
                let view = towards_eye(place, camera);
                let light = unit(vector::transform(&camera.rotation, light));
                phong(
                    material,
                    divided,
                    opacity,
                    unit(fragment.normal),
                    light,
                    view,
                )
            }
            None => divided,
        };
        let coverage = style
            .edge
            .map_or(1.0, |tau| (fragment.weight / tau).min(1.0));
        let visible = transmittance * coverage;
        colour = vector::add(colour, vector::scale(visible, shaded));
        transmittance -= visible * opacity;
    }
    let [r, g, b] = colour;
    [r, g, b, 1.0 - transmittance]
}

fn towards_eye(place: [f64; 2], camera: &Camera) -> Vector {
    let [x, y] = camera.slopes(place);
    unit(vector::scale(-1.0, camera.ray([x, y, 1.0])))
}

/// Phong: I = (ka + kd max(0, n.l)) c + ks max(0, r.v)^s a.
fn phong(
    material: Option<&Material>,
    colour: [f64; 3],
    opacity: f64,
    normal: Vector,
    light: Vector,
    view: Vector,
) -> [f64; 3] {
    let Some(material) = material else {
        return colour;
    };
    let diffuse = vector::dot(normal, light).max(0.0);
    let reflected = vector::subtract(vector::scale(2.0 * diffuse, normal), light);
    let highlight = if diffuse > 0.0 {
        vector::dot(reflected, view)
            .max(0.0)
            .powi(material.exponent.into())
    } else {
        0.0
    };
    colour.map(|c| {
        (material.ambient + material.diffuse * diffuse) * c
            + material.specular * highlight * opacity
    })
}

fn unit(a: Vector) -> Vector {
    let length = vector::length(a);
    if length > 0.0 {
        vector::scale(1.0 / length, a)
    } else {
        a
    }
}
