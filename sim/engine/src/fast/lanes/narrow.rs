//! Vectors of sixteen 32-bit words, for designs whose products can be put together from products of 16 bits or of 32.
//!
//! The portable implementation, on arrays, is the definition; it serves the tests and is not meant to be fast.

#![allow(unsafe_code)]

use super::Portable;
use super::factors::NarrowFactors;
use super::fused::Fused;

/// Operations of the narrow pixel path. Arithmetic wraps.
pub trait Narrow: Fused {
    /// Sixteen words.
    type Short: Copy;

    /// The same word everywhere.
    fn short_splat(self, value: u32) -> Self::Short;
    /// The lower half in words 0, 2, 4, ..., the upper one in words 1, 3, 5, ...
    fn short_pairs(self, value: u64) -> Self::Short;
    /// 0, 1, 2, ...
    fn short_iota(self) -> Self::Short;
    /// The words of memory.
    fn short_read(self, from: &[u32; 16]) -> Self::Short;
    /// Stores the words.
    fn short_write(self, to: &mut [u32; 16], value: Self::Short);
    /// a + b.
    fn short_add(self, a: Self::Short, b: Self::Short) -> Self::Short;
    /// a - b.
    fn short_sub(self, a: Self::Short, b: Self::Short) -> Self::Short;
    /// Low 32 bits of a b.
    fn short_mul(self, a: Self::Short, b: Self::Short) -> Self::Short;
    /// Upper 16 bits of the product of the lower halves, without a sign, and of that of the upper halves, each in its place.
    fn upper_halves(self, a: Self::Short, b: Self::Short) -> Self::Short;
    /// The products of the lower halves and of the upper halves, with signs, added.
    fn both_halves(self, a: Self::Short, b: Self::Short) -> Self::Short;
    /// a << by, at most 31.
    fn short_shl(self, a: Self::Short, by: Self::Short) -> Self::Short;
    /// a >> by, at most 31, filled with zeros.
    fn short_shr(self, a: Self::Short, by: Self::Short) -> Self::Short;
    /// a >> by, at most 31, filled with the sign.
    fn short_sar(self, a: Self::Short, by: Self::Short) -> Self::Short;
    /// a & b.
    fn short_and(self, a: Self::Short, b: Self::Short) -> Self::Short;
    /// The larger one, as signed numbers.
    fn short_max(self, a: Self::Short, b: Self::Short) -> Self::Short;
    /// The smaller one, as unsigned numbers.
    fn short_min(self, a: Self::Short, b: Self::Short) -> Self::Short;
    /// (a & mask) | b.
    fn short_merge(self, a: Self::Short, mask: Self::Short, b: Self::Short) -> Self::Short;
    /// a & b & c.
    fn short_all(self, a: Self::Short, b: Self::Short, c: Self::Short) -> Self::Short;
    /// a & b & !c.
    fn short_without(self, a: Self::Short, b: Self::Short, c: Self::Short) -> Self::Short;
    /// The bits of b where those of a are set, else those of c.
    fn short_blend(self, a: Self::Short, b: Self::Short, c: Self::Short) -> Self::Short;
    /// -1 where the most significant bit is set, else 0.
    fn short_spread(self, a: Self::Short) -> Self::Short;
    /// Bit k of the lower half in word 2 k, of the upper half in word 2 k + 1, as its most significant bit; the others are anything.
    fn short_marks(self, bits: u64) -> Self::Short;
    /// A bit for every word: its most significant one.
    fn short_marked(self, a: Self::Short) -> u16;
    /// The sum of all words.
    fn short_sum(self, a: Self::Short) -> u32;
    /// [`NarrowFactors::neighbours`] of these indices.
    fn short_factored(self, factors: &NarrowFactors, index: Self::Short) -> [Self::Short; 2];
}

type ShortWords = [u32; 16];

fn zip(a: ShortWords, b: ShortWords, operation: impl Fn(u32, u32) -> u32) -> ShortWords {
    std::array::from_fn(|k| operation(a[k], b[k]))
}

fn halves(word: u32) -> [u32; 2] {
    [word & 0xffff, word >> 16]
}

impl Narrow for Portable {
    type Short = ShortWords;

