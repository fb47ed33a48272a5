//! The machine's configuration: its settings, what they may be, named machines, and what follows from several settings.
//!
//! ```text
//! settings.toml -> settings: unit, range, default, meaning -> file: reading, checks one by one, printing
//!     -> check: settings together
//! ```

mod check;
mod file;
mod settings;

use super::memory::parts::{DramPart, PARTS};
use super::primitive;
use serde::{Deserialize, Serialize};
use std::sync::LazyLock;

pub use file::{from_file, from_toml, known, to_toml};
pub use settings::{Allowed, SETTINGS, Setting, setting};

/// How the lanes lie on the screen; see `docs/hardware-model.md`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum LaneLayout {
    /// Adjacent pixels, groups begin where the run begins.
    Run,
    /// Adjacent pixels, groups begin at multiples of the number of lanes.
    Aligned,
    /// Two rows by half as many columns, aligned.
    Quad,
    /// Every lane owns the rows `y mod lanes` of the tile.
    Rows,
}

/// How work is shared out among the stages of a raster unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Overlap {
    /// Splat setup, row generator and lanes take turns: one unit.
    Serial,
    /// They work at the same time, with FIFOs between them.
    Pipelined,
    /// They are the circuit of `sim/rtl`, cycle by cycle: pipelines that never stand still, and queues with counted
    /// places behind them.
    Primitive,
}

/// Who draws which tile.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Assignment {
    /// Tile i goes to unit i mod N.
    Static,
    /// The next tile goes to the unit that first has nothing left to fetch.
    Dynamic,
}

/// What happens to pixels that have finished.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Termination {
    /// They are visited; the blend is suppressed.
    Discard,
    /// Groups of finished pixels are not visited.
    Skip,
}

/// Which tiles a footprint is listed in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Binning {
    /// Those that its bounding box meets.
    Box,
    /// Those in which its traversal visits a pixel.
    Exact,
}

/// How splats are brought into the order of their depths.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Sorter {
    /// So many passes over the entries of all lists, whatever they do.
    Passes,
    /// Visible splats before they are binned, digit by digit of their keys, as `depth_sort.sv` does.
    Radix,
    /// The same by a network: sorted runs from the chip, then merges of many runs at a time.
    Merge,
}

/// The order in which tiles are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum TileWalk {
    /// Row by row, each from the left.
    Raster,
    /// Row by row, to the right and back in turn.
    Serpentine,
    /// By the interleaved bits of column and row.
    Morton,
    /// Along Hilbert's curve.
    Hilbert,
}

/// A machine: a value for each of [`SETTINGS`], which say what it means, its unit, its range and its default:
///
/// ```toml
#[doc = include_str!("config/settings.toml")]
/// ```
///
/// As data it is the table of its file, so that a report's machine reads like one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(remote = "Self", deny_unknown_fields)]
#[allow(missing_docs)]
pub struct Config {
    pub tile_width: u16,
    pub tile_height: u16,
    pub splat_bytes: u32,
    pub packet_bytes: u32,
    pub list_bytes: u32,
    pub pixel_bytes: u32,
    pub read_bandwidth: u32,
    pub write_bandwidth: u32,
    pub latency: u32,
    pub setup_units: u32,
    pub setup_interval: u32,
    pub setup_latency: u32,
    pub setup_fifo: u32,
    pub harmonics_cycles: u32,
    pub bin_cycles: u32,
    pub bin_tile_cycles: u32,
    pub bin_fifo: u32,
    pub binning: Binning,
    pub sorter: Sorter,
    pub sort_digit: u32,
    pub sort_run: u32,
    pub sort_ways: u32,
    pub sort_passes: u32,
    pub sort_cycles: u32,
    pub sort_every: u32,
    pub raster_units: u32,
    pub assignment: Assignment,
    pub overlap: Overlap,
    pub splat_cycles: u32,
    pub row_cycles: u32,
    pub rows_at_once: u32,
    pub packet_fifo: u32,
    pub splat_fifo: u32,
    pub row_fifo: u32,
    pub lanes: u32,
    pub layout: LaneLayout,
    pub pixel_termination: Termination,
    pub tile_termination: u32,
    pub table_latency: u32,
    pub table_ports: u32,
    pub blend_latency: u32,
    pub blend_interval: u32,
    pub surface_layers: u32,
    pub surface_light: u32,
    pub resolve_interval: u32,
    pub tile_buffers: u32,
    pub buffer_banks: u32,
    pub write_back_cycles: u32,
    pub clear_cycles: u32,
    pub packet_cache: u32,
    pub tile_order: TileWalk,
    pub clock_mhz: u32,
    pub overlap_frames: u32,
    #[serde(with = "part_by_name")]
    pub memory_part: u32,
    pub write_queue: u32,
    pub harmonics_bytes: u32,
    pub sort_bytes: u32,
}

impl Default for Config {
    fn default() -> Self {
        static DEFAULT: LazyLock<Config> = LazyLock::new(settings::defaults);
        *DEFAULT
    }
}

/// A memory part by its name; the two channels of a fixed bandwidth are called `channels`.
mod part_by_name {
    use super::PARTS;
    use serde::{Deserialize, Deserializer, Serializer, de::Error};

