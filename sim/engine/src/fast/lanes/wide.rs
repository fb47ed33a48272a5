//! Vectors of 64-bit words: the operations of setup, for the same processors as the pixel path's.
//!
//! The portable implementation, on arrays, is the definition.

#![allow(unsafe_code)]

use super::Portable;

/// Operations on vectors of 64-bit signed words. Arithmetic wraps.
pub trait Wide: Copy + Send + Sync {
    /// Words of a vector, at most 8.
    const WIDE: usize;
    /// Are the rows of footprints functions that all painters call, and not compiled into each? Calls take some time
    /// from painting, copies took most of the time in which this crate is compiled.
    const ROWS_APART: bool = false;
    /// A vector.
    type Word: Copy;
    /// One truth value per word.
    type Truth: Copy;

    /// The same word everywhere.
    fn wide_splat(self, value: i64) -> Self::Word;
    /// The first words of `from`.
    fn wide_load(self, from: &[i64; 8]) -> Self::Word;
    /// Four words: word `c` holds integer `c` of the four that `row` has for each of the vector's places.
    fn wide_columns(self, row: impl Fn(usize) -> [i32; 4]) -> [Self::Word; 4];
    /// The other way round: stores the lower halves of four words into as many rows as the vector has places.
    fn wide_rows(self, to: &mut [[i32; 4]; 8], columns: [Self::Word; 4]);
    /// Stores into the first words of `to`.
    fn wide_store(self, to: &mut [i64; 8], value: Self::Word);
    /// a + b.
    fn wide_add(self, a: Self::Word, b: Self::Word) -> Self::Word;
    /// a - b.
    fn wide_sub(self, a: Self::Word, b: Self::Word) -> Self::Word;
    /// a & b.
    fn wide_and(self, a: Self::Word, b: Self::Word) -> Self::Word;
    /// a | b.
    fn wide_or(self, a: Self::Word, b: Self::Word) -> Self::Word;
    /// a ^ b.
    fn wide_xor(self, a: Self::Word, b: Self::Word) -> Self::Word;
    /// a b of words that fit 32 bits.
    fn wide_mul(self, a: Self::Word, b: Self::Word) -> Self::Word;
    /// a b of words that fit 32 bits without a sign.
    fn wide_mul_unsigned(self, a: Self::Word, b: Self::Word) -> Self::Word;
    /// Low 64 bits of a b.
    fn wide_mul_whole(self, a: Self::Word, b: Self::Word) -> Self::Word;
    /// a << by; 0 where `by` is negative or beyond 63.
    fn wide_shl(self, a: Self::Word, by: Self::Word) -> Self::Word;
    /// a >> by, filled with zeros; 0 where `by` is negative or beyond 63.
    fn wide_shr(self, a: Self::Word, by: Self::Word) -> Self::Word;
    /// a >> by, filled with the sign; 0 or -1 where `by` is negative or beyond 63.
    fn wide_sar(self, a: Self::Word, by: Self::Word) -> Self::Word;
    /// Zeros before the first one, of words that are not negative; 64 for 0.
    fn wide_leading_zeros(self, a: Self::Word) -> Self::Word;
    /// a >> by of a constant from 0 to 63, filled with the sign.
    #[inline(always)]
    fn wide_sar_by(self, a: Self::Word, by: u32) -> Self::Word {
        self.wide_sar(a, self.wide_splat(by.into()))
    }
    /// `table[index]` and `table[index + 1]` of the index's lower 32 bits; the last two entries beyond the table, zeros
    /// if it has fewer.
    fn wide_gather(self, table: &[u32], index: Self::Word) -> [Self::Word; 2];
    /// a > b.
    fn wide_greater(self, a: Self::Word, b: Self::Word) -> Self::Truth;
    /// a = b.
    fn wide_equal(self, a: Self::Word, b: Self::Word) -> Self::Truth;
    /// `b` where it is true, else `a`.
    fn wide_select(self, a: Self::Word, b: Self::Word, truth: Self::Truth) -> Self::Word;
    /// Is any bit of a word set?
    fn wide_any(self, a: Self::Word) -> bool;
    /// A bit for every word.
    fn wide_flags(self, truth: Self::Truth) -> u32;
}

/// Does some work in a function of its own: see [`Wide::ROWS_APART`].
#[inline(never)]
pub fn apart<R>(work: impl FnOnce() -> R) -> R {
    work()
}

/// Eight words of 64 bits as an array.
pub(super) type Words = [i64; 8];

#[inline(always)]
pub(super) fn zip(a: Words, b: Words, operation: impl Fn(i64, i64) -> i64) -> Words {
    std::array::from_fn(|k| operation(a[k], b[k]))
}

/// A shift amount, if it is one.
#[inline(always)]
fn amount(by: i64) -> Option<u32> {
    u32::try_from(by).ok().filter(|by| *by < 64)
}

impl Wide for Portable {
    const WIDE: usize = 8;
    /// Where arrays are there to be compared with, on x86-64 and in tests: an operation is ten times the instructions
    /// of a vector's.
    const ROWS_APART: bool = cfg!(any(target_arch = "x86_64", test));
    type Word = Words;
    type Truth = [bool; 8];

