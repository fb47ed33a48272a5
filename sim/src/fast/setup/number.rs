//! The kernel's normalised numbers ([`SoftFloat`], [`Product`]) on vectors: one splat per word.
//!
//! Bit for bit what `splatline::math` computes, for exponents below 2^30: the kernel saturates sums of exponents at the ends of 32 bits,
//! 64-bit words do not reach them. Two identities replace branches. A right shift that rounds, `(v + 2^(s-1)) >> s`, is
//! `((v >> (s-1)) + 1) >> 1` and cannot overflow. And a product of 0 needs no case of its own: it stays 0 under every shift.
//!
//! [`Product`]: splatline::math::Product

use crate::fast::lanes::Wide;
use splatline::math::{LN_2, LOGARITHMS, RECIPROCALS, REST, ROOTS, SoftFloat, fraction};

/// `mantissa * 2^exponent` per word; also an exact product, whose mantissa has up to 62 bits.
#[derive(Clone, Copy)]
pub struct Number<W: Wide> {
    pub mantissa: W::Word,
    pub exponent: W::Word,
}

/// Arithmetic on [`Number`]s. The design's widths come as arguments, constants for named designs.
#[derive(Clone, Copy)]
pub struct Arithmetic<W: Wide> {
    pub lanes: W,
}

type Truth<W> = <W as Wide>::Truth;
type Word<W> = <W as Wide>::Word;

impl<W: Wide> Arithmetic<W> {
    #[inline(always)]
    pub fn splat(self, value: i64) -> Word<W> {
        self.lanes.wide_splat(value)
    }

    #[inline(always)]
    pub fn number(self, value: SoftFloat) -> Number<W> {
        Number {
            mantissa: self.splat(value.mantissa.into()),
            exponent: self.splat(value.exponent.into()),
        }
    }

    #[inline(always)]
    pub fn add(self, a: Word<W>, b: Word<W>) -> Word<W> {
        self.lanes.wide_add(a, b)
    }

    #[inline(always)]
    pub fn sub(self, a: Word<W>, b: Word<W>) -> Word<W> {
        self.lanes.wide_sub(a, b)
    }

    #[inline(always)]
    pub fn plus(self, a: Word<W>, b: i64) -> Word<W> {
        self.lanes.wide_add(a, self.splat(b))
    }

    #[inline(always)]
    pub fn negate(self, a: Word<W>) -> Word<W> {
        self.sub(self.splat(0), a)
    }

    #[inline(always)]
    pub fn select(self, a: Word<W>, b: Word<W>, truth: Truth<W>) -> Word<W> {
        self.lanes.wide_select(a, b, truth)
    }

    #[inline(always)]
    pub fn greater(self, a: Word<W>, b: Word<W>) -> Truth<W> {
        self.lanes.wide_greater(a, b)
    }

    #[inline(always)]
    pub fn min(self, a: Word<W>, b: Word<W>) -> Word<W> {
        self.select(a, b, self.greater(a, b))
    }

    #[inline(always)]
    pub fn max(self, a: Word<W>, b: Word<W>) -> Word<W> {
        self.select(a, b, self.greater(b, a))
    }

    #[inline(always)]
    pub fn magnitude(self, a: Word<W>) -> Word<W> {
        self.max(a, self.negate(a))
    }

    /// a >> by with the sign.
    #[inline(always)]
    pub fn sar(self, a: Word<W>, by: i64) -> Word<W> {
        self.lanes.wide_sar(a, self.splat(by))
    }

    #[inline(always)]
    pub fn shl(self, a: Word<W>, by: i64) -> Word<W> {
        self.lanes.wide_shl(a, self.splat(by))
    }

    #[inline(always)]
    pub fn shr(self, a: Word<W>, by: i64) -> Word<W> {
        self.lanes.wide_shr(a, self.splat(by))
    }

    #[inline(always)]
    pub fn and(self, a: Word<W>, mask: i64) -> Word<W> {
        self.lanes.wide_and(a, self.splat(mask))
    }

    #[inline(always)]
    pub fn mul(self, a: Word<W>, b: Word<W>) -> Word<W> {
        self.lanes.wide_mul(a, b)
    }

    /// `shift_round` by a constant.
    #[inline(always)]
    pub fn round(self, value: Word<W>, shift: u32) -> Word<W> {
        if shift == 0 {
            return value;
        }
        self.sar(self.plus(value, 1 << (shift - 1)), shift.into())
    }

