//! The quadratic form Q = (V' + V^h)^-1 in its two shapes: LDL for `spans`, conic for `box`.
//!
//! Q = 1/det (Vyy, -Vxy; -Vxy, Vxx). Completing the square along a row:
//! r = (Vyy/det) (dx - (Vxy/Vyy) dy)^2 + dy^2 / Vyy.

use super::variance::Variance;
use crate::footprint::{Conic, Scan};
use crate::format::Widths;
use crate::math::{Scaled, reciprocal};

/// LDL coefficients; `None` where the variance has no inverse or a coefficient no place in the packet.
pub fn scan(widths: &Widths, variance: &Variance) -> Option<Scan> {
    let bits = u32::from(widths.mantissa);
    let stretch = reciprocal(variance.yy, bits)?;
    let inverse = reciprocal(variance.determinant, bits)?;
    let scan = Scan {
        curvature: variance.yy.multiply(inverse, bits),
        spread: variance.determinant.multiply(stretch, bits),
        slope: packable_slope(variance.xy.multiply(stretch, bits)),
        stretch,
    };
    [scan.curvature, scan.spread, scan.stretch]
        .into_iter()
        .all(packable)
        .then_some(scan)
}

/// Is the exponent within the packet's 10 bits?
fn packable(number: Scaled) -> bool {
    (-512..512).contains(&number.exponent)
}

/// A slope too small for the packet's exponent (0 included) moves no pixel: exactly 0.
fn packable_slope(slope: Scaled) -> Scaled {
    if slope.exponent < -512 {
        Scaled {
            mantissa: 0,
            exponent: 0,
        }
    } else {
        slope
    }
}

/// Conic coefficients, aligned to the largest; `None` where the variance has no inverse.
///
/// `curvature` is the first coefficient, Vyy / det, already computed for the LDL form.
pub fn conic(widths: &Widths, variance: &Variance, curvature: Scaled) -> Option<Conic> {
    let bits = u32::from(widths.mantissa);
    let inverse = reciprocal(variance.determinant, bits)?;
    let cross = variance.xy.multiply(inverse, bits);
    let cross = Scaled {
        mantissa: -cross.mantissa,
        exponent: cross.exponent,
    };
    let coefficients = [curvature, cross, variance.xx.multiply(inverse, bits)];
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
