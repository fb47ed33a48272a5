//! Number formats: how many bits every quantity of the datapath has, in one place.
//!
//! Every stage is generic over [`Design`], which answers one question, "which widths?". A named design is a
//! zero-sized type whose answer is a constant, so that the compiler folds every shift (firmware, RTL
//! parameters); [`RuntimeWidths`] carries the answer in a field (sweeps on the host). The arithmetic is written once
//! and a test proves both bit-identical.
//!
//! # Conventions
//!
//! `Qm.n` is two's complement with `m` integer bits (sign not counted) and `n` fraction bits; `UQm.n` has no sign.
//! Results that are kept are rounded to nearest, halves towards positive infinity. In the pixel path (opacity,
//! transmittance, colour) [`Widths::rounding`] says how; truncation there shows as a darkening of deep stacks. Setup
//! and the interpolation of the footprint table always round to nearest, halves up.

use crate::blend::Blend;
use crate::rules::Rules;

/// What happens to the bits below a kept result in the pixel path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rounding {
    /// To nearest, halves up: no bias beyond half-way cases.
    Nearest,
    /// To nearest, halves to even: what a fused multiply-add of single precision does ([`blend`](crate::blend)). Sums
    /// have at most the 23 bits that one can add to ([`Widths::colour_range`]).
    NearestEven,
    /// Towards negative infinity: cheapest, with a bias of half a unit in the last place per operation.
    Truncate,
}

/// The way pixels of a footprint are visited.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Traversal {
    /// Every pixel of the bounding box, conic forward differencing (\[EWA\] 7.1.2, \[SURF\] 4).
    Box,
    /// Only each row's span, LDL forward differencing.
    Spans,
}

/// Widths of every quantity, in bits. "Fraction" counts bits right of the binary point.
///
/// A function that takes widths takes them as [checked](Widths::check), as a [`Design`] has them: its bounds rest on
/// that, and widths out of their ranges may end in an overflow. All other arguments may have any bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Widths {
    /// Magnitude bits of a splat's difference to the eye, and of the rotation by which it gets to camera space (8 to
    /// 60; above 30 both have two parts). Splats in fixed point do without ([`Translation`](crate::view::Translation)).
    pub position: u8,
    /// Magnitude bits of the mantissas that lead from camera space to a footprint's centre, and of centres in fixed
    /// point fraction bits of the rotation's entries (8 to 31; the rotation has at most 30).
    pub view: u8,
    /// Magnitude bits of every normalised mantissa of setup and of the row seeds (8 to 31). Sums keep
    /// [`GUARD`](crate::math::GUARD) bits more until they are rounded; axes and the rotation that turns them have
    /// [`axis_bits`](crate::setup::axis_bits).
    pub mantissa: u8,
    /// Fraction bits of a footprint's centre, in pixels (2 to 24).
    pub subpixel: u8,
    /// Fraction bits of the radial index in the pixel lanes (8 to 44; at most 27 for 32-bit lanes:
    /// [`check_for`](Widths::check_for)).
    pub radial: u8,
    /// Base-2 logarithm of the number of intervals of the footprint table (2 to 14, and at most `radial + 2`).
    pub table: u8,
    /// Bits of the interpolator's multiplier: fraction bits of the position within a table interval (0 to 20). 0 is no
    /// interpolation, the interval's own value.
    pub interpolation: u8,
    /// Fraction bits of a footprint table entry (4 to 28).
    pub weight: u8,
    /// Fraction bits of a footprint's peak opacity (4 to 28).
    pub peak: u8,
    /// Fraction bits of one splat's opacity at one pixel (4 to 28).
    pub alpha: u8,
    /// Fraction bits of the deep alpha channel, the pixel's transmittance (4 to 30).
    pub transmittance: u8,
    /// Fraction bits of a splat's colour (4 to 28).
    pub colour: u8,
    /// Fraction bits of the pixel's accumulated colour (4 to 27; at most 23 for [`Rounding::NearestEven`]).
    pub accumulator: u8,
    /// Rounding in the pixel path.
    pub rounding: Rounding,
}

/// A width outside its range: the field's name, the value and the range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WidthError {
    /// Name of the field of [`Widths`].
    pub field: &'static str,
    /// Value found.
    pub value: u8,
    /// Smallest and largest value allowed.
    pub range: (u8, u8),
}

/// Fields of [`Widths`] that hold a number, with their ranges.
pub const WIDTH_RANGES: [(&str, u8, u8); 13] = [
    ("position", 8, 60),
    ("view", 8, 31),
    ("mantissa", 8, 31),
    ("subpixel", 2, 24),
    ("radial", 8, 44),
    ("table", 2, 14),
    ("interpolation", 0, 20),
    ("weight", 4, 28),
    ("peak", 4, 28),
    ("alpha", 4, 28),
    ("transmittance", 4, 30),
    ("colour", 4, 28),
    ("accumulator", 4, 27),
];

