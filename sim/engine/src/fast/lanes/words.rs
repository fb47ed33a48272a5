//! Vectors of 64-bit words for pixels that single precision does not hold: a word for each pixel, so that a product of
//! 32 bits by 32 needs neither taking apart nor interleaving.
//!
//! Shifts and constants are words in memory and not of the instructions: one compiled copy draws every design.

#![allow(unsafe_code)]

use super::wide::Words;
use super::{Portable, Wide};

/// A falling table's intervals: an entry in the upper half of a word, its fall to the next one in the lower. Their
/// number is a power of two.
#[derive(Clone, Debug)]
pub struct Falls {
    intervals: Box<[u64]>,
    /// The last one's number, for every word of a vector.
    #[cfg_attr(
        not(target_arch = "x86_64"),
        allow(dead_code, reason = "arrays go by the length")
    )]
    last: [i64; 8],
}

impl Falls {
    /// The intervals between these entries; `None` if they rise anywhere.
    pub fn new(entries: &[u32]) -> Option<Self> {
        let interval = |pair: &[u32]| {
            let fall = pair[0].checked_sub(pair[1])?;
            Some(u64::from(pair[0]) << 32 | u64::from(fall))
        };
        let mut intervals: Vec<u64> = entries.windows(2).map(interval).collect::<Option<_>>()?;
        intervals.resize(intervals.len().next_power_of_two(), 0);
        Some(Falls {
            last: [intervals.len() as i64 - 1; 8],
            intervals: intervals.into(),
        })
    }

    /// The interval of this number, modulo the table's length.
    #[inline(always)]
    fn at(&self, index: i64) -> i64 {
        self.intervals[index as usize & (self.intervals.len() - 1)] as i64
    }
}

/// Operations on pixels of one word each.
pub trait PixelWords: Wide {
    /// The words from place `at` on; zeros if there are too few.
    fn read(self, from: &[u64], at: usize) -> Self::Word;
    /// Stores words from place `at` on; nothing if there is no room.
    fn write(self, to: &mut [u64], at: usize, value: Self::Word);
    /// Words whose most significant bit is set.
    fn marked(self, a: Self::Word) -> Self::Truth;
    /// The first `count` words.
    fn first(self, count: usize) -> Self::Truth;
    /// Both.
    fn both(self, a: Self::Truth, b: Self::Truth) -> Self::Truth;
    /// a and not b.
    fn except(self, a: Self::Truth, b: Self::Truth) -> Self::Truth;
    /// a where it is true, else 0.
    fn keep(self, a: Self::Word, truth: Self::Truth) -> Self::Word;
    /// a where it is false, else 0.
    fn clear(self, a: Self::Word, truth: Self::Truth) -> Self::Word;
    /// The smaller one of words below 2^32.
    fn min_short(self, a: Self::Word, b: Self::Word) -> Self::Word;
    /// 0, a, 2 a, 3 a and so on, of a vector of equal words.
    fn multiples(self, a: Self::Word) -> Self::Word;
    /// The intervals of these numbers, modulo the table's length.
    fn intervals(self, table: &Falls, index: Self::Word) -> Self::Word;
}

