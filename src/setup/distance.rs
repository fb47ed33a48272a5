//! Antialiasing by distance (\[SWAN\] 4.3), the alternative to the low-pass filter of \[EWA\].
//!
//! Samples s apart are seen at distance d through an image plane at distance D with pixels of extent p. From k = s D /
//! p on, samples lie closer together than pixels. Beyond k radii grow by d/k and the footprint's height falls by
//! (k/d)^2, so that on the screen a footprint keeps the size it has at k, and its energy is the sample's.
//!
//! In terms of the gain g, pixels per scene unit at the splat's depth (fx/z, orthographic fx), all of that is one
//! factor for both projections:
//!
//! ```text
//! d/k = 1 / (s g)       if s g < 1, else 1
//! ```
//!
//! With pixels that are not square the smaller gain decides. The factor enlarges all three axes of a splat. Under
//! normalised rules the peak falls by itself, because the footprint keeps unit volume; under the others the weight is
//! divided by the factor's square. Unlike the low-pass filter, which widens a footprint only where it is thin, the
//! factor widens an anisotropic footprint in all directions.

use super::jacobian::ScreenAxis;
use super::project::Projected;
use crate::format::Widths;
use crate::math::{SoftFloat, reciprocal};
use crate::rules::Rules;

/// d/k > 1 for a splat beyond the distance k; `None` nearer, or where the rules do not scale by distance.
///
/// Rounded to the design's mantissa twice (product and reciprocal).
pub fn enlargement(widths: &Widths, rules: &Rules, projected: &Projected) -> Option<SoftFloat> {
    if rules.spacing.mantissa <= 0 {
        return None;
    }
    let bits = u32::from(widths.mantissa);
    let [across, down] = projected.gain;
    let gain = if less(across, down) { across } else { down };
    let distance = rules.spacing.multiply(gain, bits);
    if distance.leading() >= 0 {
        return None;
    }
    reciprocal(distance, bits)
}

/// M with all axes enlarged.
pub fn enlarge(widths: &Widths, columns: [ScreenAxis; 3], factor: SoftFloat) -> [ScreenAxis; 3] {
    let bits = u32::from(widths.mantissa);
    columns.map(|column| ScreenAxis {
        x: column.x.multiply(factor, bits),
        y: column.y.multiply(factor, bits),
    })
}

/// The weight of a splat whose axes were enlarged: (k/d)^2 of it, unless kernels are normalised.
pub fn dim(widths: &Widths, rules: &Rules, weight: SoftFloat, factor: SoftFloat) -> SoftFloat {
    let bits = u32::from(widths.mantissa);
    if rules.normalised {
        return weight;
    }
    let inverse = reciprocal(factor, bits).unwrap_or(SoftFloat::ZERO);
    weight.multiply(inverse, bits).multiply(inverse, bits)
}

/// Order of two positive normalised numbers.
fn less(a: SoftFloat, b: SoftFloat) -> bool {
    (a.leading(), a.mantissa) < (b.leading(), b.mantissa)
}