impl Widths {
    /// The widths whose numeric fields are `numbers`, in the order of [`WIDTH_RANGES`]. They are not checked: see
    /// [`check`](Self::check).
    pub const fn from_numbers(numbers: [u8; 13], rounding: Rounding) -> Self {
        let [
            position,
            view,
            mantissa,
            subpixel,
            radial,
            table,
            interpolation,
            ..,
        ] = numbers;
        let [.., weight, peak, alpha, transmittance, colour, accumulator] = numbers;
        Widths {
            position,
            view,
            mantissa,
            subpixel,
            radial,
            table,
            interpolation,
            weight,
            peak,
            alpha,
            transmittance,
            colour,
            accumulator,
            rounding,
        }
    }

    /// The numeric fields, in the order of [`WIDTH_RANGES`].
    pub const fn numbers(&self) -> [u8; 13] {
        [
            self.position,
            self.view,
            self.mantissa,
            self.subpixel,
            self.radial,
            self.table,
            self.interpolation,
            self.weight,
            self.peak,
            self.alpha,
            self.transmittance,
            self.colour,
            self.accumulator,
        ]
    }

    /// Integer bits of colours and of their sums: 4, or what [`Rounding::NearestEven`] leaves of 23 bits for them.
    /// Brighter colours are cut to the largest below `2^colour_range`.
    pub const fn colour_range(&self) -> u8 {
        match self.rounding {
            Rounding::NearestEven if self.accumulator > 19 => 23u8.saturating_sub(self.accumulator),
            _ => 4,
        }
    }

