//! Named parts: what an FPGA holds and what the memory beside it moves.
//!
//! A question about a machine is asked of a part that one can buy. The parts that ship lie in `parts/parts.toml`; a file of the same form adds
//! others. The memory is a board's, not the FPGA's: each part names the one that its figure is of, and `--bandwidth` says another.

use super::area::{Area, Fabric, Family};
use super::config::line_of;
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
        match parse("parts.toml", SHIPPED) {
            Ok(parts) => Parts(parts),
            // A test reads the file, so that this is not met.
            Err(_) => Parts(BTreeMap::new()),
        }
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
            let names: Vec<&str> = self.0.keys().map(String::as_str).collect();
            format!(
                "unknown part '{name}': there are {}; --parts file.toml adds others",
                names.join(", ")
            )
        })
    }
}

fn parse(file: &str, text: &str) -> Result<BTreeMap<String, Part>, String> {
    let parts: BTreeMap<String, Part> =
        toml::from_str(text).map_err(|error| format!("{file}: {error}"))?;
    for (name, part) in &parts {
        part.check().map_err(|(key, value, [low, high])| {
            let line = line_of(text, name, key);
            format!("{file}:{line}: {name}.{key} = {value}: allowed are {low} to {high}")
        })?;
    }
    let lower = |(name, part): (String, Part)| (name.to_lowercase(), part);
    Ok(parts.into_iter().map(lower).collect())
}

impl Part {
    /// Key, value and allowed range of what cannot be.
    fn check(&self) -> Result<(), (&'static str, u64, [u64; 2])> {
        let most = 100_000_000;
        let counts = [
            ("luts", self.luts, 1),
            ("flip_flops", self.flip_flops, 1),
            ("dsps", self.dsps, 0),
            ("memory_kbit", self.memory_kbit, 0),
            ("megabytes_per_s", self.megabytes_per_s, 1),
        ];
        let wrong = counts
            .iter()
            .find(|(_, value, low)| !(*low..=most).contains(value));
        wrong.map_or(Ok(()), |(key, value, low)| {
            Err((*key, *value, [*low, most]))
        })
    }

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
    pub fn text(&self, name: &str, area: &Area, channel_bytes_per_s: f64) -> String {
        let taken = (area.raster + area.around).resources();
        let shares = taken.iter().zip(self.fabric().resources());
        let words: Vec<String> = shares
            .map(|((what, count), (_, of))| format!("{what} {}", share(*count as f64, of as f64)))
            .collect();
        let fits = taken
            .iter()
            .zip(self.fabric().resources())
            .all(|((_, count), (_, of))| *count <= of);
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
    match of > 0.0 {
        true => format!("{:.1} %", 100.0 * some / of),
        false => format!("{some} of 0"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shipped_parts_read_and_name_their_sources() {
        let parts = parse("parts.toml", SHIPPED).unwrap();
        for name in ["xc7a35t", "xc7a100t", "lfe5u-85f", "ice40up5k"] {
            let part = &parts[name];
            assert!(part.source.contains("DS"), "{name}");
            assert!(!part.memory.is_empty());
        }
        let found = Parts::default();
        assert_eq!(found.find("XC7A100T").unwrap().luts, 63_400);
        let unknown = found.find("xc7z020").unwrap_err();
        assert!(
            unknown.contains("xc7a35t") && unknown.contains("--parts"),
            "{unknown}"
        );
    }

    #[test]
    fn parts_of_ones_own_are_added_and_checked_by_line_and_range() {
        let mine = SHIPPED.replace("[xc7a35t]", "[mine]");
        let parts = Parts::default().and("mine.toml", &mine).unwrap();
        assert_eq!(parts.find("mine").unwrap().dsps, 90);
        let first = mine.find("luts = 20800").unwrap();
        let line = mine[..first].lines().count() + 1;
        let zero = mine.replacen("luts = 20800", "luts = 0", 1);
        assert_eq!(
            Parts::default().and("mine.toml", &zero).unwrap_err(),
            format!("mine.toml:{line}: mine.luts = 0: allowed are 1 to 100000000")
        );
        let unknown = mine.replacen("luts = 20800", "lutts = 20800", 1);
        let told = Parts::default().and("mine.toml", &unknown).unwrap_err();
        assert!(
            told.contains(&format!("line {line}")) && told.contains("lutts"),
            "{told}"
        );
    }
}
