//! The cells that a footprint touches in a tile, each with its pixels and the radial index at its left edge.
//!
//! Rows are computed eight at a time, and their runs' seeds moved back to the left edges of cells, which is exact modulo the lanes' word: r(x - k) =
//! r(x) - k f + k (k + 1) / 2 s. The list is in no order that matters, since a footprint touches a pixel once; what matters is that the pixels'
//! loop runs through one long list and not through rows of two cells, whose ends no processor foresees.

use super::multiply;
use super::tile::{AREA, CELLS_OF_ROW, COLUMNS};
use crate::fast::lanes::fused::{Fused, IOTA};
use crate::fast::recurrence::{RowVectors, stays_near};
use crate::fast::row_words::{RowWords, Runs, excess, runs};
use crate::fast::setup::number::Arithmetic;
use crate::fast::tile::TILE;
use splatline::raster::{BLOCK, RowConstants, Window};

/// A list with so many cells is painted before more are listed: enough to compute the rows of several footprints side by side, and little
/// enough to stay in the first-level cache.
pub const MANY: usize = 256;

/// Room for a whole footprint after that; a vector may reach beyond the last cell.
const ROOM: usize = MANY + AREA / COLUMNS + 8;

/// Bits of a place below the cell's number; the run's pixels have one each, the first one's the lowest.
const PIXELS: u32 = 16;

/// Columns of a cell.
const WIDTH: i64 = COLUMNS as i64;

/// One cell of a footprint.
#[derive(Clone, Copy, Debug)]
pub struct CellPart {
    /// Radial index and first difference at the cell's left edge, to be cut to the lanes' word.
    pub radial: u64,
    pub first: u64,
    /// The cell's number in the tile from bit 16 on, and a bit for each pixel of the row, the first one's the lowest.
    pub place: u64,
}

impl CellPart {
    /// The cell's number in the tile.
    #[inline(always)]
    pub fn cell(&self) -> usize {
        (self.place as u32 >> PIXELS) as usize
    }
}

/// A block of eight rows.
struct Block {
    /// First column.
    left: u16,
    /// First and one past the last of its cells that the footprint's box touches.
    cells: [u16; 2],
    /// Number of its first cell in the first row.
    corner: usize,
    /// Rows that the footprint has, a bit each.
    open: u8,
}

/// Cells of footprints in a tile: memory that is used again and again.
pub struct CellParts<const DEEP: bool> {
    radial: [u64; ROOM],
    first: [u64; ROOM],
    place: [u64; ROOM],
    /// Cells listed.
    pub count: usize,
    /// Pixels of the runs that have been listed.
    pub visited: u64,
}

impl<const DEEP: bool> CellParts<DEEP> {
    /// No cells.
    #[inline(always)]
    pub fn new() -> Self {
        CellParts {
            radial: [0; ROOM],
            first: [0; ROOM],
            place: [0; ROOM],
            count: 0,
            visited: 0,
        }
    }

    /// Forgets all cells.
    #[inline(always)]
    pub fn clear(&mut self) {
        self.count = 0;
        self.visited = 0;
    }

    /// The cells of these numbers in the list.
    #[inline(always)]
    pub fn range(&self, first: usize, end: usize) -> impl Iterator<Item = CellPart> {
        let end = end.min(ROOM);
        let range = first.min(end)..end;
        let lists = [&self.radial, &self.first, &self.place];
        let [radial, first, place] = lists.map(|list| list[range.clone()].iter());
        let words = radial.zip(first).zip(place);
        words.map(|((radial, first), place)| CellPart {
            radial: *radial,
            first: *first,
            place: *place,
        })
    }