    /// `shift_signed` where no left shift leaves the word: `value 2^-shift`, rounded.
    #[inline(always)]
    pub fn align(self, value: Word<W>, shift: Word<W>) -> Word<W> {
        let zero = self.splat(0);
        let above = self.lanes.wide_sar(value, self.plus(shift, -1));
        let right = self.sar(self.plus(above, 1), 1);
        let left = self.lanes.wide_shl(value, self.sub(zero, shift));
        self.select(left, right, self.greater(shift, zero))
    }

    /// Bits of a magnitude.
    #[inline(always)]
    fn length(self, value: Word<W>) -> Word<W> {
        let zeros = self.lanes.wide_leading_zeros(self.magnitude(value));
        self.sub(self.splat(64), zeros)
    }

    /// `SoftFloat::from_wide`.
    #[inline(always)]
    pub fn normalise(self, value: Number<W>, bits: u32) -> Number<W> {
        let shift = self.plus(self.length(value.mantissa), -i64::from(bits));
        let mantissa = self.align(value.mantissa, shift);
        let exponent = self.add(value.exponent, shift);
        // Rounded up to 2^bits: one bit too many.
        let full = self.shr(self.magnitude(mantissa), bits.into());
        let over = self.greater(full, self.splat(0));
        let mantissa = self.select(mantissa, self.sar(mantissa, 1), over);
        let exponent = self.select(exponent, self.plus(exponent, 1), over);
        let zero = self.lanes.wide_equal(value.mantissa, self.splat(0));
        Number {
            mantissa,
            exponent: self.select(exponent, self.splat(SoftFloat::ZERO.exponent.into()), zero),
        }
    }

    /// `SoftFloat::times`.
    #[inline(always)]
    pub fn times(self, a: Number<W>, b: Number<W>) -> Number<W> {
        Number {
            mantissa: self.mul(a.mantissa, b.mantissa),
            exponent: self.add(a.exponent, b.exponent),
        }
    }

    /// `SoftFloat::multiply`.
    #[inline(always)]
    pub fn multiply(self, a: Number<W>, b: Number<W>, bits: u32) -> Number<W> {
        self.normalise(self.times(a, b), bits)
    }

    /// The opposite of a number.
    #[inline(always)]
    pub fn opposite(self, a: Number<W>) -> Number<W> {
        Number {
            mantissa: self.negate(a.mantissa),
            ..a
        }
    }

    /// `sum_of_products`.
    #[inline(always)]
    pub fn sum<const N: usize>(self, terms: [Number<W>; N], bits: u32) -> Number<W> {
        const NONE: i64 = i32::MIN as i64;
        let zero = self.splat(0);
        let mut leading = self.splat(NONE);
        for term in terms {
            let end = self.add(term.exponent, self.length(term.mantissa));
            let nothing = self.lanes.wide_equal(term.mantissa, zero);
            let end = self.select(end, self.splat(NONE), nothing);
            leading = self.max(leading, end);
        }
        let unit = self.plus(leading, -60);
        let mut sum = zero;
        for term in terms {
            sum = self.add(
                sum,
                self.align(term.mantissa, self.sub(unit, term.exponent)),
            );
        }
        self.normalise(
            Number {
                mantissa: sum,
                exponent: unit,
            },
            bits,
        )
    }

    /// `to_fixed`: fixed point with `fraction` bits, saturated.
    #[inline(always)]
    pub fn to_fixed(self, a: Number<W>, fraction: u32) -> Word<W> {
        let zero = self.splat(0);
        let left = self.plus(a.exponent, fraction.into());
        let fixed = self.align(a.mantissa, self.negate(left));
        let room = self.lanes.wide_leading_zeros(self.magnitude(a.mantissa));
        let end = self.select(
            self.splat(i64::MAX),
            self.splat(i64::MIN),
            self.greater(zero, a.mantissa),
        );
        let fits = self.greater(room, left);
        let saturated = self.select(end, fixed, fits);
        let nothing = self.lanes.wide_equal(a.mantissa, zero);
        self.select(saturated, zero, nothing)
    }

    /// `SoftFloat::leading`.
    #[inline(always)]
    pub fn leading(self, a: Number<W>) -> Word<W> {
        self.plus(self.add(a.exponent, self.length(a.mantissa)), -1)
    }

    /// The magnitude moved up to bit 31.
    #[inline(always)]
    fn top(self, mantissa: Word<W>) -> Word<W> {
        let magnitude = self.magnitude(mantissa);
        let zeros = self.plus(self.lanes.wide_leading_zeros(magnitude), -32);
        self.lanes.wide_shl(magnitude, zeros)
    }

