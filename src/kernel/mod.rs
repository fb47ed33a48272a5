//! The footprint table: reconstruction kernel against radial index.
//!
//! All splats share one 1D table (\[EWA\] 7.1.2, \[SURF\] 4). It covers radial indices from 0 to `2^range` in
//! `2^table` intervals; entries are UQ1.weight, the kernel's peak is 1. The Gaussian is exp(-r/2).
//!
//! With interpolation, the chord of a convex function lies above it by `h^2/12 f''` on average; for the Gaussian
//! `f'' = f/4`, so entries are lowered by the factor `1 - h^2/48` and the mean error is 0. The position within an
//! interval is truncated, by d of the radial index on average, which the factor `1 - d/2` makes up for. Without
//! interpolation an entry is the kernel at the middle of its interval.

mod packed;
mod perspective;
mod ray;
mod shape;
mod tables;

pub use packed::{PackedError, PackedTable, pack, pack_into};
pub use perspective::{PERSPECTIVE_ENTRIES, PerspectiveIndex, PerspectiveTable, fill_perspective};
pub use ray::{Rays, covering_cutoff};
pub use shape::{Kernel, fill};
pub use tables::{Tabled, table_4, table_16};

use crate::format::Widths;
use crate::math::shift_round;

/// Largest number of entries of a table: `2^14` intervals and the end point.
pub const MAX_ENTRIES: usize = (1 << 14) + 1;

/// Base-2 logarithm of the largest radial index that a table can cover; a larger range counts as this one.
pub const MAX_RANGE: u8 = 4;

const fn covered(range: u8) -> u32 {
    if range < MAX_RANGE {
        range as u32
    } else {
        MAX_RANGE as u32
    }
}

/// Entries that a design's table has.
pub const fn entries(widths: &Widths) -> usize {
    (1 << widths.table) + 1
}

/// A table in memory that the caller lends.
#[derive(Clone, Copy, Debug)]
pub struct FootprintTable<'a> {
    entries: &'a [u32],
    /// Bits of the radial index below the table's index, and those of them that the interpolator sees.
    rest_bits: u32,
    kept: u32,
    /// The interpolator's product and rounding constant fit 32 bits.
    narrow: bool,
}

/// The memory lent for a table has not as many entries as [`entries`] asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TableSizeError {
    /// Entries needed.
    pub needed: usize,
    /// Entries found.
    pub found: usize,
}

impl<'a> FootprintTable<'a> {
    /// Looks radial indices up in `entries`, which [`fill_gaussian`] filled for the same widths and range.
    pub const fn new(
        entries: &'a [u32],
        widths: &Widths,
        range: u8,
    ) -> Result<Self, TableSizeError> {
        let needed = self::entries(widths);
        if entries.len() != needed {
            return Err(TableSizeError {
                needed,
                found: entries.len(),
            });
        }
        let rest_bits = (widths.radial as u32 + covered(range)).saturating_sub(widths.table as u32);
        let interpolation = widths.interpolation as u32;
        let kept = if interpolation < rest_bits {
            interpolation
        } else {
            rest_bits
        };
        Ok(FootprintTable {
            entries,
            rest_bits,
            kept,
            narrow: widths.weight as u32 + kept <= 30,
        })
    }

    /// The entries, UQ1.weight.
    #[inline(always)]
    pub const fn entries(&self) -> &'a [u32] {
        self.entries
    }

    /// Bits of the radial index below the table's index.
    #[inline(always)]
    pub const fn rest_bits(&self) -> u32 {
        self.rest_bits
    }

    /// Kernel at `radial` (UQ4.radial), UQ1.weight; 0 beyond the table. Interpolated results are rounded to nearest.
    #[inline(always)]
    pub fn weight(&self, radial: u64) -> u32 {
        let index = (radial >> self.rest_bits) as usize;
        let low = self.entries.get(index).copied().unwrap_or(0);
        if self.kept == 0 {
            return low;
        }
        let high = self.entries.get(index + 1).copied().unwrap_or(0);
        let rest = (radial >> (self.rest_bits - self.kept)) & ((1 << self.kept) - 1);
        if self.narrow {
            let step = (high as i32)
                .wrapping_sub(low as i32)
                .wrapping_mul(rest as i32);
            let step = step.wrapping_add(1 << (self.kept - 1)) >> self.kept;
            return low.wrapping_add(step as u32);
        }
        let step = (i64::from(high) - i64::from(low)) * rest as i64;
        (i64::from(low) + shift_round(step, self.kept)) as u32
    }
}

