//! Vectors of 64-bit words: what setup and rows compute with, pixels that single precision does not hold (a word for
//! each, so that a product of 32 bits by 32 needs neither taking apart nor interleaving), and the eight sums of a
//! surface's pixel.
//!
//! Shifts and constants are words in memory and not of the instructions: one compiled copy draws every design.
//!
//! Runs of surfaces are three pixels long: side by side, pixels would leave vectors half empty, and each sum would be a
//! product of its own. The sums of one pixel, 32 bits each, fill a vector whatever the run, so that a splat's share of
//! all of them is two products.

use super::singles::Singles;

/// Two entries of a table at least.
#[derive(Clone, Copy, Debug)]
pub struct Entries<'a>(&'a [u32]);

impl<'a> Entries<'a> {
    /// These, or two zeros if they are fewer.
    #[inline(always)]
    pub fn new(entries: &'a [u32]) -> Self {
        if entries.len() < 2 {
            Entries(&[0; 2])
        } else {
            Entries(entries)
        }
    }

    /// All of them, and the number of the last but one.
    #[inline(always)]
    pub(super) fn to_last(self) -> (&'a [u32], u32) {
        (self.0, (self.0.len() - 2) as u32)
    }
}

/// Sums of a pixel; the last one is the sum of weights.
pub type Sums = [u32; 8];

/// How weight times attribute is brought back to the sums' format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShareShift {
    /// Bits dropped, 1 to 32.
    pub by: u32,
    /// Half of `2^by`, or 0 to truncate.
    pub half: u64,
}

/// Operations on vectors of 64-bit signed words. Arithmetic wraps.
pub trait Lanes: Copy + Send + Sync {
    /// Words of a vector, at most 8.
    const WIDE: usize;
    /// Are the rows of footprints functions that all painters call, and not compiled into each? Calls take some time
    /// from painting, copies took most of the time in which this crate is compiled.
    const ROWS_APART: bool = false;
    /// A vector.
    type Word: Copy;
    /// One truth value per word.
    type Truth: Copy;
    /// Attributes of a splat.
    type Attributes: Copy;
    /// Pixels in single precision on the same processor.
    type Singles: Singles;

    /// See [`Lanes::Singles`].
    fn singles(self) -> Self::Singles;
    /// The same word everywhere.
    fn splat(self, value: i64) -> Self::Word;
    /// The first words of `from`.
    fn load(self, from: &[i64; 8]) -> Self::Word;
    /// Four words: word `c` holds integer `c` of the four that `row` has for each of the vector's places.
    fn columns(self, row: impl Fn(usize) -> [i32; 4]) -> [Self::Word; 4];
    /// The other way round: the lower halves of four words as rows, as many as the vector has places.
    fn rows(self, columns: [Self::Word; 4]) -> [[i32; 4]; 8];
    /// Stores into the first words of `to`.
    fn store(self, to: &mut [i64; 8], value: Self::Word);
    /// a + b.
    fn add(self, a: Self::Word, b: Self::Word) -> Self::Word;
    /// a - b.
    fn sub(self, a: Self::Word, b: Self::Word) -> Self::Word;
    /// a & b.
    fn and(self, a: Self::Word, b: Self::Word) -> Self::Word;
    /// a | b.
    fn or(self, a: Self::Word, b: Self::Word) -> Self::Word;
    /// a ^ b.
    fn xor(self, a: Self::Word, b: Self::Word) -> Self::Word;
    /// a b of words that fit 32 bits.
    fn mul(self, a: Self::Word, b: Self::Word) -> Self::Word;
    /// a b of the lower halves, without signs.
    fn mul_unsigned(self, a: Self::Word, b: Self::Word) -> Self::Word;
    /// Low 64 bits of a b.
    fn mul_whole(self, a: Self::Word, b: Self::Word) -> Self::Word;
    /// a << by; 0 where `by` is negative or beyond 63.
    fn shl(self, a: Self::Word, by: Self::Word) -> Self::Word;
    /// a >> by, filled with zeros; 0 where `by` is negative or beyond 63.
    fn shr(self, a: Self::Word, by: Self::Word) -> Self::Word;
    /// a >> by, filled with the sign; 0 or -1 where `by` is negative or beyond 63.
    fn sar(self, a: Self::Word, by: Self::Word) -> Self::Word;
    /// Zeros before the first one, of words that are not negative; 64 for 0.
    fn leading_zeros(self, a: Self::Word) -> Self::Word;
    /// a >> by of a constant from 0 to 63, filled with the sign.
    #[inline(always)]
    fn sar_by(self, a: Self::Word, by: u32) -> Self::Word {
        self.sar(a, self.splat(by.into()))
    }
    /// `table[index]` in a lower half and `table[index + 1]` above it, of the index's lower 32 bits; the last two
    /// entries beyond the table.
    fn pairs(self, table: Entries, index: Self::Word) -> Self::Word;
    /// The same as two words; zeros of a table that has fewer.
    #[inline(always)]
    fn gather(self, table: &[u32], index: Self::Word) -> [Self::Word; 2] {
        let pairs = self.pairs(Entries::new(table), index);
        [self.lower(pairs), self.upper(pairs)]
    }
    /// a > b.
    fn greater(self, a: Self::Word, b: Self::Word) -> Self::Truth;
    /// a = b.
    fn equal(self, a: Self::Word, b: Self::Word) -> Self::Truth;
    /// `b` where it is true, else `a`.
    fn select(self, a: Self::Word, b: Self::Word, truth: Self::Truth) -> Self::Word;
    /// Is any bit of a word set?
    fn any(self, a: Self::Word) -> bool;
    /// A bit for every word.
    fn flags(self, truth: Self::Truth) -> u32;

