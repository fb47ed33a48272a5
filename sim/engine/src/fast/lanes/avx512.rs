//! Sixteen words by AVX-512, truth values in mask registers. Sound for the reasons given in [`avx2`](super::avx2).

#![allow(unsafe_code)]

use super::fused::FusedTask;
use super::{Lanes, ProductShift, VectorTask};
use std::arch::x86_64::*;

/// Proof that the processor has AVX-512 F, BW, DQ, VL, CD and IFMA and all that AVX2 processors have.
#[derive(Clone, Copy, Debug)]
pub struct Avx512(());

impl Avx512 {
    /// The proof, if the processor has all of it.
    #[inline]
    pub fn detect() -> Option<Self> {
        let all = super::avx2::Avx2::detect().is_some()
            && is_x86_feature_detected!("avx512f")
            && is_x86_feature_detected!("avx512bw")
            && is_x86_feature_detected!("avx512dq")
            && is_x86_feature_detected!("avx512vl")
            && is_x86_feature_detected!("avx512cd")
            && is_x86_feature_detected!("avx512ifma");
        all.then_some(Avx512(()))
    }
}

#[target_feature(
    enable = "avx512f,avx512bw,avx512dq,avx512vl,avx512cd,avx512ifma,avx2,bmi1,bmi2,lzcnt,popcnt,fma"
)]
fn run_with<T: VectorTask>(lanes: Avx512, task: T) -> T::Output {
    task.run(lanes)
}

#[target_feature(
    enable = "avx512f,avx512bw,avx512dq,avx512vl,avx512cd,avx512ifma,avx2,bmi1,bmi2,lzcnt,popcnt,fma"
)]
fn run_fused_with<T: FusedTask>(lanes: Avx512, task: T) -> T::Output {
    task.run(lanes)
}

impl Avx512 {
    /// Runs a task compiled for this processor.
    #[inline(always)]
    pub fn run_fused<T: FusedTask>(self, task: T) -> T::Output {
        // SAFETY: `self` proves that the processor has what the function is compiled for.
        unsafe { run_fused_with(self, task) }
    }
}

impl Lanes for Avx512 {
    const WIDTH: usize = 16;
    type Words = __m512i;
    type Mask = __mmask16;
    type Count = u64;

