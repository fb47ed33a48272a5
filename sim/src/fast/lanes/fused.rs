//! Vectors of 64-bit words with the fused product of 52 bits: `acc + (a b >> 52)`, one instruction of AVX-512 IFMA.
//!
//! It does a fixed-point product, its shift and the addition of a rounding constant at once, as a fused product does in floating point. The
//! portable implementation, on arrays, is the definition; it serves the tests and is not meant to be fast.

#![allow(unsafe_code)]

use super::{Portable, Wide};

/// Fraction bits that the fused product drops.
pub const DROPPED: u32 = 52;

/// Operations of the fused pixel path. Arithmetic wraps.
pub trait Fused: Wide {
    /// 0, 1, 2, ...
    fn wide_iota(self) -> Self::Word;
    /// The first words of `from`, which must have [`Wide::WIDE`] of them; zeros if it has not.
    fn read(self, from: &[u64]) -> Self::Word;
    /// Stores into the first words of `to`; nothing if it has fewer than [`Wide::WIDE`].
    fn write(self, to: &mut [u64], value: Self::Word);
    /// acc + (a b >> 52), of the low 52 bits of a and of b.
    fn fused(self, acc: Self::Word, a: Self::Word, b: Self::Word) -> Self::Word;
    /// The same where it is true, else acc.
    fn fused_where(
        self,
        acc: Self::Word,
        a: Self::Word,
        b: Self::Word,
        truth: Self::Truth,
    ) -> Self::Word;
    /// a b of words that fit 32 bits without a sign, low 32 bits.
    fn mul_words(self, a: Self::Word, b: Self::Word) -> Self::Word;
    /// Low 64 bits of a b.
    fn mul_whole(self, a: Self::Word, b: Self::Word) -> Self::Word;
    /// Sums of the 32-bit halves, each by itself.
    fn add_words(self, a: Self::Word, b: Self::Word) -> Self::Word;
    /// The larger ones of the 32-bit halves, as signed numbers.
    fn max_words(self, a: Self::Word, b: Self::Word) -> Self::Word;
    /// The larger one, as signed numbers.
    fn max_whole(self, a: Self::Word, b: Self::Word) -> Self::Word;
    /// The smaller one, as unsigned numbers.
    fn min_whole(self, a: Self::Word, b: Self::Word) -> Self::Word;
    /// a turned to the right by this many bits, 0 to 63.
    fn turn(self, a: Self::Word, by: Self::Word) -> Self::Word;
    /// (a & mask) | b.
    fn merge(self, a: Self::Word, mask: Self::Word, b: Self::Word) -> Self::Word;
    /// a & mask where it is true, 0 elsewhere.
    fn keep(self, a: Self::Word, mask: Self::Word, truth: Self::Truth) -> Self::Word;
    /// a where it is true, b | c elsewhere.
    fn choose(self, a: Self::Word, b: Self::Word, c: Self::Word, truth: Self::Truth) -> Self::Word;
    /// a >= b as signed numbers.
    fn at_least(self, a: Self::Word, b: Self::Word) -> Self::Truth;
    /// Words whose most significant bit is set.
    fn negative_word(self, a: Self::Word) -> Self::Truth;
    /// `table[index]` where it is true, 0 elsewhere; the table's last entry beyond it.
    fn gather_pairs(self, table: &[u64], index: Self::Word, truth: Self::Truth) -> Self::Word;
    /// A bit for every word.
    fn bits(self, truth: Self::Truth) -> u8;
    /// Truth values from bits.
    fn truth(self, bits: u8) -> Self::Truth;
    /// Asks for memory that will be read soon.
    fn fetch<T>(self, place: &T);
}

/// Work on fused products. Implement `run` and all that it calls with `#[inline(always)]`.
pub trait FusedJob {
    /// The result.
    type Output;
    /// The work.
    fn run<L: Fused>(self, lanes: L) -> Self::Output;
}

/// Runs the job on the processor's fused products, or on arrays if it has none or `portable` asks for it.
#[inline]
pub fn dispatch_fused<J: FusedJob>(portable: bool, job: J) -> J::Output {
    #[cfg(target_arch = "x86_64")]
    if !portable && let Some(lanes) = super::avx512::Avx512::detect() {
        return lanes.run_fused(job);
    }
    let _ = portable;
    job.run(Portable)
}

/// Has the processor fused products?
pub fn has_fused() -> bool {
    #[cfg(target_arch = "x86_64")]
    return super::avx512::Avx512::detect().is_some();
    #[cfg(not(target_arch = "x86_64"))]
    false
}

