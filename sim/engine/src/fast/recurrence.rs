//! The recurrences down a footprint's rows, as many rows at once as a vector has words.
//!
//! Both sequences are polynomials in integers that wrap: row k has `centre + k slope` and
//! `vertical + k change + k (k - 1) / 2 second`, without an order of summation. Root, span and seeds of a row follow
//! from its words ([`rows`](super::rows)).

use super::lanes::Wide;
use super::row_words::longest_rest;
use super::setup::number::Arithmetic;
use splatline::raster::{RowBlock, RowConstants};

/// Most words of a vector.
const WORDS: usize = 8;

/// xc - 1/2 and C dy^2 of some rows, and what leads to the next ones.
pub struct RowVectors<L: Wide> {
    /// xc - 1/2 of each row.
    pub centre: L::Word,
    /// C dy^2 of each row.
    pub vertical: L::Word,
    slope: L::Word,
    change: L::Word,
    second: L::Word,
    /// The cut-off, and the largest rest of it so far.
    reach: L::Word,
    longest: L::Word,
    limit: u32,
}

impl<L: Wide> RowVectors<L> {
    /// The first rows of a block.
    #[inline(always)]
    pub fn new(lanes: L, constants: &RowConstants<i64>, block: &RowBlock) -> Self {
        let splat = |value| lanes.wide_splat(value);
        let width = L::WIDE as i64;
        let rows: [i64; WORDS] = [0, 1, 2, 3, 4, 5, 6, 7];
        let pairs: [i64; WORDS] = [0, 0, 1, 3, 6, 10, 15, 21];
        let [rows, pairs] = [lanes.wide_load(&rows), lanes.wide_load(&pairs)];
        let times = |rows: L::Word, value| lanes.wide_mul_whole(rows, splat(value));
        let ([vertical, change], second) = (block.vertical, constants.curve);
        // From row k to row k + w: w (change + k second) + w (w - 1) / 2 second.
        let along = change
            .wrapping_mul(width)
            .wrapping_add(second.wrapping_mul(width * (width - 1) / 2));
        let curved = lanes.wide_add(times(rows, change), times(pairs, second));
        let along_of_row = times(rows, second.wrapping_mul(width));
        RowVectors {
            centre: lanes.wide_add(splat(block.centre), times(rows, constants.shear)),
            vertical: lanes.wide_add(splat(vertical), curved),
            slope: splat(constants.shear.wrapping_mul(width)),
            change: lanes.wide_add(splat(along), along_of_row),
            second: splat(second.wrapping_mul(width * width)),
            reach: splat(constants.reach),
            longest: splat(0),
            limit: longest_rest(constants.drops.1, constants.vertical_fraction),
        }
    }

    /// What the rows leave of the cut-off.
    #[inline(always)]
    pub fn rest(&self, lanes: L) -> L::Word {
        lanes.wide_sub(self.reach, self.vertical)
    }

    /// On to the next rows.
    #[inline(always)]
    pub fn step(&mut self, lanes: L) {
        self.longest = Arithmetic { lanes }.max(self.longest, self.rest(lanes));
        self.centre = lanes.wide_add(self.centre, self.slope);
        self.vertical = lanes.wide_add(self.vertical, self.change);
        self.change = lanes.wide_add(self.change, self.second);
    }

    /// Bits of what the rows behind us left of the cut-off that the root does not take: 0 if there are none.
    #[inline(always)]
    pub fn excess(&self, lanes: L) -> L::Word {
        lanes.wide_shr(self.longest, lanes.wide_splat(self.limit.into()))
    }
}

/// Do the words of so many rows fit the vectors' arithmetic, apart from what is noticed row by row?
#[inline(always)]
pub fn stays_near(constants: &RowConstants<i64>, count: usize) -> bool {
    let farthest = 1 << 60;
    let is_near = |block: &RowBlock| block.centre.unsigned_abs() < farthest;
    has_short_squared_width(constants)
        && constants.blocks.iter().all(is_near)
        && constants.shear.unsigned_abs() < farthest / (count + WORDS) as u64
}

/// Is 1 / A small enough for `SquaredWidth`?
#[inline(always)]
pub fn has_short_squared_width(constants: &RowConstants<i64>) -> bool {
    // Designs of at most 18 bits multiply the root's argument in two halves.
    let bits = if constants.drops.1 <= 18 { 18 } else { 32 };
    constants.squared_width.0 < 1 << bits && constants.squared_width.2 <= 30
}
