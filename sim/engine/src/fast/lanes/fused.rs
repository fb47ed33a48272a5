//! Vectors of 64-bit words with the fused product of 52 bits: `acc + (a b >> 52)`, one instruction of AVX-512 IFMA.
//!
//! It does a fixed-point product, its shift and the addition of a rounding constant at once, as a fused product does in floating point. The
//! portable implementation, on arrays, is the definition; it serves the tests and is not meant to be fast.

#![allow(unsafe_code)]

use super::factors::Factors;
use super::wide::{Words, zip};
use super::{Portable, Wide};

/// The number of each word.
pub const IOTA: [i64; 8] = [0, 1, 2, 3, 4, 5, 6, 7];

/// Fraction bits that the fused product drops.
pub const DROPPED: u32 = 52;

/// A table whose length is a power of two.
#[derive(Clone, Debug)]
pub struct Pairs(Box<[u64]>);

impl Pairs {
    /// These entries, and zeros up to a power of two.
    pub fn new(mut entries: Vec<u64>) -> Self {
        entries.resize(entries.len().next_power_of_two(), 0);
        Pairs(entries.into())
    }
}

/// Operations of the fused pixel path. Arithmetic wraps.
pub trait Fused: Wide {
    /// The words of memory.
    fn read(self, from: &[u64; 8]) -> Self::Word;
    /// Stores the words.
    fn write(self, to: &mut [u64; 8], value: Self::Word);
    /// Stores those that are true, one after the other, and anything after them.
    fn pack(self, to: &mut [u64; 8], value: Self::Word, truth: Self::Truth);
    /// acc + (a b >> 52), of the low 52 bits of a and of b.
    fn fused(self, acc: Self::Word, a: Self::Word, b: Self::Word) -> Self::Word;
    /// The low 32-bit half as a signed number, 0 where it is negative.
    fn half_from_zero(self, a: Self::Word) -> Self::Word;
    /// The larger one, as signed numbers.
    fn max_whole(self, a: Self::Word, b: Self::Word) -> Self::Word;
    /// The smaller one, as unsigned numbers.
    fn min_whole(self, a: Self::Word, b: Self::Word) -> Self::Word;
    /// a turned to the right by this many bits, 0 to 63.
    fn turn(self, a: Self::Word, by: Self::Word) -> Self::Word;
    /// (a & mask) | b.
    fn merge(self, a: Self::Word, mask: Self::Word, b: Self::Word) -> Self::Word;
    /// a & b & c.
    fn all_three(self, a: Self::Word, b: Self::Word, c: Self::Word) -> Self::Word;
    /// a & b & !c.
    fn without(self, a: Self::Word, b: Self::Word, c: Self::Word) -> Self::Word;
    /// The bits of b where those of a are set, else those of c.
    fn blend(self, a: Self::Word, b: Self::Word, c: Self::Word) -> Self::Word;
    /// Bit k of `bits` in word k, as its most significant bit; the others are anything.
    fn marks(self, bits: u64) -> Self::Word;
    /// A bit for every word: its most significant one.
    fn marked(self, a: Self::Word) -> u8;
    /// The entries of these indices, modulo the table's length.
    fn gather_pairs(self, table: &Pairs, index: Self::Word) -> Self::Word;
    /// The sum of all words.
    fn sum(self, a: Self::Word) -> u64;
    /// [`Factors::neighbours`] of these indices.
    fn factored(self, factors: &Factors, index: Self::Word) -> [Self::Word; 2];
    /// Truth values from bits.
    fn truth(self, bits: u8) -> Self::Truth;
}