    /// All words, and zeros behind them.
    #[inline(always)]
    fn list(self, word: Self::Word) -> [i64; 8] {
        let mut list = [0; 8];
        self.store(&mut list, word);
        list
    }
    /// a + b of a constant.
    #[inline(always)]
    fn plus(self, a: Self::Word, b: i64) -> Self::Word {
        self.add(a, self.splat(b))
    }
    /// -a.
    #[inline(always)]
    fn negate(self, a: Self::Word) -> Self::Word {
        self.sub(self.splat(0), a)
    }
    /// The lesser.
    #[inline(always)]
    fn min(self, a: Self::Word, b: Self::Word) -> Self::Word {
        self.select(a, b, self.greater(a, b))
    }
    /// The greater.
    #[inline(always)]
    fn max(self, a: Self::Word, b: Self::Word) -> Self::Word {
        self.select(a, b, self.greater(b, a))
    }
    /// |a|; the least word stays what it is.
    #[inline(always)]
    fn magnitude(self, a: Self::Word) -> Self::Word {
        self.max(a, self.negate(a))
    }
    /// a << by of a constant.
    #[inline(always)]
    fn shl_by(self, a: Self::Word, by: i64) -> Self::Word {
        self.shl(a, self.splat(by))
    }
    /// a >> by of a constant, filled with zeros.
    #[inline(always)]
    fn shr_by(self, a: Self::Word, by: i64) -> Self::Word {
        self.shr(a, self.splat(by))
    }
    /// The bits of `mask`.
    #[inline(always)]
    fn masked(self, a: Self::Word, mask: i64) -> Self::Word {
        self.and(a, self.splat(mask))
    }

    // Double-precision numbers in the words' bits, each result rounded once to nearest, halves to even.

