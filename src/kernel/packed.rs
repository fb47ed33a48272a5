//! The footprint table of small processors: an interval's value and its slope in one word, rounding included.
//!
//! Interpolation between the entries a and b of an interval, at the position f in units of 2^-k, is
//!
//! ```text
//! w = floor((2^k a - (a - b) f + 2^(k-1)) / 2^k) = (word - (a - b) (f + 1)) >> k
//! word = 2^k a + 2^(k-1) + (a - b)
//! ```
//!
//! so that one word holds all that a pixel needs: one load, one multiplication, one subtraction, one shift. The slope
//! a - b lies in the word's low bits, where it also pays for the unit too much in f + 1; and f + 1 is what a lane
//! yields that runs one position ahead. Where that carries into the next interval, f + 1 is 0 and w is b, as it must
//! be. Same bits as [`FootprintTable`](super::FootprintTable).
//!
//! The position is not cut out of the lane: what stands above it is the interval's number i, and the word holds (a - b)
//! 2^k i more, which is 0 again after the multiplication, modulo 2^32.
//!
//! Two more instructions are saved by what lies before and behind the table. Radial indices below 0 are rounding noise
//! and count as 0: lanes run one *interval* ahead too, and the first word is a level one, so that no pixel clamps. And
//! an index is as many bits of the lane as the table has, which cannot miss it. The last interval gives its place to
//! the level one; cut-offs by opacity end at 15, one unit before the table. A host whose footprints reach the table's
//! end packs two words more ([`pack_into`]). Lanes whose lowest bit is the position's
//! (`radial + range == table + interpolation`) need no shift.

use crate::format::Widths;

/// Bits of a radial index that a lane word has.
const LANE: u32 = 31;

/// Base-2 logarithm of the rounding noise of a run's radial indices in the lanes' unit: `BLOCK^2/32 + BLOCK` and a few
/// roundings.
const LANE_NOISE: u32 = 7;

/// A packed table: one word for each of `2^table` intervals, made by [`pack`].
#[derive(Clone, Copy, Debug)]
pub struct PackedTable<'a> {
    words: &'a [u32],
    table: u8,
    interpolation: u8,
    radial: u8,
    range: u8,
}

/// Why a design has no packed table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PackedError {
    /// The words are not as many as the intervals, `2^table`.
    Intervals,
    /// The largest radial index leaves the lane: `radial + range` must be at most 31, and at least
    /// `table + interpolation`.
    Alignment,
    /// Values rise, or value and slope have no room in one word: `2^k a + 2^(k-1)` must be below 2^32 and a - b below
    /// `2^(k-1)`.
    Room,
    /// Intervals are so narrow that the rounding noise of the row seeds exceeds one: `mantissa` must be at least
    /// `table + 4`, and `radial + range` at least `table + 7`.
    Noise,
}

/// Packs the entries of a footprint table that was filled for the same widths and range ([`super::gaussian`],
/// [`super::fill`]); at compile time for firmware.
pub const fn pack<const N: usize>(
    entries: &[u32],
    widths: &Widths,
    range: u8,
) -> Result<[u32; N], PackedError> {
    let mut words = [0; N];
    match pack_into(&mut words, entries, widths, range) {
        Ok(()) => Ok(words),
        Err(error) => Err(error),
    }
}

/// The same into memory that the caller lends: one word less than there are entries, or one more, of which the last two
/// are the last interval's and its end's, which [`PackedTable`] has no place for. Radial indices far below 0, which no
/// run of setup has, must be raised to 0 before they [lead](PackedTable::lead).
pub const fn pack_into(
    words: &mut [u32],
    entries: &[u32],
    widths: &Widths,
    range: u8,
) -> Result<(), PackedError> {
    let intervals = 1usize << widths.table;
    if entries.len() != intervals + 1 || (words.len() != intervals && words.len() != intervals + 2)
    {
        return Err(PackedError::Intervals);
    }
    let lane = widths.radial as u32 + range as u32;
    let position = widths.interpolation as u32;
    if lane > LANE || lane < widths.table as u32 + position {
        return Err(PackedError::Alignment);
    }
    // A seed's product is rounded to the mantissa: 16 * 2^-mantissa at most, with room for its two roundings and the
    // steps'.
    if widths.mantissa < widths.table + 4 || lane < widths.table as u32 + LANE_NOISE {
        return Err(PackedError::Noise);
    }
    let mut i = 0;
    while i < words.len() {
        let level = if i == 0 { 0 } else { i - 1 };
        let end = if i < entries.len() { i } else { level };
        match word(entries[level], entries[end], i as u32, position) {
            Some(packed) => words[i] = packed,
            None => return Err(PackedError::Room),
        }
        i += 1;
    }
    Ok(())
}

impl<'a> PackedTable<'a> {
    /// A table of words that [`pack`] made for the same widths and range.
    pub const fn new(words: &'a [u32], widths: &Widths, range: u8) -> Result<Self, PackedError> {
        if words.len() != 1 << widths.table {
            return Err(PackedError::Intervals);
        }
        Ok(PackedTable {
            words,
            table: widths.table,
            interpolation: widths.interpolation,
            radial: widths.radial,
            range,
        })
    }

