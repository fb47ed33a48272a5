//! Vectors of single-precision numbers, for the baseline that shares everything with the kernel but the arithmetic.

#![allow(unsafe_code)]

use super::{Lanes, Portable};

/// Single-precision operations on the bits of [`Lanes::Words`].
pub trait Floats: Lanes {
    /// a + b.
    fn float_add(self, a: Self::Words, b: Self::Words) -> Self::Words;
    /// a - b.
    fn float_sub(self, a: Self::Words, b: Self::Words) -> Self::Words;
    /// a b.
    fn float_mul(self, a: Self::Words, b: Self::Words) -> Self::Words;
    /// a b + c, rounded once where the processor can.
    fn float_mul_add(self, a: Self::Words, b: Self::Words, c: Self::Words) -> Self::Words;
    /// The smaller one.
    fn float_min(self, a: Self::Words, b: Self::Words) -> Self::Words;
    /// a > b.
    fn float_greater(self, a: Self::Words, b: Self::Words) -> Self::Mask;
    /// Integers to numbers.
    fn to_float(self, a: Self::Words) -> Self::Words;
    /// Numbers to the nearest integers.
    fn to_integer(self, a: Self::Words) -> Self::Words;
}

#[inline(always)]
fn zip(a: [u32; 8], b: [u32; 8], operation: impl Fn(f32, f32) -> f32) -> [u32; 8] {
    std::array::from_fn(|k| operation(f32::from_bits(a[k]), f32::from_bits(b[k])).to_bits())
}

impl Floats for Portable {
    #[inline(always)]
    fn float_add(self, a: [u32; 8], b: [u32; 8]) -> [u32; 8] {
        zip(a, b, |a, b| a + b)
    }
    #[inline(always)]
    fn float_sub(self, a: [u32; 8], b: [u32; 8]) -> [u32; 8] {
        zip(a, b, |a, b| a - b)
    }
    #[inline(always)]
    fn float_mul(self, a: [u32; 8], b: [u32; 8]) -> [u32; 8] {
        zip(a, b, |a, b| a * b)
    }
    #[inline(always)]
    fn float_mul_add(self, a: [u32; 8], b: [u32; 8], c: [u32; 8]) -> [u32; 8] {
        zip(zip(a, b, |a, b| a * b), c, |a, c| a + c)
    }
    #[inline(always)]
    fn float_min(self, a: [u32; 8], b: [u32; 8]) -> [u32; 8] {
        zip(a, b, f32::min)
    }
    #[inline(always)]
    fn float_greater(self, a: [u32; 8], b: [u32; 8]) -> [bool; 8] {
        std::array::from_fn(|k| f32::from_bits(a[k]) > f32::from_bits(b[k]))
    }
    #[inline(always)]
    fn to_float(self, a: [u32; 8]) -> [u32; 8] {
        a.map(|a| (a as i32 as f32).to_bits())
    }
    #[inline(always)]
    fn to_integer(self, a: [u32; 8]) -> [u32; 8] {
        a.map(|a| f32::from_bits(a).round_ties_even() as i32 as u32)
    }
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    //! SAFETY of all intrinsics: they work on registers, and `self` proves that the processor has the instruction.

    use super::super::avx2::Avx2;
    use super::super::avx512::Avx512;
    use super::Floats;
    use std::arch::x86_64::*;

