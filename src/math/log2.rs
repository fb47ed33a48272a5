//! Base-2 logarithm, rounded up: how far a footprint reaches before its opacity falls below a threshold.
//!
//! log2(m 2^e) = e + log2(m); the fraction is a 32-interval table with linear interpolation. The chord of a
//! concave function lies below it by at most `h^2/8 * 1/ln 2 = 1.8e-4`, so 2^-12 is added and the result is never
//! too small. It only bounds the pixels visited; each pixel still compares its own opacity.

use super::scaled::Scaled;
use super::words::leading_zeros;

/// log2(1 + i/32) in UQ1.16: `log2` by repeated squaring, one bit of the result per step.
pub static LOGARITHMS: [u32; 33] = {
    let mut table = [0; 33];
    let mut i = 0;
    while i <= 32 {
        let mut x = ((32 + i) as u64) << 26; // UQ1.31
        let mut bits = 0u32;
        if i == 32 {
            bits = 1 << 16;
        } else {
            let mut step = 0;
            while step < 16 {
                x = (x * x) >> 31;
                bits <<= 1;
                if x >= 1 << 32 {
                    bits |= 1;
                    x >>= 1;
                }
                step += 1;
            }
        }
        table[i] = bits;
        i += 1;
    }
    table
};

/// An upper bound of log2(value) in Q15.16, less than 2^-11 too large; `None` unless `value > 0`.
pub fn log2_upper(value: Scaled) -> Option<i32> {
    if value.mantissa <= 0 {
        return None;
    }
    let magnitude = value.mantissa.unsigned_abs();
    let x = magnitude << leading_zeros(magnitude);
    let index = ((x >> 26) & 31) as usize;
    let rest = (x >> 10) & 0xffff;
    let low = LOGARITHMS[index & 31];
    let high = LOGARITHMS[(index & 31) + 1];
    let fraction = low + (((high - low) * rest) >> 16) + (1 << 4) + 2;
    Some(value.leading().clamp(-0x7000, 0x7000) * (1 << 16) + fraction as i32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_from_above_and_closely() {
        for mantissa in (1..2_000_000).chain([i32::MAX]) {
            let got = log2_upper(Scaled {
                mantissa,
                exponent: -9,
            })
            .unwrap() as f64
                / 65536.0;
            let exact = (mantissa as f64).log2() - 9.0;
            assert!(
                got >= exact && got - exact < 2f64.powi(-11),
                "{mantissa}: {got} {exact}"
            );
        }
        assert_eq!(log2_upper(Scaled::ZERO), None);
        assert!(
            log2_upper(Scaled {
                mantissa: 1,
                exponent: i32::MAX
            })
            .is_some()
        );
    }
}
