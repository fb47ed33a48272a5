//! Spans of many rows at once, bit for bit the kernel's [`EllipseSpans`].
//!
//! A small splat has as many rows as a row has pixels, so that a row must not cost more than a vector of pixels. Down
//! the rows only additions depend on each other; root, span and seeds are computed for four or eight rows in one
//! vector: in double precision, from constants that are computed for a group of footprints (`row_group.rs`), and in
//! words of 64 bits where doubles have not all bits. What neither could hold is noticed beforehand or beside the
//! computation, and such a footprint is left to the kernel's own rows.
//!
//! [`EllipseSpans`]: splatline::raster::EllipseSpans

use super::lanes::{Lanes, apart};
use super::row_group::{ROW_BLOCKS, RowGroup};
use super::row_reals::RowReals;
use super::row_words::{RowVectors, RowWords, Runs, excess, is_tame, runs, stays_near};
use super::tile::{ROOM, ROWS, TILE};
use core::ops::Range;
use splatline::footprint::Footprint;
use splatline::format::{Design, RuntimeWidths, Widths};
use splatline::raster::{BLOCK, EllipseSpans, RowConstants, Window};

/// Blocks of a tile's row that have seeds of their own.
pub const BLOCKS: usize = (TILE[0] / BLOCK) as usize;

const _: () = assert!(TILE[0].is_multiple_of(BLOCK) && BLOCK > 0);

/// What rows are computed from in a design that is known by its numbers, so that one compiled copy serves all.
#[derive(Clone, Debug)]
pub struct RuntimeRows {
    design: RuntimeWidths,
    /// Bits of the design's lanes.
    lane_bits: u32,
}

impl RuntimeRows {
    /// Rows of a design with lanes of so many bits.
    pub fn new(widths: &Widths, lane_bits: u32) -> Option<Self> {
        let design = RuntimeWidths::new(*widths).ok()?;
        Some(RuntimeRows { design, lane_bits })
    }

    /// The design's widths.
    #[inline(always)]
    pub fn widths(&self) -> Widths {
        self.design.widths()
    }

    /// Rows of a footprint in the window, as its design's lanes have them: compiled once, for the few footprints that
    /// need it.
    #[cold]
    #[inline(never)]
    pub fn constants(&self, footprint: &Footprint, window: &Window) -> RowConstants<i64> {
        let mut constants = EllipseSpans::new(self.design, footprint, window).constants();
        if self.lane_bits < i64::BITS {
            constants.second = (constants.second as i32).into();
        }
        constants
    }
}

/// The runs of one footprint's rows in one block of a tile.
pub struct BlockSpans {
    x: [i64; ROOM],
    end: [i64; ROOM],
    radial: [i64; ROOM],
    first: [i64; ROOM],
}

impl BlockSpans {
    /// No runs.
    #[inline(always)]
    fn new() -> Self {
        BlockSpans {
            x: [0; ROOM],
            end: [0; ROOM],
            radial: [0; ROOM],
            first: [0; ROOM],
        }
    }

    /// Notes the runs of the rows from number `start` on.
    #[inline(always)]
    fn store<L: Lanes>(&mut self, lanes: L, start: usize, runs: Runs<L>) {
        let start = start % ROWS;
        lanes.write(&mut self.x, start, runs.x);
        lanes.write(&mut self.end, start, runs.end);
        lanes.write(&mut self.radial, start, runs.radial);
        lanes.write(&mut self.first, start, runs.first);
    }

    /// First column of the rows from number `start` on, and one past the last.
    #[inline(always)]
    pub fn columns<L: Lanes>(&self, lanes: L, start: usize) -> [L::Word; 2] {
        [&self.x, &self.end].map(|list| lanes.read(list, start % ROWS))
    }

    /// Radial index and first difference at the first column of row number `row`.
    #[inline(always)]
    pub fn seeds(&self, row: usize) -> [i64; 2] {
        let row = row % ROWS;
        [self.radial[row], self.first[row]]
    }

    /// The same of two adjacent rows.
    #[inline(always)]
    pub fn two_seeds(&self, row: usize) -> [&[i64; 2]; 2] {
        [two(&self.radial, row), two(&self.first, row)]
    }

    /// The run of row number `row` in the tile that begins at column `left`, if it has pixels in the block.
    #[inline(always)]
    pub fn run(&self, row: usize, left: u16) -> Option<Pixels> {
        let row = row % ROWS;
        let (x, end) = (self.x[row], self.end[row]);
        (x < end).then(|| Pixels {
            x: (x - i64::from(left)) as usize % usize::from(TILE[0]),
            length: (end - x) as usize,
            radial: self.radial[row],
            first: self.first[row],
        })
    }
}

/// Some adjacent pixels of a row: columns of the tile, and lanes not cut to their word yet.
#[derive(Clone, Copy, Debug)]
pub struct Pixels {
    /// First column.
    pub x: usize,
    /// How many.
    pub length: usize,
    /// Radial index at the first column.
    pub radial: i64,
    /// First difference there.
    pub first: i64,
}

/// All rows of one footprint in a tile: memory that is used again for every footprint.
pub struct RowBatch {
    /// Rows of the footprint in the tile.
    rows: usize,
    blocks: [BlockSpans; BLOCKS],
    /// Blocks that the footprint's box touches.
    touched: (usize, usize),
}

