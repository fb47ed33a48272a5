//! The depth of a footprint as a sort key: a number with an exponent, so that no scene is too deep or too shallow for
//! it.
//!
//! 48 bits, compared as an unsigned integer: sign (1 for positive), 9 bits of exponent, 38 bits of mantissa below the
//! leading bit. Depths that differ by more than `2^-38` of themselves get different keys, in their order; equal keys
//! are drawn in the order of the splats. With a fixed grid, a sky of 10^4 units left the object before it a few hundred
//! depths.

use crate::math::words::leading_zeros_wide;
use crate::math::{Extended, shift_signed};

/// Bits of a key.
pub const KEY_BITS: u32 = 48;

/// Bits of a key's mantissa, without the leading one.
pub const MANTISSA: u32 = 38;

const EXPONENT: u32 = KEY_BITS - 1 - MANTISSA;
const BIAS: i32 = 1 << (EXPONENT - 1);
const POSITIVE: u64 = 1 << (KEY_BITS - 1);

/// The key of a depth: monotone, truncated towards 0. Magnitudes beyond `2^-256 .. 2^256` count as the nearest within.
#[cfg_attr(not(target_pointer_width = "32"), inline)]
#[cfg_attr(target_pointer_width = "32", inline(never))]
pub const fn key(depth: Extended) -> u64 {
    if depth.value == 0 {
        return POSITIVE;
    }
    let magnitude = depth.value.unsigned_abs();
    let zeros = leading_zeros_wide(magnitude);
    let leading = depth.exponent.saturating_add(63 - zeros as i32);
    let below = magnitude.wrapping_shl(zeros) << 1 >> (64 - MANTISSA);
    let key = if leading < -BIAS {
        0
    } else if leading >= BIAS {
        POSITIVE - 1
    } else {
        ((leading + BIAS) as u64) << MANTISSA | below
    };
    if depth.value > 0 {
        POSITIVE | key
    } else {
        POSITIVE - 1 - key
    }
}

/// The depth of a key, from the key's bits: what [`key`] was given, truncated.
#[inline]
pub const fn number(key: u64) -> Extended {
    let positive = key & POSITIVE != 0;
    let magnitude = if positive { key } else { !key } & (POSITIVE - 1);
    let mantissa = (magnitude & ((1 << MANTISSA) - 1) | 1 << MANTISSA) as i64;
    Extended {
        value: if positive { mantissa } else { -mantissa },
        exponent: (magnitude >> MANTISSA) as i32 - BIAS - MANTISSA as i32,
    }
}

/// The depth of a key in UQ9.23, rounded to nearest and saturated; 0 behind the eye.
///
/// Sheets, gathered points and surfaces compare depths by differences, for which a fixed unit is right.
#[cfg_attr(not(target_pointer_width = "32"), inline)]
#[cfg_attr(target_pointer_width = "32", inline(never))]
pub const fn fixed(key: u64) -> u32 {
    let Extended { value, exponent } = number(key);
    if value < 0 {
        return 0;
    }
    let fixed = shift_signed(value, -23 - exponent);
    if fixed > u32::MAX as i64 {
        u32::MAX
    } else {
        fixed as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn order_is_the_depths(a: i64, b: i64, drops in prop::array::uniform2(0u32..64), exponents in prop::array::uniform2(-90i32..60)) {
            let a = Extended { value: a >> drops[0], exponent: exponents[0] };
            let b = Extended { value: b >> drops[1], exponent: exponents[1] };
            let (lower, upper) = if a.exceeds(b) { (b, a) } else { (a, b) };
            prop_assert!(key(lower) <= key(upper));
            prop_assert!(key(upper) < 1 << KEY_BITS);
        }

        #[test]
        fn depths_apart_by_more_than_the_mantissa_differ(value in 1i64 << 40..1 << 62, exponent in -200i32..150) {
            let step = value >> (MANTISSA - 1);
            let (this, next) = (Extended { value, exponent }, Extended { value: value + step, exponent });
            prop_assert!(key(this) < key(next));
        }

        #[test]
        fn fixed_depths_are_rounded(depth in 0.0f64..511.0) {
            let exact = Extended { value: (depth * 2f64.powi(50)) as i64, exponent: -50 };
            let got = f64::from(fixed(key(exact))) / 2f64.powi(23);
            prop_assert!((got - depth).abs() <= 2f64.powi(-24) + depth * 2f64.powi(-38), "{got} {depth}");
        }

        #[test]
        fn every_bit_pattern_is_defined(value: i64, exponent: i32, word: u64) {
            let depth = Extended { value, exponent };
            prop_assert!(key(depth) < 1 << KEY_BITS);
            let _ = (fixed(word), number(word));
            prop_assert!(key(number(word & ((1 << KEY_BITS) - 1))) == word & ((1 << KEY_BITS) - 1));
        }
    }

    #[test]
    fn ends() {
        let number = |value, exponent| Extended { value, exponent };
        assert_eq!(fixed(key(number(1, 0))), 1 << 23);
        assert_eq!(fixed(key(number(-1, 0))), 0);
        assert_eq!(fixed(key(Extended::MAX)), u32::MAX);
        assert!(key(number(-1, 90)) < key(number(-1, 0)));
        assert!(key(number(-1, -300)) < key(number(0, 0)));
        assert_eq!(key(number(0, 0)), key(number(1, -300)));
        assert_eq!(key(number(1, 256)), 2 * POSITIVE - 1);
    }
}
