//! Seeds of `spans`: where the sequences of a block of rows, and of the lanes along a row, begin, from a footprint's
//! LDL form.
//!
//! A sequence of second order is differenced from a seed at every multiple of [`BLOCK`] rows or columns, in formats
//! that the head of `spans.rs` lists. Both kinds of seeds are two products each and balanced alike, which bounds what a
//! block's steps add up to.

use super::Quadratic;
use crate::footprint::{Footprint, Ldl};
use crate::format::{Design, Lane, Widths};
use crate::math::words::{rounded_down, shift_word};
use crate::math::{SoftFloat, shift_round, shift_signed};

/// Columns between two seeds of the radial index within a row, and rows between two seeds of the rows.
pub const BLOCK: u16 = 32;

/// Bits of A and C below their sequence's unit from which the seeds are balanced.
pub const GUARD: u32 = 8;

/// Fraction bits of C dy^2 down the rows: 4 more than the lanes have, and as many at least as 32 bits hold.
pub const fn vertical_fraction(widths: &Widths) -> u32 {
    let radial = widths.radial as u32;
    4 + if radial > 22 { radial } else { 22 }
}

/// Fraction bits of xc down the rows of one footprint, see the module's head; `half` is its [`reach_of_rows`].
pub(super) const fn centre_fraction(subpixel: u32, half: i32, shear: SoftFloat) -> u32 {
    if half > 13 || shear.leading() > 12 {
        subpixel.saturating_sub(2)
    } else {
        subpixel + 8
    }
}

/// |dx|^2 <= 16 / A < 2^(leading + 5), hence |dx| < 2^reach in pixels within a row.
pub(super) const fn reach_of_rows(squared_width: SoftFloat) -> i32 {
    squared_width.leading().saturating_add(6) >> 1
}

/// What the seeds of a footprint's blocks of rows are computed from.
#[derive(Clone, Copy, Debug)]
pub(super) struct RowSeeds {
    /// Centre, Q.subpixel.
    pub(super) centre: [i64; 2],
    pub(super) shear: SoftFloat,
    pub(super) vertical: SoftFloat,
    /// Fraction bits of xc that are not 0 in Q.32.
    pub(super) centre_fraction: u32,
    /// S in Q.32.
    pub(super) shear_per_row: i64,
    pub(super) balance: Balance,
}

impl RowSeeds {
    #[cfg_attr(not(target_pointer_width = "32"), inline(always))]
    #[cfg_attr(target_pointer_width = "32", inline)]
    pub(super) fn new(widths: &Widths, footprint: &Footprint, centre_fraction: u32) -> Self {
        let ldl = &footprint.ldl;
        let vertical_fraction = vertical_fraction(widths);
        RowSeeds {
            centre: footprint.centre,
            shear: ldl.shear,
            vertical: ldl.vertical,
            centre_fraction,
            shear_per_row: in_q32(ldl.shear.to_fixed(centre_fraction), centre_fraction),
            balance: Balance::new(ldl.vertical.to_fixed(vertical_fraction + GUARD)),
        }
    }

    /// xc - 1/2 (Q.32) and C dy^2 in row `y`, where a block begins.
    #[cfg_attr(not(target_pointer_width = "32"), inline(always))]
    #[cfg_attr(target_pointer_width = "32", inline(never))]
    pub(super) fn at<D: Design>(&self, design: D, y: u16) -> (i64, Quadratic) {
        let widths = design.widths();
        let (subpixel, bits) = (u32::from(widths.subpixel), u32::from(widths.mantissa));
        let fraction = self.centre_fraction;
        let half = 1i64 << (subpixel - 1);
        let dy = ((2 * i64::from(y) + 1) << (subpixel - 1)).wrapping_sub(self.centre[1]);
        let dy = SoftFloat::from_wide(dy, -(subpixel as i32), bits);
        let centre = shift_signed(
            self.centre[0].wrapping_sub(half),
            subpixel as i32 - fraction as i32,
        );
        let moved = self.shear.times_within(dy, 2 * bits).to_fixed(fraction);
        let along = self.vertical.times_within(dy, 2 * bits).normalise(bits);
        let Balance {
            second,
            unit,
            start,
        } = self.balance;
        let fine = vertical_fraction(&widths);
        let value = along.times_within(dy, 2 * bits).to_fixed(fine);
        let first = along.scaled_by(1).to_fixed(fine);
        let vertical = Quadratic {
            value: value.wrapping_add(start),
            first: first.wrapping_add(unit),
            second,
        };
        (in_q32(centre.wrapping_add(moved), fraction), vertical)
    }
}

