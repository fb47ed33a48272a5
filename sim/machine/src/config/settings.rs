//! What the settings of a machine are. Each is declared in one line of `settings.toml`; ranges, defaults, messages, the
//! commented file and the axes of sweeps follow from it.

use super::Config;
use serde::{Deserialize, Serialize, Serializer};
use std::sync::LazyLock;
use toml::{Table, Value};

const DECLARED: &str = include_str!("settings.toml");

/// What a setting may hold.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Allowed {
    /// A whole number from the first to the second.
    Range([u32; 2]),
    /// One of these numbers.
    OneOf(Vec<u32>),
    /// One of these names.
    Names(Vec<String>),
}

/// One setting of a machine.
#[derive(Clone, Debug, Deserialize)]
pub struct Setting {
    /// Section of the TOML file.
    pub section: String,
    /// Key in the section; no two sections share one.
    pub key: String,
    /// Allowed values.
    #[serde(flatten)]
    pub allowed: Allowed,
    /// What it is where nobody says.
    pub default: Value,
    /// What it counts; empty for names, and where the meaning says it.
    #[serde(default)]
    pub unit: String,
    about: String,
}

/// All settings, in the order of the file.
pub static SETTINGS: LazyLock<Vec<Setting>> = LazyLock::new(|| {
    #[derive(Deserialize)]
    struct Declared {
        settings: Vec<Setting>,
    }
    let declared: Declared = toml::from_str(DECLARED).expect("the declarations are a table");
    declared.settings
});

/// The setting called `section.key`, or `key` alone.
pub fn setting(name: &str) -> Option<&'static Setting> {
    let (section, key) = name.split_once('.').unwrap_or(("", name));
    let named = |setting: &&Setting| setting.key == key;
    let found = SETTINGS.iter().find(named);
    found.filter(|setting| section.is_empty() || setting.section == section)
}

impl Setting {
    /// What it means.
    pub fn meaning(&self) -> String {
        format!("{} {}", self.unit, self.about)
            .trim_start()
            .to_owned()
    }

    /// Is the value allowed?
    pub fn accepts(&self, value: &Value) -> bool {
        let number = value.as_integer().and_then(|number| number.try_into().ok());
        match &self.allowed {
            Allowed::Range([low, high]) => number.is_some_and(|n| (*low..=*high).contains(&n)),
            Allowed::OneOf(list) => number.is_some_and(|number| list.contains(&number)),
            Allowed::Names(names) => names.iter().any(|name| value.as_str() == Some(name)),
        }
    }

    /// What is allowed, in words.
    pub fn allowed(&self) -> String {
        match &self.allowed {
            Allowed::Range([low, high]) => format!("allowed are {low} to {high}"),
            Allowed::OneOf(list) => {
                let list: Vec<String> = list.iter().map(u32::to_string).collect();
                format!("allowed are {}", list.join(", "))
            }
            Allowed::Names(names) => format!("allowed are \"{}\"", names.join("\", \"")),
        }
    }

    /// The ends of its range, or all values of its list.
    pub fn limits(&self) -> Vec<Value> {
        let numbers = |list: &[u32]| list.iter().map(|n| Value::from(*n)).collect();
        match &self.allowed {
            Allowed::Range(ends) => numbers(ends),
            Allowed::OneOf(list) => numbers(list),
            Allowed::Names(names) => names.iter().map(|name| Value::from(name.clone())).collect(),
        }
    }

    /// What a machine has.
    pub fn value(&self, config: &Config) -> Value {
        config.values()[&self.key].clone()
    }
}

/// A value without quotes.
pub(super) fn shown(value: &Value) -> String {
    value
        .as_str()
        .map_or_else(|| value.to_string(), str::to_owned)
}

/// The machine of all defaults.
pub(super) fn defaults() -> Config {
    let default = |setting: &Setting| (setting.key.clone(), setting.default.clone());
    Config::of_values(SETTINGS.iter().map(default).collect())
}

impl Config {
    /// The values of all settings by their keys.
    pub fn values(&self) -> Table {
        struct ByKey<'a>(&'a Config);
        impl Serialize for ByKey<'_> {
            fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
                Config::serialize(self.0, to)
            }
        }
        Table::try_from(ByKey(self)).expect("numbers and names are TOML")
    }

    /// The machine of these values, each of which its setting must accept.
    pub(super) fn of_values(values: Table) -> Config {
        Config::deserialize(values).expect("a setting's allowed values are of its kind")
    }
}
