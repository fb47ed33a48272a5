//! From TOML text to a [`Config`] and back. Errors name the file, the line, the key and what is allowed.

use super::Config;
use super::settings::{SETTINGS, setting};
use crate::input::{self, Refused, line_at};
use serde::de::{Error as _, IntoDeserializer};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;
use toml::de::{DeTable, DeValue};
use toml::{Table, Value};

/// Reads a machine file.
pub fn from_file(path: &Path) -> Result<Config, Refused> {
    let file = path.display().to_string();
    let text = input::text(path, input::SETTINGS)
        .map_err(|error| Refused(format!("{file}: cannot read the machine: {error}")))?;
    from_toml(&file, &text)
}

/// Reads a machine from the text of a file; keys that it does not name keep their defaults.
pub fn from_toml(file: &str, text: &str) -> Result<Config, Refused> {
    let malformed = |error: toml::de::Error| Refused(format!("{file}: {error}"));
    let place = |start: usize| format!("{file}:{}", line_at(text, start));
    let sections = DeTable::parse(text).map_err(malformed)?;
    let mut config = Config::default();
    let mut places = BTreeMap::new();
    for (section, keys) in sections.get_ref() {
        let name = section.get_ref();
        let known = SETTINGS.iter().any(|setting| setting.section == *name);
        let (DeValue::Table(keys), true) = (keys.get_ref(), known) else {
            return Err(unknown(&place(section.span().start), name));
        };
        for (key, value) in keys {
            let place = place(key.span().start);
            let value = Value::deserialize(value.clone().into_deserializer()).map_err(malformed)?;
            config.set(&place, &format!("{name}.{}", key.get_ref()), &value)?;
            places.insert(key.get_ref().to_string(), place);
        }
    }
    let place = |key: &str| places.get(key).cloned();
    config.check_at(|key| place(key).unwrap_or_else(|| format!("{file}:1")))?;
    Ok(config)
}

impl Config {
    /// Gives a setting a value; `place` says where that stands, for messages.
    pub fn set(&mut self, place: &str, key: &str, value: &Value) -> Result<(), Refused> {
        self.set_all(place, &[(key, value)])
    }

    /// Gives several settings values, in the time of one.
    pub fn set_all(&mut self, place: &str, all: &[(&str, &Value)]) -> Result<(), Refused> {
        let mut values = self.values();
        for (key, value) in all {
            let Some(setting) = setting(key) else {
                return Err(unknown(place, key));
            };
            if !setting.accepts(value) {
                let allowed = setting.allowed();
                return Err(Refused(format!("{place}: {key} = {value}: {allowed}")));
            }
            values.insert(setting.key.clone(), (*value).clone());
        }
        *self = Config::of_values(values);
        Ok(())
    }

    /// Gives settings values by `key=value` words, as the command line has them.
    pub fn set_words(&mut self, words: &[String]) -> Result<(), Refused> {
        for word in words {
            let (key, text) = word.split_once('=').unwrap_or((word, ""));
            let text = text.trim();
            let number = text.parse().map(Value::Integer);
            let value = number.unwrap_or_else(|_| Value::from(text));
            self.set("--set", key.trim(), &value)?;
        }
        self.check_at(|_| "--set".to_owned())
    }

    /// Checks the settings together; `place` says where a key stands.
    fn check_at(&self, place: impl FnOnce(&str) -> String) -> Result<(), Refused> {
        let checked = self.check_together();
        checked.map_err(|(key, value, allowed)| {
            Refused(format!("{}: {key} = {value}: {allowed}", place(key)))
        })
    }
}

impl Serialize for Config {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let mut values = self.values();
        let mut sections: BTreeMap<&str, Table> = BTreeMap::new();
        for setting in SETTINGS.iter() {
            let section = sections.entry(&setting.section).or_default();
            section.extend(values.remove_entry(&setting.key));
        }
        sections.serialize(to)
    }
}

