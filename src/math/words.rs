//! 64-bit numbers by 32-bit words: what a small processor does in a few instructions where shifts of 64 bits are
//! library calls.
//!
//! Every function exists twice, plainly in 64 bits and by words, with the same bits for all inputs (tested); the
//! target's width chooses.

#[cfg(target_pointer_width = "32")]
pub use by_words::{
    Digits, leading_zeros, leading_zeros_below, leading_zeros_wide, product, rounded_down,
    shifted_up, signed_normal,
};
#[cfg(not(target_pointer_width = "32"))]
pub use plain::{
    Digits, leading_zeros, leading_zeros_below, leading_zeros_wide, product, rounded_down,
    shifted_up, signed_normal,
};

/// `value * 2^-shift` in a word, rounded to nearest, halves up; the low word of the result for negative shifts. Any
/// `shift`.
#[inline(always)]
pub const fn shift_word(value: i32, shift: i32) -> i32 {
    match shift {
        1..=31 => (value >> shift) + ((value >> (shift - 1)) & 1),
        -31..=0 => value << -shift,
        _ => 0,
    }
}

#[cfg(any(test, not(target_pointer_width = "32")))]
mod plain {
    /// Leading zeros of a word; 32 for 0.
    #[inline(always)]
    pub const fn leading_zeros(value: u32) -> u32 {
        value.leading_zeros()
    }

    /// Leading zeros of a word that is likely to have its leading bit among the eight below `2^end` (8 to 32), and none
    /// above.
    #[inline(always)]
    pub const fn leading_zeros_below(value: u32, _end: u32) -> u32 {
        value.leading_zeros()
    }

    /// Leading zeros of two words; 64 for 0.
    #[inline(always)]
    pub const fn leading_zeros_wide(value: u64) -> u32 {
        value.leading_zeros()
    }

    /// `value * 2^zeros` modulo 2^64. `zeros < 64`.
    #[inline(always)]
    pub const fn shifted_up(value: u64, zeros: u32) -> u64 {
        value.wrapping_shl(zeros)
    }

    /// The upper word of a number moved up until its first bit unlike the sign is bit 62, the bit after that word, and
    /// the number's leading zeros (ones, if negative): 1 to 64.
    #[inline(always)]
    pub const fn signed_normal(value: i64) -> (i32, u32, u32) {
        let zeros = (value ^ value >> 63).leading_zeros();
        let normal = value.wrapping_shl(zeros.wrapping_sub(1));
        ((normal >> 32) as i32, (normal as u32) >> 31, zeros)
    }

    /// `value * 2^-shift`, rounded to nearest, halves up; `shift > 0`.
    #[inline(always)]
    pub const fn rounded_down(value: i64, shift: u32) -> i64 {
        // Half a unit is added where it is 1: before the shift a saturated value would wrap.
        match shift {
            1..=63 => (value >> (shift - 1)).wrapping_add(1) >> 1,
            _ => 0,
        }
    }

    /// Product of two words.
    #[inline(always)]
    pub const fn product(a: i32, b: i32) -> i64 {
        a as i64 * b as i64
    }

    /// A factor of many products.
    #[derive(Clone, Copy)]
    pub struct Digits(i32);

    impl Digits {
        /// `factor` of at most `bits + 1` bits.
        #[inline(always)]
        pub const fn new(factor: i32, _bits: u32) -> Digits {
            Digits(factor)
        }

        /// `value * factor * 2^-drop` rounded down, for values of at most `bits` bits.
        #[inline(always)]
        pub const fn product(self, value: i32, _bits: u32, drop: u32) -> i64 {
            product(value, self.0) >> drop
        }
    }
}

/// The same by words. Armv6-M is the Arm profile without compare-and-swap: it neither counts zeros nor multiplies to 64
/// bits.
#[cfg(any(test, target_pointer_width = "32"))]
mod by_words {
    /// Two words as one number.
    #[inline(always)]
    const fn joined(high: u32, low: u32) -> u64 {
        (high as u64) << 32 | low as u64
    }

    const ARMV6M: bool = cfg!(all(target_arch = "arm", not(target_has_atomic = "32")));

    /// Leading zeros of a word; 32 for 0.
    #[inline(always)]
    pub const fn leading_zeros(value: u32) -> u32 {
        if ARMV6M {
            called_zeros(value)
        } else if cfg!(target_arch = "riscv32") {
            zeros_by_halving(value)
        } else {
            value.leading_zeros()
        }
    }

