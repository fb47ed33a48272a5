//! Spherical kernels in perspective in double precision (\[HYBRID\] 4.2 and appendix A).
//!
//! The exact ellipse comes from the angles themselves: with b the angle between the centre's direction and the optical
//! axis and sin a = R/|C|, the tangent cone cuts the image plane between tan(b - a) and tan(b + a), and the minor
//! half-axis is sin a / sqrt(cos^2 b - sin^2 a). The corrected index is the paper's d = sin(atan(i tan a)) / tan a.

use super::compositor::{self, OnScreen, ScreenSplat};
use super::float::{effective_cutoff, screen_position, visible_position};
use super::jacobian::ScreenVariance;
use super::{Culled, FloatDrawing, PixelBox};
use crate::camera::Camera;
use crate::rules::{Compositing, Rules};
use crate::scene::{Scene, Splat};
use crate::vector::{self, Vector};
use serde::{Deserialize, Serialize};

/// Which ellipse and index a sphere is drawn with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Shape {
    /// The tangent cone's ellipse instead of the affine one.
    pub exact_ellipse: bool,
    /// How a pixel's place becomes a radial index.
    pub index: Index,
}

/// How a pixel's place becomes a radial index.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Index {
    /// In proportion to the ellipse's radius.
    Affine,
    /// The paper's correction, exact in the middle of the picture.
    Perspective,
    /// The distance of the pixel's own ray from the centre.
    Ray,
}

/// A sphere on the screen.
#[derive(Clone, Debug, PartialEq)]
pub struct SphereFootprint<'a> {
    /// The rays.
    camera: &'a Camera,
    /// Centre in camera space.
    position: Vector,
    deviation: f64,
    /// Where the ellipse's middle is seen, pixels.
    centre: [f64; 2],
    /// Quadratic form with value 1 on the outline.
    outline: ScreenVariance,
    /// Radial index on the outline.
    cutoff: f64,
    index: Index,
    /// Of the half-angle that the outline is seen under.
    sine: f64,
    tangent: f64,
    peak: f64,
    on_screen: OnScreen,
}

/// Draws a scene whose splats are taken as spheres of their first axis' length.
pub fn draw(
    scene: &Scene,
    camera: &Camera,
    rules: &Rules,
    compositing: Compositing,
    shape: Shape,
) -> FloatDrawing {
    let spheres = compositor::project_all(scene, camera, rules, |splat| {
        project(splat, camera, rules, shape)
    });
    compositor::draw(&spheres, camera, rules, compositing, &|_, _| ())
}

fn project<'a>(
    splat: &Splat,
    camera: &'a Camera,
    rules: &Rules,
    shape: Shape,
) -> Result<SphereFootprint<'a>, Culled> {
    let position = visible_position(splat, camera)?;
    let deviation = vector::length(splat.axes[0]);
    let peak = if rules.normalised {
        splat.weight * rules.kernel.circular_peak(deviation * deviation)
    } else {
        splat.weight
    };
    let cutoff = effective_cutoff(peak, rules)?;
    let radius = deviation * cutoff.sqrt();
    let [x, y, z] = position;
    if z <= radius {
        return Err(Culled::Near);
    }
    let distance = vector::length(position);
    let sine = radius / distance;
    let tangent = sine / (1.0 - sine * sine).sqrt();
    let aside = x.hypot(y);
    let axis_angle = aside.atan2(z);
    let cone = sine.asin();
    // The ray's own index needs no ellipse but to bound the pixels, for which the exact one serves.
    let exact = shape.exact_ellipse || shape.index == Index::Ray;
    let (middle, major, minor) = if exact {
        let (near, far) = ((axis_angle - cone).tan(), (axis_angle + cone).tan());
        let minor = sine / (axis_angle.cos().powi(2) - sine * sine).sqrt();
        (0.5 * (near + far), 0.5 * (far - near), minor)
    } else {
        // First order in R/z. Under the corrected index the outline lies where the affine radius is R / cos a.
        let stretch = if shape.index == Index::Perspective {
            1.0 / cone.cos()
        } else {
            1.0
        };
        let flat = radius / z * stretch;
        (aside / z, flat * distance / z, flat)
    };
    let direction = if aside > 0.0 {
        [x / aside, y / aside]
    } else {
        [1.0, 0.0]
    };
    let centre = screen_position([direction[0] * middle, direction[1] * middle, 1.0], camera);
    let form = |i: usize, j: usize| {
        let along = major * major * direction[i] * direction[j];
        let across = [direction[1], -direction[0]];
        along + minor * minor * across[i] * across[j]
    };
    let determinant = (major * minor * camera.fx * camera.fy).powi(2);
    let outline = ScreenVariance {
        a: form(0, 0) * camera.fx * camera.fx,
        b: form(0, 1) * camera.fx * camera.fy,
        c: form(1, 1) * camera.fy * camera.fy,
        determinant,
        sharp_determinant: determinant,
    };
    if !outline.is_regular() {
        return Err(Culled::Degenerate);
    }
    let bounds = PixelBox::around(centre, [outline.a.sqrt(), outline.c.sqrt()], camera);
    if bounds.is_empty() {
        return Err(Culled::OutsideViewport);
    }
    Ok(SphereFootprint {
        camera,
        position,
        deviation,
        centre,
        outline,
        cutoff,
        index: shape.index,
        sine,
        tangent,
        peak,
        on_screen: OnScreen {
            bounds,
            place: z,
            colour: splat.colour,
        },
    })
}

impl ScreenSplat for SphereFootprint<'_> {
    fn on_screen(&self) -> OnScreen {
        self.on_screen
    }

    fn radial_index_and_peak(&self, point: [f64; 2]) -> (f64, f64) {
        let offset = [point[0] - self.centre[0], point[1] - self.centre[1]];
        let index = self.outline.radial_index(offset).sqrt();
        let distance = match self.index {
            Index::Affine => index,
            // The second factor makes it the ray's distance in radii.
            Index::Perspective => {
                (index * self.tangent).atan().sin() / self.tangent * (self.tangent / self.sine)
            }
            Index::Ray => {
                let [x, y] = self.camera.slopes(point);
                let ray = [x, y, 1.0];
                let apart = vector::length(vector::cross(self.position, ray)) / vector::length(ray);
                return ((apart / self.deviation).powi(2), self.peak);
            }
        };
        (distance * distance * self.cutoff, self.peak)
    }
}
