//! The signed error map: where fixed point is brighter than the reference (warm) and where it is darker (cool).
//!
//! Each pixel shows the one colour channel that differs most, with its sign, so that the largest error of the picture
//! is on the map.
//!
//! The colour scale is chosen from the errors. It ends at the largest one, and between there and zero it follows
//! `asinh(error / knee)`: linear for errors below the knee, logarithmic above. The knee is a quarter of the median
//! error, so that a few stray pixels at a footprint's edge, which may err a thousand times as much as the rest, do not
//! leave the rest black. Where all errors are alike the scale is nearly linear.

use super::png::Rgb;
use crate::metrics::median;
use crate::metrics::stored;
use crate::picture::Picture;

/// The dark middle, then towards full error, in sRGB.
const MIDDLE: [f64; 3] = [17.0, 19.0, 24.0];
/// Fixed is brighter.
const WARM: [[f64; 3]; 3] = [
    [150.0, 45.0, 25.0],
    [240.0, 120.0, 45.0],
    [255.0, 226.0, 170.0],
];
/// Fixed is darker.
const COOL: [[f64; 3]; 3] = [
    [22.0, 70.0, 150.0],
    [50.0, 145.0, 230.0],
    [190.0, 232.0, 255.0],
];

/// The knee over the median error.
const KNEE: f64 = 0.25;
/// The median is taken to be at least this part of the largest error: nobody looks for more than eight decades.
const SMALLEST_KNEE: f64 = 1e-8;

/// Signed differences and where the colour scale ends.
#[derive(Clone, Debug, PartialEq)]
pub struct ErrorMap {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Fixed minus float, of the channel that differs most, in units of 1.0.
    pub differences: Vec<f64>,
    /// The largest absolute difference, where the colour scale ends; 0 for identical pictures.
    pub limit: f64,
    /// The absolute difference at which the scale turns from linear to logarithmic; 0 for identical pictures.
    pub knee: f64,
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
        let limit = differences
            .iter()
            .fold(0.0f64, |limit, d| limit.max(d.abs()));
        let knee = KNEE * median_size(&differences).max(limit * SMALLEST_KNEE);
        ErrorMap {
            width: fixed.width,
            height: fixed.height,
            differences,
            limit,
            knee,
        }
    }

    /// By what factor the largest error is magnified to reach full colour; nothing for identical pictures.
    pub fn magnification(&self) -> Option<f64> {
        (self.limit > 0.0).then(|| 1.0 / self.limit)
    }

    /// The map in colours.
    pub fn to_rgb(&self) -> Rgb {
        let bytes = self
            .differences
            .iter()
            .flat_map(|&d| colour(self.position(d)))
            .collect();
        Rgb {
            width: self.width,
            height: self.height,
            bytes,
        }
    }

    /// Where a difference stands on the scale, -1 to 1.
    pub fn position(&self, difference: f64) -> f64 {
        if self.limit > 0.0 {
            (difference / self.knee).asinh() / self.range()
        } else {
            0.0
        }
    }

    /// The difference that stands at a position of the scale: the inverse of [`ErrorMap::position`].
    pub fn difference_at(&self, position: f64) -> f64 {
        if self.limit > 0.0 {
            self.knee * (position * self.range()).sinh()
        } else {
            0.0
        }
    }

    fn range(&self) -> f64 {
        (self.limit / self.knee).asinh()
    }
}

/// Colour at a position of the scale, -1 to 1.
pub fn colour(position: f64) -> [u8; 3] {
    let stops = if position < 0.0 { &COOL } else { &WARM };
    let along = position.abs().min(1.0) * stops.len() as f64;
    let index = (along as usize).min(stops.len() - 1);
    let start = if index == 0 {
        &MIDDLE
    } else {
        &stops[index - 1]
    };
    let part = along - index as f64;
    std::array::from_fn(|c| (start[c] + (stops[index][c] - start[c]) * part).round() as u8)
}

/// Median size of the differences that are not zero; 0 if there are none.
fn median_size(differences: &[f64]) -> f64 {
    let mut sizes: Vec<f64> = differences
        .iter()
        .map(|d| d.abs())
        .filter(|&size| size > 0.0)
        .collect();
    median(&mut sizes).unwrap_or(0.0)
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