    /// The words, for a pixel loop of one's own that keeps them otherwise.
    #[inline(always)]
    pub const fn words(&self) -> &'a [u32] {
        self.words
    }

    /// The slope a - b in a word; `interpolation` is the width that the table was packed for, and not 0.
    #[inline(always)]
    pub const fn slope(word: u32, interpolation: u8) -> u32 {
        word & (1u32.wrapping_shl(interpolation.wrapping_sub(1) as u32) - 1)
    }

    /// Was the table packed for these widths and this range?
    #[inline(always)]
    pub const fn is_for(&self, widths: &Widths, range: u8) -> bool {
        self.table == widths.table
            && self.interpolation == widths.interpolation
            && self.radial == widths.radial
            && self.range == range
    }

    /// The same table with as many words as the widths say: where those are a constant, so is their number, and no
    /// pixel compares with it.
    #[inline(always)]
    pub(crate) fn of_length(self, widths: &Widths) -> Option<Self> {
        let words = self.words.get(..1usize.wrapping_shl(widths.table.into()))?;
        Some(PackedTable { words, ..self })
    }

    /// How far lanes must run ahead of the radial index, UQ4.radial: one interval and one unit of the position within
    /// it.
    #[inline(always)]
    pub const fn lead(widths: &Widths, range: u8) -> u32 {
        let below = below_index(widths, range);
        let position = match widths.interpolation {
            0 => 0,
            k => 1u32.wrapping_shl(below.wrapping_sub(k as u32)),
        };
        1u32.wrapping_shl(below) + position
    }

    /// Kernel at the radial index `ahead - lead` (UQ4.radial, below `2^range`), UQ1.weight, rounded to nearest; for
    /// `ahead` below the lead the kernel at 0. For the widths and the range that the table was packed for.
    #[inline(always)]
    pub fn weight(&self, ahead: u32, widths: &Widths, range: u8) -> u32 {
        let below = below_index(widths, range);
        let index = ahead.wrapping_shr(below) as usize & self.words.len().wrapping_sub(1);
        let word = self.words.get(index).copied().unwrap_or(0);
        let position = u32::from(widths.interpolation);
        if position == 0 {
            return word;
        }
        let after = ahead.wrapping_shr(below.wrapping_sub(position));
        let slope = Self::slope(word, widths.interpolation);
        word.wrapping_sub(slope.wrapping_mul(after))
            .wrapping_shr(position)
    }
}

/// Bits of a lane below the table's index.
#[inline(always)]
const fn below_index(widths: &Widths, range: u8) -> u32 {
    (widths.radial as u32 + range as u32).wrapping_sub(widths.table as u32)
}

/// The interval with this number, from `a` to `b`; `None` if it does not fit.
const fn word(a: u32, b: u32, number: u32, position: u32) -> Option<u32> {
    if position == 0 {
        return Some(a);
    }
    if b > a || a - b >= 1 << (position - 1) {
        return None;
    }
    let half = 1u64 << (position - 1);
    if ((a as u64) << position) + half > u32::MAX as u64 {
        return None;
    }
    let above = (a - b).wrapping_mul(number) << position;
    Some(((a << position) + half as u32 + (a - b)).wrapping_add(above))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::format::Standard24;
    extern crate std;
    use std::{vec, vec::Vec};

    #[test]
    fn a_word_has_room_for_value_and_slope() {
        let number = 5u32;
        let expected = (20 << 4) + 8 + 7 + ((7 * number) << 4);
        assert_eq!(word(20, 13, number, 4), Some(expected));
        assert_eq!(word(20, 12, number, 4), None);
        assert_eq!(word(20, 21, number, 4), None);
        assert_eq!(word(20, 0, number, 0), Some(20));
        assert_eq!(word(0x0fff_ffff, 0x0fff_ffff, 1, 4), Some(0xffff_fff8));
        assert_eq!(word(0x1000_0000, 0x1000_0000, 1, 4), None);
        assert_eq!(word(0x7fff_ffff, 0x7fff_ffff, 0, 1), Some(u32::MAX));
    }

    #[test]
    fn tables_are_packed_within_their_limits() {
        let widths = Widths {
            table: 4,
            interpolation: 2,
            radial: 7,
            mantissa: 8,
            ..Standard24::WIDTHS
        };
        let entries: Vec<u32> = (0..17).map(|index| 16 - index).collect();
        let packed = |words: usize, entries: &[u32], widths: &Widths| {
            let mut memory = vec![0; words];
            pack_into(&mut memory, entries, widths, 4).map(|()| memory)
        };
        let words = packed(16, &entries, &widths).unwrap();
        assert_eq!(words[..2], [(16 << 2) + 2, (16 << 2) + 2 + 1 + (1 << 2)]);
        let longer = packed(18, &entries, &widths).unwrap();
        assert_eq!(longer[..16], words);
        assert_eq!(longer[16..], [(1 << 2) + 3 + (16 << 2), 2]);
        assert_eq!(pack::<16>(&entries, &widths, 4).unwrap()[..], words);
        for (words, entries) in [(17, 17), (15, 17), (16, 16), (16, 18), (18, 16)] {
            let entries = vec![0; entries];
            let refused = Err(PackedError::Intervals);
            assert_eq!(packed(words, &entries, &widths), refused);
        }
        let narrow = [
            Widths {
                mantissa: 7,
                ..widths
            },
            Widths {
                radial: 6,
                ..widths
            },
        ];
        for widths in narrow {
            assert_eq!(packed(16, &entries, &widths), Err(PackedError::Noise));
        }
    }
}
