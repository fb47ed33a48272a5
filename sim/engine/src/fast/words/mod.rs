//! Painting tiles on 64-bit words: the way of processors without fused products, in any design.
//!
//! A footprint's rows are computed first, several in a vector ([`rows`](super::rows)), and then the pixels of each run. Where nobody asks how many pixels were
//! covered, finished ones are left out before any work: every [`CHECK_INTERVAL`] footprints the tile is looked at, footprints are cut to the smallest window around what is
//! still in work, and runs to their first and last pixel that is. The kernel's rows know no windows, so that this moves no bit of a picture.

pub(super) mod path;
pub mod tile;
pub mod visit;

use super::TILE;
use super::lanes::sums::PixelSums;
use super::lanes::words::PixelWords;
use super::lanes::{PixelTask, VectorLevel, dispatch_pixels, prefetch};
use super::painter::{CHECK_INTERVAL, PaintScratch, Results, TableMemory, TilePainter};
use super::rows::{RowBatch, RunWords};
use path::{BACK_TO_FRONT, DRAW_FINISHING, OMIT_FINISHING, PathNumbers, Pixels, SplatNumbers};
use path::{WordPixels, X_RAY};
use splatline::blend::Pixel;
use splatline::draw::{Coverage, Painter};
use splatline::format::{Design, Lane, Traversal};
use splatline::raster::{EllipseSpans, RowConstants, Window};
use splatline::rules::{Compositing, Rules};
use splatline::target::Target;
use tile::WordTile;

/// How many footprints ahead memory is asked for: lists name them in an order that no cache foresees.
pub(super) const AHEAD: usize = 4;

/// Paints tiles on 64-bit words.
#[derive(Clone, Debug)]
pub struct WordPainter<D> {
    design: D,
    rules: Rules,
    order: Compositing,
    table: TableMemory,
    numbers: PathNumbers,
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
        Some(WordPainter {
            design,
            rules: *rules,
            order,
            table,
            numbers,
            choice,
            counts,
        })
    }

    /// What the list's first footprint is computed from within the window.
    fn prepare(&self, footprints: &Results, list: &[u32], window: &Window) -> PreparedFootprint {
        let footprint = |index: &u32| &footprints[*index as usize];
        if let Some(next) = list.get(AHEAD) {
            prefetch(footprint(next));
        }
        let Some(Ok(footprint)) = list.first().map(footprint) else {
            return PreparedFootprint::Nothing;
        };
        let bounds = Window::of(footprint);
        if bounds.intersect(window).is_empty() {
            return PreparedFootprint::Nothing;
        }
        let rows = EllipseSpans::new(self.design, footprint, window);
        match self.numbers.splat(footprint) {
            Some(splat) => PreparedFootprint::Rows(rows.constants().widened(), splat),
            None => PreparedFootprint::Scalar,
        }
    }

    /// The kernel's painter on the tile's pixels.
    #[cold]
    #[inline(never)]
    fn paint_scalar(&self, footprints: &Results, index: u32, tile: &mut WordTile) -> Coverage {
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
        pixels: &mut [Pixel],
    ) -> Coverage {
        let tile = scratch.words.get_or_insert_with(WordTile::new);
        tile.open(window, Pixel::clear(&self.design.widths()));
        let task = WordPainting {
            numbers: &self.numbers,
            prepare: &|list, window| self.prepare(footprints, list, window),
            scalar: &|index, tile| self.paint_scalar(footprints, index, tile),
            tile,
            list,
            counts: self.counts,
        };
        let coverage = dispatch_pixels(self.choice, task);
        tile.copy(pixels);
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
    /// By vectors.
    Rows(RowConstants<i64>, SplatNumbers),
}

/// A tile to be painted, by whatever vectors. It knows a design only by its numbers, so that one compiled copy serves all.
struct WordPainting<'a> {
    numbers: &'a PathNumbers,
    prepare: &'a dyn Fn(&[u32], &Window) -> PreparedFootprint,
    /// Paints the footprint of this number by the kernel.
    scalar: &'a dyn Fn(u32, &mut WordTile) -> Coverage,
    tile: &'a mut WordTile,
    list: &'a [u32],
    counts: bool,
}

impl PixelTask for WordPainting<'_> {
    type Output = Coverage;

    #[inline(always)]
    fn run<L: PixelSums>(self, lanes: L) -> Coverage {
        match self.numbers.operator {
            OMIT_FINISHING => self.paint::<L, OMIT_FINISHING>(lanes),
            BACK_TO_FRONT => self.paint::<L, BACK_TO_FRONT>(lanes),
            X_RAY => self.paint::<L, X_RAY>(lanes),
            _ => self.paint::<L, DRAW_FINISHING>(lanes),
        }
    }
}

impl WordPainting<'_> {
    #[inline(always)]
    fn paint<L: PixelWords, const OPERATOR: u8>(self, lanes: L) -> Coverage {
        let WordPainting {
            numbers,
            prepare,
            scalar,
            tile,
            list,
            counts,
        } = self;
        let path = WordPixels::<L, OPERATOR>::new(lanes, numbers);
        let mut batch = RowBatch::new();
        let mut coverage = Coverage::default();
        let mut window = tile.window();
        let left = window.first[0];
        for part in list.chunks(CHECK_INTERVAL) {
            for (number, index) in part.iter().enumerate() {
                let (rows, splat) = match prepare(&part[number..], &window) {
                    PreparedFootprint::Nothing => continue,
                    PreparedFootprint::Rows(rows, splat) if batch.fill(lanes, &rows, left) => {
                        (rows, splat)
                    }
                    _ => {
                        coverage += scalar(*index, tile);
                        continue;
                    }
                };
                let splat = path.splat(&splat, rows.second);
                for row in 0..batch.rows() {
                    for block in batch.touched() {
                        if let Some(run) = batch.run(row, block) {
                            let y = rows.rows[0] + row as u16;
                            let run = columns(&run, left);
                            if counts {
                                coverage.visited += run.length as u64;
                                path.paint(&splat, &run, tile.row(y), &mut coverage);
                            } else if let Some(run) = cut(run, tile.live(y), rows.second) {
                                path.paint(&splat, &run, tile.row(y), &mut coverage);
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
            tile.look(lanes);
            match tile.live_window() {
                Some(live) => window = live,
                None => break,
            }
        }
        coverage
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
    let of_run = live >> run.x & (u64::MAX >> (64 - run.length.clamp(1, 64)));
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
