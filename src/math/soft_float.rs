//! Normalised numbers: an integer mantissa and a power of two.
//!
//! Setup works in block floating point: mantissas of [`mantissa`](crate::format::Widths::mantissa) bits, exponents that are
//! aligned once per sum. Nothing is lost by range, so the relative error of every product is at most
//! `2^-mantissa`, whatever the scene's scale.
//!
//! A sum of products needs no more bits than its result has, and a few to guard them: each product is cut to a window of
//! `mantissa + GUARD` bits, aligned to the largest, and only the sum is rounded. Where the window lies follows from exponents and the formats'
//! lengths alone, so that no leading zeros are counted before the sum. A cut rounds down, because a floor of a floor is one floor: it may be
//! done before or after the alignment, and costs nothing in hardware.
//!
//! On 32-bit processors normalisation is a function of its own and not inlined, for the sake of code size (docs/firmware.md).

use super::shift::{shift_left, shift_signed};
use super::words::{
    leading_zeros, leading_zeros_below, leading_zeros_wide, product, shift_word, shifted_up,
    signed_normal,
};

/// `mantissa * 2^exponent`. Normalised: the magnitude has exactly the design's mantissa bits, or is 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SoftFloat {
    /// Signed mantissa, at most 31 bits of magnitude.
    pub mantissa: i32,
    /// Power of two.
    pub exponent: i32,
}

/// Calls a function by the copy that knows its mantissa, which shifts by constants, where a small processor has a narrow design.
macro_rules! by_mantissa {
    ($bits:expr, $name:ident($($argument:expr),*)) => {
        match $bits {
            15 if cfg!(target_pointer_width = "32") => $name::<15>($($argument),*, 15),
            18 if cfg!(target_pointer_width = "32") => $name::<18>($($argument),*, 18),
            bits => $name::<0>($($argument),*, bits),
        }
    };
}

pub(crate) use by_mantissa;

/// The mantissa that a copy knows, or the one it is told.
#[inline(always)]
pub(crate) const fn known<const KNOWN: u32>(bits: u32) -> u32 {
    if KNOWN == 0 { bits } else { KNOWN }
}

/// Bits that a sum keeps below those of its result. Of terms that do not cancel they leave `2^-8` of a last bit each.
pub const GUARD: u32 = 8;

