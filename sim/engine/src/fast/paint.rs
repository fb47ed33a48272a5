//! What paints a tile: cells of fused or short products, words of 64 bits, or the kernel's own painter, by what processor and design allow.

use super::cells::{CellTiles, FusedPainter, NarrowPainter};
use super::lanes::VectorLevel;
use super::words::{WordPainter, WordTile};
use splatline::blend::Pixel;
use splatline::draw::{Coverage, Painter};
use splatline::footprint::Footprint;
use splatline::format::{Design, Traversal, Widths};
use splatline::kernel::{FootprintTable, entries, fill};
use splatline::raster::Window;
use splatline::rules::{Compositing, Rules};
use splatline::setup::Cull;
use splatline::target::Target;

/// Footprints painted between two checks whether the tile has finished.
pub const CHECK_INTERVAL: usize = 64;

/// A footprint table with the memory that it lies in: painters outlive the picture that they were made for.
#[derive(Clone, Debug)]
pub struct TableMemory {
    entries: Vec<u32>,
    widths: Widths,
    range: u8,
}

impl TableMemory {
    /// The table of the rules' kernel.
    pub fn new(widths: &Widths, rules: &Rules) -> Self {
        let mut memory = vec![0; entries(widths)];
        fill(&mut memory, widths, rules.table_range, rules.kernel);
        TableMemory {
            entries: memory,
            widths: *widths,
            range: rules.table_range,
        }
    }

    /// The table.
    pub fn table(&self) -> FootprintTable<'_> {
        match FootprintTable::new(&self.entries, &self.widths, self.range) {
            Ok(table) => table,
            Err(_) => unreachable!("the entries have been made for these widths"),
        }
    }
}

/// A thread's memory.
#[derive(Clone, Debug, Default)]
pub struct PaintScratch {
    pub(super) words: Option<WordTile>,
    pub(super) cells: CellTiles,
}

/// What setup made of every splat, in the scene's order.
pub type Results = [Result<Footprint, Cull>];

/// Paints tiles along spans, whatever the design.
pub trait TilePainter: Send + Sync {
    /// Paints the footprints of `list`, in this order, into the transparent pixels of `window`, and writes these to `pixels`, row by row.
    fn paint(
        &self,
        scratch: &mut PaintScratch,
        window: Window,
        footprints: &Results,
        list: &[u32],
        pixels: &mut [Pixel],
    ) -> Coverage;
}

/// The fastest painter for a design and rules on such vectors: the kernel's own where vectors cannot draw.
///
/// Only where `counts` asks for it are all pixels counted; a painter that need not may leave out those that have finished.
pub fn tile_painter<D: Design + Send + Sync + 'static>(
    design: D,
    rules: &Rules,
    order: Compositing,
    traversal: Traversal,
    choice: Option<VectorLevel>,
    counts: bool,
) -> Box<dyn TilePainter> {
    let vectors = choice.filter(|_| traversal == Traversal::Spans);
    let of_level = |choice| on_vectors(design, rules, order, choice, counts);
    if let Some(painter) = vectors.and_then(of_level) {
        return painter;
    }
    Box::new(ScalarPainter {
        design,
        rules: *rules,
        table: TableMemory::new(&design.widths(), rules),
        order,
        traversal,
    })
}

/// A painter along spans; `None` where only the kernel's can. Other orders than front to back have the words alone.
fn on_vectors<D: Design + Send + Sync + 'static>(
    design: D,
    rules: &Rules,
    order: Compositing,
    choice: VectorLevel,
    counts: bool,
) -> Option<Box<dyn TilePainter>> {
    let cells = Some(choice).filter(|_| order == Compositing::FrontToBack);
    if let Some(painter) = cells.and_then(|choice| NarrowPainter::new(design, rules, choice)) {
        return Some(Box::new(painter));
    }
    if let Some(painter) = cells.and_then(|choice| FusedPainter::new(design, rules, choice)) {
        return Some(Box::new(painter));
    }
    let painter = WordPainter::new(design, rules, order, choice, counts)?;
    Some(Box::new(painter))
}

/// The kernel's own painter.
struct ScalarPainter<D> {
    design: D,
    rules: Rules,
    table: TableMemory,
    order: Compositing,
    traversal: Traversal,
}

impl<D: Design + Send + Sync> TilePainter for ScalarPainter<D> {
    fn paint(
        &self,
        _: &mut PaintScratch,
        window: Window,
        footprints: &Results,
        list: &[u32],
        pixels: &mut [Pixel],
    ) -> Coverage {
        let (table, order) = (self.table.table(), self.order);
        let painter = Painter::new(self.design, &self.rules, table, order, self.traversal);
        pixels.fill(Pixel::clear(&self.design.widths()));
        let mut coverage = Coverage::default();
        let columns = usize::from(window.end[0] - window.first[0]);
        let Ok(mut target) = Target::new(pixels, window, columns) else {
            return coverage;
        };
        for part in list.chunks(CHECK_INTERVAL) {
            for footprint in part.iter().flat_map(|index| &footprints[*index as usize]) {
                coverage += painter.draw(footprint, &mut target);
            }
            if target.is_finished() {
                break;
            }
        }
        coverage
    }
}
