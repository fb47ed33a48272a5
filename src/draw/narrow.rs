//! "Over" by spans for designs whose pixel path fits 32-bit words: the loop of a processor without 64-bit arithmetic.
//!
//! The same arithmetic as [`Painter::draw`](super::Painter::draw) with [`Traversal::Spans`](crate::format::Traversal)
//! and [`Compositing::FrontToBack`](crate::rules::Compositing), bit for bit (`tests/all/narrow.rs`): the same rows, the
//! same opacity and compositing. What is left out is what such a loop cannot afford: counters, a choice of operator,
//! and look-ups that could miss the table.

use crate::blend::{Blend, Pixel};
use crate::draw::cutoff_in_lane;
use crate::footprint::Footprint;
use crate::format::{Design, Lane, Widths};
use crate::kernel::PackedTable;
use crate::raster::{EllipseSpans, Span, Spans, Window};
use crate::rules::Rules;
use crate::target::Target;

/// A painter with 32-bit lanes and a packed table.
///
/// A [`Renderer`](crate::Renderer) takes it by itself; this is how to drive it, and a pixel loop of one's own, stage by
/// stage:
///
/// ```
/// use splatline::draw::Painter32;
/// use splatline::kernel::{PackedTable, gaussian, pack};
/// use splatline::setup::setup_for_spans;
/// use splatline::target::Target;
/// use splatline::{Camera, Gaussian, Micro16, Pixel, Rules};
///
/// const TABLE: [u32; 129] = gaussian(&Micro16::WIDTHS, 4);
/// static WORDS: [u32; 128] = match pack(&TABLE, &Micro16::WIDTHS, 4) {
///     Ok(words) => words,
///     Err(_) => panic!("Micro16 has a packed table"),
/// };
/// let table = PackedTable::new(&WORDS, &Micro16::WIDTHS, 4).unwrap();
/// let painter = Painter32::new(Micro16, &Rules::GAUSSIAN_3D, table).unwrap();
///
/// let view = Camera::look_at([0.0, 0.0, -4.0], [0.0; 3], [0.0, -1.0, 0.0], 45.0, [32, 32]).unwrap().view().unwrap();
/// let splat = Gaussian::UNIT.splat().unwrap();
/// let footprint = setup_for_spans(Micro16, &view, &Rules::GAUSSIAN_3D, &splat).unwrap();
/// let mut pixels = [Pixel::clear(&Micro16::WIDTHS); 32 * 32];
/// let mut target = Target::new(&mut pixels, view.window(), 32).unwrap();
/// let mut runs = painter.runs(&footprint, &view.window()).unwrap();
/// while let Some(run) = runs.next_span() {
///     painter.paint(runs.with_pixels(run, &mut target)); // Or a loop of one's own.
/// }
/// assert!(pixels[16 * 32 + 16].transmittance() < 1 << 10);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Painter32<'a, D> {
    design: D,
    rules: &'a Rules,
    table: PackedTable<'a>,
    /// Does it draw pixels as [`Rules::GAUSSIAN_3D`] do? Those have a loop of their own, in which all constants of
    /// blending are known.
    usual: bool,
}

/// Why a design cannot be drawn with 32-bit words.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NarrowError {
    /// A product of the pixel path does not fit 32 bits, a sum may leave its word, or lanes have 64 bits.
    Products,
    /// The table was packed for other widths, or the rules' footprints reach its last interval, whose place the level
    /// one has.
    Table,
}

/// The radial indices of a run: three words of forward differencing that lead by [`PackedTable::lead`], and where the
/// footprint ends.
///
/// In this order in memory. Footprints of setup keep the indices of a run at 0 or above and within the word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(C)]
pub struct NarrowLanes {
    /// At the first pixel.
    pub radial: i32,
    /// Difference to the next pixel.
    pub first: i32,
    /// Difference of differences.
    pub second: i32,
    /// The largest index inside the footprint, before the table's end.
    pub last: i32,
}

