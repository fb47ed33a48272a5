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
        self.run(y, x, length)
    }

    /// The same of pixels that lie in the window: runs of its own part of a footprint.
    #[inline(always)]
    pub(crate) fn run(&mut self, y: u16, x: u16, length: u16) -> &mut [Pixel] {
        let first = self.window.first;
        let (row, column) = (y.wrapping_sub(first[1]), x.wrapping_sub(first[0]));
        let start = usize::from(row) * self.stride + usize::from(column);
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

#[cfg(test)]
mod tests {
    use super::cells::CellTarget;
    use super::*;
    use crate::blend::FINISHED;
    use crate::blend::surface::{Accumulation, Cell};
    use crate::format::Standard24;
    extern crate std;
    use std::{vec, vec::Vec};

    const WINDOW: Window = Window {
        first: [3, 5],
        end: [7, 8],
    };

    /// Every run of every row on and around the window: its own pixels, or none.
    #[test]
    fn rows_are_the_windows_own() {
        for (stride, short) in [(4, 1), (6, 1), (4, 12), (3, 0)] {
            let needed = 2 * stride + 4;
            // More than the window needs.
            let mut pixels: Vec<Pixel> = (0..(needed + stride) as u32)
                .map(|transmittance| Pixel {
                    colour: [0; 3],
                    transmittance,
                })
                .collect();
            if stride < 4 {
                assert!(Target::new(&mut pixels, WINDOW, stride).is_err());
                continue;
            }
            let lent = needed - short;
            let error = Target::new(&mut pixels[..lent], WINDOW, stride).unwrap_err();
            assert_eq!((error.needed, error.found), (needed, lent));
            let mut target = Target::new(&mut pixels, WINDOW, stride).unwrap();
            for (y, x, length) in runs() {
                let found = target.row(y, x, length).iter();
                let found: Vec<u32> = found.map(|pixel| pixel.transmittance).collect();
                let start =
                    (u32::from(y.wrapping_sub(5)) * stride as u32) + u32::from(x.wrapping_sub(3));
                let expected = if is_inside(y, x, length) {
                    (start..start + u32::from(length)).collect()
                } else {
                    vec![]
                };
                assert_eq!(found, expected, "{y} {x} {length}");
            }
        }
    }

    #[test]
    fn cells_are_the_windows_own() {
        let mut cells = vec![<Accumulation as Cell>::EMPTY; 16];
        let error = CellTarget::new(&mut cells[..11], WINDOW).unwrap_err();
        assert_eq!((error.needed, error.found), (12, 11));
        let mut target = CellTarget::new(&mut cells, WINDOW).unwrap();
        let start = target.row(5, 3, 1).as_ptr();
        for (y, x, length) in runs() {
            let found = target.row(y, x, length);
            if is_inside(y, x, length) {
                let offset = usize::from(y - 5) * 4 + usize::from(x - 3);
                assert_eq!(
                    (found.len(), found.as_ptr()),
                    (length.into(), start.wrapping_add(offset))
                );
            } else {
                assert!(found.is_empty(), "{y} {x} {length}");
            }
        }
    }

    fn runs() -> impl Iterator<Item = (u16, u16, u16)> {
        let places = (3..10).flat_map(|y| (1..10).map(move |x| (y, x)));
        places.flat_map(|(y, x)| (1..7).map(move |length| (y, x, length)))
    }

    fn is_inside(y: u16, x: u16, length: u16) -> bool {
        (5..8).contains(&y) && (x..x + length).all(|x| (3..7).contains(&x))
    }

    /// One pixel of the window that has not finished is enough; pixels between its rows do not count.
    #[test]
    fn a_window_has_finished_with_its_last_pixel() {
        let mut pixels = vec![Pixel::clear(&Standard24::WIDTHS); 16];
        for (row, column) in (0..3).flat_map(|row| (0..4).map(move |column| (row, column))) {
            pixels[6 * row + column].transmittance |= FINISHED;
        }
        // Of the same size, with more columns than rows before it.
        let aside = Window {
            first: [5, 3],
            end: [9, 6],
        };
        let finished = |pixels: &mut [Pixel]| {
            [WINDOW, aside].map(|window| Target::new(pixels, window, 6).unwrap().is_finished())
        };
        assert_eq!(finished(&mut pixels), [true; 2]);
        for place in (0..3).flat_map(|row| (0..4).map(move |column| 6 * row + column)) {
            let mut open = pixels.clone();
            open[place].transmittance &= !FINISHED;
            assert_eq!(finished(&mut open), [false; 2], "{place}");
        }
    }
}
