//! Vectors of AVX-512, and the proof that the processor has it. Sound for the reasons given in [`avx2`](super::avx2).

#![allow(unsafe_code)]

use super::avx2::{AttributeFactors, Avx2, four_words, rows, store_rows, transposed};
use super::words::{Entries, Lanes, ShareShift, Sums};
use std::arch::x86_64::*;

/// Proof that the processor has AVX-512 F, BW, DQ, VL, CD and IFMA and all that AVX2 processors have. No
/// vector needs IFMA: it tells apart older processors, which lower their clock for 512 bits and were not measured.
#[derive(Clone, Copy, Debug)]
pub struct Avx512(Avx2);

impl Avx512 {
    /// The proof, if the processor has all of it.
    #[inline]
    pub fn detect() -> Option<Self> {
        let all = is_x86_feature_detected!("avx512f")
            && is_x86_feature_detected!("avx512bw")
            && is_x86_feature_detected!("avx512dq")
            && is_x86_feature_detected!("avx512vl")
            && is_x86_feature_detected!("avx512cd")
            && is_x86_feature_detected!("avx512ifma");
        Avx2::detect().filter(|_| all).map(Avx512)
    }

    /// The vectors of 256 bits that it has as well.
    #[inline(always)]
    pub fn avx2(self) -> Avx2 {
        self.0
    }
}

/// The lower words and the upper ones.
#[inline(always)]
fn halves(_: Avx512, a: __m512i) -> [__m256i; 2] {
    op!([_mm512_castsi512_si256(a), _mm512_extracti64x4_epi64::<1>(a)])
}

impl Lanes for Avx512 {
    const WIDE: usize = 8;
    type Word = __m512i;
    type Truth = __mmask8;
    type Attributes = AttributeFactors;
    type Singles = Avx2;

