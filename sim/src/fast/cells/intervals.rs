//! The footprint table as vectors read it.

use crate::fast::lanes::factors::Factors;
use crate::fast::lanes::fused::Pairs;
use splatline::format::Widths;
use splatline::kernel::FootprintTable;

/// How far a table reaches.
#[derive(Clone, Copy, Debug)]
pub struct Reach {
    intervals: u64,
    /// Bits of the radial index below an interval's number.
    pub rest_bits: u32,
}

impl Reach {
    /// Of this table.
    pub fn new(table: &FootprintTable) -> Self {
        Reach {
            intervals: table.entries().len().saturating_sub(1) as u64,
            rest_bits: table.rest_bits(),
        }
    }

    /// Do all radial indices up to `last` lie in the table?
    #[inline(always)]
    pub fn covers(&self, last: i64) -> bool {
        last < 0 || ((last as u64) >> self.rest_bits) < self.intervals
    }
}

/// A table's entries in pairs, an interval's value in the upper half of a word, its change in the lower one; and its factors if it
/// is a Gaussian.
#[derive(Clone, Debug)]
pub struct Intervals {
    pub pairs: Pairs,
    pub factors: Option<Factors>,
    pub reach: Reach,
}

impl Intervals {
    /// Every interval of `table`; `None` if an entry exceeds 1.
    pub fn new(table: &FootprintTable, widths: &Widths, range: u8) -> Option<Self> {
        let entries = table.entries();
        let interpolates = widths.interpolation > 0;
        let pair = |pair: &[u32]| {
            let change = if interpolates {
                pair[1].wrapping_sub(pair[0])
            } else {
                0
            };
            (u64::from(pair[0]) << 32) | u64::from(change)
        };
        let fits = entries.iter().all(|entry| *entry <= 1 << widths.weight);
        fits.then(|| Intervals {
            pairs: Pairs::new(entries.windows(2).map(pair).collect()),
            factors: Factors::gaussian(entries, widths, range),
            reach: Reach::new(table),
        })
    }
}
