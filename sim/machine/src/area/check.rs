//! Whether prices of someone's own make sense: every division by them and every product of them must be defined.
//!
//! A price of NaN would make every area NaN and every comparison false; a memory of 0 words divides by zero.

use super::calibration::Calibration;
use toml::{Table, Value};

/// Operands of a multiplier: at least a sign and a bit, at most what any device has.
const MULTIPLIER: (u64, u64) = (2, 128);
/// Words, bits, kilobits, look-up tables of one block or cell.
const BLOCK: (u64, u64) = (1, 1 << 20);
/// Largest absolute value of a price.
const LARGEST: f64 = 1e9;

/// A key, its value, and what is allowed.
pub type Refused = (String, String, String);

impl Calibration {
    /// The first key whose value makes no sense.
    pub fn check(&self) -> Result<(), Refused> {
        if self.shapes.is_empty() {
            let allowed = "at least one [words, bits]";
            return Err(("shapes".into(), "[]".into(), allowed.into()));
        }
        let all = Table::try_from(self).expect("prices were read from a table");
        let mut all = all.iter();
        all.try_for_each(|(key, value)| check(key, value))
    }
}

/// Lines through what was synthesised may begin below zero, and their sums are cut at zero.
fn check(path: &str, value: &Value) -> Result<(), Refused> {
    let key = path.rsplit('.').next().unwrap_or(path);
    let (found, holds, allowed) = match value {
        Value::Table(inner) => {
            let mut inner = inner.iter();
            return inner.try_for_each(|(key, value)| check(&format!("{path}.{key}"), value));
        }
        Value::Array(list) => return list.iter().try_for_each(|value| check(path, value)),
        Value::Integer(count) => {
            let (low, high) = match key {
                "multiplier" => MULTIPLIER,
                _ => BLOCK,
            };
            let holds = (low as i64..=high as i64).contains(count);
            let allowed = format!("whole numbers from {low} to {high}");
            (count.to_string(), holds, allowed)
        }
        Value::Float(price) => {
            let low = match key {
                "at_zero" | "rest" => -LARGEST,
                _ => 0.0,
            };
            let holds = (low..=LARGEST).contains(price);
            let allowed = format!("numbers from {low} to {LARGEST}");
            (price.to_string(), holds, allowed)
        }
        // The family, which is a name.
        _ => return Ok(()),
    };
    if holds {
        Ok(())
    } else {
        Err((path.to_owned(), found, allowed))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::area::{Family, estimate};
    use crate::config::Config;
    use crate::tests::with_line;
    use splatline::format::{Deep32, Traversal};

    #[test]
    fn the_families_own_prices_are_allowed() {
        for family in Family::ALL {
            family.calibration().check().unwrap();
        }
    }

    /// Every number of a calibration, set to what makes no sense, is refused by its key.
    #[test]
    fn every_price_is_checked() {
        let text = toml::to_string(&Family::Xilinx7.calibration()).unwrap();
        let mut tried = 0;
        for (place, line) in text.lines().enumerate() {
            let Some((key, _)) = line.split_once(" = ") else {
                continue;
            };
            if key == "family" {
                continue;
            }
            for wrong in ["0", "-1", "nan", "inf", "-inf", "1e300", "99999999999999"] {
                // Neither a count nor where a line begins is a divisor.
                let zero_is_fine = key == "luts_per_kbit"
                    || ["at_zero", "per_bit", "added", "rest", "luts_per_dsp"].contains(&key);
                let negative_is_fine = ["at_zero", "rest"].contains(&key);
                if wrong == "0" && zero_is_fine || wrong == "-1" && negative_is_fine {
                    continue;
                }
                let value = match key {
                    "multiplier" => format!("[{wrong}, 18]"),
                    "shapes" => format!("[[512, {wrong}]]"),
                    _ => wrong.to_owned(),
                };
                let text = with_line(&text, place, &format!("{key} = {value}"));
                let read = Calibration::from_toml("p.toml", &text);
                assert!(read.is_err(), "{key} = {value}");
                tried += 1;
            }
        }
        assert!(tried > 100, "{tried}");
    }

    /// The extremes of what is allowed give numbers.
    #[test]
    fn allowed_extremes_give_an_estimate() {
        for pick in [|range: (u64, u64)| range.0, |range: (u64, u64)| range.1] {
            let mut prices = Family::Xilinx7.calibration();
            prices.multiplier = [pick(MULTIPLIER); 2];
            prices.shapes = vec![[pick(BLOCK); 2]];
            prices.block_kbit = pick(BLOCK);
            prices.row_kbit.per_bit = LARGEST;
            prices.luts.lane.per_bit = LARGEST;
            prices.luts.rest = -LARGEST;
            prices.luts_per_dsp = LARGEST;
            prices.check().unwrap();
            let machine = Config {
                raster_units: 1024,
                lanes: 64,
                tile_width: 64,
                row_fifo: 65_536,
                ..Config::default()
            };
            for traversal in [Traversal::Box, Traversal::Spans] {
                let area = estimate(&Deep32::WIDTHS, traversal, &machine, &prices);
                assert!(area.weight.is_finite() && area.weight >= 0.0);
            }
        }
    }
}