impl<'de> Deserialize<'de> for Config {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Config, D::Error> {
        let sections = BTreeMap::<String, Table>::deserialize(from)?;
        let mut config = Config::default();
        for (section, keys) in sections {
            for (key, value) in keys {
                let set = config.set("machine", &format!("{section}.{key}"), &value);
                set.map_err(D::Error::custom)?;
            }
        }
        let checked = config.check_at(|_| "machine".to_owned());
        checked.map_err(D::Error::custom)?;
        Ok(config)
    }
}

/// The whole configuration with a comment per setting; reading it back gives the same configuration.
pub fn to_toml(config: &Config) -> String {
    let mut text = String::from(
        "# A splatting machine. Times in clock cycles; what is left out keeps its default.\n",
    );
    let values = config.values();
    let mut section = "";
    for setting in SETTINGS.iter() {
        if setting.section != section {
            section = &setting.section;
            // Writing to a String cannot fail.
            let _ = writeln!(text, "\n[{section}]");
        }
        let (meaning, allowed) = (setting.meaning(), setting.allowed());
        let line = format!("{} = {}", setting.key, values[&setting.key]);
        let _ = writeln!(text, "{line:<32} # {meaning}; {allowed}");
    }
    text
}

/// The keys of the section that an unknown key stands in, or the sections.
pub fn known(key: &str) -> String {
    let section = key.split_once('.').map_or("", |(section, _)| section);
    let in_section = SETTINGS.iter().filter(|setting| setting.section == section);
    let keys: Vec<&str> = in_section.map(|setting| setting.key.as_str()).collect();
    if !keys.is_empty() {
        return format!("[{section}] has {}", keys.join(", "));
    }
    let sections = SETTINGS.iter().map(|setting| setting.section.as_str());
    let mut sections: Vec<&str> = sections.collect();
    sections.dedup();
    let sections = sections.join(", ");
    format!("the sections are {sections}; docs/files.md lists their keys")
}

