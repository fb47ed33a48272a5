//! Edge antialiasing (SURF 7): the weight sum of a pixel as its coverage.
//!
//! Inside a surface the weights of a pixel sum to about 1; toward an edge the sum falls to 0 within a splat's radius.
//! Below a threshold tau it is taken for coverage, q' = min(1, q / tau), by which colour and opacity of the fragment
//! are scaled. SURF uses tau = 0.4. Without the filter every pixel that any splat touches is fully covered.

use crate::math::{Product, SoftFloat, reciprocal};

/// The division by tau as a multiplication.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EdgeFilter {
    inverse: SoftFloat,
}

/// tau = 0.4 in UQ0.30, the threshold of SURF 7.
pub const USUAL_THRESHOLD: u32 = 429_496_730;

impl EdgeFilter {
    /// A filter with the threshold tau in UQ2.30; `None` for 0.
    pub fn new(threshold: u32) -> Option<EdgeFilter> {
        let threshold = SoftFloat::from_wide(threshold.into(), -30, 31);
        let inverse = reciprocal(threshold, 31)?;
        Some(EdgeFilter { inverse })
    }

    /// q' = min(1, q / tau) in UQ1.30 from the weight sum q in UQ7.fraction. Relative error below 2^-28.
    #[inline(always)]
    pub fn coverage(&self, weight: u32, fraction: u8) -> u32 {
        let quotient = Product::new(
            i64::from(weight.min(i32::MAX as u32)) * i64::from(self.inverse.mantissa),
            self.inverse.exponent.saturating_sub(fraction.into()),
        );
        quotient.to_fixed(30).clamp(0, 1 << 30) as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coverage_rises_to_one_at_the_threshold() {
        let filter = EdgeFilter::new(USUAL_THRESHOLD).unwrap();
        let table = [
            (0.0, 0.0),
            (0.1, 0.25),
            (0.2, 0.5),
            (0.3, 0.75),
            (0.4, 1.0),
            (5.0, 1.0),
        ];
        for (q, expected) in table {
            let got = f64::from(filter.coverage((q * 2f64.powi(24)) as u32, 24)) / 2f64.powi(30);
            assert!((got - expected).abs() < 1e-6, "q = {q}: {got}");
        }
        assert_eq!(
            (filter.coverage(0, 24), filter.coverage(u32::MAX, 4)),
            (0, 1 << 30)
        );
        assert!(EdgeFilter::new(0).is_none());
    }

    /// Half a unit of the reciprocal, half of the result's rounding.
    #[test]
    fn coverage_is_the_quotient_to_a_unit() {
        for step in 1..20_000u32 {
            let threshold = step * 107_374;
            let filter = EdgeFilter::new(threshold).unwrap();
            for part in [7u64, 8, 9] {
                let weight = (u64::from(threshold) * part / 10) as u32;
                let exact = f64::from(weight) / f64::from(threshold) * 2f64.powi(30);
                let found = f64::from(filter.coverage(weight, 30));
                assert!(
                    (found - exact).abs() <= 1.01,
                    "{weight} of {threshold}: {found}, {exact}"
                );
            }
        }
    }

    #[test]
    fn inverses_are_these() {
        let mut next = crate::random();
        let words =
            (0..1000).map(|_| EdgeFilter::new(next() as u32 | 1).unwrap().inverse.mantissa as u64);
        assert_eq!(crate::digest(words), 9_182_996_439_456_832_484);
    }
}
