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
use crate::math::{SoftFloat, sum_of_products};

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
/// Each result is rounded once to the design's mantissa, the determinant's minors and the trace once more. In line
/// where small processors are to know the mantissa: each of its nine sums would else be there for every one.
#[cfg_attr(target_pointer_width = "32", inline(always))]
pub fn covariance(widths: &Widths, low_pass: SoftFloat, columns: &[ScreenAxis; 3]) -> Covariance2d {
    let bits = u32::from(widths.mantissa);
    let h = low_pass.term_within(low_pass.length());
    let times = |a: SoftFloat, b: SoftFloat| a.times_within(b, 2 * bits);
    let [a, b, c] = columns;
    let xx = sum_of_products([times(a.x, a.x), times(b.x, b.x), times(c.x, c.x), h], bits);
    let yy_sharp = sum_of_products([times(a.y, a.y), times(b.y, b.y), times(c.y, c.y)], bits);
    let xy = sum_of_products([times(a.x, a.y), times(b.x, b.y), times(c.x, c.y)], bits);
    let yy = sum_of_products([yy_sharp.term_within(bits), h], bits);
    let trace = sum_of_products([xx, yy_sharp].map(|v| v.term_within(bits)), bits);
    let [ab, ac, bc] = [minor(a, b, bits), minor(a, c, bits), minor(b, c, bits)];
    let determinant = sum_of_products(
        [
            times(ab, ab),
            times(ac, ac),
            times(bc, bc),
            low_pass.times_within(trace, low_pass.length() + bits),
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

/// det V' = sum_{j<k} (m_j x m_k)^2, without the low-pass filter: the same minors as in [`covariance`], rounded to the
/// design's mantissa.
pub fn sharp_determinant(widths: &Widths, [a, b, c]: &[ScreenAxis; 3]) -> SoftFloat {
    let bits = u32::from(widths.mantissa);
    let squares = [(a, b), (a, c), (b, c)].map(|(j, k)| {
        let minor = minor(j, k, bits);
        minor.times_within(minor, 2 * bits)
    });
    sum_of_products(squares, bits)
}

/// The 2x2 minor m_j x m_k. In line, where its width is known.
#[inline(always)]
pub(super) fn minor(j: &ScreenAxis, k: &ScreenAxis, bits: u32) -> SoftFloat {
    let crossed = j.y.times_within(k.x, 2 * bits).negated();
    sum_of_products([j.x.times_within(k.y, 2 * bits), crossed], bits)
}
