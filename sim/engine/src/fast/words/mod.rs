//! Painting tiles along runs: in single precision where a design and a processor allow it, on 64-bit words elsewhere.
//!
//! A footprint's rows are computed first, several in a vector ([`rows`](super::rows)), and then the pixels of each run. Where nobody asks how many pixels were
//! covered, finished ones are left out before any work: every [`CHECK_INTERVAL`] footprints the tile is looked at, footprints are cut to the smallest window around what is
//! still in work, and runs to their first and last pixel that is. The kernel's rows know no windows, so that this moves no bit of a picture.

pub(super) mod path;
mod single;
pub mod tile;
pub mod visit;

use super::TILE;
use super::lanes::sums::PixelSums;
use super::lanes::{Doubles, PixelTask, VectorLevel, VectorTask};
use super::lanes::{dispatch_pixels, dispatch_vectors, prefetch};
use super::painter::{CHECK_INTERVAL, PaintScratch, Results, Start, TableMemory, TilePainter};
use super::row_group::RowGroup;
use super::rows::{RowBatch, RunWords};
use super::setup::number::Arithmetic;
use path::{BACK_TO_FRONT, DRAW_FINISHING, EVEN, OMIT_FINISHING, PathNumbers, PixelPath};
use path::{Pixels, SplatNumbers, WordPixels, X_RAY};
use single::{SingleNumbers, SinglePixels};
use splatline::blend::Pixel;
use splatline::draw::{Coverage, Painter};
use splatline::footprint::Footprint;
use splatline::format::{Design, Lane, Traversal, Widths};
use splatline::raster::{EllipseSpans, RowConstants, Window};
use splatline::rules::{Compositing, Rules};
use splatline::target::Target;
use tile::{PixelWord, WordTile};

/// How many footprints ahead memory is asked for: lists name them in an order that no cache foresees.
pub(super) const AHEAD: usize = 4;

/// Paints tiles along runs.
#[derive(Clone, Debug)]
pub struct WordPainter<D> {
    design: D,
    rules: Rules,
    order: Compositing,
    table: TableMemory,
    numbers: PathNumbers,
    single: Option<SingleNumbers>,
    choice: VectorLevel,
    counts: bool,
}

impl<D: Design> WordPainter<D> {
    /// A painter for a design and rules, of lists in this order; `None` where only the kernel's can. Pixels are counted if `counts` asks for it.
    pub fn new(
        design: D,
        rules: &Rules,
        order: Compositing,
        choice: VectorLevel,
        counts: bool,
    ) -> Option<Self> {
        let widths = design.widths();
        let table = TableMemory::new(&widths, rules);
        let numbers = PathNumbers::new(&widths, rules, &table.table(), D::Lane::BITS)?;
        let numbers = numbers.in_order(order, widths.rounding)?;
        let single = SingleNumbers::new(&widths, rules, table.table().entries(), D::Lane::BITS);
        let single = single.filter(|_| order == Compositing::FrontToBack);
        Some(WordPainter {
            design,
            rules: *rules,
            order,
            table,
            numbers,
            single,
            choice,
            counts,
        })
    }

    /// What a footprint is computed from within the window.
    #[cold]
    fn prepare(
        &self,
        footprints: &Results,
        index: u32,
        window: &Window,
        place: &mut RowConstants<i64>,
    ) -> PreparedFootprint {
        let Ok(footprint) = &footprints[index as usize] else {
            return PreparedFootprint::Nothing;
        };
        let bounds = Window::of(footprint);
        if bounds.intersect(window).is_empty() {
            return PreparedFootprint::Nothing;
        }
        let rows = EllipseSpans::new(self.design, footprint, window);
        match splat_numbers(&self.numbers, self.single.as_ref(), footprint) {
            Some(splat) => {
                *place = rows.constants().widened();
                PreparedFootprint::Rows(splat)
            }
            None => PreparedFootprint::Scalar,
        }
    }

