//! The packed table in the layout of loops that read value and slope by themselves.

use super::LANE;
use crate::table::{INTERVALS, WORDS};
use splatline::draw::NarrowLanes;

/// An interval as most loops read it: Armv6-M both words by one instruction.
#[cfg(not(feature = "plain"))]
pub type Interval = [u32; 2];
/// Without interpolation the value is all there is.
#[cfg(feature = "plain")]
pub type Interval = u16;

const fn interval(word: u32) -> Interval {
    #[cfg(not(feature = "plain"))]
    return [
        word,
        splatline::kernel::PackedTable::slope(word, super::INTERPOLATION),
    ];
    #[cfg(feature = "plain")]
    return {
        assert!(word < 1 << 16);
        word as u16
    };
}

/// The packed table in the loop's layout. No radial index inside a footprint reads beside it: `paint` sees to that.
pub static TABLE: [Interval; INTERVALS] = {
    let mut table = [interval(0); INTERVALS];
    let mut i = 0;
    while i < INTERVALS {
        table[i] = interval(WORDS[i]);
        i += 1;
    }
    table
};

/// Lanes whose largest index lies in the table: the comparison with it is unsigned, and all that keeps a radial index
/// within.
#[inline(always)]
pub fn within_table(lanes: NarrowLanes) -> NarrowLanes {
    let last = (lanes.last as u32).min((1 << LANE) - 1) as i32;
    NarrowLanes { last, ..lanes }
}
