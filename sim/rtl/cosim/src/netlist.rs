//! What Yosys writes about a circuit, as far as it is read here.

use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;

/// Yosys' netlist; what is not read here is written as it was.
#[derive(Deserialize, Serialize)]
pub struct Netlist {
    pub modules: BTreeMap<String, NetlistModule>,
    #[serde(flatten)]
    rest: BTreeMap<String, Value>,
}

#[derive(Deserialize, Serialize)]
pub struct NetlistModule {
    pub ports: BTreeMap<String, NetlistPort>,
    pub cells: BTreeMap<String, NetlistCell>,
    #[serde(flatten)]
    rest: BTreeMap<String, Value>,
}

#[derive(Deserialize, Serialize)]
pub struct NetlistPort {
    pub direction: String,
    pub bits: Vec<Bit>,
    #[serde(flatten)]
    rest: BTreeMap<String, Value>,
}

#[derive(Clone, Deserialize, Serialize)]
pub struct NetlistCell {
    #[serde(rename = "type")]
    pub kind: String,
    pub parameters: BTreeMap<String, String>,
    #[serde(default)]
    port_directions: BTreeMap<String, String>,
    #[serde(default)]
    pub connections: BTreeMap<String, Vec<Bit>>,
    #[serde(flatten)]
    rest: BTreeMap<String, Value>,
}

/// A net, or a constant.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Deserialize, Serialize)]
#[serde(untagged)]
pub enum Bit {
    Net(u64),
    Constant(String),
}

impl Bit {
    /// The net, if it is one.
    pub fn net(&self) -> Option<u64> {
        match self {
            Bit::Net(net) => Some(*net),
            Bit::Constant(_) => None,
        }
    }

    /// Is it this constant?
    pub fn is(&self, constant: &str) -> bool {
        matches!(self, Bit::Constant(own) if own == constant)
    }
}

impl NetlistCell {
    /// Bits of a memory; nothing of anything else. Parameters are binary numerals.
    pub fn memory_bits(&self) -> Option<u64> {
        let parameter = |name| u64::from_str_radix(self.parameters.get(name)?, 2).ok();
        let bits = parameter("SIZE")? * parameter("WIDTH")?;
        self.kind.starts_with("$mem").then_some(bits)
    }

    /// What a pin of one bit is connected to.
    pub fn pin(&self, name: &str) -> Option<&Bit> {
        self.connections.get(name)?.first()
    }

    /// The net that it is connected to.
    pub fn net(&self, name: &str) -> Option<u64> {
        self.pin(name)?.net()
    }

    /// Connects an input.
    pub fn connect(&mut self, name: &str, bit: &Bit) {
        self.connections.insert(name.to_owned(), vec![bit.clone()]);
        self.port_directions.insert(name.to_owned(), "input".into());
    }

    /// Sets a parameter.
    pub fn set(&mut self, name: &str, value: &str) {
        self.parameters.insert(name.to_owned(), value.to_owned());
    }

    /// The nets that its inputs read.
    pub fn inputs(&self) -> impl Iterator<Item = u64> + '_ {
        let way = |name| self.port_directions.get(name).map(String::as_str);
        let pins = self.connections.iter();
        let pins = pins.filter(move |(name, _)| way(*name) != Some("output"));
        pins.flat_map(|(_, bits)| bits.iter().filter_map(Bit::net))
    }
}
