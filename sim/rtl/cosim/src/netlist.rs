//! What Yosys and nextpnr write about a circuit, as far as it is read here.

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

/// Yosys' `stat -json`.
#[derive(Deserialize)]
pub struct Statistics {
    pub design: DesignStatistics,
}

#[derive(Deserialize)]
pub struct DesignStatistics {
    pub num_cells_by_type: BTreeMap<String, u64>,
}

/// nextpnr's report.
#[derive(Deserialize)]
pub struct PlacerReport {
    pub fmax: BTreeMap<String, ClockReport>,
    pub critical_paths: Vec<PathReport>,
}

#[derive(Deserialize)]
pub struct ClockReport {
    pub achieved: f64,
}

#[derive(Deserialize)]
pub struct PathReport {
    pub from: String,
    pub to: String,
    pub path: Vec<StepReport>,
}

#[derive(Deserialize)]
pub struct StepReport {
    pub delay: f64,
    #[serde(rename = "type")]
    pub kind: String,
    pub from: EndReport,
    pub to: EndReport,
}

#[derive(Deserialize)]
pub struct EndReport {
    pub cell: String,
}