    fn short_splat(self, value: u32) -> ShortWords {
        [value; 16]
    }
    fn short_pairs(self, value: u64) -> ShortWords {
        std::array::from_fn(|k| (value >> (32 * (k % 2))) as u32)
    }
    fn short_iota(self) -> ShortWords {
        std::array::from_fn(|k| k as u32)
    }
    fn short_read(self, from: &[u32; 16]) -> ShortWords {
        *from
    }
    fn short_write(self, to: &mut [u32; 16], value: ShortWords) {
        *to = value;
    }
    fn short_add(self, a: ShortWords, b: ShortWords) -> ShortWords {
        zip(a, b, u32::wrapping_add)
    }
    fn short_sub(self, a: ShortWords, b: ShortWords) -> ShortWords {
        zip(a, b, u32::wrapping_sub)
    }
    fn short_mul(self, a: ShortWords, b: ShortWords) -> ShortWords {
        zip(a, b, u32::wrapping_mul)
    }
    fn upper_halves(self, a: ShortWords, b: ShortWords) -> ShortWords {
        zip(a, b, |a, b| {
            let ([a, above_a], [b, above_b]) = (halves(a), halves(b));
            ((a * b) >> 16) | ((above_a * above_b) & 0xffff_0000)
        })
    }
    fn both_halves(self, a: ShortWords, b: ShortWords) -> ShortWords {
        let signed = |word: u32| halves(word).map(|half| i32::from(half as u16 as i16));
        zip(a, b, |a, b| {
            let ([a, above_a], [b, above_b]) = (signed(a), signed(b));
            (a * b).wrapping_add(above_a * above_b) as u32
        })
    }
    fn short_shl(self, a: ShortWords, by: ShortWords) -> ShortWords {
        zip(a, by, |a, by| a << by)
    }
    fn short_shr(self, a: ShortWords, by: ShortWords) -> ShortWords {
        zip(a, by, |a, by| a >> by)
    }
    fn short_sar(self, a: ShortWords, by: ShortWords) -> ShortWords {
        zip(a, by, |a, by| (a as i32 >> by) as u32)
    }
    fn short_and(self, a: ShortWords, b: ShortWords) -> ShortWords {
        zip(a, b, |a, b| a & b)
    }
    fn short_max(self, a: ShortWords, b: ShortWords) -> ShortWords {
        zip(a, b, |a, b| (a as i32).max(b as i32) as u32)
    }
    fn short_min(self, a: ShortWords, b: ShortWords) -> ShortWords {
        zip(a, b, u32::min)
    }
    fn short_merge(self, a: ShortWords, mask: ShortWords, b: ShortWords) -> ShortWords {
        std::array::from_fn(|k| (a[k] & mask[k]) | b[k])
    }
    fn short_all(self, a: ShortWords, b: ShortWords, c: ShortWords) -> ShortWords {
        std::array::from_fn(|k| a[k] & b[k] & c[k])
    }
    fn short_without(self, a: ShortWords, b: ShortWords, c: ShortWords) -> ShortWords {
        std::array::from_fn(|k| a[k] & b[k] & !c[k])
    }
    fn short_blend(self, a: ShortWords, b: ShortWords, c: ShortWords) -> ShortWords {
        std::array::from_fn(|k| (a[k] & b[k]) | (!a[k] & c[k]))
    }
    fn short_spread(self, a: ShortWords) -> ShortWords {
        a.map(|a| (a as i32 >> 31) as u32)
    }
    fn short_marks(self, bits: u64) -> ShortWords {
        let halves = self.short_pairs(bits);
        std::array::from_fn(|k| halves[k] << (31 - k / 2))
    }
    fn short_marked(self, a: ShortWords) -> u16 {
        (0..16).fold(0, |bits, k| bits | ((a[k] >> 31) as u16) << k)
    }
    fn short_sum(self, a: ShortWords) -> u32 {
        a.into_iter().fold(0, u32::wrapping_add)
    }
    fn short_factored(self, factors: &NarrowFactors, index: ShortWords) -> [ShortWords; 2] {
        let pairs = index.map(|index| factors.neighbours(index));
        [0, 1].map(|which| pairs.map(|pair| pair[which]))
    }
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    //! SAFETY of all intrinsics on registers: `self` proves that the processor has the instruction.

    use super::super::avx512::Avx512;
    use super::super::factors::{NarrowFactors, TO_SHORT_INTEGER};
    use super::Narrow;
    use std::arch::x86_64::*;

    /// The intrinsic as an instruction that the compiler does not look into: knowing half of the words to be 0, it would widen them all,
    /// multiply, and narrow them again, eight instructions instead of one.
    #[target_feature(enable = "avx512f,avx512bw")]
    #[inline]
    fn upper_halves(a: __m512i, b: __m512i) -> __m512i {
        let upper;
        // SAFETY: an instruction on registers that the function's features include.
        unsafe {
            std::arch::asm!(
                "vpmulhuw {upper}, {a}, {b}",
                upper = lateout(zmm_reg) upper,
                a = in(zmm_reg) a,
                b = in(zmm_reg) b,
                options(pure, nomem, nostack, preserves_flags),
            );
        }
        upper
    }

    impl Narrow for Avx512 {
        type Short = __m512i;