fn unknown(place: &str, key: &str) -> Refused {
    let name = key.rsplit('.').next().unwrap_or(key);
    let hint = match setting(name) {
        // The name that the setting once had, and that the command line has for something else.
        None if name == "part" => {
            ": the memory is memory_part; the FPGA is the option --part".to_owned()
        }
        Some(setting) => format!(": '{name}' belongs into [{}]", setting.section),
        None => {
            let start: String = name.chars().take(3).collect();
            let keys = SETTINGS.iter().map(|setting| setting.key.as_str());
            let near: Vec<&str> = keys.filter(|key| key.starts_with(&start)).collect();
            if near.is_empty() {
                format!(": {}", known(key))
            } else {
                format!(": did you mean {}?", near.join(" or "))
            }
        }
    };
    Refused(format!("{place}: unknown key '{key}'{hint}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::memory::parts::PARTS;
    use crate::tests::{changed, refused, says};

    /// The resolved file, and a report's machine.
    #[test]
    fn what_is_written_reads_back() {
        assert_eq!(from_toml("m.toml", ""), Ok(Config::default()));
        let named = |lanes| Config::named(&format!("primitive-{lanes}")).unwrap();
        let lanes = [1, 2, 4, 8, 16];
        assert_eq!(lanes.map(|lanes| named(lanes).lanes), lanes);
        let own = changed(Config::default(), "lanes=4 layout=rows memory.latency=17");
        for config in lanes.map(named).into_iter().chain([own]) {
            assert_eq!(from_toml("m.toml", &to_toml(&config)), Ok(config));
            let text = serde_json::to_string(&config).unwrap();
            assert_eq!(serde_json::from_str::<Config>(&text).unwrap(), config);
        }
        let wrong = serde_json::to_string(&own).unwrap().replace("17", "-17");
        let error = serde_json::from_str::<Config>(&wrong).unwrap_err();
        says(&error.to_string(), &["latency"]);
    }

    #[test]
    fn the_primitive_keeps_what_the_circuit_fixes() {
        assert_eq!(Config::named("primitive-3"), None);
        let error = refused(Config::primitive(4), "rows_at_once=2");
        says(&error, &["needs 1"]);
        let error = refused(
            changed(Config::primitive(4), "splat_cycles=1"),
            "splat_cycles=2",
        );
        says(&error, &["allows 1, 4 and 8"]);
        let every = changed(Config::primitive(1), "splat_cycles=1");
        says(
            &refused(every, "row_cycles=2"),
            &["2 with splat_cycles = 4 or 8"],
        );
    }

    #[test]
    fn every_setting_can_be_set_to_its_limits() {
        for setting in SETTINGS.iter() {
            assert!(setting.accepts(&setting.default), "{}", setting.key);
            let mut config = Config::default();
            assert_eq!(setting.value(&config), setting.default);
            for value in setting.limits() {
                config.set("--set", &setting.key, &value).unwrap();
                assert_eq!(setting.value(&config), value, "{}", setting.key);
            }
        }
        assert_eq!(SETTINGS.len(), Config::default().values().len());
        let parts = PARTS.iter().map(|part| Value::from(part.name.as_str()));
        let all = std::iter::once(Value::from("channels")).chain(parts);
        assert!(setting("memory_part").unwrap().limits().into_iter().eq(all));
    }

    /// Every key of a file: what is beyond its range or of another kind is refused by file, line, key and what is
    /// allowed.
    #[test]
    fn every_key_is_refused_outside_its_range_by_name_and_line() {
        for setting in SETTINGS.iter() {
            let limits = setting.limits();
            let numbers: Vec<i64> = limits.iter().filter_map(Value::as_integer).collect();
            let mut wrong = vec!["\"none such\"".to_owned(), "1.5".to_owned()];
            match (numbers.first(), numbers.last()) {
                (Some(low), Some(high)) => {
                    wrong.extend([low - 1, high + 1, i64::MAX].map(|number| number.to_string()));
                }
                _ => wrong.push("1".to_owned()),
            }
            for value in wrong {
                let text = format!(
                    "# a machine\n\n[{}]\n{} = {value}\n",
                    setting.section, setting.key
                );
                let printed = from_toml("m.toml", &text).unwrap_err().to_string();
                let place = format!("m.toml:4: {}.{} = ", setting.section, setting.key);
                assert!(printed.starts_with(&place), "{printed}");
                assert!(printed.ends_with(&setting.allowed()), "{printed}");
                let word = format!("{}={}", setting.key, value.trim_matches('"'));
                refused(Config::default(), &word);
            }
        }
    }

    #[test]
    fn errors_name_key_line_and_range() {
        let message = |text: &str| from_toml("m.toml", text).unwrap_err().to_string();
        let renamed =
            "unknown key 'memory.part': the memory is memory_part; the FPGA is the option --part";
        for (text, expected) in [
            (
                "[tile]\n\n[memory]\nlatency = 1000000\n",
                "4: memory.latency = 1000000: allowed are 0 to 100000",
            ),
            (
                "[lanes]\nlanes = 3\n",
                "2: lanes.lanes = 3: allowed are 1, 2, 4, 8, 16, 32, 64",
            ),
            (
                "[lanes]\nlayout = \"cube\"\n",
                "2: lanes.layout = \"cube\": allowed are \"run\", \"aligned\", \"quad\", \"rows\"",
            ),
            (
                "[lanes]\nlatency = 3\n",
                "2: unknown key 'lanes.latency': 'latency' belongs into [memory]",
            ),
            // The name that a memory part once had is told what it is called now.
            (
                "[memory]\npart = \"ddr3-1600-x16\"\n",
                &format!("2: {renamed}"),
            ),
            ("memory.part = 1\n", &format!("1: {renamed}")),
        ] {
            assert_eq!(message(text), format!("m.toml:{expected}"));
        }
        for (text, expected) in [
            ("[memory]\nlatencies = 3\n", "did you mean latency"),
            (
                "[lanes]\nlayout = \"quad\"\n",
                "m.toml:2: layout = \"quad\": allowed with 2",
            ),
            ("x = \n", "line 1"),
            ("tile.tile_width = 9", "m.toml:1"),
            (
                "colour = 9",
                "m.toml:1: unknown key 'colour': the sections are tile, memory",
            ),
            (
                "[buffer]\nhue = 3\n",
                "[buffer] has tile_buffers, buffer_banks",
            ),
        ] {
            says(&message(text), &[expected]);
        }
    }
}