    /// a + b.
    fn double_add(self, a: Self::Word, b: Self::Word) -> Self::Word;
    /// a - b.
    fn double_sub(self, a: Self::Word, b: Self::Word) -> Self::Word;
    /// a b.
    fn double_mul(self, a: Self::Word, b: Self::Word) -> Self::Word;
    /// a b + c, rounded once.
    fn double_mul_add(self, a: Self::Word, b: Self::Word, c: Self::Word) -> Self::Word;
    /// a b - c, rounded once.
    fn double_mul_sub(self, a: Self::Word, b: Self::Word, c: Self::Word) -> Self::Word;
    /// The smaller one; `b` if one of them is no number.
    fn double_min(self, a: Self::Word, b: Self::Word) -> Self::Word;
    /// The larger one; `b` if one of them is no number.
    fn double_max(self, a: Self::Word, b: Self::Word) -> Self::Word;
    /// The largest integer that is not larger.
    fn double_floor(self, a: Self::Word) -> Self::Word;
    /// The square root.
    fn double_root(self, a: Self::Word) -> Self::Word;
    /// a > b.
    fn double_greater(self, a: Self::Word, b: Self::Word) -> Self::Truth;

    // Pixels of one word each.

    /// The words from place `at` on; zeros if there are fewer than eight.
    #[inline(always)]
    fn read(self, from: &[i64], at: usize) -> Self::Word {
        match from.get(at..).and_then(|rest| rest.first_chunk()) {
            Some(words) => self.load(words),
            None => self.splat(0),
        }
    }
    /// Stores words from place `at` on; nothing if there is no room for eight.
    #[inline(always)]
    fn write(self, to: &mut [i64], at: usize, value: Self::Word) {
        if let Some(words) = to.get_mut(at..).and_then(|rest| rest.first_chunk_mut()) {
            self.store(words, value);
        }
    }
    /// The upper half of each word, in the lower one; 0 where it is negative.
    #[inline(always)]
    fn unmarked(self, a: Self::Word) -> Self::Word {
        self.upper(self.clear(a, self.marked(a)))
    }
    /// The upper half of each word, in the lower one.
    #[inline(always)]
    fn upper(self, a: Self::Word) -> Self::Word {
        self.shr_by(a, 32)
    }
    /// The lower half of each word, in the upper one.
    #[inline(always)]
    fn raised(self, a: Self::Word) -> Self::Word {
        self.shl_by(a, 32)
    }
    /// The lower half of each word.
    #[inline(always)]
    fn lower(self, a: Self::Word) -> Self::Word {
        self.masked(a, u32::MAX.into())
    }
    /// The lower halves of `low` and the upper ones of `high`.
    fn halves(self, low: Self::Word, high: Self::Word) -> Self::Word;
    /// a + b of either half.
    fn add_halves(self, a: Self::Word, b: Self::Word) -> Self::Word;
    /// Words whose most significant bit is set.
    fn marked(self, a: Self::Word) -> Self::Truth;
    /// The first `count` words.
    fn first(self, count: usize) -> Self::Truth;
    /// Both.
    fn both(self, a: Self::Truth, b: Self::Truth) -> Self::Truth;
    /// a and not b.
    fn except(self, a: Self::Truth, b: Self::Truth) -> Self::Truth;
    /// a where it is true, else 0.
    fn keep(self, a: Self::Word, truth: Self::Truth) -> Self::Word;
    /// a where it is false, else 0.
    fn clear(self, a: Self::Word, truth: Self::Truth) -> Self::Word;
    /// The smaller one of words below 2^32.
    fn min_short(self, a: Self::Word, b: Self::Word) -> Self::Word;
    /// 0, a, 2 a, 3 a and so on, of a vector of equal words.
    fn multiples(self, a: Self::Word) -> Self::Word;

    // Sums of a pixel.

    /// Attributes, each of magnitude at most 1 in the shift's format.
    fn attributes(self, values: &[i32; 8], shift: ShareShift) -> Self::Attributes;

    /// Adds `weight`, below 2^31, times the attributes to the sums; magnitudes are rounded. If the last sum would reach
    /// 2^31 all stay as they are, and the answer is false.
    fn add_shares(self, sums: &mut Sums, weight: &i64, attributes: &Self::Attributes) -> bool;
}

/// Does some work in a function of its own: see [`Lanes::ROWS_APART`].
#[inline(never)]
pub fn apart<R>(work: impl FnOnce() -> R) -> R {
    work()
}
