//! Setup of surface splats (SURF 3.3 and 4, EWA 6.3): M = J W S, V' = M M^T, and the tangent plane's depth.
//!
//! A surface splat is a volume splat whose third axis has length 0 (EWA 6.4), so the units of volume setup serve as
//! they are: `columns` with a zero third column, `variance` whose Cauchy-Binet sum then is (m1 x m2)^2 + h trace + h^2.
//! Two things are new.
//!
//! **Weight.** SURF eq. 8 normalises by |J| = |m1 x m2|: the screen-space basis function at its centre is
//!
//! ```text
//! p = w |m1 x m2| / sqrt(det(V' + V^h)),   0 <= p <= w
//! ```
//!
//! w when magnified, falling with the projected area when minified. It is the flattened volume kernel's peak (`peak`)
//! times the cosine between normal and ray: a thin sheet gets denser along an oblique ray, a surface does not.
//!
//! **Depth.** The plane's depth is affine in the pixel, z = z0 + g . (x - u). SURF takes g from the tangent plane,
//! which is infinitely steep when seen edge-on, while the low-pass filter keeps the footprint at least a pixel wide.
//! Here g is the depth that the *filtered* kernel has at a pixel, the regression of z on the screen position:
//!
//! ```text
//! g = (V' + h I)^-1 M z,   z = (depth components of the two axes)
//!   = ( D (m2y z1 - m1y z2) + h (m1x z1 + m2x z2),  D (m1x z2 - m2x z1) + h (m1y z1 + m2y z2) ) / det,   D = m1 x m2
//! ```
//!
//! With h = 0 this is the tangent plane's slope, and by Cauchy-Schwarz |g . (x - u)| <= sqrt(r) |z|: no depth inside a
//! footprint leaves the splat's own depth range, so nothing needs to be clamped. The second form never subtracts
//! variances. Perspective: 1/z, not z, is affine on the screen; z0 + g . x is its first-order expansion, the
//! approximation that the Jacobian makes of the position. The error is below (sqrt(c) |z| / z0)^2 z0 and exact in
//! orthographic views.

use super::covariance::{Covariance2d, covariance, minor};
use super::jacobian::{ScreenAxis, project_axes, rotate_axis};
use super::{Cull, Projected, bounding_box, conic, cutoff, ldl, opacity_fixed, project};
use crate::footprint::surface::{
    Attributes, DEPTH_FRACTION, Plane, SurfaceFootprint, attribute_fraction,
};
use crate::footprint::{Footprint, depth};
use crate::format::{Design, Widths};
use crate::math::{Product, SoftFloat, reciprocal, shift_unsigned, square_root, sum_of_products};
use crate::rules::Rules;
use crate::splat::Axis;
use crate::splat::surface::SurfaceSplat;
use crate::view::{Pose, Rotation, View};

/// The whole of setup for one surface splat. Total: defined for every bit pattern of its inputs.
pub fn setup_surface<D: Design, P: Pose>(
    design: D,
    view: &View<P>,
    rules: &Rules,
    splat: &SurfaceSplat<P::Centre>,
) -> Result<SurfaceFootprint, Cull> {
    let widths = design.widths();
    let bits = u32::from(widths.mantissa);
    let projected = project(&widths, view, rules, &splat.centre)?;
    let [first_axis, second_axis] = splat.frame;
    let columns = project_axes(
        &widths,
        &view.rotation,
        &projected,
        &[first_axis, second_axis, Axis::default()],
    );
    let covariance = covariance(&widths, rules.low_pass, &columns);
    let ldl = ldl(&widths, &covariance).ok_or(Cull::Degenerate)?;
    let conic = conic(&widths, &covariance, ldl.horizontal).ok_or(Cull::Degenerate)?;
    let area = minor(&columns[0], &columns[1], bits);
    let peak = surface_opacity(&widths, splat.weight, area, &covariance);
    let cutoff = cutoff(rules, peak).ok_or(Cull::Transparent)?;
    let peak = opacity_fixed(peak, widths.peak.into()).ok_or(Cull::Transparent)?;
    let (first, last) = bounding_box(&widths, view, projected.centre, &covariance, cutoff)?;
    let (attributes, back) = attributes(&widths, &view.rotation, &projected, splat);
    let along_ray = splat
        .frame
        .map(|axis| rotate_axis(&widths, &view.rotation, axis)[2]);
    let gradient = depth_gradient(
        &widths,
        rules.low_pass,
        &columns,
        along_ray,
        area,
        &covariance,
    );
    let footprint = Footprint {
        depth: depth::key(projected.depth),
        centre: projected.centre,
        first,
        end: last,
        ldl,
        conic,
        cutoff,
        opacity: peak,
        colour: attributes.colour.map(|channel| {
            let drop = i32::from(attribute_fraction(&widths)) - i32::from(widths.colour);
            shift_unsigned(channel.into(), drop, widths.rounding) as u32
        }),
    };
    Ok(SurfaceFootprint {
        plane: plane(&widths, &projected, first, gradient),
        footprint,
        attributes,
        back,
    })
}