impl RowBatch {
    /// No rows.
    pub(crate) fn new() -> Self {
        RowBatch {
            rows: 0,
            blocks: std::array::from_fn(|_| BlockSpans::new()),
            touched: (0, 0),
        }
    }

    /// Computes the runs of a group's footprint `k`, which this is, in the part of the tile that the window shows: its
    /// first row and second difference, or `None` if vectors cannot. `together` is what the group's computation gave,
    /// for a tile that begins at column `left`.
    #[inline(always)]
    pub fn fill<L: Lanes>(
        &mut self,
        rows: &RuntimeRows,
        (together, group, k): (&RowReals<L>, &RowGroup, usize),
        footprint: &Footprint,
        (window, left): (&Window, u16),
    ) -> Option<(u16, i64)> {
        if self.fill_in_reals(together, group, k, left) {
            return Some((group.member(k).rows[0], group.second(k)));
        }
        let constants = rows.constants(footprint, window);
        let filled = if L::ROWS_APART {
            apart(|| self.fill_in_words(together.lanes, &constants, left))
        } else {
            self.fill_in_words(together.lanes, &constants, left)
        };
        filled.then_some((constants.rows[0], constants.second))
    }

    /// Notes the blocks of the visible columns.
    #[inline(always)]
    fn touch(&mut self, visible: [u16; 2], left: u16) {
        let [first, last] = visible.map(|x| usize::from(x.saturating_sub(left)));
        let block = usize::from(BLOCK);
        self.touched = (first / block, last.div_ceil(block).min(BLOCKS));
    }

    /// In double precision; `false` where that has not all bits.
    #[inline(always)]
    fn fill_in_reals<L: Lanes>(
        &mut self,
        together: &RowReals<L>,
        group: &RowGroup,
        k: usize,
        left: u16,
    ) -> bool {
        let member = group.member(k);
        self.touch(member.visible, left);
        if !group.is_ordinary(k) {
            return false;
        }
        let reals = group.reals(k, together);
        let columns = group.columns(k, &reals);
        let mut longest = reals.lanes.splat(0);
        let touched = self.touched();
        let [first, last] = member.rows;
        let count = usize::from(last.saturating_sub(first)).min(ROWS);
        let mut start = 0;
        for number in 0..ROW_BLOCKS {
            if start >= count {
                break;
            }
            let block = group.block(k, number);
            let end = usize::from(block.end.saturating_sub(first)).min(count);
            let mut rows = reals.rows(&block);
            while start < end {
                let span = reals.span(&rows, &mut longest);
                // Without a loop, which would fetch its constants for the one block that most footprints touch.
                for (number, spans) in self.blocks.iter_mut().enumerate() {
                    if touched.contains(&number) {
                        let runs = reals.runs(&rows, &span, columns[number]);
                        spans.store(reals.lanes, start, runs);
                    }
                }
                rows = reals.step(&rows);
                start += L::WIDE;
            }
            start = end;
        }
        self.rows = count;
        !reals.lanes.any(reals.excess(longest))
    }

    /// The same with all of a row in words; `false` where they are too large.
    #[inline(always)]
    fn fill_in_words<L: Lanes>(
        &mut self,
        lanes: L,
        constants: &RowConstants<i64>,
        left: u16,
    ) -> bool {
        self.touch(constants.visible, left);
        let [first, last] = constants.rows;
        let count = usize::from(last.saturating_sub(first)).min(ROWS);
        if !is_tame(constants) || !stays_near(constants, count) {
            return false;
        }
        let words = RowWords::new(lanes, constants);
        let (mut large, mut long) = (lanes.splat(0), lanes.splat(0));
        let mut start = 0;
        for block in &constants.blocks {
            let end = usize::from(block.end.saturating_sub(first)).min(count);
            if end <= start {
                break;
            }
            let mut rows = RowVectors::new(lanes, constants, block);
            while start < end {
                for number in self.touched() {
                    let column = i64::from(left) + (number * usize::from(BLOCK)) as i64;
                    let columns = [column, column + i64::from(BLOCK)];
                    let [centre, vertical] = [rows.centre, rows.vertical];
                    let runs = runs(lanes, &words, [centre, vertical], columns, &mut large);
                    self.blocks[number].store(lanes, start, runs);
                }
                rows.step(lanes);
                start += L::WIDE;
            }
            long = lanes.add(long, rows.excess(lanes));
            start = end;
        }
        self.rows = count;
        !lanes.any(lanes.add(long, excess(lanes, constants, large)))
    }

    /// Blocks that the footprint's box touches; the others hold what an earlier footprint left there.
    #[inline(always)]
    pub fn touched(&self) -> Range<usize> {
        self.touched.0..self.touched.1
    }

    /// Rows of the footprint in the tile.
    #[inline(always)]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// The runs in one block.
    #[inline(always)]
    pub fn block(&self, block: usize) -> &BlockSpans {
        &self.blocks[block]
    }
}

/// Two words from `start` on, a row's number.
#[inline(always)]
pub(super) fn two(words: &[i64; ROOM], start: usize) -> &[i64; 2] {
    let rows = &words[start % ROWS..];
    rows.first_chunk().unwrap_or(&[0; 2])
}

#[cfg(test)]
mod tests;
