//! Input primitives.

pub mod surface;

use crate::math::{SoftFloat, square_root, sum_of_products};
use crate::view::{Eye, Pose};
use fixed::types::U4F28;

/// A centre as a file has it: a mantissa of at most 31 bits and an exponent for each coordinate, scene units. Exact for
/// any f32.
pub type Position = <Eye as Pose>::Centre;

/// A centre in Q7.24, scene units, for firmware that knows the range of its scene.
pub type FixedPosition = <crate::view::Translation as Pose>::Centre;

/// A volume splat: an elliptical Gaussian reconstruction kernel of variance `V = sum_k a_k a_k^T` (\[EWA\] 6.2).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VolumeSplat<C = Position> {
    /// Centre in scene units.
    pub centre: C,
    /// The three axes a_k, each one standard deviation long.
    pub axes: [Axis; 3],
    /// Peak opacity (rules with peak opacity), or extinction times volume in square scene units (normalised
    /// kernels; \[EWA\] eq. 5: g_k). Negative counts as 0.
    pub weight: SoftFloat,
    /// Linear red, green, blue, UQ4.28.
    pub colour: [U4F28; 3],
}

impl VolumeSplat {
    /// A splat that is nowhere visible: what memory lent for splats can be filled with; all its numbers are 0.
    pub const EMPTY: VolumeSplat = VolumeSplat {
        centre: [SoftFloat::ZERO; 3],
        axes: [Axis {
            mantissa: [0; 3],
            exponent: 0,
        }; 3],
        weight: SoftFloat::ZERO,
        colour: [U4F28::ZERO; 3],
    };
}

/// A spherical kernel: a volume splat of variance s^2 I, for which perspective can be exact (\[HYBRID\] 4.2).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphereSplat<C = Position> {
    /// Centre in scene units.
    pub centre: C,
    /// Standard deviation s in scene units, positive.
    pub deviation: SoftFloat,
    /// Peak opacity or extinction times volume, as for [`VolumeSplat`].
    pub weight: SoftFloat,
    /// Linear red, green, blue, UQ4.28.
    pub colour: [U4F28; 3],
}

/// A vector `mantissa * 2^exponent` in scene units: one exponent for the three components.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Axis {
    /// Components; the largest should use all 31 bits of magnitude. `i32::MIN` counts as `-i32::MAX`.
    pub mantissa: [i32; 3],
    /// Power of two, -512 to 511 (others are clamped).
    pub exponent: i32,
}

/// Why a covariance is not one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CovarianceError {
    /// A variance is negative, or a covariance is larger than its variances allow.
    Indefinite,
}

impl Axis {
    /// One vector from three normalised numbers: aligned to the largest, rounded to nearest.
    pub fn from_components(components: [SoftFloat; 3]) -> Axis {
        let leading = components
            .iter()
            .map(|c| {
                if c.mantissa == 0 {
                    i32::MIN
                } else {
                    c.leading()
                }
            })
            .max();
        let Some(leading) = leading.filter(|l| *l != i32::MIN) else {
            return Axis::default();
        };
        let exponent = leading.saturating_sub(29);
        let mantissa =
            components.map(|c| c.scaled_by(exponent.saturating_neg()).to_fixed(0) as i32);
        Axis { mantissa, exponent }
    }

    /// Axes of a covariance (xx, xy, xz, yy, yz, zz) in square scene units: the columns of its Cholesky factor.
    ///
    /// A semidefinite covariance gives axes of length 0. A pivot that is negative by no more than rounding (2^-24 of
    /// its variance) counts as 0; a clearly negative one is an error. Relative error 2^-28 of the largest entry per
    /// column.
    pub fn from_covariance(covariance: [SoftFloat; 6]) -> Result<[Axis; 3], CovarianceError> {
        const BITS: u32 = 31;
        let [xx, xy, xz, yy, yz, zz] = covariance;
        let l11 = pivot(xx, [SoftFloat::ZERO; 2], xx)?;
        let l21 = divide(xy, l11)?;
        let l31 = divide(xz, l11)?;
        let l22 = pivot(yy, [l21, SoftFloat::ZERO], yy)?;
        let cross = sum_of_products([yz.times(ONE), negate(l31).times(l21)], BITS);
        let l32 = divide(negligible(cross, yz), l22)?;
        let l33 = pivot(zz, [l31, l32], zz)?;
        Ok([
            Axis::from_components([l11, l21, l31]),
            Axis::from_components([SoftFloat::ZERO, l22, l32]),
            Axis::from_components([SoftFloat::ZERO, SoftFloat::ZERO, l33]),
        ])
    }
}

const ONE: SoftFloat = SoftFloat {
    mantissa: 1 << 30,
    exponent: -30,
};

fn negate(value: SoftFloat) -> SoftFloat {
    SoftFloat {
        mantissa: value.mantissa.saturating_neg(),
        exponent: value.exponent,
    }
}

