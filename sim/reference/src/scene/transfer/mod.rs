//! Transfer functions: from a voxel's value and gradient magnitude to colour and extinction (\[EWA\] 7.1, \[SWAN\] 5).
//!
//! Both are piecewise linear between control points and constant beyond them:
//! `extinction = extinction(value) * multiplier(|gradient|)`, with extinction per scene unit and the gradient in data
//! units per scene unit. A file looks like this:
//!
//! ```toml
//! [[value]]              # control points, `at` increasing
//! at = 40.0
//! colour = [0.9, 0.6, 0.5]
//! extinction = 0.0
//! [[value]]
//! at = 90.0
//! colour = [1.0, 0.9, 0.8]
//! extinction = 0.05
//!
//! [[gradient]]           # optional; without it the multiplier is 1
//! at = 0.0
//! multiplier = 0.2
//! [[gradient]]
//! at = 30.0
//! multiplier = 1.0
//!
//! [shading]              # optional Phong terms, see `Shading`
//! ambient = 0.3
//! ```

mod file;
mod presets;
#[cfg(test)]
mod tests;

use serde::Deserialize;

/// Colour and extinction at one value.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ValuePoint {
    /// Data value.
    pub at: f64,
    /// Linear RGB, 0 to 1.
    pub colour: [f64; 3],
    /// Extinction per scene unit.
    pub extinction: f64,
}

/// Multiplier of the extinction at one gradient magnitude.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GradientPoint {
    /// Gradient magnitude, data units per scene unit.
    pub at: f64,
    /// Multiplies the extinction.
    pub multiplier: f64,
}

/// The terms of Phong's model.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Shading {
    /// Part of the colour that no light direction changes.
    pub ambient: f64,
    /// Part of the colour that follows the cosine between normal and light.
    pub diffuse: f64,
    /// White highlight.
    pub specular: f64,
    /// Sharpness of the highlight.
    pub exponent: f64,
    /// Gradient magnitude from which a voxel counts fully as a surface. Below it the shading fades into a plain
    /// average, because the direction of a small gradient is mostly noise.
    pub surface: f64,
}

impl Default for Shading {
    fn default() -> Self {
        Shading {
            ambient: 0.3,
            diffuse: 0.7,
            specular: 0.25,
            exponent: 20.0,
            surface: 0.0,
        }
    }
}

/// A transfer function over value and gradient magnitude; [`Transfer::from_toml`] checks what a file says.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Transfer {
    /// Control points, `at` increasing; at least one.
    #[serde(rename = "value", default)]
    values: Vec<ValuePoint>,
    /// Control points, `at` increasing; none means a multiplier of 1.
    #[serde(rename = "gradient", default)]
    gradients: Vec<GradientPoint>,
    /// The Phong terms that go with this function.
    #[serde(default)]
    pub shading: Shading,
}

impl Transfer {
    /// Colour and extinction at a value, before the gradient is looked at.
    pub fn at_value(&self, value: f64) -> ([f64; 3], f64) {
        let (low, high, part) = bracket(&self.values, value, |point| point.at);
        let mix = |from: f64, to: f64| from + (to - from) * part;
        let colour = std::array::from_fn(|channel| mix(low.colour[channel], high.colour[channel]));
        (colour, mix(low.extinction, high.extinction))
    }

    /// What a gradient magnitude multiplies the extinction by.
    pub fn at_gradient(&self, magnitude: f64) -> f64 {
        if self.gradients.is_empty() {
            return 1.0;
        }
        let (low, high, part) = bracket(&self.gradients, magnitude, |point| point.at);
        low.multiplier + (high.multiplier - low.multiplier) * part
    }
}

/// The control points around a place and how far it lies between them, 0 to 1. `points` is not empty.
fn bracket<T>(points: &[T], place: f64, at: impl Fn(&T) -> f64) -> (&T, &T, f64) {
    let above = points.partition_point(|point| at(point) <= place);
    let low = &points[above.saturating_sub(1)];
    let high = &points[above.min(points.len() - 1)];
    let width = at(high) - at(low);
    let part = if width > 0.0 {
        (place - at(low)) / width
    } else {
        0.0
    };
    (low, high, part)
}
