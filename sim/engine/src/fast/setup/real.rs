//! The kernel's normalised numbers ([`SoftFloat`], `Product`) as doubles: one splat per word.
//!
//! A number of at most 31 bits and a power of two is a double, a sum's leading-zero count is its exponent field, and
//! rounding to the design's bits is an addition and a mask. What makes this the kernel's arithmetic to the last bit:
//!
//! - *Products.* p = fl(a b) has 53 of at most 62 bits, and fma(a, b, -p) is exactly what it lost. Only the sign of
//!   that matters: numbers rounded down to 53 bits lie on the same side of every half of fewer bits as the exact ones
//!   ([`Reals::rounded`]).
//! - *Sums.* A window's unit is a power of two that follows from the factors' exponent fields, and a cut is a floor of
//!   the product in that unit: a whole number of at most 39 bits, as the sum of four is. Where factors have more bits
//!   together than a double, fma(a, b, -floor) is negative exactly if the rounding of the product carried it over a
//!   whole number.
//! - *Tables* (reciprocal, root, logarithm) are the kernel's, on its integers, which are the bits of the doubles.
//!
//! Exponents of doubles end where the kernel's do not: splats far from unit size are left to the kernel, or put in
//! doubt.

use super::number::{Arithmetic, Number, Word, power};
use crate::fast::lanes::Lanes;
use splatline::math::{GUARD, RECIPROCALS, ROOTS, SoftFloat};
use std::cell::Cell;

/// A double per splat.
#[derive(Clone, Copy)]
pub struct Real<W: Lanes>(pub Word<W>);

/// Integers below this magnitude are converted by an addition.
const SHORT: f64 = (1u64 << 51) as f64;

/// 2^52 + 2^51: what lies around it has its units in the last place.
const MAGIC: f64 = 1.5 * (1u64 << 52) as f64;

/// Bits of a double's fraction and the one before it.
const DOUBLE: u32 = 53;

/// A number far below all others: a quarter of the window of a sum of zeros, whose unit still has an inverse.
const NOTHING: f64 = f64::from_bits((1023 - 962) << 52);

/// The bits of a double above those of its fraction.
const EXPONENT: i64 = 52;

/// Where a double's exponent is.
const EXPONENT_FIELD: i64 = 0x7ff << EXPONENT;

/// 1.0's exponent field.
const BIAS: i64 = 1023;

/// A term of a sum: a product, or a number alone.
#[derive(Clone, Copy)]
pub struct Term<W: Lanes> {
    a: Word<W>,
    b: Option<Word<W>>,
    /// May the factors have more bits together than a double?
    long: bool,
}

/// Arithmetic on [`Real`]s.
#[derive(Clone, Copy)]
pub struct Reals<'a, W: Lanes> {
    pub lanes: W,
    /// Not 0 where a result may not be the kernel's.
    pub doubt: &'a Cell<Word<W>>,
}

