//! Tables of 32-bit words that a vector of pixels looks up: by one instruction, or word by word.
//!
//! Which way is quicker is measured once, since processors differ: a gather of eight words took 11 cycles on one and 23
//! on another, a Skylake, probably by the remedy of its microcode against Downfall; eight loads take 8 there. Both give
//! the same words.

#![allow(unsafe_code)]

use super::singles::Singles;

/// A table of 32-bit words whose length is a power of two.
#[derive(Clone, Debug)]
pub struct PackedWords(Box<[u32]>);

/// The same on vectors, with the last one's number.
#[cfg_attr(
    not(target_arch = "x86_64"),
    allow(dead_code, reason = "arrays go by the length")
)]
#[derive(Clone, Copy)]
pub struct PackedOn<'a, L: Singles> {
    pub(super) words: &'a [u32],
    pub(super) last: L::Whole,
    /// Is it looked up by gathers?
    pub(super) gathers: bool,
}

impl PackedWords {
    /// These words, and zeros up to a power of two.
    pub fn new(mut words: Vec<u32>) -> Self {
        words.resize(words.len().next_power_of_two(), 0);
        PackedWords(words.into())
    }

    /// The table on these vectors.
    #[inline(always)]
    pub fn on<L: Singles>(&self, lanes: L) -> PackedOn<'_, L> {
        PackedOn {
            words: &self.0,
            last: lanes.whole(self.0.len() as i32 - 1),
            gathers: lanes.gathers(),
        }
    }
}

#[cfg(target_arch = "x86_64")]
pub(super) mod x86 {
    //! SAFETY of all look-ups: the table's length is a power of two, so that every masked number lies in it.

    use super::super::avx2::Avx2;
    use super::{PackedOn, PackedWords};
    use std::arch::x86_64::*;
    use std::hint::black_box;
    use std::sync::OnceLock;
    use std::time::{Duration, Instant};

    /// Look-ups of a measurement, and how often it is repeated: some forty microseconds in all.
    const LOOKUPS: i32 = 512;
    const ROUNDS: usize = 5;

    /// By one instruction.
    #[inline(always)]
    pub fn gather(_: Avx2, table: &PackedOn<Avx2>, index: __m256i, choice: __m256) -> __m256i {
        // SAFETY: see above.
        unsafe {
            let index = _mm256_and_si256(index, table.last);
            let choice = _mm256_castps_si256(choice);
            let words = table.words.as_ptr().cast();
            _mm256_mask_i32gather_epi32::<4>(_mm256_setzero_si256(), words, index, choice)
        }
    }

    /// Word by word.
    #[inline(always)]
    pub fn load(_: Avx2, table: &PackedOn<Avx2>, index: __m256i, choice: __m256) -> __m256i {
        // SAFETY: see above.
        unsafe {
            let index = _mm256_and_si256(index, table.last);
            let words = table.words.as_ptr().cast::<i32>();
            let four = |index: __m128i| {
                let pairs = [_mm_cvtsi128_si64(index), _mm_extract_epi64::<1>(index)];
                let [a, c] = pairs.map(|pair| *words.add(pair as u32 as usize));
                let [b, d] = pairs.map(|pair| *words.add((pair as u64 >> 32) as usize));
                _mm_setr_epi32(a, b, c, d)
            };
            let low = four(_mm256_castsi256_si128(index));
            let high = four(_mm256_extracti128_si256::<1>(index));
            let all = _mm256_inserti128_si256::<1>(_mm256_castsi128_si256(low), high);
            _mm256_and_si256(all, _mm256_castps_si256(choice))
        }
    }

    /// Is [`gather`] quicker than [`load`] on this processor?
    pub fn gathers_are_quicker(lanes: Avx2) -> bool {
        static QUICKER: OnceLock<bool> = OnceLock::new();
        *QUICKER.get_or_init(|| {
            // SAFETY: `lanes` proves that the processor has the instructions.
            unsafe { time(lanes, true) < time(lanes, false) }
        })
    }

    /// The least time that so many look-ups take.
    #[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt,fma")]
    fn time(lanes: Avx2, gathers: bool) -> Duration {
        let words = PackedWords((0..1024).collect());
        let table = PackedOn::<Avx2> {
            words: &words.0,
            last: _mm256_set1_epi32(1023),
            gathers,
        };
        let all = _mm256_castsi256_ps(_mm256_set1_epi32(-1));
        let apart = _mm256_setr_epi32(0, 1, 2, 3, 5, 8, 13, 21);
        let mut least = Duration::MAX;
        for _ in 0..ROUNDS {
            let started = Instant::now();
            let mut sum = _mm256_setzero_si256();
            for number in 0..LOOKUPS {
                let index = _mm256_add_epi32(apart, _mm256_set1_epi32(black_box(number)));
                let found = if gathers {
                    gather(lanes, &table, index, all)
                } else {
                    load(lanes, &table, index, all)
                };
                sum = _mm256_add_epi32(sum, found);
            }
            black_box(sum);
            least = least.min(started.elapsed());
        }
        least
    }

    #[cfg(test)]
    mod tests {
        use super::*;

        #[test]
        fn both_ways_find_the_same_words() {
            let Some(lanes) = Avx2::detect() else { return };
            let words = PackedWords::new(
                (0..1000u32)
                    .map(|word| word.wrapping_mul(0x9e37_79b9))
                    .collect(),
            );
            let table = words.on(lanes);
            for number in 0..5000i32 {
                // SAFETY: `lanes` proves that the processor has the instructions.
                unsafe {
                    let number = _mm256_set1_epi32(number.wrapping_mul(0x3c6e_f35f));
                    let index =
                        _mm256_mullo_epi32(number, _mm256_setr_epi32(1, 2, 3, 5, 7, 9, 11, 13));
                    let choice = _mm256_castsi256_ps(_mm256_slli_epi32::<3>(index));
                    let choice = _mm256_cmp_ps::<_CMP_LT_OQ>(choice, _mm256_setzero_ps());
                    let ways = [gather, load].map(|way| way(lanes, &table, index, choice));
                    let same = _mm256_movemask_epi8(_mm256_cmpeq_epi32(ways[0], ways[1]));
                    assert_eq!(same, -1);
                }
            }
        }
    }
}
