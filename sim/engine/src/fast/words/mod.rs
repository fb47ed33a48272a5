//! Painting tiles along runs: in single precision where a design and a processor allow it, on 64-bit words elsewhere.
//!
//! A footprint's rows are computed first, several in a vector ([`rows`](super::rows)), and then the pixels of each run.
//! Where nobody asks how many pixels were covered, finished ones are left out before any work: every
//! [`CHECK_INTERVAL`](super::CHECK_INTERVAL) footprints the tile is looked at, footprints are cut to the smallest
//! window around what is still in work, and runs to their last pixel that is. The kernel's rows know no windows, so
//! that this moves no bit of a picture.

mod live;
pub(super) mod numbers;
mod painting;
pub(super) mod path;
mod single;
pub mod tile;
pub mod visit;

use super::lanes::{Lanes, VectorLevel, VectorTask, dispatch_pixels, draws_pixels};
use super::painter::{CHECK_INTERVAL, PaintScratch, Results, ScalarPainter, TilePainter, TileWork};
use super::setup::Outcome;
use numbers::{ANY, BACK_TO_FRONT, DRAW_FINISHING, LAYERS, OMIT_FINISHING, PathNumbers, X_RAY};
use painting::{PaintAlone, Painting};
use path::WordPixels;
use single::{SingleNumbers, SinglePixels};
use splatline::blend::Pixel;
use splatline::draw::Coverage;
use splatline::format::{Design, Lane, Traversal};
use splatline::rules::{Compositing, Rules};
use tile::{PixelWord, WordTile};

/// Paints tiles along runs.
#[derive(Clone, Debug)]
pub struct WordPainter<D> {
    /// For what vectors cannot do.
    kernel: ScalarPainter<D>,
    numbers: PathNumbers,
    single: Option<SingleNumbers>,
    choice: VectorLevel,
    counts: bool,
}

impl<D: Design> WordPainter<D> {
    /// A painter for a design and rules, of lists in this order; `None` where only the kernel's can. Pixels are counted
    /// if `counts` asks for it.
    pub fn new(
        design: D,
        rules: &Rules,
        order: Compositing,
        choice: VectorLevel,
        counts: bool,
    ) -> Option<Self> {
        if !draws_pixels(choice) {
            return None;
        }
        let widths = design.widths();
        let kernel = ScalarPainter::new(design, rules, order, Traversal::Spans);
        let numbers = PathNumbers::new(&kernel.table, D::Lane::BITS)?;
        let numbers = numbers.in_order(order, widths.rounding)?;
        let table = kernel.table.table();
        let single = SingleNumbers::new(&widths, rules, table.entries(), D::Lane::BITS);
        let single = single.filter(|_| order == Compositing::FrontToBack);
        Some(WordPainter {
            kernel,
            numbers,
            single,
            choice,
            counts,
        })
    }

    /// Eight words to a vector where runs are long, four where they are short: a vector costs the same however little
    /// of it a run covers.
    fn level(&self, footprints: &Results, list: &[u32]) -> VectorLevel {
        let first = list.iter().take(CHECK_INTERVAL);
        // A footprint's longest run grows as the root of 1 / A. Below 2, nine pixels by the largest cut-off, vectors of
        // eight took longer (a volume of small splats back to front 72 ms, of four 66).
        let (mut sum, mut count) = (0, 0);
        for footprint in first.flat_map(|index| &footprints[*index as usize]) {
            sum += footprint.ldl.squared_width.leading().clamp(-32, 32);
            count += 1;
        }
        match self.choice {
            VectorLevel::Best if sum < count => VectorLevel::Avx2,
            choice => choice,
        }
    }

    /// The kernel's painter on the tile's pixels.
    #[cold]
    #[inline(never)]
    fn paint_scalar<W: PixelWord>(&self, footprint: &Outcome, tile: &mut WordTile<W>) -> Coverage {
        let mut pixels = tile.to_pixels();
        let coverage = (self.kernel).paint_alone(footprint, tile.window(), &mut pixels);
        tile.set_pixels(&pixels);
        coverage
    }
}