/// Fills a table with the Gaussian exp(-r/2) on 0 ..= `2^range`; evaluates at compile time for firmware.
///
/// Each entry is rounded to nearest from 60 fraction bits.
pub const fn fill_gaussian(table: &mut [u32], widths: &Widths, range: u8) {
    // One interval is h = 2^(range - table), so an entry's factor to the next is exp(-h/2).
    let step = (1u128 << (60 + covered(range))) >> widths.table;
    let half_step = (step / 2) as u64;
    let factor = exp_negative(half_step);
    let mut value = if widths.interpolation > 0 {
        // 1 - h^2/48 - d/2.
        let chord = ((step * step) >> 60) / 48;
        let rest_bits = (widths.radial as u32 + covered(range)).saturating_sub(widths.table as u32);
        let truncated = if (widths.interpolation as u32) < rest_bits {
            step >> (widths.interpolation as u32 + 2)
        } else {
            0
        };
        (1u64 << 60) - (chord + truncated) as u64
    } else {
        exp_negative(half_step / 2)
    };
    let drop = 60 - widths.weight as u32;
    let mut i = 0;
    while i < table.len() {
        table[i] = ((value + (1 << (drop - 1))) >> drop) as u32;
        value = ((value as u128 * factor as u128 + (1 << 59)) >> 60) as u64;
        i += 1;
    }
}

/// Fills a table with any profile (Q.40 in and out); entry positions as for the Gaussian, without its centring of the
/// mean.
fn shape_entries(table: &mut [u32], widths: &Widths, range: u8, profile: impl Fn(i64) -> i64) {
    let half = u32::from(widths.interpolation == 0);
    let half_step = 1i64 << (39 + u32::from(range.min(4)) - u32::from(widths.table));
    let drop = 40 - u32::from(widths.weight);
    for (entry, index) in table.iter_mut().zip(0i64..) {
        let radial = half_step * (2 * index + i64::from(half));
        *entry = shift_round(profile(radial), drop) as u32;
    }
}

/// A compile-time table of the Gaussian; `N` must be [`entries`] of the widths.
pub const fn gaussian<const N: usize>(widths: &Widths, range: u8) -> [u32; N] {
    let mut table = [0; N];
    fill_gaussian(&mut table, widths, range);
    table
}

