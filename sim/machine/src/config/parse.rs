//! From TOML text to a [`Config`] and back. Errors name the file, the line, the key and what is allowed.

use super::fields::{ConfigField, FIELDS, Range, field};
use super::{Config, LaneLayout, Overlap, primitive};
use crate::input;
use std::fmt::Write;
use std::path::Path;
use thiserror::Error;

/// Bytes that a simulated machine's queues may take: a thousandth of it is a large machine, and sweeps simulate several at once.
const MOST_BYTES: u64 = 256_000_000;

/// What is wrong with a machine file or with one setting.
#[derive(Debug, Error, PartialEq, Eq)]
pub enum ConfigError {
    /// The file cannot be read.
    #[error("{file}: cannot read the machine: {problem}")]
    Unreadable {
        /// The file.
        file: String,
        /// What the system said.
        problem: String,
    },
    /// Not TOML.
    #[error("{file}: {problem}")]
    Malformed {
        /// The file.
        file: String,
        /// The parser's message, which names line and column.
        problem: String,
    },
    /// No such key.
    #[error("{place}: unknown key '{key}'{hint}")]
    UnknownKey {
        /// File and line, or the option.
        place: String,
        /// The key.
        key: String,
        /// What may have been meant.
        hint: String,
    },
    /// A value of the wrong kind or out of range.
    #[error("{place}: {key} = {value}: {allowed}")]
    NotAllowed {
        /// File and line, or the option.
        place: String,
        /// The key.
        key: String,
        /// The value found.
        value: String,
        /// What is allowed.
        allowed: String,
    },
}

/// Reads a machine file.
pub fn from_file(path: &Path) -> Result<Config, ConfigError> {
    let file = path.display().to_string();
    let text = input::text(path, input::SETTINGS).map_err(|error| ConfigError::Unreadable {
        file: file.clone(),
        problem: error.to_string(),
    })?;
    from_toml(&file, &text)
}

/// Reads a machine from the text of a file; keys that it does not name keep their defaults.
pub fn from_toml(file: &str, text: &str) -> Result<Config, ConfigError> {
    let malformed = |problem: String| ConfigError::Malformed {
        file: file.to_owned(),
        problem,
    };
    let table: toml::Table = text
        .parse()
        .map_err(|error: toml::de::Error| malformed(error.to_string()))?;
    from_table(file, text, &table)
}

/// A machine as its file's table; a message names `file` and the line of `text`.
fn from_table(file: &str, text: &str, table: &toml::Table) -> Result<Config, ConfigError> {
    let mut config = Config::default();
    for (section, value) in table {
        let place = format!("{file}:{}", line_of(text, "", section));
        match value {
            toml::Value::Table(keys) if FIELDS.iter().any(|field| field.section == section) => {
                for (key, value) in keys {
                    let place = format!("{file}:{}", line_of(text, section, key));
                    config.set(&place, &format!("{section}.{key}"), value)?;
                }
            }
            _ => return Err(unknown(&place, section)),
        }
    }
    config.check_together().map_err(|(key, value, allowed)| {
        let section = field(key).map_or("", |field| field.section);
        let place = format!("{file}:{}", line_of(text, section, key));
        ConfigError::NotAllowed {
            place,
            key: key.to_owned(),
            value,
            allowed,
        }
    })?;
    Ok(config)
}

impl Config {
    /// Sets one field; `place` says where the setting stands, for messages.
    pub fn set(&mut self, place: &str, key: &str, value: &toml::Value) -> Result<(), ConfigError> {
        let Some(field) = field(key) else {
            return Err(unknown(place, key));
        };
        match field.accept(value) {
            Some(number) => {
                (field.set)(self, number);
                Ok(())
            }
            None => Err(ConfigError::NotAllowed {
                place: place.to_owned(),
                key: key.to_owned(),
                value: value.to_string(),
                allowed: field.allowed(),
            }),
        }
    }

