//! What all painters of tiles share: their interface, their memory, the footprint table, the kernel's own painter for
//! what vectors cannot do, and the choice among them by what processor and design allow.

use super::lanes::VectorLevel;
use super::setup::Outcome;
use super::words::WordPainter;
use super::words::tile::WordTile;
use splatline::blend::Pixel;
use splatline::draw::{Coverage, Painter};
use splatline::format::{Design, Traversal, Widths};
use splatline::kernel::{FootprintTable, entries, fill};
use splatline::raster::Window;
use splatline::rules::{Compositing, Rules};
use splatline::target::Target;

/// Footprints painted between two checks whether the tile has finished.
pub const CHECK_INTERVAL: usize = 64;

/// A footprint table with the memory that it lies in: painters outlive the picture that they were made for.
#[derive(Clone, Debug)]
pub struct TableMemory {
    /// Its entries.
    pub entries: Vec<u32>,
    /// Of the design whose table it is.
    pub widths: Widths,
    /// Whose kernel it is.
    pub rules: Rules,
}

impl TableMemory {
    /// The table of the rules' kernel.
    pub fn new(widths: &Widths, rules: &Rules) -> Self {
        let mut memory = vec![0; entries(widths)];
        fill(&mut memory, widths, rules.table_range, rules.kernel);
        TableMemory {
            entries: memory,
            widths: *widths,
            rules: *rules,
        }
    }

    /// The table.
    pub fn table(&self) -> FootprintTable<'_> {
        match FootprintTable::new(&self.entries, &self.widths, self.rules.table_range) {
            Ok(table) => table,
            Err(_) => unreachable!("the entries have been made for these widths"),
        }
    }

    /// The kernel's painter by this table and under its rules, of lists in this order.
    pub fn painter<D: Design>(
        &self,
        design: D,
        order: Compositing,
        traversal: Traversal,
    ) -> Painter<'_, D> {
        Painter::new(design, &self.rules, self.table(), order, traversal)
    }
}

/// A tile's pixels, row by row, to be painted.
pub fn whole(pixels: &mut [Pixel], window: Window) -> Target<'_> {
    match Target::new(pixels, window, window.columns().into()) {
        Ok(target) => target,
        Err(_) => unreachable!("the tile's memory has been made for its window"),
    }
}

/// A thread's memory.
#[derive(Clone, Debug, Default)]
pub struct PaintScratch {
    pub(super) words: Option<WordTile<i64>>,
    pub(super) singles: Option<WordTile<f32>>,
}

/// What setup made of every splat, in the scene's order.
pub type Results = [Outcome];

/// What a tile's pixels are before it is painted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// Transparent, whatever they hold.
    Clear,
    /// What nearer footprints left.
    Resumed,
}

/// A tile to be painted.
pub struct TileWork<'a> {
    /// Its part of the screen.
    pub window: Window,
    /// See [`Results`].
    pub footprints: &'a Results,
    /// The numbers of those that are drawn, in this order.
    pub list: &'a [u32],
    /// What its pixels are before.
    pub start: Start,
    /// Its pixels, row by row.
    pub pixels: &'a mut [Pixel],
}

/// Paints tiles along spans, whatever the design.
pub trait TilePainter: Send + Sync {
    /// Paints a tile in a thread's memory.
    fn paint(&self, scratch: &mut PaintScratch, work: TileWork) -> Coverage;
}

/// The fastest painter for a design and rules on such vectors: the kernel's own where vectors cannot draw.
///
/// Only where `counts` asks for it are all pixels counted; a painter that need not may leave out those that have
/// finished.
pub fn tile_painter<D: Design + Send + Sync + 'static>(
    design: D,
    rules: &Rules,
    order: Compositing,
    traversal: Traversal,
    choice: Option<VectorLevel>,
    counts: bool,
) -> Box<dyn TilePainter> {
    let vectors = choice.filter(|_| traversal == Traversal::Spans);
    let of_level = |choice| WordPainter::new(design, rules, order, choice, counts);
    match vectors.and_then(of_level) {
        Some(painter) => Box::new(painter),
        None => Box::new(ScalarPainter::new(design, rules, order, traversal)),
    }
}

/// The kernel's own painter.
#[derive(Clone, Debug)]
pub struct ScalarPainter<D> {
    pub design: D,
    pub table: TableMemory,
    pub order: Compositing,
    pub traversal: Traversal,
}

impl<D: Design> ScalarPainter<D> {
    /// For a design and rules, of lists in this order.
    pub fn new(design: D, rules: &Rules, order: Compositing, traversal: Traversal) -> Self {
        ScalarPainter {
            design,
            table: TableMemory::new(&design.widths(), rules),
            order,
            traversal,
        }
    }

    /// One footprint on a tile's pixels, which lie row by row.
    pub fn paint_alone(
        &self,
        footprint: &Outcome,
        window: Window,
        pixels: &mut [Pixel],
    ) -> Coverage {
        match footprint {
            Ok(footprint) => self.painter().draw(footprint, &mut whole(pixels, window)),
            Err(_) => Coverage::default(),
        }
    }

    fn painter(&self) -> Painter<'_, D> {
        (self.table).painter(self.design, self.order, self.traversal)
    }
}

impl<D: Design + Send + Sync> TilePainter for ScalarPainter<D> {
    fn paint(&self, _: &mut PaintScratch, work: TileWork) -> Coverage {
        if work.start == Start::Clear {
            work.pixels.fill(Pixel::clear(&self.design.widths()));
        }
        let (painter, mut coverage) = (self.painter(), Coverage::default());
        let mut target = whole(work.pixels, work.window);
        for part in work.list.chunks(CHECK_INTERVAL) {
            for footprint in part
                .iter()
                .flat_map(|index| &work.footprints[*index as usize])
            {
                coverage += painter.draw(footprint, &mut target);
            }
            if target.is_finished() {
                break;
            }
        }
        coverage
    }
}
