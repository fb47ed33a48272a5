//! Vectors of AVX2, and the proof that the processor has it.
//!
//! Two reasons make the `unsafe` code sound, here and in the siblings that build on [`Avx2`] and `Avx512`:
//! a value of [`Avx2`] exists only after detection, so every intrinsic finds its instruction; and the operations that
//! touch memory (load, store, gather) are given a checked array or an index that has been brought into the table.

#![allow(unsafe_code)]

use super::words::{Entries, Lanes, ShareShift, Sums};
#[cfg(not(miri))]
use std::arch::asm;
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

/// The columns of four rows.
#[inline(always)]
pub(super) fn transposed(_: Avx2, rows: [[i32; 4]; 4]) -> [__m128i; 4] {
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
pub(super) fn rows(_: Avx2, [a, b, c, d]: [__m256i; 4]) -> [__m256i; 2] {
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
pub(super) fn store_rows(
    _: Avx2,
    [to_0, to_1, to_2, to_3]: [&mut [i32; 4]; 4],
    [even, odd]: [__m256i; 2],
) {
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

/// A word for each of four places by a load of its own: a gather of four takes longer on most processors.
#[inline(always)]
pub(super) fn four_words(_: Avx2, places: __m256i, word: impl Fn(usize) -> u64) -> __m256i {
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

/// Words of which an unaligned part starts with so many true ones.
static FIRST: [i64; 8] = [-1, -1, -1, -1, 0, 0, 0, 0];

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

impl Lanes for Avx2 {
    const WIDE: usize = 4;
    type Word = __m256i;
    type Truth = __m256i;
    type Attributes = AttributeFactors;
    type Singles = Avx2;

    #[inline(always)]
    fn splat(self, value: i64) -> __m256i {
        op!(_mm256_set1_epi64x(value))
    }
    #[inline(always)]
    fn load(self, from: &[i64; 8]) -> __m256i {
        // SAFETY: a vector of the array's words is read.
        unsafe { _mm256_loadu_si256(from.as_ptr().cast()) }
    }
    #[inline(always)]
    fn columns(self, row: impl Fn(usize) -> [i32; 4]) -> [__m256i; 4] {
        let [a, b, c, d] = transposed(self, [row(0), row(1), row(2), row(3)]);
        op!([
            _mm256_cvtepi32_epi64(a),
            _mm256_cvtepi32_epi64(b),
            _mm256_cvtepi32_epi64(c),
            _mm256_cvtepi32_epi64(d),
        ])
    }
    #[inline(always)]
    fn rows(self, columns: [__m256i; 4]) -> [[i32; 4]; 8] {
        let mut to = [[0; 4]; 8];
        let [to_0, to_1, to_2, to_3, ..] = &mut to;
        store_rows(self, [to_0, to_1, to_2, to_3], rows(self, columns));
        to
    }
    #[inline(always)]
    fn store(self, to: &mut [i64; 8], value: __m256i) {
        // SAFETY: a vector of the array's words is written.
        unsafe { _mm256_storeu_si256(to.as_mut_ptr().cast(), value) }
    }
    #[inline(always)]
    fn add(self, a: __m256i, b: __m256i) -> __m256i {
        op!(_mm256_add_epi64(a, b))
    }
    #[inline(always)]
    fn sub(self, a: __m256i, b: __m256i) -> __m256i {
        op!(_mm256_sub_epi64(a, b))
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
    fn xor(self, a: __m256i, b: __m256i) -> __m256i {
        op!(_mm256_xor_si256(a, b))
    }
    #[inline(always)]
    fn mul(self, a: __m256i, b: __m256i) -> __m256i {
        op!(product(a, b))
    }
    #[inline(always)]
    fn mul_unsigned(self, a: __m256i, b: __m256i) -> __m256i {
        op!(product_unsigned(a, b))
    }
    #[inline(always)]
    fn shl(self, a: __m256i, by: __m256i) -> __m256i {
        op!(_mm256_sllv_epi64(a, by))
    }
    #[inline(always)]
    fn shr(self, a: __m256i, by: __m256i) -> __m256i {
        op!(_mm256_srlv_epi64(a, by))
    }
    #[inline(always)]
    fn greater(self, a: __m256i, b: __m256i) -> __m256i {
        op!(_mm256_cmpgt_epi64(a, b))
    }
    #[inline(always)]
    fn equal(self, a: __m256i, b: __m256i) -> __m256i {
        op!(_mm256_cmpeq_epi64(a, b))
    }
    #[inline(always)]
    fn select(self, a: __m256i, b: __m256i, truth: __m256i) -> __m256i {
        // By words: of those by bytes the compiler compares every byte with 0 first.
        op!({
            let (a, b) = (_mm256_castsi256_pd(a), _mm256_castsi256_pd(b));
            _mm256_castpd_si256(_mm256_blendv_pd(a, b, _mm256_castsi256_pd(truth)))
        })
    }
    #[inline(always)]
    fn mul_whole(self, a: __m256i, b: __m256i) -> __m256i {
        op!({
            let upper = |word| _mm256_srli_epi64::<32>(word);
            let crossed =
                _mm256_add_epi64(_mm256_mul_epu32(upper(a), b), _mm256_mul_epu32(a, upper(b)));
            _mm256_add_epi64(_mm256_mul_epu32(a, b), _mm256_slli_epi64::<32>(crossed))
        })
    }
    #[inline(always)]
    fn leading_zeros(self, a: __m256i) -> __m256i {
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
    fn sar(self, a: __m256i, by: __m256i) -> __m256i {
        // Inverted where negative, so that zeros may come in.
        let sign = self.greater(self.splat(0), a);
        op!(_mm256_xor_si256(
            _mm256_srlv_epi64(_mm256_xor_si256(a, sign), by),
            sign
        ))
    }
    #[inline(always)]
    fn sar_by(self, a: __m256i, by: u32) -> __m256i {
        // 2^63 more makes signed words unsigned ones in their order.
        let turned = self.add(a, self.splat(i64::MIN));
        let turn = 1i64 << (63 - by);
        let shifted = self.shr(turned, self.splat(by.into()));
        self.sub(shifted, self.splat(turn))
    }
    #[inline(always)]
    fn pairs(self, table: Entries, index: __m256i) -> __m256i {
        let (entries, last) = table.to_last();
        let index = op!(_mm256_min_epu32(index, self.splat(last.into())));
        let words = entries.as_ptr();
        // SAFETY: every index and the next one lie in the table. An entry and the next one are a word of 64 bits.
        four_words(self, index, |place| unsafe {
            words.add(place).cast::<u64>().read_unaligned()
        })
    }
    #[inline(always)]
    fn any(self, a: __m256i) -> bool {
        op!(_mm256_testz_si256(a, a)) == 0
    }
    #[inline(always)]
    fn flags(self, truth: __m256i) -> u32 {
        op!(_mm256_movemask_pd(_mm256_castsi256_pd(truth))) as u32
    }
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
    #[inline(always)]
    fn unmarked(self, a: __m256i) -> __m256i {
        // What becomes of lower halves is shifted out.
        let positive = op!(_mm256_max_epi32(a, _mm256_setzero_si256()));
        self.upper(positive)
    }
    #[inline(always)]
    fn upper(self, a: __m256i) -> __m256i {
        op!(_mm256_srli_epi64::<32>(a))
    }
    #[inline(always)]
    fn raised(self, a: __m256i) -> __m256i {
        op!(_mm256_slli_epi64::<32>(a))
    }
    #[inline(always)]
    fn halves(self, low: __m256i, high: __m256i) -> __m256i {
        op!(_mm256_blend_epi32::<0xaa>(low, high))
    }
    #[inline(always)]
    fn add_halves(self, a: __m256i, b: __m256i) -> __m256i {
        op!(_mm256_add_epi32(a, b))
    }
    #[inline(always)]
    fn marked(self, a: __m256i) -> __m256i {
        op!(_mm256_cmpgt_epi64(_mm256_setzero_si256(), a))
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
    fn keep(self, a: __m256i, truth: __m256i) -> __m256i {
        op!(_mm256_and_si256(a, truth))
    }
    #[inline(always)]
    fn clear(self, a: __m256i, truth: __m256i) -> __m256i {
        op!(_mm256_andnot_si256(truth, a))
    }
    #[inline(always)]
    fn min_short(self, a: __m256i, b: __m256i) -> __m256i {
        op!(_mm256_min_epu32(a, b))
    }
    #[inline(always)]
    fn multiples(self, a: __m256i) -> __m256i {
        op!({
            let odd = _mm256_and_si256(a, _mm256_setr_epi64x(0, -1, 0, -1));
            let upper = _mm256_and_si256(a, _mm256_setr_epi64x(0, 0, -1, -1));
            _mm256_add_epi64(odd, _mm256_add_epi64(upper, upper))
        })
    }
    #[inline(always)]
    fn first(self, count: usize) -> __m256i {
        let start = 4 - count.min(4);
        match FIRST[start..].first_chunk::<4>() {
            // SAFETY: an array of four words is read.
            Some(words) => unsafe { _mm256_loadu_si256(words.as_ptr().cast()) },
            None => self.splat(0),
        }
    }
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
