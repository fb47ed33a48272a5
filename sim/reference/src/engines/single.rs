//! The usual formulas in single precision: what a float rasterizer of 3D Gaussians computes.
//!
//! [`plain`] with r from the conic per pixel and exp of the mathematical library: the yardstick of the stability
//! tables.

use super::plain::{self, PlainFootprint};
use super::{PixelBox, in_bands};
use crate::camera::Camera;
use crate::picture::Picture;
use crate::rules::Rules;
use crate::scene::Splat;

/// A footprint in single precision.
pub type SingleFootprint = PlainFootprint<f32>;

impl SingleFootprint {
    /// The radial index at a point.
    pub fn radial(&self, x: f32, y: f32) -> f32 {
        plain::radial(self.conic, x - self.centre[0], y - self.centre[1])
    }

    /// Opacity at a point, clamped and cut off by the rules.
    pub fn opacity(&self, x: f32, y: f32, rules: &Rules) -> f32 {
        let r = self.radial(x, y);
        // Rasterizers of this kind skip pixels whose r came out negative.
        if !(0.0..rules.cutoff as f32).contains(&r) {
            return 0.0;
        }
        let alpha = (self.peak * (-0.5 * r).exp()).min(rules.alpha_max as f32);
        if alpha < rules.alpha_min as f32 {
            0.0
        } else {
            alpha
        }
    }
}

/// Projects one splat, whose weight is as the rules need it; `None` if it is culled by depth, its determinant is not
/// positive, or it is transparent.
pub fn project(splat: &Splat, camera: &Camera, rules: &Rules) -> Option<SingleFootprint> {
    plain::project(splat, camera, rules, |x| x as f32).ok()
}

/// The picture of projected splats, drawn front to back in the order given.
pub fn picture(
    projected: &[Option<SingleFootprint>],
    colours: &[[f64; 3]],
    order: &[usize],
    camera: &Camera,
    rules: &Rules,
) -> Picture {
    let splats: Vec<(SingleFootprint, PixelBox, [f32; 3])> = order
        .iter()
        .filter_map(|&index| {
            let footprint = projected[index]?;
            let colour = colours[index].map(|channel| channel as f32);
            Some((footprint, footprint.bounds(camera, rules), colour))
        })
        .collect();
    let mut picture = Picture::new(camera.width, camera.height);
    in_bands(&mut picture.pixels, camera.width, |rows, pixels| {
        // Premultiplied colour and the light that is left; negative once the pixel is finished.
        let mut gathered = vec![[0.0f32, 0.0, 0.0, 1.0]; pixels.len()];
        for (footprint, bounds, colour) in &splats {
            let inside = bounds.intersection(&rows);
            for y in inside.y0..inside.y1 {
                let row = (y - rows.y0) * camera.width;
                for x in inside.x0..inside.x1 {
                    let at = [x as f32 + 0.5, y as f32 + 0.5];
                    let alpha = footprint.opacity(at[0], at[1], rules);
                    blend(&mut gathered[row + x], alpha, colour, rules);
                }
            }
        }
        for (pixel, [r, g, b, clear]) in pixels.iter_mut().zip(gathered) {
            *pixel = [r, g, b, 1.0 - clear.abs()].map(f64::from);
        }
        0
    });
    picture
}

/// "Over" in single precision; the sign of the light that is left says that the pixel takes no more.
fn blend(pixel: &mut [f32; 4], alpha: f32, colour: &[f32; 3], rules: &Rules) {
    let clear = pixel[3];
    if alpha <= 0.0 || clear < 0.0 {
        return;
    }
    let rest = clear * (1.0 - alpha);
    let finished = rest <= rules.minimum_transmittance as f32;
    if finished && rules.omit_finishing {
        pixel[3] = -clear;
        return;
    }
    for (sum, channel) in pixel.iter_mut().zip(colour) {
        *sum += clear * alpha * channel;
    }
    pixel[3] = if finished { -rest } else { rest };
}
