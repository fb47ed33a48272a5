//! Peak opacity and the cut-off that follows from it.
//!
//! Normalised kernels (\[EWA\] eq. 26-31): the footprint is a Gaussian of unit volume in ray space, so its peak is
//!
//! ```text
//! g |J W| / (pi I sqrt(det)),   |J| = fx/z fy/z |t|/z = gain_x gain_y sqrt(1 + (x/z)^2 + (y/z)^2)
//! ```
//!
//! with J in pixels, |W| = 1 and I the integral of the kernel's profile (2 for the Gaussian). Orthographic views have
//! |t|/z = 1. All other rules take the weight itself, or what is left of it where the low-pass filter is compensated
//! (Mip-Splatting, Yu et al., CVPR 2024, eq. 9): `weight sqrt(det V' / det(V' + V^h))`.

use super::covariance::{Covariance2d, sharp_determinant};
use super::jacobian::ScreenAxis;
use super::project::Projected;
use crate::format::Widths;
use crate::kernel::Kernel;
use crate::math::{Product, SoftFloat, ln, reciprocal, shift_round, square_root, sum_of_products};
use crate::rules::{Cutoff, Rules, THRESHOLD};

/// Peak opacity; 0 for negative weights.
pub fn centre_opacity(
    widths: &Widths,
    rules: &Rules,
    weight: SoftFloat,
    projected: &Projected,
    covariance: &Covariance2d,
) -> SoftFloat {
    if weight.mantissa <= 0 {
        return SoftFloat::ZERO;
    }
    if !rules.normalised {
        return weight;
    }
    let bits = u32::from(widths.mantissa);
    let [x, y] = projected.ratio;
    let square = |ratio: SoftFloat| ratio.times_within(ratio, 2 * bits);
    let slant = sum_of_products([Product::new(1, 0), square(x), square(y)], bits);
    let Some(inverse) = reciprocal(covariance.determinant, bits) else {
        return SoftFloat::ZERO;
    };
    let density = square_root(slant.multiply_within(inverse, bits), bits);
    let area = projected.gain[0].multiply_within(projected.gain[1], bits);
    weight
        .multiply(area, bits)
        .multiply(density, bits)
        .multiply(rules.kernel.inverse_integral(), bits)
}

/// The weight times sqrt(det V' / det(V' + V^h)), at most the weight but for rounding, with the design's mantissa; 0 of
/// a splat without area. Three products and a root, each rounded once; where the variance has no inverse the splat is
/// culled before.
pub fn compensate(
    widths: &Widths,
    weight: SoftFloat,
    columns: &[ScreenAxis; 3],
    covariance: &Covariance2d,
) -> SoftFloat {
    let bits = u32::from(widths.mantissa);
    let Some(inverse) = reciprocal(covariance.determinant, bits) else {
        return SoftFloat::ZERO;
    };
    let kept = sharp_determinant(widths, columns).multiply_within(inverse, bits);
    weight.multiply(square_root(kept, bits), bits)
}

/// The peak in UQ4.peak, saturated; `None` if it rounds to 0.
///
/// Saturation below 16 changes no pixel of a footprint with cut-off 4: the kernel there is at least exp(-2) > 1/16, so
/// the opacity is clamped to 1 either way.
///
/// Halves go to even, as those of colours do: a faint opacity of single precision has a few bits more than the format,
/// and one in four of them lies in the middle.
pub fn opacity_fixed(peak: SoftFloat, fraction: u32) -> Option<u32> {
    let fixed = peak.to_fixed(fraction);
    let odd_half = fixed & 1 != 0 && is_half(peak, fraction);
    match (fixed - i64::from(odd_half)).clamp(0, (16 << fraction.min(28)) - 1) {
        0 => None,
        fixed => Some(fixed as u32),
    }
}

/// Does a number lie in the middle between two multiples of `2^-fraction`?
fn is_half(number: SoftFloat, fraction: u32) -> bool {
    let dropped = 0i32
        .saturating_sub(number.exponent)
        .saturating_sub(fraction as i32);
    match dropped {
        1..=31 => number.mantissa << (32 - dropped) == i32::MIN,
        _ => false,
    }
}

/// Radial index at which the footprint ends, UQ4.28, at most 15; `None` if it is nowhere visible.
///
/// Where the opacity decides, c = 2 ln(peak / alpha_min), rounded to nearest. The comparison r < c in the lanes is then
/// the decision itself: it sees the unrounded peak, and no rounding of table or opacity, whose errors are ten times
/// those of r.
pub fn cutoff(rules: &Rules, peak: SoftFloat) -> Option<u32> {
    if rules.cutoff != Cutoff::Opacity || rules.kernel != Kernel::Gaussian {
        return Some(rules.end());
    }
    let least = if rules.alpha_min == USUAL {
        const { least_logarithm(USUAL) }
    } else {
        least_logarithm(rules.alpha_min)
    };
    let difference = ln(peak)?.wrapping_sub(least?);
    // Twice as much, from 32 to 28 fraction bits.
    let cutoff = shift_round(difference, 3);
    (cutoff > 0).then_some(cutoff.min(rules.end().into()) as u32)
}

/// The threshold of most scenes, whose logarithm no splat computes.
const USUAL: u64 = Rules::GAUSSIAN_3D.alpha_min;

/// ln of [`Rules::alpha_min`], of whose bits the lowest is left out.
const fn least_logarithm(alpha_min: u64) -> Option<i64> {
    ln(SoftFloat::from_wide(
        (alpha_min >> 1) as i64,
        1 - THRESHOLD as i32,
        31,
    ))
}
