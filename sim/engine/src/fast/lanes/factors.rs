//! The Gaussian's table as products of three numbers, found by permutations in registers instead of a gather from memory.
//!
//! exp(-(256 a + 16 b + c) h / 2) = exp(-128 a h) exp(-8 b h) exp(-c h / 2): sixteen entries each, four bits of the interval's number each. The
//! product in double precision, rounded to the table's last bit, is the table's entry, or else there are no factors: every entry is
//! compared when they are made. So the table stays the definition, whatever it holds.

use splatline::format::Widths;

/// Adding 2^52 leaves a number's integer in the lowest bits, rounded to nearest.
pub const TO_INTEGER: f64 = (1u64 << 52) as f64;

/// The first entry of a Gaussian table before it is rounded, and the ratio of its entries; as in the kernel's `fill_gaussian`.
fn progression(widths: &Widths, range: u8) -> (f64, f64) {
    let interval = 2f64.powi(i32::from(range) - i32::from(widths.table));
    let first = if widths.interpolation > 0 {
        let rest_bits = (i32::from(widths.radial) + i32::from(range)) - i32::from(widths.table);
        let kept = i32::from(widths.interpolation);
        let truncated = if kept < rest_bits {
            interval * 2f64.powi(-kept - 2)
        } else {
            0.0
        };
        1.0 - interval * interval / 48.0 - truncated
    } else {
        (-interval / 4.0).exp()
    };
    let one = 2f64.powi(widths.weight.into());
    (first * one, (-interval / 2.0).exp())
}

/// Factors of a table whose entry i is the nearest integer to `first ratio^i`, for i below 4096.
#[derive(Clone, Debug)]
pub struct Factors {
    /// `first ratio^c`, `ratio^(16 b)` and `ratio^(256 a)`.
    pub thirds: [[f64; 16]; 3],
    /// From an entry to the next.
    pub ratio: f64,
}

impl Factors {
    /// The factors of a design's table; `None` unless it holds the Gaussian and every product is exactly the entry.
    pub fn gaussian(entries: &[u32], widths: &Widths, range: u8) -> Option<Self> {
        let (first, ratio) = progression(widths, range);
        Self::new(entries, first, ratio)
    }

    /// The factors of these entries, of which entry 0 is nearly `first`; `None` if a product is not exactly the entry.
    fn new(entries: &[u32], first: f64, ratio: f64) -> Option<Self> {
        let powers =
            |first: f64, step: i32| std::array::from_fn(|k| first * ratio.powi(step * k as i32));
        let factors = Factors {
            thirds: [powers(first, 1), powers(1.0, 16), powers(1.0, 256)],
            ratio,
        };
        let is_exact = entries.len() <= 4097
            && entries.windows(2).enumerate().all(|(index, pair)| {
                let [low, next] = factors.neighbours(index as u64);
                pair == [low as u32, next as u32]
            });
        is_exact.then_some(factors)
    }

    /// Entries `index` modulo 4096 and the one after, each as the low bits of [`TO_INTEGER`] plus it: the definition of the vectors' lookup.
    pub fn neighbours(&self, index: u64) -> [u64; 2] {
        let third = |k: usize| self.thirds[k][(index >> (4 * k) & 15) as usize];
        let value = third(0) * third(1) * third(2);
        let next = value.mul_add(self.ratio, TO_INTEGER);
        [(value + TO_INTEGER).to_bits(), next.to_bits()]
    }
}

/// Adding 2^23 leaves a single-precision number's integer in the lowest bits, rounded to nearest.
pub const TO_SHORT_INTEGER: f32 = (1u32 << 23) as f32;

/// Factors in single precision, of tables of at most 1024 intervals: entry 32 a + c is the nearest integer to `coarse[a] fine[c]`, and the entry
/// after it that to `coarse[a] next[c]`, each product rounded once.
#[derive(Clone, Debug)]
pub struct NarrowFactors {
    /// Numbers a.
    pub coarse: [f32; 32],
    /// Numbers c.
    pub fine: [f32; 32],
    /// Numbers c + 1.
    pub next: [f32; 32],
}

