//! Normalised numbers: an integer mantissa and a power of two.
//!
//! Setup works in block floating point: mantissas of [`mantissa`](crate::format::Widths::mantissa) bits, exponents that are
//! aligned once per sum. Nothing is lost by range, so the relative error of every product is at most
//! `2^-mantissa`, whatever the scene's scale. A sum of products is aligned in 64 bits and rounded once.
//!
//! On 32-bit processors normalisation is a function of its own and not inlined, for the sake of code size (docs/firmware.md).

use super::shift::{shift_left, shift_signed};
use super::words::{
    leading_bits, leading_zeros, leading_zeros_wide, product, shift_word, shifted_up,
};

/// `mantissa * 2^exponent`. Normalised: the magnitude has exactly the design's mantissa bits, or is 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SoftFloat {
    /// Signed mantissa, at most 31 bits of magnitude.
    pub mantissa: i32,
    /// Power of two.
    pub exponent: i32,
}

/// An exact product of two mantissas, not yet normalised: `value * 2^exponent`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Product {
    /// At most 62 bits of magnitude.
    pub value: i64,
    /// Power of two.
    pub exponent: i32,
}

/// Exponent given to zero: below every other, and far from the ends of `i32`.
const ZERO_EXPONENT: i32 = -(1 << 20);

impl SoftFloat {
    /// Zero.
    pub const ZERO: SoftFloat = SoftFloat {
        mantissa: 0,
        exponent: ZERO_EXPONENT,
    };

    /// `value * 2^exponent` with the magnitude rounded to nearest to `bits` (at most 31) bits.
    #[cfg_attr(not(target_pointer_width = "32"), inline)]
    #[cfg_attr(target_pointer_width = "32", inline(never))]
    pub const fn from_wide(value: i64, exponent: i32, bits: u32) -> SoftFloat {
        if value == 0 {
            return SoftFloat::ZERO;
        }
        // Halves go towards positive infinity: for a negative number, to the smaller magnitude.
        let (mut magnitude, zeros) = leading_bits(value.unsigned_abs(), bits, value > 0);
        let mut exponent = exponent.saturating_add(64 - zeros as i32 - bits as i32);
        if magnitude.wrapping_shr(bits) != 0 {
            magnitude >>= 1;
            exponent = exponent.saturating_add(1);
        }
        SoftFloat {
            mantissa: if value < 0 {
                (magnitude as i32).wrapping_neg()
            } else {
                magnitude as i32
            },
            exponent,
        }
    }

    /// Exact product.
    #[inline(always)]
    pub const fn times(self, other: SoftFloat) -> Product {
        Product {
            value: product(self.mantissa, other.mantissa),
            exponent: self.exponent.saturating_add(other.exponent),
        }
    }

    /// Product rounded to `bits`.
    #[inline]
    pub const fn multiply(self, other: SoftFloat, bits: u32) -> SoftFloat {
        self.times(other).normalise(bits)
    }

    /// `self * 2^power`, exactly.
    #[inline(always)]
    pub const fn scaled_by(self, power: i32) -> SoftFloat {
        SoftFloat {
            mantissa: self.mantissa,
            exponent: self.exponent.saturating_add(power),
        }
    }

    /// Fixed point with `fraction` bits, rounded to nearest, saturated to 64 bits.
    #[cfg_attr(not(target_pointer_width = "32"), inline)]
    #[cfg_attr(target_pointer_width = "32", inline(never))]
    pub const fn to_fixed(self, fraction: u32) -> i64 {
        let up = self.exponent.saturating_add(fraction as i32);
        match up {
            ..=-1 => shift_word(self.mantissa, up.saturating_neg()) as i64,
            0..=31 => shifted_up(self.mantissa as i64 as u64, up as u32) as i64,
            _ => shift_left(self.mantissa as i64, up as u32),
        }
    }

    /// Position of the leading bit: `2^leading <= |self| < 2^(leading + 1)`; very negative for 0.
    #[inline(always)]
    pub const fn leading(self) -> i32 {
        let length = 32 - leading_zeros(self.mantissa.unsigned_abs()) as i32;
        self.exponent.saturating_add(length - 1)
    }
}

impl Product {
    /// Rounded to `bits`.
    #[inline]
    pub const fn normalise(self, bits: u32) -> SoftFloat {
        SoftFloat::from_wide(self.value, self.exponent, bits)
    }

    /// Fixed point with `fraction` bits, rounded to nearest, saturated to 64 bits.
    #[inline]
    pub const fn to_fixed(self, fraction: u32) -> i64 {
        shift_signed(
            self.value,
            0i32.saturating_sub(self.exponent)
                .saturating_sub(fraction as i32),
        )
    }
}

/// Sum of up to four products, aligned to 61 bits below the largest leading bit and rounded once to `bits`.
///
/// Alignment error: at most half of `2^-60` of the largest term for each term.
#[inline]
pub fn sum_of_products<const N: usize>(terms: [Product; N], bits: u32) -> SoftFloat {
    const { assert!(N <= 4) };
    sum(&terms, bits)
}

