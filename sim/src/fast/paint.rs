//! Painting a tile: the kernel's rows, the vectors' pixels, and the scalar painter for what they cannot do.

use super::cells::{FusedPainter, NarrowPainter, Tiles};
use super::lanes::{Choice, Floats, Job, Lanes, dispatch, prefetch};
use super::pixels::{Counts, Intervals, PixelPath, supports};
use super::rows::RowBatch;
use super::tile::Tile;
use splatline::blend::Pixel;
use splatline::draw::{Coverage, Painter};
use splatline::footprint::Footprint;
use splatline::format::{Classic8, Design, Lean18, Standard24, Traversal};
use splatline::kernel::FootprintTable;
use splatline::raster::{SpanRows, Window};
use splatline::rules::{Compositing, Rules};
use splatline::setup::Cull;
use splatline::target::Target;

/// Footprints painted between two checks whether the tile has finished.
pub const CHECK_INTERVAL: usize = 64;

/// How many footprints ahead memory is asked for: lists name them in an order that no cache foresees.
const AHEAD: usize = 4;

/// Everything that is constant for a picture.
#[derive(Clone, Debug)]
pub struct FastPainter<'a, D> {
    design: D,
    rules: Rules,
    intervals: Intervals,
    scalar: Painter<'a, D>,
    choice: Choice,
}

/// A thread's memory.
#[derive(Clone, Debug, Default)]
pub struct Scratch {
    words: Option<Tile>,
    pub(super) cells: Tiles,
}

/// What setup made of every splat, in the scene's order.
pub type Results = [Result<Footprint, Cull>];

/// Paints tiles front to back along spans, whatever the design.
pub trait TilePainter: Sync {
    /// Paints the footprints of `list`, in this order, into the transparent pixels of `window`, and writes these to `rows`.
    fn paint(
        &self,
        scratch: &mut Scratch,
        window: Window,
        footprints: &Results,
        list: &[u32],
        rows: &mut [&mut [Pixel]],
    ) -> Coverage;
}

/// A painter on vectors for a design and rules; `None` where only the scalar painter can.
///
/// One compiled copy exists for each named design with 32-bit lanes, because its shifts are constants of the instructions.
pub fn tile_painter<'a, D: Design + Sync + 'a>(
    design: D,
    rules: &Rules,
    table: FootprintTable<'a>,
    choice: Choice,
) -> Option<Box<dyn TilePainter + 'a>> {
    if let Some(painter) = NarrowPainter::new(design, rules, table, choice) {
        return Some(Box::new(painter));
    }
    if let Some(painter) = FusedPainter::new(design, rules, table, choice) {
        return Some(Box::new(painter));
    }
    // Lanes of 64 bits do not wrap where those of 32 do.
    if size_of::<D::Lane>() != size_of::<i32>() {
        return None;
    }
    match design.widths() {
        Classic8::WIDTHS => boxed(FastPainter::new(Classic8, rules, table, choice)),
        Lean18::WIDTHS => boxed(FastPainter::new(Lean18, rules, table, choice)),
        Standard24::WIDTHS => boxed(FastPainter::new(Standard24, rules, table, choice)),
        _ => None,
    }
}

fn boxed<'a, D: Design<Lane = i32> + Sync + 'a>(
    painter: Option<FastPainter<'a, D>>,
) -> Option<Box<dyn TilePainter + 'a>> {
    painter.map(|painter| Box::new(painter) as Box<dyn TilePainter>)
}

impl<'a, D: Design<Lane = i32>> FastPainter<'a, D> {
    /// A painter for widths and rules that vectors can do.
    pub fn new(
        design: D,
        rules: &Rules,
        table: FootprintTable<'a>,
        choice: Choice,
    ) -> Option<Self> {
        let intervals = Intervals::new(&table);
        let known = matches!(
            (rules.stop_before, rules.table_range),
            (true, 4) | (false, 2)
        );
        let fits = known && supports(&design.widths(), rules, &intervals);
        fits.then(|| FastPainter {
            design,
            rules: *rules,
            intervals,
            scalar: Painter::new(
                design,
                rules,
                table,
                Compositing::FrontToBack,
                Traversal::Spans,
            ),
            choice,
        })
    }
}

