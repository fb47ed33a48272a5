//! Sheet buffers: splats of one slab of space are added, then the sheet is composited as one layer (\[EWA\] 4.1,
//! \[SWAN\] 3).
//!
//! Every-sample compositing puts overlapping kernels one behind the other, although they are samples of one function;
//! a sheet adds them first, as reconstruction asks. A sheet is a [`Target`] drawn with
//! [`Compositing::XRay`](crate::rules::Compositing::XRay): the sums are that unit's, and only laying the sheet over
//! the picture is new here. Slabs are either
//!
//! - axis-aligned ([`AxisSlabs`]): the slices of the volume most perpendicular to the view. All sheets change at once
//!   when another axis takes over at 45 degrees: the picture pops; or
//! - image-aligned ([`DepthSlabs`]): parallel to the image plane, by depth. Nothing switches, and a kernel may be cut
//!   into the slabs that it reaches ([`DepthSlabs::fraction_in`]), so that a splat changes slabs smoothly.
//!
//! All memory is the caller's: one sheet of the target's size.

mod slabs;

pub use slabs::{AxisSlabs, DepthSlabs, Facing, depth_spread};

use super::{Blend, FINISHED, Pixel};
use crate::format::Widths;
use crate::raster::Window;
use crate::target::{Target, TargetError};

/// One sheet over memory that the caller lends.
#[derive(Debug)]
pub struct SheetBuffer<'a> {
    target: Target<'a>,
    clear: Pixel,
}

impl<'a> SheetBuffer<'a> {
    /// An empty sheet for the pixels of `window`, rows `stride` pixels apart.
    pub fn new(
        pixels: &'a mut [Pixel],
        window: Window,
        stride: usize,
        widths: &Widths,
    ) -> Result<Self, TargetError> {
        let mut sheet = SheetBuffer::drawn(pixels, window, stride, widths)?;
        sheet.target.clear(widths);
        Ok(sheet)
    }

    /// A sheet that somebody has drawn already, as [`target`](Self::target) would have been drawn.
    pub fn drawn(
        pixels: &'a mut [Pixel],
        window: Window,
        stride: usize,
        widths: &Widths,
    ) -> Result<Self, TargetError> {
        Ok(SheetBuffer {
            target: Target::new(pixels, window, stride)?,
            clear: Pixel::clear(widths),
        })
    }

    /// Where to draw the slab's splats, by a painter that adds
    /// ([`Compositing::XRay`](crate::rules::Compositing::XRay)).
    ///
    /// Opacity saturates at 1 where a slab is denser than that; colour at its format's end.
    pub fn target(&mut self) -> &mut Target<'a> {
        &mut self.target
    }

    /// Lays the sheet behind what `into` holds and empties it; nearest slab first. Returns the pixels that it changed.
    pub fn composite_behind(&mut self, blend: &Blend, into: &mut Target) -> u64 {
        self.composite(into, |pixel, sheet| {
            if !pixel.is_finished() {
                blend.sheet_behind(pixel, sheet);
            }
        })
    }

    /// Lays the sheet over what `into` holds and empties it; farthest slab first. Returns the pixels that it changed.
    pub fn composite_over(&mut self, blend: &Blend, into: &mut Target) -> u64 {
        self.composite(into, |pixel, sheet| blend.sheet_over(pixel, sheet))
    }

    fn composite(&mut self, into: &mut Target, layer: impl Fn(&mut Pixel, &Pixel)) -> u64 {
        let window = self.target.window().intersect(&into.window());
        let [x, width] = [
            window.first[0],
            window.end[0].saturating_sub(window.first[0]),
        ];
        let mut changed = 0;
        for y in window.first[1]..window.end[1] {
            let sheet = self.target.row(y, x, width);
            for (pixel, sheet) in into.row(y, x, width).iter_mut().zip(sheet) {
                if *sheet != self.clear {
                    layer(pixel, sheet);
                    *sheet = self.clear;
                    changed += 1;
                }
            }
        }
        changed
    }
}

impl Blend {
    /// C' = C + T C_s, T' = T - T A_s for a sheet of colour C_s (UQ4.accumulator) and opacity A_s = 1 - T_s
    /// (UQ1.transmittance), nearest sheet first (\[EWA\] eq. 5 with a sheet for a splat).
    ///
    /// Rounded by the design; the end of a pixel is as in [`front_to_back`](Self::front_to_back). Colour saturates.
    #[inline(always)]
    pub fn sheet_behind(&self, pixel: &mut Pixel, sheet: &Pixel) {
        let behind = pixel.transmittance();
        let rest = behind.saturating_sub(self.part(behind, self.opacity_of_sheet(sheet)));
        let stop = rest <= self.minimum_transmittance;
        if stop && self.omit_finishing {
            pixel.transmittance |= FINISHED;
            return;
        }
        for (sum, c) in pixel.colour.iter_mut().zip(sheet.colour) {
            *sum = sum.saturating_add(self.part(c, behind));
        }
        pixel.transmittance = if stop { rest | FINISHED } else { rest };
    }

    /// C' = C - A_s C + C_s, T' = T - A_s T: the sheet in front, farthest sheet first. Formats as in
    /// [`sheet_behind`](Self::sheet_behind).
    #[inline(always)]
    pub fn sheet_over(&self, pixel: &mut Pixel, sheet: &Pixel) {
        let opacity = self.opacity_of_sheet(sheet);
        for (sum, c) in pixel.colour.iter_mut().zip(sheet.colour) {
            *sum = sum
                .saturating_sub(self.part(*sum, opacity))
                .saturating_add(c);
        }
        let behind = pixel.transmittance();
        pixel.transmittance = behind.saturating_sub(self.part(behind, opacity));
    }

    /// A_s = 1 - T_s, UQ1.transmittance.
    #[inline(always)]
    fn opacity_of_sheet(&self, sheet: &Pixel) -> u32 {
        (1u32 << self.transmittance_bits()).saturating_sub(sheet.transmittance())
    }

    /// `value` times a share in UQ1.transmittance, in the format of `value`.
    #[inline(always)]
    fn part(&self, value: u32, share: u32) -> u32 {
        self.shift(
            u64::from(value) * u64::from(share),
            self.transmittance_bits(),
        ) as u32
    }
}

#[cfg(test)]
mod tests;
