//! Engine `exact`: the ray integral of the Gaussian in double precision, without the affine approximation.
//!
//! **Filter.** The low-pass filter of variance h square pixels is carried to the plane z = z0 through the splat's
//! centre, where a pixel is z0/fx by z0/fy: the Gaussian's variance becomes V + h diag((z0/fx)^2, (z0/fy)^2, 0).
//! This is the exact preimage of the filter at the splat's depth, so that for a small splat anywhere in the picture
//! this engine converges to `float` (an isotropic filter would do so on the optical axis only).
//!
//! **Ray.** Along the line (sx, sy, 1) z through the eye and a pixel's centre, both the integral of a Gaussian and
//! its peak follow from the marginal of its distribution in the sheared coordinates (x - sx z, y - sy z), which are
//! constant on the line. In units of pixels at depth z0 the splat's centre lies there at (u0 - u, v0 - v), and
//! the marginal variance is J V J^T + h I with the Jacobian J of the *pixel's* ray at depth z0. Hence
//!
//! ```text
//!     r    = x^T (J V J^T + h I)^-1 x      the smallest Mahalanobis distance on the line, squared
//!     peak = weight                                              under opacity rules (`3dgs`)
//!     peak = mass |J| / (2 pi sqrt(det(J V J^T + h I)))          under normalised rules (`ewa`)
//! ```
//!
//! That is EWA splatting with the Jacobian taken at each pixel instead of once at the splat's centre; a
//! parallel projection has the same J everywhere, so there both engines agree. The clamp of the Jacobian's
//! slopes, a remedy for the affine approximation, does not apply. The whole line counts, including what lies
//! behind the eye: this concerns only splats that reach around the eye.

use super::compositor::{self, OnScreen, ScreenSplat};
use super::float::{effective_cutoff, scaled_by_distance, screen_position, visible_position};
use super::jacobian::{CameraAxes, Jacobian, ScreenVariance};
use super::{Culled, FloatDrawing, PixelBox, pixel_range};
use crate::camera::Camera;
use crate::rules::{Compositing, Rules};
use crate::scene::{Scene, Splat};
use crate::vector;

/// A splat that is evaluated along each pixel's own ray.
#[derive(Clone, Debug, PartialEq)]
pub struct ExactFootprint<'a> {
    /// The rays.
    camera: &'a Camera,
    /// The splat's axes in camera space.
    axes: CameraAxes,
    /// Where the centre is seen, pixels.
    centre: [f64; 2],
    /// Camera-space z of the centre.
    depth: f64,
    /// Peak opacity or mass, as the rules want.
    weight: f64,
    rules: Rules,
    /// Pixels that may lie inside the cut-off; sorted by the depth, unless [`footprints`] says otherwise.
    on_screen: OnScreen,
}

/// Prepares one splat, whose weight is as the rules need it.
pub fn project<'a>(
    splat: &Splat,
    camera: &'a Camera,
    rules: &Rules,
) -> Result<ExactFootprint<'a>, Culled> {
    let position = visible_position(splat, camera)?;
    let jacobian = Jacobian::at(camera, [0.0; 2], position[2]);
    let (axes, weight) = scaled_by_distance(splat, &jacobian, rules);
    let axes = CameraAxes::new(&axes, camera);
    let centre = screen_position(position, camera);
    let mut footprint = ExactFootprint {
        camera,
        axes,
        centre,
        depth: position[2],
        weight,
        rules: *rules,
        on_screen: OnScreen {
            bounds: PixelBox::whole(camera),
            place: position[2],
            colour: splat.colour,
        },
    };
    let (variance, mut peak) = footprint.variance_and_peak(centre);
    if !(variance.is_regular() && centre[0].is_finite() && centre[1].is_finite()) {
        return Err(Culled::Degenerate);
    }
    // An opacity is the splat's own and the same on all rays, and so is what is left of it: that on the ray through the
    // centre.
    if rules.compensated && !rules.normalised {
        peak *= variance.compensation();
        footprint.weight = peak;
    }
    // The peak of a normalised kernel differs from ray to ray, so its smallest opacity bounds nothing here.
    let mut bounding = *rules;
    if rules.normalised {
        bounding.alpha_min = 0.0;
    }
    let cutoff = effective_cutoff(peak, &bounding)?;
    footprint.on_screen.bounds = footprint.bounds_within(cutoff);
    if footprint.on_screen.bounds.is_empty() {
        return Err(Culled::OutsideViewport);
    }
    Ok(footprint)
}

