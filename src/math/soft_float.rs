//! Normalised numbers: an integer mantissa and a power of two.
//!
//! Setup works in block floating point: mantissas of [`mantissa`](crate::format::Widths::mantissa) bits, exponents that
//! are aligned once per sum. Nothing is lost by range, so the relative error of every product is at most `2^-mantissa`,
//! whatever the scene's scale.
//!
//! A sum of products needs no more bits than its result has, and a few to guard them: each product is cut to a window
//! of `mantissa + GUARD` bits, aligned to the largest, and only the sum is rounded. Where the window lies follows from
//! exponents and the formats' lengths alone, so that no leading zeros are counted before the sum. A cut rounds down,
//! because a floor of a floor is one floor: it may be done before or after the alignment, and costs nothing in
//! hardware.
//!
//! `bits` is 1 to 31 wherever a result is rounded to it. Other numbers of bits are no width: what they give has no
//! meaning, but nothing panics.
//!
//! On 32-bit processors normalisation is a function of its own and not inlined, for the sake of code size
//! (docs/firmware.md).

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

/// Calls a function by the copy that knows its mantissa, which shifts by constants, where a small processor has a
/// narrow design.
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

    /// `value * 2^exponent` with the magnitude rounded to nearest, halves up, to `bits` (1 to 31) bits; the exponent
    /// saturates.
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

    /// The same of a sum in a window ([`fits_words`]), which ends two bits below the sum's own end: there its leading
    /// bit is looked for first.
    #[inline(always)]
    pub(crate) fn from_sum(value: i32, exponent: i32, bits: u32) -> SoftFloat {
        by_mantissa!(bits, rounded_sum(value, exponent))
    }

    /// A number whose first bit unlike its sign is bit 30 of `normal` and stands for `2^(exponent + length - 1)`,
    /// rounded to `bits`, halves up; `below` is the bit after the word.
    #[inline(always)]
    const fn rounded(normal: i32, below: u32, exponent: i32, length: i32, bits: u32) -> SoftFloat {
        let exponent = exponent.saturating_add(length.wrapping_sub(bits as i32));
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
        sum_of_products([self.times_within(other, bits.wrapping_mul(2))], bits)
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
        let drop = (self.length as i32).wrapping_sub(window as i32);
        // Two short mantissas make a word.
        let word = self.length < 32 && drop >= 0;
        Cut {
            value: if word {
                (self.value as i32).wrapping_shr(drop as u32) as i64
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

/// Sum of up to four terms, cut to `bits + GUARD` bits below the largest format's end and rounded once to `bits`,
/// halves up.
///
/// The window ends at the largest `exponent + length` of all terms that are not 0 in it. Every cut takes less than
/// `2^-(bits + GUARD)` of that; of two normalised mantissas the first bit may be 0, so that is less than
/// `2^-(bits + GUARD - 2)` of the largest term.
#[cfg_attr(not(target_pointer_width = "32"), inline)]
#[cfg_attr(target_pointer_width = "32", inline(always))]
pub fn sum_of_products<const N: usize>(terms: [Product; N], bits: u32) -> SoftFloat {
    const { assert!(N <= 4) };
    let window = window(bits);
    if !fits_words(bits) {
        let mut cuts = [Cut::NONE; N];
        for (cut, term) in cuts.iter_mut().zip(terms) {
            *cut = term.cut(window);
        }
        return sum(&cuts, bits);
    }
    // Term by term: a loop that a compiler for size keeps would have them all in memory.
    let word = |term: Product| {
        let Cut { value, top } = term.cut(window);
        (value as i32, top)
    };
    match *terms.as_slice() {
        [a] => {
            let (value, top) = word(a);
            SoftFloat::from_sum(value, top.saturating_sub(window as i32), bits)
        }
        [a, b] => {
            let ((a, a_top), (b, b_top)) = (word(a), word(b));
            by_mantissa!(bits, sum_of_two(a, a_top, b, b_top))
        }
        [a, b, c] => {
            let words = [word(a), word(b), word(c)];
            by_mantissa!(bits, sum_in_words(&words))
        }
        [a, b, c, d] => {
            let words = [word(a), word(b), word(c), word(d)];
            by_mantissa!(bits, sum_in_words(&words))
        }
        _ => SoftFloat::ZERO,
    }
}

/// Bits of a term in a sum.
#[inline(always)]
const fn window(bits: u32) -> u32 {
    bits.wrapping_add(GUARD)
}

/// Does a sum of four terms fit a word, the sign included?
const fn fits_words(bits: u32) -> bool {
    bits < 32 - GUARD - 2
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
        SoftFloat::from_sum(value, top.saturating_sub(window(bits) as i32), bits)
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
    SoftFloat::from_sum(sum, top.saturating_sub(window(bits) as i32), bits)
}

/// The same in a window that ends at `2^top`, below which all terms lie, rounded once to `bits`.
#[inline]
pub fn sum_below<const N: usize>(terms: [Product; N], top: i32, bits: u32) -> SoftFloat {
    let unit = top.saturating_sub(window(bits) as i32);
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
    SoftFloat::from_wide(sum, top.saturating_sub(window(bits) as i32), bits)
}

#[cfg(test)]
mod tests;
