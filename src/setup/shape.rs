//! The quadratic form Q = (V' + V^h)^-1 in its two shapes: LDL for `spans`, conic for `box`.
//!
//! Q = 1/det (Vyy, -Vxy; -Vxy, Vxx). Completing the square along a row:
//! r = (Vyy/det) (dx - (Vxy/Vyy) dy)^2 + dy^2 / Vyy.

use super::covariance::Covariance2d;
use crate::footprint::{Conic, Ldl};
use crate::format::Widths;
use crate::math::{SoftFloat, reciprocal};

/// LDL coefficients; `None` where the variance has no inverse or a coefficient no place in the packet.
pub fn ldl(widths: &Widths, covariance: &Covariance2d) -> Option<Ldl> {
    let bits = u32::from(widths.mantissa);
    let vertical = reciprocal(covariance.yy, bits)?;
    let inverse = reciprocal(covariance.determinant, bits)?;
    let ldl = Ldl {
        horizontal: covariance.yy.multiply_within(inverse, bits),
        squared_width: covariance.determinant.multiply_within(vertical, bits),
        shear: packable_shear(covariance.xy.multiply_within(vertical, bits)),
        vertical,
    };
    [ldl.horizontal, ldl.squared_width, ldl.vertical]
        .into_iter()
        .all(packable)
        .then_some(ldl)
}

/// Is the exponent within the packet's 10 bits?
pub(super) fn packable(number: SoftFloat) -> bool {
    (-512..512).contains(&number.exponent)
}

/// A shear too small for the packet's exponent (0 included) moves no pixel: exactly 0.
pub(super) fn packable_shear(shear: SoftFloat) -> SoftFloat {
    if shear.exponent < -512 {
        SoftFloat {
            mantissa: 0,
            exponent: 0,
        }
    } else {
        shear
    }
}

/// Conic coefficients, aligned to the largest; `None` where the variance has no inverse.
///
/// `horizontal` is the first coefficient, Vyy / det, already computed for the LDL form.
pub fn conic(widths: &Widths, covariance: &Covariance2d, horizontal: SoftFloat) -> Option<Conic> {
    let bits = u32::from(widths.mantissa);
    let inverse = reciprocal(covariance.determinant, bits)?;
    let cross = covariance.xy.multiply_within(inverse, bits);
    let cross = SoftFloat {
        mantissa: -cross.mantissa,
        exponent: cross.exponent,
    };
    let coefficients = [
        horizontal,
        cross,
        covariance.xx.multiply_within(inverse, bits),
    ];
    let leading = coefficients
        .iter()
        .filter(|c| c.mantissa != 0)
        .map(|c| c.leading())
        .max()?;
    let exponent = leading.saturating_sub(bits as i32 - 1);
    let mantissa = coefficients.map(|c| c.scaled_by(exponent.saturating_neg()).to_fixed(0) as i32);
    (-512..512)
        .contains(&exponent)
        .then_some(Conic { mantissa, exponent })
}
