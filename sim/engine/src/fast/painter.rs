//! What all painters of tiles share: their interface, their memory and the footprint table.

use super::cells::tile::CellTile;
use super::words::tile::WordTile;
use splatline::blend::Pixel;
use splatline::draw::Coverage;
use splatline::footprint::Footprint;
use splatline::format::Widths;
use splatline::kernel::{FootprintTable, entries, fill};
use splatline::raster::Window;
use splatline::rules::Rules;
use splatline::setup::Cull;

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
    pub(super) words: Option<WordTile<u64>>,
    pub(super) singles: Option<WordTile<f32>>,
    pub(super) cells: Option<CellTile>,
}

/// What setup made of every splat, in the scene's order.
pub type Results = [Result<Footprint, Cull>];

/// What a tile's pixels are before it is painted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// Transparent, whatever they hold.
    Clear,
    /// What nearer footprints left.
    Resumed,
}

/// Paints tiles along spans, whatever the design.
pub trait TilePainter: Send + Sync {
    /// Paints the footprints of `list`, in this order, into the pixels of `window`, which lie row by row.
    fn paint(
        &self,
        scratch: &mut PaintScratch,
        window: Window,
        footprints: &Results,
        list: &[u32],
        start: Start,
        pixels: &mut [Pixel],
    ) -> Coverage;
}