impl Fused for Portable {
    fn read(self, from: &[u64; 8]) -> Words {
        from.map(|word| word as i64)
    }
    fn write(self, to: &mut [u64; 8], value: Words) {
        *to = value.map(|word| word as u64);
    }
    fn pack(self, to: &mut [u64; 8], value: Words, truth: [bool; 8]) {
        let words = value.iter().zip(truth).filter(|(_, truth)| *truth);
        for (to, (word, _)) in to.iter_mut().zip(words) {
            *to = *word as u64;
        }
    }
    fn fused(self, acc: Words, a: Words, b: Words) -> Words {
        let low = |word: i64| (word & ((1 << DROPPED) - 1)) as u128;
        let product = zip(a, b, |a, b| ((low(a) * low(b)) >> DROPPED) as i64);
        zip(acc, product, i64::wrapping_add)
    }
    #[inline(always)]
    fn half_from_zero(self, a: Words) -> Words {
        a.map(|a| (a as i32).max(0).into())
    }
    #[inline(always)]
    fn max_whole(self, a: Words, b: Words) -> Words {
        zip(a, b, i64::max)
    }
    #[inline(always)]
    fn min_whole(self, a: Words, b: Words) -> Words {
        zip(a, b, |a, b| (a as u64).min(b as u64) as i64)
    }
    #[inline(always)]
    fn turn(self, a: Words, by: Words) -> Words {
        zip(a, by, |a, by| a.rotate_right(by as u32 % 64))
    }
    #[inline(always)]
    fn merge(self, a: Words, mask: Words, b: Words) -> Words {
        zip(zip(a, mask, |a, mask| a & mask), b, |a, b| a | b)
    }
    #[inline(always)]
    fn all_three(self, a: Words, b: Words, c: Words) -> Words {
        zip(zip(a, b, |a, b| a & b), c, |ab, c| ab & c)
    }
    #[inline(always)]
    fn without(self, a: Words, b: Words, c: Words) -> Words {
        zip(zip(a, b, |a, b| a & b), c, |ab, c| ab & !c)
    }
    #[inline(always)]
    fn blend(self, a: Words, b: Words, c: Words) -> Words {
        std::array::from_fn(|k| (a[k] & b[k]) | (!a[k] & c[k]))
    }
    fn marks(self, bits: u64) -> Words {
        std::array::from_fn(|k| (bits << (63 - k)) as i64)
    }
    fn marked(self, a: Words) -> u8 {
        self.wide_flags(a.map(|a| a < 0)) as u8
    }
    fn gather_pairs(self, table: &Pairs, index: Words) -> Words {
        index.map(|index| table.0[index as usize & (table.0.len() - 1)] as i64)
    }
    fn sum(self, a: Words) -> u64 {
        a.into_iter().fold(0, i64::wrapping_add) as u64
    }
    fn factored(self, factors: &Factors, index: Words) -> [Words; 2] {
        let pairs = index.map(|index| factors.neighbours(index as u64));
        [0, 1].map(|which| pairs.map(|pair| pair[which] as i64))
    }
    fn truth(self, bits: u8) -> [bool; 8] {
        std::array::from_fn(|k| bits >> k & 1 == 1)
    }
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    //! SAFETY of all intrinsics on registers: `self` proves that the processor has the instruction.

    use super::super::avx512::Avx512;
    use super::super::factors::TO_INTEGER;
    use super::{Factors, Fused, Pairs};
    use std::arch::x86_64::*;

