//! The radial index of a sphere along each pixel's own ray: exact anywhere in the picture.
//!
//! The table of \[HYBRID\] 4.2 ([`super::PerspectiveTable`]) is exact for a sphere in the middle of the picture. Aside,
//! the outlines for different radii are ellipses with different centres, and no index within one ellipse can follow
//! them. What the kernel depends on is the distance of the ray v = (X, Y, 1) from the centre C, and
//!
//! ```text
//! r' = |C x v|^2 / (|v|^2 s^2) = r L / |v|^2,    L = |C|^2/z^2,  |v|^2 = 1 + X^2 + Y^2
//! ```
//!
//! where r is nothing but the affine radial index that the lanes have already: |C x v|^2 / s^2 is L times \[EWA\]'s
//! conic around the projected centre. In the middle this is the paper's r / (1 + r s^2/z^2). It costs two squares, a
//! reciprocal and a product per pixel; |v|^2 does not depend on the splat and may be kept per row and column.

use crate::math::{SoftFloat, reciprocal, shift_signed, sum_of_products};
use crate::view::View;

/// Fraction bits of ray slopes and of |v|^2.
const FRACTION: u32 = 28;

/// Slopes are clamped to this; rays beyond 82 degrees count as 82.
const LARGEST_SLOPE: i64 = 7 << FRACTION;

/// The rays of a picture's pixels. Constant for a picture.
#[derive(Clone, Copy, Debug)]
pub struct Rays {
    inverse_focal: [SoftFloat; 2],
    principal: [i64; 2],
}

impl Rays {
    /// The rays of a perspective view.
    pub fn new(view: &View) -> Rays {
        Rays {
            inverse_focal: view
                .focal
                .map(|focal| reciprocal(focal, 31).unwrap_or(SoftFloat::ZERO)),
            principal: view.principal.map(|coordinate| coordinate.to_bits()),
        }
    }

    /// |v|^2 of the pixel at column x and row y, UQ7.28, rounded to nearest.
    #[inline]
    pub fn squared(&self, pixel: [u16; 2]) -> i64 {
        let square = |axis: usize| {
            let sample =
                ((2 * i64::from(pixel[axis]) + 1) << 31).wrapping_sub(self.principal[axis]);
            let offset = SoftFloat::from_wide(sample, -32, 31);
            let slope = offset.times(self.inverse_focal[axis]).to_fixed(FRACTION);
            let slope = slope.clamp(-LARGEST_SLOPE, LARGEST_SLOPE);
            crate::math::shift_round(slope * slope, FRACTION)
        };
        (1i64 << FRACTION) + square(0) + square(1)
    }

    /// r' = r L / |v|^2 for r in UQ4.radial, in the same format; relative error 2^-27, saturated to 2^62.
    #[inline]
    pub fn correct(&self, pixel: [u16; 2], radial: u64, slant: SoftFloat) -> u64 {
        let squared = SoftFloat::from_wide(self.squared(pixel), -(FRACTION as i32), 31);
        let factor = slant.multiply(reciprocal(squared, 31).unwrap_or(SoftFloat::ZERO), 31);
        let radial = SoftFloat::from_wide((radial >> 1) as i64, 1, 31);
        let corrected = radial.times(factor);
        shift_signed(corrected.value, 0i32.saturating_sub(corrected.exponent)).clamp(0, 1 << 62)
            as u64
    }
}

/// Cut-off of the affine index that covers the whole outline of index `end` (UQ4.28): c (1 + T^2) / L, at most 15.
///
/// T = (sqrt(L - 1) + sqrt(e (L - e))) / g is the slope of the outline's point farthest from the principal point;
/// `aside` is L - 1, `limit` e and `rest` g of [`setup_sphere`](crate::setup::setup_sphere).
pub fn covering_cutoff(
    end: u32,
    aside: SoftFloat,
    limit: SoftFloat,
    rest: SoftFloat,
    bits: u32,
) -> u32 {
    const ONE: SoftFloat = SoftFloat {
        mantissa: 1 << 30,
        exponent: -30,
    };
    let root = |value: SoftFloat| crate::math::square_root(value, bits).times(ONE);
    let slant = sum_of_products([ONE.times(ONE), aside.times(ONE)], bits);
    let minus = SoftFloat {
        mantissa: limit.mantissa.saturating_neg(),
        exponent: limit.exponent,
    };
    let spread = limit.multiply(
        sum_of_products([slant.times(ONE), minus.times(ONE)], bits),
        bits,
    );
    let sum = sum_of_products([root(aside), root(spread)], bits);
    let (Some(inverse), Some(inverse_slant)) = (reciprocal(rest, bits), reciprocal(slant, bits))
    else {
        return 15 << 28;
    };
    let farthest = sum.multiply(inverse, bits);
    let squared = sum_of_products([ONE.times(ONE), farthest.times(farthest)], bits);
    let cutoff = SoftFloat::from_wide(end.into(), -28, bits)
        .multiply(squared, bits)
        .multiply(inverse_slant, bits)
        .to_fixed(28);
    // A pixel on the outline is not lost to rounding.
    cutoff.saturating_add(cutoff >> 12).clamp(0, 15 << 28) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cutoffs_end_where_their_word_does() {
        let one = SoftFloat {
            mantissa: 1 << 30,
            exponent: -30,
        };
        let zero = SoftFloat::ZERO;
        assert_eq!(covering_cutoff(4 << 28, one, zero, zero, 24), 15 << 28);
        assert_eq!(covering_cutoff(0, one, zero, one, 24), 0);
    }

    #[test]
    fn rays_and_their_cutoffs_are_these() {
        let mut next = crate::random();
        let words = (0..4000).flat_map(|step| {
            let focal = [step % 50 + 20, step % 31 + 40];
            let mut view = crate::setup::tests::view(crate::view::Eye::ORIGIN, focal);
            view.principal = [7_654_321_987, -9_876_543_210].map(fixed::types::I32F32::from_bits);
            let rays = Rays::new(&view);
            let pixel = [next() % 300, next() % 300].map(|place| place as u16);
            let radial = next() >> (next() % 60 + 1);
            let mut number = |exponent| SoftFloat {
                mantissa: (next() as i32 & i32::MAX) | 1 << 30,
                exponent,
            };
            let (slant, aside) = (number(-28), number(-30));
            let (limit, rest) = (number(-32), number(-31));
            let squared = rays.squared(pixel);
            [
                squared as u64,
                rays.correct(pixel, radial, slant),
                covering_cutoff(squared as u32, aside, limit, rest, 24).into(),
                covering_cutoff(squared as u32 >> 8, limit, rest, aside, 18).into(),
            ]
        });
        assert_eq!(crate::digest(words), 14_759_603_436_771_244_501);
    }
}
