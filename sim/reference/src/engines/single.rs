//! The usual formulas in single precision: what a float rasterizer of 3D Gaussians computes.
//!
//! Covariance from the axes, T = J W, T V T^T + h I, the determinant as a c - b^2, the conic by division, r from the
//! conic per pixel, exp of the mathematical library. It is the yardstick of the stability tables, written for that alone.

use crate::camera::Camera;
use crate::engines::PixelBox;
use crate::picture::Picture;
use crate::rules::Rules;
use crate::scene::Splat;
use rayon::prelude::*;

/// Rows that one task draws.
const BAND: usize = 16;

/// A footprint in single precision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SingleFootprint {
    /// Centre, pixels.
    pub centre: [f32; 2],
    /// Depth, scene units.
    pub depth: f32,
    /// Vxx, Vxy, Vyy, square pixels, and the determinant.
    pub variance: [f32; 4],
    /// a, b, c of r = a dx^2 + 2 b dx dy + c dy^2.
    pub conic: [f32; 3],
    /// Opacity at r = 0.
    pub peak: f32,
}

impl SingleFootprint {
    /// The radial index at a point.
    pub fn radial(&self, x: f32, y: f32) -> f32 {
        let [a, b, c] = self.conic;
        let [dx, dy] = [x - self.centre[0], y - self.centre[1]];
        a * dx * dx + 2.0 * b * dx * dy + c * dy * dy
    }

    /// The pixels outside of which the opacity is below the smallest that the rules draw, two pixels wider for rounding.
    pub fn bounds(&self, camera: &Camera, rules: &Rules) -> PixelBox {
        let faint = 2.0 * (self.peak / rules.alpha_min as f32).ln().max(0.0);
        let cutoff = faint.min(rules.cutoff as f32);
        let range = |axis: usize, variance: f32, size: usize| {
            let half = (cutoff * variance).sqrt() + 2.0;
            // Casts from float to integer saturate.
            let first = (self.centre[axis] - half).max(0.0) as usize;
            let last = (self.centre[axis] + half).max(0.0) as usize;
            (first, last.saturating_add(1).min(size))
        };
        let (x0, x1) = range(0, self.variance[0], camera.width);
        let (y0, y1) = range(1, self.variance[2], camera.height);
        PixelBox { x0, y0, x1, y1 }
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

/// Projects one splat; `None` if it is culled by depth, its determinant is not positive, or it is transparent.
pub fn project(
    splat: &Splat,
    weight: f64,
    camera: &Camera,
    rules: &Rules,
) -> Option<SingleFootprint> {
    let single = |v: [f64; 3]| v.map(|x| x as f32);
    let rotation = camera.rotation.map(single);
    let centre = single(splat.centre);
    let t: [f32; 3] =
        std::array::from_fn(|row| dot(rotation[row], centre) + camera.translation[row] as f32);
    let z = t[2];
    if z <= camera.near as f32 || z >= camera.far as f32 {
        return None;
    }
    let focal = [camera.fx as f32, camera.fy as f32];
    let distance = if camera.orthographic { 1.0 } else { z };
    let slope = slopes(t, camera, rules);
    let gain = focal.map(|f| f / distance);
    let rows: [[f32; 3]; 2] = [0, 1].map(|i| {
        std::array::from_fn(|k| gain[i] * rotation[i][k] - gain[i] * slope[i] * rotation[2][k])
    });
    let variance = covariance(splat);
    let spread = |i: usize, j: usize| dot(rows[i], variance.map(|line| dot(line, rows[j])));
    let low_pass = rules.low_pass as f32;
    let (sharp_a, b, sharp_c) = (spread(0, 0), spread(0, 1), spread(1, 1));
    let (a, c) = (sharp_a + low_pass, sharp_c + low_pass);
    let determinant = a * c - b * b;
    if determinant.is_nan() || determinant <= 0.0 {
        return None;
    }
    let peak = if rules.normalised {
        let slant = (slope[0] * slope[0] + slope[1] * slope[1] + 1.0).sqrt();
        weight as f32 * gain[0] * gain[1] * slant / (std::f32::consts::TAU * determinant.sqrt())
    } else if rules.compensated {
        let kept = (sharp_a * sharp_c - b * b) / determinant;
        weight as f32 * kept.max(0.0).sqrt()
    } else {
        weight as f32
    };
    if peak <= 0.0 || peak < rules.alpha_min as f32 {
        return None;
    }
    Some(SingleFootprint {
        centre: [
            focal[0] * t[0] / distance + camera.cx as f32,
            focal[1] * t[1] / distance + camera.cy as f32,
        ],
        depth: z,
        variance: [a, b, c, determinant],
        conic: [c / determinant, -b / determinant, a / determinant],
        peak,
    })
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
    let bands = picture.pixels.par_chunks_mut(camera.width * BAND);
    bands.enumerate().for_each(|(band, pixels)| {
        let rows = PixelBox {
            x0: 0,
            y0: band * BAND,
            x1: camera.width,
            y1: band * BAND + pixels.len() / camera.width,
        };
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

fn slopes(t: [f32; 3], camera: &Camera, rules: &Rules) -> [f32; 2] {
    let frustum = [
        (camera.width, camera.cx, camera.fx),
        (camera.height, camera.cy, camera.fy),
    ];
    [0, 1].map(|i| {
        let (size, centre, focal) = frustum[i];
        let (size, centre, focal) = (size as f32, centre as f32, focal as f32);
        let slope = t[i] / t[2];
        match (camera.orthographic, rules.clamp_jacobian) {
            (true, _) => 0.0,
            (false, false) => slope,
            (false, true) => {
                let margin = 0.15 * size / focal;
                slope
                    .min((size - centre) / focal + margin)
                    .max(-(centre / focal + margin))
            }
        }
    })
}

fn covariance(splat: &Splat) -> [[f32; 3]; 3] {
    let axes = splat.axes.map(|axis| axis.map(|x| x as f32));
    std::array::from_fn(|i| std::array::from_fn(|j| axes.iter().map(|a| a[i] * a[j]).sum()))
}

fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
