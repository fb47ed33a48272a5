//! What a splat weighs under each kind of rules.
//!
//! Normalised rules (\[EWA\] eq. 26-31) want a mass, the others a peak opacity. A scene made for one is drawn under the
//! other by the peak that its kernel would have if it were a sphere of the same volume, seen one scene unit per pixel
//! and without a low-pass filter: `opacity = mass / (2 pi det(V)^(1/3))`, clamped to 0..1, and
//! `mass = opacity 2 pi det(V)^(1/3)`, where V is the splat's variance matrix.

use super::{Scene, Splat, Weight};
use crate::rules::Rules;
use crate::vector;

impl Scene {
    /// One weight per splat with the meaning that `rules` want: a mass if they are normalised, else an opacity.
    pub fn weights_for(&self, rules: &Rules) -> Vec<f64> {
        self.splats.iter().map(self.weighing(rules)).collect()
    }

    /// What gives each of its splats that weight.
    pub fn weighing(&self, rules: &Rules) -> fn(&Splat) -> f64 {
        match (self.weight, rules.normalised) {
            (Weight::Opacity, false) | (Weight::Mass, true) => |splat| splat.weight,
            (Weight::Mass, false) => opacity_of_mass,
            (Weight::Opacity, true) => |splat| splat.weight * mean_section(splat),
        }
    }
}

fn opacity_of_mass(splat: &Splat) -> f64 {
    if splat.weight <= 0.0 {
        return 0.0;
    }
    // A flat kernel has no section: any mass at all makes it opaque.
    (splat.weight / mean_section(splat)).clamp(0.0, 1.0)
}

/// `2 pi det(V)^(1/3)`, in square scene units. V = A A^T for the axes A, so the root is |det A|^(2/3).
fn mean_section(splat: &Splat) -> f64 {
    let [a, b, c] = splat.axes;
    let determinant = vector::dot(a, vector::cross(b, c));
    std::f64::consts::TAU * determinant.abs().cbrt().powi(2)
}
