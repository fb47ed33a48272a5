//! The double-precision reference: two engines that share one compositor and no arithmetic with the kernel.
//!
//! - [`float`]: EWA volume splatting as the papers write it (EWA 6.2): the perspective map is
//!   replaced by its affine approximation at the splat's centre.
//! - [`exact`]: the integral (or peak) of the Gaussian along each pixel's own ray, without that approximation, so
//!   that model error (`float` against `exact`) and arithmetic error (fixed against `float`) are told apart.
//!
//! Both derive from [`jacobian`]; [`compositor`] orders and blends what they project. [`golden`] holds the
//! independent data that the reference itself is measured against.

pub mod compositor;
pub mod exact;
pub mod float;
pub mod formats;
// Reads an archive: scene/archive.rs.
#[cfg(not(target_family = "wasm"))]
pub mod golden;
pub mod hybrid;
pub mod jacobian;
pub mod kernels;
pub mod maps;
pub mod plain;
pub mod rational;
pub mod sheets;
pub mod single;
pub mod sphere;
pub mod surface;

use crate::camera::Camera;
use crate::picture::Picture;
use rayon::prelude::*;

/// Why a splat does not reach the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Culled {
    /// At or before the near plane: z <= near.
    Near,
    /// At or beyond the far plane: z >= far.
    Far,
    /// Its footprint touches no pixel of the picture.
    OutsideViewport,
    /// Its peak is zero or below the smallest opacity that the rules keep.
    Transparent,
    /// Its variance on the screen is singular or too large for a double.
    Degenerate,
    /// Its position, axes, weight or colour is NaN or infinite.
    NonFinite,
    /// It shows its back, and the style leaves backs out.
    Backface,
}

/// Reasons why a splat does not reach the picture.
const REASONS: usize = Culled::Backface as usize + 1;

/// What became of a scene's splats in one drawing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Splats of the scene.
    pub splats: usize,
    /// Splats handed to the compositor.
    pub drawn: usize,
    /// The others, by reason.
    culled: [usize; REASONS],
    /// Pairs of a splat and a pixel that were blended: inside the cut-off, not too faint, pixel not yet finished.
    pub covered_pixels: u64,
}

impl Counts {
    /// Counts the outcome of projecting each splat; nothing is blended yet.
    pub fn of_projected<Footprint>(projected: &[Result<Footprint, Culled>]) -> Counts {
        let mut counts = Counts {
            splats: projected.len(),
            ..Counts::default()
        };
        for outcome in projected {
            match outcome {
                Ok(_) => counts.drawn += 1,
                Err(reason) => counts.culled[*reason as usize] += 1,
            }
        }
        counts
    }

    /// Splats that were culled for this reason.
    pub fn culled(&self, reason: Culled) -> usize {
        self.culled[reason as usize]
    }
}

/// A picture and what became of the splats.
#[derive(Clone, Debug, PartialEq)]
pub struct FloatDrawing {
    /// The picture.
    pub picture: Picture,
    /// The counts.
    pub counts: Counts,
}

/// A rectangle of pixels, `x0 <= x < x1` and `y0 <= y < y1`; empty if a pair is not ascending.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PixelBox {
    /// First column.
    pub x0: usize,
    /// First row.
    pub y0: usize,
    /// Column after the last.
    pub x1: usize,
    /// Row after the last.
    pub y1: usize,
}

impl PixelBox {
    /// All pixels of a camera's picture.
    pub fn whole(camera: &Camera) -> PixelBox {
        PixelBox {
            x0: 0,
            y0: 0,
            x1: camera.width,
            y1: camera.height,
        }
    }

    /// The pixels whose centres lie within `half` of a place in the picture, on either side along both axes.
    pub fn around(centre: [f64; 2], half: [f64; 2], camera: &Camera) -> PixelBox {
        let range = |axis: usize, size: usize| {
            let (middle, half) = (centre[axis], half[axis]);
            pixel_range(middle - half, middle + half, middle.abs() + half, size)
        };
        let (x0, x1) = range(0, camera.width);
        let (y0, y1) = range(1, camera.height);
        PixelBox { x0, y0, x1, y1 }
    }

    /// Whether there is no pixel inside.
    pub fn is_empty(&self) -> bool {
        self.x0 >= self.x1 || self.y0 >= self.y1
    }

    /// The pixels of both rectangles.
    pub fn intersection(&self, other: &PixelBox) -> PixelBox {
        PixelBox {
            x0: self.x0.max(other.x0),
            y0: self.y0.max(other.y0),
            x1: self.x1.min(other.x1),
            y1: self.y1.min(other.y1),
        }
    }
}

/// Rows that one task draws.
const BAND: usize = 16;

/// Draws a picture's pixels in bands of rows, which are shared among threads, and sums up what `draw` counts of each.
fn in_bands<Pixel: Send>(
    pixels: &mut [Pixel],
    width: usize,
    draw: impl Fn(PixelBox, &mut [Pixel]) -> u64 + Sync,
) -> u64 {
    let bands = pixels.par_chunks_mut((width * BAND).max(1)).enumerate();
    let drawn = bands.map(|(band, pixels)| {
        let y0 = band * BAND;
        let rows = PixelBox {
            x0: 0,
            y0,
            x1: width,
            y1: y0 + pixels.len() / width,
        };
        draw(rows, pixels)
    });
    drawn.sum()
}

/// The pixels `0..size` whose centres (i + 0.5) lie between `low` and `high`, as a half-open range.
///
/// `magnitude` is the size of the numbers that the ends were computed from: the interval is widened by a billionth
/// of it, so that rounding never loses a pixel. NaN gives everything.
pub fn pixel_range(low: f64, high: f64, magnitude: f64, size: usize) -> (usize, usize) {
    let slack = 1e-9 * (1.0 + magnitude);
    let (low, high) = (low - slack, high + slack);
    if low.is_nan() || high.is_nan() {
        return (0, size);
    }
    // Casts from float to integer saturate, so bounds far off the screen are safe.
    let first = (low - 0.5).ceil().max(0.0) as usize;
    let after_last = ((high - 0.5).floor() + 1.0).max(0.0) as usize;
    (first, after_last.min(size))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixel_ranges_hold_the_centres_of_the_interval() {
        let range = |low, high| pixel_range(low, high, 0.0, 10);
        assert_eq!(range(0.5, 2.5), (0, 3));
        assert_eq!(range(0.51, 2.49), (1, 2));
        assert_eq!(range(-5.0, 100.0), (0, 10));
        assert_eq!(range(f64::NEG_INFINITY, f64::INFINITY), (0, 10));
        assert_eq!(range(f64::NAN, 1.0), (0, 10));
        for (low, high) in [(1e300, 2e300), (-2e300, -1e300), (3.6, 4.4)] {
            let (first, after_last) = range(low, high);
            assert!(first >= after_last, "{low} to {high}");
        }
    }
}
