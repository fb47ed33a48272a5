//! Vectors of 64-bit words in registers of AVX-512 and AVX2.
//!
//! SAFETY of all intrinsics on registers: `self` proves that the processor has the instruction. Loads and stores are of
//! whole arrays, look-ups of indices that have been brought into the table.

use super::super::avx2::Avx2;
use super::super::avx512::Avx512;
use super::Wide;
#[cfg(not(miri))]
use std::arch::asm;
use std::arch::x86_64::*;

/// The columns of four rows.
#[inline(always)]
fn transposed(_: Avx2, rows: [[i32; 4]; 4]) -> [__m128i; 4] {
    // SAFETY: a vector of the array's integers is read; the rest works on registers.
    unsafe {
        let row = |k: usize| _mm_loadu_si128(rows[k].as_ptr().cast());
        let (a, b, c, d) = (row(0), row(1), row(2), row(3));
        let (low, low_below) = (_mm_unpacklo_epi32(a, b), _mm_unpacklo_epi32(c, d));
        let (high, high_below) = (_mm_unpackhi_epi32(a, b), _mm_unpackhi_epi32(c, d));
        [
            _mm_unpacklo_epi64(low, low_below),
            _mm_unpackhi_epi64(low, low_below),
            _mm_unpacklo_epi64(high, high_below),
            _mm_unpackhi_epi64(high, high_below),
        ]
    }
}

/// Four words' lower halves as rows: the first two places' in lower halves of 128 bits, the last two's in upper ones.
#[inline(always)]
fn rows(_: Avx2, [a, b, c, d]: [__m256i; 4]) -> [__m256i; 2] {
    op!({
        let first = _mm256_blend_epi32::<0xaa>(a, _mm256_slli_epi64::<32>(b));
        let second = _mm256_blend_epi32::<0xaa>(c, _mm256_slli_epi64::<32>(d));
        [
            _mm256_unpacklo_epi64(first, second),
            _mm256_unpackhi_epi64(first, second),
        ]
    })
}

/// Stores four rows that [`rows`] made.
#[inline(always)]
fn store_rows(_: Avx2, [to_0, to_1, to_2, to_3]: [&mut [i32; 4]; 4], [even, odd]: [__m256i; 2]) {
    // SAFETY: vectors of the arrays' integers are written.
    unsafe {
        _mm_storeu_si128(to_0.as_mut_ptr().cast(), _mm256_castsi256_si128(even));
        _mm_storeu_si128(to_1.as_mut_ptr().cast(), _mm256_castsi256_si128(odd));
        _mm_storeu_si128(
            to_2.as_mut_ptr().cast(),
            _mm256_extracti128_si256::<1>(even),
        );
        _mm_storeu_si128(to_3.as_mut_ptr().cast(), _mm256_extracti128_si256::<1>(odd));
    }
}

/// The lower words and the upper ones.
#[inline(always)]
pub fn halves(_: Avx512, a: __m512i) -> [__m256i; 2] {
    op!([_mm512_castsi512_si256(a), _mm512_extracti64x4_epi64::<1>(a)])
}

impl Wide for Avx512 {
    const WIDE: usize = 8;
    type Word = __m512i;
    type Truth = __mmask8;