impl PixelWords for Portable {
    #[cfg_attr(not(test), inline(always))]
    fn read(self, from: &[u64], at: usize) -> Words {
        let words = from.get(at..).and_then(|rest| rest.first_chunk::<8>());
        words.map_or([0; 8], |words| words.map(|word| word as i64))
    }
    #[cfg_attr(not(test), inline(always))]
    fn write(self, to: &mut [u64], at: usize, value: Words) {
        if let Some(words) = to
            .get_mut(at..)
            .and_then(|rest| rest.first_chunk_mut::<8>())
        {
            *words = value.map(|word| word as u64);
        }
    }
    #[cfg_attr(not(test), inline(always))]
    fn marked(self, a: Words) -> [bool; 8] {
        a.map(|a| a < 0)
    }
    #[cfg_attr(not(test), inline(always))]
    fn first(self, count: usize) -> [bool; 8] {
        std::array::from_fn(|k| k < count)
    }
    #[cfg_attr(not(test), inline(always))]
    fn both(self, a: [bool; 8], b: [bool; 8]) -> [bool; 8] {
        std::array::from_fn(|k| a[k] && b[k])
    }
    #[cfg_attr(not(test), inline(always))]
    fn except(self, a: [bool; 8], b: [bool; 8]) -> [bool; 8] {
        std::array::from_fn(|k| a[k] && !b[k])
    }
    #[cfg_attr(not(test), inline(always))]
    fn keep(self, a: Words, truth: [bool; 8]) -> Words {
        std::array::from_fn(|k| if truth[k] { a[k] } else { 0 })
    }
    #[cfg_attr(not(test), inline(always))]
    fn clear(self, a: Words, truth: [bool; 8]) -> Words {
        std::array::from_fn(|k| if truth[k] { 0 } else { a[k] })
    }
    #[cfg_attr(not(test), inline(always))]
    fn min_short(self, a: Words, b: Words) -> Words {
        std::array::from_fn(|k| a[k].min(b[k]))
    }
    #[cfg_attr(not(test), inline(always))]
    fn multiples(self, a: Words) -> Words {
        std::array::from_fn(|k| a[k].wrapping_mul(k as i64))
    }
    #[cfg_attr(not(test), inline(always))]
    fn intervals(self, table: &Falls, index: Words) -> Words {
        index.map(|index| table.at(index))
    }
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    //! SAFETY of all intrinsics on registers: `self` proves that the processor has the instruction. Loads and stores
    //! are of whole arrays, look-ups of numbers that have been brought into the table.

    use super::super::Wide;
    use super::super::avx2::Avx2;
    use super::super::avx512::Avx512;
    use super::super::wide::x86::{four_words, halves};
    use super::{Falls, PixelWords};
    use std::arch::x86_64::*;

    /// Words of which an unaligned part starts with so many true ones.
    static FIRST: [i64; 8] = [-1, -1, -1, -1, 0, 0, 0, 0];

    impl PixelWords for Avx2 {
        #[inline(always)]
        fn read(self, from: &[u64], at: usize) -> __m256i {
            match from.get(at..).and_then(|rest| rest.first_chunk::<4>()) {
                // SAFETY: an array of four words is read.
                Some(words) => unsafe { _mm256_loadu_si256(words.as_ptr().cast()) },
                None => self.wide_splat(0),
            }
        }
        #[inline(always)]
        fn write(self, to: &mut [u64], at: usize, value: __m256i) {
            if let Some(words) = to
                .get_mut(at..)
                .and_then(|rest| rest.first_chunk_mut::<4>())
            {
                // SAFETY: an array of four words is written.
                unsafe { _mm256_storeu_si256(words.as_mut_ptr().cast(), value) }
            }
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
                None => self.wide_splat(0),
            }
        }
        #[inline(always)]
        fn intervals(self, table: &Falls, index: __m256i) -> __m256i {
            let index = self.wide_and(index, self.wide_load(&table.last));
            let words = table.intervals.as_ptr();
            // SAFETY: the length is a power of two, so that every masked number lies in the table.
            four_words(self, index, |place| unsafe { *words.add(place) })
        }
    }

    impl PixelWords for Avx512 {
        #[inline(always)]
        fn read(self, from: &[u64], at: usize) -> __m512i {
            match from.get(at..).and_then(|rest| rest.first_chunk::<8>()) {
                // SAFETY: an array of eight words is read.
                Some(words) => unsafe { _mm512_loadu_si512(words.as_ptr().cast()) },
                None => self.wide_splat(0),
            }
        }
        #[inline(always)]
        fn write(self, to: &mut [u64], at: usize, value: __m512i) {
            if let Some(words) = to
                .get_mut(at..)
                .and_then(|rest| rest.first_chunk_mut::<8>())
            {
                // SAFETY: an array of eight words is written.
                unsafe { _mm512_storeu_si512(words.as_mut_ptr().cast(), value) }
            }
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
        fn intervals(self, table: &Falls, index: __m512i) -> __m512i {
            let index = self.wide_and(index, self.wide_load(&table.last));
            let words = table.intervals.as_ptr();
            let [low, high] = halves(self, index);
            // SAFETY: the length is a power of two, so that every masked number lies in the table.
            let low = four_words(self.avx2(), low, |place| unsafe { *words.add(place) });
            // SAFETY: as above.
            let high = four_words(self.avx2(), high, |place| unsafe { *words.add(place) });
            op!(_mm512_inserti64x4::<1>(_mm512_castsi256_si512(low), high))
        }
    }
}
