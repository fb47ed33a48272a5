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

#[cfg(test)]
mod tests {
    use super::*;
    use splatline::format::{Classic8, Deep32, Lean18, Standard24};
    use splatline::kernel::{entries, fill_gaussian};

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
