//! What a machine has to do for one picture: splats, tiles, splat-tile pairs and their rows.
//!
//! Extracted once from the kernel's own rows and pixels ([`extract`]) or from a table of footprints (`table`), then
//! shared by any number of machine configurations. Columns are counted from the tile's first, so that a row's pixels
//! are the bits of one 64-bit word.

mod extract;
mod order_changes;
mod room;
mod surface;
mod table;

pub use extract::{InOrder, extract, extract_from, extract_in_order};
pub use order_changes::OrderChanges;
pub use room::room_for;
pub use surface::{SurfaceCounts, SurfaceWork, extract_surface, layers_of};
pub use table::{TableOptions, read_table};

use rayon::prelude::*;
use splatline::blend::Pixel;
use splatline::footprint::depth::KEY_BITS;
use splatline::raster::Window;
use splatline_engine::fast::order::Grid;
use std::ops::Range;

/// Pixels of a row of a tile: bit i is column i.
pub type Mask = u64;

/// Bits `from .. from + count`.
pub fn mask(from: u32, count: u32) -> Mask {
    let bits = if count >= 64 {
        Mask::MAX
    } else {
        (1 << count) - 1
    };
    bits.checked_shl(from).unwrap_or(0)
}

/// One row of a splat-tile pair. A row whose span is empty has length 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WorkloadRow {
    /// Visited pixels that had not finished before this splat.
    pub open: Mask,
    /// Visited pixels inside the footprint, r < c, finished or not.
    pub covered: Mask,
    /// First visited column.
    pub x: u8,
    /// Visited pixels.
    pub length: u8,
}

impl WorkloadRow {
    /// The visited pixels.
    pub fn visited(&self) -> Mask {
        mask(self.x.into(), self.length.into())
    }
}

/// One footprint in one tile.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pair {
    /// The splat, by its number in the scene.
    pub splat: u32,
    /// One past its last row in [`Workload::rows`]; its first is the end of the pair before.
    pub rows_end: u32,
    /// Row of the tile in which its first row lies.
    pub first_row: u8,
    /// Does the traversal visit a pixel?
    pub visits: bool,
}

/// One tile of the screen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tile {
    /// One past its last pair in [`Workload::pairs`].
    pub pairs_end: u32,
    /// Pairs after which all its pixels have finished; `u32::MAX` if they never do.
    pub finished_after: u32,
    /// Pixels on the screen.
    pub pixels: u32,
}

/// One splat of the scene in the geometry phase.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SplatWork {
    /// Tiles that its bounding box meets; 0 if it is culled.
    pub tiles: u32,
    /// Of these, tiles in which its traversal visits a pixel.
    pub visited_tiles: u32,
}

/// All work of one picture.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Workload {
    /// Columns and rows of a tile.
    pub tile: [u16; 2],
    /// Bytes of the design's footprint packet.
    pub packet_bytes: u32,
    /// Splats in the order of the scene.
    pub splats: Vec<SplatWork>,
    /// Tiles, row by row.
    pub tiles: Vec<Tile>,
    /// Tiles in a row of the screen; 0 if that is not known.
    pub columns: u32,
    /// Pairs of all tiles, in drawing order within each.
    pub pairs: Vec<Pair>,
    /// Rows of all pairs.
    pub rows: Vec<WorkloadRow>,
    /// Bits in which the sort keys of visible splats differ; all where the keys are not known.
    pub key_bits: u64,
    /// What changed in the lists where they keep the order of the picture before; nothing where all is sorted anew.
    pub order_changes: Option<OrderChanges>,
    /// What a surface unit does, if surfaces are drawn: their tiles' lists are in the scene's order, which nobody
    /// sorts.
    pub surface: Option<SurfaceWork>,
}

/// Which part of a list belongs to an item of another one, whose items say where theirs end.
pub(super) fn part_of<T>(items: &[T], number: usize, end: fn(&T) -> u32) -> Range<usize> {
    let first = number
        .checked_sub(1)
        .map_or(0, |before| end(&items[before]));
    first as usize..end(&items[number]) as usize
}

/// Sums over a workload.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Totals {
    /// Rows of all pairs.
    pub rows: u64,
    /// Visited pixels.
    pub visited: u64,
    /// Pixels inside a footprint.
    pub covered: u64,
    /// Of these, pixels that had not finished.
    pub live: u64,
}

