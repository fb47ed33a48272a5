//! Engine `float`: EWA volume splatting in double precision, straight from the papers' formulas.
//!
//! EWA 6.2 and 7.1: centre t = W u + d, Jacobian of the perspective map at the
//! centre, V' = J W V W^T J^T, low-pass V^h = h I, conic Q = (V' + V^h)^-1, radial index r = x^T Q x and weight
//! exp(-r/2). Everything is in pixels. What the peak means and where the footprint ends is up to the [`Rules`].

use super::compositor::{self, OnScreen, ScreenSplat};
use super::jacobian::{CameraAxes, Jacobian, ScreenVariance};
use super::kernels::enlargement;
use super::{Culled, FloatDrawing, PixelBox, pixel_range};
use crate::camera::Camera;
use crate::rules::{Compositing, Kernel, Rules};
use crate::scene::{Scene, Splat};
use crate::vector::{self, Vector};

/// How far, in half pictures, the clamp of the Jacobian's slopes reaches beyond the picture's edge.
const CLAMP_MARGIN: f64 = 0.3;

/// Widens the radial index at which a splat becomes too faint, so that rounding never loses a pixel: the pixel's own
/// opacity decides in the end.
const CUTOFF_SLACK: f64 = 1e-9;

/// A splat on the screen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Footprint {
    /// Centre [u, v], pixels.
    pub centre: [f64; 2],
    /// Camera-space z of the centre.
    pub depth: f64,
    /// What it is sorted by: the depth, unless [`footprints`] says otherwise.
    pub place: f64,
    /// Variance matrix including the low-pass filter, and its determinant.
    pub variance: ScreenVariance,
    /// Opacity at r = 0, before the clamp to `alpha_max`.
    pub peak: f64,
    /// Radial index at which the footprint ends: the rules' cut-off, or earlier where it becomes too faint.
    pub cutoff: f64,
    /// Pixels that may lie inside the cut-off.
    pub bounds: PixelBox,
    /// Linear RGB.
    pub colour: [f64; 3],
}

/// Projects one splat, whose weight is as the rules need it.
pub fn project(splat: &Splat, camera: &Camera, rules: &Rules) -> Result<Footprint, Culled> {
    let footprint = project_beyond_viewport(splat, camera, rules)?;
    if footprint.bounds.is_empty() {
        Err(Culled::OutsideViewport)
    } else {
        Ok(footprint)
    }
}

/// Like [`project`], but keeps a footprint that touches no pixel: its bounds are empty.
pub fn project_beyond_viewport(
    splat: &Splat,
    camera: &Camera,
    rules: &Rules,
) -> Result<Footprint, Culled> {
    let position = visible_position(splat, camera)?;
    let depth = position[2];
    let jacobian = Jacobian::at(camera, jacobian_slope(position, camera, rules), depth);
    let (axes, weight) = scaled_by_distance(splat, &jacobian, rules);
    let axes = CameraAxes::new(&axes, camera);
    let variance = ScreenVariance::new(&axes, &jacobian, rules.low_pass);
    let centre = screen_position(position, camera);
    if !(variance.is_regular() && centre[0].is_finite() && centre[1].is_finite()) {
        return Err(Culled::Degenerate);
    }
    // EWA eq. 31: the integral along the ray of a normalised kernel, times its mass. |W| is 1.
    let peak = if rules.normalised {
        weight * jacobian.determinant() * variance.normalised_peak() * rules.kernel.relative_peak()
    } else if rules.compensated {
        weight * variance.compensation()
    } else {
        weight
    };
    let cutoff = effective_cutoff(peak, rules)?;
    // The ellipse's half extents.
    let half = [variance.a, variance.c].map(|along| (cutoff * along).sqrt());
    let bounds = PixelBox::around(centre, half, camera);
    Ok(Footprint {
        centre,
        depth,
        place: depth,
        variance,
        peak,
        cutoff,
        bounds,
        colour: splat.colour,
    })
}

/// Projects every splat of the scene, in the scene's order, each with the place that the scene's
/// [`SortOrder`](crate::scene::SortOrder) gives it.
pub fn footprints(scene: &Scene, camera: &Camera, rules: &Rules) -> Vec<Result<Footprint, Culled>> {
    compositor::project_all(scene, camera, rules, |splat| {
        let footprint = project(splat, camera, rules)?;
        let place = scene.order.place(camera, splat.centre);
        Ok(Footprint { place, ..footprint })
    })
}

/// Draws the scene; the caller's rayon pool decides the number of threads.
pub fn draw(
    scene: &Scene,
    camera: &Camera,
    rules: &Rules,
    compositing: Compositing,
) -> FloatDrawing {
    let footprints = footprints(scene, camera, rules);
    compositor::draw(&footprints, camera, rules, compositing, &|_, _| ())
}

impl ScreenSplat for Footprint {
    fn on_screen(&self) -> OnScreen {
        OnScreen {
            bounds: self.bounds,
            place: self.place,
            colour: self.colour,
        }
    }

