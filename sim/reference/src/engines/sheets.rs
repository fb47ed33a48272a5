//! Sheet buffers in double precision (\[EWA\] 4.1, \[SWAN\] 3): splats of a slab are added, sheets are composited.
//!
//! With the sums A_s = min(1, sum alpha) and C_s = sum alpha c of sheet s, nearest first: C = sum_s C_s prod_(i<s) (1 -
//! A_i).

use super::compositor::{ScreenSplat, for_each_pixel, opacity};
use super::float::{self, Footprint};
use super::{Counts, FloatDrawing, PixelBox, in_bands};
use crate::camera::Camera;
use crate::picture::Picture;
use crate::rules::{Kernel, Rules};
use crate::scene::{Scene, Splat};
use crate::sheets::{SheetKind, SheetPlan};
use crate::vector;

/// Standard deviations of depth beyond which a kernel is not cut any more.
const REACH: f64 = 3.0;

/// A splat's part in a sheet.
struct Part<'a> {
    slab: i64,
    /// Of the opacity.
    share: f64,
    footprint: &'a Footprint,
}

impl Part<'_> {
    /// Its opacity at a point. A Gaussian's parts end where the whole one does: by its cut-off, for which a thin slab's
    /// part is not too faint.
    fn opacity(&self, point: [f64; 2], rules: &Rules) -> Option<f64> {
        let peak = self.footprint.peak * self.share;
        let part = Footprint {
            peak,
            ..*self.footprint
        };
        if rules.kernel != Kernel::Gaussian {
            return opacity(&part, point, rules);
        }
        opacity(self.footprint, point, rules)?;
        let (radial_index, peak) = part.radial_index_and_peak(point);
        Some(rules.alpha_max.min(peak * rules.kernel.at(radial_index)))
    }
}

/// Draws the scene sheet by sheet, nearest first.
pub fn draw(scene: &Scene, camera: &Camera, rules: &Rules, plan: &SheetPlan) -> FloatDrawing {
    let footprints = float::footprints(scene, camera, rules);
    let mut drawn: Vec<Part> = Vec::new();
    for (splat, footprint) in scene.splats.iter().zip(&footprints) {
        if let Ok(footprint) = footprint {
            let parts = parts_of(splat, camera, plan).into_iter();
            drawn.extend(parts.map(|(slab, share)| Part {
                slab,
                share,
                footprint,
            }));
        }
    }
    // Stable: the splats of a sheet stay in the scene's order.
    drawn.sort_by_key(|part| part.slab);
    let mut picture = Picture::new(camera.width, camera.height);
    in_bands(&mut picture.pixels, camera.width, |band, pixels| {
        draw_band(&drawn, band, pixels, rules);
        0
    });
    let counts = Counts::of_projected(&footprints);
    FloatDrawing { picture, counts }
}

/// The sheets that a splat takes part in, by their numbers, which grow away from the eye, and the share of its opacity
/// in each.
fn parts_of(splat: &Splat, camera: &Camera, plan: &SheetPlan) -> Vec<(i64, f64)> {
    let depth = (camera.to_camera(splat.centre)[2] - plan.first) / plan.thickness;
    let slab = |place: f64| place.max(0.0).floor() as i64;
    match plan.kind {
        SheetKind::AxisAligned => vec![(axis_slab(splat, plan), 1.0)],
        SheetKind::ImageAligned => vec![(slab(depth), 1.0)],
        SheetKind::ImageAlignedCut => {
            let along = |axis: &[f64; 3]| vector::dot(camera.rotation[2], *axis).powi(2);
            let spread = splat.axes.iter().map(along).sum::<f64>().sqrt() / plan.thickness;
            let (first, last) = (slab(depth - REACH * spread), slab(depth + REACH * spread));
            let below = |edge: i64| match edge {
                edge if edge <= first => 0.0,
                edge if edge > last => 1.0,
                edge => normal_integral((edge as f64 - depth) / spread),
            };
            let shares = (first..=last).map(|s| (s, below(s + 1) - below(s)));
            shares.collect()
        }
    }
}

fn axis_slab(splat: &Splat, plan: &SheetPlan) -> i64 {
    let mut axis = 0;
    for other in 1..3 {
        if plan.direction[other].abs() > plan.direction[axis].abs() {
            axis = other;
        }
    }
    let slab = ((splat.centre[axis] - plan.first) / plan.thickness).floor() as i64;
    if plan.direction[axis] >= 0.0 {
        slab
    } else {
        -slab
    }
}

/// Integral of the normal distribution up to `t`.
fn normal_integral(t: f64) -> f64 {
    0.5 * (1.0 + libm::erf(t / std::f64::consts::SQRT_2))
}

/// Sums and composites one band of rows.
fn draw_band(parts: &[Part], band: PixelBox, pixels: &mut [[f64; 4]], rules: &Rules) {
    // [r, g, b, transmittance] until the last sheet.
    pixels.fill([0.0, 0.0, 0.0, 1.0]);
    let mut sheet = vec![[0.0; 4]; pixels.len()];
    let mut finished = vec![false; pixels.len()];
    for of_slab in parts.chunk_by(|a, b| a.slab == b.slab) {
        let mut touched = false;
        for part in of_slab {
            for_each_pixel(part.footprint, band, |x, y, centre| {
                touched = true;
                if let Some(opacity) = part.opacity(centre, rules) {
                    let sums = &mut sheet[(y - band.y0) * band.x1 + x];
                    for (sum, colour) in sums.iter_mut().zip(part.footprint.colour) {
                        *sum += opacity * colour;
                    }
                    sums[3] += opacity;
                }
            });
        }
        if touched {
            for ((pixel, sums), finished) in pixels.iter_mut().zip(&mut sheet).zip(&mut finished) {
                let sums = std::mem::take(sums);
                *finished = *finished || lay_behind(pixel, sums, rules);
            }
        }
    }
    for pixel in pixels {
        pixel[3] = 1.0 - pixel[3];
    }
}

/// Lays a sheet behind a pixel, and tells whether that finishes it.
fn lay_behind(pixel: &mut [f64; 4], sheet: [f64; 4], rules: &Rules) -> bool {
    let rest = pixel[3] * (1.0 - sheet[3].min(1.0));
    let finishes = rest <= rules.minimum_transmittance;
    if finishes && rules.omit_finishing {
        return true;
    }
    for channel in 0..3 {
        pixel[channel] += pixel[3] * sheet[channel];
    }
    pixel[3] = rest;
    finishes
}