    /// Sets fields from `key=value` words, as the command line gives them.
    pub fn set_words(&mut self, words: &[String]) -> Result<(), ConfigError> {
        for word in words {
            let (key, text) = word.split_once('=').unwrap_or((word, ""));
            let value = match text.trim().parse::<i64>() {
                Ok(number) => toml::Value::Integer(number),
                Err(_) => toml::Value::String(text.trim().to_owned()),
            };
            self.set("--set", key.trim(), &value)?;
        }
        self.check_together()
            .map_err(|(key, value, allowed)| ConfigError::NotAllowed {
                place: "--set".to_owned(),
                key: key.to_owned(),
                value,
                allowed,
            })
    }

    /// Conditions between fields: the key at fault, its value and what is allowed.
    pub fn check_together(&self) -> Result<(), (&'static str, String, String)> {
        if self.packet_cache > 0 && self.memory_part > 0 {
            let allowed =
                "allowed is 0 with a memory part: a cache in front of its port is not modelled";
            return Err((
                "packet_cache",
                self.packet_cache.to_string(),
                allowed.to_owned(),
            ));
        }
        self.check_sorter()?;
        if self.sort_every > 1 && self.sort_passes < 2 {
            let allowed = "allowed is 1 with a sort_passes below 2: to merge what came into a kept list is a pass itself";
            return Err((
                "sort_every",
                self.sort_every.to_string(),
                allowed.to_owned(),
            ));
        }
        if self.overlap_frames > 1 && self.memory_part > 0 {
            let allowed = "allowed is 1 with a memory part: phases of two pictures at one port are not simulated";
            return Err((
                "overlap_frames",
                self.overlap_frames.to_string(),
                allowed.to_owned(),
            ));
        }
        if self.layout == LaneLayout::Quad && self.lanes < 2 {
            return Err((
                "layout",
                "\"quad\"".to_owned(),
                "allowed with 2 or more lanes".to_owned(),
            ));
        }
        if self.layout == LaneLayout::Rows && self.overlap == Overlap::Serial {
            return Err((
                "layout",
                "\"rows\"".to_owned(),
                "allowed with overlap = \"pipelined\" or \"primitive\"".to_owned(),
            ));
        }
        if self.overlap == Overlap::Primitive {
            self.check_primitive()?;
        }
        if let Some(part) = self.memory_part()
            && self.clock_mhz == 0
        {
            let allowed = "allowed with a clock_mhz of 1 to 10000: the part has a clock of its own";
            return Err((
                "memory_part",
                format!("\"{}\"", part.name),
                allowed.to_owned(),
            ));
        }
        if self.simulator_bytes() > MOST_BYTES {
            let allowed = format!(
                "with these lanes and FIFOs the simulator would take {} MB, allowed are {} MB: fewer units, or shallower FIFOs",
                self.simulator_bytes() / 1_000_000,
                MOST_BYTES / 1_000_000
            );
            return Err(("raster_units", self.raster_units.to_string(), allowed));
        }
        if self.lanes > u32::from(self.tile_width) && self.layout != LaneLayout::Rows {
            let allowed = format!(
                "allowed are up to tile_width = {} lanes in this layout",
                self.tile_width
            );
            return Err(("lanes", self.lanes.to_string(), allowed));
        }
        Ok(())
    }

    /// What the circuit of `sim/rtl` fixes.
    fn check_primitive(&self) -> Result<(), (&'static str, String, String)> {
        let wanted = Config::primitive(self.lanes);
        let fixed = [
            "layout",
            "row_cycles",
            "rows_at_once",
            "pixel_termination",
            "table_ports",
            "blend_interval",
            "buffer_banks",
        ];
        for field in fixed.iter().filter_map(|key| field(key)) {
            let (found, needed) = (field.show(self), field.show(&wanted));
            if found != needed {
                let allowed = format!("overlap = \"primitive\" needs {needed}");
                return Err((field.key, found, allowed));
            }
        }
        if ![1, primitive::SETUP_INTERVAL].contains(&self.splat_cycles) {
            let allowed = format!(
                "overlap = \"primitive\" allows 1 and {}",
                primitive::SETUP_INTERVAL
            );
            return Err(("splat_cycles", self.splat_cycles.to_string(), allowed));
        }
        if self.tile_width > primitive::TILE[0] {
            let allowed = format!(
                "overlap = \"primitive\" allows up to {} columns, one seed a row",
                primitive::TILE[0]
            );
            return Err(("tile_width", self.tile_width.to_string(), allowed));
        }
        if self.lanes > u32::from(self.tile_height) {
            let allowed = format!(
                "overlap = \"primitive\" allows up to tile_height = {} lanes",
                self.tile_height
            );
            return Err(("lanes", self.lanes.to_string(), allowed));
        }
        Ok(())
    }
}