    /// [`WIDTH_RANGES`] as the other widths and the rounding leave them: a table's interval is at least one step of the
    /// radial index, also where the table ends at 4; and single precision adds to [at most 23
    /// bits](Rounding::NearestEven).
    pub const fn ranges(&self) -> [(&'static str, u8, u8); 13] {
        let mut ranges = WIDTH_RANGES;
        if self.radial < ranges[TABLE].2 - 2 {
            ranges[TABLE].2 = self.radial + 2;
        }
        if let Rounding::NearestEven = self.rounding {
            ranges[ACCUMULATOR].2 = 23;
        }
        ranges
    }

    /// Are all widths within the [ranges](Self::ranges) for which the datapath's bounds hold?
    pub const fn check(&self) -> Result<(), WidthError> {
        self.check_within(self.ranges())
    }

    /// The same, and does the radial index fit lanes of `L`? Four integer bits, the sign and [`radial`](Self::radial)
    /// fraction bits must.
    pub const fn check_for<L: Lane>(&self) -> Result<(), WidthError> {
        let mut ranges = self.ranges();
        let most = L::BITS.saturating_sub(5);
        if most < ranges[RADIAL].2 as u32 {
            ranges[RADIAL].2 = most as u8;
        }
        self.check_within(ranges)
    }

    const fn check_within(&self, ranges: [(&'static str, u8, u8); 13]) -> Result<(), WidthError> {
        let numbers = self.numbers();
        let mut i = 0;
        while i < numbers.len() {
            let (field, low, high) = ranges[i];
            if numbers[i] < low || numbers[i] > high {
                return Err(WidthError {
                    field,
                    value: numbers[i],
                    range: (low, high),
                });
            }
            i += 1;
        }
        Ok(())
    }
}

/// Places in [`WIDTH_RANGES`].
const RADIAL: usize = 4;
const TABLE: usize = 5;
const ACCUMULATOR: usize = 12;

/// The word in which a pixel lane keeps the radial index and its differences.
///
/// Arithmetic wraps: the values that matter lie in `[0, 16)`, and differences that leave the word belong to
/// pixels outside the footprint, which are never visited after them.
pub trait Lane: Copy + core::fmt::Debug + PartialEq {
    /// Bits of the word.
    const BITS: u32;
    /// The low bits of `value`.
    fn from_wide(value: i64) -> Self;
    /// Sign-extended value.
    fn to_wide(self) -> i64;
    /// The value, 0 where it is negative.
    fn at_least_zero(self) -> u64;
    /// Sum modulo the word.
    fn add(self, other: Self) -> Self;
}

impl Lane for i32 {
    const BITS: u32 = i32::BITS;
    #[inline(always)]
    fn from_wide(value: i64) -> Self {
        value as i32
    }
    #[inline(always)]
    fn to_wide(self) -> i64 {
        self as i64
    }
    #[inline(always)]
    fn at_least_zero(self) -> u64 {
        // In 32 bits, which small processors compare in one instruction.
        u64::from(self.max(0) as u32)
    }
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.wrapping_add(other)
    }
}

impl Lane for i64 {
    const BITS: u32 = i64::BITS;
    #[inline(always)]
    fn from_wide(value: i64) -> Self {
        value
    }
    #[inline(always)]
    fn to_wide(self) -> i64 {
        self
    }
    #[inline(always)]
    fn at_least_zero(self) -> u64 {
        self.max(0) as u64
    }
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.wrapping_add(other)
    }
}

/// A complete choice of widths; the bounds of the whole datapath rest on their check.
///
/// A design of one's own states its lanes and its widths. Widths out of range, or lanes too narrow for them, do not
/// compile:
///
/// ```compile_fail
/// use splatline::format::{Design, Standard24, Widths};
///
/// #[derive(Clone, Copy)]
/// struct Mine;
/// impl Design for Mine {
///     type Lane = i32;
///     const FIXED: Option<Widths> = Some(Widths { radial: 30, ..Standard24::WIDTHS });
/// }
/// let widths = Mine.widths();
/// ```
///
/// With `radial: 27` it does. Neither does `Widths { radial: 8, table: 12, .. }`, nor an accumulator that its rounding
/// cannot have:
///
/// ```compile_fail
/// use splatline::format::{Design, Lean18, Widths};
///
/// #[derive(Clone, Copy)]
/// struct Mine;
/// impl Design for Mine {
///     type Lane = i32;
///     const FIXED: Option<Widths> = Some(Widths { accumulator: 24, ..Lean18::WIDTHS });
/// }
/// let widths = Mine.widths();
/// ```
///
/// Widths that are not known before run time are [`RuntimeWidths`].
pub trait Design: Copy {
    /// Word of the pixel lanes: `i32` needs `radial <= 27`.
    type Lane: Lane;
    /// The widths, `None` of [`RuntimeWidths`].
    const FIXED: Option<Widths>;
    /// The widths; inlined to a constant where they are fixed.
    #[inline(always)]
    fn widths(&self) -> Widths {
        const { fixed::<Self>() }
    }
}

/// The widths of a design that passed their check for its lanes.
const fn fixed<D: Design>() -> Widths {
    match D::FIXED {
        Some(widths) => {
            assert!(
                widths.check_for::<D::Lane>().is_ok(),
                "a width is out of its range (Widths::ranges), or lanes are too narrow for `radial`"
            );
            widths
        }
        None => panic!("widths chosen at run time are RuntimeWidths"),
    }
}

/// Widths chosen at run time; lanes are 64 bits wide unless told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RuntimeWidths<L = i64>(Widths, core::marker::PhantomData<L>);

impl RuntimeWidths {
    /// Checks the widths.
    pub const fn new(widths: Widths) -> Result<Self, WidthError> {
        RuntimeWidths::for_lanes(widths)
    }
}

impl<L: Lane> RuntimeWidths<L> {
    /// Checks the widths, also for lanes of `L`.
    pub const fn for_lanes(widths: Widths) -> Result<Self, WidthError> {
        match widths.check_for::<L>() {
            Ok(()) => Ok(RuntimeWidths(widths, core::marker::PhantomData)),
            Err(error) => Err(error),
        }
    }
}

impl<L: Lane> Design for RuntimeWidths<L> {
    type Lane = L;
    const FIXED: Option<Widths> = None;
    #[inline(always)]
    fn widths(&self) -> Widths {
        self.0
    }
}

/// What 1997-2003 hardware would have built: 8-bit opacity, box traversal, no interpolation, truncation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Classic8;

/// For microcontrollers: every product and sum of the pixel path, and every product of a row's seed, fits one word of
/// 32 bits, so that a processor without 64-bit multiplication (Cortex-M0+) needs one instruction for it. A
/// [`Renderer`](crate::Renderer) takes the loop of 32-bit words ([`Painter32`](crate::draw::Painter32)) by itself.
///
/// | product | bits |
/// |---|---|
/// | peak UQ4.14 x kernel UQ1.14 | 32 |
/// | transmittance UQ1.16 x opacity UQ1.15 | 31 |
/// | share UQ1.16 x colour UQ4.10 | 30 |
/// | table step UQ0.11 x position 17 | 28 |
/// | row seed: 15-bit mantissas | 31 |
///
/// The accumulated colour has as many fraction bits as share and colour together: nothing is rounded there, and nothing
/// shifted. 17 bits of position leave a half-word for the table's slope. Lanes end where the position ends (20 + 4 =
/// 7 + 17 bits), so that nothing is shifted there either.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Micro16;

/// 18-bit multipliers (one operand of 18, the other of at most 27 bits: one DSP slice of today's FPGAs). Every product
/// of its pixels is also one fused multiply-add of single precision, bit for bit ([`blend`](crate::blend)).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lean18;

/// At least as accurate as single precision on hard cases, but for three ends of formats (docs/error-analysis.md);
/// 32-bit pixel lanes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Standard24;

/// 31-bit magnitudes, 64-bit pixel lanes: the most accurate the formats allow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Deep32;

impl Classic8 {
    /// Widths of the design.
    pub const WIDTHS: Widths = Widths {
        position: 24,
        view: 20,
        mantissa: 16,
        subpixel: 8,
        radial: 12,
        table: 8,
        interpolation: 0,
        weight: 8,
        peak: 8,
        alpha: 8,
        transmittance: 8,
        colour: 8,
        accumulator: 8,
        rounding: Rounding::Truncate,
    };
}

impl Micro16 {
    /// Widths of the design.
    pub const WIDTHS: Widths = Widths {
        position: 30,
        view: 24,
        mantissa: 15,
        subpixel: 12,
        radial: 20,
        table: 7,
        interpolation: 17,
        weight: 14,
        peak: 14,
        alpha: 15,
        transmittance: 16,
        colour: 10,
        accumulator: 26,
        rounding: Rounding::Nearest,
    };
}

/// What the design's description states.
const _: () = {
    let w = Micro16::WIDTHS;
    assert!(4 + w.peak + w.weight <= 32 && w.transmittance + w.alpha <= 31);
    assert!(w.transmittance + 4 + w.colour <= 30 && 2 * w.mantissa < 32);
    assert!(w.accumulator == w.transmittance + w.colour);
    assert!(w.radial + 4 == w.table + w.interpolation);
};

impl Lean18 {
    /// Widths of the design.
    pub const WIDTHS: Widths = Widths {
        position: 30,
        view: 26,
        mantissa: 18,
        subpixel: 12,
        radial: 22,
        table: 10,
        interpolation: 13,
        weight: 18,
        peak: 18,
        alpha: 18,
        transmittance: 22,
        colour: 15,
        accumulator: 20,
        rounding: Rounding::NearestEven,
    };
}

/// What the design's description states.
const _: () = {
    let w = Lean18::WIDTHS;
    assert!(
        w.mantissa <= 18 && w.weight <= 18 && w.alpha <= 18 && w.colour + w.colour_range() <= 18
    );
    assert!(Blend::new(&w, &Rules::GAUSSIAN_3D).is_single());
};

impl Standard24 {
    /// Widths of the design.
    pub const WIDTHS: Widths = Widths {
        position: 48,
        view: 30,
        mantissa: 28,
        subpixel: 24,
        radial: 27,
        table: 12,
        interpolation: 15,
        weight: 26,
        peak: 28,
        alpha: 26,
        transmittance: 30,
        colour: 24,
        accumulator: 26,
        rounding: Rounding::Nearest,
    };
}

impl Deep32 {
    /// Widths of the design.
    pub const WIDTHS: Widths = Widths {
        position: 60,
        view: 31,
        mantissa: 31,
        subpixel: 24,
        radial: 44,
        table: 12,
        interpolation: 20,
        weight: 28,
        peak: 28,
        alpha: 28,
        transmittance: 30,
        colour: 24,
        accumulator: 27,
        rounding: Rounding::Nearest,
    };
}

impl Design for Classic8 {
    type Lane = i32;
    const FIXED: Option<Widths> = Some(Self::WIDTHS);
}

impl Design for Micro16 {
    type Lane = i32;
    const FIXED: Option<Widths> = Some(Self::WIDTHS);
}

impl Design for Lean18 {
    type Lane = i32;
    const FIXED: Option<Widths> = Some(Self::WIDTHS);
}

impl Design for Standard24 {
    type Lane = i32;
    const FIXED: Option<Widths> = Some(Self::WIDTHS);
}

impl Design for Deep32 {
    type Lane = i64;
    const FIXED: Option<Widths> = Some(Self::WIDTHS);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The longest table is as long as the radial index' two integer bits and its fraction, and never longer than all
    /// tables.
    #[test]
    fn tables_end_where_the_radial_index_does() {
        for radial in WIDTH_RANGES[RADIAL].1..=WIDTH_RANGES[RADIAL].2 {
            let widths = Widths {
                radial,
                ..Standard24::WIDTHS
            };
            let longest = WIDTH_RANGES[TABLE].2.min(radial + 2);
            assert_eq!(widths.ranges()[TABLE].2, longest);
        }
    }

    #[test]
    fn lanes_below_zero_are_zero() {
        assert_eq!(
            [-1i32, 0, 1, i32::MIN].map(Lane::at_least_zero),
            [0, 0, 1, 0]
        );
        assert_eq!(
            [-1i64, 0, 1, i64::MIN].map(Lane::at_least_zero),
            [0, 0, 1, 0]
        );
    }
}
