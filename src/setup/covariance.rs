//! The screen-space variance matrix V' + V^h and its determinant, without cancellation.
//!
//! V' = M M^T, V^h = h I. By Cauchy-Binet, with m_k the columns of M:
//!
//! ```text
//! det(M M^T + h I) = sum_{j<k} (m_j x m_k)^2 + h (|row_x|^2 + |row_y|^2) + h^2
//! ```
//!
//! a sum of positive terms. The usual Vxx Vyy - Vxy^2 loses twice as many bits as the axis ratio has.

use super::jacobian::ScreenAxis;
use crate::format::Widths;
use crate::math::{Product, SoftFloat, sum_of_products};

/// V' + V^h in square pixels and its determinant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Covariance2d {
    /// Horizontal covariance.
    pub xx: SoftFloat,
    /// Covariance.
    pub xy: SoftFloat,
    /// Vertical covariance.
    pub yy: SoftFloat,
    /// Determinant, to the fourth power of pixels.
    pub determinant: SoftFloat,
}

/// Covariance2d and determinant from the columns of M and the low-pass variance h (square pixels, not negative).
///
/// Each result is rounded once to the design's mantissa, the determinant's minors and the trace once more.
pub fn covariance(widths: &Widths, low_pass: SoftFloat, columns: &[ScreenAxis; 3]) -> Covariance2d {
    let bits = u32::from(widths.mantissa);
    let h = Product {
        value: low_pass.mantissa.into(),
        exponent: low_pass.exponent,
    };
    let [a, b, c] = columns;
    let xx = sum_of_products([a.x.times(a.x), b.x.times(b.x), c.x.times(c.x), h], bits);
    let yy_sharp = sum_of_products([a.y.times(a.y), b.y.times(b.y), c.y.times(c.y)], bits);
    let xy = sum_of_products([a.x.times(a.y), b.x.times(b.y), c.x.times(c.y)], bits);
    let plain = |value: SoftFloat| Product {
        value: value.mantissa.into(),
        exponent: value.exponent,
    };
    let yy = sum_of_products([plain(yy_sharp), h], bits);
    let trace = sum_of_products([plain(xx), plain(yy_sharp)], bits);
    let [ab, ac, bc] = [minor(a, b, bits), minor(a, c, bits), minor(b, c, bits)];
    let determinant = sum_of_products(
        [
            ab.times(ab),
            ac.times(ac),
            bc.times(bc),
            low_pass.times(trace),
        ],
        bits,
    );
    Covariance2d {
        xx,
        xy,
        yy,
        determinant,
    }
}

/// The 2x2 minor m_j x m_k.
pub(super) fn minor(j: &ScreenAxis, k: &ScreenAxis, bits: u32) -> SoftFloat {
    let crossed = j.y.times(k.x);
    let crossed = Product {
        value: crossed.value.wrapping_neg(),
        exponent: crossed.exponent,
    };
    sum_of_products([j.x.times(k.y), crossed], bits)
}