impl Workload {
    /// Sums over all rows, without any termination.
    pub fn totals(&self) -> Totals {
        let mut totals = Totals {
            rows: self.rows.len() as u64,
            ..Totals::default()
        };
        for row in &self.rows {
            totals.visited += u64::from(row.length);
            totals.covered += u64::from(row.covered.count_ones());
            totals.live += u64::from((row.covered & row.open).count_ones());
        }
        totals
    }

    /// The numbers of a tile's pairs in drawing order.
    pub fn pairs_in(&self, tile: usize) -> Range<usize> {
        part_of(&self.tiles, tile, |tile| tile.pairs_end)
    }

    /// A tile's pairs in drawing order; none of a tile that is not there.
    pub fn pairs_of(&self, tile: usize) -> &[Pair] {
        let there = tile < self.tiles.len();
        if there {
            &self.pairs[self.pairs_in(tile)]
        } else {
            &[]
        }
    }

    /// The rows of the pair of this number.
    pub fn rows_of(&self, pair: usize) -> &[WorkloadRow] {
        &self.rows[part_of(&self.pairs, pair, |pair| pair.rows_end)]
    }

    /// Bytes of its lists.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.rows)
            + size_of_val(&*self.pairs)
            + size_of_val(&*self.splats)
            + size_of_val(&*self.tiles)
    }

    /// Splats that are not culled.
    pub fn visible(&self) -> usize {
        self.splats.iter().filter(|splat| splat.tiles > 0).count()
    }
}

/// The pairs and rows of one tile, before tiles are put together.
#[derive(Clone, Debug, Default)]
struct TilePart {
    finished_after: Option<u32>,
    pairs: Vec<Pair>,
    rows: Vec<WorkloadRow>,
    /// The finished pixels of volumes.
    pixels: Vec<Pixel>,
}

/// Footprints by tile: which boxes meet which tile, in drawing order.
struct Bins {
    grid: Grid,
    tile: [u16; 2],
    lists: Vec<Vec<u32>>,
}

impl Bins {
    /// Sorts boxes into tiles; they must lie in the viewport and not be empty.
    fn new(boxes: impl Iterator<Item = (u32, Window)>, viewport: [u16; 2], tile: [u16; 2]) -> Bins {
        let grid = Grid::new(viewport, tile);
        let mut lists = vec![Vec::new(); grid.len()];
        for (index, bounds) in boxes {
            grid.touched(&bounds, |tile| lists[tile].push(index));
        }
        Bins { grid, tile, lists }
    }
}

/// Every tile's part on some core, in the order of the tiles. Takes a function behind a reference, so that what spreads
/// the work is compiled once and not for every design.
fn each_tile<Part: Send>(tiles: usize, part: &(dyn Fn(usize) -> Part + Sync)) -> Vec<Part> {
    (0..tiles).into_par_iter().map(part).collect()
}

/// Puts the tiles together and counts each splat's tiles.
fn assemble(parts: Vec<TilePart>, bins: &Bins, splats: usize, packet_bytes: u32) -> Workload {
    let Bins { grid, tile, .. } = bins;
    let mut workload = Workload {
        tile: *tile,
        columns: grid.viewport()[0].div_ceil(tile[0]).into(),
        packet_bytes,
        splats: vec![SplatWork::default(); splats],
        key_bits: (1 << KEY_BITS) - 1,
        ..Workload::default()
    };
    let (pairs, rows) = (&mut workload.pairs, &mut workload.rows);
    pairs.reserve(parts.iter().map(|part| part.pairs.len()).sum());
    rows.reserve(parts.iter().map(|part| part.rows.len()).sum());
    for (index, part) in parts.into_iter().enumerate() {
        let base = workload.rows.len() as u32;
        for pair in part.pairs {
            let splat = &mut workload.splats[pair.splat as usize];
            splat.tiles += 1;
            splat.visited_tiles += u32::from(pair.visits);
            workload.pairs.push(Pair {
                rows_end: base + pair.rows_end,
                ..pair
            });
        }
        workload.rows.extend(part.rows);
        workload.tiles.push(Tile {
            pairs_end: workload.pairs.len() as u32,
            finished_after: part.finished_after.unwrap_or(u32::MAX),
            pixels: grid.window(index).pixels() as u32,
        });
    }
    workload
}