    /// `reciprocal` of numbers other than 0.
    #[inline(always)]
    pub fn reciprocal(self, value: Number<W>, bits: u32) -> Number<W> {
        let x = self.top(value.mantissa);
        let [low, high] = self
            .lanes
            .wide_gather(&RECIPROCALS, self.and(self.shr(x, 23), 0xff));
        let rest = self.and(x, 0x7f_ffff);
        let step = self.round(self.mul(self.sub(high, low), rest), 23);
        let seed = self.add(low, step);
        let coarse = self.shl(seed, 30);
        let result = if bits > 16 {
            let product = self.lanes.wide_mul_unsigned(x, seed);
            let defect = self.round(self.sub(self.splat(1 << 61), product), 14);
            self.add(coarse, self.round(self.mul(seed, defect), 17))
        } else {
            coarse
        };
        let negative = self.greater(self.splat(0), value.mantissa);
        let result = self.select(result, self.negate(result), negative);
        let exponent = self.sub(self.splat(-60), self.leading(value));
        self.normalise(
            Number {
                mantissa: result,
                exponent,
            },
            bits,
        )
    }

    /// `square_root`; 0 of numbers that are not positive.
    #[inline(always)]
    pub fn square_root(self, value: Number<W>, bits: u32) -> Number<W> {
        let zero = self.splat(0);
        let odd = self.and(value.exponent, 1);
        let half = self.sar(self.sub(value.exponent, odd), 1);
        let (root, shift) = self.root_seed(self.lanes.wide_shl(value.mantissa, odd));
        let seed = self.normalise(
            Number {
                mantissa: root,
                exponent: self.add(shift, half),
            },
            31,
        );
        let result = if bits <= 16 {
            self.normalise(seed, bits)
        } else {
            let inverse = self.reciprocal(seed, 31);
            let mut halved = seed;
            halved.exponent = self.plus(halved.exponent, -1);
            let mut quotient = self.times(value, inverse);
            quotient.exponent = self.plus(quotient.exponent, -1);
            self.sum([halved, quotient], bits)
        };
        let positive = self.greater(value.mantissa, zero);
        Number {
            mantissa: self.select(zero, result.mantissa, positive),
            exponent: self.select(
                self.splat(SoftFloat::ZERO.exponent.into()),
                result.exponent,
                positive,
            ),
        }
    }

    /// `root_seed` of positive numbers without a sign.
    #[inline(always)]
    pub fn root_seed(self, value: Word<W>) -> (Word<W>, Word<W>) {
        let even = self.and(self.lanes.wide_leading_zeros(value), !1);
        let normal = self.lanes.wide_shl(value, even);
        let index = self.plus(self.shr(normal, 56), -64);
        let [low, high] = self.lanes.wide_gather(&ROOTS, index);
        let rest = self.and(self.shr(normal, 40), 0xffff);
        let step = self.round(self.mul(self.sub(high, low), rest), 16);
        (
            self.add(low, step),
            self.sub(self.splat(8), self.sar(even, 1)),
        )
    }

    /// 1/n - d times the rest of the series.
    #[inline(always)]
    fn bent(self, d: Word<W>, series: Word<W>, n: i64) -> Word<W> {
        let lost = self.round(self.mul(d, series), REST);
        self.sub(self.splat(fraction(n).into()), lost)
    }

    /// `ln` of positive numbers.
    #[inline(always)]
    pub fn ln(self, value: Number<W>) -> Word<W> {
        let x = self.shr(self.top(value.mantissa), 1);
        let index = self.shl(self.and(self.shr(x, 25), 31), 1);
        let [inverse, offset] = self.lanes.wide_gather(&LOGARITHMS, index);
        let rest = self.plus(self.mul(x, inverse), -(1 << 46));
        let rest = self.round(rest, 46 - REST);
        let inner = self.bent(rest, self.splat(fraction(5).into()), 4);
        let inner = self.bent(rest, inner, 3);
        let inner = self.bent(rest, inner, 2);
        let curve = self.round(self.mul(rest, inner), 30);
        let curve = self.round(self.mul(rest, curve), 2 * REST - 40);
        let below = self.sub(self.shl(rest, i64::from(40 - REST)), curve);
        let end = self.splat(1 << 20);
        let leading = self.max(self.min(self.leading(value), end), self.negate(end));
        let octaves = self.lanes.wide_mul_whole(leading, self.splat(LN_2));
        let sum = self.add(self.add(octaves, self.shl(offset, 8)), below);
        self.round(sum, 8)
    }
}
