//! Eight words by AVX2.
//!
//! Two reasons make the `unsafe` code sound, here and in the siblings that build on [`Avx2`] and `Avx512`:
//! a value of [`Avx2`] exists only after detection, so every intrinsic finds its instruction; and the three operations that
//! touch memory (load, store, gather) are given a checked array or an index that has been brought into the table.

#![allow(unsafe_code)]

use super::words::PixelTask;
use super::{Lanes, ProductShift, VectorTask};
use std::arch::x86_64::*;

/// Proof that the processor has AVX2, BMI, LZCNT, POPCNT and FMA.
#[derive(Clone, Copy, Debug)]
pub struct Avx2(());

impl Avx2 {
    /// The proof, if the processor has all of it.
    #[inline]
    pub fn detect() -> Option<Self> {
        let all = is_x86_feature_detected!("avx2")
            && is_x86_feature_detected!("bmi1")
            && is_x86_feature_detected!("bmi2")
            && is_x86_feature_detected!("lzcnt")
            && is_x86_feature_detected!("popcnt")
            && is_x86_feature_detected!("fma");
        all.then_some(Avx2(()))
    }
}

#[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt,fma")]
fn run_with<T: VectorTask>(lanes: Avx2, task: T) -> T::Output {
    task.run(lanes)
}

#[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt,fma")]
fn run_pixels_with<T: PixelTask>(lanes: Avx2, task: T) -> T::Output {
    task.run(lanes)
}

impl Avx2 {
    /// Runs a task on pixels compiled for this processor.
    #[inline(always)]
    pub fn run_pixels<T: PixelTask>(self, task: T) -> T::Output {
        // SAFETY: `self` proves that the processor has what the function is compiled for.
        unsafe { run_pixels_with(self, task) }
    }
}

/// Bit patterns of which an unaligned part starts with so many true words.
static FIRST: [u32; 16] = {
    let mut words = [0; 16];
    let mut k = 0;
    while k < 8 {
        words[k] = u32::MAX;
        k += 1;
    }
    words
};

impl Lanes for Avx2 {
    const WIDTH: usize = 8;
    type Words = __m256i;
    type Mask = __m256i;
    type Count = __m256i;

