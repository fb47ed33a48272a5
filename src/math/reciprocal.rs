//! Reciprocal of a normalised number: a table with linear interpolation, then one Newton step.
//!
//! With x in [1, 2) split into i/256 and a rest, the chord through 1/(1 + i/256) and its neighbour is at most
//! `h^2/8 * max f'' = 2^-16 / 8 * 2 = 2^-18` too large. Lowering each entry by half of the mean excess would centre it,
//! but the Newton step `y' = y + y (1 - x y)` squares the error to 2^-36 anyway, below every mantissa in use, and is
//! exact enough without. Designs of at most 16 bits skip the step.

use super::shift::shift_round;
use super::soft_float::SoftFloat;
use super::words::{leading_zeros, product};

const INTERVALS: usize = 256;

/// 1/(1 + i/256) in UQ1.30, rounded to nearest.
pub static RECIPROCALS: [u32; INTERVALS + 1] = {
    let mut table = [0; INTERVALS + 1];
    let mut i = 0;
    while i <= INTERVALS {
        let divisor = (INTERVALS + i) as u64;
        table[i] = (((1u64 << 30) * INTERVALS as u64 + divisor / 2) / divisor) as u32;
        i += 1;
    }
    table
};

/// `1 / value` rounded to `bits`. The sign is kept; 0 gives `None`.
///
/// Relative error: at most `2^-bits + 2^-29` for `bits > 16`, `2^-bits + 2^-17.9` below (tested exhaustively at 16
/// bits).
#[cfg_attr(target_pointer_width = "32", inline(never))]
pub fn reciprocal(value: SoftFloat, bits: u32) -> Option<SoftFloat> {
    if value.mantissa == 0 {
        return None;
    }
    // x in [1, 2) as UQ1.31: value = +-x * 2^leading.
    let magnitude = value.mantissa.unsigned_abs();
    let x = magnitude << leading_zeros(magnitude);
    let index = ((x >> 23) & 0xff) as usize;
    let rest = (x & 0x7f_ffff) as i32;
    let low = RECIPROCALS[index & 0xff] as i32;
    let high = RECIPROCALS[(index & 0xff) + 1] as i32;
    let seed = low + shift_round(product(high - low, rest), 23) as i32;
    let signed = |result: i64| if value.mantissa < 0 { -result } else { result };
    let exponent = (-60i32).saturating_sub(value.leading());
    Some(if bits > 16 {
        SoftFloat::from_wide(signed(newton(x, seed)), exponent, bits)
    } else {
        SoftFloat::from_word(
            signed(seed.into()) as i32,
            exponent.saturating_add(30),
            bits,
        )
    })
}

/// y (2 - x y) in UQ1.60 from y in UQ1.30 and x in UQ1.31, whose leading bit is set.
#[inline(always)]
fn newton(x: u32, seed: i32) -> i64 {
    let wide = i64::from(seed);
    // 2 - x y, but for the 2^61 that leaves the word below; as a signed number x is 2^32 less.
    let defect = -((wide << 32) + product(x as i32, seed));
    // |defect| < 2^-17 in Q61, so 31 of its bits are kept for the product.
    (wide << 30) + shift_round(product(seed, shift_round(defect, 14) as i32), 17)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn relative_error(mantissa: i32, bits: u32) -> f64 {
        let got = reciprocal(
            SoftFloat {
                mantissa,
                exponent: 0,
            },
            bits,
        )
        .unwrap();
        (got.mantissa as f64 * (got.exponent as f64).exp2() * mantissa as f64 - 1.0).abs()
    }

    #[test]
    fn exhaustive_at_16_bits() {
        let worst = (1i32 << 15..1 << 16)
            .map(|m| relative_error(m, 16))
            .fold(0.0, f64::max);
        assert!(
            worst < 2f64.powi(-16) + 2f64.powf(-17.9),
            "{:.2} bits",
            -worst.log2()
        );
        // The step that longer results take would do better.
        assert!(worst > 2f64.powi(-16) + 2f64.powi(-28));
    }

    #[test]
    fn wide_mantissas() {
        for bits in [18, 24, 31] {
            let worst = (0..200_000u64)
                .map(|i| relative_error(((1u64 << 30) + i * 5368 + i * i % 4099) as i32, bits))
                .fold(0.0, f64::max);
            assert!(
                worst < 2f64.powi(-(bits as i32)) + 2f64.powi(-29),
                "{bits}: {:.2} bits",
                -worst.log2()
            );
        }
    }

    #[test]
    fn ends_of_the_format() {
        assert_eq!(reciprocal(SoftFloat::ZERO, 24), None);
        for mantissa in [1, -1, i32::MIN, i32::MAX, -2, 3] {
            for exponent in [i32::MIN, -70, 0, 70, i32::MAX] {
                let got = reciprocal(SoftFloat { mantissa, exponent }, 24).unwrap();
                assert_eq!(got.mantissa < 0, mantissa < 0);
            }
        }
    }
}
