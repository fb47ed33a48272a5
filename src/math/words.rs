//! 64-bit numbers by 32-bit words: what a small processor does in a few instructions where shifts of 64 bits are library calls.
//!
//! Every function equals its plain 64-bit form for all inputs (tested); the plain form stands in the test.

/// Leading zeros of a word; 32 for 0.
///
/// Armv6-M (the Arm profile without compare-and-swap) and RV32 have no such instruction: some 20 executed instructions instead of
/// the library's 36 or the compiler's 40. In line it costs Armv6-M more in registers than the call, RV32 less.
#[cfg(any(
    target_arch = "riscv32",
    all(target_arch = "arm", not(target_has_atomic = "32"))
))]
#[cfg_attr(target_arch = "arm", inline(never))]
#[cfg_attr(target_arch = "riscv32", inline(always))]
pub const fn leading_zeros(value: u32) -> u32 {
    leading_zeros_by_halving(value)
}

/// Leading zeros of a word; 32 for 0.
#[cfg(not(any(
    target_arch = "riscv32",
    all(target_arch = "arm", not(target_has_atomic = "32"))
)))]
#[inline(always)]
pub const fn leading_zeros(value: u32) -> u32 {
    value.leading_zeros()
}

#[cfg_attr(
    not(any(
        test,
        target_arch = "riscv32",
        all(target_arch = "arm", not(target_has_atomic = "32"))
    )),
    allow(dead_code)
)]
#[inline(always)]
const fn leading_zeros_by_halving(value: u32) -> u32 {
    let mut rest = value;
    let mut zeros = 2;
    if rest >> 16 == 0 {
        zeros += 16;
        rest <<= 16;
    }
    if rest >> 24 == 0 {
        zeros += 8;
        rest <<= 8;
    }
    if rest >> 28 == 0 {
        zeros += 4;
        rest <<= 4;
    }
    if rest >> 30 == 0 {
        zeros += 2;
        rest <<= 2;
    }
    let top = rest >> 30;
    zeros - if top > 2 { 2 } else { top }
}

/// Leading zeros of two words; 64 for 0. One count, not one per word.
#[inline(always)]
pub const fn leading_zeros_wide(value: u64) -> u32 {
    let high = (value >> 32) as u32;
    let (word, above) = if high == 0 {
        (value as u32, 32)
    } else {
        (high, 0)
    };
    above + leading_zeros(word)
}

/// `value * 2^zeros` as high and low word; the bits that leave the number are lost. `zeros < 64`.
#[inline(always)]
pub const fn shifted_up(value: u64, zeros: u32) -> (u32, u32) {
    let (high, low) = ((value >> 32) as u32, value as u32);
    if zeros >= 32 {
        return (low.wrapping_shl(zeros), 0);
    }
    // Two shifts, because one by 32 is not defined.
    let carried = (low >> 1).wrapping_shr(31 - zeros);
    (high.wrapping_shl(zeros) | carried, low.wrapping_shl(zeros))
}

/// `value * 2^-shift`, rounded to nearest, halves up. 0 from 64 on; `shift > 0`.
#[cfg(any(test, target_pointer_width = "32"))]
#[inline(always)]
pub const fn rounded_down(value: i64, shift: u32) -> i64 {
    // Half a unit is added after the shift to half units, where it is 1.
    let (high, low) = ((value >> 32) as i32, value as u32);
    let by = shift - 1;
    let halves = match by {
        0..=31 => {
            let carried = ((high as u32) << 1).wrapping_shl(31 - by);
            joined((high >> by) as u32, low >> by | carried)
        }
        32..=62 => joined((high >> 31) as u32, (high >> (by - 32)) as u32),
        _ => return 0,
    } as i64;
    halves.wrapping_add(1) >> 1
}

/// Product of two words.
#[cfg(not(all(target_arch = "arm", not(target_has_atomic = "32"))))]
#[inline(always)]
pub const fn product(a: i32, b: i32) -> i64 {
    a as i64 * b as i64
}

