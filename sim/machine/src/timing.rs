//! A whole picture on a machine: geometry phase, sort, raster phase, and what reports show of it.
//!
//! The phases follow each other, because the first tile can be drawn in depth order only when the last splat has been
//! binned. With pictures in sequence a machine may overlap one picture's geometry with another's raster phase; the
//! slower phase then sets the rate, which is why phases are reported one by one.

use super::accounts::{Account, Cause, Fifo, UnitTime};
use super::config::{Assignment, Config, Sorter};
use super::geometry::Geometry;
use super::lanes::{LaneShape, LaneWork};
use super::memory::{Access, Channels, Memory, MemoryFacts, Shared};
use super::observe::{Blind, Observer};
use super::order::SortStep;
use super::raster::{RasterUnit, TileDrawing, TileJob};
use super::tile_order::sequence;
use super::workload::{SurfaceCounts, Workload};
use serde::Serialize;
use std::collections::BTreeMap;

/// Cycles of a picture and everything counted on the way.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Timing {
    /// All cycles: the sum of the three phases.
    pub total: u64,
    /// Geometry phase: fetch, setup, binning.
    pub geometry: u64,
    /// Depth sort, and the filling of the lists where it comes after.
    pub sort: u64,
    /// Raster phase.
    pub raster: u64,
    /// Accounts of every kind of unit over the whole picture.
    pub units: BTreeMap<&'static str, UnitTime>,
    /// Depth and high-water mark of every FIFO, the fullest over all instances.
    pub fifos: BTreeMap<&'static str, FifoUse>,
    /// Work of the geometry phase.
    pub splats: SplatCounts,
    /// Bytes over the memory interface.
    pub bytes: Bytes,
    /// Work of the lanes.
    pub pixels: PixelWork,
    /// Work of the surface unit, if surfaces are drawn.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub surface: Option<SurfaceCounts>,
    /// What a memory part did, if the machine has one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub memory: Option<MemoryFacts>,
}

/// How deep a FIFO is and how full it was.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct FifoUse {
    /// Places.
    pub depth: u64,
    /// Most entries at once.
    pub high_water: u64,
}

/// Splats and what became of them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct SplatCounts {
    /// Splats of the scene.
    pub fetched: u64,
    /// Of these, splats whose box meets the screen.
    pub visible: u64,
    /// Tiles examined for them.
    pub tiles: u64,
    /// Entries of all tiles' lists.
    pub entries: u64,
    /// Entries that the passes of the sort moved.
    pub sorted: u64,
}

/// Bytes read and written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Bytes {
    /// Splats read by the geometry phase.
    pub splats_read: u64,
    /// Harmonics of splats that are seen.
    pub harmonics_read: u64,
    /// Packets and list entries written, and what is sorted where that are splats.
    pub packets_written: u64,
    /// List entries read and written by the sort.
    pub sort_moved: u64,
    /// Sorted splats read to fill the lists, where the sort comes before them.
    #[serde(skip_serializing_if = "is_zero")]
    pub sorted_read: u64,
    /// Packets and list entries read by the raster phase.
    pub packets_read: u64,
    /// Packets that the raster phase found in its caches instead.
    pub packets_cached: u64,
    /// Of those that were read, packets of tiles that had finished before they could be used.
    #[serde(rename = "packets_in_vain")]
    pub packets_discarded: u64,
    /// Pixels written back.
    pub pixels_written: u64,
}

impl Bytes {
    /// Bytes read and bytes written; a sort reads as much as it writes.
    pub fn directions(&self) -> [u64; 2] {
        let sorted = self.sort_moved / 2;
        [
            self.splats_read + self.harmonics_read + sorted + self.sorted_read + self.packets_read,
            self.packets_written + sorted + self.pixels_written,
        ]
    }

    /// All of them.
    pub fn all(&self) -> u64 {
        self.directions().iter().sum()
    }
}

/// Pixels, counted once per splat.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct PixelWork {
    /// Splat-tile pairs drawn.
    pub pairs: u64,
    /// Of these, pairs whose packet was in a cache.
    pub packet_hits: u64,
    /// Pairs left out because their tile had finished.
    pub pairs_left_out: u64,
    /// Rows of the drawn pairs.
    pub rows: u64,
    /// Of these, what the lanes took from their queues: rows, or pairs of rows, with work for them.
    pub runs: u64,
    /// Groups of lanes issued.
    pub groups: u64,
    /// Groups not issued although they lie between a band's first and last.
    pub groups_skipped: u64,
    /// Pixels that lanes visited.
    pub visited: u64,
    /// Of these, pixels inside the footprint.
    pub covered: u64,
    /// Of these, pixels that had not finished.
    pub live: u64,
    /// Lane slots: cycles in which lanes were busy times lanes.
    pub slots: u64,
    /// covered / (raster cycles x lanes x raster units).
    pub covered_per_cycle_and_lane: f64,
    /// live / (raster cycles x lanes x raster units).
    pub live_per_cycle_and_lane: f64,
}

