//! The usual setup in single precision: covariance, Jacobian, low-pass filter, conic (\[EWA\] 6.2, 7.1).
//!
//! Covariances are made from scales and rotations when the scene is loaded, as rasterizers allow that keep them; everything that depends
//! on the camera is computed for every picture.

use rayon::prelude::*;
use splatline::raster::Window;
use splatline_sim::camera::Camera;
use splatline_sim::rules::Rules;
use splatline_sim::scene::Scene;

/// A splat as a rasterizer loads it.
#[derive(Clone, Copy, Debug)]
pub struct BaselineSplat {
    centre: [f32; 3],
    /// xx, xy, xz, yy, yz, zz.
    covariance: [f32; 6],
    weight: f32,
    colour: [f32; 3],
}

/// Rules, camera and splats in single precision.
#[derive(Clone, Debug)]
pub struct FloatScene {
    splats: Vec<BaselineSplat>,
    rotation: [[f32; 3]; 3],
    translation: [f32; 3],
    focal: [f32; 2],
    principal: [f32; 2],
    near: f32,
    far: f32,
    /// Smallest and largest x/z and y/z that the Jacobian takes, under rules that clamp.
    slopes: [[f32; 2]; 2],
    normalised: bool,
    low_pass: f32,
    /// The footprint is r < cutoff; infinite where only the opacity ends it.
    pub cutoff: f32,
    /// Columns and rows.
    pub viewport: [u16; 2],
    /// Opacities are clamped to this.
    pub alpha_max: f32,
    /// Smaller opacities are skipped.
    pub alpha_min: f32,
    /// A pixel is finished at this transmittance.
    pub stop: f32,
    /// The splat that would finish a pixel is left out.
    pub omit_finishing: bool,
}

/// How far a splat's bounding box reaches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BoxExtent {
    /// The square of three sigmas of the longer axis (or of the rules' cut-off, where that is nearer), rounded up: the reference
    /// implementation of 3D Gaussian splatting and most that follow it.
    Sigmas,
    /// Horizontally and vertically as far as the opacity is large enough to be drawn.
    Cutoff,
}

/// A splat on the screen.
#[derive(Clone, Copy, Debug)]
pub struct BaselineFootprint {
    /// Camera-space depth.
    pub depth: f32,
    /// Pixels.
    pub centre: [f32; 2],
    /// r = a dx^2 + 2 b dx dy + c dy^2.
    pub conic: [f32; 3],
    /// Vxx, Vxy, Vyy.
    pub variance: [f32; 3],
    /// The footprint is r < cutoff.
    pub cutoff: f32,
    /// Opacity at r = 0.
    pub peak: f32,
    /// Linear red, green, blue.
    pub colour: [f32; 3],
    /// Pixels that the cut-off's bounding box touches; not empty.
    pub bounds: Window,
}

