//! The kernel's integers on vectors, one splat or row per word; its normalised numbers are `Real`s (`real`).
//!
//! A right shift that rounds, `(v + 2^(s-1)) >> s`, is `((v >> (s-1)) + 1) >> 1` and cannot overflow, and a word of 0
//! needs no case of its own: it stays 0 under every shift.

use crate::fast::lanes::Lanes;
use splatline::format::Rounding;
use splatline::math::{LN_2, LOGARITHMS, REST, ROOTS, fraction};

/// `mantissa * 2^exponent` per word.
#[derive(Clone, Copy)]
pub struct Number<W: Lanes> {
    /// Its integers.
    pub mantissa: W::Word,
    /// Powers of two.
    pub exponent: W::Word,
}

/// A shift to the right that rounds, by the same amount in every word: two instructions a vector, where a shift with
/// the sign by an amount of each word's own is a dozen without AVX-512. What it leaves is too large by
/// [`Arithmetic::turn_of`], for the sign's sake: that goes into a constant which is added anyway.
#[derive(Clone, Copy)]
pub struct RoundingShift<W: Lanes> {
    /// Half of a unit and the turn.
    pub raise: W::Word,
    /// Bits that are dropped.
    pub by: W::Word,
}

/// The turn that makes signed words unsigned ones in their order, and back.
const TURN: i64 = i64::MIN;

/// Bits dropped of numbers that have room for a rounding: `shift_unsigned` without its cases.
#[derive(Clone, Copy, Debug)]
pub struct BitDrop {
    /// So many.
    pub by: u32,
    /// What is added to every number.
    pub half: u64,
    /// The bits of the result that are added.
    pub odd: u64,
}

impl BitDrop {
    /// By fewer than 64 bits.
    #[inline(always)]
    pub fn new(by: u32, rounding: Rounding) -> Self {
        let above = (1u64 << by) >> 1;
        let (half, odd) = match rounding {
            Rounding::Nearest => (above, 0),
            Rounding::NearestEven => (above.saturating_sub(1), above.min(1)),
            Rounding::Truncate => (0, 0),
        };
        BitDrop { by, half, odd }
    }

    /// The number without them.
    #[inline(always)]
    pub fn of(self, value: u64) -> u64 {
        (value + self.half + (value >> self.by & self.odd)) >> self.by
    }
}

/// 2^exponent, of exponents that a number may have.
#[inline(always)]
pub fn power(exponent: impl Into<i64>) -> f64 {
    f64::from_bits(((1023 + exponent.into()) as u64) << 52)
}

/// A vector of words.
pub type Word<W> = <W as Lanes>::Word;

/// The kernel's arithmetic on vectors. The design's widths come as arguments, constants for named designs.
pub trait Arithmetic: Lanes {
    /// `shift_round` by a constant.
    #[inline(always)]
    fn round(self, value: Self::Word, shift: u32) -> Self::Word {
        if shift == 0 {
            return value;
        }
        self.sar_by(self.plus(value, 1 << (shift - 1)), shift)
    }

    /// A shift to the right by so much.
    #[inline(always)]
    fn rounding_shift(self, by: Self::Word) -> RoundingShift<Self> {
        let half = self.shr_by(self.shl(self.splat(1), by), 1);
        RoundingShift {
            raise: self.plus(half, TURN),
            by,
        }
    }

    /// What [`Arithmetic::dropped`] by so much leaves too large.
    #[inline(always)]
    fn turn_of(self, drop: RoundingShift<Self>) -> Self::Word {
        self.shr(self.splat(TURN), drop.by)
    }

    /// `shift_round`, and [`turn_of`](Arithmetic::turn_of) the shift more. The turn does not reach the lower 32 bits if
    /// the shift is at most 31.
    #[inline(always)]
    fn dropped(self, value: Self::Word, drop: RoundingShift<Self>) -> Self::Word {
        self.shr(self.add(value, drop.raise), drop.by)
    }

    /// (value + more) >> by with the sign, `by` not 0, of words that are far from the end of theirs.
    #[inline(always)]
    fn floor(self, value: Self::Word, more: i64, by: u32) -> Self::Word {
        let raised = self.plus(value, TURN.wrapping_add(more));
        self.plus(self.shr_by(raised, by.into()), TURN >> by)
    }

    /// `shift_signed` where no left shift leaves the word: `value 2^-shift`, rounded. The shift of the other direction
    /// gives 0.
    #[inline(always)]
    fn align(self, value: Self::Word, shift: Self::Word) -> Self::Word {
        let above = self.sar(value, self.plus(shift, -1));
        let right = self.sar_by(self.plus(above, 1), 1);
        let left = self.shl(value, self.negate(shift));
        self.add(left, right)
    }

    /// `to_fixed`: fixed point with `fraction` bits, saturated.
    #[inline(always)]
    fn to_fixed(self, a: Number<Self>, fraction: u32) -> Self::Word {
        let zero = self.splat(0);
        let left = self.plus(a.exponent, fraction.into());
        let fixed = self.align(a.mantissa, self.negate(left));
        let room = self.leading_zeros(self.magnitude(a.mantissa));
        let end = self.select(
            self.splat(i64::MAX),
            self.splat(i64::MIN),
            self.greater(zero, a.mantissa),
        );
        let fits = self.greater(room, left);
        let saturated = self.select(end, fixed, fits);
        let nothing = self.equal(a.mantissa, zero);
        self.select(saturated, zero, nothing)
    }

    /// `root_seed` of positive numbers without a sign.
    #[inline(always)]
    fn root_seed(self, value: Self::Word) -> (Self::Word, Self::Word) {
        let even = self.masked(self.leading_zeros(value), !1);
        let normal = self.shl(value, even);
        let index = self.plus(self.shr_by(normal, 56), -64);
        let [low, high] = self.gather(&ROOTS, index);
        let rest = self.masked(self.shr_by(normal, 40), 0xffff);
        let step = self.round(self.mul(self.sub(high, low), rest), 16);
        (
            self.add(low, step),
            self.sub(self.splat(8), self.sar_by(even, 1)),
        )
    }

    /// 1/n - d times the rest of the series.
    #[inline(always)]
    fn bent(self, d: Self::Word, series: Self::Word, n: i64) -> Self::Word {
        let lost = self.round(self.mul(d, series), REST);
        self.sub(self.splat(fraction(n).into()), lost)
    }

    /// `ln` of x 2^leading with x in UQ1.30.
    #[inline(always)]
    fn ln(self, x: Self::Word, leading: Self::Word) -> Self::Word {
        let index = self.shl_by(self.masked(self.shr_by(x, 25), 31), 1);
        let [inverse, offset] = self.gather(&LOGARITHMS, index);
        let rest = self.plus(self.mul(x, inverse), -(1 << 46));
        let rest = self.round(rest, 46 - REST);
        let inner = self.bent(rest, self.splat(fraction(5).into()), 4);
        let inner = self.bent(rest, inner, 3);
        let inner = self.bent(rest, inner, 2);
        let curve = self.round(self.mul(rest, inner), 30);
        let curve = self.round(self.mul(rest, curve), 2 * REST - 40);
        let below = self.sub(self.shl_by(rest, i64::from(40 - REST)), curve);
        let end = self.splat(1 << 20);
        let leading = self.max(self.min(leading, end), self.negate(end));
        let octaves = self.mul_whole(leading, self.splat(LN_2));
        let sum = self.add(self.add(octaves, self.shl_by(offset, 8)), below);
        self.round(sum, 8)
    }
}

impl<L: Lanes> Arithmetic for L {}