/// sqrt(variance - a^2 - b^2), 0 where the difference is rounding noise of `scale`.
fn pivot(
    variance: SoftFloat,
    [a, b]: [SoftFloat; 2],
    scale: SoftFloat,
) -> Result<SoftFloat, CovarianceError> {
    let rest = sum_of_products(
        [variance.times(ONE), negate(a).times(a), negate(b).times(b)],
        31,
    );
    let rest = negligible(rest, scale);
    if rest.mantissa < 0 {
        Err(CovarianceError::Indefinite)
    } else {
        Ok(square_root(rest, 31))
    }
}

/// 0 where `value` is below 2^-24 of `scale`.
fn negligible(value: SoftFloat, scale: SoftFloat) -> SoftFloat {
    if value.leading() < scale.leading().saturating_sub(24) {
        SoftFloat::ZERO
    } else {
        value
    }
}

/// `value / pivot`; a zero pivot allows only a zero value.
fn divide(value: SoftFloat, pivot: SoftFloat) -> Result<SoftFloat, CovarianceError> {
    match crate::math::reciprocal(pivot, 31) {
        Some(inverse) => Ok(value.multiply(inverse, 31)),
        None if value.mantissa == 0 => Ok(SoftFloat::ZERO),
        None => Err(CovarianceError::Indefinite),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn scaled(value: f64) -> SoftFloat {
        SoftFloat::from_wide((value * 2f64.powi(40)) as i64, -40, 31)
    }

    fn vectors(axes: [Axis; 3]) -> [[f64; 3]; 3] {
        axes.map(|a| a.mantissa.map(|m| m as f64 * (a.exponent as f64).exp2()))
    }

    proptest! {
        #![proptest_config(ProptestConfig { max_global_rejects: 16, ..ProptestConfig::default() })]

        #[test]
        fn axes_reproduce_the_covariance(rows in proptest::array::uniform3(proptest::array::uniform3(-8.0f64..8.0))) {
            let entry = |i: usize, j: usize| rows.iter().map(|r| r[i] * r[j]).sum::<f64>();
            let exact = [entry(0, 0), entry(0, 1), entry(0, 2), entry(1, 1), entry(1, 2), entry(2, 2)];
            // Next to singular, rounding may make it indefinite: those are replaced by others, and the test fails if
            // that is more than rare.
            let Ok(axes) = Axis::from_covariance(exact.map(scaled)) else {
                return Err(TestCaseError::reject("indefinite"));
            };
            let a = vectors(axes);
            let back = |i: usize, j: usize| a.iter().map(|r| r[i] * r[j]).sum::<f64>();
            let got = [back(0, 0), back(0, 1), back(0, 2), back(1, 1), back(1, 2), back(2, 2)];
            let largest = exact[0].max(exact[3]).max(exact[5]);
            for (g, e) in got.iter().zip(exact) {
                prop_assert!((g - e).abs() <= largest * 1e-7, "{got:?} {exact:?}");
            }
        }
    }

    /// A digest of words that have 31 bits all the way; noise below 2^-24 of its scale alone counts as 0.
    #[test]
    fn axes_are_these_words() {
        let words = (0..4000i64).flat_map(|index| {
            let part = |factor: i64| (index * factor % 2001) as f64 / 1000.0 - 1.0;
            let scale = |factor: i64| scaled(3.0 + part(factor));
            let [xy, xz, yz] = [881, 1427, 613].map(|factor| scaled(part(factor)));
            let covariance = [scale(337), xy, xz, scale(769), yz, scale(1733)];
            let axes = Axis::from_covariance(covariance).unwrap();
            axes.into_iter()
                .flat_map(|axis| axis.mantissa)
                .map(|word| word as u64)
        });
        assert_eq!(crate::digest(words), 3_097_565_263_094_872_409);
        let value = |exponent| SoftFloat {
            mantissa: 1 << 30,
            exponent,
        };
        assert_eq!(negligible(value(-24), value(0)), value(-24));
        assert_eq!(negligible(value(-25), value(0)), SoftFloat::ZERO);
    }

    #[test]
    fn singular_is_fine_and_indefinite_is_not() {
        let flat = [4.0, 2.0, 0.0, 1.0, 0.0, 9.0].map(scaled);
        assert_eq!(
            vectors(Axis::from_covariance(flat).unwrap()),
            [[2.0, 1.0, 0.0], [0.0; 3], [0.0, 0.0, 3.0]]
        );
        let saddle = [1.0, 2.0, 0.0, 1.0, 0.0, 1.0].map(scaled);
        assert_eq!(
            Axis::from_covariance(saddle),
            Err(CovarianceError::Indefinite)
        );
        let negative = [-1.0, 0.0, 0.0, 1.0, 0.0, 1.0].map(scaled);
        assert_eq!(
            Axis::from_covariance(negative),
            Err(CovarianceError::Indefinite)
        );
        assert_eq!(
            Axis::from_covariance([SoftFloat::ZERO; 6]),
            Ok([Axis::default(); 3])
        );
    }
}
