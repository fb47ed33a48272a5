//! First and last columns of a footprint's rows, eight rows in a vector, bit for bit those of the kernel's [`EllipseSpans`].
//!
//! The clock needs no seeds, so that a footprint's rows are computed once, whatever the tiles that they cross. Where a word would be too long
//! for the vectors' arithmetic the kernel's own rows are taken.

use crate::fast::lanes::Wide;
use crate::fast::recurrence::{RowVectors, is_zero, stays_near};
use crate::fast::rows::columns;
use crate::fast::setup::number::Arithmetic;
use splatline::raster::{EllipseSpans, RowConstants, Spans as _};

/// Rows of a vector, whatever the processor: one with fewer words takes two turns.
const STEP: usize = 8;

/// Places behind the last row that vectors may write or read.
const SPARE: usize = 32;

/// Spans of one footprint's rows: memory that is used again for every footprint.
pub struct SpanMemory {
    first: Vec<u16>,
    end: Vec<u16>,
}

impl SpanMemory {
    /// Room for so many rows.
    pub fn new(rows: usize) -> Self {
        SpanMemory {
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
    pub fn fill<L: Wide, K: splatline::format::Lane>(&mut self, lanes: L, rows: EllipseSpans<K>) {
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
        if !stays_near(constants, count) {
            return false;
        }
        let mut rows = RowVectors::new(lanes, constants, 0);
        for start in (0..count).step_by(L::WIDE) {
            let (first, end) = span(lanes, constants, rows.centre, rows.rest(lanes));
            store(lanes, &mut self.first, start, first);
            store(lanes, &mut self.end, start, end);
            rows.step(lanes);
        }
        is_zero(lanes, rows.excess(lanes))
    }

    #[cold]
    #[inline(never)]
    fn by_the_kernel<K: splatline::format::Lane>(
        &mut self,
        mut rows: EllipseSpans<K>,
        [top, bottom]: [u16; 2],
    ) {
        let count = usize::from(bottom.saturating_sub(top));
        self.first[..count].fill(0);
        self.end[..count].fill(0);
        while let Some(run) = rows.next_span() {
            let row = usize::from(run.y - top);
            if self.end[row] == 0 {
                self.first[row] = run.x;
            }
            self.end[row] = run.x + run.length;
        }
    }
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
