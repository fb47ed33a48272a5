//! Projection of the centre: view transform, reciprocal of the depth, perspective division (\[EWA\] eq. 22-24).
//!
//! The difference to the eye is exact before it is rounded ([`Pose`]), so that a splat just behind the near plane loses
//! nothing to cancellation, however far from the origin it stands. From camera space on mantissas of the design's
//! `view` bits: 1/z once, then x/z and y/z, then u = fx x/z + cx rounded once to the design's sub-pixel bits. The
//! centre deserves more bits than the shape: 8 sub-pixel bits cost more accuracy than everything else together
//! (docs/specification.md).

use super::Cull;
use crate::format::Widths;
use crate::math::{Extended, SoftFloat, reciprocal, shift_round};
use crate::rules::Rules;
use crate::view::{CameraPoint, Pose, Projection, View};

/// A projected centre with what the Jacobian needs of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Projected {
    /// z in scene units.
    pub depth: Extended,
    /// Pixels, Q27.subpixel, |u| < 2^26.
    pub centre: [i64; 2],
    /// x/z and y/z, clamped if the rules say so; 0 for orthographic views.
    pub ratio: [SoftFloat; 2],
    /// Pixels per scene unit at the splat's depth: fx/z and fy/z (orthographic: fx and fy).
    pub gain: [SoftFloat; 2],
}

/// Projects `centre`; culls by depth and range.
pub fn project<P: Pose>(
    widths: &Widths,
    view: &View<P>,
    rules: &Rules,
    centre: &P::Centre,
) -> Result<Projected, Cull> {
    let bits = u32::from(widths.view);
    let point = view.pose.to_camera(&view.rotation, centre, widths);
    let [x, y] = [0, 1].map(|axis| point.coordinate(axis));
    let z = between_planes(view, &point)?;
    let perspective = view.projection == Projection::Perspective;
    let rounded = |number: Extended| SoftFloat::from_wide(number.value, number.exponent, bits);
    let position = [x, y].map(rounded);
    let inverse = if perspective {
        reciprocal(rounded(z), bits).ok_or(Cull::Near)?
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
        [SoftFloat::ZERO; 2]
    };
    Ok(Projected {
        depth: z,
        centre,
        ratio,
        gain,
    })
}

/// z of a centre, scene units, by which splats are sorted; culls by depth as [`project`] does.
pub fn depth_of<P: Pose>(
    widths: &Widths,
    view: &View<P>,
    centre: &P::Centre,
) -> Result<Extended, Cull> {
    let point = view.pose.to_camera(&view.rotation, centre, widths);
    between_planes(view, &point)
}

fn between_planes<P>(view: &View<P>, point: &CameraPoint) -> Result<Extended, Cull> {
    let z = point.coordinate(2);
    let perspective = view.projection == Projection::Perspective;
    if !z.exceeds(view.near) || (perspective && z.value <= 0) {
        return Err(Cull::Near);
    }
    if view.far.exceeds(z) {
        Ok(z)
    } else {
        Err(Cull::Far)
    }
}

const ONE: SoftFloat = SoftFloat {
    mantissa: 1 << 30,
    exponent: -30,
};

/// fx x/z + cx in Q27.subpixel; `None` beyond 2^26 pixels.
fn on_screen<P>(widths: &Widths, view: &View<P>, axis: usize, on_plane: SoftFloat) -> Option<i64> {
    let offset = view.focal[axis].times(on_plane).to_fixed(32);
    let position = view.principal[axis].to_bits().saturating_add(offset);
    if position.unsigned_abs() >> (32 + 26) != 0 {
        return None;
    }
    Some(shift_round(position, 32 - u32::from(widths.subpixel)))
}

/// x/z and y/z as the Jacobian takes them, clamped to the widened frustum under rules that say so.
fn ratios<P>(view: &View<P>, rules: &Rules, on_plane: [SoftFloat; 2], bits: u32) -> [SoftFloat; 2] {
    let mut ratio = on_plane;
    for (axis, value) in ratio.iter_mut().enumerate() {
        let mut fixed = value.to_fixed(32);
        let (low, high) = (
            view.limits.low[axis].to_bits(),
            view.limits.high[axis].to_bits(),
        );
        if rules.clamp_jacobian && (fixed < low || fixed > high) {
            fixed = fixed.min(high).max(low);
            *value = SoftFloat::from_wide(fixed, -32, bits);
        } else {
            *value = SoftFloat::from_word(value.mantissa, value.exponent, bits);
        }
    }
    ratio
}