impl<D: Design + Send + Sync> WordPainter<D> {
    /// Paints a tile by words that have such numbers; `None`, and pixels as they were, where these vectors do not, or
    /// the words do not hold a sum.
    fn paint_in<W: PixelWord, N>(
        &self,
        (numbers, level): (&N, VectorLevel),
        tile: &mut WordTile<W>,
        work: &mut TileWork,
    ) -> Option<Coverage>
    where
        for<'a> TilePainting<'a, W, N>: VectorTask<Output = Coverage>,
    {
        let (footprints, widths) = (work.footprints, self.kernel.design.widths());
        tile.start(work.window, Pixel::clear(&widths), work.start, work.pixels);
        // Colours beyond their format, drawn by the kernel, make sums beyond theirs: 64-bit words hold them.
        if tile.has_overflowed() {
            return None;
        }
        let task = TilePainting {
            painting: Painting {
                numbers: &self.numbers,
                footprints,
                list: work.list,
                start: work.start,
                counts: self.counts,
            },
            numbers,
            scalar: &|index, tile| self.paint_scalar(&footprints[index as usize], tile),
            tile,
        };
        let coverage = dispatch_pixels(level, task).ok()?;
        if tile.has_overflowed() {
            return None;
        }
        tile.copy(work.pixels);
        Some(coverage)
    }
}

impl<D: Design + Send + Sync> TilePainter for WordPainter<D> {
    fn paint(&self, scratch: &mut PaintScratch, mut work: TileWork) -> Coverage {
        let in_singles = self.single.as_ref().and_then(|numbers| {
            let tile = scratch.singles.get_or_insert_default();
            self.paint_in((numbers, self.choice), tile, &mut work)
        });
        let painted = in_singles.or_else(|| {
            let level = self.level(work.footprints, work.list);
            let tile = scratch.words.get_or_insert_default();
            self.paint_in((&self.numbers, level), tile, &mut work)
        });
        match painted {
            Some(coverage) if self.counts => coverage,
            Some(_) => Coverage::default(),
            None => unreachable!(
                "64-bit words hold all sums, and vectors were there when they were chosen"
            ),
        }
    }
}

/// A tile to be painted by words that have such numbers.
struct TilePainting<'a, W: PixelWord, N> {
    painting: Painting<'a>,
    numbers: &'a N,
    scalar: &'a PaintAlone<'a, W>,
    tile: &'a mut WordTile<W>,
}

impl VectorTask for TilePainting<'_, i64, PathNumbers> {
    type Output = Coverage;

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) -> Coverage {
        match self.numbers.operator {
            OMIT_FINISHING => self.paint::<L, OMIT_FINISHING>(lanes),
            DRAW_FINISHING => self.paint::<L, DRAW_FINISHING>(lanes),
            BACK_TO_FRONT | X_RAY => self.paint::<L, LAYERS>(lanes),
            _ => self.paint::<L, ANY>(lanes),
        }
    }
}

impl TilePainting<'_, i64, PathNumbers> {
    #[inline(always)]
    fn paint<L: Lanes, const OPERATOR: u8>(self, lanes: L) -> Coverage {
        let path = WordPixels::<L, OPERATOR>::new(lanes, self.numbers);
        self.painting.paint(lanes, &path, self.scalar, self.tile)
    }
}

impl VectorTask for TilePainting<'_, f32, SingleNumbers> {
    type Output = Coverage;

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) -> Coverage {
        if self.painting.numbers.operator & OMIT_FINISHING != 0 {
            self.paint::<L, OMIT_FINISHING>(lanes)
        } else {
            self.paint::<L, DRAW_FINISHING>(lanes)
        }
    }
}

impl TilePainting<'_, f32, SingleNumbers> {
    #[inline(always)]
    fn paint<L: Lanes, const OPERATOR: u8>(self, lanes: L) -> Coverage {
        let path = SinglePixels::<_, OPERATOR>::new(lanes.singles(), self.numbers);
        self.painting.paint(lanes, &path, self.scalar, self.tile)
    }
}
