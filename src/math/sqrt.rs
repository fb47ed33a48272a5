//! Square root: a table with linear interpolation, then one Heron step through the reciprocal unit.
//!
//! The argument is brought to [1/4, 1) by an even shift. The chord between entries at i/256 is at most
//! `h^2/8 * max |f''| = 2^-19 * 2 = 2^-18` too small at 1/4, a relative error of 2^-17. The row unit uses that seed as
//! it is (its spans are made conservative by far more); setup adds `s' = (s + x/s)/2`, which leaves `e^2/2 = 2^-35`.

use super::reciprocal::reciprocal;
use super::soft_float::{SoftFloat, sum_below};
use super::words::{leading_zeros, leading_zeros_wide, shifted_up};

const FIRST: usize = 64;
const LAST: usize = 256;

/// sqrt(i/256) in UQ0.24 for i = 64 ..= 256, rounded to nearest.
pub static ROOTS: [u32; LAST - FIRST + 1] = {
    let mut table = [0; LAST - FIRST + 1];
    let mut i = FIRST;
    while i <= LAST {
        let scaled = (i as u64) << 42; // (i / 256) * 2^50: its root has 25 fraction bits, one to round with
        table[i - FIRST] = ((scaled.isqrt() + 1) >> 1) as u32;
        i += 1;
    }
    table
};

/// Square root of a 64-bit integer as `(root, shift)`: `sqrt(value) = root * 2^shift`, `root` in UQ0.24 of the range
/// [1/2, 1).
///
/// Relative error below 2^-16.9 (tested). 0 gives `(0, 0)`. The shift lies in -23 ..= 8.
#[inline]
pub fn root_seed(value: u64) -> (u32, i32) {
    if value == 0 {
        return (0, 0);
    }
    let even = leading_zeros_wide(value) & !1;
    let normal = (shifted_up(value, even) >> 32) as u32;
    (root_of(normal), 8 - (even / 2) as i32)
}

/// The root of a number of [1/4, 1) in UQ0.32, UQ0.24 of [1/2, 1): of its upper two bits one is set. The lowest eight
/// bits do not count.
///
/// Smaller numbers, which [`root_seed`] and [`square_root`] never ask for, give roots of the table's first interval: at
/// least 1/2, below 0.504.
#[inline(always)]
pub fn root_of(normal: u32) -> u32 {
    // Saturating, so that neither place needs a comparison.
    let place = ((normal >> 24) as usize).saturating_sub(FIRST);
    let rest = (normal >> 8) & 0xffff;
    let at = |place: usize| ROOTS.get(place).copied().unwrap_or(0);
    let (low, high) = (at(place), at(place + 1));
    // Entries are at most 65,282 apart (between 64/256 and 65/256), so that the product and half a unit fit 32 bits.
    let step = high.wrapping_sub(low).wrapping_mul(rest);
    low.wrapping_add(step.wrapping_add(1 << 15) >> 16)
}

