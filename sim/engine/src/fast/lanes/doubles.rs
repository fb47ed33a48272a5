//! Vectors of double-precision numbers in the bits of 64-bit words: what setup computes with.

#![allow(unsafe_code)]

use super::singles::Singles;
use super::wide::Words;
use super::{Portable, Wide};

/// Double-precision operations on the bits of [`Wide::Word`](super::Wide::Word), each rounded once to nearest, halves
/// to even.
pub trait Doubles: Wide {
    /// Pixels in single precision on the same processor.
    type Singles: Singles;
    /// See [`Doubles::Singles`].
    fn singles(self) -> Self::Singles;
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
}

#[inline(always)]
fn double(bits: i64) -> f64 {
    f64::from_bits(bits as u64)
}

#[inline(always)]
fn zip(a: Words, b: Words, operation: impl Fn(f64, f64) -> f64) -> Words {
    std::array::from_fn(|k| operation(double(a[k]), double(b[k])).to_bits() as i64)
}

#[inline(always)]
fn fused(a: Words, b: Words, c: [f64; 8]) -> Words {
    std::array::from_fn(|k| double(a[k]).mul_add(double(b[k]), c[k]).to_bits() as i64)
}

impl Doubles for Portable {
    type Singles = Portable;

    #[cfg_attr(not(test), inline(always))]
    fn singles(self) -> Portable {
        self
    }
    #[cfg_attr(not(test), inline(always))]
    fn double_add(self, a: Words, b: Words) -> Words {
        zip(a, b, |a, b| a + b)
    }
    #[cfg_attr(not(test), inline(always))]
    fn double_sub(self, a: Words, b: Words) -> Words {
        zip(a, b, |a, b| a - b)
    }
    #[cfg_attr(not(test), inline(always))]
    fn double_mul(self, a: Words, b: Words) -> Words {
        zip(a, b, |a, b| a * b)
    }
    #[cfg_attr(not(test), inline(always))]
    fn double_min(self, a: Words, b: Words) -> Words {
        zip(a, b, |a, b| if a < b { a } else { b })
    }
    #[cfg_attr(not(test), inline(always))]
    fn double_max(self, a: Words, b: Words) -> Words {
        zip(a, b, |a, b| if a > b { a } else { b })
    }
    #[cfg_attr(not(test), inline(always))]
    fn double_floor(self, a: Words) -> Words {
        a.map(|a| double(a).floor().to_bits() as i64)
    }
    #[cfg_attr(not(test), inline(always))]
    fn double_root(self, a: Words) -> Words {
        a.map(|a| double(a).sqrt().to_bits() as i64)
    }
    #[cfg_attr(not(test), inline(always))]
    fn double_mul_add(self, a: Words, b: Words, c: Words) -> Words {
        fused(a, b, c.map(double))
    }
    #[cfg_attr(not(test), inline(always))]
    fn double_mul_sub(self, a: Words, b: Words, c: Words) -> Words {
        fused(a, b, c.map(|c| -double(c)))
    }
    #[cfg_attr(not(test), inline(always))]
    fn double_greater(self, a: Words, b: Words) -> [bool; 8] {
        std::array::from_fn(|k| double(a[k]) > double(b[k]))
    }
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    //! SAFETY of all intrinsics: they work on registers, and `self` proves that the processor has the instruction.

    use super::super::avx2::Avx2;
    use super::super::avx512::Avx512;
    use super::Doubles;
    use std::arch::x86_64::*;

    /// The operations that have the same shape at every level: the word, its casts to numbers and back, and an
    /// instruction for each.
    macro_rules! arithmetic {
        ($word:ty, $to:ident, $from:ident, two: $($two:ident = $op2:ident),+; three: $($three:ident = $op3:ident),+) => {
            $(#[inline(always)]
            fn $two(self, a: $word, b: $word) -> $word {
                op!($from($op2($to(a), $to(b))))
            })+
            $(#[inline(always)]
            fn $three(self, a: $word, b: $word, c: $word) -> $word {
                op!($from($op3($to(a), $to(b), $to(c))))
            })+
        };
    }

    impl Doubles for Avx2 {
        type Singles = Avx2;

        #[inline(always)]
        fn singles(self) -> Avx2 {
            self
        }
        arithmetic!(
            __m256i, _mm256_castsi256_pd, _mm256_castpd_si256,
            two: double_add = _mm256_add_pd, double_sub = _mm256_sub_pd, double_mul = _mm256_mul_pd,
                double_min = _mm256_min_pd, double_max = _mm256_max_pd;
            three: double_mul_add = _mm256_fmadd_pd, double_mul_sub = _mm256_fmsub_pd
        );
        #[inline(always)]
        fn double_floor(self, a: __m256i) -> __m256i {
            op!(_mm256_castpd_si256(_mm256_floor_pd(_mm256_castsi256_pd(a))))
        }
        #[inline(always)]
        fn double_root(self, a: __m256i) -> __m256i {
            op!(_mm256_castpd_si256(_mm256_sqrt_pd(_mm256_castsi256_pd(a))))
        }
        #[inline(always)]
        fn double_greater(self, a: __m256i, b: __m256i) -> __m256i {
            op!(_mm256_castpd_si256(_mm256_cmp_pd::<_CMP_GT_OQ>(
                _mm256_castsi256_pd(a),
                _mm256_castsi256_pd(b)
            )))
        }
    }

    impl Doubles for Avx512 {
        type Singles = Avx2;

        #[inline(always)]
        fn singles(self) -> Avx2 {
            self.avx2()
        }
        arithmetic!(
            __m512i, _mm512_castsi512_pd, _mm512_castpd_si512,
            two: double_add = _mm512_add_pd, double_sub = _mm512_sub_pd, double_mul = _mm512_mul_pd,
                double_min = _mm512_min_pd, double_max = _mm512_max_pd;
            three: double_mul_add = _mm512_fmadd_pd, double_mul_sub = _mm512_fmsub_pd
        );
        #[inline(always)]
        fn double_floor(self, a: __m512i) -> __m512i {
            // Without an exception, towards negative infinity, no fraction bits.
            op!(_mm512_castpd_si512(_mm512_roundscale_pd::<9>(
                _mm512_castsi512_pd(a)
            )))
        }
        #[inline(always)]
        fn double_root(self, a: __m512i) -> __m512i {
            op!(_mm512_castpd_si512(_mm512_sqrt_pd(_mm512_castsi512_pd(a))))
        }
        #[inline(always)]
        fn double_greater(self, a: __m512i, b: __m512i) -> __mmask8 {
            op!(_mm512_cmp_pd_mask::<_CMP_GT_OQ>(
                _mm512_castsi512_pd(a),
                _mm512_castsi512_pd(b)
            ))
        }
    }
}
