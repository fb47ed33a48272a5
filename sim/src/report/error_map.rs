//! The signed error map: where fixed point is brighter than the reference (warm) and where it is darker (cool).
//!
//! Each pixel shows the one colour channel that differs most, with its sign. The colours are those of an `ErrorScale`
//! that is chosen from the errors.

use super::png::Rgb;
pub use super::scale::colour;
use super::scale::{ErrorScale, PERCENTILE};
use crate::metrics::stored;
use crate::picture::Picture;

/// Signed differences and their colour scale.
#[derive(Clone, Debug, PartialEq)]
pub struct ErrorMap {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Fixed minus float, of the channel that differs most, in units of 1.0.
    pub differences: Vec<f64>,
    /// Their colours; its limit is 0 for identical pictures.
    pub scale: ErrorScale,
}

impl ErrorMap {
    /// Compares two pictures of one size (which [`crate::metrics::compare`] checks).
    pub fn new(fixed: &Picture, float: &Picture) -> ErrorMap {
        let differences: Vec<f64> = fixed
            .pixels
            .iter()
            .zip(&float.pixels)
            .map(|(a, b)| largest_difference(a, b))
            .collect();
        ErrorMap {
            width: fixed.width,
            height: fixed.height,
            scale: ErrorScale::of(&differences, PERCENTILE),
            differences,
        }
    }

    /// By what factor the error at the scale's end is magnified to reach full colour; nothing for identical pictures.
    pub fn magnification(&self) -> Option<f64> {
        (self.scale.limit > 0.0).then(|| 1.0 / self.scale.limit)
    }

    /// The map in colours.
    pub fn to_rgb(&self) -> Rgb {
        let positions = self.differences.iter().map(|d| self.scale.position(*d));
        Rgb::of_pixels([self.width, self.height], positions.map(colour))
    }
}

/// Of red, green and blue, the difference that is largest in size.
fn largest_difference(fixed: &[f64; 4], float: &[f64; 4]) -> f64 {
    (0..3)
        .map(|c| stored(fixed[c]) - stored(float[c]))
        .fold(
            0.0,
            |largest: f64, d| if d.abs() > largest.abs() { d } else { largest },
        )
}
