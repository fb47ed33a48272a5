//! Where pixels go: a window of the screen over memory that the caller lends.

pub mod cells;

use crate::blend::Pixel;
use crate::format::Widths;
use crate::raster::Window;

/// A tile or a whole frame. Row `y` of the window begins at `(y - first row) * stride`.
#[derive(Debug)]
pub struct Target<'a> {
    pixels: &'a mut [Pixel],
    window: Window,
    stride: usize,
}

/// The memory lent is too small for the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct TargetError {
    /// Pixels needed.
    pub needed: usize,
    /// Pixels found.
    pub found: usize,
}

impl core::fmt::Display for TargetError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let TargetError { needed, found } = self;
        write!(f, "the window needs {needed} pixels, but {found} were lent")
    }
}

impl core::error::Error for TargetError {}

impl<'a> Target<'a> {
    /// A target for the pixels of `window`, rows `stride` pixels apart (at least the window's width).
    pub fn new(
        pixels: &'a mut [Pixel],
        window: Window,
        stride: usize,
    ) -> Result<Self, TargetError> {
        let columns = usize::from(window.end[0].saturating_sub(window.first[0]));
        let rows = usize::from(window.end[1].saturating_sub(window.first[1]));
        let needed = if rows == 0 {
            0
        } else {
            (rows - 1)
                .saturating_mul(stride.max(columns))
                .saturating_add(columns)
        };
        if stride < columns || pixels.len() < needed {
            return Err(TargetError {
                needed,
                found: pixels.len(),
            });
        }
        Ok(Target {
            pixels,
            window,
            stride,
        })
    }

    /// The pixels that the target holds.
    pub fn window(&self) -> Window {
        self.window
    }

    /// Makes every pixel transparent black.
    pub fn clear(&mut self, widths: &Widths) {
        self.pixels.fill(Pixel::clear(widths));
    }

    /// Pixels `x .. x + length` of row `y`; empty if any of them lies outside the window.
    #[inline(always)]
    pub fn row(&mut self, y: u16, x: u16, length: u16) -> &mut [Pixel] {
        let Window { first, end: last } = self.window;
        let end = u32::from(x) + u32::from(length);
        if y < first[1] || y >= last[1] || x < first[0] || end > u32::from(last[0]) {
            return &mut [];
        }
        let start = usize::from(y - first[1]) * self.stride + usize::from(x - first[0]);
        self.pixels
            .get_mut(start..start + usize::from(length))
            .unwrap_or_default()
    }

    /// Have all pixels of the window finished?
    pub fn is_finished(&mut self) -> bool {
        let Window { first, end: last } = self.window;
        let columns = last[0].saturating_sub(first[0]);
        (first[1]..last[1]).all(|y| {
            self.row(y, first[0], columns)
                .iter()
                .all(Pixel::is_finished)
        })
    }
}