    impl Floats for Avx2 {
        #[inline(always)]
        fn float_add(self, a: __m256i, b: __m256i) -> __m256i {
            // SAFETY: `self` proves that the processor has the instructions.
            unsafe {
                let sum = _mm256_add_ps(_mm256_castsi256_ps(a), _mm256_castsi256_ps(b));
                _mm256_castps_si256(sum)
            }
        }
        #[inline(always)]
        fn float_sub(self, a: __m256i, b: __m256i) -> __m256i {
            // SAFETY: `self` proves that the processor has the instructions.
            unsafe {
                let difference = _mm256_sub_ps(_mm256_castsi256_ps(a), _mm256_castsi256_ps(b));
                _mm256_castps_si256(difference)
            }
        }
        #[inline(always)]
        fn float_mul(self, a: __m256i, b: __m256i) -> __m256i {
            // SAFETY: `self` proves that the processor has the instructions.
            unsafe {
                let product = _mm256_mul_ps(_mm256_castsi256_ps(a), _mm256_castsi256_ps(b));
                _mm256_castps_si256(product)
            }
        }
        #[inline(always)]
        fn float_mul_add(self, a: __m256i, b: __m256i, c: __m256i) -> __m256i {
            // SAFETY: `self` proves that the processor has the instructions.
            unsafe {
                let (a, b) = (_mm256_castsi256_ps(a), _mm256_castsi256_ps(b));
                _mm256_castps_si256(_mm256_fmadd_ps(a, b, _mm256_castsi256_ps(c)))
            }
        }
        #[inline(always)]
        fn float_min(self, a: __m256i, b: __m256i) -> __m256i {
            // SAFETY: `self` proves that the processor has the instructions.
            unsafe {
                let smaller = _mm256_min_ps(_mm256_castsi256_ps(a), _mm256_castsi256_ps(b));
                _mm256_castps_si256(smaller)
            }
        }
        #[inline(always)]
        fn float_greater(self, a: __m256i, b: __m256i) -> __m256i {
            // SAFETY: `self` proves that the processor has the instructions.
            unsafe {
                let (a, b) = (_mm256_castsi256_ps(a), _mm256_castsi256_ps(b));
                _mm256_castps_si256(_mm256_cmp_ps::<_CMP_GT_OQ>(a, b))
            }
        }
        #[inline(always)]
        fn to_float(self, a: __m256i) -> __m256i {
            // SAFETY: `self` proves that the processor has the instructions.
            unsafe { _mm256_castps_si256(_mm256_cvtepi32_ps(a)) }
        }
        #[inline(always)]
        fn to_integer(self, a: __m256i) -> __m256i {
            // SAFETY: `self` proves that the processor has the instructions.
            unsafe { _mm256_cvtps_epi32(_mm256_castsi256_ps(a)) }
        }
    }

    impl Floats for Avx512 {
        #[inline(always)]
        fn float_add(self, a: __m512i, b: __m512i) -> __m512i {
            // SAFETY: `self` proves that the processor has the instructions.
            unsafe {
                let sum = _mm512_add_ps(_mm512_castsi512_ps(a), _mm512_castsi512_ps(b));
                _mm512_castps_si512(sum)
            }
        }
        #[inline(always)]
        fn float_sub(self, a: __m512i, b: __m512i) -> __m512i {
            // SAFETY: `self` proves that the processor has the instructions.
            unsafe {
                let difference = _mm512_sub_ps(_mm512_castsi512_ps(a), _mm512_castsi512_ps(b));
                _mm512_castps_si512(difference)
            }
        }
        #[inline(always)]
        fn float_mul(self, a: __m512i, b: __m512i) -> __m512i {
            // SAFETY: `self` proves that the processor has the instructions.
            unsafe {
                let product = _mm512_mul_ps(_mm512_castsi512_ps(a), _mm512_castsi512_ps(b));
                _mm512_castps_si512(product)
            }
        }
        #[inline(always)]
        fn float_mul_add(self, a: __m512i, b: __m512i, c: __m512i) -> __m512i {
            // SAFETY: `self` proves that the processor has the instructions.
            unsafe {
                let (a, b) = (_mm512_castsi512_ps(a), _mm512_castsi512_ps(b));
                _mm512_castps_si512(_mm512_fmadd_ps(a, b, _mm512_castsi512_ps(c)))
            }
        }
        #[inline(always)]
        fn float_min(self, a: __m512i, b: __m512i) -> __m512i {
            // SAFETY: `self` proves that the processor has the instructions.
            unsafe {
                let smaller = _mm512_min_ps(_mm512_castsi512_ps(a), _mm512_castsi512_ps(b));
                _mm512_castps_si512(smaller)
            }
        }
        #[inline(always)]
        fn float_greater(self, a: __m512i, b: __m512i) -> __mmask16 {
            // SAFETY: `self` proves that the processor has the instructions.
            unsafe {
                let (a, b) = (_mm512_castsi512_ps(a), _mm512_castsi512_ps(b));
                _mm512_cmp_ps_mask::<_CMP_GT_OQ>(a, b)
            }
        }
        #[inline(always)]
        fn to_float(self, a: __m512i) -> __m512i {
            // SAFETY: `self` proves that the processor has the instructions.
            unsafe { _mm512_castps_si512(_mm512_cvtepi32_ps(a)) }
        }
        #[inline(always)]
        fn to_integer(self, a: __m512i) -> __m512i {
            // SAFETY: `self` proves that the processor has the instructions.
            unsafe { _mm512_cvtps_epi32(_mm512_castsi512_ps(a)) }
        }
    }
}
