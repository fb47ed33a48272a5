//! What Yosys writes about a circuit, as far as it is read here.

use serde::Deserialize;
use serde::de::IgnoredAny;
use std::collections::BTreeMap;

/// Yosys' netlist.
#[derive(Deserialize)]
pub struct Netlist {
    pub modules: BTreeMap<String, NetlistModule>,
}

#[derive(Deserialize)]
pub struct NetlistModule {
    pub ports: BTreeMap<String, NetlistPort>,
    pub cells: BTreeMap<String, NetlistCell>,
}

#[derive(Deserialize)]
pub struct NetlistPort {
    pub direction: String,
    pub bits: Vec<IgnoredAny>,
}

#[derive(Deserialize)]
pub struct NetlistCell {
    #[serde(rename = "type")]
    pub kind: String,
    pub parameters: BTreeMap<String, String>,
}

impl NetlistCell {
    /// Bits of a memory; nothing of anything else. Parameters are binary numerals.
    pub fn memory_bits(&self) -> Option<u64> {
        let parameter = |name| u64::from_str_radix(self.parameters.get(name)?, 2).ok();
        if !self.kind.starts_with("$mem") {
            return None;
        }
        Some(parameter("SIZE")? * parameter("WIDTH")?)
    }
}