/// The low word of [`rounded_down`], of which the upper has nothing: one word of shifts.
#[inline(always)]
pub(super) const fn rounded_to_word(value: i64, shift: u32) -> i32 {
    let by = shift.wrapping_sub(1);
    if by >= 32 {
        return rounded_down(value, shift) as i32;
    }
    // Two shifts, because one by 32 is not defined.
    let above = (((value >> 32) as u32) << 1).wrapping_shl(31 - by);
    let halves = (value as u32).wrapping_shr(by) | above;
    (halves as i32).wrapping_add(1) >> 1
}

/// `a b 2^-cut` rounded down, for numbers of at most 18 bits and a sign: two products of words. What is cut off does
/// not matter to a rounding of more bits, halves up.
#[inline(always)]
const fn product_above(a: i32, b: i32, cut: u32) -> i32 {
    let below = (a & ((1 << cut) - 1)).wrapping_mul(b) >> cut;
    (a >> cut).wrapping_mul(b).wrapping_add(below)
}

/// A number of pixels with `fraction` (at most 32) fraction bits in Q.32; what leaves the word is lost.
pub(super) const fn in_q32(value: i64, fraction: u32) -> i64 {
    value << (32u32.saturating_sub(fraction) & 63)
}

/// Seeds of the lanes: r and its first difference at a column by two multiplications.
///
/// dx is held in as many bits as the mantissa has: its unit is a power of two that follows from the footprint's
/// largest half-width, so that all alignments are constants of the footprint.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seed<D: Design> {
    pub(super) design: D,
    pub(super) horizontal: i64,
    /// Right shifts: dx from Q.32, r and its difference to Q.fraction.
    pub(super) drop_dx: u32,
    pub(super) drop_radial: i32,
    pub(super) drop_first: i32,
    pub(super) balance: Balance,
    pub(super) second: D::Lane,
}

/// The constants of a footprint's seeds along rows (of A) or down them (of C): what is added up stays within
/// `BLOCK^2 / 32` units of A dx^2.
///
/// With the lanes' horizontal factor second/2 = A + e, the sum n first + n (n - 1) second/2 exceeds the truth by e n^2
/// if first is 2 A dx + second/2. Here first is smaller by e BLOCK and the start larger by e BLOCK^2/8, which leaves e
/// (n^2 - n BLOCK + BLOCK^2/8).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Balance {
    /// 2 A to the nearest unit of the sequence.
    pub(super) second: i64,
    /// Added to 2 A dx for the first difference: second/2 - e BLOCK.
    pub(super) unit: i64,
    /// Added to r: e BLOCK^2/8.
    pub(super) start: i64,
}

impl Balance {
    /// `fine` is A with [`GUARD`] bits below the sequence's unit; wraps where A saturates, beyond any footprint of two
    /// adjacent pixels.
    pub(super) fn new(fine: i64) -> Self {
        let block = i32::from(BLOCK);
        let second = shift_round(fine, GUARD - 1);
        let rounded = second << (GUARD - 1);
        // At most half of `2^(GUARD - 1)`, in a word.
        let excess = rounded.wrapping_sub(fine) as i32;
        let start = excess.wrapping_mul(block * block / 8);
        Balance {
            second,
            unit: shift_round(
                rounded.wrapping_sub(excess.wrapping_mul(block).into()),
                GUARD,
            ),
            start: shift_word(start, GUARD as i32).into(),
        }
    }
}

impl<D: Design> Seed<D> {
    #[cfg_attr(not(target_pointer_width = "32"), inline(always))]
    pub(super) fn new(design: D, ldl: &Ldl, half: i32, unit_of_centre: u32) -> Self {
        let widths = design.widths();
        let (bits, fraction) = (u32::from(widths.mantissa), u32::from(widths.radial));
        // No finer than xc is.
        let drop_dx = half
            .saturating_add(32 - bits as i32)
            .min(63)
            .max(unit_of_centre as i32);
        let power = ldl.horizontal.exponent.clamp(-1024, 1024) + drop_dx - 32;
        let balance = Balance::new(ldl.horizontal.to_fixed(fraction + GUARD));
        Seed {
            design,
            horizontal: ldl.horizontal.mantissa.into(),
            drop_dx: drop_dx as u32,
            drop_radial: -(power + drop_dx - 32 + bits as i32 + fraction as i32),
            drop_first: -(power + 1 + fraction as i32),
            balance,
            second: D::Lane::from_wide(balance.second),
        }
    }

