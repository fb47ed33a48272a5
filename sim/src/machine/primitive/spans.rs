//! First and last columns of a footprint's rows, eight rows in a vector, bit for bit those of the kernel's [`SpanRows`].
//!
//! The clock needs no seeds, so that a footprint's rows are computed once, whatever the tiles that they cross. Down the rows both sequences are
//! polynomials in integers that wrap: row k is `centre + k slope` and `vertical + k change + k (k - 1) / 2 second`, without an order of
//! summation. Where a word would be too long for the vectors' arithmetic the kernel's own rows are taken.

use crate::fast::lanes::Wide;
use crate::fast::rows::{columns, has_short_spread};
use crate::fast::setup::number::Arithmetic;
use splatline::raster::{RowConstants, Rows, SpanRows};

/// Rows of a vector, whatever the processor: one with fewer words takes two turns.
const STEP: usize = 8;

/// Places behind the last row that vectors may write or read.
const SPARE: usize = 32;

/// Spans of one footprint's rows: memory that is used again for every footprint.
pub struct Spans {
    first: Vec<u16>,
    end: Vec<u16>,
}

impl Spans {
    /// Room for so many rows.
    pub fn new(rows: usize) -> Self {
        Spans {
            first: vec![0; rows + SPARE],
            end: vec![0; rows + SPARE],
        }
    }

    /// First columns, and columns one past the last, of the rows from `row` on; of use are those that the footprint has. A row without
    /// pixels ends where it begins, or before.
    #[inline(always)]
    pub fn starting_at(&self, row: usize) -> Option<(&[u16; SPARE], &[u16; SPARE])> {
        let first = self.first.get(row..)?.first_chunk()?;
        Some((first, self.end.get(row..)?.first_chunk()?))
    }

    /// Fills in the rows of a footprint.
    #[inline(always)]
    pub fn fill<L: Wide, K: splatline::format::Lane>(&mut self, lanes: L, rows: SpanRows<K>) {
        let constants = rows.constants().widened();
        if !self.by_vectors(lanes, &constants) {
            self.by_the_kernel(rows, constants.rows);
        }
    }

    /// `false` where a word is too long.
    #[inline(always)]
    fn by_vectors<L: Wide>(&mut self, lanes: L, constants: &RowConstants<i64>) -> bool {
        let [top, bottom] = constants.rows;
        let count = usize::from(bottom.saturating_sub(top));
        if !is_tame(constants, count) {
            return false;
        }
        let mut rows = RowVectors::new(lanes, constants);
        let mut longest = lanes.wide_splat(0);
        for start in (0..count).step_by(L::WIDE) {
            let rest = lanes.wide_sub(lanes.wide_splat(constants.reach), rows.vertical);
            longest = Arithmetic { lanes }.max(longest, rest);
            let (first, end) = span(lanes, constants, rows.centre, rest);
            store(lanes, &mut self.first, start, first);
            store(lanes, &mut self.end, start, end);
            rows.step(lanes);
        }
        // Remaining radial indices of 2^56 and more would lose bits above the root's argument.
        let mut words = [0; STEP];
        lanes.wide_store(&mut words, longest);
        words.iter().fold(0, |all, word| all | word) >> 56 == 0
    }

    #[cold]
    #[inline(never)]
    fn by_the_kernel<K: splatline::format::Lane>(
        &mut self,
        mut rows: SpanRows<K>,
        [top, bottom]: [u16; 2],
    ) {
        let count = usize::from(bottom.saturating_sub(top));
        self.first[..count].fill(0);
        self.end[..count].fill(0);
        while let Some(run) = rows.next_run() {
            let row = usize::from(run.y - top);
            if self.end[row] == 0 {
                self.first[row] = run.x;
            }
            self.end[row] = run.x + run.length;
        }
    }
}

/// Do the words of so many rows fit the vectors' arithmetic, apart from what is noticed row by row?
#[inline(always)]
fn is_tame(constants: &RowConstants<i64>, count: usize) -> bool {
    let farthest = 1 << 60;
    has_short_spread(constants)
        && constants.centre.unsigned_abs() < farthest
        && constants.slope.unsigned_abs() < farthest / (count + STEP) as u64
}

/// xc - 1/2 and C dy^2 of as many rows as a vector has words, and what leads to the next ones.
struct RowVectors<L: Wide> {
    centre: L::Word,
    slope: L::Word,
    vertical: L::Word,
    change: L::Word,
    second: L::Word,
}

impl<L: Wide> RowVectors<L> {
    #[inline(always)]
    fn new(lanes: L, constants: &RowConstants<i64>) -> Self {
        let splat = |value| lanes.wide_splat(value);
        let width = L::WIDE as i64;
        let rows: [i64; STEP] = std::array::from_fn(|k| k as i64);
        let pairs = rows.map(|k| k * (k - 1) / 2);
        let [vertical, change, second] = constants.vertical;
        let slopes = multiples(lanes, constants.slope, rows);
        let changes = multiples(lanes, change, rows);
        let seconds = multiples(lanes, second, pairs);
        // From row k to row k + w: w (change + k second) + w (w - 1) / 2 second.
        let ahead = change
            .wrapping_mul(width)
            .wrapping_add(second.wrapping_mul(width * (width - 1) / 2));
        let ahead_of_row = multiples(lanes, second.wrapping_mul(width), rows);
        RowVectors {
            centre: lanes.wide_add(splat(constants.centre), slopes),
            slope: splat(constants.slope.wrapping_mul(width)),
            vertical: lanes.wide_add(splat(vertical), lanes.wide_add(changes, seconds)),
            change: lanes.wide_add(splat(ahead), ahead_of_row),
            second: splat(second.wrapping_mul(width * width)),
        }
    }

    #[inline(always)]
    fn step(&mut self, lanes: L) {
        self.centre = lanes.wide_add(self.centre, self.slope);
        self.vertical = lanes.wide_add(self.vertical, self.change);
        self.change = lanes.wide_add(self.change, self.second);
    }
}

/// `value` times small numbers below 32 that the compiler knows: sums of its multiples by powers of two.
#[inline(always)]
fn multiples<L: Wide>(lanes: L, value: i64, times: [i64; STEP]) -> L::Word {
    let mut sum = lanes.wide_splat(0);
    for bit in 0..5 {
        let chosen = times.map(|times| -(times >> bit & 1));
        if chosen != [0; STEP] {
            let multiple = lanes.wide_splat(value.wrapping_shl(bit));
            sum = lanes.wide_add(sum, lanes.wide_and(multiple, lanes.wide_load(&chosen)));
        }
    }
    sum
}

/// First and one past the last column of the rows' spans within the footprint's box; 0 and 0 where the ellipse does not reach.
#[inline(always)]
fn span<L: Wide>(
    lanes: L,
    constants: &RowConstants<i64>,
    centre: L::Word,
    rest: L::Word,
) -> (L::Word, L::Word) {
    let math = Arithmetic { lanes };
    let (low, high) = columns(math, constants, centre, rest);
    let open = math.greater(rest, math.splat(0));
    let where_open = |column| math.select(math.splat(0), column, open);
    (where_open(low), where_open(high))
}

/// A vector's columns, each of which fits 16 bits, to the rows from `start` on.
#[inline(always)]
fn store<L: Wide>(lanes: L, to: &mut [u16], start: usize, columns: L::Word) {
    let mut words = [0; STEP];
    lanes.wide_store(&mut words, columns);
    if let Some(to) = to
        .get_mut(start..)
        .and_then(|to| to.first_chunk_mut::<STEP>())
    {
        *to = words.map(|word| word as u16);
    }
}