    impl Fused for Avx512 {
        #[inline(always)]
        fn read(self, from: &[u64; 8]) -> __m512i {
            // SAFETY: the array has the 64 bytes that are read; no alignment is needed.
            unsafe { _mm512_loadu_si512(from.as_ptr().cast()) }
        }
        #[inline(always)]
        fn write(self, to: &mut [u64; 8], value: __m512i) {
            // SAFETY: the array has the 64 bytes that are written; no alignment is needed.
            unsafe { _mm512_storeu_si512(to.as_mut_ptr().cast(), value) }
        }
        #[inline(always)]
        fn pack(self, to: &mut [u64; 8], value: __m512i, truth: u8) {
            // Packed in a register: storing only some of the words is microcode on some processors.
            self.write(to, op!(_mm512_maskz_compress_epi64(truth, value)));
        }
        #[inline(always)]
        fn fused(self, acc: __m512i, a: __m512i, b: __m512i) -> __m512i {
            op!(_mm512_madd52hi_epu64(acc, a, b))
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
        fn half_from_zero(self, a: __m512i) -> __m512i {
            // Every other half of a word is a low one.
            op!(_mm512_maskz_max_epi32(0x5555, a, _mm512_setzero_si512()))
        }
        #[inline(always)]
        fn turn(self, a: __m512i, by: __m512i) -> __m512i {
            op!(_mm512_rorv_epi64(a, by))
        }
        #[inline(always)]
        fn merge(self, a: __m512i, mask: __m512i, b: __m512i) -> __m512i {
            // The numbers are truth tables of the operands' bits.
            op!(_mm512_ternarylogic_epi64::<0b1110_1010>(a, mask, b))
        }
        #[inline(always)]
        fn all_three(self, a: __m512i, b: __m512i, c: __m512i) -> __m512i {
            op!(_mm512_ternarylogic_epi64::<0b1000_0000>(a, b, c))
        }
        #[inline(always)]
        fn without(self, a: __m512i, b: __m512i, c: __m512i) -> __m512i {
            op!(_mm512_ternarylogic_epi64::<0b0100_0000>(a, b, c))
        }
        #[inline(always)]
        fn blend(self, a: __m512i, b: __m512i, c: __m512i) -> __m512i {
            op!(_mm512_ternarylogic_epi64::<0b1100_1010>(a, b, c))
        }
        #[inline(always)]
        fn marks(self, bits: u64) -> __m512i {
            let to_the_top = op!(_mm512_setr_epi64(63, 62, 61, 60, 59, 58, 57, 56));
            op!(_mm512_sllv_epi64(
                _mm512_set1_epi64(bits as i64),
                to_the_top
            ))
        }
        #[inline(always)]
        fn marked(self, a: __m512i) -> u8 {
            op!(_mm512_movepi64_mask(a))
        }
        #[inline(always)]
        fn gather_pairs(self, table: &Pairs, index: __m512i) -> __m512i {
            let last = table.0.len() as i64 - 1;
            // SAFETY: the length is a power of two, so that every masked index lies in the table.
            unsafe {
                let index = _mm512_and_si512(index, _mm512_set1_epi64(last));
                _mm512_i64gather_epi64::<8>(index, table.0.as_ptr().cast())
            }
        }
        #[inline(always)]
        fn sum(self, a: __m512i) -> u64 {
            op!(_mm512_reduce_add_epi64(a)) as u64
        }
        #[inline(always)]
        fn factored(self, factors: &Factors, index: __m512i) -> [__m512i; 2] {
            let sixteenth = |entries: &[f64; 16], index: __m512i| {
                let [low, high] = [&entries[..8], &entries[8..]];
                // SAFETY: both halves have the 64 bytes that are read.
                unsafe {
                    let low = _mm512_loadu_pd(low.as_ptr());
                    let high = _mm512_loadu_pd(high.as_ptr());
                    _mm512_permutex2var_pd(low, index, high)
                }
            };
            let [first, second, third] = &factors.thirds;
            op!({
                let value = _mm512_mul_pd(
                    sixteenth(first, index),
                    sixteenth(second, _mm512_srli_epi64::<4>(index)),
                );
                let value = _mm512_mul_pd(value, sixteenth(third, _mm512_srli_epi64::<8>(index)));
                let to_integer = _mm512_set1_pd(TO_INTEGER);
                let low = _mm512_add_pd(value, to_integer);
                let next = _mm512_fmadd_pd(value, _mm512_set1_pd(factors.ratio), to_integer);
                [_mm512_castpd_si512(low), _mm512_castpd_si512(next)]
            })
        }
        #[inline(always)]
        fn truth(self, bits: u8) -> u8 {
            bits
        }
    }
}
