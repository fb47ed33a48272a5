//! The pixels of a footprint's runs that are in work: several rows in a vector, a bit for each pixel.
//!
//! A run ends at its last such pixel, and rows without one are never looked at: whether a row has a run, and whether
//! that is in work, no branch foresees. Finished pixels before the first one are computed, too: to move seeds past them
//! costs more.

use super::path::{SHORT, TwoRuns};
use super::tile::{PixelWord, WordTile};
use crate::fast::lanes::Lanes;
use crate::fast::rows::{BlockSpans, Pixels, two};
use crate::fast::tile::{ROOM, ROWS, TILE};

/// The runs of one footprint in one block; memory that is used again for every block.
pub(super) struct LiveRuns {
    /// Column of the tile that each row's run begins at.
    starts: [i64; ROOM],
    /// A bit for each of its pixels in work, from that column on.
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

    /// Finds the pixels in work of so many rows' runs, from row `first` of the tile on, which begins at column `left`.
    /// A bit for every row that has any comes back, and one for every row of which they are more than [`SHORT`]
    /// columns.
    #[inline(always)]
    pub fn find<L: Lanes, W: PixelWord>(
        &mut self,
        lanes: L,
        (runs, count): (&BlockSpans, usize),
        (tile, first): (&WordTile<W>, usize),
        left: u16,
    ) -> [u64; 2] {
        let (zero, short) = (lanes.splat(0), lanes.splat((1 << SHORT) - 1));
        let (mut empty, mut long) = (0, 0);
        for row in (0..count).step_by(L::WIDE) {
            let [x, of_run] = columns(lanes, runs.columns(lanes, row), left);
            let live = tile.live(lanes, first + row);
            let pixels = lanes.shr(lanes.and(of_run, live), x);
            lanes.write(&mut self.starts, row % ROWS, x);
            lanes.write(&mut self.pixels, row % ROWS, pixels);
            empty |= u64::from(lanes.flags(lanes.equal(pixels, zero))) << row;
            long |= u64::from(lanes.flags(lanes.greater(pixels, short))) << row;
        }
        // A row beside the last one is none.
        self.pixels[count.min(ROOM - 1)] = 0;
        let beyond = u64::MAX.checked_shl(count as u32).unwrap_or(0);
        [!(empty | beyond), long & !beyond]
    }

    /// The short runs of two adjacent rows.
    #[inline(always)]
    pub fn two<'a>(&'a self, runs: &'a BlockSpans, row: usize) -> TwoRuns<'a> {
        let [radial, first] = runs.two_seeds(row);
        TwoRuns {
            x: two(&self.starts, row),
            pixels: two(&self.pixels, row),
            radial,
            first,
        }
    }

    /// The run of a row that has pixels in work, up to the last of them.
    #[inline(always)]
    pub fn run(&self, runs: &BlockSpans, row: usize) -> Pixels {
        let row = row % ROOM;
        let pixels = self.pixels[row] as u64;
        let x = self.starts[row] as usize;
        let [radial, first] = runs.seeds(row);
        Pixels {
            x,
            length: 64 - pixels.leading_zeros() as usize,
            radial,
            first,
        }
    }
}

/// First columns of runs in the tile that begins at column `left`, and a bit for each of their pixels.
#[inline(always)]
fn columns<L: Lanes>(lanes: L, [x, end]: [L::Word; 2], left: u16) -> [L::Word; 2] {
    let left = i64::from(left);
    let (all, end_of_tile) = (lanes.splat(-1), lanes.splat(left + i64::from(TILE[0])));
    let x = lanes.sub(x, lanes.splat(left));
    // From the first column on, and up to the last one: none where a run ends before it begins.
    let to_end = lanes.shr(all, lanes.sub(end_of_tile, end));
    [x, lanes.and(lanes.shl(all, x), to_end)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fast::lanes::{Portable, VectorLevel, VectorTask, dispatch_vectors};
    use proptest::prelude::*;

    struct Runs {
        left: u16,
        x: [i64; 8],
        end: [i64; 8],
    }

    impl VectorTask for &Runs {
        type Output = Vec<[i64; 2]>;

        #[inline(always)]
        fn run<L: Lanes>(self, lanes: L) -> Vec<[i64; 2]> {
            let runs = [&self.x, &self.end].map(|list| lanes.load(list));
            let mut lists = [[0; 8]; 2];
            for (list, words) in (lists.iter_mut()).zip(columns(lanes, runs, self.left)) {
                lanes.store(list, words);
            }
            (0..L::WIDE).map(|k| lists.map(|list| list[k])).collect()
        }
    }

    proptest! {
        /// In the last tile of the widest screen as well.
        #[test]
        fn a_bit_is_a_column_of_the_run(
            tile in prop_oneof![Just(1023u16), 0u16..1024], starts: [u8; 8], ends in prop::array::uniform8(0i64..=64),
        ) {
            let left = TILE[0] * tile;
            let x = starts.map(|x| i64::from(left) + i64::from(x % 64));
            // A closed row ends in column 0.
            let end = ends.map(|end| if end == 0 { 0 } else { i64::from(left) + end });
            let runs = Runs { left, x, end };
            let others = [VectorLevel::Avx2, VectorLevel::Best];
            let others = others.map(|level| dispatch_vectors(level, &runs).ok());
            for found in others.into_iter().flatten().chain([(&runs).run(Portable)]) {
                for (k, [start, bits]) in found.into_iter().enumerate() {
                    prop_assert_eq!(start, x[k] - i64::from(left));
                    for column in 0..64 {
                        let inside = (x[k]..end[k]).contains(&(i64::from(left) + column));
                        prop_assert_eq!(bits >> column & 1 == 1, inside, "{} of {:?}", column, (x[k], end[k]));
                    }
                }
            }
        }
    }
}