    #[inline(always)]
    fn wide_splat(self, value: i64) -> __m512i {
        op!(_mm512_set1_epi64(value))
    }
    #[inline(always)]
    fn wide_load(self, from: &[i64; 8]) -> __m512i {
        // SAFETY: a vector of the array's words is read.
        unsafe { _mm512_loadu_epi64(from.as_ptr()) }
    }
    #[inline(always)]
    fn wide_columns(self, row: impl Fn(usize) -> [i32; 4]) -> [__m512i; 4] {
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
    fn wide_rows(self, to: &mut [[i32; 4]; 8], [a, b, c, d]: [__m512i; 4]) {
        let ([a, e], [b, f]) = (halves(self, a), halves(self, b));
        let ([c, g], [d, h]) = (halves(self, c), halves(self, d));
        let [to_0, to_1, to_2, to_3, to_4, to_5, to_6, to_7] = to;
        let (below, above) = (
            rows(self.avx2(), [a, b, c, d]),
            rows(self.avx2(), [e, f, g, h]),
        );
        store_rows(self.avx2(), [to_0, to_1, to_2, to_3], below);
        store_rows(self.avx2(), [to_4, to_5, to_6, to_7], above);
    }
    #[inline(always)]
    fn wide_store(self, to: &mut [i64; 8], value: __m512i) {
        // SAFETY: a vector of the array's words is written.
        unsafe { _mm512_storeu_epi64(to.as_mut_ptr(), value) }
    }
    #[inline(always)]
    fn wide_add(self, a: __m512i, b: __m512i) -> __m512i {
        op!(_mm512_add_epi64(a, b))
    }
    #[inline(always)]
    fn wide_sub(self, a: __m512i, b: __m512i) -> __m512i {
        op!(_mm512_sub_epi64(a, b))
    }
    #[inline(always)]
    fn wide_and(self, a: __m512i, b: __m512i) -> __m512i {
        op!(_mm512_and_si512(a, b))
    }
    #[inline(always)]
    fn wide_or(self, a: __m512i, b: __m512i) -> __m512i {
        op!(_mm512_or_si512(a, b))
    }
    #[inline(always)]
    fn wide_xor(self, a: __m512i, b: __m512i) -> __m512i {
        op!(_mm512_xor_si512(a, b))
    }
    #[inline(always)]
    fn wide_mul(self, a: __m512i, b: __m512i) -> __m512i {
        op!(_mm512_mul_epi32(a, b))
    }
    #[inline(always)]
    fn wide_mul_unsigned(self, a: __m512i, b: __m512i) -> __m512i {
        op!(_mm512_mul_epu32(a, b))
    }
    #[inline(always)]
    fn wide_mul_whole(self, a: __m512i, b: __m512i) -> __m512i {
        op!(_mm512_mullo_epi64(a, b))
    }
    #[inline(always)]
    fn wide_shl(self, a: __m512i, by: __m512i) -> __m512i {
        op!(_mm512_sllv_epi64(a, by))
    }
    #[inline(always)]
    fn wide_shr(self, a: __m512i, by: __m512i) -> __m512i {
        op!(_mm512_srlv_epi64(a, by))
    }
    #[inline(always)]
    fn wide_sar(self, a: __m512i, by: __m512i) -> __m512i {
        op!(_mm512_srav_epi64(a, by))
    }
    #[inline(always)]
    fn wide_leading_zeros(self, a: __m512i) -> __m512i {
        op!(_mm512_lzcnt_epi64(a))
    }
    #[inline(always)]
    fn wide_gather(self, table: &[u32], index: __m512i) -> [__m512i; 2] {
        let Some(last) = table.len().checked_sub(2) else {
            return [self.wide_splat(0); 2];
        };
        // SAFETY: every index and the next one lie in the table. An entry and the next one are a word of 64 bits.
        unsafe {
            let index = _mm512_min_epu32(index, _mm512_set1_epi64(i64::from(last as u32)));
            let pairs = _mm512_i64gather_epi64::<4>(index, table.as_ptr().cast());
            let low = _mm512_and_si512(pairs, _mm512_set1_epi64(u32::MAX.into()));
            [low, _mm512_srli_epi64::<32>(pairs)]
        }
    }
    #[inline(always)]
    fn wide_greater(self, a: __m512i, b: __m512i) -> __mmask8 {
        op!(_mm512_cmpgt_epi64_mask(a, b))
    }
    #[inline(always)]
    fn wide_equal(self, a: __m512i, b: __m512i) -> __mmask8 {
        op!(_mm512_cmpeq_epi64_mask(a, b))
    }
    #[inline(always)]
    fn wide_select(self, a: __m512i, b: __m512i, truth: __mmask8) -> __m512i {
        op!(_mm512_mask_mov_epi64(a, truth, b))
    }
    #[inline(always)]
    fn wide_any(self, a: __m512i) -> bool {
        op!(_mm512_test_epi64_mask(a, a)) != 0
    }
    #[inline(always)]
    fn wide_flags(self, truth: __mmask8) -> u32 {
        truth.into()
    }
}

/// A word for each of four places by a load of its own: a gather of four takes longer on most processors.
#[inline(always)]
pub fn four_words(_: Avx2, places: __m256i, word: impl Fn(usize) -> u64) -> __m256i {
    op!({
        let two = |places: __m128i| {
            let upper = word(_mm_extract_epi64::<1>(places) as usize);
            _mm_set_epi64x(
                upper as i64,
                word(_mm_cvtsi128_si64(places) as usize) as i64,
            )
        };
        let low = two(_mm256_castsi256_si128(places));
        let high = two(_mm256_extracti128_si256::<1>(places));
        _mm256_inserti128_si256::<1>(_mm256_castsi128_si256(low), high)
    })
}

/// Products of lower halves. Miri, which interprets no assembly, has the intrinsics.
#[cfg(miri)]
use std::arch::x86_64::{_mm256_mul_epi32 as product, _mm256_mul_epu32 as product_unsigned};

/// Products of lower halves, written out: the compiler knows the intrinsics as products of 64 bits by 64, which it
/// makes of them where a factor was brought into another block.
#[cfg(not(miri))]
#[inline]
#[target_feature(enable = "avx2")]
fn product(a: __m256i, b: __m256i) -> __m256i {
    let product;
    // SAFETY: the processor has the instruction, which works on registers.
    unsafe {
        asm!("vpmuldq {}, {}, {}", lateout(ymm_reg) product, in(ymm_reg) a, in(ymm_reg) b,
            options(pure, nomem, nostack, preserves_flags));
    }
    product
}

/// The same without signs.
#[cfg(not(miri))]
#[inline]
#[target_feature(enable = "avx2")]
fn product_unsigned(a: __m256i, b: __m256i) -> __m256i {
    let product;
    // SAFETY: as above.
    unsafe {
        asm!("vpmuludq {}, {}, {}", lateout(ymm_reg) product, in(ymm_reg) a, in(ymm_reg) b,
            options(pure, nomem, nostack, preserves_flags));
    }
    product
}

impl Wide for Avx2 {
    const WIDE: usize = 4;
    type Word = __m256i;
    type Truth = __m256i;