type Words = [i64; 8];

#[inline(always)]
fn zip(a: Words, b: Words, operation: impl Fn(i64, i64) -> i64) -> Words {
    std::array::from_fn(|k| operation(a[k], b[k]))
}

/// An operation on both halves of a word.
#[inline(always)]
fn halves(a: i64, b: i64, operation: impl Fn(i32, i32) -> i32) -> i64 {
    let low = operation(a as i32, b as i32) as u32;
    let high = operation((a >> 32) as i32, (b >> 32) as i32);
    (i64::from(high) << 32) | i64::from(low)
}

impl Fused for Portable {
    fn wide_iota(self) -> Words {
        [0, 1, 2, 3, 4, 5, 6, 7]
    }
    fn read(self, from: &[u64]) -> Words {
        let words: [u64; 8] = from.first_chunk().copied().unwrap_or_default();
        words.map(|word| word as i64)
    }
    fn write(self, to: &mut [u64], value: Words) {
        if let Some(words) = to.first_chunk_mut::<8>() {
            *words = value.map(|word| word as u64);
        }
    }
    fn fused(self, acc: Words, a: Words, b: Words) -> Words {
        let low = |word: i64| (word & ((1 << DROPPED) - 1)) as u128;
        let product = zip(a, b, |a, b| ((low(a) * low(b)) >> DROPPED) as i64);
        zip(acc, product, i64::wrapping_add)
    }
    fn fused_where(self, acc: Words, a: Words, b: Words, truth: [bool; 8]) -> Words {
        self.wide_select(acc, self.fused(acc, a, b), truth)
    }
    fn mul_words(self, a: Words, b: Words) -> Words {
        zip(a, b, |a, b| i64::from((a as u32).wrapping_mul(b as u32)))
    }
    fn mul_whole(self, a: Words, b: Words) -> Words {
        zip(a, b, i64::wrapping_mul)
    }
    fn add_words(self, a: Words, b: Words) -> Words {
        zip(a, b, |a, b| halves(a, b, i32::wrapping_add))
    }
    fn max_words(self, a: Words, b: Words) -> Words {
        zip(a, b, |a, b| halves(a, b, i32::max))
    }
    fn max_whole(self, a: Words, b: Words) -> Words {
        zip(a, b, i64::max)
    }
    fn min_whole(self, a: Words, b: Words) -> Words {
        zip(a, b, |a, b| (a as u64).min(b as u64) as i64)
    }
    fn turn(self, a: Words, by: Words) -> Words {
        zip(a, by, |a, by| a.rotate_right(by as u32 % 64))
    }
    fn merge(self, a: Words, mask: Words, b: Words) -> Words {
        zip(zip(a, mask, |a, mask| a & mask), b, |a, b| a | b)
    }
    fn keep(self, a: Words, mask: Words, truth: [bool; 8]) -> Words {
        self.wide_select([0; 8], self.wide_and(a, mask), truth)
    }
    fn choose(self, a: Words, b: Words, c: Words, truth: [bool; 8]) -> Words {
        self.wide_select(zip(b, c, |b, c| b | c), a, truth)
    }
    fn at_least(self, a: Words, b: Words) -> [bool; 8] {
        std::array::from_fn(|k| a[k] >= b[k])
    }
    fn negative_word(self, a: Words) -> [bool; 8] {
        a.map(|a| a < 0)
    }
    fn gather_pairs(self, table: &[u64], index: Words, truth: [bool; 8]) -> Words {
        let last = table.len().saturating_sub(1) as u64;
        let entry = |index: i64| table.get((index as u64).min(last) as usize);
        let entries = index.map(|index| entry(index).copied().unwrap_or(0) as i64);
        self.wide_select([0; 8], entries, truth)
    }
    fn bits(self, truth: [bool; 8]) -> u8 {
        (0..8).fold(0, |bits, k| bits | (u8::from(truth[k]) << k))
    }
    fn truth(self, bits: u8) -> [bool; 8] {
        std::array::from_fn(|k| bits >> k & 1 == 1)
    }
    fn fetch<T>(self, _: &T) {}
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    //! SAFETY of all intrinsics on registers: `self` proves that the processor has the instruction.

    use super::super::avx512::Avx512;
    use super::Fused;
    use std::arch::x86_64::*;

    macro_rules! op {
        ($call:expr) => {
            unsafe { $call }
        };
    }

