//! The columns of M = J W A: each of the splat's axes on the screen, in pixels (\[EWA\] eq. 25-29).
//!
//! J has the rows (fx/z)(1, 0, -x/z) and (fy/z)(0, 1, -y/z), so a column is the axis turned into camera
//! space, sheared by the viewing ray, and scaled by the gain. Each component keeps its own exponent: the thin axis of
//! a needle is as exact as the long one, which is what the determinant lives on.

use super::project::Projected;
use crate::format::Widths;
use crate::math::{Product, SoftFloat, sum_of_products};
use crate::splat::Axis;
use crate::view::{Rotation, round_entry};

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
    let shear = |across: SoftFloat, ratio: SoftFloat, gain: SoftFloat| {
        let along = ratio.times(z);
        let along = Product {
            value: along.value.wrapping_neg(),
            exponent: along.exponent,
        };
        let across = Product {
            value: across.mantissa.into(),
            exponent: across.exponent,
        };
        sum_of_products([across, along], bits).multiply(gain, bits)
    };
    ScreenAxis {
        x: shear(x, projected.ratio[0], projected.gain[0]),
        y: shear(y, projected.ratio[1], projected.gain[1]),
    }
}

/// W a: exact products and sum, each component rounded to the mantissa.
pub(super) fn rotate_axis(widths: &Widths, rotation: &Rotation, axis: Axis) -> [SoftFloat; 3] {
    let exponent = axis.exponent.clamp(-512, 511) - 30;
    let mut turned = [SoftFloat::ZERO; 3];
    for (component, entries) in turned.iter_mut().zip(rotation) {
        let mut sum = 0i64;
        for (entry, mantissa) in entries.iter().zip(axis.mantissa) {
            let mantissa = i64::from(mantissa.max(-i32::MAX));
            sum = sum.wrapping_add(round_entry(*entry, widths.view.into()).wrapping_mul(mantissa));
        }
        *component = SoftFloat::from_wide(sum, exponent, widths.mantissa.into());
    }
    turned
}