/// Adjacent pixels of a row, and all that blending a footprint into them depends on: what a pixel loop gets.
#[derive(Debug)]
pub struct NarrowRun<'t, 'f> {
    /// The pixels, each with the lanes' next index; may be empty.
    pub pixels: &'t mut [Pixel],
    /// Their radial indices.
    pub lanes: NarrowLanes,
    /// Peak and colour are its.
    pub footprint: &'f Footprint,
    /// Can its opacity exceed the clamp? See [`Blend::is_clamped`].
    pub clamped: bool,
}

/// The runs of one footprint, row by row, for a pixel loop of the caller's: [`Painter32::runs`].
#[derive(Clone, Debug)]
pub struct NarrowRuns<'f, D: Design> {
    rows: EllipseSpans<D>,
    footprint: &'f Footprint,
    clamped: bool,
    lead: i32,
    last: i32,
}

impl<'f, D: Design> NarrowRuns<'f, D> {
    /// The next run, without its pixels.
    #[inline(always)]
    pub fn next_span(&mut self) -> Option<Span<D::Lane>> {
        self.rows.next_span()
    }

    /// A run with its pixels of the target: what the pixel loop gets.
    ///
    /// Not joined with [`next_span`](NarrowRuns::next_span): an `Option` of all this costs Cortex-M five instructions a
    /// run.
    #[inline(always)]
    pub fn with_pixels<'t>(&self, run: Span<D::Lane>, target: &'t mut Target) -> NarrowRun<'t, 'f> {
        self.of_pixels(run, target.row(run.y, run.x, run.length))
    }

    #[inline(always)]
    fn of_pixels<'t>(&self, run: Span<D::Lane>, pixels: &'t mut [Pixel]) -> NarrowRun<'t, 'f> {
        NarrowRun {
            pixels,
            lanes: NarrowLanes {
                radial: (run.radial.to_wide() as i32).wrapping_add(self.lead),
                first: run.first.to_wide() as i32,
                second: run.second.to_wide() as i32,
                last: self.last,
            },
            footprint: self.footprint,
            clamped: self.clamped,
        }
    }
}

impl<'a, D: Design> Painter32<'a, D> {
    /// A painter for one design, rule set and footprint table.
    #[inline(always)]
    pub fn new(design: D, rules: &'a Rules, table: PackedTable<'a>) -> Result<Self, NarrowError> {
        let widths = design.widths();
        if !Blend::new(&widths, rules).is_narrow() || D::Lane::BITS != 32 {
            return Err(NarrowError::Products);
        }
        let lead = PackedTable::lead(&widths, rules.table_range);
        let most = cutoff_in_lane(rules.end(), widths.radial) + u64::from(lead);
        if !table.is_for(&widths, rules.table_range) || most > table_end(&widths, rules) {
            return Err(NarrowError::Table);
        }
        Ok(Painter32 {
            design,
            rules,
            table,
            usual: rules.table_range == Rules::GAUSSIAN_3D.table_range
                && Blend::new(&widths, rules) == Blend::new(&widths, &Rules::GAUSSIAN_3D),
        })
    }

    /// Draws one footprint of [`setup`](crate::setup::setup) into the target's window. Footprints must come nearest
    /// first.
    ///
    /// At most as many steps as the window has pixels, plus one per row, whatever the footprint's bits.
    #[inline(always)]
    pub fn draw(self, footprint: &Footprint, target: &mut Target) {
        self.draw_with(footprint, target, |painter, run| painter.paint(run));
    }

    /// The same with a pixel loop of the caller's.
    #[inline(always)]
    pub fn draw_with(
        self,
        footprint: &Footprint,
        target: &mut Target,
        paint: impl Fn(Self, NarrowRun),
    ) {
        let Some(last) = self.last(footprint) else {
            return;
        };
        let mut runs = self.unplaced(last, footprint, &target.window());
        runs.rows.place();
        while let Some(run) = runs.next_span() {
            let pixels = target.run(run.y, run.x, run.length);
            paint(self, runs.of_pixels(run, pixels));
        }
    }