    #[inline(always)]
    fn wide_splat(self, value: i64) -> __m256i {
        op!(_mm256_set1_epi64x(value))
    }
    #[inline(always)]
    fn wide_load(self, from: &[i64; 8]) -> __m256i {
        // SAFETY: a vector of the array's words is read.
        unsafe { _mm256_loadu_si256(from.as_ptr().cast()) }
    }
    #[inline(always)]
    fn wide_columns(self, row: impl Fn(usize) -> [i32; 4]) -> [__m256i; 4] {
        let [a, b, c, d] = transposed(self, [row(0), row(1), row(2), row(3)]);
        op!([
            _mm256_cvtepi32_epi64(a),
            _mm256_cvtepi32_epi64(b),
            _mm256_cvtepi32_epi64(c),
            _mm256_cvtepi32_epi64(d),
        ])
    }
    #[inline(always)]
    fn wide_rows(self, to: &mut [[i32; 4]; 8], columns: [__m256i; 4]) {
        let [to_0, to_1, to_2, to_3, ..] = to;
        store_rows(self, [to_0, to_1, to_2, to_3], rows(self, columns));
    }
    #[inline(always)]
    fn wide_store(self, to: &mut [i64; 8], value: __m256i) {
        // SAFETY: a vector of the array's words is written.
        unsafe { _mm256_storeu_si256(to.as_mut_ptr().cast(), value) }
    }
    #[inline(always)]
    fn wide_add(self, a: __m256i, b: __m256i) -> __m256i {
        op!(_mm256_add_epi64(a, b))
    }
    #[inline(always)]
    fn wide_sub(self, a: __m256i, b: __m256i) -> __m256i {
        op!(_mm256_sub_epi64(a, b))
    }
    #[inline(always)]
    fn wide_and(self, a: __m256i, b: __m256i) -> __m256i {
        op!(_mm256_and_si256(a, b))
    }
    #[inline(always)]
    fn wide_or(self, a: __m256i, b: __m256i) -> __m256i {
        op!(_mm256_or_si256(a, b))
    }
    #[inline(always)]
    fn wide_xor(self, a: __m256i, b: __m256i) -> __m256i {
        op!(_mm256_xor_si256(a, b))
    }
    #[inline(always)]
    fn wide_mul(self, a: __m256i, b: __m256i) -> __m256i {
        op!(product(a, b))
    }
    #[inline(always)]
    fn wide_mul_unsigned(self, a: __m256i, b: __m256i) -> __m256i {
        op!(product_unsigned(a, b))
    }
    #[inline(always)]
    fn wide_shl(self, a: __m256i, by: __m256i) -> __m256i {
        op!(_mm256_sllv_epi64(a, by))
    }
    #[inline(always)]
    fn wide_shr(self, a: __m256i, by: __m256i) -> __m256i {
        op!(_mm256_srlv_epi64(a, by))
    }
    #[inline(always)]
    fn wide_greater(self, a: __m256i, b: __m256i) -> __m256i {
        op!(_mm256_cmpgt_epi64(a, b))
    }
    #[inline(always)]
    fn wide_equal(self, a: __m256i, b: __m256i) -> __m256i {
        op!(_mm256_cmpeq_epi64(a, b))
    }
    #[inline(always)]
    fn wide_select(self, a: __m256i, b: __m256i, truth: __m256i) -> __m256i {
        // By words: of those by bytes the compiler compares every byte with 0 first.
        op!({
            let (a, b) = (_mm256_castsi256_pd(a), _mm256_castsi256_pd(b));
            _mm256_castpd_si256(_mm256_blendv_pd(a, b, _mm256_castsi256_pd(truth)))
        })
    }
    #[inline(always)]
    fn wide_mul_whole(self, a: __m256i, b: __m256i) -> __m256i {
        op!({
            let upper = |word| _mm256_srli_epi64::<32>(word);
            let crossed =
                _mm256_add_epi64(_mm256_mul_epu32(upper(a), b), _mm256_mul_epu32(a, upper(b)));
            _mm256_add_epi64(_mm256_mul_epu32(a, b), _mm256_slli_epi64::<32>(crossed))
        })
    }
    #[inline(always)]
    fn wide_leading_zeros(self, a: __m256i) -> __m256i {
        // The upper half if it is not 0, else the lower one, as a double: its exponent counts.
        op!({
            let upper = _mm256_srli_epi64(a, 32);
            let low = _mm256_cmpeq_epi64(upper, _mm256_setzero_si256());
            let half = _mm256_blendv_epi8(upper, a, low);
            let unit = _mm256_castpd_si256(_mm256_set1_pd((1u64 << 52) as f64));
            let number = _mm256_sub_pd(
                _mm256_castsi256_pd(_mm256_or_si256(half, unit)),
                _mm256_castsi256_pd(unit),
            );
            let exponent = _mm256_srli_epi64(_mm256_castpd_si256(number), 52);
            let base = _mm256_blendv_epi8(
                _mm256_set1_epi64x(1023 + 31),
                _mm256_set1_epi64x(1023 + 63),
                low,
            );
            let zeros = _mm256_sub_epi64(base, exponent);
            let none = _mm256_cmpeq_epi64(a, _mm256_setzero_si256());
            _mm256_blendv_epi8(zeros, _mm256_set1_epi64x(64), none)
        })
    }
    #[inline(always)]
    fn wide_sar(self, a: __m256i, by: __m256i) -> __m256i {
        // Inverted where negative, so that zeros may come in.
        let sign = self.wide_greater(self.wide_splat(0), a);
        op!(_mm256_xor_si256(
            _mm256_srlv_epi64(_mm256_xor_si256(a, sign), by),
            sign
        ))
    }
    #[inline(always)]
    fn wide_sar_by(self, a: __m256i, by: u32) -> __m256i {
        // 2^63 more makes signed words unsigned ones in their order.
        let turned = self.wide_add(a, self.wide_splat(i64::MIN));
        let turn = 1i64 << (63 - by);
        let shifted = self.wide_shr(turned, self.wide_splat(by.into()));
        self.wide_sub(shifted, self.wide_splat(turn))
    }
    #[inline(always)]
    fn wide_gather(self, table: &[u32], index: __m256i) -> [__m256i; 2] {
        let Some(last) = table.len().checked_sub(2) else {
            return [self.wide_splat(0); 2];
        };
        let last = self.wide_splat(i64::from(last as u32));
        let index = op!(_mm256_min_epu32(index, last));
        // SAFETY: every index and the next one lie in the table. An entry and the next one are a word of 64 bits.
        unsafe {
            let words = table.as_ptr();
            let pairs = four_words(self, index, |place| {
                words.add(place).cast::<u64>().read_unaligned()
            });
            let low = _mm256_and_si256(pairs, self.wide_splat(u32::MAX.into()));
            [low, _mm256_srli_epi64::<32>(pairs)]
        }
    }
    #[inline(always)]
    fn wide_any(self, a: __m256i) -> bool {
        op!(_mm256_testz_si256(a, a)) == 0
    }
    #[inline(always)]
    fn wide_flags(self, truth: __m256i) -> u32 {
        op!(_mm256_movemask_pd(_mm256_castsi256_pd(truth))) as u32
    }
}
