//! Named parts: what an FPGA holds and what the memory beside it moves.
//!
//! A question about a machine is asked of a part that one can buy. The parts that ship lie in `parts/parts.toml`; a
//! file of the same form adds others. The memory is a board's, not the FPGA's: each part names the one that its figure
//! is of, and `--bandwidth` says another.

use super::area::{Fabric, Family};
use crate::input::line_of;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The parts that ship.
const SHIPPED: &str = include_str!("parts/parts.toml");

/// A part.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Part {
    /// Whose prices its area is counted by.
    pub family: Family,
    /// Look-up tables.
    pub luts: u64,
    /// Flip-flops.
    pub flip_flops: u64,
    /// Multipliers.
    pub dsps: u64,
    /// Kilobits of block memory.
    pub memory_kbit: u64,
    /// What its memory moves at best, both directions together.
    pub megabytes_per_s: u64,
    /// Which memory.
    pub memory: String,
    /// Data sheets and tables.
    pub source: String,
}

/// Parts by name.
#[derive(Clone, Debug, PartialEq)]
pub struct Parts(BTreeMap<String, Part>);

impl Default for Parts {
    /// Those that ship.
    fn default() -> Parts {
        // A test reads the file, so that it is never empty.
        Parts(parse("parts.toml", SHIPPED).unwrap_or_default())
    }
}

impl Parts {
    /// These and those of a file, which replace parts of the same name.
    pub fn and(mut self, file: &str, text: &str) -> Result<Parts, String> {
        self.0.extend(parse(file, text)?);
        Ok(self)
    }

    /// The part of that name, in whatever case.
    pub fn find(&self, name: &str) -> Result<&Part, String> {
        self.0.get(&name.to_lowercase()).ok_or_else(|| {
            let names = self.0.keys().map(String::as_str);
            let names = names.collect::<Vec<_>>().join(", ");
            format!("unknown part '{name}': there are {names}; --parts file.toml adds others")
        })
    }
}

fn parse(file: &str, text: &str) -> Result<BTreeMap<String, Part>, String> {
    let table: toml::Table = toml::from_str(text).map_err(|error| format!("{file}: {error}"))?;
    for (name, part) in &table {
        check(part).map_err(|(key, value, allowed)| {
            let line = line_of(text, &[name, key]);
            format!("{file}:{line}: {name}.{key} = {value}: {allowed}")
        })?;
    }
    let parts: BTreeMap<String, Part> =
        toml::from_str(text).map_err(|error| format!("{file}: {error}"))?;
    let lower = |(name, part): (String, Part)| (name.to_lowercase(), part);
    Ok(parts.into_iter().map(lower).collect())
}

/// The counts of a part and the least that each may be.
const COUNTS: [(&str, i64); 5] = [
    ("luts", 1),
    ("flip_flops", 1),
    ("dsps", 0),
    ("memory_kbit", 0),
    ("megabytes_per_s", 1),
];
/// The most that a count may be.
const MOST: i64 = 100_000_000;

/// Key, value and what is allowed in place of a value that cannot be; keys that lack or are unknown are told by the
/// reader of the file.
fn check(part: &toml::Value) -> Result<(), (&'static str, String, String)> {
    for (key, low) in COUNTS {
        let Some(value) = part.get(key) else { continue };
        let number = value.as_integer();
        if !number.is_some_and(|number| (low..=MOST).contains(&number)) {
            let allowed = format!("allowed are {low} to {MOST}");
            return Err((key, value.to_string(), allowed));
        }
    }
    if let Some(value) = part.get("family")
        && value.as_str().and_then(Family::by_key).is_none()
    {
        let allowed = "allowed are \"xilinx7\", \"ecp5\" and \"ice40\"";
        return Err(("family", value.to_string(), allowed.to_owned()));
    }
    for (key, allowed) in [
        ("memory", "name the memory that megabytes_per_s is of"),
        ("source", "name the data sheets that the figures are from"),
    ] {
        let Some(value) = part.get(key) else { continue };
        if value.as_str().is_none_or(|words| words.trim().is_empty()) {
            return Err((key, value.to_string(), allowed.to_owned()));
        }
    }
    Ok(())
}