    /// The runs of one footprint in a window; `None` if no pixel can lie inside it.
    #[inline(always)]
    pub fn runs<'f>(self, footprint: &'f Footprint, window: &Window) -> Option<NarrowRuns<'f, D>> {
        let mut runs = self.unplaced(self.last(footprint)?, footprint, window);
        runs.rows.place();
        Some(runs)
    }

    /// The largest index inside a footprint, before the table's end.
    #[inline(always)]
    fn last(self, footprint: &Footprint) -> Option<i32> {
        let widths = self.design.widths();
        let lead = PackedTable::lead(&widths, self.rules.table_range);
        let end = cutoff_in_lane(footprint.cutoff, widths.radial);
        (end > 0)
            .then(|| (end - 1 + u64::from(lead)).min(table_end(&widths, self.rules) - 1) as i32)
    }

    /// The runs, the rows of which are still to be [placed](EllipseSpans::place).
    #[inline(always)]
    fn unplaced<'f>(
        self,
        last: i32,
        footprint: &'f Footprint,
        window: &Window,
    ) -> NarrowRuns<'f, D> {
        let widths = self.design.widths();
        let blend = Blend::new(&widths, self.rules);
        NarrowRuns {
            rows: EllipseSpans::unplaced(self.design, footprint, window),
            footprint,
            clamped: blend.is_clamped(footprint.opacity, widths.weight),
            lead: PackedTable::lead(&widths, self.rules.table_range) as i32,
            last,
        }
    }

    /// The pixel loop: the definition of what a loop of the caller's does with a run.
    #[inline(always)]
    pub fn paint(self, run: NarrowRun) {
        let (pixels, lanes, footprint) = (run.pixels, run.lanes, run.footprint);
        match (self.usual, run.clamped) {
            (true, false) => self.paint_as::<true, false>(pixels, lanes, footprint),
            (true, true) => self.paint_as::<true, true>(pixels, lanes, footprint),
            (false, false) => self.paint_as::<false, false>(pixels, lanes, footprint),
            (false, true) => self.paint_as::<false, true>(pixels, lanes, footprint),
        }
    }

    /// A function of its own, so that the loop has all registers, one for each way of clamping, and one for usual
    /// rules.
    #[inline(never)]
    fn paint_as<const USUAL: bool, const CLAMPED: bool>(
        self,
        pixels: &mut [Pixel],
        lanes: NarrowLanes,
        footprint: &Footprint,
    ) {
        let widths = self.design.widths();
        let rules = if USUAL {
            Rules::GAUSSIAN_3D
        } else {
            *self.rules
        };
        let blend = Blend::new(&widths, &rules);
        // Always: `new` has compared the table's width.
        let Some(table) = self.table.of_length(&widths) else {
            return;
        };
        let Footprint {
            opacity: peak,
            colour,
            ..
        } = *footprint;
        let NarrowLanes {
            mut radial,
            mut first,
            second,
            last,
        } = lanes;
        let blend_in = |pixel: &mut Pixel, radial: i32| {
            if is_left_out(radial, last, pixel) {
                return;
            }
            let weight = table.weight(radial as u32, &widths, rules.table_range);
            let alpha = if CLAMPED {
                blend.opacity(peak, weight)
            } else {
                blend.opacity_unclamped(peak, weight)
            };
            // Under usual rules an opacity of 0 takes nothing: a pixel that has not finished has more than the least
            // transmittance.
            if USUAL || alpha > 0 {
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

/// The radial index at which the table ends, UQ4.radial; a packed one's has at most 31 bits.
#[inline(always)]
fn table_end(widths: &Widths, rules: &Rules) -> u64 {
    1u64.wrapping_shl(u32::from(widths.radial) + u32::from(rules.table_range))
}

/// Outside the footprint, or finished: one look at two sign bits, or two where a branch compares by itself.
#[inline(always)]
fn is_left_out(radial: i32, last: i32, pixel: &Pixel) -> bool {
    if cfg!(target_arch = "riscv32") {
        last < radial || pixel.is_finished()
    } else {
        (last.wrapping_sub(radial) | pixel.transmittance as i32) < 0
    }
}
