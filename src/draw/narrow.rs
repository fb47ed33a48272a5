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

/// Why a design cannot be drawn with 32-bit words.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NarrowError {
    /// A product of the pixel path does not fit 32 bits, or a sum may leave its word.
    Products,
    /// The table was packed for other widths.
    Table,
}

/// A run whose radial indices lead by [`PackedTable::lead`].
#[derive(Clone, Copy, Debug)]
struct Lanes {
    radial: i32,
    first: i32,
    second: i32,
    /// The largest of them inside the footprint.
    last: i32,
}

impl<'a, D: Design<Lane = i32>, const N: usize> NarrowPainter<'a, D, N> {
    /// A painter for one design, rule set and footprint table.
    #[inline(always)]
    pub fn new(
        design: D,
        rules: &'a Rules,
        table: &'a PackedTable<N>,
    ) -> Result<Self, NarrowError> {
        let widths = design.widths();
        if !Blend::new(&widths, rules).is_narrow() {
            return Err(NarrowError::Products);
        }
        if !table.is_for(&widths) {
            return Err(NarrowError::Table);
        }
        Ok(NarrowPainter {
            design,
            rules,
            table,
        })
    }

    /// Draws one footprint of [`setup`](crate::setup::setup) into the target's window. Footprints must come nearest first.
    ///
    /// At most as many steps as the window has pixels, plus one per row, whatever the footprint's bits.
    #[inline(always)]
    pub fn draw(self, footprint: &Footprint, target: &mut Target) {
        let widths = self.design.widths();
        let lead = PackedTable::<N>::lead(&widths);
        let end = cutoff_in_lane(footprint.cutoff, widths.radial);
        if end == 0 {
            return;
        }
        let last = (end - 1 + u64::from(lead)).min(i32::MAX as u64) as i32;
        let blend = Blend::new(&widths, self.rules);
        let clamped = blend.is_clamped(footprint.peak, widths.weight);
        let mut rows = SpanRows::new(self.design, footprint, &target.window());
        while let Some(run) = rows.next_run() {
            let pixels = target.row(run.y, run.x, run.length);
            let lanes = Lanes {
                radial: run.radial.wrapping_add(lead as i32),
                first: run.first,
                second: run.second,
                last,
            };
            if clamped {
                self.paint::<true>(pixels, lanes, footprint);
            } else {
                self.paint::<false>(pixels, lanes, footprint);
            }
        }
    }

    /// The pixel loop: a function of its own, so that it has all registers, and one for each way of clamping.
    #[inline(never)]
    fn paint<const CLAMPED: bool>(self, pixels: &mut [Pixel], lanes: Lanes, footprint: &Footprint) {
        let widths = self.design.widths();
        let blend = Blend::new(&widths, self.rules);
        let Footprint { peak, colour, .. } = *footprint;
        let Lanes {
            mut radial,
            mut first,
            second,
            last,
        } = lanes;
        let blend_in = |pixel: &mut Pixel, radial: i32| {
            // Outside, or finished: one look at two sign bits.
            if (last.wrapping_sub(radial) | pixel.transmittance as i32) < 0 {
                return;
            }
            let weight = self.table.weight(radial as u32, widths.interpolation);
            let alpha = if CLAMPED {
                Some(blend.opacity(peak, weight)).filter(|alpha| *alpha > 0)
            } else {
                blend.opacity_unclamped(peak, weight)
            };
            if let Some(alpha) = alpha {
                blend.front_to_back_of_opacity(pixel, alpha, &colour);
            }
        };
        for pixel in pixels {
            blend_in(pixel, radial);
            radial = radial.wrapping_add(first);
            first = first.wrapping_add(second);
        }
    }
}
