//! The eight sums of a surface's pixel as one vector of 32-bit words, so that a splat's share of all of them is two
//! products.
//!
//! Runs of surfaces are three pixels long: side by side, pixels would leave vectors half empty, and each sum would be a
//! product of its own. The attributes of one pixel fill a vector whatever the run.

#![allow(unsafe_code)]

use super::words::PixelWords;
use super::{Doubles, Portable};

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

/// Operations on a pixel's sums.
pub trait PixelSums: PixelWords + Doubles {
    /// Attributes of a splat.
    type Attributes: Copy;

    /// Attributes, each of magnitude at most 1 in the shift's format.
    fn attributes(self, values: &[i32; 8], shift: ShareShift) -> Self::Attributes;

    /// Adds `weight`, below 2^31, times the attributes to the sums; magnitudes are rounded. If the last sum would reach
    /// 2^31 all stay as they are, and the answer is false.
    fn add_shares(self, sums: &mut Sums, weight: &i64, attributes: &Self::Attributes) -> bool;
}

/// A pixel's last sum ends here.
const FULL: u32 = 1 << 31;

impl PixelSums for Portable {
    type Attributes = ([i32; 8], ShareShift);

    #[cfg_attr(not(test), inline(always))]
    fn attributes(self, values: &[i32; 8], shift: ShareShift) -> Self::Attributes {
        (*values, shift)
    }

    #[cfg_attr(not(test), inline(always))]
    fn add_shares(self, sums: &mut Sums, weight: &i64, attributes: &Self::Attributes) -> bool {
        let (values, ShareShift { by, half }) = attributes;
        let share = |value: i32| {
            let product = (*weight as u64).wrapping_mul(value.unsigned_abs().into());
            let magnitude = (product.wrapping_add(*half) >> by) as u32;
            if value < 0 {
                magnitude.wrapping_neg()
            } else {
                magnitude
            }
        };
        let added: Sums = std::array::from_fn(|k| sums[k].wrapping_add(share(values[k])));
        if added[7] & FULL != 0 {
            return false;
        }
        *sums = added;
        true
    }
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    //! SAFETY of all intrinsics on registers: `self` proves that the processor has the instruction. Loads and stores
    //! are of whole arrays.

    use super::super::avx2::Avx2;
    use super::super::avx512::Avx512;
    use super::{PixelSums, ShareShift, Sums};
    use std::arch::x86_64::*;

    /// Magnitudes of even and odd attributes, the signs of all, and what rounds their products.
    #[derive(Clone, Copy)]
    pub struct AttributeFactors {
        even: __m256i,
        odd: __m256i,
        signs: __m256i,
        half: __m256i,
        right: __m128i,
        left: __m128i,
    }

    impl PixelSums for Avx2 {
        type Attributes = AttributeFactors;

        #[inline(always)]
        fn attributes(self, values: &[i32; 8], shift: ShareShift) -> AttributeFactors {
            // SAFETY: an array of eight words is read.
            unsafe {
                let values = _mm256_loadu_si256(values.as_ptr().cast());
                let even = _mm256_abs_epi32(values);
                AttributeFactors {
                    even,
                    odd: _mm256_srli_epi64::<32>(even),
                    signs: _mm256_srai_epi32::<31>(values),
                    half: _mm256_set1_epi64x(shift.half as i64),
                    right: _mm_cvtsi32_si128(shift.by as i32),
                    left: _mm_cvtsi32_si128(32 - shift.by as i32),
                }
            }
        }

        /// Odd words are not shifted down and up again but only up, to where the upper half of a word holds them.
        #[inline(always)]
        fn add_shares(self, sums: &mut Sums, weight: &i64, attributes: &AttributeFactors) -> bool {
            let AttributeFactors {
                even,
                odd,
                signs,
                half,
                right,
                left,
            } = *attributes;
            // SAFETY: an array of eight words is read and written.
            unsafe {
                let weight = _mm256_set1_epi64x(*weight);
                let even = _mm256_add_epi64(_mm256_mul_epu32(weight, even), half);
                let odd = _mm256_add_epi64(_mm256_mul_epu32(weight, odd), half);
                let share = _mm256_blend_epi32::<0b1010_1010>(
                    _mm256_srl_epi64(even, right),
                    _mm256_sll_epi64(odd, left),
                );
                let share = _mm256_sub_epi32(_mm256_xor_si256(share, signs), signs);
                let place = sums.as_mut_ptr().cast();
                let added = _mm256_add_epi32(_mm256_loadu_si256(place), share);
                if _mm256_movemask_ps(_mm256_castsi256_ps(added)) & 0x80 != 0 {
                    return false;
                }
                _mm256_storeu_si256(place, added);
            }
            true
        }
    }

    /// Eight words of 32 bits fill half of a vector.
    impl PixelSums for Avx512 {
        type Attributes = AttributeFactors;

        #[inline(always)]
        fn attributes(self, values: &[i32; 8], shift: ShareShift) -> AttributeFactors {
            self.avx2().attributes(values, shift)
        }
        #[inline(always)]
        fn add_shares(self, sums: &mut Sums, weight: &i64, attributes: &AttributeFactors) -> bool {
            self.avx2().add_shares(sums, weight, attributes)
        }
    }
}