    /// The kernel's painter on the tile's pixels.
    #[cold]
    #[inline(never)]
    fn paint_scalar<W: PixelWord>(
        &self,
        footprints: &Results,
        index: u32,
        tile: &mut WordTile<W>,
    ) -> Coverage {
        let (table, order) = (self.table.table(), self.order);
        let painter = Painter::new(self.design, &self.rules, table, order, Traversal::Spans);
        let mut pixels = tile.to_pixels();
        let window = tile.window();
        let stride = usize::from(window.end[0] - window.first[0]);
        let target = Target::new(&mut pixels, window, stride);
        let (Ok(footprint), Ok(mut target)) = (&footprints[index as usize], target) else {
            return Coverage::default();
        };
        let coverage = painter.draw(footprint, &mut target);
        tile.set_pixels(&pixels);
        coverage
    }
}

impl<D: Design + Send + Sync> TilePainter for WordPainter<D> {
    fn paint(
        &self,
        scratch: &mut PaintScratch,
        window: Window,
        footprints: &Results,
        list: &[u32],
        start: Start,
        pixels: &mut [Pixel],
    ) -> Coverage {
        let clear = Pixel::clear(&self.design.widths());
        let painting = Painting {
            widths: self.design.widths(),
            numbers: &self.numbers,
            single: self.single.as_ref(),
            prepare: &|index, window, rows| self.prepare(footprints, index, window, rows),
            footprints,
            list,
            start,
            counts: self.counts,
        };
        let in_singles = self.single.as_ref().and_then(|numbers| {
            let tile = scratch.singles.get_or_insert_with(WordTile::new);
            tile.start(window, clear, start, pixels);
            // Colours beyond their format, drawn by the kernel, make sums beyond theirs: 64-bit words hold them.
            if tile.has_overflowed() {
                return None;
            }
            let task = SinglePainting {
                painting,
                numbers,
                scalar: &|index, tile| self.paint_scalar(footprints, index, tile),
                tile,
            };
            let coverage = dispatch_vectors(self.choice, task).ok()?;
            if tile.has_overflowed() {
                return None;
            }
            tile.copy(pixels);
            Some(coverage)
        });
        let coverage = in_singles.unwrap_or_else(|| {
            let tile = scratch.words.get_or_insert_with(WordTile::new);
            tile.start(window, clear, start, pixels);
            let task = WordPainting {
                painting,
                numbers: &self.numbers,
                scalar: &|index, tile| self.paint_scalar(footprints, index, tile),
                tile,
            };
            let coverage = dispatch_pixels(self.choice, task);
            tile.copy(pixels);
            coverage
        });
        if self.counts {
            coverage
        } else {
            Coverage::default()
        }
    }
}

/// What is drawn of a footprint.
enum PreparedFootprint {
    /// Nothing of it lies in the window.
    Nothing,
    /// By the kernel's painter.
    Scalar,
    /// By vectors, from these numbers and the constants of its rows, which are left in memory that serves all.
    Rows(SplatNumbers),
}

/// Prepares a footprint for a window by itself, and leaves the constants of its rows in the place given.
type Prepare<'a> = dyn Fn(u32, &Window, &mut RowConstants<i64>) -> PreparedFootprint + 'a;

/// What a footprint's pixels need beside its rows; `None` if it lies outside its formats.
#[inline(always)]
fn splat_numbers(
    numbers: &PathNumbers,
    single: Option<&SingleNumbers>,
    footprint: &Footprint,
) -> Option<SplatNumbers> {
    let splat = numbers.splat(footprint)?;
    single
        .is_none_or(|single| single.fits(&splat))
        .then_some(splat)
}

/// A tile to be painted, by whatever vectors. It knows a design only by its numbers, so that one compiled copy serves all.
#[derive(Clone, Copy)]
struct Painting<'a> {
    widths: Widths,
    numbers: &'a PathNumbers,
    single: Option<&'a SingleNumbers>,
    prepare: &'a Prepare<'a>,
    footprints: &'a Results,
    list: &'a [u32],
    start: Start,
    counts: bool,
}

