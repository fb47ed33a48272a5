//! Area of what stands between the memory and the raster units: sorter and binning, harmonics, readers and their
//! arbiter, by their synthesis.
//!
//! Their cells are counted as `rtl -- area UNIT` counts them, each unit alone. What a machine has otherwise than the
//! circuits is charged by more of the same: a reader for each raster unit, an arbiter for each three that ask. A
//! merging sorter was not written: it is charged as the radix sorter, with a comparator of a key for each run that it
//! merges, which is an estimate. The controller of the memory and its pins are not here: they are the vendor's.

use super::{Calibration, Fabric, Family, lines_of};
use crate::config::{Config, Sorter};
use serde::Deserialize;
use std::sync::LazyLock;

/// The counts, flattened, as Yosys gives them.
static UNITS: LazyLock<Vec<UnitLine>> =
    LazyLock::new(|| lines_of(include_str!("units.csv")).expect("units.csv is a table of units"));

/// A unit for a family.
#[derive(Deserialize)]
struct UnitLine {
    unit: String,
    family: Family,
    #[serde(flatten)]
    fabric: Fabric,
}

/// Those that ask at one arbiter.
const ASKERS: u64 = 3;

/// Bits of a key that a comparator sees, each of which takes half a look-up table and a register in the tree of a
/// merge.
const KEY_BITS: u64 = 48;

/// The counts of a unit for a family.
///
/// # Panics
/// If the table has no such line; a test reads all of them.
fn unit(name: &str, family: Family) -> Fabric {
    let mut lines = UNITS.iter();
    let found = lines.find(|line| (line.unit.as_str(), line.family) == (name, family));
    found
        .expect("units.csv has every unit for every family")
        .fabric
}

/// All of a machine's.
pub(super) fn of_machine(config: &Config, calibration: &Calibration) -> Fabric {
    let unit = |name| unit(name, calibration.family);
    let raster_units = u64::from(config.raster_units);
    // Splats are read for setup and by the sort, lists and packets by each raster unit.
    let readers = 2 + raster_units;
    let asking = unit("stream") * readers + unit("arbiter") * readers.div_ceil(ASKERS);
    let mut all = unit("binning") + asking;
    if config.surface_layers == 0 {
        all = all + unit("sort");
    }
    if config.harmonics_bytes > 0 {
        all = all + unit("harmonics");
    }
    if config.sorter == Sorter::Merge {
        let runs = u64::from(config.sort_ways);
        all = all
            + Fabric {
                luts: runs * KEY_BITS / 2,
                flip_flops: runs * KEY_BITS,
                ..Fabric::default()
            };
    }
    all
}

/// What no area counts, for an answer to say.
pub const LEFT_OUT: &str = "not in the area: the memory's controller and pins (the vendor's), the bus to the host, packet fetch and tile finder";

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::changed;

    #[test]
    fn every_unit_is_there_for_every_family() {
        for family in Family::ALL {
            for name in ["sort", "binning", "harmonics", "arbiter", "stream"] {
                assert!(unit(name, family).luts > 20, "{name}");
            }
        }
    }

    /// Harmonics, more raster units and merged runs each take more; a splat without harmonics takes no unit for them.
    #[test]
    fn what_a_scene_needs_is_charged() {
        let prices = Family::Ecp5.calibration();
        let area = |words: &str| of_machine(&changed(Config::default(), words), &prices);
        let plain = area("");
        let harmonics = unit("harmonics", Family::Ecp5);
        assert_eq!(area("harmonics_bytes=48"), plain + harmonics);
        let streams = unit("stream", Family::Ecp5) * 2;
        let arbiter = unit("arbiter", Family::Ecp5);
        assert_eq!(area("raster_units=3"), plain + streams + arbiter);
        let merged = area("sort_bytes=16 sorter=merge");
        assert_eq!(merged.luts - plain.luts, 16 * 24);
    }
}