    pub fn serialize<S: Serializer>(part: &u32, to: S) -> Result<S::Ok, S::Error> {
        let part = (*part as usize)
            .checked_sub(1)
            .and_then(|index| PARTS.get(index));
        to.serialize_str(part.map_or("channels", |part| part.name.as_str()))
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<u32, D::Error> {
        let name = String::deserialize(from)?;
        if name == "channels" {
            return Ok(0);
        }
        let index = PARTS.iter().position(|part| part.name == name);
        let index = index.ok_or_else(|| D::Error::custom("no such memory part"))?;
        Ok(index as u32 + 1)
    }
}

impl Config {
    /// The machine around the splat primitive of `sim/rtl` with so many lanes (a power of two up to 16).
    pub fn primitive(lanes: u32) -> Config {
        let [tile_width, tile_height] = primitive::TILE;
        Config {
            tile_width,
            tile_height,
            // Transmittance and three colours, a word each.
            pixel_bytes: 16,
            overlap: Overlap::Primitive,
            splat_cycles: primitive::Intervals::USUAL.setup,
            row_cycles: primitive::Intervals::USUAL.rows,
            rows_at_once: 1,
            row_fifo: primitive::QUEUE,
            lanes,
            layout: LaneLayout::Rows,
            tile_termination: 0,
            // From a lane's pixel to the reading of its transmittance, and with its colours to the end.
            table_latency: 9,
            blend_latency: primitive::INTERVAL as u32,
            tile_buffers: 2,
            write_back_cycles: 3,
            ..Config::default()
        }
    }

    /// What the primitive of `sim/rtl` is built with to be this machine's raster unit.
    pub fn intervals(&self) -> primitive::Intervals {
        primitive::Intervals {
            setup: self.splat_cycles,
            rows: self.row_cycles,
        }
    }

    /// The same with the primitive's other intervals.
    pub fn with_intervals(self, intervals: primitive::Intervals) -> Config {
        Config {
            splat_cycles: intervals.setup,
            row_cycles: intervals.rows,
            ..self
        }
    }

    /// The whole machine of `sim/rtl` (`splat_machine.sv`) with so many lanes: words of 16 bytes in either direction,
    /// splats sorted before they are binned. Setup takes a splat in 16 cycles, which is nine cores of lean18, in five
    /// pairs, whose round has 135.
    pub fn machine(lanes: u32) -> Config {
        Config {
            splat_bytes: 80,
            read_bandwidth: 16,
            write_bandwidth: 16,
            setup_interval: 16,
            setup_latency: 1073,
            sorter: Sorter::Radix,
            sort_bytes: 16,
            ..Config::primitive(lanes)
        }
    }

    /// A machine by its name: `primitive-1` to `primitive-16`, and `machine-1` to `machine-16` with what stands before
    /// it.
    pub fn named(name: &str) -> Option<Config> {
        let (kind, lanes) = name.rsplit_once('-')?;
        let lanes: u32 = lanes.parse().ok()?;
        let known = [1, 2, 4, 8, 16].contains(&lanes);
        match kind {
            "primitive" if known => Some(Config::primitive(lanes)),
            "machine" if known => Some(Config::machine(lanes)),
            _ => None,
        }
    }

    /// The memory part, if it is not the two channels.
    pub fn memory_part(&self) -> Option<&'static DramPart> {
        let index = (self.memory_part as usize).checked_sub(1)?;
        PARTS.get(index)
    }

    /// Bytes that the memory could move in a cycle of so many megahertz: both channels together, or the part at its
    /// peak.
    pub fn channel_bytes_per_cycle(&self, mhz: f64) -> f64 {
        match self.memory_part() {
            Some(part) => part.peak_bytes_per_s() as f64 / (1e6 * mhz),
            None => f64::from(self.read_bandwidth) + f64::from(self.write_bandwidth),
        }
    }

    /// Bytes of a packet, of which the design's has so many.
    pub fn bytes_of_packet(&self, of_design: u32) -> u32 {
        match self.packet_bytes {
            0 => of_design,
            bytes => bytes,
        }
    }

    /// Bytes of an entry while it is sorted.
    pub fn sorted_bytes(&self) -> u32 {
        match self.sort_bytes {
            0 => self.list_bytes,
            bytes => bytes,
        }
    }

    /// Banks of a tile buffer, one a lane unless they are given.
    pub fn banks(&self) -> u64 {
        match self.buffer_banks {
            0 => self.lanes.into(),
            banks => banks.into(),
        }
    }

    /// Pixels of a tile.
    pub fn tile_pixels(&self) -> u64 {
        u64::from(self.tile_width) * u64::from(self.tile_height)
    }

    /// Pixels of a bank of a tile buffer.
    pub fn bank_words(&self) -> u64 {
        self.tile_pixels().div_ceil(self.banks())
    }

    /// Cycles per group of lanes, stretched where ports or banks are fewer than lanes.
    pub fn stretch(&self) -> u32 {
        let shared = |ports: u32| match ports {
            0 => 1,
            ports => self.lanes.div_ceil(ports),
        };
        let shared = shared(self.table_ports).max(shared(self.buffer_banks));
        self.blend_interval.max(shared)
    }

    /// Bytes of the queues that simulating it takes: a time per place, in rings of a power of two, and the primitive's
    /// own per lane.
    pub fn simulator_bytes(&self) -> u64 {
        let ring = |depth: u32| u64::from(depth.next_power_of_two());
        let lanes = u64::from(self.lanes);
        let sequencers = match self.layout {
            LaneLayout::Rows => lanes,
            _ => 1,
        };
        let unit = sequencers * ring(self.row_fifo)
            + ring(self.packet_fifo)
            + ring(self.splat_fifo)
            + lanes * u64::from(self.row_fifo)
            + u64::from(self.packet_cache);
        let geometry = ring(self.setup_fifo) + ring(self.bin_fifo);
        8 * (u64::from(self.raster_units) * unit + geometry)
    }
}