/// Paints the footprint of this number by the kernel.
type PaintAlone<'a, W> = dyn Fn(u32, &mut WordTile<W>) -> Coverage + 'a;

/// On 64-bit words.
struct WordPainting<'a> {
    painting: Painting<'a>,
    numbers: &'a PathNumbers,
    scalar: &'a PaintAlone<'a, u64>,
    tile: &'a mut WordTile<u64>,
}

impl PixelTask for WordPainting<'_> {
    type Output = Coverage;

    #[inline(always)]
    fn run<L: PixelSums>(self, lanes: L) -> Coverage {
        const EVEN_OMIT_FINISHING: u8 = EVEN | OMIT_FINISHING;
        const EVEN_BACK_TO_FRONT: u8 = EVEN | BACK_TO_FRONT;
        const EVEN_X_RAY: u8 = EVEN | X_RAY;
        match self.painting.numbers.operator {
            OMIT_FINISHING => self.paint::<L, OMIT_FINISHING>(lanes),
            BACK_TO_FRONT => self.paint::<L, BACK_TO_FRONT>(lanes),
            X_RAY => self.paint::<L, X_RAY>(lanes),
            EVEN_OMIT_FINISHING => self.paint::<L, EVEN_OMIT_FINISHING>(lanes),
            EVEN_BACK_TO_FRONT => self.paint::<L, EVEN_BACK_TO_FRONT>(lanes),
            EVEN_X_RAY => self.paint::<L, EVEN_X_RAY>(lanes),
            EVEN => self.paint::<L, EVEN>(lanes),
            _ => self.paint::<L, DRAW_FINISHING>(lanes),
        }
    }
}

impl WordPainting<'_> {
    #[inline(always)]
    fn paint<L: PixelSums, const OPERATOR: u8>(self, lanes: L) -> Coverage {
        let path = WordPixels::<L, OPERATOR>::new(lanes, self.numbers);
        self.painting.paint(lanes, &path, self.scalar, self.tile)
    }
}

/// In single precision.
struct SinglePainting<'a> {
    painting: Painting<'a>,
    numbers: &'a SingleNumbers,
    scalar: &'a PaintAlone<'a, f32>,
    tile: &'a mut WordTile<f32>,
}

impl VectorTask for SinglePainting<'_> {
    type Output = Coverage;

    #[inline(always)]
    fn run<L: Doubles>(self, lanes: L) -> Coverage {
        if self.painting.numbers.operator == EVEN | OMIT_FINISHING {
            self.paint::<L, OMIT_FINISHING>(lanes)
        } else {
            self.paint::<L, DRAW_FINISHING>(lanes)
        }
    }
}

impl SinglePainting<'_> {
    #[inline(always)]
    fn paint<L: Doubles, const OPERATOR: u8>(self, lanes: L) -> Coverage {
        let path = SinglePixels::<_, OPERATOR>::new(lanes.singles(), self.numbers);
        self.painting.paint(lanes, &path, self.scalar, self.tile)
    }
}