impl PixelWork {
    /// Which part of the pairs found their packet in a cache.
    pub fn packet_hit_rate(&self) -> f64 {
        self.packet_hits as f64 / self.pairs.max(1) as f64
    }
}

/// Cycles of `workload` on a machine; `work` must have been made for the machine's [`LaneShape`].
pub fn simulate(workload: &Workload, work: &LaneWork, config: &Config) -> Timing {
    simulate_observed(workload, work, config, &mut Blind)
}

/// The same with an observer of the raster phase.
pub fn simulate_observed<O: Observer>(
    workload: &Workload,
    work: &LaneWork,
    config: &Config,
    observer: &mut O,
) -> Timing {
    match config.memory_part() {
        None => {
            let mut memory = Channels::new(config, workload);
            phases(workload, work, config, observer, &mut memory)
        }
        Some(part) => {
            let mut memory = Shared::new(part, config, workload, false);
            phases(workload, work, config, observer, &mut memory)
        }
    }
}

/// All accesses to a machine's memory part; none if it has none.
pub fn accesses(workload: &Workload, work: &LaneWork, config: &Config) -> Option<Vec<Access>> {
    let mut memory = Shared::new(config.memory_part()?, config, workload, true);
    phases(workload, work, config, &mut Blind, &mut memory);
    Some(memory.into_trace())
}

/// The three phases one after the other, and what came of them.
fn phases<O: Observer, M: Memory>(
    workload: &Workload,
    work: &LaneWork,
    config: &Config,
    observer: &mut O,
    memory: &mut M,
) -> Timing {
    let geometry = Geometry::run(workload, config, memory);
    let geometry_cycles = memory.end_of_phase(geometry.cycles());
    let mut sort = Account::default();
    let steps = match workload.surface {
        None => SortStep::all(config, workload, geometry.packets, geometry.entries),
        Some(_) => Vec::new(),
    };
    memory.sort(&mut sort, &steps);
    sort.wait(Cause::Port, memory.end_of_phase(sort.at()));
    let fill = filled(&geometry, config, memory);
    let sort_cycles = sort.at() + fill.as_ref().map_or(0, Account::at);
    let units = (0..config.raster_units).map(|number| RasterUnit::new(number, config));
    let mut raster = Raster {
        units: units.collect(),
        ..Raster::default()
    };
    let tiles = Tiles {
        work,
        config,
        order: sequence(config.tile_order, work.columns, work.tiles.len()),
    };
    if M::IN_TURN {
        raster.draw_in_turn(&tiles, observer, memory);
    } else {
        raster.draw(&tiles, observer, memory);
    }
    let finished = raster.units.iter().map(RasterUnit::finished_at);
    let raster_cycles = memory.end_of_phase(finished.max().unwrap_or(0));

    let moves = SortStep::moves(&steps);
    let total = geometry_cycles + sort_cycles + raster_cycles;
    let mut timing = Timing {
        total,
        geometry: geometry_cycles,
        sort: sort_cycles,
        raster: raster_cycles,
        memory: memory.facts(total),
        surface: workload.surface.as_ref().map(|work| work.counts),
        ..Timing::default()
    };
    timing.add_units(&geometry, &sort, fill.as_ref(), &raster);
    timing.add_fifos(&geometry, &raster, config);
    timing.add_pixels(&raster, config);
    timing.splats = SplatCounts {
        fetched: workload.splats.len() as u64,
        visible: geometry.visible,
        tiles: geometry.tiles,
        entries: geometry.entries,
        sorted: moves,
    };
    let packet_bytes = config.bytes_of_packet(workload.packet_bytes);
    let entry = u64::from(packet_bytes + config.list_bytes);
    let cached = timing.pixels.packet_hits * u64::from(packet_bytes);
    // What is sorted before the lists are filled is written once beside them.
    let sorted = match fill {
        None => 0,
        Some(_) => geometry.packets * u64::from(config.sorted_bytes()),
    };
    timing.bytes = Bytes {
        splats_read: workload.splats.len() as u64 * u64::from(config.splat_bytes),
        harmonics_read: geometry.visible * u64::from(config.harmonics_bytes),
        packets_written: geometry.packets * u64::from(packet_bytes)
            + geometry.entries * u64::from(config.list_bytes)
            + sorted,
        sort_moved: 2 * moves * u64::from(config.sorted_bytes()),
        sorted_read: sorted,
        packets_read: (raster.pixels.pairs + raster.discarded()) * entry - cached,
        packets_cached: cached,
        packets_discarded: raster.discarded() * entry,
        pixels_written: raster.pixels_written * u64::from(config.pixel_bytes),
    };
    timing
}