/// Square root rounded to `bits`; negative numbers and 0 give 0.
///
/// Relative error at most `2^-bits + 2^-29` for `bits > 16`, `2^-bits + 2^-16.9` below.
#[cfg_attr(target_pointer_width = "32", inline(never))]
pub fn square_root(value: SoftFloat, bits: u32) -> SoftFloat {
    if value.mantissa <= 0 {
        return SoftFloat::ZERO;
    }
    let odd = value.exponent & 1;
    let shifted = (value.mantissa as u32) << odd;
    let even = leading_zeros(shifted) & !1;
    let half = (value.exponent - odd) / 2;
    let exponent = half.saturating_sub(8 + (even / 2) as i32);
    // 24 bits of [1/2, 1), of which the leading one is set.
    let seed = SoftFloat {
        mantissa: (root_of(shifted << even) << 7) as i32,
        exponent: exponent.saturating_sub(7),
    };
    if bits <= 16 {
        return SoftFloat::from_word(seed.mantissa, seed.exponent, bits);
    }
    let Some(inverse) = reciprocal(seed, 31) else {
        return SoftFloat::ZERO;
    };
    // Seed and quotient are the same but for 2^-16, so that the seed's exponent says where the window lies.
    let terms = [
        seed.scaled_by(-1).term_within(31),
        value.times(inverse.scaled_by(-1)),
    ];
    sum_below(terms, seed.exponent.saturating_add(31), bits)
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    #[test]
    fn seed_is_good_to_almost_17_bits() {
        let mut worst: f64 = 0.0;
        let mut value: u64 = 1;
        while value < u64::MAX / 3 {
            for candidate in [value, value + value / 3, value + value / 7] {
                let (root, shift) = root_seed(candidate);
                let got = root as f64 * (shift as f64).exp2();
                worst = worst.max((got / (candidate as f64).sqrt() - 1.0).abs());
            }
            value += value / 97 + 1;
        }
        assert!(worst < 2f64.powf(-16.9), "{:.2} bits", -worst.log2());
    }

    /// The same by shifts of 64 bits.
    #[test]
    fn seeds_by_words_are_seeds() {
        let mut value: u64 = 1;
        while value < u64::MAX / 3 {
            for candidate in [value, value + value / 3, value.rotate_left(7)] {
                let even = candidate.leading_zeros() & !1;
                let normal = candidate << even;
                let at = |i: u64| i64::from(ROOTS[i as usize - FIRST]);
                let (low, high) = (at(normal >> 56), at((normal >> 56) + 1));
                let step = (high - low) * ((normal >> 40) & 0xffff) as i64;
                let expected = (low + ((step + (1 << 15)) >> 16), 8 - (even / 2) as i32);
                let (root, shift) = root_seed(candidate);
                assert_eq!((i64::from(root), shift), expected, "{candidate}");
            }
            value += value / 97 + 1;
        }
    }

    #[test]
    fn wide_roots() {
        let mut words = std::vec::Vec::new();
        for bits in [12, 16, 18, 24, 31] {
            let bound = 2f64.powi(-(bits as i32))
                + if bits > 16 {
                    2f64.powi(-29)
                } else {
                    2f64.powf(-16.9)
                };
            let mut worst = 0.0f64;
            for i in 1..100_000i64 {
                let mantissa = (i * 21_473) as i32;
                for exponent in [-7, 6] {
                    let exact = (mantissa as f64 * (exponent as f64).exp2()).sqrt();
                    let got = square_root(SoftFloat { mantissa, exponent }, bits);
                    let error =
                        (got.mantissa as f64 * (got.exponent as f64).exp2() / exact - 1.0).abs();
                    worst = worst.max(error);
                    words.push(got.mantissa as u64);
                    assert!(
                        error <= bound,
                        "{bits} bits: {mantissa} {exponent}: {:.2}",
                        -error.log2()
                    );
                }
            }
            // The seed alone: the step of longer results would do better.
            assert!(bits != 16 || worst > 2f64.powi(-16) + 2f64.powi(-28));
        }
        assert_eq!(crate::digest(words), 14_609_316_306_886_978_586);
    }

    #[test]
    fn ends_of_the_format() {
        assert_eq!(root_seed(0), (0, 0));
        assert_eq!(root_seed(u64::MAX), ((1 << 24) - 1, 8));
        assert_eq!(root_seed(1), (1 << 23, -23));
        // Below its range a root is one of the first interval.
        for normal in [0, 1, 255, 1 << 24, (1 << 30) - 1] {
            let root = f64::from(root_of(normal)) / 2f64.powi(24);
            assert!((0.5..0.504).contains(&root), "{normal}: {root}");
        }
        for mantissa in [i32::MIN, -1, 0, 1, i32::MAX] {
            for exponent in [i32::MIN, -1, 0, 1, i32::MAX] {
                let got = square_root(SoftFloat { mantissa, exponent }, 24);
                assert_eq!(got.mantissa > 0, mantissa > 0);
            }
        }
    }
}
