//! The table of fields: section, key, range, meaning, and how to read and write it in a [`Config`].

use super::{Assignment, Binning, Config, LaneLayout, Overlap, Sorter, Termination, TileWalk};
use crate::memory::parts::PARTS;

/// What a field may hold. Values are passed as integers; a choice is its index.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Range {
    /// A whole number from the first to the second.
    Number(u32, u32),
    /// One of these numbers.
    OneOf(&'static [u32]),
    /// One of these names.
    Choice(&'static [&'static str]),
}

/// One field of the configuration.
#[derive(Clone, Copy, Debug)]
pub struct ConfigField {
    /// Section of the TOML file.
    pub section: &'static str,
    /// Key in the section.
    pub key: &'static str,
    /// Allowed values.
    pub range: Range,
    /// What it means, for the comment beside it.
    pub about: &'static str,
    /// Reads it.
    pub get: fn(&Config) -> u32,
    /// Writes a value that lies in the range.
    pub set: fn(&mut Config, u32),
}

impl ConfigField {
    /// `section.key`.
    pub fn path(&self) -> String {
        format!("{}.{}", self.section, self.key)
    }
}

/// The field called `section.key`, or `key` alone, since no key occurs twice.
pub fn field(name: &str) -> Option<&'static ConfigField> {
    FIELDS
        .iter()
        .find(|field| field.key == name || field.path() == name)
}

const COUNT: Range = Range::Number(1, 1024);
const CYCLES: Range = Range::Number(0, 100_000);
const POSITIVE_CYCLES: Range = Range::Number(1, 100_000);
const BYTES: Range = Range::Number(1, 65_536);
const DEPTH: Range = Range::Number(1, 65_536);
const WIDTHS: Range = Range::OneOf(&[8, 16, 32, 64]);
const LANES: Range = Range::OneOf(&[1, 2, 4, 8, 16, 32, 64]);

const LAYOUTS: [LaneLayout; 4] = [
    LaneLayout::Run,
    LaneLayout::Aligned,
    LaneLayout::Quad,
    LaneLayout::Rows,
];
const OVERLAPS: [Overlap; 3] = [Overlap::Serial, Overlap::Pipelined, Overlap::Primitive];
const ASSIGNMENTS: [Assignment; 2] = [Assignment::Static, Assignment::Dynamic];
const TERMINATIONS: [Termination; 2] = [Termination::Discard, Termination::Skip];
const TILE_ORDERS: [TileWalk; 4] = [
    TileWalk::Raster,
    TileWalk::Serpentine,
    TileWalk::Morton,
    TileWalk::Hilbert,
];
const CACHES: Range = Range::OneOf(&[
    0, 16, 32, 64, 128, 256, 512, 1024, 2048, 4096, 8192, 16_384, 32_768, 65_536,
]);
const SORTERS: [Sorter; 3] = [Sorter::Passes, Sorter::Radix, Sorter::Merge];
const BINNINGS: [Binning; 2] = [Binning::Box, Binning::Exact];

/// The two channels, and all parts.
const PART_NAMES: [&str; PARTS.len() + 1] = {
    let mut names = ["channels"; PARTS.len() + 1];
    let mut index = 0;
    while index < PARTS.len() {
        names[index + 1] = PARTS[index].name;
        index += 1;
    }
    names
};

/// Index of a choice; every choice is in its list.
fn index<T: PartialEq>(list: &[T], value: &T) -> u32 {
    list.iter().position(|entry| entry == value).unwrap_or(0) as u32
}