    /// Do the lanes fit a word, and the products of a seed one or [two](product_above) words? Then they are 32-bit
    /// products, with the same bits for every footprint of setup: |dx| is below `2^bits` within its rows.
    #[inline(always)]
    pub(super) fn is_narrow(&self) -> bool {
        self.design.widths().mantissa <= 18 && D::Lane::BITS == 32
    }

    /// Does C dy^2 fit a signed word as well, within the box of a footprint of setup?
    #[inline(always)]
    fn is_narrow_down(&self) -> bool {
        self.is_narrow() && vertical_fraction(&self.design.widths()) <= 26
    }

    /// What a row leaves of the cut-off, in the unit of C dy^2.
    #[inline(always)]
    pub(super) fn rest(&self, reach: i64, vertical: i64) -> i64 {
        if self.is_narrow_down() {
            return (reach as i32).wrapping_sub(vertical as i32).into();
        }
        reach.wrapping_sub(vertical)
    }

    /// C dy^2 brought to the lanes' unit, and what balances a run added.
    #[inline(always)]
    pub(super) fn down(&self, vertical: i64) -> i64 {
        let widths = self.design.widths();
        let drop = vertical_fraction(&widths) - u32::from(widths.radial);
        if self.is_narrow_down() {
            let down = shift_word(vertical as i32, drop as i32);
            return (self.balance.start as i32).wrapping_add(down).into();
        }
        self.balance.start.wrapping_add(shift_round(vertical, drop))
    }

    /// r = A dx^2 + C dy^2, its difference A (2 dx + 1) and 2 A at column `x`, balanced; `centre` is xc - 1/2 in Q.32,
    /// `down` the row's [`Seed::down`].
    #[inline(always)]
    pub(super) fn at(&self, x: u16, centre: i64, down: i64) -> (D::Lane, D::Lane, D::Lane) {
        let dx = (i64::from(x) << 32).wrapping_sub(centre);
        let bits = u32::from(self.design.widths().mantissa);
        // Of a footprint of setup |A dx| is below 2^36 and A dx^2 below 2^(26 + drop), where drop is 7 to 9.
        let (along_cut, across_cut) = (5, 6);
        let split = (7..32).contains(&self.drop_radial) && (6..32).contains(&self.drop_first);
        if self.is_narrow() && bits > 15 && split {
            let dx = rounded_to_word(dx, self.drop_dx);
            let along = product_above(self.horizontal as i32, dx, along_cut);
            let rounded = shift_word(along, (bits - along_cut) as i32);
            let across = product_above(rounded, dx, across_cut);
            let radial = shift_word(across, self.drop_radial - across_cut as i32);
            let first = shift_word(along, self.drop_first - along_cut as i32);
            return (
                D::Lane::from_wide(radial.wrapping_add(down as i32).into()),
                D::Lane::from_wide(first.wrapping_add(self.balance.unit as i32).into()),
                self.second,
            );
        }
        if self.is_narrow() && bits <= 15 {
            let dx = rounded_to_word(dx, self.drop_dx);
            let along = (self.horizontal as i32).wrapping_mul(dx);
            let across = shift_word(along, bits as i32).wrapping_mul(dx);
            let radial = shift_word(across, self.drop_radial).wrapping_add(down as i32);
            let first = shift_word(along, self.drop_first).wrapping_add(self.balance.unit as i32);
            return (
                D::Lane::from_wide(radial.into()),
                D::Lane::from_wide(first.into()),
                self.second,
            );
        }
        let dx = shift_round(dx, self.drop_dx);
        let along = self.horizontal.wrapping_mul(dx);
        let across = shift_round(along, bits).wrapping_mul(dx);
        let radial = shift_signed(across, self.drop_radial).wrapping_add(down);
        let first = shift_signed(along, self.drop_first).wrapping_add(self.balance.unit);
        (
            D::Lane::from_wide(radial),
            D::Lane::from_wide(first),
            self.second,
        )
    }
}