        #[inline(always)]
        fn short_splat(self, value: u32) -> __m512i {
            op!(_mm512_set1_epi32(value as i32))
        }
        #[inline(always)]
        fn short_pairs(self, value: u64) -> __m512i {
            op!(_mm512_set1_epi64(value as i64))
        }
        #[inline(always)]
        fn short_iota(self) -> __m512i {
            op!(_mm512_setr_epi32(
                0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15
            ))
        }
        #[inline(always)]
        fn short_read(self, from: &[u32; 16]) -> __m512i {
            // SAFETY: the array has the 64 bytes that are read; no alignment is needed.
            unsafe { _mm512_loadu_si512(from.as_ptr().cast()) }
        }
        #[inline(always)]
        fn short_write(self, to: &mut [u32; 16], value: __m512i) {
            // SAFETY: the array has the 64 bytes that are written; no alignment is needed.
            unsafe { _mm512_storeu_si512(to.as_mut_ptr().cast(), value) }
        }
        #[inline(always)]
        fn short_add(self, a: __m512i, b: __m512i) -> __m512i {
            op!(_mm512_add_epi32(a, b))
        }
        #[inline(always)]
        fn short_sub(self, a: __m512i, b: __m512i) -> __m512i {
            op!(_mm512_sub_epi32(a, b))
        }
        #[inline(always)]
        fn short_mul(self, a: __m512i, b: __m512i) -> __m512i {
            op!(_mm512_mullo_epi32(a, b))
        }
        #[inline(always)]
        fn upper_halves(self, a: __m512i, b: __m512i) -> __m512i {
            // SAFETY: `self` proves that the processor has what the function is compiled for.
            unsafe { upper_halves(a, b) }
        }
        #[inline(always)]
        fn both_halves(self, a: __m512i, b: __m512i) -> __m512i {
            op!(_mm512_madd_epi16(a, b))
        }
        #[inline(always)]
        fn short_shl(self, a: __m512i, by: __m512i) -> __m512i {
            op!(_mm512_sllv_epi32(a, by))
        }
        #[inline(always)]
        fn short_shr(self, a: __m512i, by: __m512i) -> __m512i {
            op!(_mm512_srlv_epi32(a, by))
        }
        #[inline(always)]
        fn short_sar(self, a: __m512i, by: __m512i) -> __m512i {
            op!(_mm512_srav_epi32(a, by))
        }
        #[inline(always)]
        fn short_and(self, a: __m512i, b: __m512i) -> __m512i {
            op!(_mm512_and_si512(a, b))
        }
        #[inline(always)]
        fn short_max(self, a: __m512i, b: __m512i) -> __m512i {
            op!(_mm512_max_epi32(a, b))
        }
        #[inline(always)]
        fn short_min(self, a: __m512i, b: __m512i) -> __m512i {
            op!(_mm512_min_epu32(a, b))
        }
        #[inline(always)]
        fn short_merge(self, a: __m512i, mask: __m512i, b: __m512i) -> __m512i {
            // The number is the truth table of (a & mask) | b.
            op!(_mm512_ternarylogic_epi32::<0b1110_1010>(a, mask, b))
        }
        #[inline(always)]
        fn short_all(self, a: __m512i, b: __m512i, c: __m512i) -> __m512i {
            op!(_mm512_ternarylogic_epi32::<0b1000_0000>(a, b, c))
        }
        #[inline(always)]
        fn short_without(self, a: __m512i, b: __m512i, c: __m512i) -> __m512i {
            op!(_mm512_ternarylogic_epi32::<0b0100_0000>(a, b, c))
        }
        #[inline(always)]
        fn short_blend(self, a: __m512i, b: __m512i, c: __m512i) -> __m512i {
            op!(_mm512_ternarylogic_epi32::<0b1100_1010>(a, b, c))
        }
        #[inline(always)]
        fn short_spread(self, a: __m512i) -> __m512i {
            op!(_mm512_srai_epi32::<31>(a))
        }
        #[inline(always)]
        fn short_marks(self, bits: u64) -> __m512i {
            let to_the_top = op!(_mm512_setr_epi32(
                31, 31, 30, 30, 29, 29, 28, 28, 27, 27, 26, 26, 25, 25, 24, 24
            ));
            op!(_mm512_sllv_epi32(
                _mm512_set1_epi64(bits as i64),
                to_the_top
            ))
        }
        #[inline(always)]
        fn short_marked(self, a: __m512i) -> u16 {
            op!(_mm512_movepi32_mask(a))
        }
        #[inline(always)]
        fn short_sum(self, a: __m512i) -> u32 {
            op!(_mm512_reduce_add_epi32(a)) as u32
        }
        #[inline(always)]
        fn short_factored(self, factors: &NarrowFactors, index: __m512i) -> [__m512i; 2] {
            let entry = |entries: &[f32; 32], index: __m512i| {
                let [low, high] = [&entries[..16], &entries[16..]];
                // SAFETY: both halves have the 64 bytes that are read.
                unsafe {
                    let low = _mm512_loadu_ps(low.as_ptr());
                    let high = _mm512_loadu_ps(high.as_ptr());
                    _mm512_permutex2var_ps(low, index, high)
                }
            };
            op!({
                let coarse = entry(&factors.coarse, _mm512_srli_epi32::<5>(index));
                let to_integer = _mm512_set1_ps(TO_SHORT_INTEGER);
                let neighbour = |fine| {
                    let sum = _mm512_fmadd_ps(coarse, entry(fine, index), to_integer);
                    _mm512_castps_si512(sum)
                };
                [neighbour(&factors.fine), neighbour(&factors.next)]
            })
        }
    }
}