    fn radial_index_and_peak(&self, point: [f64; 2]) -> (f64, f64) {
        let offset = [point[0] - self.centre[0], point[1] - self.centre[1]];
        (self.variance.radial_index(offset), self.peak)
    }

    /// From r < cutoff with the square completed : no pixel outside the ellipse is visited.
    fn row_span(&self, y: f64) -> (usize, usize) {
        let dy = y - self.centre[1];
        let ScreenVariance {
            b, c, determinant, ..
        } = self.variance;
        let left_over = (self.cutoff - dy * dy / c).max(0.0);
        let middle = self.centre[0] + b / c * dy;
        let half_width = (left_over * determinant / c).sqrt();
        let magnitude = self.centre[0].abs() + half_width;
        let (x0, x1) = pixel_range(
            middle - half_width,
            middle + half_width,
            magnitude,
            self.bounds.x1,
        );
        (x0.max(self.bounds.x0), x1)
    }
}

/// The splat's centre in camera space, unless a number is not finite or it lies outside near and far.
pub(super) fn visible_position(splat: &Splat, camera: &Camera) -> Result<[f64; 3], Culled> {
    let mut vectors = splat.axes.iter().chain([&splat.centre, &splat.colour]);
    if !(splat.weight.is_finite() && vectors.all(|&numbers| vector::is_finite(numbers))) {
        return Err(Culled::NonFinite);
    }
    let position = camera.to_camera(splat.centre);
    if !vector::is_finite(position) {
        return Err(Culled::Degenerate);
    }
    within_depths(position, camera)
}

/// The place itself, unless it lies outside near and far.
pub(super) fn within_depths(position: Vector, camera: &Camera) -> Result<Vector, Culled> {
    match position[2] {
        z if z <= camera.near => Err(Culled::Near),
        z if z >= camera.far => Err(Culled::Far),
        _ => Ok(position),
    }
}

/// Where a point of camera space lies in the picture, pixels.
pub(super) fn screen_position(position: [f64; 3], camera: &Camera) -> [f64; 2] {
    let [x, y, z] = position;
    let distance = if camera.orthographic { 1.0 } else { z };
    [
        camera.fx * x / distance + camera.cx,
        camera.fy * y / distance + camera.cy,
    ]
}

/// The radial index beyond which neither the cut-off nor the smallest opacity lets a pixel through.
pub(super) fn effective_cutoff(peak: f64, rules: &Rules) -> Result<f64, Culled> {
    if peak.is_infinite() || peak.is_nan() {
        return Err(Culled::Degenerate);
    }
    if peak <= 0.0 || peak < rules.alpha_min {
        return Err(Culled::Transparent);
    }
    if rules.kernel != Kernel::Gaussian {
        return Ok(rules.cutoff);
    }
    // peak exp(-r/2) >= alpha_min; without a smallest opacity the logarithm is infinite, as it should be.
    let faint = 2.0 * (peak / rules.alpha_min).ln() + CUTOFF_SLACK;
    Ok(rules.cutoff.min(faint))
}

/// Axes and weight of a splat as \[SWAN\] 4.3 scales them beyond the distance k: radii grow by d/k, energy falls by
/// (k/d)^2. A normalised kernel keeps its mass, and its peak falls by itself.
pub(super) fn scaled_by_distance(
    splat: &Splat,
    jacobian: &Jacobian,
    rules: &Rules,
) -> ([Vector; 3], f64) {
    let factor = enlargement(rules, jacobian);
    let axes = splat.axes.map(|axis| vector::scale(factor, axis));
    let weight = if rules.normalised {
        splat.weight
    } else {
        splat.weight / (factor * factor)
    };
    (axes, weight)
}

/// The slopes at which J is taken: the centre's own, or clamped to the widened frustum as `3dgs` asks.
fn jacobian_slope(position: [f64; 3], camera: &Camera, rules: &Rules) -> [f64; 2] {
    let [x, y, z] = position;
    let slope = [x / z, y / z];
    if !rules.clamp_jacobian {
        return slope;
    }
    let frustum = widened_frustum(camera);
    // Not `clamp`, which panics where a principal point far off the picture turns the bounds around.
    [0, 1].map(|i| slope[i].min(frustum[i][1]).max(frustum[i][0]))
}

/// The least and the greatest slope, across and down, that the clamp lets through.
pub(super) fn widened_frustum(camera: &Camera) -> [[f64; 2]; 2] {
    let ends = |size: usize, centre: f64, focal_length: f64| {
        let size = size as f64;
        let margin = CLAMP_MARGIN * 0.5 * size / focal_length;
        [
            -(centre / focal_length + margin),
            (size - centre) / focal_length + margin,
        ]
    };
    [
        ends(camera.width, camera.cx, camera.fx),
        ends(camera.height, camera.cy, camera.fy),
    ]
}