/// Prepares every splat of the scene, in the scene's order, each with the place that the scene's
/// [`SortOrder`](crate::scene::SortOrder) gives it.
pub fn footprints<'a>(
    scene: &Scene,
    camera: &'a Camera,
    rules: &Rules,
) -> Vec<Result<ExactFootprint<'a>, Culled>> {
    compositor::project_all(scene, camera, rules, |splat| {
        let mut footprint = project(splat, camera, rules)?;
        footprint.on_screen.place = scene.order.place(camera, splat.centre);
        Ok(footprint)
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

impl ExactFootprint<'_> {
    /// The marginal variance and the peak on the ray through a point of the picture.
    fn variance_and_peak(&self, point: [f64; 2]) -> (ScreenVariance, f64) {
        let jacobian = Jacobian::at(self.camera, self.camera.slopes(point), self.depth);
        let variance = ScreenVariance::new(&self.axes, &jacobian, self.rules.low_pass);
        let peak = if self.rules.normalised {
            let peak = variance.normalised_peak() * self.rules.kernel.relative_peak();
            self.weight * jacobian.determinant() * peak
        } else {
            self.weight
        };
        (variance, peak)
    }

    /// The pixels whose rays may meet the widened ellipsoid of radial index `cutoff`.
    fn bounds_within(&self, cutoff: f64) -> PixelBox {
        let camera = self.camera;
        let range = |axis: usize, focal_length: f64, principal: f64, size: usize| {
            let [low, high] = self.extent(axis, focal_length, principal, cutoff);
            pixel_range(low, high, self.centre[axis].abs() + (high - low), size)
        };
        let (x0, x1) = range(0, camera.fx, camera.cx, camera.width);
        let (y0, y1) = range(1, camera.fy, camera.cy, camera.height);
        PixelBox { x0, y0, x1, y1 }
    }

    /// The extent of the footprint along one direction of the picture, pixels; infinite if it has no end.
    ///
    /// A ray of slope s + e, where s is the centre's slope, lies in the plane x = (s + e) z. With the rows X and Z
    /// of A and B = X - s Z, the plane meets the ellipsoid of radial index `cutoff` exactly if
    ///
    /// ```text
    ///     (e z0)^2 <= cutoff (|B - e Z|^2 + h z0^2 / f^2)
    /// ```
    ///
    /// which bounds e between the roots of a quadratic, unless the ellipsoid reaches the plane z = 0.
    fn extent(&self, direction: usize, focal_length: f64, principal: f64, cutoff: f64) -> [f64; 2] {
        let centre = self.centre[direction];
        let x_row = self.axes.row(direction);
        if self.camera.orthographic {
            let variance =
                focal_length * focal_length * vector::dot(x_row, x_row) + self.rules.low_pass;
            let half = (cutoff * variance).sqrt();
            return [centre - half, centre + half];
        }
        let z_row = self.axes.row(2);
        let slope = (centre - principal) / focal_length;
        let b_row = vector::subtract(x_row, vector::scale(slope, z_row));
        let filter = self.rules.low_pass * (self.depth / focal_length).powi(2);
        // p e^2 + 2 q e - w <= 0
        let p = self.depth * self.depth - cutoff * vector::dot(z_row, z_row);
        let q = cutoff * vector::dot(b_row, z_row);
        let w = cutoff * (vector::dot(b_row, b_row) + filter);
        let reaches_the_eye_plane = p <= 1e-9 * self.depth * self.depth;
        if reaches_the_eye_plane || !(p.is_finite() && q.is_finite() && w.is_finite()) {
            return [f64::NEG_INFINITY, f64::INFINITY];
        }
        // Of the two forms of each root the one without cancellation.
        let root = (q * q + p * w).sqrt();
        let (low, high) = if q >= 0.0 {
            (-(q + root) / p, w / (q + root))
        } else {
            (-w / (root - q), (root - q) / p)
        };
        // w = q = 0 (a point without a filter) makes 0 / 0: then both ends are the centre.
        let end = |e: f64| {
            if e.is_nan() {
                centre
            } else {
                centre + focal_length * e
            }
        };
        [end(low), end(high)]
    }
}

impl ScreenSplat for ExactFootprint<'_> {
    fn on_screen(&self) -> OnScreen {
        self.on_screen
    }

    fn radial_index_and_peak(&self, point: [f64; 2]) -> (f64, f64) {
        let (variance, peak) = self.variance_and_peak(point);
        let offset = [point[0] - self.centre[0], point[1] - self.centre[1]];
        (variance.radial_index(offset), peak)
    }
}