    /// In line it would cost Armv6-M more in registers than the call costs.
    #[inline(never)]
    const fn called_zeros(value: u32) -> u32 {
        zeros_by_table(value)
    }

    /// Leading zeros of a byte.
    static BYTE_ZEROS: [u8; 256] = {
        let mut zeros = [0; 256];
        let mut byte = 0;
        while byte < 256 {
            zeros[byte] = (byte as u8).leading_zeros() as u8;
            byte += 1;
        }
        zeros
    };

    /// Half the instructions of [`zeros_by_halving`], where a branch costs little.
    #[inline(always)]
    pub const fn zeros_by_table(value: u32) -> u32 {
        if value >> 16 != 0 {
            if value >> 24 != 0 {
                byte_zeros(value >> 24)
            } else {
                8 + byte_zeros(value >> 16)
            }
        } else if value >> 8 != 0 {
            16 + byte_zeros(value >> 8)
        } else {
            24 + byte_zeros(value)
        }
    }

    #[inline(always)]
    const fn byte_zeros(byte: u32) -> u32 {
        BYTE_ZEROS[(byte & 0xff) as usize] as u32
    }

    /// Some 20 executed instructions instead of the library's 36 (Armv6-M) or the compiler's 40 (RV32).
    #[inline(always)]
    pub const fn zeros_by_halving(value: u32) -> u32 {
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

    /// Leading zeros of a word that is likely to have its leading bit among the eight below `2^end` (8 to 32), and none
    /// above.
    #[inline(always)]
    pub const fn leading_zeros_below(value: u32, end: u32) -> u32 {
        if !ARMV6M && !cfg!(target_arch = "riscv32") {
            return value.leading_zeros();
        }
        zeros_by_byte(value, end)
    }

    /// The same by the table where the leading bit is among those eight.
    #[inline(always)]
    pub const fn zeros_by_byte(value: u32, end: u32) -> u32 {
        match value.wrapping_shr(end.wrapping_sub(8)) {
            byte @ 1..=255 => 32u32.wrapping_sub(end) + byte_zeros(byte),
            _ => leading_zeros(value),
        }
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

    /// `value * 2^zeros` modulo 2^64. `zeros < 64`.
    #[inline(always)]
    pub const fn shifted_up(value: u64, zeros: u32) -> u64 {
        let (high, low) = ((value >> 32) as u32, value as u32);
        if zeros >= 32 {
            return joined(low.wrapping_shl(zeros), 0);
        }
        // Two shifts, because one by 32 is not defined.
        let carried = (low >> 1).wrapping_shr(31 - zeros);
        joined(high.wrapping_shl(zeros) | carried, low.wrapping_shl(zeros))
    }

    /// The upper word of a number moved up until its first bit unlike the sign is bit 62, the bit after that word, and
    /// the number's leading zeros (ones, if negative): 1 to 64.
    #[inline(always)]
    pub const fn signed_normal(value: i64) -> (i32, u32, u32) {
        let sign = value >> 63;
        let zeros = leading_zeros_wide((value ^ sign) as u64);
        let normal = shifted_up(value as u64, zeros - 1);
        ((normal >> 32) as i32, normal as u32 >> 31, zeros)
    }

    /// `value * 2^-shift`, rounded to nearest, halves up. 0 from 64 on; `shift > 0`.
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
    #[inline(always)]
    pub const fn product(a: i32, b: i32) -> i64 {
        if ARMV6M {
            called_product(a, b)
        } else {
            a as i64 * b as i64
        }
    }

    #[inline(never)]
    const fn called_product(a: i32, b: i32) -> i64 {
        product_by_halves(a, b)
    }

    /// By four multiplications.
    #[inline(always)]
    pub const fn product_by_halves(a: i32, b: i32) -> i64 {
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

    /// A factor of many products, for Armv6-M in three digits of seven bits and more, the lowest first.
    #[derive(Clone, Copy)]
    pub struct Digits([i32; 3]);

    /// Bits that a factor in digits may have, its sign left out: of 21 the upper digit has 8, so that no product leaves
    /// a word.
    const SHORT: u32 = 21;

    impl Digits {
        /// `factor` of at most `bits + 1` bits.
        #[inline(always)]
        pub const fn new(factor: i32, bits: u32) -> Digits {
            if ARMV6M && bits <= SHORT {
                Digits::split(factor)
            } else {
                Digits([factor, 0, 0])
            }
        }

        #[inline(always)]
        pub(super) const fn split(factor: i32) -> Digits {
            Digits([factor & 0x7f, factor >> 7 & 0x7f, factor >> 14])
        }

        /// `value * factor * 2^-drop` rounded down, for values of at most `bits` bits.
        #[inline(always)]
        pub const fn product(self, value: i32, bits: u32, drop: u32) -> i64 {
            if ARMV6M && bits <= SHORT {
                self.product_of_words(value, drop) as i64
            } else {
                product(value, self.0[0]) >> drop
            }
        }

        /// The same in words, where `drop` is 14 and more and leaves a word: a floor of a floor is one floor.
        #[inline(always)]
        pub(super) const fn product_of_words(self, value: i32, drop: u32) -> i32 {
            let [low, middle, high] = self.0;
            let sum = value.wrapping_mul(low) >> 7;
            let sum = value.wrapping_mul(middle).wrapping_add(sum) >> 7;
            value
                .wrapping_mul(high)
                .wrapping_add(sum)
                .wrapping_shr(drop.wrapping_sub(14))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{shift_left, shift_round};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn counts_agree(value: u64, drop in 0u32..64) {
            let value = value >> drop;
            prop_assert_eq!(by_words::zeros_by_halving(value as u32), plain::leading_zeros(value as u32));
            prop_assert_eq!(by_words::zeros_by_table(value as u32), plain::leading_zeros(value as u32));
            prop_assert_eq!(by_words::leading_zeros(value as u32), plain::leading_zeros(value as u32));
            for end in 8..=32 {
                prop_assert_eq!(by_words::zeros_by_byte(value as u32, end), plain::leading_zeros_below(value as u32, end));
            }
            prop_assert_eq!(by_words::leading_zeros_below(value as u32, 20), plain::leading_zeros(value as u32));
            prop_assert_eq!(by_words::leading_zeros_wide(value), plain::leading_zeros_wide(value));
        }

        #[test]
        fn shifts_agree(value: u64, zeros in 0u32..64) {
            prop_assert_eq!(by_words::shifted_up(value, zeros), plain::shifted_up(value, zeros));
        }

        #[test]
        fn normals_agree(value: i64, drop in 0u32..64) {
            let value = value >> drop;
            prop_assert_eq!(by_words::signed_normal(value), plain::signed_normal(value));
        }

        #[test]
        fn roundings_agree(value in prop_oneof![any::<i64>(), Just(i64::MAX), Just(i64::MIN)], drop in 0u32..64, shift in 1u32..100) {
            let value = value >> drop;
            prop_assert_eq!(by_words::rounded_down(value, shift), plain::rounded_down(value, shift));
        }

        #[test]
        fn products_agree(a: i32, b: i32, drop in 0u32..32) {
            let (a, b) = (a, b >> drop);
            let long = [(90_000, 90_000), (-32_768, 98_000), (98_000, -32_768), (0x7_8000, 0x5_8000)];
            for (a, b) in [(a, b), (b, a), (a >> drop, b), (i32::MIN, b), (i32::MIN, i32::MIN), (i32::MAX, b)].into_iter().chain(long) {
                prop_assert_eq!(by_words::product_by_halves(a, b), plain::product(a, b));
                prop_assert_eq!(by_words::product(a, b), plain::product(a, b));
            }
        }

        /// With the ends of values of 21 bits and of factors of 22.
        #[test]
        fn products_by_digits_agree(value in prop_oneof![-0x1f_ffff..=0x1f_ffffi32, Just(0x1f_ffff), Just(-0x1f_ffff)],
            factor in prop_oneof![-0x40_0000..=0x40_0000i32, Just(0x40_0000), Just(-0x40_0000), Just(0x3f_ffff)], drop in 14u32..22) {
            let expected = plain::Digits::new(factor, 21).product(value, 21, drop);
            prop_assert_eq!(i64::from(by_words::Digits::split(factor).product_of_words(value, drop)), expected);
            prop_assert_eq!(by_words::Digits::new(factor, 21).product(value, 21, drop), expected);
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
            assert_eq!(by_words::zeros_by_halving(value), value.leading_zeros());
            assert_eq!(by_words::zeros_by_table(value), value.leading_zeros());
        }
        for value in [i32::MIN, -1, 0, 1, i32::MAX] {
            for shift in 1..70 {
                let wide = shift_round(value.into(), shift as u32);
                assert_eq!(shift_word(value, shift), wide as i32);
            }
        }
    }
}