/// p = w |D| / sqrt(det), SURF eq. 8; 0 for weights that are not positive and for planes seen edge-on.
///
/// Rounded to the mantissa four times: relative error below 2^-(bits - 2).
pub fn surface_opacity(
    widths: &Widths,
    weight: SoftFloat,
    area: SoftFloat,
    covariance: &Covariance2d,
) -> SoftFloat {
    let bits = u32::from(widths.mantissa);
    if weight.mantissa <= 0 {
        return SoftFloat::ZERO;
    }
    let Some(inverse) = reciprocal(square_root(covariance.determinant, bits), bits) else {
        return SoftFloat::ZERO;
    };
    let magnitude = SoftFloat {
        mantissa: area.mantissa.saturating_abs(),
        exponent: area.exponent,
    };
    weight.multiply(magnitude, bits).multiply(inverse, bits)
}

/// g = (V' + h I)^-1 M z in scene units per pixel; see the module's head. 0 where the variance has no inverse.
pub fn depth_gradient(
    widths: &Widths,
    low_pass: SoftFloat,
    columns: &[ScreenAxis; 3],
    along_ray: [SoftFloat; 2],
    area: SoftFloat,
    covariance: &Covariance2d,
) -> [SoftFloat; 2] {
    let bits = u32::from(widths.mantissa);
    let Some(inverse) = reciprocal(covariance.determinant, bits) else {
        return [SoftFloat::ZERO; 2];
    };
    let [m1, m2, _] = columns;
    let [z1, z2] = along_ray;
    let component = |sharp: [Product; 2], filtered: [Product; 2]| {
        let sharp = sum_of_products(sharp, bits);
        let filtered = sum_of_products(filtered, bits);
        sum_of_products([area.times(sharp), low_pass.times(filtered)], bits).multiply(inverse, bits)
    };
    [
        component(
            [m2.y.times(z1), m1.y.times(z2).negated()],
            [m1.x.times(z1), m2.x.times(z2)],
        ),
        component(
            [m1.x.times(z2), m2.x.times(z1).negated()],
            [m1.y.times(z1), m2.y.times(z2)],
        ),
    ]
}

/// The plane's integers: depth at the box's first sample point and its steps, each rounded once to 2^-32 scene units.
fn plane(
    widths: &Widths,
    projected: &Projected,
    first: [u16; 2],
    gradient: [SoftFloat; 2],
) -> Plane {
    let subpixel = u32::from(widths.subpixel);
    let depth = Product::new(projected.depth.value, projected.depth.exponent);
    let mut origin = depth.to_fixed(DEPTH_FRACTION);
    for axis in 0..2 {
        let sample = (2 * i64::from(first[axis]) + 1) << (subpixel - 1);
        let distance = SoftFloat::from_wide(
            sample.wrapping_sub(projected.centre[axis]),
            -(subpixel as i32),
            widths.mantissa.into(),
        );
        origin = origin.saturating_add(gradient[axis].times(distance).to_fixed(DEPTH_FRACTION));
    }
    Plane {
        origin,
        step: gradient.map(|slope| slope.to_fixed(DEPTH_FRACTION)),
    }
}

/// Colour and opacity clamped to 1, the normal turned into camera space and towards the eye; and whether that turned it
/// around.
fn attributes<C>(
    widths: &Widths,
    rotation: &Rotation,
    projected: &Projected,
    splat: &SurfaceSplat<C>,
) -> (Attributes, bool) {
    let bits = i32::from(attribute_fraction(widths));
    let one = 1u64 << bits;
    let unit = |value: u32| shift_unsigned(value.into(), 28 - bits, widths.rounding).min(one);
    let opacity = unit(splat.opacity.to_bits());
    let premultiplied = |channel: fixed::types::U4F28| {
        shift_unsigned(unit(channel.to_bits()) * opacity, bits, widths.rounding) as u32
    };
    let (normal, back) = facing_normal(widths, rotation, projected, splat.normal);
    let attributes = Attributes {
        colour: splat.colour.map(premultiplied),
        opacity: opacity as u32,
        normal,
        material: splat.material,
    };
    (attributes, back)
}

/// The normal in camera space, Q1 with the attributes' fraction, turned so that it does not point away from the eye.
///
/// Surfaces are two-sided and normals of scans often are not oriented; averaged as they are, opposite ones would
/// cancel. The turn leaves no seam: where n . t changes its sign the plane is seen edge-on and the splat's weight is 0.
///
/// On closed surfaces whose normals are oriented it leaves a fringe instead: next to the silhouette the back's splats
/// reach over it and are lit as if they were in front. There the ones that were turned are left out.
fn facing_normal(
    widths: &Widths,
    rotation: &Rotation,
    projected: &Projected,
    normal: Axis,
) -> ([i32; 3], bool) {
    let normal = rotate_axis(widths, rotation, normal);
    let [ratio_x, ratio_y] = projected.ratio;
    let [x, y, z] = normal;
    let bits = widths.mantissa.into();
    let depth = z.term_within(bits);
    let away = sum_of_products([x.times(ratio_x), y.times(ratio_y), depth], bits).mantissa > 0;
    let bits = attribute_fraction(widths);
    let limit = 1i64 << bits;
    let facing = normal.map(|n| {
        let fixed = n.to_fixed(bits.into()).clamp(-limit, limit) as i32;
        if away { -fixed } else { fixed }
    });
    (facing, away)
}
