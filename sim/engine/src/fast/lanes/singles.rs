//! Vectors of pixels in single precision: one fused multiply-add is a product of the kernel's words, its rounding and
//! its addition ([`splatline::blend`] says why), so that a vector holds twice as many pixels as one of 64-bit words.
//! Radial indices stay integers.

#![allow(unsafe_code)]

use super::Portable;
use super::packed::PackedOn;

/// Is a fused multiply-add one instruction wherever [`dispatch_vectors`](super::dispatch_vectors) runs a task?
/// Elsewhere (wasm) it is a call.
pub const HAS_FUSED_ADD: bool = cfg!(any(target_arch = "x86_64", target_arch = "aarch64"));

/// Pixels of a vector. Sixteen with AVX-512 lost: a run of random splats has ten, and looking up sixteen entries takes
/// twice the time of eight.
pub const SINGLES: usize = 8;

/// Pixels of each of two rows that share a vector.
pub const HALF: usize = SINGLES / 2;

/// Operations on pixels in single precision. Integers wrap; numbers are rounded to nearest, halves to even.
pub trait Singles: Copy {
    /// Integers of 32 bits.
    type Whole: Copy;
    /// Numbers of single precision.
    type Single: Copy;
    /// Truth values.
    type Choice: Copy;

    /// Equal integers.
    fn whole(self, value: i32) -> Self::Whole;
    /// The integers of the array.
    fn whole_load(self, from: &[i32; SINGLES]) -> Self::Whole;
    /// a + b.
    fn whole_add(self, a: Self::Whole, b: Self::Whole) -> Self::Whole;
    /// a - b.
    fn whole_sub(self, a: Self::Whole, b: Self::Whole) -> Self::Whole;
    /// a b.
    fn whole_mul(self, a: Self::Whole, b: Self::Whole) -> Self::Whole;
    /// a & b.
    fn whole_and(self, a: Self::Whole, b: Self::Whole) -> Self::Whole;
    /// The larger one, as signed numbers.
    fn whole_max(self, a: Self::Whole, b: Self::Whole) -> Self::Whole;
    /// Zeros come in; by less than 32.
    fn whole_shr(self, a: Self::Whole, by: Self::Whole) -> Self::Whole;
    /// a > b, as signed numbers.
    fn whole_greater(self, a: Self::Whole, b: Self::Whole) -> Self::Choice;
    /// Is the instruction that looks up all of a vector's words at once the quicker way?
    fn gathers(self) -> bool;
    /// The words of these numbers, modulo the table's length, where it is true, else 0.
    fn packed(
        self,
        table: &PackedOn<Self>,
        index: Self::Whole,
        choice: Self::Choice,
    ) -> Self::Whole;
    /// `a`, from 0 to below 2^15, times the lower 16 bits of `b` as a signed number.
    fn short_mul(self, a: Self::Whole, b: Self::Whole) -> Self::Whole;
    /// Integers below 2^23 added to `whole`, which is 2^23.
    fn single_of(self, a: Self::Whole, whole: Self::Single) -> Self::Single;
    /// Equal numbers.
    fn single(self, value: f32) -> Self::Single;
    /// The numbers from place `at` on; zeros if there are too few.
    fn single_read(self, from: &[f32], at: usize) -> Self::Single;
    /// Stores numbers from place `at` on; nothing if there is no room.
    fn single_write(self, to: &mut [f32], at: usize, value: Self::Single);
    /// The lower half of each of two words, in half of the integers.
    fn whole_two(self, words: &[i64; 2]) -> Self::Whole;
    /// Half of the numbers from a place on of each list; zeros if there are too few.
    fn two_read(self, from: [&[f32]; 2], at: [usize; 2]) -> Self::Single;
    /// Stores each half of the numbers from a place on of a list; nothing if there is no room.
    fn two_write(self, to: [&mut [f32]; 2], at: [usize; 2], value: Self::Single);
    /// a b + c, rounded once.
    fn fused_add(self, a: Self::Single, b: Self::Single, c: Self::Single) -> Self::Single;
    /// a - b.
    fn single_sub(self, a: Self::Single, b: Self::Single) -> Self::Single;
    /// The smaller one.
    fn single_min(self, a: Self::Single, b: Self::Single) -> Self::Single;
    /// The number, 0 where it is negative.
    fn at_least_zero(self, a: Self::Single) -> Self::Single;
    /// a < b.
    fn single_less(self, a: Self::Single, b: Self::Single) -> Self::Choice;
    /// The number where it is false, else 0.
    fn single_clear(self, a: Self::Single, choice: Self::Choice) -> Self::Single;
    /// The number, and its sign set where it is true.
    fn single_mark(self, a: Self::Single, choice: Self::Choice) -> Self::Single;
    /// A bit for every set sign.
    fn signs(self, a: Self::Single) -> u32;
    /// The first `count` pixels, of which a vector has no less.
    fn choose_first(self, count: usize) -> Self::Choice;
    /// Both.
    fn choose_both(self, a: Self::Choice, b: Self::Choice) -> Self::Choice;
    /// A bit for every pixel.
    fn chosen(self, choice: Self::Choice) -> u32;
}