    #[inline(always)]
    fn splat(self, value: u32) -> __m512i {
        op!(_mm512_set1_epi32(value as i32))
    }
    #[inline(always)]
    fn iota(self) -> __m512i {
        op!(_mm512_setr_epi32(
            0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15
        ))
    }
    #[inline(always)]
    fn load(self, from: &[u32]) -> __m512i {
        let words: [u32; 16] = from.first_chunk().copied().unwrap_or_default();
        // SAFETY: the array has the 64 bytes that are read; no alignment is needed.
        unsafe { _mm512_loadu_si512(words.as_ptr().cast()) }
    }
    #[inline(always)]
    fn store(self, to: &mut [u32], value: __m512i) {
        if let Some(words) = to.first_chunk_mut::<16>() {
            // SAFETY: the array has the 64 bytes that are written; no alignment is needed.
            unsafe { _mm512_storeu_si512(words.as_mut_ptr().cast(), value) }
        }
    }
    #[inline(always)]
    fn add(self, a: __m512i, b: __m512i) -> __m512i {
        op!(_mm512_add_epi32(a, b))
    }
    #[inline(always)]
    fn sub(self, a: __m512i, b: __m512i) -> __m512i {
        op!(_mm512_sub_epi32(a, b))
    }
    #[inline(always)]
    fn mul(self, a: __m512i, b: __m512i) -> __m512i {
        op!(_mm512_mullo_epi32(a, b))
    }
    #[inline(always)]
    fn shl(self, a: __m512i, by: u32) -> __m512i {
        op!(_mm512_sll_epi32(a, _mm_cvtsi32_si128(by as i32)))
    }
    #[inline(always)]
    fn shr(self, a: __m512i, by: u32) -> __m512i {
        op!(_mm512_srl_epi32(a, _mm_cvtsi32_si128(by as i32)))
    }
    #[inline(always)]
    fn sar(self, a: __m512i, by: u32) -> __m512i {
        op!(_mm512_sra_epi32(a, _mm_cvtsi32_si128(by as i32)))
    }
    #[inline(always)]
    fn and(self, a: __m512i, b: __m512i) -> __m512i {
        op!(_mm512_and_si512(a, b))
    }
    #[inline(always)]
    fn or(self, a: __m512i, b: __m512i) -> __m512i {
        op!(_mm512_or_si512(a, b))
    }
    #[inline(always)]
    fn max_signed(self, a: __m512i, b: __m512i) -> __m512i {
        op!(_mm512_max_epi32(a, b))
    }
    #[inline(always)]
    fn min_unsigned(self, a: __m512i, b: __m512i) -> __m512i {
        op!(_mm512_min_epu32(a, b))
    }
    #[inline(always)]
    fn product(self, a: __m512i, b: __m512i, drop: ProductShift) -> __m512i {
        if drop.narrow {
            let rounded = self.add(self.mul(a, b), self.splat(drop.half as u32));
            return self.shr(rounded, drop.shift);
        }
        let (even, odd) = op!((
            _mm512_mul_epu32(a, b),
            _mm512_mul_epu32(_mm512_srli_epi64(a, 32), _mm512_srli_epi64(b, 32)),
        ));
        join(even, odd, drop)
    }
    #[inline(always)]
    fn product_from(self, a: __m512i, b: __m512i, drop: ProductShift, least: u64) -> __m512i {
        if drop.narrow {
            let product = self.mul(a, b);
            let product = self.clear(product, self.greater(self.splat(least as u32), product));
            return self.shr(self.add(product, self.splat(drop.half as u32)), drop.shift);
        }
        let least = op!(_mm512_set1_epi64(least as i64));
        let kept = |product| {
            op!(_mm512_maskz_mov_epi64(
                _mm512_cmpge_epi64_mask(product, least),
                product
            ))
        };
        let (even, odd) = op!((
            _mm512_mul_epu32(a, b),
            _mm512_mul_epu32(_mm512_srli_epi64(a, 32), _mm512_srli_epi64(b, 32)),
        ));
        join(kept(even), kept(odd), drop)
    }
    #[inline(always)]
    fn signed_product(self, a: __m512i, b: __m512i, drop: ProductShift) -> __m512i {
        if drop.narrow {
            let rounded = self.add(self.mul(a, b), self.splat(drop.half as u32));
            return self.sar(rounded, drop.shift);
        }
        let (even, odd) = op!((
            _mm512_mul_epi32(a, b),
            _mm512_mul_epi32(_mm512_srli_epi64(a, 32), _mm512_srli_epi64(b, 32)),
        ));
        join(even, odd, drop)
    }
    #[inline(always)]
    fn gather(self, table: &[u32], index: __m512i, mask: __mmask16) -> __m512i {
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
            _mm512_mask_i32gather_epi32::<4>(
                _mm512_setzero_si512(),
                mask,
                index,
                table.as_ptr().cast(),
            )
        }
    }
    #[inline(always)]
    fn greater(self, a: __m512i, b: __m512i) -> __mmask16 {
        op!(_mm512_cmpgt_epi32_mask(a, b))
    }
    #[inline(always)]
    fn first(self, count: usize) -> __mmask16 {
        ((1u32 << count.min(16)) - 1) as __mmask16
    }
    #[inline(always)]
    fn both(self, a: __mmask16, b: __mmask16) -> __mmask16 {
        a & b
    }
    #[inline(always)]
    fn except(self, a: __mmask16, b: __mmask16) -> __mmask16 {
        a & !b
    }
    #[inline(always)]
    fn negative(self, a: __m512i) -> __mmask16 {
        op!(_mm512_movepi32_mask(a))
    }
    #[inline(always)]
    fn is_none(self, a: __mmask16) -> bool {
        a == 0
    }
    #[inline(always)]
    fn clear(self, a: __m512i, mask: __mmask16) -> __m512i {
        op!(_mm512_maskz_mov_epi32(!mask, a))
    }
    #[inline(always)]
    fn select(self, a: __m512i, b: __m512i, mask: __mmask16) -> __m512i {
        op!(_mm512_mask_mov_epi32(a, mask, b))
    }
    #[inline(always)]
    fn no_count(self) -> u64 {
        0
    }
    #[inline(always)]
    fn count(self, count: u64, mask: __mmask16) -> u64 {
        count + u64::from(mask.count_ones())
    }
    #[inline(always)]
    fn total(self, count: u64) -> u64 {
        count
    }
    #[inline(always)]
    fn run<T: VectorTask>(self, task: T) -> T::Output {
        // SAFETY: `self` proves that the processor has what the function is compiled for.
        unsafe { run_with(self, task) }
    }
}

/// Rounds and shifts the 64-bit products of the even and of the odd words, and interleaves their low words.
#[inline(always)]
fn join(even: __m512i, odd: __m512i, drop: ProductShift) -> __m512i {
    // SAFETY: only reached through a value of `Avx512`.
    unsafe {
        let half = _mm512_set1_epi64(drop.half as i64);
        let count = |by: u32| _mm_cvtsi32_si128(by as i32);
        let even = _mm512_srl_epi64(_mm512_add_epi64(even, half), count(drop.shift));
        let odd = _mm512_add_epi64(odd, half);
        let odd = if drop.shift <= 32 {
            _mm512_sll_epi64(odd, count(32 - drop.shift))
        } else {
            _mm512_srl_epi64(odd, count(drop.shift - 32))
        };
        _mm512_mask_mov_epi32(even, 0b1010_1010_1010_1010, odd)
    }
}
