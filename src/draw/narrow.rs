//! "Over" by spans for designs whose pixel path fits 32-bit words: the loop of a processor without 64-bit arithmetic.
//!
//! The same arithmetic as [`Painter::draw`](super::Painter::draw) with [`Traversal::Spans`](crate::format::Traversal) and
//! [`Compositing::FrontToBack`](crate::rules::Compositing), bit for bit (`tests/narrow.rs`): the same rows, the same opacity and compositing.
//! What is left out is what such a loop cannot afford: counters, a choice of operator, and look-ups that could miss the table.

use crate::blend::{Blend, Pixel};
use crate::draw::cutoff_in_lane;
use crate::footprint::Footprint;
use crate::format::Design;
use crate::kernel::PackedTable;
use crate::raster::{Rows, SpanRows};
use crate::rules::Rules;
use crate::target::Target;

/// A painter with 32-bit lanes and a packed table of `N` intervals.
#[derive(Clone, Copy, Debug)]
pub struct NarrowPainter<'a, D, const N: usize> {
    design: D,
    rules: &'a Rules,
    table: &'a PackedTable<N>,
}

/// A product of the design's pixel path does not fit 32 bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NarrowError;

impl<'a, D: Design<Lane = i32>, const N: usize> NarrowPainter<'a, D, N> {
    /// A painter for one design, rule set and footprint table.
    #[inline(always)]
    pub fn new(
        design: D,
        rules: &'a Rules,
        table: &'a PackedTable<N>,
    ) -> Result<Self, NarrowError> {
        if !Blend::new(&design.widths(), rules).is_narrow() {
            return Err(NarrowError);
        }
        Ok(NarrowPainter {
            design,
            rules,
            table,
        })
    }

    /// Draws one footprint into the target's window. Footprints must come nearest first.
    #[inline(always)]
    pub fn draw(self, footprint: &Footprint, target: &mut Target) {
        let widths = self.design.widths();
        let end = cutoff_in_lane(footprint.cutoff, widths.radial);
        let bias = 1 << (31 - u32::from(widths.table) - u32::from(widths.interpolation));
        let last = end.min(i32::MAX as u64) as i32 - 1 + bias;
        let mut rows = SpanRows::new(self.design, footprint, &target.window());
        while let Some(run) = rows.next_run() {
            let pixels = target.row(run.y, run.x, run.length);
            self.paint(pixels, run.radial.wrapping_add(bias), run.first, run.second, last, footprint);
        }
    }

    /// The pixel loop: a function of its own, so that it has all registers.
    #[inline(never)]
    fn paint(
        self,
        pixels: &mut [Pixel],
        mut radial: i32,
        mut first: i32,
        second: i32,
        last: i32,
        footprint: &Footprint,
    ) {
        let widths = self.design.widths();
        let blend = Blend::new(&widths, self.rules);
        let Footprint { peak, colour, .. } = *footprint;
        for pixel in pixels {
            let here = radial.max(0);
            if last.wrapping_sub(here) | pixel.transmittance as i32 >= 0 {
                let weight = self.table.weight(here as u32, widths.interpolation);
                if let Some(alpha) = blend.opacity_unclamped(peak, weight) {
                    blend.front_to_back(pixel, alpha, &colour);
                }
            }
            radial = radial.wrapping_add(first);
            first = first.wrapping_add(second);
        }
    }
}
