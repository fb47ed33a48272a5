//! Perspective-correct footprint index of a sphere (\[HYBRID\] 4.2).
//!
//! An affine footprint indexes its table by the fraction i of its radius on the screen. What the kernel really depends
//! on is the distance of the ray from the sphere's centre. With a the half-angle under which the affine radius is seen,
//!
//! ```text
//! d = sin(atan(i tan a)) / tan a
//! ```
//!
//! Squared and in terms of the radial index r = i^2 c (c the cut-off, in variances) this needs no trigonometry:
//! sin^2(atan x) = x^2 / (1 + x^2), hence
//!
//! ```text
//! r' = r / (1 + r s),   s = tan^2 a / c
//! ```
//!
//! where s, the *spread*, is the variance of the kernel over the squared distance of its centre from the eye. The table
//! over (i, a) is a table over (r, s) here; between its entries it is bilinear. Beyond the table (r >= 4 or s >= 1/16:
//! spheres that fill more than 53 degrees) the formula is evaluated with the reciprocal unit.

use crate::math::{SoftFloat, reciprocal, shift_round};

/// Base-2 logarithms of the intervals along r (0 to 4) and along s (0 to 1/16).
const RADIAL_LOG2: u32 = 6;
const SPREAD_LOG2: u32 = 5;
const COLUMNS: usize = (1 << RADIAL_LOG2) + 1;
const ROWS: usize = (1 << SPREAD_LOG2) + 1;

/// Entries of the table.
pub const PERSPECTIVE_ENTRIES: usize = COLUMNS * ROWS;

/// Fraction bits of radial indices inside this unit: UQ4.28.
const FRACTION: u32 = 28;

/// The two-index table, in memory that the caller lends or in a constant.
#[derive(Clone, Copy, Debug)]
pub struct PerspectiveTable<'a> {
    entries: &'a [u32; PERSPECTIVE_ENTRIES],
}

/// The correction for one footprint: its row of the table, or the formula.
#[derive(Clone, Copy, Debug)]
pub struct PerspectiveIndex<'a> {
    /// Two rows of the table and the position between them, UQ0.16; none beyond the table.
    rows: Option<([&'a [u32]; 2], i64)>,
    spread: u32,
    radial_bits: u32,
}

/// Fills the table: r / (1 + r s) in UQ4.28, rounded to nearest; evaluates at compile time for firmware.
pub const fn fill_perspective(table: &mut [u32; PERSPECTIVE_ENTRIES]) {
    let mut row = 0;
    while row < ROWS {
        let mut column = 0;
        while column < COLUMNS {
            let radial = (column as u64) << (FRACTION + 2 - RADIAL_LOG2);
            // 1 + r s in UQ.34: r s = (column 2^-4) (row 2^-9).
            let divisor = (1u64 << 34) + ((column as u64 * row as u64) << (34 - 4 - 9));
            let value = ((radial as u128) << 34) + divisor as u128 / 2;
            table[row * COLUMNS + column] = (value / divisor as u128) as u32;
            column += 1;
        }
        row += 1;
    }
}

impl<'a> PerspectiveTable<'a> {
    /// Looks up in `entries`, which [`fill_perspective`] filled.
    pub const fn new(entries: &'a [u32; PERSPECTIVE_ENTRIES]) -> Self {
        PerspectiveTable { entries }
    }

    /// The correction for a footprint of `spread` (UQ0.32) with `radial_bits` fraction bits of r; more than 44 count as
    /// 44.
    pub fn index(&self, spread: u32, radial_bits: u32) -> PerspectiveIndex<'a> {
        let row = (spread >> (32 - 4 - SPREAD_LOG2)) as usize;
        let start = row * COLUMNS;
        let low = self.entries.get(start..start + COLUMNS);
        let high = self.entries.get(start + COLUMNS..start + 2 * COLUMNS);
        let between = (spread >> (32 - 4 - SPREAD_LOG2 - 16)) & 0xffff;
        let rows = match (low, high) {
            (Some(low), Some(high)) => Some(([low, high], i64::from(between))),
            _ => None,
        };
        PerspectiveIndex {
            rows,
            spread,
            radial_bits: radial_bits.min(44),
        }
    }
}

impl PerspectiveIndex<'_> {
    /// r' = r / (1 + r s) for r in UQ4.radial, in the same format.
    ///
    /// Error at most 6.2e-5 in the table (bilinear, tested), 2^-27 r beyond.
    #[inline(always)]
    pub fn correct(&self, radial: u64) -> u64 {
        let common = crate::math::shift_unsigned(
            radial,
            self.radial_bits as i32 - FRACTION as i32,
            crate::format::Rounding::Nearest,
        );
        let corrected = self
            .looked_up(common)
            .unwrap_or_else(|| evaluate(common, self.spread));
        crate::math::shift_unsigned(
            corrected,
            FRACTION as i32 - self.radial_bits as i32,
            crate::format::Rounding::Nearest,
        )
    }

    /// Bilinear interpolation: along r in both rows, then between the rows; three multiplications.
    #[inline(always)]
    fn looked_up(&self, radial: u64) -> Option<u64> {
        const DROP: u32 = FRACTION + 2 - RADIAL_LOG2;
        let ([low, high], between) = self.rows?;
        let column = (radial >> DROP) as usize;
        let rest = (radial & ((1 << DROP) - 1)) as i64;
        let along = |row: &[u32]| {
            let left = i64::from(*row.get(column)?);
            let right = i64::from(*row.get(column + 1)?);
            Some(left + shift_round((right - left) * rest, DROP))
        };
        let (below, above) = (along(low)?, along(high)?);
        Some((below + shift_round((above - below) * between, 16)) as u64)
    }
}