/// Sorted splats go into the lists of their tiles, as binning counted them; nothing where the lists were there before
/// they were sorted.
fn filled<M: Memory>(geometry: &Geometry, config: &Config, memory: &mut M) -> Option<Account> {
    if config.sorter == Sorter::Passes {
        return None;
    }
    let mut fill = Account::default();
    let tiles = geometry.entries * u64::from(config.bin_tile_cycles);
    let cycles = geometry.packets * u64::from(config.bin_cycles) + tiles;
    memory.fill(&mut fill, cycles, geometry.packets, geometry.entries);
    Some(fill)
}

fn is_zero(value: &u64) -> bool {
    *value == 0
}

/// All raster units, and what they have drawn.
#[derive(Default)]
struct Raster {
    units: Vec<RasterUnit>,
    pixels: PixelWork,
    pixels_written: u64,
}

impl Raster {
    /// Draws tile by tile: no unit needs to know what another one does meanwhile.
    fn draw<O: Observer, M: Memory>(&mut self, tiles: &Tiles, observer: &mut O, memory: &mut M) {
        for turn in 0..tiles.order.len() {
            let job = tiles.job(turn);
            self.count(&job);
            let unit = self.choose(turn, tiles.config.assignment);
            self.units[unit].draw(&job, observer, memory);
        }
        self.units.iter_mut().for_each(|unit| unit.settle(memory));
    }

    /// Draws pair by pair, always by the unit whose next request is the earliest: the port that they share sees
    /// requests in the order of time.
    fn draw_in_turn<O: Observer, M: Memory>(
        &mut self,
        tiles: &Tiles,
        observer: &mut O,
        memory: &mut M,
    ) {
        let count = self.units.len();
        let mut drawn: Vec<Option<(TileJob, TileDrawing)>> = (0..count).map(|_| None).collect();
        // The next tile of each unit, or of all of them where tiles are not assigned beforehand.
        let mut next: Vec<usize> = match tiles.config.assignment {
            Assignment::Static => (0..count).collect(),
            Assignment::Dynamic => vec![0],
        };
        let step = next.len();
        loop {
            let open =
                |unit: &usize| drawn[*unit].is_some() || next[*unit % step] < tiles.order.len();
            let earliest = (0..count).filter(open);
            let Some(unit) = earliest.min_by_key(|unit| self.units[*unit].next_request(memory))
            else {
                break;
            };
            let Some((job, drawing)) = &mut drawn[unit] else {
                let job = tiles.job(next[unit % step]);
                next[unit % step] += step;
                self.count(&job);
                if self.units[unit].is_background(&job) {
                    self.units[unit].write_background(&job, memory);
                    continue;
                }
                let begun = self.units[unit].begin(&job, memory);
                drawn[unit] = Some((job, begun));
                continue;
            };
            self.units[unit].draw_pair(job, drawing, observer, memory);
            if drawing.is_over(job) {
                self.units[unit].end(job, drawing, observer, memory);
                drawn[unit] = None;
            }
        }
        self.units.iter_mut().for_each(|unit| unit.settle(memory));
    }

    /// Which unit draws the next tile.
    fn choose(&self, tile: usize, assignment: Assignment) -> usize {
        match assignment {
            Assignment::Static => tile % self.units.len(),
            Assignment::Dynamic => {
                let ready = |unit: &usize| self.units[*unit].ready_at();
                (0..self.units.len()).min_by_key(ready).unwrap_or(0)
            }
        }
    }

    fn count(&mut self, job: &TileJob) {
        self.pixels_written += u64::from(job.pixels);
        let sums = &mut self.pixels;
        sums.pairs += job.pairs.len() as u64;
        sums.pairs_left_out += job.left_out.len() as u64;
        for pair in job.pairs {
            sums.rows += u64::from(pair.rows);
            sums.runs += u64::from(pair.runs);
            sums.groups += u64::from(pair.groups);
            sums.groups_skipped += u64::from(pair.skipped);
            sums.visited += u64::from(pair.visited);
            sums.covered += u64::from(pair.covered);
            sums.live += u64::from(pair.live);
        }
    }

    fn discarded(&self) -> u64 {
        let units = self.units.iter();
        units.map(|unit| unit.prefetched_discarded).sum()
    }
}

/// The tiles of a picture in the order in which they are drawn.
struct Tiles<'a> {
    work: &'a LaneWork,
    config: &'a Config,
    order: Vec<usize>,
}

