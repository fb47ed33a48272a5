//! Memory parts: organisation and timings of real DRAM, in clocks of the part, with the data sheet that they are from.
//!
//! The figures (`parts.toml`) were entered by hand from the sheets that `source` names; the tests state them once more
//! in nanoseconds, and do not read the sheets. Times that a data sheet gives in nanoseconds are rounded up to whole
//! clocks there, as a controller has to.

use serde::Deserialize;
use std::sync::LazyLock;

/// One memory part on one channel.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DramPart {
    /// Name in a machine file.
    pub name: String,
    /// What it is, and where its figures stand.
    pub source: String,
    /// Clock, kHz.
    pub khz: u64,
    /// Transfers per clock: 1, or 2 on both edges.
    pub rate: u64,
    /// Bytes of a transfer.
    pub bus_bytes: u64,
    /// Transfers of a burst.
    pub burst: u64,
    /// Banks, a power of two.
    pub banks: u64,
    /// Bytes of a row.
    pub row_bytes: u64,
    /// From a read command to its data.
    pub cl: u64,
    /// From a write command to its data.
    pub cwl: u64,
    /// From an activation to a command.
    pub rcd: u64,
    /// From a precharge to an activation.
    pub rp: u64,
    /// From an activation to a precharge.
    pub ras: u64,
    /// Between activations of two banks.
    pub rrd: u64,
    /// Between an activation and the fourth after it.
    pub faw: u64,
    /// Between two commands of the same direction.
    pub ccd: u64,
    /// From the last data written to a read command.
    pub wtr: u64,
    /// From the last data written to a precharge.
    pub wr: u64,
    /// From a read command to a precharge.
    pub rtp: u64,
    /// Between two refreshes.
    pub refi: u64,
    /// How long a refresh takes.
    pub rfc: u64,
}

/// All parts.
pub static PARTS: LazyLock<Vec<DramPart>> = LazyLock::new(|| {
    #[derive(Deserialize)]
    struct PartsFile {
        parts: Vec<DramPart>,
    }
    let file: PartsFile = toml::from_str(include_str!("parts.toml")).expect("a table of parts");
    file.parts
});

impl DramPart {
    /// Bytes of a burst.
    pub fn burst_bytes(&self) -> u64 {
        self.bus_bytes * self.burst
    }

    /// Clocks in which a burst is on the bus.
    pub fn burst_clocks(&self) -> u64 {
        self.burst / self.rate
    }

    /// Bytes a second that its bus can move.
    pub fn peak_bytes_per_s(&self) -> u64 {
        self.khz * 1000 * self.rate * self.bus_bytes
    }
}