/// A term of a sum, not yet normalised: `value * 2^exponent`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Product {
    /// At most `length` bits of magnitude.
    pub value: i64,
    /// Power of two.
    pub exponent: i32,
    /// Bits that its format has: for two mantissas theirs together. At most 63.
    pub length: u32,
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
        if cfg!(target_pointer_width = "32") && value as i32 as i64 == value {
            return SoftFloat::from_word(value as i32, exponent, bits);
        }
        let (normal, below, zeros) = signed_normal(value);
        SoftFloat::rounded(normal, below, exponent, 64 - zeros as i32, bits)
    }

    /// The same of a word.
    #[cfg_attr(not(target_pointer_width = "32"), inline)]
    #[cfg_attr(target_pointer_width = "32", inline(never))]
    pub(crate) const fn from_word(value: i32, exponent: i32, bits: u32) -> SoftFloat {
        if value == 0 {
            return SoftFloat::ZERO;
        }
        let zeros = leading_zeros((value ^ value >> 31) as u32);
        let normal = value.wrapping_shl(zeros.wrapping_sub(1));
        SoftFloat::rounded(normal, 0, exponent, 32 - zeros as i32, bits)
    }

    /// The same of a sum in a window ([`fits_words`]), which ends two bits below the sum's own end: there its leading bit is looked for first.
    #[inline(always)]
    pub(crate) fn from_sum(value: i32, exponent: i32, bits: u32) -> SoftFloat {
        by_mantissa!(bits, rounded_sum(value, exponent))
    }

    /// A number whose first bit unlike its sign is bit 30 of `normal` and stands for `2^(exponent + length - 1)`, rounded to `bits`, halves up;
    /// `below` is the bit after the word.
    #[inline(always)]
    const fn rounded(normal: i32, below: u32, exponent: i32, length: i32, bits: u32) -> SoftFloat {
        let exponent = exponent.saturating_add(length - bits as i32);
        let mantissa = if bits == 31 {
            normal.wrapping_add(below as i32)
        } else {
            normal
                .wrapping_shr(30u32.wrapping_sub(bits))
                .wrapping_add(1)
                >> 1
        };
        if mantissa.wrapping_shl(32u32.wrapping_sub(bits)) != 0 {
            return SoftFloat { mantissa, exponent };
        }
        // Up to the next power of two, beyond the word's end for a positive number; a negative one may be one itself.
        let half = 1i32.wrapping_shl(bits.wrapping_sub(1));
        SoftFloat {
            mantissa: if normal < 0 {
                half.wrapping_neg()
            } else {
                half
            },
            exponent: exponent.saturating_add(1),
        }
    }

    /// Exact product of mantissas of any length.
    #[inline(always)]
    pub const fn times(self, other: SoftFloat) -> Product {
        self.times_within(other, self.length() + other.length())
    }

    /// Exact product of mantissas that are known to have `length` bits together, or to be 0.
    #[inline(always)]
    pub const fn times_within(self, other: SoftFloat, length: u32) -> Product {
        let value = if length < 32 {
            self.mantissa.wrapping_mul(other.mantissa) as i64
        } else {
            product(self.mantissa, other.mantissa)
        };
        Product {
            value,
            exponent: self.exponent.saturating_add(other.exponent),
            length,
        }
    }

    /// The number itself as a term, its mantissa known to have `length` bits or to be 0.
    #[inline(always)]
    pub const fn term_within(self, length: u32) -> Product {
        Product {
            value: self.mantissa as i64,
            exponent: self.exponent,
            length,
        }
    }

    /// Bits of the mantissa's magnitude.
    #[inline(always)]
    pub const fn length(self) -> u32 {
        32 - leading_zeros(self.mantissa.unsigned_abs())
    }

    /// Product of mantissas that are known to have `bits` bits each, rounded to as many; exact where they have.
    #[inline(always)]
    pub fn multiply_within(self, other: SoftFloat, bits: u32) -> SoftFloat {
        sum_of_products([self.times_within(other, 2 * bits)], bits)
    }

    /// Product rounded to `bits`.
    #[inline]
    pub const fn multiply(self, other: SoftFloat, bits: u32) -> SoftFloat {
        let Product {
            value, exponent, ..
        } = self.times(other);
        SoftFloat::from_wide(value, exponent, bits)
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
        self.exponent.saturating_add(self.length() as i32 - 1)
    }
}

impl Product {
    /// A term of any value, its length counted.
    #[inline(always)]
    pub const fn new(value: i64, exponent: i32) -> Product {
        Product {
            value,
            exponent,
            length: 64 - leading_zeros_wide(value.unsigned_abs()),
        }
    }

    /// With the other sign.
    #[inline(always)]
    pub const fn negated(self) -> Product {
        Product {
            value: self.value.wrapping_neg(),
            ..self
        }
    }