    impl Fused for Avx512 {
        #[inline(always)]
        fn wide_iota(self) -> __m512i {
            op!(_mm512_setr_epi64(0, 1, 2, 3, 4, 5, 6, 7))
        }
        #[inline(always)]
        fn read(self, from: &[u64]) -> __m512i {
            let words: [u64; 8] = from.first_chunk().copied().unwrap_or_default();
            // SAFETY: the array has the 64 bytes that are read; no alignment is needed.
            unsafe { _mm512_loadu_si512(words.as_ptr().cast()) }
        }
        #[inline(always)]
        fn write(self, to: &mut [u64], value: __m512i) {
            if let Some(words) = to.first_chunk_mut::<8>() {
                // SAFETY: the array has the 64 bytes that are written; no alignment is needed.
                unsafe { _mm512_storeu_si512(words.as_mut_ptr().cast(), value) }
            }
        }
        #[inline(always)]
        fn fused(self, acc: __m512i, a: __m512i, b: __m512i) -> __m512i {
            op!(_mm512_madd52hi_epu64(acc, a, b))
        }
        #[inline(always)]
        fn fused_where(self, acc: __m512i, a: __m512i, b: __m512i, truth: u8) -> __m512i {
            op!(_mm512_mask_madd52hi_epu64(acc, truth, a, b))
        }
        #[inline(always)]
        fn mul_words(self, a: __m512i, b: __m512i) -> __m512i {
            op!(_mm512_and_si512(
                _mm512_mul_epu32(a, b),
                _mm512_set1_epi64(0xffff_ffff)
            ))
        }
        #[inline(always)]
        fn mul_whole(self, a: __m512i, b: __m512i) -> __m512i {
            op!(_mm512_mullo_epi64(a, b))
        }
        #[inline(always)]
        fn add_words(self, a: __m512i, b: __m512i) -> __m512i {
            op!(_mm512_add_epi32(a, b))
        }
        #[inline(always)]
        fn max_words(self, a: __m512i, b: __m512i) -> __m512i {
            op!(_mm512_max_epi32(a, b))
        }
        #[inline(always)]
        fn max_whole(self, a: __m512i, b: __m512i) -> __m512i {
            op!(_mm512_max_epi64(a, b))
        }
        #[inline(always)]
        fn min_whole(self, a: __m512i, b: __m512i) -> __m512i {
            op!(_mm512_min_epu64(a, b))
        }
        #[inline(always)]
        fn turn(self, a: __m512i, by: __m512i) -> __m512i {
            op!(_mm512_rorv_epi64(a, by))
        }
        #[inline(always)]
        fn merge(self, a: __m512i, mask: __m512i, b: __m512i) -> __m512i {
            // The truth table of (a & mask) | b.
            op!(_mm512_ternarylogic_epi64::<0b1110_1010>(a, mask, b))
        }
        #[inline(always)]
        fn keep(self, a: __m512i, mask: __m512i, truth: u8) -> __m512i {
            op!(_mm512_maskz_and_epi64(truth, a, mask))
        }
        #[inline(always)]
        fn choose(self, a: __m512i, b: __m512i, c: __m512i, truth: u8) -> __m512i {
            op!(_mm512_mask_or_epi64(a, !truth, b, c))
        }
        #[inline(always)]
        fn at_least(self, a: __m512i, b: __m512i) -> u8 {
            op!(_mm512_cmpge_epi64_mask(a, b))
        }
        #[inline(always)]
        fn negative_word(self, a: __m512i) -> u8 {
            op!(_mm512_movepi64_mask(a))
        }
        #[inline(always)]
        fn gather_pairs(self, table: &[u64], index: __m512i, truth: u8) -> __m512i {
            let Some(last) = table.len().checked_sub(1) else {
                return op!(_mm512_setzero_si512());
            };
            // SAFETY: every index lies in the table.
            unsafe {
                let index = _mm512_min_epu64(index, _mm512_set1_epi64(last as i64));
                _mm512_mask_i64gather_epi64::<8>(
                    _mm512_setzero_si512(),
                    truth,
                    index,
                    table.as_ptr().cast(),
                )
            }
        }
        #[inline(always)]
        fn bits(self, truth: u8) -> u8 {
            truth
        }
        #[inline(always)]
        fn truth(self, bits: u8) -> u8 {
            bits
        }
        #[inline(always)]
        fn fetch<T>(self, place: &T) {
            super::super::Lanes::prefetch(self, place);
        }
    }
}
