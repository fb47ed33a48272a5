//! The deep alpha channel in double precision (\[SWAN\] 6): what all three representations stand for.
//!
//! N layers of opacity a leave T = (1 - a)^N = exp(-N tau) with the optical depth tau = -ln(1 - a) of a layer (\[EWA\] eq. 4).
//! The recurrences A' = A + (1 - A) a, T' = T (1 - a) and D' = D + tau are the same number; a test compares them.

/// Transmittance of `layers` layers of opacity `alpha` (0 to 1), 0 to 1.
pub fn transmittance(alpha: f64, layers: u32) -> f64 {
    (f64::from(layers) * (-alpha).ln_1p()).exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rounding of 10^5 operations in double precision.
    const TOLERANCE: f64 = 1e-11;

    #[test]
    fn the_three_representations_are_one_number() {
        for exponent in 1..=16 {
            let alpha = f64::from(-exponent).exp2();
            let (mut opacity, mut rest, mut depth) = (0.0, 1.0, 0.0);
            for layer in 1..=100_000 {
                opacity += (1.0 - opacity) * alpha;
                rest *= 1.0 - alpha;
                depth -= (1.0 - alpha).ln();
                let exact = transmittance(alpha, layer);
                for other in [1.0 - opacity, rest, f64::exp(-depth)] {
                    assert!(
                        (other - exact).abs() < TOLERANCE,
                        "2^-{exponent}, layer {layer}"
                    );
                }
            }
        }
    }
}