impl<W: Lanes> Reals<'_, W> {
    /// The same number in every word.
    #[inline(always)]
    pub fn constant(self, value: f64) -> Word<W> {
        self.lanes.splat(value.to_bits() as i64)
    }

    /// A number of the kernel in every word.
    #[inline(always)]
    pub fn number(self, value: SoftFloat) -> Real<W> {
        let field = BIAS + i64::from(value.exponent.clamp(-900, 900));
        let power = f64::from_bits((field << EXPONENT) as u64);
        Real(self.constant(f64::from(value.mantissa) * power))
    }

    /// Puts splats in doubt where the word is not 0.
    #[inline(always)]
    pub fn doubt_where(self, word: Word<W>) {
        self.doubt.set(self.lanes.or(self.doubt.get(), word));
    }

    /// Puts splats in doubt unless it is true.
    #[inline(always)]
    fn doubt_unless(self, truth: W::Truth) {
        let lanes = self.lanes;
        // All bits: that is the comparison's own word.
        self.doubt_where(lanes.select(lanes.splat(-1), lanes.splat(0), truth));
    }

    /// Puts splats in doubt unless the number is greater than `least`.
    #[inline(always)]
    pub fn doubt_unless_greater(self, number: Word<W>, least: f64) {
        self.doubt_unless((self.lanes).double_greater(number, self.constant(least)));
    }

    /// Puts splats in doubt unless the number is less than `most`.
    #[inline(always)]
    pub fn doubt_unless_less(self, number: Word<W>, most: f64) {
        self.doubt_unless((self.lanes).double_greater(self.constant(most), number));
    }

    /// |a|.
    #[inline(always)]
    pub fn magnitude(self, a: Real<W>) -> Real<W> {
        Real(self.lanes.masked(a.0, i64::MAX))
    }

    /// -a.
    #[inline(always)]
    pub fn opposite(self, a: Real<W>) -> Real<W> {
        let sign = self.lanes.splat(i64::MIN);
        Real(self.lanes.xor(a.0, sign))
    }

    /// Is it 0?
    #[inline(always)]
    pub fn is_zero(self, a: Real<W>) -> W::Truth {
        let lanes = self.lanes;
        lanes.equal(self.magnitude(a).0, lanes.splat(0))
    }

    /// Not 0 where the sign is that of negative numbers.
    #[inline(always)]
    pub fn sign(self, a: Word<W>) -> Word<W> {
        self.lanes.shr_by(a, 63)
    }

    /// `value` to `bits` bits, to nearest, halves towards positive infinity, where the truth lies beside `value` in the
    /// direction `error`.
    #[inline(always)]
    fn rounded(self, value: Word<W>, error: Word<W>, bits: u32) -> Real<W> {
        let lanes = self.lanes;
        let half = 1i64 << (EXPONENT - i64::from(bits));
        // Magnitudes grow at a half unless that lies below 0, or the truth lies below the half.
        let towards_zero = self.sign(lanes.xor(value, error));
        let sum = lanes.add(value, lanes.sub(lanes.splat(half), towards_zero));
        Real(lanes.masked(sum, -2 * half))
    }

    /// `Product::normalise` of an exact number.
    #[inline(always)]
    pub fn narrow(self, a: Real<W>, bits: u32) -> Real<W> {
        self.rounded(a.0, self.lanes.splat(0), bits)
    }

    /// A product, rounded to a double.
    #[inline(always)]
    pub fn times(self, a: Real<W>, b: Real<W>) -> Real<W> {
        Real(self.lanes.double_mul(a.0, b.0))
    }

    /// A product as a term of a sum, of factors with so many bits together.
    #[inline(always)]
    pub fn product(self, a: Real<W>, b: Real<W>, length: u32) -> Term<W> {
        Term {
            a: a.0,
            b: Some(b.0),
            long: length > DOUBLE,
        }
    }

    /// A number as a term of a sum.
    #[inline(always)]
    pub fn term(self, a: Real<W>) -> Term<W> {
        Term {
            a: a.0,
            b: None,
            long: false,
        }
    }

    /// A product with a power of two.
    #[inline(always)]
    pub fn scaled(self, a: Real<W>, power: f64) -> Real<W> {
        self.times(a, Real(self.constant(power)))
    }

    /// `SoftFloat::multiply`.
    #[inline(always)]
    pub fn multiply(self, a: Real<W>, b: Real<W>, bits: u32) -> Real<W> {
        let lanes = self.lanes;
        let product = lanes.double_mul(a.0, b.0);
        let error = lanes.double_mul_sub(a.0, b.0, product);
        self.rounded(product, error, bits)
    }

    /// The power of two below a number's magnitude; 0 of 0.
    #[inline(always)]
    fn leading(self, a: Word<W>) -> Word<W> {
        self.lanes.masked(a, EXPONENT_FIELD)
    }

    /// A quarter of the end of a term's format.
    #[inline(always)]
    fn quarter(self, term: Term<W>) -> Word<W> {
        let leading = self.leading(term.a);
        let other = match term.b {
            Some(b) => self.leading(b),
            None => self.constant(0.5),
        };
        self.lanes.double_mul(leading, other)
    }

    /// A term in units of 1/inverse, a power of two, rounded down.
    #[inline(always)]
    fn cut(self, term: Term<W>, inverse: Word<W>) -> Word<W> {
        let lanes = self.lanes;
        let a = lanes.double_mul(term.a, inverse);
        let Some(b) = term.b else {
            return lanes.double_floor(a);
        };
        let floor = lanes.double_floor(lanes.double_mul(a, b));
        if !term.long {
            return floor;
        }
        let above = lanes.double_mul_sub(a, b, floor);
        let carried = lanes.double_greater(self.lanes.splat(0), above);
        let one = lanes.select(self.lanes.splat(0), self.constant(1.0), carried);
        lanes.double_sub(floor, one)
    }

    /// `sum_of_products`, in units of a power of two that comes with it.
    #[inline(always)]
    fn window(self, terms: &[Term<W>], bits: u32) -> (Word<W>, Word<W>) {
        let lanes = self.lanes;
        let mut top = self.constant(NOTHING);
        for term in terms {
            top = lanes.double_max(top, self.quarter(*term));
        }
        let unit = lanes.double_mul(top, self.constant(4.0 / power(bits + GUARD)));
        (self.cuts(terms, unit), unit)
    }

    /// The sum of terms cut to a unit, a power of two.
    #[inline(always)]
    pub fn cuts(self, terms: &[Term<W>], unit: Word<W>) -> Word<W> {
        let lanes = self.lanes;
        // A power of two has an empty fraction, so that this is its inverse.
        let inverse = lanes.sub(lanes.splat((2 * BIAS) << EXPONENT), unit);
        let mut sum = self.cut(terms[0], inverse);
        for term in &terms[1..] {
            sum = lanes.double_add(sum, self.cut(*term, inverse));
        }
        sum
    }

    /// `sum_of_products`.
    #[inline(always)]
    pub fn sum(self, terms: impl AsRef<[Term<W>]>, bits: u32) -> Real<W> {
        let (sum, unit) = self.window(terms.as_ref(), bits);
        self.times(self.narrow(Real(sum), bits), Real(unit))
    }

    /// Where `sum_of_products` is positive.
    #[inline(always)]
    pub fn sum_is_positive(self, terms: [Term<W>; 3], bits: u32) -> W::Truth {
        let (sum, _) = self.window(&terms, bits);
        self.lanes.double_greater(sum, self.lanes.splat(0))
    }

    /// 2^exponent.
    #[inline(always)]
    pub fn power(self, exponent: Word<W>) -> Real<W> {
        Real(self.lanes.shl_by(self.lanes.plus(exponent, BIAS), EXPONENT))
    }

    /// Exponent field of a number that is not negative.
    #[inline(always)]
    fn field_of_positive(self, a: Real<W>) -> Word<W> {
        self.lanes.shr_by(a.0, EXPONENT)
    }

    /// Exponent field of a number.
    #[inline(always)]
    fn field(self, a: Real<W>) -> Word<W> {
        self.lanes.shr_by(self.lanes.shl_by(a.0, 1), EXPONENT + 1)
    }

    /// `SoftFloat::from_wide` of integers in words, times `power`.
    #[inline(always)]
    pub fn wide(self, value: Word<W>, power: Real<W>, bits: u32) -> Real<W> {
        // Upper and lower half as fractions of 2^84 and 2^52.
        const UPPER: f64 = (1u128 << 84) as f64;
        const LOWER: f64 = (1u64 << 52) as f64;
        const TURNED: f64 = (1u64 << 63) as f64;
        let lanes = self.lanes;
        let unsigned = lanes.xor(value, lanes.splat(i64::MIN));
        let upper = lanes.or(lanes.shr_by(unsigned, 32), self.constant(UPPER));
        let upper = lanes.double_sub(upper, self.constant(UPPER + TURNED));
        let lower = lanes.or(lanes.masked(value, 0xffff_ffff), self.constant(LOWER));
        let lower = lanes.double_sub(lower, self.constant(LOWER));
        let sum = lanes.double_add(upper, lower);
        let error = lanes.double_sub(lower, lanes.double_sub(sum, upper));
        self.times(self.rounded(sum, error, bits), power)
    }

    /// Integers of at most 51 bits.
    #[inline(always)]
    pub fn short(self, value: Word<W>) -> Real<W> {
        let magic = self.constant(MAGIC);
        let lanes = self.lanes;
        Real(lanes.double_sub(self.lanes.add(value, magic), magic))
    }

    /// Whole numbers of at most 51 bits; others are in doubt.
    #[inline(always)]
    pub fn to_word(self, whole: Word<W>) -> Word<W> {
        self.doubt_unless_less(self.magnitude(Real(whole)).0, SHORT);
        self.to_short_word(whole)
    }

    /// Whole numbers of at most 51 bits.
    #[inline(always)]
    pub fn to_short_word(self, whole: Word<W>) -> Word<W> {
        let magic = self.constant(MAGIC);
        let sum = self.lanes.double_add(whole, magic);
        self.lanes.sub(sum, magic)
    }

    /// `SoftFloat::to_fixed` with the unit `1 / scale`, a power of two, as a whole number.
    #[inline(always)]
    pub fn to_fixed(self, a: Real<W>, scale: f64) -> Word<W> {
        let half = self.constant(0.5);
        let lanes = self.lanes;
        lanes.double_floor(lanes.double_mul_add(a.0, self.constant(scale), half))
    }

    /// `Product::to_fixed` with the unit `1 / scale`, a power of two, as a whole number below 2^51; others are in
    /// doubt.
    #[inline(always)]
    pub fn times_to_fixed(self, a: Real<W>, b: Real<W>, scale: f64) -> Word<W> {
        let lanes = self.lanes;
        let product = lanes.double_mul(a.0, b.0);
        let error = lanes.double_mul_sub(a.0, b.0, product);
        let scaled = lanes.double_mul(product, self.constant(scale));
        let raised = lanes.double_add(scaled, self.constant(0.5));
        let whole = lanes.double_floor(raised);
        // Whole only because the product, or the sum, was rounded up?
        let half = lanes.double_sub(whole, self.constant(0.5));
        let rounded = lanes.or(error, lanes.double_sub(scaled, half));
        let exact = lanes.equal(whole, raised);
        let below = lanes.select(lanes.splat(0), self.sign(rounded), exact);
        lanes.sub(self.to_word(whole), below)
    }

    /// Mantissa of so many bits and exponent of numbers other than 0.
    #[inline(always)]
    pub fn parts(self, a: Real<W>, bits: u32) -> Number<W> {
        let lanes = self.lanes;
        let fraction = lanes.masked(a.0, (1 << EXPONENT) - 1);
        let whole = lanes.or(fraction, lanes.splat(1 << EXPONENT));
        let magnitude = lanes.shr_by(whole, EXPONENT + 1 - i64::from(bits));
        let negative = lanes.negate(self.sign(a.0));
        let mantissa = lanes.sub(lanes.xor(magnitude, negative), negative);
        Number {
            mantissa,
            exponent: self.exponent(a, bits),
        }
    }

    /// The other way round, of mantissas of at most 51 bits; 0 with any exponent.
    #[inline(always)]
    pub fn of_parts(self, number: Number<W>) -> Real<W> {
        let lanes = self.lanes;
        let scaled = self.times(self.short(number.mantissa), self.power(number.exponent));
        let nothing = lanes.equal(number.mantissa, lanes.splat(0));
        Real(lanes.select(scaled.0, lanes.splat(0), nothing))
    }

    /// Exponent of a mantissa of so many bits.
    #[inline(always)]
    pub fn exponent(self, a: Real<W>, bits: u32) -> Word<W> {
        let above = BIAS + i64::from(bits) - 1;
        self.lanes.plus(self.field(a), -above)
    }

    /// `shift_round` of at most 62 bits: with the sign, which AVX2 cannot shift, moved out of the way.
    #[inline(always)]
    fn shift_round(self, value: Word<W>, shift: u32) -> Word<W> {
        const ABOVE: i64 = 1 << 62;
        let lanes = self.lanes;
        let raised = lanes.plus(value, ABOVE + (1 << (shift - 1)));
        lanes.plus(lanes.shr_by(raised, shift.into()), -(ABOVE >> shift))
    }

    /// The leading 32 bits of positive numbers, which have no more.
    #[inline(always)]
    fn top(self, a: Real<W>) -> Word<W> {
        let lanes = self.lanes;
        let fraction = lanes.masked(lanes.shr_by(a.0, EXPONENT - 31), (1 << 31) - 1);
        lanes.or(fraction, lanes.splat(1 << 31))
    }

    /// `reciprocal` of positive numbers.
    #[inline(always)]
    pub fn reciprocal(self, value: Real<W>, bits: u32) -> Real<W> {
        let lanes = self.lanes;
        let x = self.top(value);
        let [low, high] = lanes.gather(&RECIPROCALS, lanes.masked(lanes.shr_by(x, 23), 0xff));
        let rest = lanes.masked(x, 0x7f_ffff);
        let step = lanes.mul(lanes.sub(high, low), rest);
        let seed = lanes.add(low, self.shift_round(step, 23));
        let coarse = lanes.shl_by(seed, 30);
        let result = if bits > 16 {
            let product = lanes.mul_unsigned(x, seed);
            let defect = self.shift_round(lanes.sub(lanes.splat(1 << 61), product), 14);
            lanes.add(coarse, self.shift_round(lanes.mul(seed, defect), 17))
        } else {
            coarse
        };
        // 1/x lies in (1/2, 1], so that its leading bit is known.
        let drop = 60 - i64::from(bits);
        let mantissa = lanes.shr_by(lanes.plus(result, 1 << (drop - 1)), drop);
        let field = self.field_of_positive(value);
        let power = lanes.sub(lanes.splat(2 * BIAS - i64::from(bits)), field);
        let power = Real(lanes.shl_by(power, EXPONENT));
        self.times(self.short(mantissa), power)
    }

    /// `square_root`; 0 of numbers that are not positive.
    #[inline(always)]
    pub fn square_root(self, value: Real<W>, bits: u32) -> Real<W> {
        let lanes = self.lanes;
        let field = self.field(value);
        let fraction = lanes.masked(value.0, (1 << EXPONENT) - 1);
        let whole = lanes.or(fraction, lanes.splat(1 << EXPONENT));
        // Of 53 bits, in [1/4, 1): the leading bit is the first or the second one.
        let normal = lanes.shr(whole, lanes.masked(field, 1));
        let index = lanes.plus(lanes.shr_by(normal, 45), -64);
        let [low, high] = lanes.gather(&ROOTS, index);
        let rest = lanes.masked(lanes.shr_by(normal, 29), 0xffff);
        let step = lanes.plus(lanes.mul(lanes.sub(high, low), rest), 1 << 15);
        let root = lanes.add(low, lanes.shr_by(step, 16));
        // Half of the exponent, and the root's 24 bits.
        let half = lanes.plus(lanes.shr_by(lanes.plus(field, 1), 1), BIAS - 511 - 24);
        let half = Real(lanes.shl_by(half, EXPONENT));
        let seed = self.times(self.short(root), half);
        let result = if bits <= 16 {
            self.narrow(seed, bits)
        } else {
            let inverse = self.reciprocal(seed, 31);
            // `sum_below` the seed's end, of halves.
            let terms = [self.term(seed), self.product(value, inverse, bits + 31)];
            let unit = lanes.double_mul(
                self.leading(seed.0),
                self.constant(4.0 / power(bits + GUARD)),
            );
            let twice = self.narrow(Real(self.cuts(&terms, unit)), bits);
            self.scaled(self.times(twice, Real(unit)), 0.5)
        };
        let positive = lanes.double_greater(value.0, lanes.splat(0));
        Real(lanes.select(lanes.splat(0), result.0, positive))
    }

    /// `ln` of positive numbers.
    #[inline(always)]
    pub fn ln(self, value: Real<W>) -> Word<W> {
        let leading = self.lanes.plus(self.field_of_positive(value), -BIAS);
        self.lanes
            .ln(self.lanes.shr_by(self.top(value), 1), leading)
    }
}