impl FloatScene {
    /// What `rules` and `camera` make of the scene.
    pub fn new(scene: &Scene, camera: &Camera, rules: &Rules) -> Self {
        let (colours, weights) = (scene.colours(camera), scene.weights_for(rules));
        let attributes = colours.iter().zip(&weights);
        let splats = scene.splats.iter().zip(attributes);
        let slope = |axis: usize| {
            let (size, focal, principal) = [
                (camera.width as f64, camera.fx, camera.cx),
                (camera.height as f64, camera.fy, camera.cy),
            ][axis];
            let margin = 0.3 * size / (2.0 * focal);
            [
                -(principal / focal + margin),
                (size - principal) / focal + margin,
            ]
            .map(|limit| {
                if rules.clamp_jacobian {
                    limit as f32
                } else {
                    f32::INFINITY.copysign(limit as f32)
                }
            })
        };
        FloatScene {
            splats: splats
                .map(|(splat, (colour, weight))| BaselineSplat {
                    centre: splat.centre.map(|c| c as f32),
                    covariance: [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)]
                        .map(|(i, j)| splat.axes.iter().map(|a| a[i] * a[j]).sum::<f64>() as f32),
                    weight: *weight as f32,
                    colour: colour.map(|c| c as f32),
                })
                .collect(),
            rotation: camera.rotation.map(|row| row.map(|w| w as f32)),
            translation: camera.translation.map(|d| d as f32),
            focal: [camera.fx as f32, camera.fy as f32],
            principal: [camera.cx as f32, camera.cy as f32],
            near: camera.near as f32,
            far: camera.far as f32,
            slopes: [slope(0), slope(1)],
            normalised: rules.normalised,
            low_pass: rules.low_pass as f32,
            cutoff: rules.cutoff as f32,
            viewport: [camera.width as u16, camera.height as u16],
            alpha_max: rules.alpha_max as f32,
            alpha_min: rules.alpha_min as f32,
            stop: rules.minimum_transmittance as f32,
            omit_finishing: rules.omit_finishing,
        }
    }

    /// Footprints of all splats, in the scene's order, side by side on all cores.
    pub fn footprints(&self, extent: BoxExtent) -> Vec<Option<BaselineFootprint>> {
        self.splats
            .par_iter()
            .map(|splat| self.footprint(splat, extent))
            .collect()
    }

    /// Projects one splat; `None` if nothing of it is seen.
    fn footprint(&self, splat: &BaselineSplat, extent: BoxExtent) -> Option<BaselineFootprint> {
        let [x, y, z] =
            [0, 1, 2].map(|row| dot(self.rotation[row], splat.centre) + self.translation[row]);
        if z <= self.near || z >= self.far {
            return None;
        }
        let inverse = 1.0 / z;
        let slope = [x * inverse, y * inverse];
        let gain = self.focal.map(|focal| focal * inverse);
        let clamped = [0, 1].map(|axis| {
            let [low, high] = self.slopes[axis];
            slope[axis].max(low).min(high)
        });
        // Rows of J W; the third column of J is -gain * slope.
        let rows = [0, 1].map(|axis| {
            [0, 1, 2].map(|k| {
                gain[axis] * (self.rotation[axis][k] - clamped[axis] * self.rotation[2][k])
            })
        });
        let [across, down] = rows.map(|row| apply(&splat.covariance, row));
        let xx = dot(rows[0], across) + self.low_pass;
        let xy = dot(rows[0], down);
        let yy = dot(rows[1], down) + self.low_pass;
        let determinant = xx * yy - xy * xy;
        if determinant <= 0.0 {
            return None;
        }
        let peak = if self.normalised {
            let slant = (1.0 + clamped[0] * clamped[0] + clamped[1] * clamped[1]).sqrt();
            splat.weight * gain[0] * gain[1] * slant / (std::f32::consts::TAU * determinant.sqrt())
        } else {
            splat.weight
        };
        let cutoff = if self.alpha_min > 0.0 {
            self.cutoff.min(2.0 * (peak / self.alpha_min).ln())
        } else {
            self.cutoff
        };
        // Also false for a peak of 0, whose logarithm is -infinity, and for NaN.
        if !(cutoff > 0.0 && peak > 0.0) {
            return None;
        }
        let centre = [0, 1].map(|axis| self.focal[axis] * slope[axis] + self.principal[axis]);
        let extent = match extent {
            BoxExtent::Cutoff => [(cutoff * xx).sqrt(), (cutoff * yy).sqrt()],
            BoxExtent::Sigmas => {
                let mean = 0.5 * (xx + yy);
                let largest = mean + (mean * mean - determinant).max(0.1).sqrt();
                let end = self.cutoff.min(9.0);
                [(end * largest).sqrt().ceil(); 2]
            }
        };
        let bounds = self.bounds(centre, extent)?;
        Some(BaselineFootprint {
            depth: z,
            centre,
            conic: [yy / determinant, -xy / determinant, xx / determinant],
            variance: [xx, xy, yy],
            cutoff,
            peak,
            colour: splat.colour,
            bounds,
        })
    }

    /// Pixels whose samples lie within the extents around the centre.
    fn bounds(&self, centre: [f32; 2], extent: [f32; 2]) -> Option<Window> {
        let mut window = Window {
            first: [0; 2],
            end: [0; 2],
        };
        for axis in 0..2 {
            let limit = f32::from(self.viewport[axis]);
            let low = (centre[axis] - extent[axis] - 0.5).ceil().max(0.0);
            let high = ((centre[axis] + extent[axis] - 0.5).floor() + 1.0).min(limit);
            // NaN has been culled: the cut-off and the variance are positive numbers.
            if low >= high {
                return None;
            }
            (window.first[axis], window.end[axis]) = (low as u16, high as u16);
        }
        Some(window)
    }
}

/// Sort key of a depth: the bits of positive numbers are ordered as the numbers are.
pub fn depth_key(depth: f32) -> u32 {
    depth.to_bits()
}

fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// A symmetric matrix times a vector.
fn apply([xx, xy, xz, yy, yz, zz]: &[f32; 6], v: [f32; 3]) -> [f32; 3] {
    [
        dot([*xx, *xy, *xz], v),
        dot([*xy, *yy, *yz], v),
        dot([*xz, *yz, *zz], v),
    ]
}
