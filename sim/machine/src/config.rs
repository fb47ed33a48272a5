//! The machine's configuration: defaults, the table of fields with their ranges, and the commented TOML form.
//!
//! Every field is one line of [`FIELDS`]. Parsing, range checks, the resolved file beside the results and the sweep of
//! any field by its name all follow from that table.

mod fields;
mod parse;
mod sorter;

use super::memory::parts::{DramPart, PARTS};
use super::primitive;

pub use fields::{ConfigField, FIELDS, Range, field};
pub use parse::{ConfigError, from_file, from_toml, known, line_of, to_toml};

/// How the lanes lie on the screen; see `docs/hardware-model.md`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
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
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Overlap {
    /// Splat setup, row generator and lanes take turns: one unit.
    Serial,
    /// They work at the same time, with FIFOs between them.
    Pipelined,
    /// They are the circuit of `sim/rtl`, cycle by cycle: pipelines that never stand still, and queues with counted places behind them.
    Primitive,
}

/// Who draws which tile.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Assignment {
    /// Tile i goes to unit i mod N.
    Static,
    /// The next tile goes to the unit that first has nothing left to fetch.
    Dynamic,
}

/// What happens to pixels that have finished.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Termination {
    /// They are visited; the blend is suppressed.
    Discard,
    /// Groups of finished pixels are not visited.
    Skip,
}

/// Which tiles a footprint is listed in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Binning {
    /// Those that its bounding box meets.
    Box,
    /// Those in which its traversal visits a pixel.
    Exact,
}

/// How splats are brought into the order of their depths.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Sorter {
    /// So many passes over the entries of all lists, whatever they do.
    Passes,
    /// Visible splats before they are binned, digit by digit of their keys, as `depth_sort.sv` does.
    Radix,
    /// The same by a network: sorted runs from the chip, then merges of many runs at a time.
    Merge,
}

/// The order in which tiles are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
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

/// A machine. Times are in clock cycles, sizes in bytes where the name says so and in entries otherwise.
///
/// As data it is the table of its file, so that a report's machine reads like one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(into = "toml::Table", try_from = "toml::Table")]
pub struct Config {
    /// Tile columns: 8, 16, 32 or 64.
    pub tile_width: u16,
    /// Tile rows, 1 to 64.
    pub tile_height: u16,
    /// Bytes of one splat in the scene memory.
    pub splat_bytes: u32,
    /// Bytes of a footprint packet; 0 takes the design's own packet.
    pub packet_bytes: u32,
    /// Bytes of one entry of a tile's list.
    pub list_bytes: u32,
    /// Bytes of one pixel in the frame memory.
    pub pixel_bytes: u32,
    /// Bytes read per cycle, shared by all units of a phase.
    pub read_bandwidth: u32,
    /// Bytes written per cycle, shared by all units of a phase.
    pub write_bandwidth: u32,
    /// Cycles from a read request to its first byte.
    pub latency: u32,
    /// Setup units.
    pub setup_units: u32,
    /// Cycles between two splats into one setup unit.
    pub setup_interval: u32,
    /// Cycles from a splat to its footprint.
    pub setup_latency: u32,
    /// Splats between fetch and setup.
    pub setup_fifo: u32,
    /// Tile binning: cycles per visible splat.
    pub bin_cycles: u32,
    /// Tile binning: cycles per tile examined.
    pub bin_tile_cycles: u32,
    /// Footprints between setup and binning.
    pub bin_fifo: u32,
    /// Which tiles a footprint is listed in.
    pub binning: Binning,
    /// Depth sort: what sorts.
    pub sorter: Sorter,
    /// Radix: bits of a digit.
    pub sort_digit: u32,
    /// Merge: splats that the chip sorts at once.
    pub sort_run: u32,
    /// Merge: runs merged at once.
    pub sort_ways: u32,
    /// Depth sort: passes over all list entries.
    pub sort_passes: u32,
    /// Depth sort: cycles per entry and pass.
    pub sort_cycles: u32,
    /// Pictures of a camera path from one full sort to the next; in between tile lists keep their order.
    pub sort_every: u32,
    /// Raster units.
    pub raster_units: u32,
    /// Who draws which tile.
    pub assignment: Assignment,
    /// Whether the stages of a raster unit overlap.
    pub overlap: Overlap,
    /// Cycles per splat-tile pair in splat setup.
    pub splat_cycles: u32,
    /// Cycles per step of the row generator.
    pub row_cycles: u32,
    /// Rows that a step of the row generator makes.
    pub rows_at_once: u32,
    /// Packets between fetch and splat setup; bounds the reads in flight.
    pub packet_fifo: u32,
    /// Splats between splat setup and row generator.
    pub splat_fifo: u32,
    /// Runs between row generator and lanes (per lane with the layout `rows`).
    pub row_fifo: u32,
    /// Pixel lanes per raster unit, a power of two.
    pub lanes: u32,
    /// How the lanes lie on the screen.
    pub layout: LaneLayout,
    /// What happens to pixels that have finished.
    pub pixel_termination: Termination,
    /// Pairs between two checks whether the tile has finished; 0 for never.
    pub tile_termination: u32,
    /// Cycles from a lane to its footprint weight.
    pub table_latency: u32,
    /// Look-ups per cycle; 0 for one per lane.
    pub table_ports: u32,
    /// Cycles from reading a pixel to its new value being readable.
    pub blend_latency: u32,
    /// Cycles between two groups into the blend.
    pub blend_interval: u32,
    /// Tile buffers per raster unit: with two, one is written back while the other is drawn into.
    pub tile_buffers: u32,
    /// Pixels that a tile buffer reads and writes per cycle; 0 for one per lane.
    pub buffer_banks: u32,
    /// Cycles to begin a tile's write-back.
    pub write_back_cycles: u32,
    /// Cycles to clear a tile buffer before it is drawn into; 0 where that happens during the write-back.
    pub clear_cycles: u32,
    /// Packets that a raster unit keeps, so that a splat over several tiles is read less often; 0: none.
    pub packet_cache: u32,
    /// The order in which tiles are drawn.
    pub tile_order: TileWalk,
    /// Clock in megahertz; 0 takes that of the nearest circuit that was placed, except for a memory part, which needs one.
    pub clock_mhz: u32,
    /// Pictures in work at the same time: with two, one is set up and sorted while another is drawn; with three, each phase has one.
    pub overlap_frames: u32,
    /// What the memory is: 0 for two channels of a fixed bandwidth, else a part behind one port, counted from 1 in [`PARTS`].
    pub memory_part: u32,
    /// Writes that the port to a part holds back.
    pub write_queue: u32,
    /// Bytes of harmonics read for a splat that is seen.
    pub harmonics_bytes: u32,
    /// Bytes of an entry while it is sorted; 0 for those of a list.
    pub sort_bytes: u32,
}