/// exp(-x) for x in [0, 4], both with 60 fraction bits: the power series of exp(-x/16), squared four times.
const fn exp_negative(x: u64) -> u64 {
    let one = 1i128 << 60;
    let small = (x >> 4) as i128;
    let mut term = one;
    let mut sum = one;
    let mut n = 1;
    while n <= 20 {
        term = -(term * small) / n / one;
        sum += term;
        n += 1;
    }
    let mut squared = 0;
    while squared < 4 {
        sum = (sum * sum) >> 60;
        squared += 1;
    }
    sum as u64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::format::{Classic8, Deep32, Lean18, Standard24};
    extern crate std;
    use std::vec;

    fn errors(widths: Widths, range: u8) -> (f64, f64) {
        let mut memory = vec![0; entries(&widths)];
        fill_gaussian(&mut memory, &widths, range);
        let table = FootprintTable::new(&memory, &widths, range).unwrap();
        let end = 1u64 << (widths.radial + range);
        let samples = 200_000u64;
        let (mut worst, mut sum) = (0.0f64, 0.0);
        for i in 0..samples {
            let radial = (u128::from(end) * u128::from(i) / u128::from(samples)) as u64;
            let exact = (-0.5 * radial as f64 / (widths.radial as f64).exp2()).exp();
            let error = table.weight(radial) as f64 / (widths.weight as f64).exp2() - exact;
            worst = worst.max(error.abs());
            sum += error;
        }
        (worst, sum / samples as f64)
    }

    /// One row a table: largest error and bias allowed. What is left of the bias is the entries' rounding.
    #[test]
    fn tables_are_accurate_and_unbiased() {
        let rows = [
            ("classic8 2", Classic8::WIDTHS, 2, 6.1e-3, 1e-4),
            ("classic8 4", Classic8::WIDTHS, 4, 1.9e-2, 2e-4),
            ("lean18 2", Lean18::WIDTHS, 2, 4.1e-6, 1e-7),
            ("lean18 4", Lean18::WIDTHS, 4, 9e-6, 2e-7),
            ("standard24 2", Standard24::WIDTHS, 2, 4e-8, 1e-9),
            ("standard24 4", Standard24::WIDTHS, 4, 3.5e-7, 4e-10),
            ("deep32 2", Deep32::WIDTHS, 2, 3e-8, 1e-9),
            ("deep32 4", Deep32::WIDTHS, 4, 3.4e-7, 1e-9),
        ];
        for (name, widths, range, worst, bias) in rows {
            let got = errors(widths, range);
            assert!(
                got.0 < worst && got.1.abs() < bias,
                "{name}: largest {:.3e}, bias {:.3e}",
                got.0,
                got.1
            );
        }
    }

    #[test]
    fn compile_time_and_run_time_tables_are_equal() {
        static TABLE: [u32; entries(&Standard24::WIDTHS)] = gaussian(&Standard24::WIDTHS, 4);
        let mut memory = [0; entries(&Standard24::WIDTHS)];
        fill_gaussian(&mut memory, &Standard24::WIDTHS, 4);
        assert_eq!(TABLE, memory);
        assert_eq!(gaussian(&Standard24::WIDTHS, 4), TABLE);
    }

    /// Where entries lie: at the middle of intervals without interpolation, and with it where they begin, lowered by
    /// what a chord is too high.
    #[test]
    fn entries_lie_where_they_are_read() {
        let widths = |interpolation| Widths {
            table: 4,
            interpolation,
            ..Standard24::WIDTHS
        };
        let unit = f64::from(1u32 << widths(0).weight);
        for interpolation in [0, 1, 9] {
            let widths = widths(interpolation);
            let mut memory = vec![0; entries(&widths)];
            fill_gaussian(&mut memory, &widths, 4);
            let rest = 0.5f64.powi(interpolation.into()) / 4.0;
            for (entry, index) in memory.iter().zip(0..) {
                // An interval is 1; what is cut off a position is half its last bit in the mean, half of which the
                // slope takes.
                let exact = match interpolation {
                    0 => (-0.25 - 0.5 * f64::from(index)).exp(),
                    _ => (1.0 - 1.0 / 48.0 - rest) * (-0.5 * f64::from(index)).exp(),
                };
                assert!((f64::from(*entry) - exact * unit).abs() <= 0.5 + 1e-3);
            }
        }
        let mut memory = vec![0; entries(&widths(0))];
        shape_entries(&mut memory, &widths(0), 4, |radial| radial >> 5);
        assert_eq!(memory[..3], [1 << 20, 3 << 20, 5 << 20]);
    }

    /// Long tables whose words show how each step was rounded.
    #[test]
    fn steps_are_rounded_to_nearest() {
        let words = [(0, 10), (1, 18)].map(|(range, interpolation)| {
            let widths = Widths {
                radial: 44,
                table: 14,
                interpolation,
                weight: 27,
                ..Standard24::WIDTHS
            };
            let mut memory = vec![0; entries(&widths)];
            fill_gaussian(&mut memory, &widths, range);
            crate::digest(memory.into_iter().map(u64::from))
        });
        assert_eq!(
            words,
            [2_381_531_050_094_165_533, 7_947_258_027_200_568_078]
        );
    }

    /// Only a position that is cut lowers entries: of 14 bits below the index all but the longest are.
    #[test]
    fn positions_that_are_cut_lower_entries() {
        let second = |interpolation| {
            let widths = Widths {
                radial: 20,
                table: 10,
                interpolation,
                weight: 28,
                ..Standard24::WIDTHS
            };
            let mut memory = vec![0; entries(&widths)];
            fill_gaussian(&mut memory, &widths, 4);
            memory[1]
        };
        let lowered = [12, 13, 14, 15, 20].map(|bits| second(20) - second(bits));
        assert_eq!(lowered[2..], [0; 3]);
        assert!(lowered[0] > lowered[1] && lowered[1] > 0, "{lowered:?}");
    }

    #[test]
    fn the_narrow_interpolator_changes_no_bit() {
        let mut tested = 0;
        for (weight, interpolation) in [(13, 8), (8, 20), (16, 14), (28, 2)] {
            let widths = Widths {
                weight,
                interpolation,
                ..Standard24::WIDTHS
            };
            let mut memory = vec![0; entries(&widths)];
            fill_gaussian(&mut memory, &widths, 4);
            let narrow = FootprintTable::new(&memory, &widths, 4).unwrap();
            let wide = FootprintTable {
                narrow: false,
                ..narrow
            };
            tested += u32::from(narrow.narrow);
            for radial in (0..16u64 << 27).step_by(9973) {
                assert_eq!(
                    narrow.weight(radial),
                    wide.weight(radial),
                    "{weight} {interpolation} {radial}"
                );
            }
        }
        assert_eq!(tested, 4);
    }

    #[test]
    fn beyond_the_table_is_zero_and_wrong_sizes_are_refused() {
        let memory = [1; 257];
        let table = FootprintTable::new(&memory, &Classic8::WIDTHS, 4).unwrap();
        assert_eq!(table.weight(u64::MAX), 0);
        let zeros = vec![0; entries(&Standard24::WIDTHS)];
        let after = FootprintTable::new(&zeros, &Standard24::WIDTHS, 4).unwrap();
        assert_eq!(
            after.rest_bits(),
            27 + 4 - u32::from(Standard24::WIDTHS.table)
        );
        assert_eq!(after.weight((16 << 27) + (1 << after.rest_bits()) - 1), 0);
        let error = FootprintTable::new(&memory[1..], &Classic8::WIDTHS, 4).unwrap_err();
        assert_eq!(
            error,
            TableSizeError {
                needed: 257,
                found: 256
            }
        );
    }
}