impl ConfigField {
    /// The value as the integer that [`ConfigField::set`] takes, if it is allowed.
    pub fn accept(&self, value: &toml::Value) -> Option<u32> {
        let number = value
            .as_integer()
            .and_then(|number| u32::try_from(number).ok());
        match self.range {
            Range::Number(low, high) => number.filter(|number| (low..=high).contains(number)),
            Range::OneOf(list) => number.filter(|number| list.contains(number)),
            Range::Choice(names) => {
                let name = value.as_str()?;
                names
                    .iter()
                    .position(|choice| *choice == name)
                    .map(|index| index as u32)
            }
        }
    }

    /// What is allowed, in words.
    pub fn allowed(&self) -> String {
        match self.range {
            Range::Number(low, high) => format!("allowed are {low} to {high}"),
            Range::OneOf(list) => {
                format!(
                    "allowed are {}",
                    list.iter()
                        .map(u32::to_string)
                        .collect::<Vec<_>>()
                        .join(", ")
                )
            }
            Range::Choice(names) => format!("allowed are \"{}\"", names.join("\", \"")),
        }
    }

    /// The field's value as TOML and CSV show it.
    pub fn show(&self, config: &Config) -> String {
        let value = (self.get)(config);
        match self.range {
            Range::Choice(names) => names[value as usize].to_owned(),
            _ => value.to_string(),
        }
    }
}

impl From<Config> for toml::Table {
    fn from(config: Config) -> toml::Table {
        let value = |field: &ConfigField| {
            let number = (field.get)(&config);
            match field.range {
                Range::Choice(_) => toml::Value::String(field.show(&config)),
                _ => toml::Value::Integer(number.into()),
            }
        };
        let mut sections = toml::Table::new();
        for field in &FIELDS {
            let empty = || toml::Value::Table(toml::Table::new());
            let section = sections.entry(field.section).or_insert_with(empty);
            if let toml::Value::Table(keys) = section {
                keys.insert(field.key.to_owned(), value(field));
            }
        }
        sections
    }
}

impl TryFrom<toml::Table> for Config {
    type Error = ConfigError;

    fn try_from(table: toml::Table) -> Result<Config, ConfigError> {
        from_table("machine", "", &table)
    }
}

/// The whole configuration with a comment per field; reading it back gives the same configuration.
pub fn to_toml(config: &Config) -> String {
    let mut text = String::from(
        "# A splatting machine. Times in clock cycles; what is left out keeps its default.\n",
    );
    let mut section = "";
    for field in &FIELDS {
        if field.section != section {
            section = field.section;
            // Writing to a String cannot fail.
            let _ = writeln!(text, "\n[{section}]");
        }
        let shown = field.show(config);
        let value = if matches!(field.range, Range::Choice(_)) {
            format!("\"{shown}\"")
        } else {
            shown
        };
        let setting = format!("{} = {value}", field.key);
        let _ = writeln!(text, "{setting:<32} # {}; {}", field.about, field.allowed());
    }
    text
}

/// The keys of the section that an unknown key stands in, or the sections.
pub fn known(key: &str) -> String {
    let section = key.split_once('.').map_or("", |(section, _)| section);
    let in_section = FIELDS.iter().filter(|field| field.section == section);
    let keys: Vec<&str> = in_section.map(|field| field.key).collect();
    if !keys.is_empty() {
        return format!("[{section}] has {}", keys.join(", "));
    }
    let mut sections: Vec<&str> = FIELDS.iter().map(|field| field.section).collect();
    sections.dedup();
    format!(
        "the sections are {}; docs/files.md lists their keys",
        sections.join(", ")
    )
}