/// One function for any number of terms: a copy per number would be a tenth of a small image.
#[cfg_attr(not(target_pointer_width = "32"), inline(always))]
#[cfg_attr(target_pointer_width = "32", inline(never))]
fn sum(terms: &[Product], bits: u32) -> SoftFloat {
    let mut leading = i32::MIN;
    for term in terms {
        if term.value != 0 {
            let length = 64 - leading_zeros_wide(term.value.unsigned_abs()) as i32;
            leading = leading.max(term.exponent.saturating_add(length));
        }
    }
    if leading == i32::MIN {
        return SoftFloat::ZERO;
    }
    let unit = leading.saturating_sub(60);
    let mut sum = 0i64;
    for term in terms {
        if term.value != 0 {
            let shift = unit.saturating_sub(term.exponent);
            // To the left nothing leaves the word, by the choice of the unit, unless the exponent is at its end.
            let aligned = if shift < 0 && leading < i32::MAX {
                shifted_up(term.value as u64, shift.unsigned_abs()) as i64
            } else {
                shift_signed(term.value, shift)
            };
            sum = sum.wrapping_add(aligned);
        }
    }
    SoftFloat::from_wide(sum, unit, bits)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn value(number: SoftFloat) -> f64 {
        number.mantissa as f64 * (number.exponent as f64).exp2()
    }

    proptest! {
        #[test]
        fn normalising_rounds_to_the_mantissa(wide: i64, exponent in -100i32..100, bits in 8u32..=31) {
            let number = SoftFloat::from_wide(wide, exponent, bits);
            let exact = wide as f64 * (exponent as f64).exp2();
            prop_assert!((value(number) - exact).abs() <= exact.abs() * (-(bits as f64)).exp2() * 1.0001);
            if wide != 0 {
                let length = 32 - number.mantissa.unsigned_abs().leading_zeros();
                prop_assert_eq!(length, bits);
            }
        }

        #[test]
        fn sums_are_rounded_once(parts: [(i32, i32, i8); 4], bits in 8u32..=31) {
            let terms = parts.map(|(a, b, e)| Product { value: (a >> 1) as i64 * (b >> 1) as i64, exponent: e as i32 / 8 });
            let exact: f64 = terms.iter().map(|t| t.value as f64 * (t.exponent as f64).exp2()).sum();
            let largest = terms.iter().map(|t| (t.value as f64 * (t.exponent as f64).exp2()).abs()).fold(0.0, f64::max);
            let error = (value(sum_of_products(terms, bits)) - exact).abs();
            prop_assert!(error <= exact.abs() * (-(bits as f64)).exp2() * 1.0001 + largest * 1e-15, "{error} {exact}");
        }

        /// The oracle rounds in 128 bits.
        #[test]
        fn normalising_by_words_is_normalising(wide: i64, drop in 0u32..64, tail in 0u32..4, bits in 1u32..=31) {
            // Half of the values are short, some end in a half or next to it.
            let wide = wide >> drop;
            let wide = [wide, wide & -1 << 32, (wide & -1 << 33) | 1 << 32, (wide & -1 << 33) | 1][tail as usize];
            let got = SoftFloat::from_wide(wide, 3, bits);
            if wide == 0 {
                prop_assert_eq!(got, SoftFloat::ZERO);
                return Ok(());
            }
            let shift = 64 - wide.unsigned_abs().leading_zeros() as i32 - bits as i32;
            let rounded = if shift > 0 {
                (i128::from(wide) + (1 << (shift - 1))) >> shift
            } else {
                i128::from(wide) << -shift
            };
            let carried = rounded.unsigned_abs() >> bits != 0;
            let mantissa = if carried { rounded / 2 } else { rounded };
            prop_assert_eq!(got, SoftFloat { mantissa: mantissa as i32, exponent: 3 + shift + i32::from(carried) });
        }

        #[test]
        fn fixed_point_by_words_is_a_shift(mantissa: i32, exponent in -100i32..80, fraction in 0u32..64) {
            let expected = shift_signed(mantissa.into(), -exponent - fraction as i32);
            prop_assert_eq!(SoftFloat { mantissa, exponent }.to_fixed(fraction), expected);
        }

        /// The oracle aligns with shifts that saturate.
        #[test]
        fn alignment_needs_no_saturation(parts: [(i64, i8, u8); 4], last in prop_oneof![Just(0), Just(i32::MAX - 127)]) {
            let terms = parts.map(|(value, e, drop)| Product { value: value >> (2 + drop % 62), exponent: last + e as i32 });
            let length = |t: &Product| t.exponent.saturating_add(64 - t.value.unsigned_abs().leading_zeros() as i32);
            let Some(leading) = terms.iter().filter(|t| t.value != 0).map(length).max() else { return Ok(()) };
            let unit = leading.saturating_sub(60);
            let aligned = terms.iter().filter(|t| t.value != 0).map(|t| shift_signed(t.value, unit.saturating_sub(t.exponent)));
            let sum = aligned.fold(0, i64::wrapping_add);
            prop_assert_eq!(sum_of_products(terms, 20), SoftFloat::from_wide(sum, unit, 20));
        }

        #[test]
        fn every_bit_pattern_is_defined(mantissa: i32, exponent: i32, wide: i64, fraction in 0u32..64, bits in 1u32..=31) {
            let number = SoftFloat { mantissa, exponent };
            let _ = (number.to_fixed(fraction), number.leading(), number.multiply(number, bits));
            let _ = SoftFloat::from_wide(wide, exponent, bits);
            let product = Product { value: wide, exponent };
            let _ = (product.to_fixed(fraction), sum_of_products([product; 4], bits));
        }
    }

    #[test]
    fn fixed_point_saturates() {
        let number = SoftFloat {
            mantissa: 3,
            exponent: 80,
        };
        assert_eq!(number.to_fixed(16), i64::MAX);
        assert_eq!(
            SoftFloat {
                mantissa: -3,
                exponent: 80
            }
            .to_fixed(16),
            i64::MIN
        );
        assert_eq!(
            SoftFloat {
                mantissa: 3,
                exponent: -1
            }
            .to_fixed(0),
            2
        );
        assert_eq!(SoftFloat::ZERO.to_fixed(40), 0);
    }
}
