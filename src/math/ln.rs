//! Natural logarithm, exact enough to decide: where a footprint's opacity falls below a threshold.
//!
//! With x in [1, 2) in the middle of 32 intervals, a table has a = 1/middle in 16 bits and -ln a. So x a = 1 + d
//! exactly, |d| <= 2^-6, and
//!
//! ```text
//! ln(m 2^e) = e ln 2 - ln a + d - d^2 (1/2 - d (1/3 - d (1/4 - d/5)))
//! ```
//!
//! The series ends `d^6/6 < 2^-38` short, the table is rounded at `2^-33`, and five products of 32 bits do it.

use super::shift::shift_round;
use super::soft_float::SoftFloat;
use super::words::{leading_zeros, product};

const INTERVALS: usize = 32;

/// ln 2 with 40 fraction bits.
pub const LN_2: i64 = (logarithm(2 << 60) + (1 << 19)) >> 20;

/// For each interval 1/middle in UQ0.16, rounded, and minus its logarithm in UQ0.32.
pub static LOGARITHMS: [u32; 2 * INTERVALS] = {
    let mut table = [0; 2 * INTERVALS];
    let mut i = 0;
    while i < INTERVALS {
        let middle = (2 * INTERVALS + 2 * i + 1) as u64;
        let inverse = (((2 * INTERVALS as u64) << 16) + middle / 2) / middle;
        let exact = logarithm((1u128 << 76) / inverse as u128);
        table[2 * i] = inverse as u32;
        table[2 * i + 1] = ((exact + (1 << 27)) >> 28) as u32;
        i += 1;
    }
    table
};

/// ln y for y in [1, 2], both with 60 fraction bits: 2 artanh((y - 1) / (y + 1)) by its series.
const fn logarithm(y: u128) -> i64 {
    let one = 1i128 << 60;
    let z = ((y as i128 - one) << 60) / (y as i128 + one);
    let square = (z * z) >> 60;
    let mut power = z;
    let mut sum = 0;
    let mut n = 1;
    while n <= 41 {
        sum += power / n;
        power = (power * square) >> 60;
        n += 2;
    }
    (2 * sum) as i64
}

/// Fraction bits of d.
pub const REST: u32 = 36;

/// 1/n in Q1.30, rounded towards 0, with the sign of n: the coefficients of the series. 0 gives the largest word.
pub const fn fraction(n: i64) -> i32 {
    if n == 0 {
        return i32::MAX;
    }
    ((1 << 30) / n) as i32
}

/// ln(value) in Q31.32, within `2^-31`; `None` unless `value > 0`. Leading bits beyond `2^20` count as there.
#[cfg_attr(target_pointer_width = "32", inline(never))]
pub const fn ln(value: SoftFloat) -> Option<i64> {
    const LARGEST: i32 = 1 << 20;
    if value.mantissa <= 0 {
        return None;
    }
    let magnitude = value.mantissa.unsigned_abs();
    // The mantissa has 31 bits, so that nothing is lost below x in UQ1.30.
    let x = (magnitude << leading_zeros(magnitude)) >> 1;
    let index = ((x >> 25) & 31) as usize;
    let [inverse, offset] = [LOGARITHMS[2 * index], LOGARITHMS[2 * index + 1]];
    let rest = shift_round(product(x as i32, inverse as i32) - (1 << 46), 46 - REST);
    let d = rest as i32;
    let inner = fraction(4) - shift_round(product(d, fraction(5)), REST) as i32;
    let inner = fraction(3) - shift_round(product(d, inner), REST) as i32;
    let inner = fraction(2) - shift_round(product(d, inner), REST) as i32;
    let bent = shift_round(product(d, inner), 30) as i32;
    let below = (rest << (40 - REST)) - shift_round(product(d, bent), 2 * REST - 40);
    let leading = value.leading();
    let leading = if leading > LARGEST {
        LARGEST
    } else if leading < -LARGEST {
        -LARGEST
    } else {
        leading
    };
    let sum = leading as i64 * LN_2 + ((offset as i64) << 8) + below;
    Some(shift_round(sum, 8))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error(mantissa: i32, exponent: i32) -> f64 {
        let got = ln(SoftFloat { mantissa, exponent }).unwrap() as f64 / 2f64.powi(32);
        let exact = f64::from(mantissa).ln() + f64::from(exponent) * 2f64.ln();
        (got - exact).abs()
    }

    #[test]
    fn close_everywhere() {
        let all = (1..1_000_000).chain((1 << 30..i32::MAX).step_by(9973));
        for mantissa in all.chain([i32::MAX]) {
            let error = error(mantissa, -30);
            assert!(error <= 2f64.powi(-31), "{mantissa}: {error:e}");
        }
        for sixteenth in 0..=16u32 {
            let y = 1.0 + f64::from(sixteenth) / 16.0;
            let found = logarithm(u128::from(16 + sixteenth) << 56) as f64 / 2f64.powi(60);
            assert!((found - y.ln()).abs() < 2f64.powi(-52), "{y}: {found}");
        }
        assert_eq!(logarithm(1 << 60), 0);
        for exponent in -60..60 {
            assert!(
                error(1_234_567_891, exponent) <= 2f64.powi(-30),
                "{exponent}"
            );
        }
    }

    #[test]
    fn a_fraction_of_anything_is_defined() {
        let table = [
            (0, i32::MAX),
            (1, 1 << 30),
            (-1, -1 << 30),
            (3, 357_913_941),
            (-3, -357_913_941),
            (1 << 30, 1),
            ((1 << 30) + 1, 0),
            (i64::MIN, 0),
            (i64::MAX, 0),
        ];
        for (n, expected) in table {
            assert_eq!(fraction(n), expected, "1/{n}");
        }
    }

    #[test]
    fn every_bit_pattern_is_defined() {
        assert_eq!(ln(SoftFloat::ZERO), None);
        assert_eq!(
            ln(SoftFloat {
                mantissa: -1,
                exponent: 0
            }),
            None
        );
        for exponent in [i32::MIN, i32::MAX] {
            assert!(
                ln(SoftFloat {
                    mantissa: 1,
                    exponent
                })
                .is_some_and(|logarithm| (logarithm < 0) == (exponent < 0))
            );
        }
        assert_eq!(
            ln(SoftFloat {
                mantissa: 1,
                exponent: 0
            }),
            Some(0)
        );
    }
}