impl<D: Design<Lane = i32> + Sync> TilePainter for FastPainter<'_, D> {
    fn paint(
        &self,
        scratch: &mut Scratch,
        window: Window,
        footprints: &Results,
        list: &[u32],
        rows: &mut [&mut [Pixel]],
    ) -> Coverage {
        let tile = scratch.words.get_or_insert_with(Tile::new);
        tile.open(window, Pixel::clear(&self.design.widths()));
        let painting = Painting {
            painter: self,
            tile,
            footprints,
            list,
        };
        let coverage = dispatch(self.choice, painting);
        for (y, row) in rows.iter_mut().enumerate() {
            tile.copy_row(y, row);
        }
        coverage
    }
}

/// A tile to be painted, by whatever vectors.
struct Painting<'p, 'a, D> {
    painter: &'p FastPainter<'a, D>,
    tile: &'p mut Tile,
    footprints: &'p Results,
    list: &'p [u32],
}

impl<D: Design<Lane = i32>> Job for Painting<'_, '_, D> {
    type Output = Coverage;

    #[inline(always)]
    fn run<L: Floats>(self, lanes: L) -> Coverage {
        if self.painter.rules.stop_before {
            self.paint::<L, true, 4>(lanes)
        } else {
            self.paint::<L, false, 2>(lanes)
        }
    }
}

impl<D: Design<Lane = i32>> Painting<'_, '_, D> {
    #[inline(always)]
    fn paint<L: Lanes, const STOP_BEFORE: bool, const RANGE: u32>(self, lanes: L) -> Coverage {
        let Painting {
            painter,
            tile,
            footprints,
            list,
        } = self;
        let widths = painter.design.widths();
        let path = PixelPath::<L, STOP_BEFORE, RANGE>::new(
            lanes,
            widths,
            &painter.rules,
            &painter.intervals,
        );
        let mut counts = Counts::new(lanes);
        let mut batch = RowBatch::new();
        let mut coverage = Coverage::default();
        let window = tile.window();
        for part in list.chunks(CHECK_INTERVAL) {
            for (number, index) in part.iter().enumerate() {
                if let Some(next) = part.get(number + AHEAD) {
                    prefetch(&footprints[*next as usize]);
                }
                let Ok(footprint) = &footprints[*index as usize] else {
                    continue;
                };
                let rows = SpanRows::new(painter.design, footprint, &window)
                    .constants()
                    .widened();
                let brush = path.brush(footprint, rows.second as i32);
                let fits = batch.fill(lanes, &rows, window.first[0]);
                let (Some(brush), true) = (brush, fits) else {
                    coverage += paint_scalar(&painter.scalar, footprint, tile);
                    continue;
                };
                for row in 0..batch.rows() {
                    for block in batch.touched() {
                        if let Some(run) = batch.run(&rows, row, block) {
                            let x = run.x - window.first[0];
                            path.paint(&brush, &run, x, tile.row(run.y), &mut counts);
                        }
                    }
                }
            }
            if tile.is_finished() {
                break;
            }
        }
        coverage += counts.coverage(lanes);
        coverage
    }
}

/// The scalar painter on the tile's pixels.
#[cold]
#[inline(never)]
fn paint_scalar<D: Design>(
    painter: &Painter<D>,
    footprint: &Footprint,
    tile: &mut Tile,
) -> Coverage {
    let mut pixels = tile.to_pixels();
    let window = tile.window();
    let stride = usize::from(window.last[0] - window.first[0]);
    let Ok(mut target) = Target::new(&mut pixels, window, stride) else {
        return Coverage::default();
    };
    let coverage = painter.draw(footprint, &mut target);
    tile.set_pixels(&pixels);
    coverage
}
