//! Numbers wider than a mantissa of setup: where the eye is, how far a splat is away from it, where the picture's
//! depths end.

use super::words::{leading_zeros_wide, shifted_up};

/// `value * 2^exponent`. Every bit pattern is a number; nothing needs to be normalised.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Extended {
    /// Signed, up to 64 bits.
    pub value: i64,
    /// Power of two.
    pub exponent: i32,
}

impl Extended {
    /// Zero.
    pub const ZERO: Extended = Extended {
        value: 0,
        exponent: 0,
    };

    /// Larger than any other number: a far plane that culls nothing.
    pub const MAX: Extended = Extended {
        value: i64::MAX,
        exponent: i32::MAX,
    };

    /// Position of the leading bit: `2^leading <= |self| < 2^(leading + 1)`, saturated; `i32::MIN` for 0.
    #[inline]
    pub const fn leading(self) -> i32 {
        if self.value == 0 {
            return i32::MIN;
        }
        let length = 64 - leading_zeros_wide(self.value.unsigned_abs()) as i32;
        self.exponent.saturating_add(length - 1)
    }

    /// Is `self > other`? Exact, but for numbers beyond `2^(2^31)`, which count as equal to each other.
    #[cfg_attr(not(target_pointer_width = "32"), inline)]
    #[cfg_attr(target_pointer_width = "32", inline(never))]
    pub const fn exceeds(self, other: Extended) -> bool {
        let (sign, other_sign) = (self.value.signum(), other.value.signum());
        if sign != other_sign {
            return sign > other_sign;
        }
        // Of negative numbers the one nearer to 0 is larger.
        let (larger, smaller) = if sign < 0 {
            (other, self)
        } else {
            (self, other)
        };
        let (a, b) = (larger.leading(), smaller.leading());
        a > b || a == b && larger.normal() > smaller.normal()
    }

    /// The magnitude moved up until its leading bit is bit 63; 0 stays 0.
    #[cfg_attr(not(target_pointer_width = "32"), inline)]
    #[cfg_attr(target_pointer_width = "32", inline(never))]
    const fn normal(self) -> u64 {
        let magnitude = self.value.unsigned_abs();
        shifted_up(magnitude, leading_zeros_wide(magnitude) & 63)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// The oracle compares in 128 bits.
        #[test]
        fn comparison_is_exact(a: i64, b: i64, drops in prop::array::uniform2(0u32..64), exponents in prop::array::uniform2(0i32..60), same: bool) {
            let a = Extended { value: a >> drops[0], exponent: exponents[0] };
            let b = if same { a } else { Extended { value: b >> drops[1], exponent: exponents[1] } };
            let wide = |number: Extended| i128::from(number.value) << number.exponent;
            prop_assert_eq!(a.exceeds(b), wide(a) > wide(b));
            prop_assert_eq!(b.exceeds(a), wide(b) > wide(a));
            prop_assert!(a.value == 0 || wide(a).unsigned_abs() >> a.leading() == 1);
            let half = Extended { value: 1, exponent: a.exponent - 1 };
            let whole = Extended { value: 1, ..a };
            prop_assert!(whole.exceeds(half));
        }

        /// The same number in more or fewer digits, and one unit more.
        #[test]
        fn digits_do_not_count(value in 1i64..1 << 20, by in 1u32..42, exponent in -100..100) {
            let short = Extended { value, exponent };
            let long = Extended { value: value << by, exponent: exponent - by as i32 };
            let more = Extended { value: long.value + 1, ..long };
            prop_assert!(!short.exceeds(long) && !long.exceeds(short));
            prop_assert!(more.exceeds(short) && !short.exceeds(more));
        }

        #[test]
        fn every_bit_pattern_is_defined(value: i64, exponent: i32, other: i64, power: i32) {
            let (a, b) = (Extended { value, exponent }, Extended { value: other, exponent: power });
            prop_assert!(!(a.exceeds(b) && b.exceeds(a)));
            prop_assert!(!Extended::ZERO.exceeds(Extended::MAX));
        }
    }
}