    /// Rounded to `bits`.
    #[inline]
    pub const fn normalise(self, bits: u32) -> SoftFloat {
        if self.length < 32 {
            return SoftFloat::from_word(self.value as i32, self.exponent, bits);
        }
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

    /// Cut to the first `window` bits of its format.
    #[inline(always)]
    const fn cut(self, window: u32) -> Cut {
        let drop = self.length as i32 - window as i32;
        // Two short mantissas make a word.
        let word = self.length < 32 && drop >= 0;
        Cut {
            value: if word {
                (self.value as i32 >> drop) as i64
            } else {
                shift_down(self.value, drop)
            },
            top: self.exponent.saturating_add(self.length as i32),
        }
    }
}

/// A term in a window: `value * 2^(top - window)`.
#[derive(Clone, Copy)]
struct Cut {
    value: i64,
    top: i32,
}

impl Cut {
    const NONE: Cut = Cut { value: 0, top: 0 };
}

/// `value * 2^-shift` rounded down; to the left what leaves the word is lost. `|shift|` at most 63, more counts as 63.
#[inline(always)]
const fn shift_down(value: i64, shift: i32) -> i64 {
    if shift < 0 {
        value.wrapping_shl(shift.unsigned_abs())
    } else if shift > 63 {
        value >> 63
    } else {
        value >> shift
    }
}

/// Sum of up to four terms, cut to `bits + GUARD` bits below the largest format's end and rounded once to `bits`, halves up.
///
/// The window ends at the largest `exponent + length` of all terms that are not 0 in it. Every cut takes less than `2^-(bits + GUARD)` of that;
/// of two normalised mantissas the first bit may be 0, so that is less than `2^-(bits + GUARD - 2)` of the largest term.
#[cfg_attr(not(target_pointer_width = "32"), inline)]
#[cfg_attr(target_pointer_width = "32", inline(always))]
pub fn sum_of_products<const N: usize>(terms: [Product; N], bits: u32) -> SoftFloat {
    const { assert!(N <= 4) };
    let window = bits + GUARD;
    let mut cuts = [Cut::NONE; N];
    for (cut, term) in cuts.iter_mut().zip(terms) {
        *cut = term.cut(window);
    }
    if !fits_words(bits) {
        return sum(&cuts, bits);
    }
    let mut words = [(0, 0); N];
    for (word, cut) in words.iter_mut().zip(cuts) {
        *word = (cut.value as i32, cut.top);
    }
    match words.as_slice() {
        [(value, top)] => SoftFloat::from_sum(*value, top.saturating_sub(window as i32), bits),
        [(a, a_top), (b, b_top)] => by_mantissa!(bits, sum_of_two(*a, *a_top, *b, *b_top)),
        _ => by_mantissa!(bits, sum_in_words(&words)),
    }
}

/// Does a sum of four terms fit a word, the sign included?
const fn fits_words(bits: u32) -> bool {
    bits + GUARD + 2 < 32
}

/// [`SoftFloat::from_sum`] of one mantissa.
#[cfg_attr(not(target_pointer_width = "32"), inline)]
#[cfg_attr(target_pointer_width = "32", inline(never))]
fn rounded_sum<const KNOWN: u32>(value: i32, exponent: i32, bits: u32) -> SoftFloat {
    let bits = known::<KNOWN>(bits);
    if value == 0 {
        return SoftFloat::ZERO;
    }
    let zeros = leading_zeros_below((value ^ value >> 31) as u32, bits + GUARD + 2);
    let normal = value.wrapping_shl(zeros.wrapping_sub(1));
    SoftFloat::rounded(normal, 0, exponent, 32 - zeros as i32, bits)
}

/// [`sum_in_words`] of two terms, without a list of them.
#[cfg_attr(not(target_pointer_width = "32"), inline(always))]
#[cfg_attr(target_pointer_width = "32", inline(never))]
fn sum_of_two<const KNOWN: u32>(a: i32, a_top: i32, b: i32, b_top: i32, bits: u32) -> SoftFloat {
    let bits = known::<KNOWN>(bits);
    let at = |value: i32, top: i32| {
        SoftFloat::from_sum(value, top.saturating_sub((bits + GUARD) as i32), bits)
    };
    let down = |value: i32, shift: i32| value >> if shift as u32 > 31 { 31 } else { shift };
    if b == 0 || (a != 0 && a_top >= b_top) {
        at(a.wrapping_add(down(b, a_top.wrapping_sub(b_top))), a_top)
    } else {
        at(b.wrapping_add(down(a, b_top.wrapping_sub(a_top))), b_top)
    }
}

/// `sum` in words of 32 bits.
#[cfg_attr(not(target_pointer_width = "32"), inline(always))]
#[cfg_attr(target_pointer_width = "32", inline(never))]
fn sum_in_words<const KNOWN: u32>(terms: &[(i32, i32)], bits: u32) -> SoftFloat {
    let bits = known::<KNOWN>(bits);
    let mut top = i32::MIN;
    for (value, end) in terms {
        if *value != 0 && *end > top {
            top = *end;
        }
    }
    let mut sum = 0i32;
    for (value, end) in terms {
        let shift = top.wrapping_sub(*end);
        sum = sum.wrapping_add(value >> if shift as u32 > 31 { 31 } else { shift });
    }
    SoftFloat::from_sum(sum, top.saturating_sub((bits + GUARD) as i32), bits)
}

/// The same in a window that ends at `2^top`, below which all terms lie, rounded once to `bits`.
#[inline]
pub fn sum_below<const N: usize>(terms: [Product; N], top: i32, bits: u32) -> SoftFloat {
    let unit = top.saturating_sub((bits + GUARD) as i32);
    let mut sum = 0i64;
    for term in terms {
        sum = sum.wrapping_add(shift_down(term.value, unit.saturating_sub(term.exponent)));
    }
    SoftFloat::from_wide(sum, unit, bits)
}

/// One function for any number of terms: a copy per number would be a tenth of a small image.
#[cfg_attr(not(target_pointer_width = "32"), inline(always))]
#[cfg_attr(target_pointer_width = "32", inline(never))]
fn sum(terms: &[Cut], bits: u32) -> SoftFloat {
    let mut top = i32::MIN;
    for term in terms {
        if term.value != 0 && term.top > top {
            top = term.top;
        }
    }
    let mut sum = 0i64;
    for term in terms {
        sum = sum.wrapping_add(shift_down(term.value, top.saturating_sub(term.top)));
    }
    SoftFloat::from_wide(sum, top.saturating_sub((bits + GUARD) as i32), bits)
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
            let terms = parts.map(|(a, b, e)| {
                let [a, b] = [a, b].map(|mantissa| SoftFloat { mantissa: mantissa >> 1, exponent: e as i32 / 16 });
                a.times(b)
            });
            let number = |t: &Product| t.value as f64 * (t.exponent as f64).exp2();
            let exact: f64 = terms.iter().map(number).sum();
            let largest = terms.iter().map(number).fold(0.0, |most: f64, term| most.max(term.abs()));
            let error = (value(sum_of_products(terms, bits)) - exact).abs();
            // Of four terms each loses less than a unit, and the largest has its leading bit at the window's first or second bit.
            let cuts = 4.0 * 4.0 * largest * (-f64::from(bits + GUARD)).exp2();
            prop_assert!(error <= (exact.abs() + cuts) * (-f64::from(bits)).exp2() * 1.0001 + cuts, "{error} {exact}");
        }