fn zip<T: Copy, U>(a: [T; SINGLES], b: [T; SINGLES], f: impl Fn(T, T) -> U) -> [U; SINGLES] {
    std::array::from_fn(|k| f(a[k], b[k]))
}

impl Singles for Portable {
    type Whole = [i32; SINGLES];
    type Single = [f32; SINGLES];
    type Choice = [bool; SINGLES];

    #[cfg_attr(not(test), inline(always))]
    fn whole(self, value: i32) -> Self::Whole {
        [value; SINGLES]
    }
    #[cfg_attr(not(test), inline(always))]
    fn whole_load(self, from: &[i32; SINGLES]) -> Self::Whole {
        *from
    }
    #[cfg_attr(not(test), inline(always))]
    fn whole_add(self, a: Self::Whole, b: Self::Whole) -> Self::Whole {
        zip(a, b, i32::wrapping_add)
    }
    #[cfg_attr(not(test), inline(always))]
    fn whole_sub(self, a: Self::Whole, b: Self::Whole) -> Self::Whole {
        zip(a, b, i32::wrapping_sub)
    }
    #[cfg_attr(not(test), inline(always))]
    fn whole_mul(self, a: Self::Whole, b: Self::Whole) -> Self::Whole {
        zip(a, b, i32::wrapping_mul)
    }
    #[cfg_attr(not(test), inline(always))]
    fn whole_and(self, a: Self::Whole, b: Self::Whole) -> Self::Whole {
        zip(a, b, |a, b| a & b)
    }
    #[cfg_attr(not(test), inline(always))]
    fn whole_max(self, a: Self::Whole, b: Self::Whole) -> Self::Whole {
        zip(a, b, i32::max)
    }
    #[cfg_attr(not(test), inline(always))]
    fn whole_shr(self, a: Self::Whole, by: Self::Whole) -> Self::Whole {
        zip(a, by, |a, by| (a as u32).wrapping_shr(by as u32) as i32)
    }
    #[cfg_attr(not(test), inline(always))]
    fn short_mul(self, a: Self::Whole, b: Self::Whole) -> Self::Whole {
        zip(a, b, |a, b| a.wrapping_mul((b as i16).into()))
    }
    #[cfg_attr(not(test), inline(always))]
    fn whole_greater(self, a: Self::Whole, b: Self::Whole) -> Self::Choice {
        zip(a, b, |a, b| a > b)
    }
    #[cfg_attr(not(test), inline(always))]
    fn gathers(self) -> bool {
        false
    }
    #[cfg_attr(not(test), inline(always))]
    fn packed(
        self,
        table: &PackedOn<Self>,
        index: Self::Whole,
        choice: Self::Choice,
    ) -> Self::Whole {
        let word = |index: i32| table.words[index as usize & (table.words.len() - 1)] as i32;
        std::array::from_fn(|k| if choice[k] { word(index[k]) } else { 0 })
    }
    #[cfg_attr(not(test), inline(always))]
    fn single_of(self, a: Self::Whole, whole: Self::Single) -> Self::Single {
        std::array::from_fn(|k| f32::from_bits(a[k] as u32 | whole[k].to_bits()))
    }
    #[cfg_attr(not(test), inline(always))]
    fn single(self, value: f32) -> Self::Single {
        [value; SINGLES]
    }
    #[cfg_attr(not(test), inline(always))]
    fn single_read(self, from: &[f32], at: usize) -> Self::Single {
        let numbers = from.get(at..).and_then(|rest| rest.first_chunk());
        numbers.copied().unwrap_or_default()
    }
    #[cfg_attr(not(test), inline(always))]
    fn single_write(self, to: &mut [f32], at: usize, value: Self::Single) {
        if let Some(numbers) = to.get_mut(at..).and_then(|rest| rest.first_chunk_mut()) {
            *numbers = value;
        }
    }
    #[cfg_attr(not(test), inline(always))]
    fn whole_two(self, words: &[i64; 2]) -> Self::Whole {
        std::array::from_fn(|k| words[k / HALF] as i32)
    }
    #[cfg_attr(not(test), inline(always))]
    fn two_read(self, from: [&[f32]; 2], at: [usize; 2]) -> Self::Single {
        let number = |k: usize| from[k / HALF].get(at[k / HALF] + k % HALF).copied();
        std::array::from_fn(|k| number(k).unwrap_or_default())
    }
    #[cfg_attr(not(test), inline(always))]
    fn two_write(self, to: [&mut [f32]; 2], at: [usize; 2], value: Self::Single) {
        for ((to, at), half) in to.into_iter().zip(at).zip(value.as_chunks::<HALF>().0) {
            if let Some(numbers) = to.get_mut(at..).and_then(|rest| rest.first_chunk_mut()) {
                *numbers = *half;
            }
        }
    }
    #[cfg_attr(not(test), inline(always))]
    fn fused_add(self, a: Self::Single, b: Self::Single, c: Self::Single) -> Self::Single {
        std::array::from_fn(|k| a[k].mul_add(b[k], c[k]))
    }
    #[cfg_attr(not(test), inline(always))]
    fn single_sub(self, a: Self::Single, b: Self::Single) -> Self::Single {
        zip(a, b, |a, b| a - b)
    }
    #[cfg_attr(not(test), inline(always))]
    fn single_min(self, a: Self::Single, b: Self::Single) -> Self::Single {
        zip(a, b, f32::min)
    }
    #[cfg_attr(not(test), inline(always))]
    fn at_least_zero(self, a: Self::Single) -> Self::Single {
        a.map(|a| if a > 0.0 { a } else { 0.0 })
    }
    #[cfg_attr(not(test), inline(always))]
    fn single_less(self, a: Self::Single, b: Self::Single) -> Self::Choice {
        zip(a, b, |a, b| a < b)
    }
    #[cfg_attr(not(test), inline(always))]
    fn single_clear(self, a: Self::Single, choice: Self::Choice) -> Self::Single {
        std::array::from_fn(|k| if choice[k] { 0.0 } else { a[k] })
    }
    #[cfg_attr(not(test), inline(always))]
    fn single_mark(self, a: Self::Single, choice: Self::Choice) -> Self::Single {
        std::array::from_fn(|k| if choice[k] { -a[k].abs() } else { a[k] })
    }
    #[cfg_attr(not(test), inline(always))]
    fn signs(self, a: Self::Single) -> u32 {
        self.chosen(a.map(f32::is_sign_negative))
    }
    #[cfg_attr(not(test), inline(always))]
    fn choose_first(self, count: usize) -> Self::Choice {
        std::array::from_fn(|k| k < count)
    }
    #[cfg_attr(not(test), inline(always))]
    fn choose_both(self, a: Self::Choice, b: Self::Choice) -> Self::Choice {
        zip(a, b, |a, b| a && b)
    }
    #[cfg_attr(not(test), inline(always))]
    fn chosen(self, choice: Self::Choice) -> u32 {
        let bits = choice.iter().enumerate();
        bits.fold(0, |all, (k, choice)| all | u32::from(*choice) << k)
    }
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    //! SAFETY of all intrinsics on registers: `self` proves that the processor has the instruction. Loads and stores
    //! are of whole arrays.

