//! Projection of the centre: view transform, reciprocal of the depth, perspective division (\[EWA\] eq. 22-24).
//!
//! t = W u + d is exact to Q9.54, so that a splat just behind the near plane loses nothing to cancellation.
//! From there on mantissas of the design's `view` bits: 1/z once, then x/z and y/z, then u = fx x/z + cx rounded
//! once to the design's sub-pixel bits. The centre deserves more bits than the shape: 8 sub-pixel bits
//! cost more accuracy than everything else together (docs/number-formats.md).

use super::Cull;
use crate::format::Widths;
use crate::math::{Scaled, reciprocal, shift_round};
use crate::rules::Rules;
use crate::view::{Projection, View};
use fixed::types::I8F24;

/// A projected centre with what the Jacobian needs of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Projected {
    /// z in scene units, UQ9.23, rounded to nearest, saturated.
    pub depth: u32,
    /// Pixels, Q27.subpixel, |u| < 2^26.
    pub centre: [i64; 2],
    /// x/z and y/z, clamped if the rules say so; 0 for orthographic views.
    pub ratio: [Scaled; 2],
    /// Pixels per scene unit at the splat's depth: fx/z and fy/z (orthographic: fx and fy).
    pub gain: [Scaled; 2],
}

/// Projects `centre` (scene units, Q7.24); culls by depth and range.
pub fn project(
    widths: &Widths,
    view: &View,
    rules: &Rules,
    centre: [I8F24; 3],
) -> Result<Projected, Cull> {
    let bits = u32::from(widths.view);
    let [x, y, z] = view.to_camera(centre, bits);
    let perspective = view.projection == Projection::Perspective;
    if z <= view.near.to_bits() || (perspective && z <= 0) {
        return Err(Cull::Near);
    }
    if z >= view.far.to_bits() {
        return Err(Cull::Far);
    }
    let depth = shift_round(z, 31).clamp(0, u32::MAX.into()) as u32;
    let position = [x, y].map(|coordinate| Scaled::from_wide(coordinate, -54, bits));
    let inverse = if perspective {
        reciprocal(Scaled::from_wide(z, -54, bits), bits).ok_or(Cull::Near)?
    } else {
        ONE
    };
    let on_plane = position.map(|coordinate| coordinate.multiply(inverse, bits));
    let mut centre = [0; 2];
    for axis in 0..2 {
        centre[axis] = on_screen(widths, view, axis, on_plane[axis]).ok_or(Cull::Range)?;
    }
    let mantissa = u32::from(widths.mantissa);
    let gain = view.focal.map(|focal| focal.multiply(inverse, mantissa));
    let ratio = if perspective {
        ratios(view, rules, on_plane, mantissa)
    } else {
        [Scaled::ZERO; 2]
    };
    Ok(Projected {
        depth,
        centre,
        ratio,
        gain,
    })
}

const ONE: Scaled = Scaled {
    mantissa: 1 << 30,
    exponent: -30,
};

/// fx x/z + cx in Q27.subpixel; `None` beyond 2^26 pixels.
fn on_screen(widths: &Widths, view: &View, axis: usize, on_plane: Scaled) -> Option<i64> {
    let offset = view.focal[axis].times(on_plane).to_fixed(32);
    let position = view.principal[axis].to_bits().saturating_add(offset);
    if position.unsigned_abs() >> (32 + 26) != 0 {
        return None;
    }
    Some(shift_round(position, 32 - u32::from(widths.subpixel)))
}

/// x/z and y/z as the Jacobian takes them, clamped to the widened frustum under rules that say so.
fn ratios(view: &View, rules: &Rules, on_plane: [Scaled; 2], bits: u32) -> [Scaled; 2] {
    let mut ratio = on_plane;
    for (axis, value) in ratio.iter_mut().enumerate() {
        let mut fixed = value.to_fixed(32);
        let (low, high) = (
            view.limits.low[axis].to_bits(),
            view.limits.high[axis].to_bits(),
        );
        if rules.clamp_jacobian && (fixed < low || fixed > high) {
            fixed = fixed.min(high).max(low);
            *value = Scaled::from_wide(fixed, -32, bits);
        } else {
            *value = Scaled::from_wide(value.mantissa.into(), value.exponent, bits);
        }
    }
    ratio
}