impl NarrowFactors {
    /// The factors of a design's table; `None` unless it holds the Gaussian, and single precision is enough for every product.
    pub fn gaussian(entries: &[u32], widths: &Widths, range: u8) -> Option<Self> {
        let (first, ratio) = progression(widths, range);
        let count = entries
            .len()
            .checked_sub(1)
            .filter(|count| *count <= 1024)?;
        if entries.iter().any(|entry| *entry >= 1 << 23) {
            return None;
        }
        let mut fine: [f32; 33] = std::array::from_fn(|c| (first * ratio.powi(c as i32)) as f32);
        let rows = || entries[..count].chunks(32).enumerate();
        let row_end = |a: usize| (32 * a + 33).min(entries.len());
        // Numbers rounded to single precision miss few entries; a step of the last bit at the one that misses settles it.
        for _ in 0..ROUNDS {
            let mut coarse = [0.0; 32];
            let mut exact = true;
            for (a, _) in rows() {
                let row = &entries[32 * a..row_end(a)];
                coarse[a] = middle(row, &fine);
                for (entry, fine) in row.iter().zip(&mut fine) {
                    let missed = integer(coarse[a], *fine).wrapping_sub(*entry) as i32;
                    exact &= missed == 0;
                    *fine = match missed {
                        0 => *fine,
                        1.. => fine.next_down(),
                        _ => fine.next_up(),
                    };
                }
            }
            if exact {
                return Some(NarrowFactors {
                    coarse,
                    fine: std::array::from_fn(|c| fine[c]),
                    next: std::array::from_fn(|c| fine[c + 1]),
                });
            }
        }
        None
    }

    /// Entries `index` modulo 1024 and the one after, each in the low 23 bits: the definition of the vectors' lookup.
    pub fn neighbours(&self, index: u32) -> [u32; 2] {
        let coarse = self.coarse[(index >> 5 & 31) as usize];
        let c = (index & 31) as usize;
        [self.fine[c], self.next[c]].map(|fine| coarse.mul_add(fine, TO_SHORT_INTEGER).to_bits())
    }
}

/// How often factors that miss an entry are moved.
const ROUNDS: usize = 8;

/// The middle of the numbers whose products with `fine` round to the row's entries.
fn middle(row: &[u32], fine: &[f32; 33]) -> f32 {
    let bound = |entry: f64, fine: f32| entry / f64::from(fine);
    let bounds = row.iter().zip(fine).map(|(entry, fine)| {
        let entry = f64::from(*entry);
        [bound(entry - 0.5, *fine), bound(entry + 0.5, *fine)]
    });
    let [low, high] = bounds.fold([0.0, f64::MAX], |[low, high], bound| {
        [bound[0].max(low), bound[1].min(high)]
    });
    ((low + high) / 2.0) as f32
}

/// The integer nearest to a product that is rounded once.
fn integer(coarse: f32, fine: f32) -> u32 {
    coarse.mul_add(fine, TO_SHORT_INTEGER).to_bits() - TO_SHORT_INTEGER.to_bits()
}

#[cfg(test)]
mod tests {
    use super::*;
    use splatline::format::{Classic8, Deep32, Lean18, Standard24};
    use splatline::kernel::{entries, fill_gaussian};

    #[test]
    fn narrow_designs_have_theirs_in_single_precision() {
        for widths in [Classic8::WIDTHS, Lean18::WIDTHS] {
            for range in [2, 4] {
                let mut table = vec![0; entries(&widths)];
                fill_gaussian(&mut table, &widths, range);
                let factors = NarrowFactors::gaussian(&table, &widths, range).unwrap();
                for (index, pair) in table.windows(2).enumerate() {
                    let neighbours = factors.neighbours(index as u32);
                    let got = neighbours.map(|word| word & ((1 << 23) - 1));
                    assert_eq!(got, pair, "{widths:?}, range {range}, {index}");
                }
                table[7] += 9;
                assert!(NarrowFactors::gaussian(&table, &widths, range).is_none());
            }
        }
    }

    #[test]
    fn every_design_has_its_table_in_factors_and_no_other_table() {
        for widths in [
            Classic8::WIDTHS,
            Lean18::WIDTHS,
            Standard24::WIDTHS,
            Deep32::WIDTHS,
        ] {
            for range in [2, 4] {
                let mut table = vec![0; entries(&widths)];
                fill_gaussian(&mut table, &widths, range);
                let is_exact = |table: &[u32]| Factors::gaussian(table, &widths, range).is_some();
                assert!(is_exact(&table), "{widths:?}, range {range}");
                *table.last_mut().unwrap() += 1;
                assert!(!is_exact(&table), "{widths:?}, range {range}");
            }
        }
    }
}
