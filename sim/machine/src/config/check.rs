//! Conditions between settings: what no machine can be, because the model does not have it or the circuit cannot do it.

use super::settings::{setting, shown};
use super::{Binning, Config, LaneLayout, Overlap, Sorter, primitive};

/// Bytes that a simulated machine's queues may take: a thousandth of it is a large machine, and sweeps simulate several
/// at once.
const MOST_BYTES: u64 = 256_000_000;

/// What the circuit of `sim/rtl` fixes.
const FIXED: [&str; 6] = [
    "layout",
    "rows_at_once",
    "pixel_termination",
    "table_ports",
    "blend_interval",
    "buffer_banks",
];

/// A setting at fault, and what is allowed.
type Conflict = (&'static str, String);

impl Config {
    /// Conditions between settings: the key at fault, its value and what is allowed.
    pub fn check_together(&self) -> Result<(), (&'static str, String, String)> {
        let lacks = self.model_lacks().or_else(|| self.primitive_lacks());
        let Some((key, allowed)) = lacks.or_else(|| self.too_large()) else {
            return Ok(());
        };
        let value = setting(key).map(|setting| setting.value(self).to_string());
        Err((key, value.unwrap_or_default(), allowed))
    }

    /// What the model does not have.
    fn model_lacks(&self) -> Option<Conflict> {
        let part = self.memory_part > 0;
        let before_binning = self.sorter != Sorter::Passes;
        let conditions = [
            (
                part && self.packet_cache > 0,
                "packet_cache",
                "allowed is 0 with a memory part: a cache in front of its port is not modelled",
            ),
            (
                before_binning && self.sorted_bytes() < 10,
                "sorter",
                "allowed with a sort_bytes of 10 or more: a key has 48 bits, a splat's number 32",
            ),
            (
                before_binning && self.binning == Binning::Exact,
                "sorter",
                "allowed with binning = \"box\": tiles are counted before anything is traversed",
            ),
            (
                before_binning && self.sort_every > 1,
                "sorter",
                "allowed with a sort_every of 1: kept lists are sorted by their entries",
            ),
            (
                before_binning && part,
                "sorter",
                "allowed with memory_part = \"channels\": their writes on a part are not modelled",
            ),
            (
                self.sort_every > 1 && self.sort_passes < 2,
                "sort_every",
                "allowed is 1 with a sort_passes below 2: to merge what came into a kept list is a pass itself",
            ),
            (
                before_binning && self.surface_layers > 0,
                "sorter",
                "allowed is \"passes\" with a surface unit: it takes splats in any order, and nothing is sorted",
            ),
            (
                self.overlap == Overlap::Primitive && self.surface_layers > 0,
                "overlap",
                "allowed with surface_layers = 0: the circuit of sim/rtl has no surface unit",
            ),
            (
                part && self.overlap_frames > 1,
                "overlap_frames",
                "allowed is 1 with a memory part: phases of two pictures at one port are not simulated",
            ),
            (
                self.layout == LaneLayout::Quad && self.lanes < 2,
                "layout",
                "allowed with 2 or more lanes",
            ),
            (
                self.layout == LaneLayout::Rows && self.overlap == Overlap::Serial,
                "layout",
                "allowed with overlap = \"pipelined\" or \"primitive\"",
            ),
            (
                part && self.clock_mhz == 0,
                "memory_part",
                "allowed with a clock_mhz of 1 to 10000: the part has a clock of its own",
            ),
        ];
        let found = conditions.into_iter().find(|(wrong, ..)| *wrong);
        found.map(|(_, key, allowed)| (key, allowed.to_owned()))
    }

    /// What the circuit of `sim/rtl` cannot do, where it is the raster unit.
    fn primitive_lacks(&self) -> Option<Conflict> {
        if self.overlap != Overlap::Primitive {
            return None;
        }
        let (found, needed) = (self.values(), Config::primitive(self.lanes).values());
        let other = FIXED.into_iter().find(|key| found[*key] != needed[*key]);
        if let Some(key) = other {
            let needed = shown(&needed[key]);
            return Some((key, format!("overlap = \"primitive\" needs {needed}")));
        }
        let columns = primitive::TILE[0];
        if ![1, 4, 8].contains(&self.splat_cycles) {
            let allowed = "overlap = \"primitive\" allows 1, 4 and 8";
            return Some(("splat_cycles", allowed.to_owned()));
        }
        if ![1, 2].contains(&self.row_cycles) || self.row_cycles > self.splat_cycles {
            let allowed = "overlap = \"primitive\" allows 1, and 2 with splat_cycles = 4 or 8";
            return Some(("row_cycles", allowed.to_owned()));
        }
        if self.tile_width > columns {
            let allowed =
                format!("overlap = \"primitive\" allows up to {columns} columns, one seed a row");
            return Some(("tile_width", allowed));
        }
        if self.lanes > u32::from(self.tile_height) {
            let rows = self.tile_height;
            let allowed =
                format!("overlap = \"primitive\" allows up to tile_height = {rows} lanes");
            return Some(("lanes", allowed));
        }
        None
    }

    fn too_large(&self) -> Option<Conflict> {
        if self.simulator_bytes() > MOST_BYTES {
            let allowed = format!(
                "with these lanes and FIFOs the simulator would take {} MB, allowed are {} MB: fewer units, or shallower FIFOs",
                self.simulator_bytes() / 1_000_000,
                MOST_BYTES / 1_000_000
            );
            return Some(("raster_units", allowed));
        }
        if self.lanes > u32::from(self.tile_width) && self.layout != LaneLayout::Rows {
            let columns = self.tile_width;
            let allowed = format!("allowed are up to tile_width = {columns} lanes in this layout");
            return Some(("lanes", allowed));
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::{refused, says};

    #[test]
    fn what_cannot_be_sorted_before_it_is_binned_is_refused_by_name() {
        for (words, printed) in [
            ("sort_bytes=8", "sort_bytes of 10 or more"),
            ("binning=exact", "binning = \"box\""),
            ("memory_part=ddr3-1600-x16", "memory_part = \"channels\""),
        ] {
            for sorter in ["radix", "merge"] {
                let words = format!("clock_mhz=100 sorter={sorter} {words}");
                let error = refused(Config::machine(4), &words);
                says(&error, &[&format!("sorter = \"{sorter}\""), printed]);
            }
        }
        assert_eq!(Config::named("machine-4"), Some(Config::machine(4)));
        assert_eq!(Config::named("machine-3"), None);
    }
}