    /// Lists the cells of a footprint's rows within the window; `false` and none of them if a word was too long for vectors. The list must
    /// not be full. The window is the tile's; rows and columns of the constants may be fewer.
    #[inline(always)]
    pub fn fill<L: Fused>(
        &mut self,
        lanes: L,
        constants: &RowConstants<i64>,
        window: &Window,
    ) -> bool {
        let math = Arithmetic { lanes };
        let listed = self.count;
        let mut visited = math.splat(0);
        let [top, bottom] = constants.rows;
        let count = bottom.saturating_sub(top).min(TILE[1]);
        if count == 0 {
            return true;
        }
        let offset = top.wrapping_sub(window.first[1]) % TILE[1];
        if !stays_near(constants, usize::from(count)) {
            return false;
        }
        let words = RowWords::new(math, constants);
        let (mut large, mut long) = (math.splat(0), math.splat(0));
        let mut begin = 0;
        for seeds in &constants.blocks {
            let stop = seeds.end.saturating_sub(top).min(count);
            if stop <= begin {
                break;
            }
            let mut rows = RowVectors::new(lanes, constants, seeds);
            for start in (begin..stop).step_by(L::WIDE) {
                let open = first_bits(usize::from(stop - start));
                let [first, last] = constants.visible;
                for left in (first - first % BLOCK..last).step_by(BLOCK.into()) {
                    let columns = [left.into(), i64::from(left) + i64::from(BLOCK)];
                    let [centre, vertical] = [rows.centre, rows.vertical];
                    let runs = runs(math, &words, [centre, vertical], columns, &mut large);
                    let seen = [first.max(left) - left, (last - left).min(BLOCK)];
                    let block = Block {
                        left,
                        cells: [seen[0] / COLUMNS as u16, seen[1].div_ceil(COLUMNS as u16)],
                        corner: usize::from(offset + start) * CELLS_OF_ROW
                            + usize::from(left.wrapping_sub(window.first[0])) / COLUMNS,
                        open,
                    };
                    let lengths = self.append(math, &runs, constants.second, &block);
                    visited = math.add(visited, lengths);
                }
                rows.step(lanes);
            }
            long = math.add(long, rows.excess(lanes));
            begin = stop;
        }
        let too_large = math.add(long, excess(lanes, constants, large));
        let fits = !lanes.wide_any(too_large);
        if fits {
            self.visited += lanes.sum(visited);
        } else {
            self.count = listed;
        }
        fits
    }

    /// Lists the cells of eight rows in a block, and returns the runs' lengths.
    #[inline(always)]
    fn append<L: Fused>(
        &mut self,
        math: Arithmetic<L>,
        runs: &Runs<L>,
        second: i64,
        block: &Block,
    ) -> L::Word {
        let lanes = math.lanes;
        let one = math.splat(1);
        let begin = math.plus(runs.x, -i64::from(block.left));
        let end = math.plus(runs.end, -i64::from(block.left));
        let bits = math.sub(lanes.wide_shl(one, end), lanes.wide_shl(one, begin));
        let is_open = lanes.wide_flags(math.greater(end, begin)) as u8 & block.open;
        let is_open = lanes.truth(is_open);
        let bits = math.select(math.splat(0), bits, is_open);
        let [first_cell, end_cell] = block.cells;
        let back = math.plus(begin, -i64::from(first_cell) * WIDTH);
        let corners = multiply::<L, DEEP>(lanes, back, math.plus(back, 1));
        let corners = multiply::<L, DEEP>(lanes, math.sar(corners, 1), math.splat(second));
        let moved = multiply::<L, DEEP>(lanes, back, runs.first);
        let mut radial = math.add(math.sub(runs.radial, moved), corners);
        let slowed = multiply::<L, DEEP>(lanes, back, math.splat(second));
        let mut first = math.sub(runs.first, slowed);
        let mut bits = lanes.turn(bits, math.splat(i64::from(first_cell) * WIDTH));
        let number = block.corner + usize::from(first_cell);
        let number = math.splat((number << PIXELS) as i64);
        let row = math.shl(
            lanes.wide_load(&IOTA),
            (CELLS_OF_ROW << PIXELS).ilog2().into(),
        );
        let mut place = math.add(number, row);
        for _ in first_cell..end_cell {
            let pixels = math.and(bits, (1 << WIDTH) - 1);
            let truth = math.greater(pixels, math.splat(0));
            let place_of_cell = math.add(place, pixels);
            self.pack(lanes, [radial, first, place_of_cell], truth);
            let along = math.plus(
                math.shl(first, WIDTH.ilog2().into()),
                second.wrapping_mul(WIDTH * (WIDTH - 1) / 2),
            );
            radial = math.add(radial, along);
            first = math.plus(first, second.wrapping_mul(WIDTH));
            bits = lanes.turn(bits, math.splat(WIDTH));
            place = math.plus(place, 1 << PIXELS);
        }
        math.select(math.splat(0), math.sub(end, begin), is_open)
    }

    /// Adds the cells where it is true.
    #[inline(always)]
    fn pack<L: Fused>(&mut self, lanes: L, words: [L::Word; 3], truth: L::Truth) {
        let lists = [&mut self.radial, &mut self.first, &mut self.place];
        for (list, word) in lists.into_iter().zip(words) {
            if let Some(room) = list.get_mut(self.count..self.count + 8)
                && let Some(room) = room.first_chunk_mut()
            {
                lanes.pack(room, word, truth);
            }
        }
        self.count += lanes.wide_flags(truth).count_ones() as usize;
    }
}

/// The lowest `count` bits of eight.
#[inline(always)]
fn first_bits(count: usize) -> u8 {
    if count >= 8 {
        u8::MAX
    } else {
        (1 << count) - 1
    }
}