        #[test]
        fn normalising_by_words_is_normalising(wide: i64, drop in 0u32..64, tail in 0u32..4, bits in 1u32..=31) {
            // Half of the values are short, some end in a half or next to it.
            let wide = wide >> drop;
            let wide = [wide, wide & -1 << 32, (wide & -1 << 33) | 1 << 32, (wide & -1 << 33) | 1][tail as usize];
            prop_assert_eq!(SoftFloat::from_wide(wide, 3, bits), normalised(wide, bits));
            if let Ok(word) = i32::try_from(wide) {
                prop_assert_eq!(SoftFloat::from_word(word, 3, bits), normalised(wide, bits));
            }
        }

        #[test]
        fn fixed_point_by_words_is_a_shift(mantissa: i32, exponent in -100i32..80, fraction in 0u32..64) {
            let expected = shift_signed(mantissa.into(), -exponent - fraction as i32);
            prop_assert_eq!(SoftFloat { mantissa, exponent }.to_fixed(fraction), expected);
        }

        /// The oracle cuts and adds in 128 bits.
        #[test]
        fn terms_are_cut_to_the_window(parts: [(i64, i8, u8); 4], last in prop_oneof![Just(0), Just(i32::MAX - 200)], bits in 8u32..=31) {
            let terms = parts.map(|(value, e, drop)| Product::new(value >> (2 + drop % 62), last + e as i32));
            let top = |t: &Product| t.exponent.saturating_add(t.length as i32);
            let Some(top) = terms.iter().filter(|t| t.value != 0).map(top).max() else { return Ok(()) };
            let unit = top.saturating_sub(bits as i32 + GUARD as i32);
            let aligned = terms.iter().map(|t| match unit.saturating_sub(t.exponent) {
                shift @ ..0 => i128::from(t.value) << shift.unsigned_abs().min(63),
                shift => i128::from(t.value) >> shift.min(127),
            });
            let sum: i128 = aligned.sum();
            prop_assert_eq!(sum_of_products(terms, bits), SoftFloat::from_wide(sum as i64, unit, bits));
            prop_assert_eq!(sum_below(terms, top, bits), SoftFloat::from_wide(sum as i64, unit, bits));
        }