impl<'a> Tiles<'a> {
    /// The work of the tile whose turn it is.
    fn job(&self, turn: usize) -> TileJob<'a> {
        let (work, number) = (self.work, self.order[turn]);
        let tile = &work.tiles[number];
        let numbers = work.pairs_in(number);
        let first_pair = numbers.start;
        let before = first_pair.checked_sub(1);
        let first_band = before.map_or(0, |before| work.pairs[before].bands_end as usize);
        let all = &work.pairs[numbers];
        let interval = self.config.tile_termination;
        let (pairs, left_out) = all.split_at(drawn(all.len(), tile.finished_after, interval));
        TileJob {
            tile: number as u32,
            pixels: tile.pixels,
            resolved: work.resolved.get(number).copied().unwrap_or(0),
            pairs,
            first_pair,
            first_band,
            left_out,
            bands: &work.bands,
        }
    }
}

/// How many of a tile's pairs are drawn: all up to the first check after the tile has finished.
fn drawn(pairs: usize, finished_after: u32, interval: u32) -> usize {
    if interval == 0 || finished_after == u32::MAX {
        return pairs;
    }
    (u64::from(finished_after.div_ceil(interval)) * u64::from(interval)).min(pairs as u64) as usize
}

impl Timing {
    fn add_units(
        &mut self,
        geometry: &Geometry,
        sort: &Account,
        fill: Option<&Account>,
        raster: &Raster,
    ) {
        let units = || raster.units.iter();
        let sequencers = units().flat_map(|unit| &unit.sequencers);
        let all: [(_, Vec<&Account>); 11] = [
            ("fetch", vec![&geometry.fetch]),
            ("setup", geometry.setup.iter().collect()),
            ("binning", vec![&geometry.binning]),
            ("packet_write", vec![&geometry.write]),
            ("sort", vec![sort]),
            ("list_fill", fill.into_iter().collect()),
            ("packet_fetch", units().map(|unit| &unit.fetch).collect()),
            ("splat_setup", units().map(|unit| &unit.splat).collect()),
            ("row_generator", units().map(|unit| &unit.rows).collect()),
            ("write_back", units().map(|unit| &unit.write_back).collect()),
            ("lanes", sequencers.map(|lanes| &lanes.account).collect()),
        ];
        for (name, accounts) in all {
            if !accounts.is_empty() {
                let time = UnitTime::close(accounts, self.total);
                self.units.insert(name, time);
            }
        }
    }

    fn add_fifos(&mut self, geometry: &Geometry, raster: &Raster, config: &Config) {
        let units = || raster.units.iter();
        let sequencers = units().flat_map(|unit| &unit.sequencers);
        let packets = units().map(|unit| &unit.packets).collect();
        let splats = units().map(|unit| &unit.splats).collect();
        let rows = sequencers.map(|lanes| &lanes.fifo).collect();
        let all: [(_, _, Vec<&Fifo>); 5] = [
            ("setup", config.setup_fifo, vec![&geometry.splats]),
            ("bin", config.bin_fifo, vec![&geometry.footprints]),
            ("packet", config.packet_fifo, packets),
            ("splat", config.splat_fifo, splats),
            ("row", config.row_fifo, rows),
        ];
        for (name, depth, fifos) in all {
            let high_water = fifos.iter().map(|fifo| fifo.high_water()).max();
            let used = FifoUse {
                depth: depth.into(),
                high_water: high_water.unwrap_or(0),
            };
            self.fifos.insert(name, used);
        }
    }

    fn add_pixels(&mut self, raster: &Raster, config: &Config) {
        let lanes = u64::from(config.lanes) * u64::from(config.raster_units);
        // A phase without cycles has no pixels.
        let per_lane = |pixels: u64| pixels as f64 / (self.raster * lanes).max(1) as f64;
        let unit = raster.units.first();
        let sequencers = unit.map_or(1, |unit| unit.sequencers.len() as u64);
        let busy = self.units.get("lanes").map_or(0, |unit| unit.busy);
        self.pixels = PixelWork {
            packet_hits: raster.units.iter().map(|unit| unit.cache.hits).sum(),
            slots: busy * u64::from(config.lanes) / sequencers,
            covered_per_cycle_and_lane: per_lane(raster.pixels.covered),
            live_per_cycle_and_lane: per_lane(raster.pixels.live),
            ..raster.pixels
        };
    }
}

/// The lane work for a configuration and the simulation in one call.
pub fn simulate_alone(workload: &Workload, config: &Config) -> Timing {
    let work = LaneWork::new(workload, LaneShape::from(config));
    simulate(workload, &work, config)
}
