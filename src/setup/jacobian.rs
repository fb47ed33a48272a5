//! The columns of M = J W A: each of the splat's axes on the screen, in pixels (\[EWA\] eq. 25-29).
//!
//! J has the rows (fx/z)(1, 0, -x/z) and (fy/z)(0, 1, -y/z), so a column is the axis turned into camera
//! space, sheared by the viewing ray, and scaled by the gain. Each component keeps its own exponent: the thin axis of
//! a needle is as exact as the long one, which is what the determinant lives on.

use super::project::Projected;
use crate::format::Widths;
use crate::math::words::product;
use crate::math::{GUARD, SoftFloat, sum_of_products};
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

/// M = J W A, one column per axis. An axis of length 0 gives a zero column.
pub fn project_axes(
    widths: &Widths,
    rotation: &Rotation,
    projected: &Projected,
    axes: &[Axis; 3],
) -> [ScreenAxis; 3] {
    axes.map(|axis| column(widths, rotation, projected, axis))
}

fn column(widths: &Widths, rotation: &Rotation, projected: &Projected, axis: Axis) -> ScreenAxis {
    let bits = u32::from(widths.mantissa);
    let [x, y, z] = rotate_axis(widths, rotation, axis);
    ScreenAxis {
        x: sheared(x, z, projected.ratio[0], projected.gain[0], bits),
        y: sheared(y, z, projected.ratio[1], projected.gain[1], bits),
    }
}

/// A component across the view and what the depth's moves it by, in pixels.
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
/// Two axes of a needle differ in their directions' last bits: with 18-bit mantissas, axes of 18 bits cost 2 dB, rotations of 18 bits 5 dB,
/// and of either 24 bits nothing.
pub const AXIS_GUARD: u32 = 6;

/// Bits of an axis' components, and fraction bits of the rotation that turns it; of this the format has 30.
pub const fn axis_bits(widths: &Widths) -> u32 {
    let bits = widths.mantissa as u32 + AXIS_GUARD;
    if bits < AXIS { bits } else { AXIS }
}

/// Magnitude bits that an axis comes with.
const AXIS: u32 = 31;

/// W a, each component rounded to the mantissa.
///
/// The axis, Q31 by its block's exponent, is rounded down and the rotation to nearest to [`axis_bits`]. Each product is cut to the
/// window of a sum ([`GUARD`]), which ends at twice the axis' largest component: nothing overflows, and the error is that of axis and rotation,
/// `2^-axis_bits`.
pub(super) fn rotate_axis(widths: &Widths, rotation: &Rotation, axis: Axis) -> [SoftFloat; 3] {
    let bits = u32::from(widths.mantissa);
    let [kept, window] = [axis_bits(widths), bits + GUARD];
    let exponent = axis.exponent.clamp(-512, 511) + AXIS as i32 - window as i32;
    let mut turned = [SoftFloat::ZERO; 3];
    for (component, entries) in turned.iter_mut().zip(rotation) {
        let mut sum = 0i64;
        for (entry, mantissa) in entries.iter().zip(axis.mantissa) {
            let part = mantissa.max(-i32::MAX) & -1 << (AXIS - kept);
            let product = product(round_entry(*entry, kept) as i32, part);
            sum = sum.wrapping_add(product >> (AXIS + ENTRY - window));
        }
        *component = SoftFloat::from_wide(sum, exponent, bits);
    }
    turned
}