        #[test]
        fn every_bit_pattern_is_defined(mantissa: i32, exponent: i32, wide: i64, fraction in 0u32..64, bits in 1u32..=31) {
            let number = SoftFloat { mantissa, exponent };
            let _ = (number.to_fixed(fraction), number.leading(), number.multiply(number, bits));
            let _ = SoftFloat::from_wide(wide, exponent, bits);
            let product = Product { value: wide, exponent, length: fraction };
            let _ = (product.to_fixed(fraction), sum_of_products([product; 4], bits), sum_below([product; 4], mantissa, bits));
        }
    }

    /// Times 8, rounded in 128 bits.
    fn normalised(wide: i64, bits: u32) -> SoftFloat {
        if wide == 0 {
            return SoftFloat::ZERO;
        }
        let shift = 64 - wide.unsigned_abs().leading_zeros() as i32 - bits as i32;
        let rounded = if shift > 0 {
            (i128::from(wide) + (1 << (shift - 1))) >> shift
        } else {
            i128::from(wide) << -shift
        };
        let carried = rounded.unsigned_abs() >> bits != 0;
        let mantissa = if carried { rounded / 2 } else { rounded };
        SoftFloat {
            mantissa: mantissa as i32,
            exponent: 3 + shift + i32::from(carried),
        }
    }

    /// Numbers of ones alone carry through all of them.
    #[test]
    fn ones_become_the_next_power_of_two() {
        for (bits, length) in (1..=31).flat_map(|bits| (1..=63).map(move |length| (bits, length))) {
            let ones = i64::MAX >> (63 - length);
            for value in [ones, -ones, ones - 1, -ones - 1] {
                let found = SoftFloat::from_wide(value, 3, bits);
                assert_eq!(found, normalised(value, bits), "{value} {bits}");
                if let Ok(word) = i32::try_from(value) {
                    assert_eq!(SoftFloat::from_word(word, 3, bits), found, "{word} {bits}");
                }
            }
        }
    }

    #[test]
    fn short_numbers_by_words_are_rounded_alike() {
        for bits in [1, 4, 8, 12, 16] {
            for value in -40_000..40_000 {
                let wide = SoftFloat::from_wide(value.into(), 3, bits);
                assert_eq!(SoftFloat::from_word(value, 3, bits), wide, "{value} {bits}");
            }
        }
    }

    /// Terms of 0 say nothing of the window, wherever they are; small ones do. The oracle is the sum in two words.
    #[test]
    fn terms_of_zero_have_no_say() {
        let places = [0, 3, 40].into_iter().flat_map(|exponent| {
            [0, 1, 2, -1, 1 << 29].map(|value| Product {
                value,
                exponent,
                length: 30,
            })
        });
        for a in places.clone() {
            for b in places.clone() {
                let wide = [a, b].map(|term| term.cut(15 + GUARD));
                assert_eq!(sum_of_products([a, b], 15), sum(&wide, 15), "{a:?} {b:?}");
            }
        }
        assert_eq!(
            Product::new(3 << 30, 0).normalise(2),
            SoftFloat {
                mantissa: 3,
                exponent: 30
            }
        );
    }

    /// Four of the largest terms, alone and with mantissas of half a word.
    #[test]
    fn the_largest_sums_fit() {
        for bits in 8..=31 {
            let most = SoftFloat {
                mantissa: i32::MAX >> (31 - bits),
                exponent: 0,
            };
            let term = most.times_within(most, 2 * bits);
            assert_eq!(
                term.value,
                i64::from(most.mantissa) * i64::from(most.mantissa)
            );
            let drop = (2 * bits).saturating_sub(bits + GUARD);
            let sum = 4 * (term.value >> drop);
            let unit = 2 * bits as i32 - (bits + GUARD) as i32;
            let sum = if unit < 0 { sum << -unit } else { sum };
            assert_eq!(
                sum_of_products([term; 4], bits),
                SoftFloat::from_wide(sum, unit, bits),
                "{bits}"
            );
        }
        for bits in 8..=31 {
            // A single bit at the window's end.
            let least = Product {
                value: 1,
                exponent: 0,
                length: bits + GUARD,
            };
            assert_eq!(
                sum_of_products([least], bits),
                SoftFloat::from_wide(1, 0, bits)
            );
        }
        let far = Product {
            value: 1 << 62,
            exponent: 0,
            length: 63,
        };
        assert_eq!(sum_below([far], 200, 8), SoftFloat::ZERO);
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