fn unknown(place: &str, key: &str) -> ConfigError {
    let name = key.rsplit('.').next().unwrap_or(key);
    let hint = match field(name) {
        // The name that the setting once had, and that the command line has for something else.
        None if name == "part" => {
            ": the memory is memory_part; the FPGA is the option --part".to_owned()
        }
        Some(field) => format!(": '{name}' belongs into [{}]", field.section),
        None => {
            let start: String = name.chars().take(3).collect();
            let near = FIELDS.iter().filter(|field| field.key.starts_with(&start));
            let keys: Vec<&str> = near.map(|field| field.key).collect();
            if keys.is_empty() {
                format!(": {}", known(key))
            } else {
                format!(": did you mean {}?", keys.join(" or "))
            }
        }
    };
    ConfigError::UnknownKey {
        place: place.to_owned(),
        key: key.to_owned(),
        hint,
    }
}

/// Line, counted from 1, on which `key` is set in `[section]` (or as `section.key`); 1 if it is not found.
pub fn line_of(text: &str, section: &str, key: &str) -> usize {
    let sets = |line: &str, name: &str| {
        line.strip_prefix(name)
            .is_some_and(|rest| rest.trim_start().starts_with('='))
    };
    let dotted = format!("{section}.{key}");
    let quoted = format!("\"{key}\"");
    let mut current = "";
    for (index, line) in text.lines().enumerate() {
        let line = line.trim();
        if let Some(name) = line
            .strip_prefix('[')
            .and_then(|rest| rest.split(']').next())
        {
            current = name.trim();
            if section.is_empty() && current == key {
                return index + 1;
            }
        }
        let inside = current == section && (sets(line, key) || sets(line, &quoted));
        if inside || (current.is_empty() && sets(line, &dotted)) {
            return index + 1;
        }
    }
    1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_resolved_file_reads_back() {
        let mut config = Config::default();
        config
            .set_words(&[
                "lanes=4".into(),
                "layout=rows".into(),
                "memory.latency=17".into(),
            ])
            .unwrap();
        assert_eq!(from_toml("m.toml", &to_toml(&config)), Ok(config));
        assert_eq!(from_toml("m.toml", ""), Ok(Config::default()));
    }

    #[test]
    fn a_reports_machine_reads_back() {
        let mut config = Config::primitive(4);
        config.set_words(&["memory.latency=17".into()]).unwrap();
        let text = serde_json::to_string(&config).unwrap();
        assert_eq!(serde_json::from_str::<Config>(&text).unwrap(), config);
        let wrong = text.replace("17", "-17");
        let error = serde_json::from_str::<Config>(&wrong).unwrap_err();
        assert!(error.to_string().contains("latency"), "{error}");
    }

    #[test]
    fn the_primitive_is_a_machine_and_keeps_what_the_circuit_fixes() {
        for lanes in [1, 2, 4, 8, 16] {
            let config = Config::named(&format!("primitive-{lanes}")).unwrap();
            assert_eq!(config.lanes, lanes);
            assert_eq!(from_toml("m.toml", &to_toml(&config)), Ok(config));
        }
        assert_eq!(Config::named("primitive-3"), None);
        let mut config = Config::primitive(4);
        let error = config.set_words(&["rows_at_once=2".into()]).unwrap_err();
        assert!(error.to_string().contains("needs 1"), "{error}");
        let mut config = Config::primitive(4);
        config.set_words(&["splat_cycles=1".into()]).unwrap();
        let error = config.set_words(&["splat_cycles=2".into()]).unwrap_err();
        assert!(error.to_string().contains("allows 1 and 4"), "{error}");
    }

    #[test]
    fn every_field_can_be_set_to_its_limits_and_no_further() {
        for field in &FIELDS {
            let (low, high) = match field.range {
                Range::Number(low, high) => (low, high),
                Range::OneOf(list) => (list[0], list[list.len() - 1]),
                Range::Choice(names) => (0, names.len() as u32 - 1),
            };
            let mut config = Config::default();
            for value in [low, high] {
                (field.set)(&mut config, value);
                assert_eq!((field.get)(&config), value, "{}", field.key);
            }
            let beyond = toml::Value::Integer(i64::from(high) + 1);
            assert!(
                config.set("--set", field.key, &beyond).is_err(),
                "{}",
                field.key
            );
        }
    }

    /// Every key of a file: what is beyond its range or of another kind is refused by file, line, key and what is allowed.
    #[test]
    fn every_key_is_refused_outside_its_range_by_name_and_line() {
        for field in &FIELDS {
            let wrong: Vec<String> = match field.range {
                Range::Number(low, high) => vec![
                    (i64::from(low) - 1).to_string(),
                    (i64::from(high) + 1).to_string(),
                    "9223372036854775807".to_owned(),
                    "\"many\"".to_owned(),
                    "1.5".to_owned(),
                ],
                Range::OneOf(list) => vec![
                    (i64::from(list[0]) - 1).to_string(),
                    (list[list.len() - 1] + 1).to_string(),
                    "true".to_owned(),
                ],
                Range::Choice(_) => vec!["\"none such\"".to_owned(), "1".to_owned()],
            };
            for value in wrong {
                let text = format!(
                    "# a machine\n\n[{}]\n{} = {value}\n",
                    field.section, field.key
                );
                let printed = from_toml("m.toml", &text).unwrap_err().to_string();
                let place = format!("m.toml:4: {} = ", field.path());
                assert!(printed.starts_with(&place), "{printed}");
                assert!(printed.ends_with(&field.allowed()), "{printed}");
                let mut config = Config::default();
                let word = format!("{}={}", field.key, value.trim_matches('"'));
                if config.set_words(std::slice::from_ref(&word)).is_ok() {
                    panic!("--set {word} was taken");
                }
            }
        }
    }

    /// The name that a memory part once had is told what it is called now.
    #[test]
    fn the_old_name_of_a_memory_part_is_told_the_new_one() {
        for (text, line) in [
            ("[memory]\npart = \"ddr3-1600-x16\"\n", 2),
            ("memory.part = 1\n", 1),
        ] {
            let printed = from_toml("m.toml", text).unwrap_err().to_string();
            let expected = format!(
                "m.toml:{line}: unknown key 'memory.part': the memory is memory_part; the FPGA is the option --part"
            );
            assert_eq!(printed, expected);
        }
    }

    #[test]
    fn errors_name_key_line_and_range() {
        let message = |text: &str| from_toml("m.toml", text).unwrap_err().to_string();
        assert_eq!(
            message("[tile]\n\n[memory]\nlatency = 1000000\n"),
            "m.toml:4: memory.latency = 1000000: allowed are 0 to 100000"
        );
        assert_eq!(
            message("[lanes]\nlanes = 3\n"),
            "m.toml:2: lanes.lanes = 3: allowed are 1, 2, 4, 8, 16, 32, 64"
        );
        assert_eq!(
            message("[lanes]\nlayout = \"cube\"\n"),
            "m.toml:2: lanes.layout = \"cube\": allowed are \"run\", \"aligned\", \"quad\", \"rows\""
        );
        assert_eq!(
            message("[lanes]\nlatency = 3\n"),
            "m.toml:2: unknown key 'lanes.latency': 'latency' belongs into [memory]"
        );
        assert!(message("[memory]\nlatencies = 3\n").contains("did you mean latency"));
        assert!(
            message("[lanes]\nlayout = \"quad\"\n")
                .contains("m.toml:2: layout = \"quad\": allowed with 2")
        );
        assert!(message("x = \n").contains("line 1"));
        assert!(message("tile.tile_width = 9").contains("m.toml:1"));
        let printed = message("colour = 9");
        assert!(
            printed.contains("m.toml:1: unknown key 'colour': the sections are tile, memory"),
            "{printed}"
        );
        let printed = message("[buffer]\nhue = 3\n");
        assert!(
            printed.contains("[buffer] has tile_buffers, buffer_banks"),
            "{printed}"
        );
    }
}