    #[inline(always)]
    fn splat(self, value: i64) -> __m512i {
        op!(_mm512_set1_epi64(value))
    }
    #[inline(always)]
    fn load(self, from: &[i64; 8]) -> __m512i {
        // SAFETY: a vector of the array's words is read.
        unsafe { _mm512_loadu_epi64(from.as_ptr()) }
    }
    #[inline(always)]
    fn columns(self, row: impl Fn(usize) -> [i32; 4]) -> [__m512i; 4] {
        let [a, b, c, d] = transposed(self.avx2(), [row(0), row(1), row(2), row(3)]);
        let [e, f, g, h] = transposed(self.avx2(), [row(4), row(5), row(6), row(7)]);
        op!([
            _mm512_cvtepi32_epi64(_mm256_set_m128i(e, a)),
            _mm512_cvtepi32_epi64(_mm256_set_m128i(f, b)),
            _mm512_cvtepi32_epi64(_mm256_set_m128i(g, c)),
            _mm512_cvtepi32_epi64(_mm256_set_m128i(h, d)),
        ])
    }
    #[inline(always)]
    fn rows(self, [a, b, c, d]: [__m512i; 4]) -> [[i32; 4]; 8] {
        let mut to = [[0; 4]; 8];
        let ([a, e], [b, f]) = (halves(self, a), halves(self, b));
        let ([c, g], [d, h]) = (halves(self, c), halves(self, d));
        let [to_0, to_1, to_2, to_3, to_4, to_5, to_6, to_7] = &mut to;
        let (below, above) = (
            rows(self.avx2(), [a, b, c, d]),
            rows(self.avx2(), [e, f, g, h]),
        );
        store_rows(self.avx2(), [to_0, to_1, to_2, to_3], below);
        store_rows(self.avx2(), [to_4, to_5, to_6, to_7], above);
        to
    }
    #[inline(always)]
    fn store(self, to: &mut [i64; 8], value: __m512i) {
        // SAFETY: a vector of the array's words is written.
        unsafe { _mm512_storeu_epi64(to.as_mut_ptr(), value) }
    }
    #[inline(always)]
    fn add(self, a: __m512i, b: __m512i) -> __m512i {
        op!(_mm512_add_epi64(a, b))
    }
    #[inline(always)]
    fn sub(self, a: __m512i, b: __m512i) -> __m512i {
        op!(_mm512_sub_epi64(a, b))
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
    fn xor(self, a: __m512i, b: __m512i) -> __m512i {
        op!(_mm512_xor_si512(a, b))
    }
    #[inline(always)]
    fn mul(self, a: __m512i, b: __m512i) -> __m512i {
        op!(_mm512_mul_epi32(a, b))
    }
    #[inline(always)]
    fn mul_unsigned(self, a: __m512i, b: __m512i) -> __m512i {
        op!(_mm512_mul_epu32(a, b))
    }
    #[inline(always)]
    fn mul_whole(self, a: __m512i, b: __m512i) -> __m512i {
        op!(_mm512_mullo_epi64(a, b))
    }
    #[inline(always)]
    fn shl(self, a: __m512i, by: __m512i) -> __m512i {
        op!(_mm512_sllv_epi64(a, by))
    }
    #[inline(always)]
    fn shr(self, a: __m512i, by: __m512i) -> __m512i {
        op!(_mm512_srlv_epi64(a, by))
    }
    #[inline(always)]
    fn sar(self, a: __m512i, by: __m512i) -> __m512i {
        op!(_mm512_srav_epi64(a, by))
    }
    #[inline(always)]
    fn leading_zeros(self, a: __m512i) -> __m512i {
        op!(_mm512_lzcnt_epi64(a))
    }
    #[inline(always)]
    fn pairs(self, table: Entries, index: __m512i) -> __m512i {
        let (entries, last) = table.to_last();
        let index = op!(_mm512_min_epu32(index, self.splat(last.into())));
        let [low, high] = halves(self, index);
        let words = entries.as_ptr();
        // SAFETY: every index and the next one lie in the table. An entry and the next one are a word of 64 bits.
        let word = |place| unsafe { words.add(place).cast::<u64>().read_unaligned() };
        let low = four_words(self.avx2(), low, word);
        let high = four_words(self.avx2(), high, word);
        op!(_mm512_inserti64x4::<1>(_mm512_castsi256_si512(low), high))
    }
    #[inline(always)]
    fn greater(self, a: __m512i, b: __m512i) -> __mmask8 {
        op!(_mm512_cmpgt_epi64_mask(a, b))
    }
    #[inline(always)]
    fn equal(self, a: __m512i, b: __m512i) -> __mmask8 {
        op!(_mm512_cmpeq_epi64_mask(a, b))
    }
    #[inline(always)]
    fn select(self, a: __m512i, b: __m512i, truth: __mmask8) -> __m512i {
        op!(_mm512_mask_mov_epi64(a, truth, b))
    }
    #[inline(always)]
    fn any(self, a: __m512i) -> bool {
        op!(_mm512_test_epi64_mask(a, a)) != 0
    }
    #[inline(always)]
    fn flags(self, truth: __mmask8) -> u32 {
        truth.into()
    }
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
    #[inline(always)]
    fn unmarked(self, a: __m512i) -> __m512i {
        // What becomes of lower halves is shifted out.
        let positive = op!(_mm512_max_epi32(a, _mm512_setzero_si512()));
        self.upper(positive)
    }
    #[inline(always)]
    fn upper(self, a: __m512i) -> __m512i {
        op!(_mm512_srli_epi64::<32>(a))
    }
    #[inline(always)]
    fn raised(self, a: __m512i) -> __m512i {
        op!(_mm512_slli_epi64::<32>(a))
    }
    #[inline(always)]
    fn halves(self, low: __m512i, high: __m512i) -> __m512i {
        op!(_mm512_mask_mov_epi32(low, 0xaaaa, high))
    }
    #[inline(always)]
    fn add_halves(self, a: __m512i, b: __m512i) -> __m512i {
        op!(_mm512_add_epi32(a, b))
    }
    #[inline(always)]
    fn marked(self, a: __m512i) -> __mmask8 {
        op!(_mm512_movepi64_mask(a))
    }
    #[inline(always)]
    fn first(self, count: usize) -> __mmask8 {
        (0xff_u32 >> (8 - count.min(8))) as __mmask8
    }
    #[inline(always)]
    fn both(self, a: __mmask8, b: __mmask8) -> __mmask8 {
        a & b
    }
    #[inline(always)]
    fn except(self, a: __mmask8, b: __mmask8) -> __mmask8 {
        a & !b
    }
    #[inline(always)]
    fn keep(self, a: __m512i, truth: __mmask8) -> __m512i {
        op!(_mm512_maskz_mov_epi64(truth, a))
    }
    #[inline(always)]
    fn clear(self, a: __m512i, truth: __mmask8) -> __m512i {
        self.keep(a, !truth)
    }
    #[inline(always)]
    fn min_short(self, a: __m512i, b: __m512i) -> __m512i {
        op!(_mm512_min_epu32(a, b))
    }
    #[inline(always)]
    fn multiples(self, a: __m512i) -> __m512i {
        op!(_mm512_mullo_epi64(
            a,
            _mm512_setr_epi64(0, 1, 2, 3, 4, 5, 6, 7)
        ))
    }
    #[inline(always)]
    fn attributes(self, values: &[i32; 8], shift: ShareShift) -> AttributeFactors {
        self.avx2().attributes(values, shift)
    }
    #[inline(always)]
    fn add_shares(self, sums: &mut Sums, weight: &i64, attributes: &AttributeFactors) -> bool {
        self.avx2().add_shares(sums, weight, attributes)
    }
}