/// Product of two words, where the processor multiplies only 32 bits to 32.
#[cfg(all(target_arch = "arm", not(target_has_atomic = "32")))]
#[inline(never)]
pub const fn product(a: i32, b: i32) -> i64 {
    product_by_halves(a, b)
}

#[cfg_attr(
    not(any(test, all(target_arch = "arm", not(target_has_atomic = "32")))),
    allow(dead_code)
)]
#[inline(always)]
const fn product_by_halves(a: i32, b: i32) -> i64 {
    const SHORT: i32 = 1 << 15;
    if (a.wrapping_add(SHORT) as u32 | b.wrapping_add(SHORT) as u32) >> 16 == 0 {
        return a.wrapping_mul(b) as i64;
    }
    let (a_low, a_high) = (a & 0xffff, a >> 16);
    let (b_low, b_high) = (b & 0xffff, b >> 16);
    let low = a_low.wrapping_mul(b_low) as u32;
    let middle = a_high.wrapping_mul(b_low).wrapping_add((low >> 16) as i32);
    let other = a_low.wrapping_mul(b_high).wrapping_add(middle & 0xffff);
    let high = a_high
        .wrapping_mul(b_high)
        .wrapping_add(middle >> 16)
        .wrapping_add(other >> 16);
    joined(high as u32, (other as u32) << 16 | low & 0xffff) as i64
}

/// Two words as one number.
#[inline(always)]
pub const fn joined(high: u32, low: u32) -> u64 {
    (high as u64) << 32 | low as u64
}

/// `value * 2^-shift` in a word, rounded to nearest, halves up; the low word of the result for negative shifts. Any `shift`.
#[inline(always)]
pub const fn shift_word(value: i32, shift: i32) -> i32 {
    match shift {
        1..=31 => (value >> shift) + ((value >> (shift - 1)) & 1),
        -31..=0 => value << -shift,
        _ => 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{shift_left, shift_round};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn counts_are_the_processors(value: u64, drop in 0u32..64) {
            let value = value >> drop;
            prop_assert_eq!(leading_zeros_by_halving(value as u32), (value as u32).leading_zeros());
            prop_assert_eq!(leading_zeros_wide(value), value.leading_zeros());
        }

        #[test]
        fn shifts_are_those_of_64_bits(value: u64, zeros in 0u32..64) {
            let (high, low) = shifted_up(value, zeros);
            prop_assert_eq!(joined(high, low), value << zeros);
        }

        #[test]
        fn rounding_is_that_of_64_bits(value: i64, drop in 1u32..64, shift in 1u32..100) {
            let value = value >> drop;
            prop_assert_eq!(rounded_down(value, shift), shift_round(value, shift));
        }

        #[test]
        fn products_are_those_of_64_bits(a: i32, b: i32, drop in 0u32..32) {
            let (a, b) = (a, b >> drop);
            for (a, b) in [(a, b), (b, a), (a >> drop, b), (i32::MIN, b), (i32::MIN, i32::MIN), (i32::MAX, b)] {
                prop_assert_eq!(product_by_halves(a, b), i64::from(a) * i64::from(b));
            }
        }

        #[test]
        fn a_word_shifts_like_a_wide_number(value: i32, shift in -31i32..100) {
            let wide = if shift > 0 { shift_round(value.into(), shift as u32) } else { shift_left(value.into(), -shift as u32) };
            prop_assert_eq!(shift_word(value, shift), wide as i32);
        }
    }

    #[test]
    fn ends() {
        for value in [0, 1, 2, 3, u32::MAX, 1 << 31] {
            assert_eq!(leading_zeros_by_halving(value), value.leading_zeros());
        }
        for value in [i32::MIN, -1, 0, 1, i32::MAX] {
            for shift in 1..70 {
                assert_eq!(
                    shift_word(value, shift),
                    shift_round(value.into(), shift as u32) as i32
                );
            }
        }
    }
}