impl Part {
    /// What it holds.
    pub fn fabric(&self) -> Fabric {
        Fabric {
            luts: self.luts,
            flip_flops: self.flip_flops,
            dsps: self.dsps,
            memory_kbit: self.memory_kbit,
        }
    }

    /// How much of it a machine takes, in one line.
    pub fn text(&self, name: &str, taken: Fabric, channel_bytes_per_s: f64) -> String {
        let pairs = taken.resources().into_iter().zip(self.fabric().resources());
        let fits = pairs.clone().all(|((_, count), (_, of))| count <= of);
        let share_of =
            |((what, count), (_, of))| format!("{what} {}", share(count as f64, of as f64));
        let words: Vec<String> = pairs.map(share_of).collect();
        let memory = self.megabytes_per_s as f64 * 1e6;
        format!(
            "part {name} ({}): {}{}; the channels ask for {} of its memory ({}, {} MB a second)\n",
            self.source,
            words.join(", "),
            if fits { "" } else { ": it does not fit" },
            share(channel_bytes_per_s, memory),
            self.memory,
            self.megabytes_per_s
        )
    }
}

/// A part of a whole in words.
fn share(some: f64, of: f64) -> String {
    if of > 0.0 {
        format!("{:.1} %", 100.0 * some / of)
    } else {
        format!("{some} of 0")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::{says, with_line};

    #[test]
    fn shipped_parts_read_and_name_their_sources() {
        let parts = parse("parts.toml", SHIPPED).unwrap();
        assert!(parts.len() >= 7);
        for (name, part) in &parts {
            // Which sheet, and where in it.
            let mut places = ["table", "family selection guide"].into_iter();
            let has_place = places.any(|place| part.source.contains(place));
            assert!(has_place && part.source.contains("DS"), "{name}");
            assert!(!part.memory.is_empty());
        }
        let found = Parts::default();
        assert_eq!(found.find("XC7A100T").unwrap().luts, 63_400);
        let unknown = found.find("xc7z020").unwrap_err();
        says(&unknown, &["xc7a35t", "--parts"]);
    }

    #[test]
    fn parts_of_ones_own_are_added_and_checked_by_line_and_range() {
        let mine = SHIPPED.replace("[xc7a35t]", "[mine]");
        let parts = Parts::default().and("mine.toml", &mine).unwrap();
        assert_eq!(parts.find("mine").unwrap().dsps, 90);
        let first = mine.find("luts = 20800").unwrap();
        let line = mine[..first].lines().count() + 1;
        let place = format!("mine.toml:{line}: mine.luts = 0");
        let refused = |text: &str| Parts::default().and("mine.toml", text).unwrap_err();
        // Every key of the part, by its own line.
        let start = mine.lines().position(|text| text == "[mine]").unwrap() + 1;
        let end = mine.lines().skip(start).position(str::is_empty).unwrap();
        let keys = mine.lines().enumerate().skip(start).take(end);
        let mut checked = 0;
        for (index, text) in keys {
            let key = text.split(" = ").next().unwrap();
            let wrong: &[&str] = if COUNTS.iter().any(|(count, _)| *count == key) {
                &["-1", "100000001", "1.5", "\"many\"", "nan"]
            } else {
                &["\" \"", "3", "true"]
            };
            for value in wrong {
                let printed = refused(&with_line(&mine, index, &format!("{key} = {value}")));
                let place = format!("mine.toml:{}: mine.{key} = ", index + 1);
                assert!(printed.starts_with(&place), "{printed}");
                let mut words = ["allowed are", "name the"].into_iter();
                assert!(words.any(|words| printed.contains(words)), "{printed}");
            }
            checked += 1;
        }
        assert_eq!(checked, 8, "all keys of a part");
        let zero = refused(&mine.replacen("luts = 20800", "luts = 0", 1));
        assert_eq!(zero, place + ": allowed are 1 to 100000000");
        let printed = refused(&mine.replacen("luts = 20800", "lutts = 20800", 1));
        says(&printed, &[&format!("line {line}"), "lutts"]);
    }
}