    use super::super::avx2::Avx2;
    use super::super::packed::{PackedOn, x86 as packed};
    use super::{HALF, SINGLES, Singles};
    use std::arch::x86_64::*;

    /// Words of which an unaligned part starts with so many true ones.
    static FIRST: [i32; 3 * SINGLES] = {
        let mut words = [0; 3 * SINGLES];
        let mut k = 0;
        while k < SINGLES {
            words[k] = -1;
            k += 1;
        }
        words
    };

    impl Singles for Avx2 {
        type Whole = __m256i;
        type Single = __m256;
        type Choice = __m256;

        #[inline(always)]
        fn whole(self, value: i32) -> __m256i {
            op!(_mm256_set1_epi32(value))
        }
        #[inline(always)]
        fn whole_load(self, from: &[i32; SINGLES]) -> __m256i {
            // SAFETY: an array of eight words is read.
            unsafe { _mm256_loadu_si256(from.as_ptr().cast()) }
        }
        #[inline(always)]
        fn whole_add(self, a: __m256i, b: __m256i) -> __m256i {
            op!(_mm256_add_epi32(a, b))
        }
        #[inline(always)]
        fn whole_sub(self, a: __m256i, b: __m256i) -> __m256i {
            op!(_mm256_sub_epi32(a, b))
        }
        #[inline(always)]
        fn whole_mul(self, a: __m256i, b: __m256i) -> __m256i {
            op!(_mm256_mullo_epi32(a, b))
        }
        #[inline(always)]
        fn whole_and(self, a: __m256i, b: __m256i) -> __m256i {
            op!(_mm256_and_si256(a, b))
        }
        #[inline(always)]
        fn whole_max(self, a: __m256i, b: __m256i) -> __m256i {
            op!(_mm256_max_epi32(a, b))
        }
        #[inline(always)]
        fn whole_shr(self, a: __m256i, by: __m256i) -> __m256i {
            op!(_mm256_srlv_epi32(a, by))
        }
        #[inline(always)]
        fn short_mul(self, a: __m256i, b: __m256i) -> __m256i {
            op!(_mm256_madd_epi16(a, b))
        }
        #[inline(always)]
        fn whole_greater(self, a: __m256i, b: __m256i) -> __m256 {
            op!(_mm256_castsi256_ps(_mm256_cmpgt_epi32(a, b)))
        }
        #[inline(always)]
        fn gathers(self) -> bool {
            packed::gathers_are_quicker(self)
        }
        #[inline(always)]
        fn packed(self, table: &PackedOn<Self>, index: __m256i, choice: __m256) -> __m256i {
            if table.gathers {
                packed::gather(self, table, index, choice)
            } else {
                packed::load(self, table, index, choice)
            }
        }
        #[inline(always)]
        fn single_of(self, a: __m256i, whole: __m256) -> __m256 {
            op!(_mm256_castsi256_ps(_mm256_add_epi32(
                a,
                _mm256_castps_si256(whole)
            )))
        }
        #[inline(always)]
        fn single(self, value: f32) -> __m256 {
            op!(_mm256_set1_ps(value))
        }
        #[inline(always)]
        fn single_read(self, from: &[f32], at: usize) -> __m256 {
            match from.get(at..).and_then(|rest| rest.first_chunk::<8>()) {
                // SAFETY: an array of eight numbers is read.
                Some(numbers) => unsafe { _mm256_loadu_ps(numbers.as_ptr()) },
                None => self.single(0.0),
            }
        }
        #[inline(always)]
        fn single_write(self, to: &mut [f32], at: usize, value: __m256) {
            let place = to.get_mut(at..);
            if let Some(numbers) = place.and_then(|rest| rest.first_chunk_mut::<8>()) {
                // SAFETY: an array of eight numbers is written.
                unsafe { _mm256_storeu_ps(numbers.as_mut_ptr(), value) }
            }
        }
        #[inline(always)]
        fn whole_two(self, words: &[i64; 2]) -> __m256i {
            // SAFETY: an array of two words is read.
            let words = unsafe { _mm_loadu_si128(words.as_ptr().cast()) };
            op!({
                let places = _mm256_setr_epi32(0, 0, 0, 0, 2, 2, 2, 2);
                _mm256_permutevar8x32_epi32(_mm256_castsi128_si256(words), places)
            })
        }
        #[inline(always)]
        fn two_read(self, [above, below]: [&[f32]; 2], [x, y]: [usize; 2]) -> __m256 {
            let above = above.get(x..).and_then(|rest| rest.first_chunk::<HALF>());
            let below = below.get(y..).and_then(|rest| rest.first_chunk::<HALF>());
            match (above, below) {
                // SAFETY: two arrays of four numbers are read.
                (Some(above), Some(below)) => unsafe {
                    _mm256_loadu2_m128(below.as_ptr(), above.as_ptr())
                },
                _ => self.single(0.0),
            }
        }
        #[inline(always)]
        fn two_write(self, [above, below]: [&mut [f32]; 2], [x, y]: [usize; 2], value: __m256) {
            let above = above
                .get_mut(x..)
                .and_then(|rest| rest.first_chunk_mut::<HALF>());
            let below = below
                .get_mut(y..)
                .and_then(|rest| rest.first_chunk_mut::<HALF>());
            if let (Some(above), Some(below)) = (above, below) {
                // SAFETY: two arrays of four numbers are written.
                unsafe { _mm256_storeu2_m128(below.as_mut_ptr(), above.as_mut_ptr(), value) }
            }
        }
        #[inline(always)]
        fn fused_add(self, a: __m256, b: __m256, c: __m256) -> __m256 {
            op!(_mm256_fmadd_ps(a, b, c))
        }
        #[inline(always)]
        fn single_sub(self, a: __m256, b: __m256) -> __m256 {
            op!(_mm256_sub_ps(a, b))
        }
        #[inline(always)]
        fn single_min(self, a: __m256, b: __m256) -> __m256 {
            op!(_mm256_min_ps(a, b))
        }
        #[inline(always)]
        fn at_least_zero(self, a: __m256) -> __m256 {
            op!(_mm256_max_ps(a, _mm256_setzero_ps()))
        }
        #[inline(always)]
        fn single_less(self, a: __m256, b: __m256) -> __m256 {
            op!(_mm256_cmp_ps::<_CMP_LT_OQ>(a, b))
        }
        #[inline(always)]
        fn single_clear(self, a: __m256, choice: __m256) -> __m256 {
            op!(_mm256_andnot_ps(choice, a))
        }
        #[inline(always)]
        fn choose_both(self, a: __m256, b: __m256) -> __m256 {
            op!(_mm256_and_ps(a, b))
        }
        #[inline(always)]
        fn single_mark(self, a: __m256, choice: __m256) -> __m256 {
            op!({
                let sign = _mm256_slli_epi32::<31>(_mm256_castps_si256(choice));
                _mm256_or_ps(a, _mm256_castsi256_ps(sign))
            })
        }
        #[inline(always)]
        fn signs(self, a: __m256) -> u32 {
            op!(_mm256_movemask_ps(a)) as u32
        }
        #[inline(always)]
        fn chosen(self, choice: __m256) -> u32 {
            self.signs(choice)
        }
        #[inline(always)]
        fn choose_first(self, count: usize) -> __m256 {
            let start = SINGLES.wrapping_sub(count) % (2 * SINGLES);
            match FIRST[start..].first_chunk::<8>() {
                // SAFETY: an array of eight words is read.
                Some(words) => unsafe { _mm256_loadu_ps(words.as_ptr().cast()) },
                None => self.single(0.0),
            }
        }
    }
}