    #[cfg_attr(not(test), inline(always))]
    fn wide_splat(self, value: i64) -> Words {
        [value; 8]
    }
    #[cfg_attr(not(test), inline(always))]
    fn wide_load(self, from: &[i64; 8]) -> Words {
        *from
    }
    #[cfg_attr(not(test), inline(always))]
    fn wide_columns(self, row: impl Fn(usize) -> [i32; 4]) -> [Words; 4] {
        let rows: [[i32; 4]; 8] = std::array::from_fn(row);
        std::array::from_fn(|column| rows.map(|row| row[column].into()))
    }
    #[cfg_attr(not(test), inline(always))]
    fn wide_rows(self, to: &mut [[i32; 4]; 8], columns: [Words; 4]) {
        *to = std::array::from_fn(|k| columns.map(|word| word[k] as i32));
    }
    #[cfg_attr(not(test), inline(always))]
    fn wide_store(self, to: &mut [i64; 8], value: Words) {
        *to = value;
    }
    #[cfg_attr(not(test), inline(always))]
    fn wide_add(self, a: Words, b: Words) -> Words {
        zip(a, b, i64::wrapping_add)
    }
    #[cfg_attr(not(test), inline(always))]
    fn wide_sub(self, a: Words, b: Words) -> Words {
        zip(a, b, i64::wrapping_sub)
    }
    #[cfg_attr(not(test), inline(always))]
    fn wide_and(self, a: Words, b: Words) -> Words {
        zip(a, b, |a, b| a & b)
    }
    #[cfg_attr(not(test), inline(always))]
    fn wide_or(self, a: Words, b: Words) -> Words {
        zip(a, b, |a, b| a | b)
    }
    #[cfg_attr(not(test), inline(always))]
    fn wide_xor(self, a: Words, b: Words) -> Words {
        zip(a, b, |a, b| a ^ b)
    }
    #[cfg_attr(not(test), inline(always))]
    fn wide_mul(self, a: Words, b: Words) -> Words {
        zip(a, b, |a, b| i64::from(a as i32) * i64::from(b as i32))
    }
    #[cfg_attr(not(test), inline(always))]
    fn wide_mul_whole(self, a: Words, b: Words) -> Words {
        zip(a, b, i64::wrapping_mul)
    }
    #[cfg_attr(not(test), inline(always))]
    fn wide_shl(self, a: Words, by: Words) -> Words {
        zip(a, by, |a, by| amount(by).map_or(0, |by| a << by))
    }
    #[cfg_attr(not(test), inline(always))]
    fn wide_sar(self, a: Words, by: Words) -> Words {
        zip(a, by, |a, by| a >> amount(by).unwrap_or(63))
    }
    #[cfg_attr(not(test), inline(always))]
    fn wide_leading_zeros(self, a: Words) -> Words {
        a.map(|a| a.leading_zeros().into())
    }
    #[cfg_attr(not(test), inline(always))]
    fn wide_mul_unsigned(self, a: Words, b: Words) -> Words {
        zip(a, b, |a, b| {
            (u64::from(a as u32) * u64::from(b as u32)) as i64
        })
    }
    #[cfg_attr(not(test), inline(always))]
    fn wide_shr(self, a: Words, by: Words) -> Words {
        zip(a, by, |a, by| {
            amount(by).map_or(0, |by| (a as u64 >> by) as i64)
        })
    }
    #[cfg_attr(not(test), inline(always))]
    fn wide_gather(self, table: &[u32], index: Words) -> [Words; 2] {
        let last = table.len().saturating_sub(2) as u32;
        let first = index.map(|index| (index as u32).min(last) as usize);
        let entry = |index: usize| table.get(index..).and_then(|pair| pair.first_chunk::<2>());
        let pairs = first.map(|first| entry(first).copied().unwrap_or_default());
        [0, 1].map(|which| pairs.map(|pair| i64::from(pair[which])))
    }
    #[cfg_attr(not(test), inline(always))]
    fn wide_greater(self, a: Words, b: Words) -> [bool; 8] {
        std::array::from_fn(|k| a[k] > b[k])
    }
    #[cfg_attr(not(test), inline(always))]
    fn wide_equal(self, a: Words, b: Words) -> [bool; 8] {
        std::array::from_fn(|k| a[k] == b[k])
    }
    #[cfg_attr(not(test), inline(always))]
    fn wide_select(self, a: Words, b: Words, truth: [bool; 8]) -> Words {
        std::array::from_fn(|k| if truth[k] { b[k] } else { a[k] })
    }
    #[cfg_attr(not(test), inline(always))]
    fn wide_any(self, a: Words) -> bool {
        a.iter().any(|a| *a != 0)
    }
    #[cfg_attr(not(test), inline(always))]
    fn wide_flags(self, truth: [bool; 8]) -> u32 {
        let bits = truth.iter().enumerate();
        bits.fold(0, |all, (k, truth)| all | u32::from(*truth) << k)
    }
}

#[cfg(target_arch = "x86_64")]
pub(super) mod x86;