/// The formula in UQ4.28, by the reciprocal unit.
fn evaluate(radial: u64, spread: u32) -> u64 {
    let radial = SoftFloat::from_wide((radial & 0xffff_ffff) as i64, -(FRACTION as i32), 31);
    let spread = SoftFloat::from_wide(spread.into(), -32, 31);
    // 1 + r s is below 17.
    let divisor = (1i64 << 58).saturating_add(radial.times(spread).to_fixed(58));
    let inverse = reciprocal(SoftFloat::from_wide(divisor, -58, 31), 31).unwrap_or(SoftFloat::ZERO);
    radial.times(inverse).to_fixed(FRACTION).max(0) as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    static TABLE: [u32; PERSPECTIVE_ENTRIES] = {
        let mut table = [0; PERSPECTIVE_ENTRIES];
        fill_perspective(&mut table);
        table
    };

    #[test]
    fn every_entry_is_filled() {
        let mut table = [u32::MAX; PERSPECTIVE_ENTRIES];
        fill_perspective(&mut table);
        assert!(table == TABLE);
    }

    #[test]
    fn more_fraction_bits_than_the_format_has_count_as_what_it_has() {
        for bits in [45, 72, 1 << 31, u32::MAX] {
            let correct = |bits| {
                PerspectiveTable::new(&TABLE)
                    .index(1 << 27, bits)
                    .correct(3 << 44)
            };
            assert_eq!(correct(bits), correct(44), "{bits}");
        }
    }

    /// \[HYBRID\] 4.2 as it is printed, on distances: i and d in affine radii, a the half-angle.
    fn as_printed(radial: f64, spread: f64, cutoff: f64) -> f64 {
        let tangent = (spread * cutoff).sqrt();
        let index = (radial / cutoff).sqrt();
        let distance = (index * tangent).atan().sin() / tangent;
        distance * distance * cutoff
    }

    #[test]
    fn table_and_formula_follow_the_paper() {
        let mut worst = [0.0f64; 2];
        for i in 1..400u32 {
            let spread = (u64::from(i) * (1 << 32) / 1600) as u32;
            let index = PerspectiveTable::new(&TABLE).index(spread, 27);
            let exact_spread = f64::from(spread) / 2f64.powi(32);
            for j in 0..500u64 {
                let radial = j * (15 << 27) / 500;
                let got = index.correct(radial) as f64 / 2f64.powi(27);
                let exact = as_printed(radial as f64 / 2f64.powi(27), exact_spread, 4.0);
                let beyond = radial >= 4 << 27 || spread >= 1 << 28;
                let slot = &mut worst[usize::from(beyond)];
                *slot = slot.max((got - exact).abs());
            }
        }
        assert!(worst[0] < 6.2e-5 && worst[1] < 1e-7, "{worst:?}");
    }

    #[test]
    fn the_largest_divisor_fits() {
        let index = PerspectiveTable::new(&TABLE).index(u32::MAX, 27);
        assert_eq!(
            PerspectiveTable::new(&TABLE).index(u32::MAX, 28).correct(0),
            0
        );
        let got = index.correct((16 << 27) - 1) as f64 / 2f64.powi(27);
        assert!((got - 16.0 / 17.0).abs() < 1e-7, "{got}");
    }

    #[test]
    fn no_spread_is_no_correction() {
        let index = PerspectiveTable::new(&TABLE).index(0, 27);
        for radial in [0, 1 << 27, (1 << 27) + 12345, 15 << 27] {
            assert!(index.correct(radial).abs_diff(radial) <= 1);
        }
    }

    #[test]
    fn every_bit_pattern_is_defined() {
        for spread in [0, 1, 1 << 28, u32::MAX, (1 << 28) - 1] {
            for bits in [8, 27, 44] {
                let index = PerspectiveTable::new(&TABLE).index(spread, bits);
                for radial in [0, 1, u64::MAX, 1 << 30, 4 << bits, 16 << bits] {
                    let _ = index.correct(radial);
                }
            }
        }
    }

    #[test]
    fn corrected_indices_are_these() {
        let mut next = crate::random();
        let words = (0..4000).map(|_| {
            let bits = [8, 20, 27, 28, 31, 44][next() as usize % 6];
            let index =
                PerspectiveTable::new(&TABLE).index((next() >> (32 + next() % 9)) as u32, bits);
            index.correct(next() >> (60 - bits + next() as u32 % 9))
        });
        assert_eq!(crate::digest(words), 4_419_249_230_297_299_400);
    }
}