    #[inline(always)]
    fn splat(self, value: u32) -> __m256i {
        op!(_mm256_set1_epi32(value as i32))
    }
    #[inline(always)]
    fn iota(self) -> __m256i {
        op!(_mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7))
    }
    #[inline(always)]
    fn load(self, from: &[u32]) -> __m256i {
        let words: [u32; 8] = from.first_chunk().copied().unwrap_or_default();
        // SAFETY: the array has the 32 bytes that are read; no alignment is needed.
        unsafe { _mm256_loadu_si256(words.as_ptr().cast()) }
    }
    #[inline(always)]
    fn store(self, to: &mut [u32], value: __m256i) {
        if let Some(words) = to.first_chunk_mut::<8>() {
            // SAFETY: the array has the 32 bytes that are written; no alignment is needed.
            unsafe { _mm256_storeu_si256(words.as_mut_ptr().cast(), value) }
        }
    }
    #[inline(always)]
    fn add(self, a: __m256i, b: __m256i) -> __m256i {
        op!(_mm256_add_epi32(a, b))
    }
    #[inline(always)]
    fn sub(self, a: __m256i, b: __m256i) -> __m256i {
        op!(_mm256_sub_epi32(a, b))
    }
    #[inline(always)]
    fn mul(self, a: __m256i, b: __m256i) -> __m256i {
        op!(_mm256_mullo_epi32(a, b))
    }
    #[inline(always)]
    fn shl(self, a: __m256i, by: u32) -> __m256i {
        op!(_mm256_sll_epi32(a, _mm_cvtsi32_si128(by as i32)))
    }
    #[inline(always)]
    fn shr(self, a: __m256i, by: u32) -> __m256i {
        op!(_mm256_srl_epi32(a, _mm_cvtsi32_si128(by as i32)))
    }
    #[inline(always)]
    fn sar(self, a: __m256i, by: u32) -> __m256i {
        op!(_mm256_sra_epi32(a, _mm_cvtsi32_si128(by as i32)))
    }
    #[inline(always)]
    fn and(self, a: __m256i, b: __m256i) -> __m256i {
        op!(_mm256_and_si256(a, b))
    }
    #[inline(always)]
    fn or(self, a: __m256i, b: __m256i) -> __m256i {
        op!(_mm256_or_si256(a, b))
    }
    #[inline(always)]
    fn max_signed(self, a: __m256i, b: __m256i) -> __m256i {
        op!(_mm256_max_epi32(a, b))
    }
    #[inline(always)]
    fn min_unsigned(self, a: __m256i, b: __m256i) -> __m256i {
        op!(_mm256_min_epu32(a, b))
    }
    #[inline(always)]
    fn product(self, a: __m256i, b: __m256i, drop: ProductShift) -> __m256i {
        if drop.narrow {
            let rounded = self.add(self.mul(a, b), self.splat(drop.half as u32));
            return self.shr(rounded, drop.shift);
        }
        let (even, odd) = op!((
            _mm256_mul_epu32(a, b),
            _mm256_mul_epu32(_mm256_srli_epi64(a, 32), _mm256_srli_epi64(b, 32)),
        ));
        join(even, odd, drop)
    }
    #[inline(always)]
    fn product_from(self, a: __m256i, b: __m256i, drop: ProductShift, least: u64) -> __m256i {
        if drop.narrow {
            let product = self.mul(a, b);
            let product = self.clear(product, self.greater(self.splat(least as u32), product));
            return self.shr(self.add(product, self.splat(drop.half as u32)), drop.shift);
        }
        let least = op!(_mm256_set1_epi64x(least as i64));
        let kept = |product| {
            op!(_mm256_andnot_si256(
                _mm256_cmpgt_epi64(least, product),
                product
            ))
        };
        let (even, odd) = op!((
            _mm256_mul_epu32(a, b),
            _mm256_mul_epu32(_mm256_srli_epi64(a, 32), _mm256_srli_epi64(b, 32)),
        ));
        join(kept(even), kept(odd), drop)
    }
    #[inline(always)]
    fn signed_product(self, a: __m256i, b: __m256i, drop: ProductShift) -> __m256i {
        if drop.narrow {
            let rounded = self.add(self.mul(a, b), self.splat(drop.half as u32));
            return self.sar(rounded, drop.shift);
        }
        let (even, odd) = op!((
            _mm256_mul_epi32(a, b),
            _mm256_mul_epi32(_mm256_srli_epi64(a, 32), _mm256_srli_epi64(b, 32)),
        ));
        join(even, odd, drop)
    }
    #[inline(always)]
    fn gather(self, table: &[u32], index: __m256i, mask: __m256i) -> __m256i {
        let Some(last) = table
            .len()
            .checked_sub(1)
            .and_then(|n| i32::try_from(n).ok())
        else {
            return self.splat(0);
        };
        let index = self.min_unsigned(index, self.splat(last as u32));
        // SAFETY: every index lies in the table.
        unsafe {
            _mm256_mask_i32gather_epi32::<4>(
                _mm256_setzero_si256(),
                table.as_ptr().cast(),
                index,
                mask,
            )
        }
    }
    #[inline(always)]
    fn greater(self, a: __m256i, b: __m256i) -> __m256i {
        op!(_mm256_cmpgt_epi32(a, b))
    }
    #[inline(always)]
    fn first(self, count: usize) -> __m256i {
        self.load(&FIRST[8 - count.min(8)..])
    }
    #[inline(always)]
    fn both(self, a: __m256i, b: __m256i) -> __m256i {
        op!(_mm256_and_si256(a, b))
    }
    #[inline(always)]
    fn except(self, a: __m256i, b: __m256i) -> __m256i {
        op!(_mm256_andnot_si256(b, a))
    }
    #[inline(always)]
    fn negative(self, a: __m256i) -> __m256i {
        op!(_mm256_srai_epi32(a, 31))
    }
    #[inline(always)]
    fn is_none(self, a: __m256i) -> bool {
        op!(_mm256_testz_si256(a, a)) != 0
    }
    #[inline(always)]
    fn clear(self, a: __m256i, mask: __m256i) -> __m256i {
        op!(_mm256_andnot_si256(mask, a))
    }
    #[inline(always)]
    fn select(self, a: __m256i, b: __m256i, mask: __m256i) -> __m256i {
        op!(_mm256_blendv_epi8(a, b, mask))
    }
    #[inline(always)]
    fn no_count(self) -> __m256i {
        self.splat(0)
    }
    #[inline(always)]
    fn count(self, count: __m256i, mask: __m256i) -> __m256i {
        // A true word is -1.
        self.sub(count, mask)
    }
    #[inline(always)]
    fn total(self, count: __m256i) -> u64 {
        let mut words = [0; 8];
        self.store(&mut words, count);
        words.iter().map(|word| u64::from(*word)).sum()
    }
    #[inline(always)]
    fn run<T: VectorTask>(self, task: T) -> T::Output {
        // SAFETY: `self` proves that the processor has what the function is compiled for.
        unsafe { run_with(self, task) }
    }
}

/// Rounds and shifts the 64-bit products of the even and of the odd words, and interleaves their low words.
#[inline(always)]
fn join(even: __m256i, odd: __m256i, drop: ProductShift) -> __m256i {
    // SAFETY: only reached through a value of `Avx2`.
    unsafe {
        let half = _mm256_set1_epi64x(drop.half as i64);
        let count = |by: u32| _mm_cvtsi32_si128(by as i32);
        let even = _mm256_srl_epi64(_mm256_add_epi64(even, half), count(drop.shift));
        let odd = _mm256_add_epi64(odd, half);
        let odd = if drop.shift <= 32 {
            _mm256_sll_epi64(odd, count(32 - drop.shift))
        } else {
            _mm256_srl_epi64(odd, count(drop.shift - 32))
        };
        _mm256_blend_epi32::<0b1010_1010>(even, odd)
    }
}