impl Default for Config {
    fn default() -> Self {
        Config {
            tile_width: 16,
            tile_height: 16,
            splat_bytes: 32,
            packet_bytes: 0,
            list_bytes: 4,
            pixel_bytes: 4,
            read_bandwidth: 64,
            write_bandwidth: 32,
            latency: 60,
            setup_units: 1,
            setup_interval: 1,
            setup_latency: 40,
            setup_fifo: 64,
            bin_cycles: 1,
            bin_tile_cycles: 1,
            bin_fifo: 8,
            binning: Binning::Box,
            sorter: Sorter::Passes,
            sort_digit: 8,
            sort_run: 1024,
            sort_ways: 16,
            sort_passes: 1,
            sort_cycles: 1,
            sort_every: 1,
            raster_units: 1,
            assignment: Assignment::Dynamic,
            overlap: Overlap::Pipelined,
            splat_cycles: 1,
            row_cycles: 1,
            rows_at_once: 2,
            packet_fifo: 64,
            splat_fifo: 2,
            row_fifo: 16,
            lanes: 1,
            layout: LaneLayout::Run,
            pixel_termination: Termination::Discard,
            tile_termination: 1,
            table_latency: 3,
            table_ports: 0,
            blend_latency: 4,
            blend_interval: 1,
            tile_buffers: 2,
            buffer_banks: 0,
            write_back_cycles: 4,
            clear_cycles: 0,
            packet_cache: 0,
            tile_order: TileWalk::Raster,
            clock_mhz: 0,
            overlap_frames: 1,
            memory_part: 0,
            write_queue: 32,
            harmonics_bytes: 0,
            sort_bytes: 0,
        }
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
            splat_cycles: primitive::SETUP_INTERVAL,
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

    /// The whole machine of `sim/rtl` (`splat_machine.sv`) with so many lanes: words of 16 bytes in either direction, splats sorted before they
    /// are binned. Setup takes a splat in 20 cycles, which is nine cores of lean18: the most that fit an LFE5U-85F beside four lanes.
    pub fn machine(lanes: u32) -> Config {
        Config {
            splat_bytes: 80,
            read_bandwidth: 16,
            write_bandwidth: 16,
            setup_interval: 20,
            setup_latency: 1533,
            sorter: Sorter::Radix,
            sort_bytes: 16,
            ..Config::primitive(lanes)
        }
    }

    /// A machine by its name: `primitive-1` to `primitive-16`, and `machine-1` to `machine-16` with what stands before it.
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

    /// Bytes that the memory could move in a cycle of so many megahertz: both channels together, or the part at its peak.
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

    /// Cycles per group of lanes, stretched where ports or banks are fewer than lanes.
    pub fn stretch(&self) -> u32 {
        let shared = |ports: u32| {
            if ports == 0 {
                1
            } else {
                self.lanes.div_ceil(ports)
            }
        };
        self.blend_interval
            .max(shared(self.table_ports))
            .max(shared(self.buffer_banks))
    }

    /// Bytes of the queues that simulating it takes: a time per place, in rings of a power of two, and the primitive's own per lane.
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

    /// Columns that the lanes advance per group.
    pub fn stride(&self) -> u32 {
        match self.layout {
            LaneLayout::Run | LaneLayout::Aligned => self.lanes,
            LaneLayout::Quad => (self.lanes / 2).max(1),
            LaneLayout::Rows => 1,
        }
    }
}