/// All fields, in the order of the file.
#[rustfmt::skip]
pub const FIELDS: [ConfigField; 53] = [
    entry("tile", "tile_width", WIDTHS, "columns of a tile", |c| c.tile_width.into(), |c, v| c.tile_width = v as u16),
    entry("tile", "tile_height", Range::Number(1, 64), "rows of a tile", |c| c.tile_height.into(), |c, v| c.tile_height = v as u16),
    entry("memory", "splat_bytes", BYTES, "bytes of a splat in the scene", |c| c.splat_bytes, |c, v| c.splat_bytes = v),
    entry("memory", "packet_bytes", Range::Number(0, 65_536), "bytes of a footprint packet; 0: the design's", |c| c.packet_bytes, |c, v| c.packet_bytes = v),
    entry("memory", "list_bytes", BYTES, "bytes of a tile list's entry", |c| c.list_bytes, |c, v| c.list_bytes = v),
    entry("memory", "pixel_bytes", BYTES, "bytes of a pixel written back", |c| c.pixel_bytes, |c, v| c.pixel_bytes = v),
    entry("memory", "read_bandwidth", BYTES, "bytes read per cycle", |c| c.read_bandwidth, |c, v| c.read_bandwidth = v),
    entry("memory", "write_bandwidth", BYTES, "bytes written per cycle", |c| c.write_bandwidth, |c, v| c.write_bandwidth = v),
    entry("memory", "latency", CYCLES, "cycles from a request to its data", |c| c.latency, |c, v| c.latency = v),
    entry("memory", "memory_part", Range::Choice(&PART_NAMES), "channels: two of read_bandwidth and write_bandwidth; else a DRAM behind one port, which needs clock_mhz", |c| c.memory_part, |c, v| c.memory_part = v),
    entry("memory", "write_queue", DEPTH, "writes that the port to a part holds back", |c| c.write_queue, |c, v| c.write_queue = v),
    entry("memory", "harmonics_bytes", Range::Number(0, 65_536), "bytes of harmonics read for a splat that is seen", |c| c.harmonics_bytes, |c, v| c.harmonics_bytes = v),
    entry("memory", "sort_bytes", Range::Number(0, 65_536), "bytes of an entry while it is sorted; 0: list_bytes", |c| c.sort_bytes, |c, v| c.sort_bytes = v),
    entry("setup", "setup_units", COUNT, "units side by side", |c| c.setup_units, |c, v| c.setup_units = v),
    entry("setup", "setup_interval", POSITIVE_CYCLES, "cycles between two splats into a unit", |c| c.setup_interval, |c, v| c.setup_interval = v),
    entry("setup", "setup_latency", CYCLES, "cycles from splat to footprint", |c| c.setup_latency, |c, v| c.setup_latency = v),
    entry("setup", "setup_fifo", DEPTH, "splats waiting for setup", |c| c.setup_fifo, |c, v| c.setup_fifo = v),
    entry("binning", "bin_cycles", POSITIVE_CYCLES, "cycles per visible splat", |c| c.bin_cycles, |c, v| c.bin_cycles = v),
    entry("binning", "bin_tile_cycles", CYCLES, "cycles per tile examined", |c| c.bin_tile_cycles, |c, v| c.bin_tile_cycles = v),
    entry("binning", "bin_fifo", DEPTH, "footprints waiting for binning", |c| c.bin_fifo, |c, v| c.bin_fifo = v),
    entry("binning", "binning", Range::Choice(&["box", "exact"]), "tiles met by the box, or by the traversal", |c| index(&BINNINGS, &c.binning), |c, v| c.binning = BINNINGS[v as usize]),
    entry("sort", "sorter", Range::Choice(&["passes", "radix", "merge"]), "passes over list entries; or splats before they are binned, by digits or by merging runs", |c| index(&SORTERS, &c.sorter), |c, v| c.sorter = SORTERS[v as usize]),
    entry("sort", "sort_digit", Range::Number(1, 16), "radix: bits of a digit", |c| c.sort_digit, |c, v| c.sort_digit = v),
    entry("sort", "sort_run", Range::Number(1, 65_536), "merge: splats that the chip sorts at once", |c| c.sort_run, |c, v| c.sort_run = v),
    entry("sort", "sort_ways", Range::Number(2, 1024), "merge: runs merged at once", |c| c.sort_ways, |c, v| c.sort_ways = v),
    entry("sort", "sort_passes", Range::Number(0, 64), "passes: over all list entries", |c| c.sort_passes, |c, v| c.sort_passes = v),
    entry("sort", "sort_cycles", POSITIVE_CYCLES, "cycles per entry and pass", |c| c.sort_cycles, |c, v| c.sort_cycles = v),
    entry("sort", "sort_every", Range::Number(1, 1024), "pictures of a camera path from one full sort to the next; in between lists keep their order, and what came is sorted and merged in", |c| c.sort_every, |c, v| c.sort_every = v),
    entry("raster", "raster_units", COUNT, "raster units, sharing the bandwidth evenly", |c| c.raster_units, |c, v| c.raster_units = v),
    entry("raster", "assignment", Range::Choice(&["static", "dynamic"]), "who draws which tile", |c| index(&ASSIGNMENTS, &c.assignment), |c, v| c.assignment = ASSIGNMENTS[v as usize]),
    entry("raster", "overlap", Range::Choice(&["serial", "pipelined", "primitive"]), "do splat setup, row generator and lanes overlap? primitive: as in sim/rtl", |c| index(&OVERLAPS, &c.overlap), |c, v| c.overlap = OVERLAPS[v as usize]),
    entry("raster", "splat_cycles", CYCLES, "cycles per splat-tile pair", |c| c.splat_cycles, |c, v| c.splat_cycles = v),
    entry("raster", "row_cycles", CYCLES, "cycles per step of the row generator", |c| c.row_cycles, |c, v| c.row_cycles = v),
    entry("raster", "rows_at_once", Range::Number(1, 64), "rows per step of the row generator", |c| c.rows_at_once, |c, v| c.rows_at_once = v),
    entry("raster", "packet_fifo", DEPTH, "packets between fetch and splat setup (reads in flight)", |c| c.packet_fifo, |c, v| c.packet_fifo = v),
    entry("raster", "splat_fifo", DEPTH, "splats between splat setup and row generator", |c| c.splat_fifo, |c, v| c.splat_fifo = v),
    entry("raster", "row_fifo", DEPTH, "runs between row generator and lanes", |c| c.row_fifo, |c, v| c.row_fifo = v),
    entry("raster", "packet_cache", CACHES, "packets that a raster unit keeps, in four ways; 0: none", |c| c.packet_cache, |c, v| c.packet_cache = v),
    entry("raster", "tile_order", Range::Choice(&["raster", "serpentine", "morton", "hilbert"]), "order in which tiles are drawn", |c| index(&TILE_ORDERS, &c.tile_order), |c, v| c.tile_order = TILE_ORDERS[v as usize]),
    entry("lanes", "lanes", LANES, "pixel lanes per raster unit", |c| c.lanes, |c, v| c.lanes = v),
    entry("lanes", "layout", Range::Choice(&["run", "aligned", "quad", "rows"]), "how lanes lie on the screen", |c| index(&LAYOUTS, &c.layout), |c, v| c.layout = LAYOUTS[v as usize]),
    entry("lanes", "pixel_termination", Range::Choice(&["discard", "skip"]), "finished pixels", |c| index(&TERMINATIONS, &c.pixel_termination), |c, v| c.pixel_termination = TERMINATIONS[v as usize]),
    entry("lanes", "tile_termination", Range::Number(0, 65_536), "pairs between checks for a finished tile; 0: never", |c| c.tile_termination, |c, v| c.tile_termination = v),
    entry("lanes", "table_latency", CYCLES, "cycles from lane to footprint weight", |c| c.table_latency, |c, v| c.table_latency = v),
    entry("lanes", "table_ports", Range::Number(0, 64), "look-ups per cycle; 0: one per lane", |c| c.table_ports, |c, v| c.table_ports = v),
    entry("blend", "blend_latency", POSITIVE_CYCLES, "cycles from reading a pixel to its new value", |c| c.blend_latency, |c, v| c.blend_latency = v),
    entry("blend", "blend_interval", Range::Number(1, 64), "cycles between two groups of pixels", |c| c.blend_interval, |c, v| c.blend_interval = v),
    entry("buffer", "tile_buffers", Range::Number(1, 64), "tile buffers per raster unit", |c| c.tile_buffers, |c, v| c.tile_buffers = v),
    entry("buffer", "buffer_banks", Range::Number(0, 64), "pixels per cycle; 0: one per lane", |c| c.buffer_banks, |c, v| c.buffer_banks = v),
    entry("buffer", "write_back_cycles", CYCLES, "cycles to begin a write-back", |c| c.write_back_cycles, |c, v| c.write_back_cycles = v),
    entry("buffer", "clear_cycles", CYCLES, "cycles to clear a buffer before a tile; 0: during the write-back", |c| c.clear_cycles, |c, v| c.clear_cycles = v),
    entry("clock", "clock_mhz", Range::Number(0, 10_000), "clock in MHz; 0: that of the nearest circuit that was placed, marked as assumed", |c| c.clock_mhz, |c, v| c.clock_mhz = v),
    entry("clock", "overlap_frames", Range::Number(1, 3), "pictures in work at the same time; 2: geometry and sort beside raster, 3: each phase", |c| c.overlap_frames, |c, v| c.overlap_frames = v),
];

const fn entry(
    section: &'static str,
    key: &'static str,
    range: Range,
    about: &'static str,
    get: fn(&Config) -> u32,
    set: fn(&mut Config, u32),
) -> ConfigField {
    ConfigField {
        section,
        key,
        range,
        about,
        get,
        set,
    }
}