impl Painting<'_> {
    #[inline(always)]
    fn paint<L: Doubles, P: PixelPath>(
        self,
        lanes: L,
        path: &P,
        scalar: &PaintAlone<P::Word>,
        tile: &mut WordTile<P::Word>,
    ) -> Coverage {
        let Painting {
            prepare,
            list,
            start,
            counts,
            ..
        } = self;
        let math = Arithmetic { lanes };
        let (mut batch, mut rows) = (RowBatch::new(), RowConstants::default());
        let (mut group, widths) = (RowGroup::default(), self.widths);
        let mut coverage = Coverage::default();
        let mut window = tile.window();
        let [left, top] = window.first;
        if start == Start::Resumed && !counts {
            tile.look(|row| path.finished(row));
            match tile.live_window() {
                Some(live) => window = live,
                None => return coverage,
            }
        }
        for (number, part) in list.chunks(CHECK_INTERVAL).enumerate() {
            let (seen, count) = self.seen(part, tile);
            let next = list.chunks(CHECK_INTERVAL).nth(number + 1);
            let mut ahead = next.unwrap_or_default().iter();
            for indices in seen[..count].chunks(L::WIDE) {
                // The next part's footprints, two for each of these, of which some were left out.
                for index in ahead.by_ref().take(2 * L::WIDE) {
                    prefetch(&self.footprints[*index as usize]);
                }
                for (k, index) in indices.iter().enumerate() {
                    if let Ok(footprint) = &self.footprints[*index as usize] {
                        group.read(k, footprint, &window);
                    }
                }
                let together = group.compute(math, &widths);
                for (k, index) in indices.iter().enumerate() {
                    if group.member(k).is_empty() {
                        continue;
                    }
                    let splat = self.footprints[*index as usize].as_ref().ok();
                    let splat = splat.and_then(|f| splat_numbers(self.numbers, self.single, f));
                    let (splat, first, second) = match splat {
                        Some(splat) if batch.fill_member(&together, &group, k, left) => {
                            (splat, group.member(k).rows[0], group.second(k))
                        }
                        _ => match prepare(*index, &window, &mut rows) {
                            PreparedFootprint::Nothing => continue,
                            PreparedFootprint::Rows(splat) if batch.fill(lanes, &rows, left) => {
                                (splat, rows.rows[0], rows.second)
                            }
                            _ => {
                                coverage += scalar(*index, tile);
                                continue;
                            }
                        },
                    };
                    let splat = path.splat(&splat, second);
                    let first = usize::from(first.wrapping_sub(top));
                    for block in batch.touched() {
                        let runs = batch.block(block);
                        for row in 0..batch.rows() {
                            let Some(run) = runs.run(row) else { continue };
                            let run = columns(&run, left);
                            let (pixels, live) = tile.row(first + row);
                            if counts {
                                coverage.visited += run.length as u64;
                                path.paint::<true>(&splat, &run, pixels, &mut coverage);
                            } else if let Some(run) = cut(run, live, second) {
                                path.paint::<false>(&splat, &run, pixels, &mut coverage);
                            }
                        }
                    }
                }
            }
            if counts {
                if tile.is_finished() {
                    break;
                }
                continue;
            }
            tile.look(|row| path.finished(row));
            match tile.live_window() {
                Some(live) => window = live,
                None => break,
            }
        }
        coverage
    }

    /// Those of a part that finished pixels do not hide, and how many: nothing is computed of the others.
    #[inline(always)]
    fn seen<W: PixelWord>(
        &self,
        part: &[u32],
        tile: &WordTile<W>,
    ) -> ([u32; CHECK_INTERVAL], usize) {
        let (mut seen, mut count) = ([0; CHECK_INTERVAL], 0);
        for index in part {
            if let Ok(footprint) = &self.footprints[*index as usize]
                && tile.is_live(&Window::of(footprint))
            {
                // A part has no more than so many.
                seen[count % CHECK_INTERVAL] = *index;
                count += 1;
            }
        }
        (seen, count)
    }
}

/// A run in columns of the tile that begins at column `left`.
#[inline(always)]
pub(super) fn columns(run: &RunWords, left: u16) -> Pixels {
    Pixels {
        x: (run.x - i64::from(left)) as usize % usize::from(TILE[0]),
        length: (run.end - run.x) as usize,
        radial: run.radial,
        first: run.first,
    }
}

/// The run from its first to its last pixel in work; `None` if it has none.
#[inline(always)]
fn cut(run: Pixels, live: u64, second: i64) -> Option<Pixels> {
    // At most a block.
    let of_run = live >> run.x & ((1 << (run.length % 64)) - 1);
    if of_run == 0 {
        return None;
    }
    let head = of_run.trailing_zeros() as usize;
    let length = 64 - of_run.leading_zeros() as usize;
    let run = Pixels { length, ..run };
    Some(if head == 0 {
        run
    } else {
        run.skip(head, second)
    })
}
