//! The pixels of a footprint's runs that are in work: several rows in a vector, a bit for each pixel.
//!
//! A run ends at its last such pixel, and rows without one are never looked at: whether a row has a run, and whether that is in work, no
//! branch foresees. Finished pixels before the first one cost a test for each vector of them, less than seeds that are moved on.

use super::path::Pixels;
use super::tile::{PixelWord, ROOM, WordTile};
use crate::fast::lanes::Wide;
use crate::fast::rows::BlockSpans;
use crate::fast::setup::number::Arithmetic;
use crate::fast::tile::TILE;

/// The runs of one footprint in one block; memory that is used again for every block.
pub(super) struct LiveRuns {
    /// Column of the tile that each row's run begins at.
    starts: [i64; ROOM],
    /// A bit for each of its pixels in work.
    pixels: [i64; ROOM],
}

impl LiveRuns {
    /// No runs.
    pub fn new() -> Self {
        LiveRuns {
            starts: [0; ROOM],
            pixels: [0; ROOM],
        }
    }

    /// Finds the pixels in work of so many rows' runs, from row `first` of the tile on, which begins at column `left`. A bit for every row that has
    /// any comes back.
    #[inline(always)]
    pub fn find<L: Wide, W: PixelWord>(
        &mut self,
        math: Arithmetic<L>,
        (runs, count): (&BlockSpans, usize),
        (tile, first): (&WordTile<W>, usize),
        left: u16,
    ) -> u64 {
        let lanes = math.lanes;
        let [all, zero] = [-1, 0].map(|word| math.splat(word));
        let [from, to] = [left, left.saturating_add(TILE[0])].map(|x| math.splat(x.into()));
        let mut empty = 0;
        for row in (0..count).step_by(L::WIDE) {
            let [x, end] = runs.columns(lanes, row);
            let x = math.sub(x, from);
            // From the first column on, and up to the last one.
            let right = lanes.wide_shr(all, math.sub(to, end));
            let of_run = lanes.wide_and(lanes.wide_shl(all, x), right);
            let live = lanes.wide_load(tile.live(first + row));
            let pixels = lanes.wide_and(of_run, live);
            lanes.wide_store(room(&mut self.starts, row), x);
            lanes.wide_store(room(&mut self.pixels, row), pixels);
            empty |= u64::from(lanes.wide_flags(lanes.wide_equal(pixels, zero))) << row;
        }
        let beyond = u64::MAX.checked_shl(count as u32).unwrap_or(0);
        !(empty | beyond)
    }

    /// The run of a row that has pixels in work, up to the last of them.
    #[inline(always)]
    pub fn run(&self, runs: &BlockSpans, row: usize) -> Pixels {
        let row = row % ROOM;
        let pixels = self.pixels[row] as u64;
        let x = self.starts[row] as usize;
        let end = 64 - pixels.leading_zeros() as usize;
        let [radial, first] = runs.seeds(row);
        Pixels {
            x,
            length: end - x,
            radial,
            first,
        }
    }
}

/// Place for a vector at a row.
#[inline(always)]
fn room(words: &mut [i64; ROOM], row: usize) -> &mut [i64; 8] {
    let Some(room) = words[row % (ROOM - 8)..].first_chunk_mut() else {
        unreachable!("the list has room for a vector at every row")
    };
    room
}
