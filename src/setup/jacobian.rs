//! The columns of M = J W A: each of the splat's axes on the screen, in pixels (\[EWA\] eq. 25-29).
//!
//! J has the rows (fx/z)(1, 0, -x/z) and (fy/z)(0, 1, -y/z), so a column is the axis turned into camera
//! space, sheared by the viewing ray, and scaled by the gain. Each component keeps its own exponent: the thin axis of
//! a needle is as exact as the long one, which is what the determinant lives on.

use super::project::Projected;
use crate::format::Widths;
use crate::math::words::Digits;
use crate::math::{GUARD, SoftFloat, by_mantissa, known, sum_of_products};
use crate::splat::Axis;
use crate::view::{ENTRY, Rotation, round_entry};

/// An axis on the screen, pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ScreenAxis {
    /// Horizontal component.
    pub x: SoftFloat,
    /// Vertical component.
    pub y: SoftFloat,
}

impl ScreenAxis {
    const ZERO: ScreenAxis = ScreenAxis {
        x: SoftFloat::ZERO,
        y: SoftFloat::ZERO,
    };
}

/// M = J W A, one column per axis. An axis of length 0 gives a zero column.
#[cfg_attr(target_pointer_width = "32", inline(always))]
pub fn project_axes(
    widths: &Widths,
    rotation: &Rotation,
    projected: &Projected,
    axes: &[Axis; 3],
) -> [ScreenAxis; 3] {
    let bits = u32::from(widths.mantissa);
    by_mantissa!(bits, columns(rotation, projected, axes))
}

fn columns<const KNOWN: u32>(
    rotation: &Rotation,
    projected: &Projected,
    axes: &[Axis; 3],
    bits: u32,
) -> [ScreenAxis; 3] {
    let turn = Turn::new(known::<KNOWN>(bits), rotation);
    let mut columns = [ScreenAxis::ZERO; 3];
    for (column, axis) in columns.iter_mut().zip(axes) {
        *column = turn.column(projected, axis);
    }
    columns
}

/// A component across the view and what the depth's moves it by, in pixels.
#[inline(always)]
fn sheared(
    across: SoftFloat,
    z: SoftFloat,
    ratio: SoftFloat,
    gain: SoftFloat,
    bits: u32,
) -> SoftFloat {
    let along = ratio.times_within(z, 2 * bits).negated();
    sum_of_products([across.term_within(bits), along], bits).multiply_within(gain, bits)
}

/// Bits that axes, and the rotation that turns them, have beyond the mantissa.
///
/// Two axes of a needle differ in their directions' last bits: with 18-bit mantissas, axes of 18 bits cost 2 dB,
/// rotations of 18 bits 5 dB, and of either 24 bits nothing.
pub const AXIS_GUARD: u32 = 6;

/// Bits of an axis' components, and fraction bits of the rotation that turns it; of this the format has 30.
pub const fn axis_bits(widths: &Widths) -> u32 {
    kept_bits(widths.mantissa as u32)
}

const fn kept_bits(mantissa: u32) -> u32 {
    let bits = mantissa + AXIS_GUARD;
    if bits < AXIS { bits } else { AXIS }
}

/// Magnitude bits that an axis comes with.
const AXIS: u32 = 31;

/// W a, each component rounded to the mantissa.
pub(super) fn rotate_axis(widths: &Widths, rotation: &Rotation, axis: Axis) -> [SoftFloat; 3] {
    Turn::new(widths.mantissa.into(), rotation).axis(&axis)
}

/// W as axes are turned by it.
///
/// The axis, Q31 by its block's exponent, is rounded down and the rotation to nearest to [`axis_bits`]. Each product is
/// cut to the window of a sum ([`GUARD`]), which ends at twice the axis' largest component: nothing overflows, and the
/// error is that of axis and rotation, `2^-axis_bits`.
struct Turn {
    entries: [[Digits; 3]; 3],
    bits: u32,
}

impl Turn {
    #[inline(always)]
    fn new(bits: u32, rotation: &Rotation) -> Turn {
        let kept = kept_bits(bits);
        let digits = |entry| {
            let rounded = round_entry(entry, kept) as i32;
            Digits::new(rounded >> ENTRY.saturating_sub(kept), kept)
        };
        // Entry by entry: what is filled in a loop is cleared before and copied afterwards.
        let row = |row: [_; 3]| [digits(row[0]), digits(row[1]), digits(row[2])];
        let [x, y, z] = *rotation;
        Turn {
            entries: [row(x), row(y), row(z)],
            bits,
        }
    }

    #[inline(always)]
    fn column(&self, projected: &Projected, axis: &Axis) -> ScreenAxis {
        let [x, y, z] = self.axis(axis);
        let Projected { ratio, gain, .. } = projected;
        ScreenAxis {
            x: sheared(x, z, ratio[0], gain[0], self.bits),
            y: sheared(y, z, ratio[1], gain[1], self.bits),
        }
    }

    /// A sum of up to `2^(window + 2)` may be a word; where a word might not do, it is two.
    #[inline(always)]
    fn axis(&self, axis: &Axis) -> [SoftFloat; 3] {
        let [kept, window] = [kept_bits(self.bits), self.bits + GUARD];
        let [fraction, whole] = [ENTRY.min(kept), AXIS - kept];
        let exponent = axis.exponent.clamp(-512, 511) + AXIS as i32 - window as i32;
        let parts = axis.mantissa.map(|part| part.max(-i32::MAX) >> whole);
        let mut turned = [SoftFloat::ZERO; 3];
        for (component, row) in turned.iter_mut().zip(&self.entries) {
            let cut = |j: usize| row[j].product(parts[j], kept, kept + fraction - window);
            let [a, b, c] = [cut(0), cut(1), cut(2)];
            let word = (a as i32).wrapping_add(b as i32).wrapping_add(c as i32);
            let wide = a.wrapping_add(b).wrapping_add(c);
            *component = if window <= 28 {
                SoftFloat::from_sum(word, exponent, self.bits)
            } else {
                SoftFloat::from_wide(wide, exponent, self.bits)
            };
        }
        turned
    }
}
