//! The geometry phase: splats are fetched, set up, binned into tiles and written as packets and list entries.
//!
//! ```text
//! memory -> [setup_fifo] -> setup units -> [bin_fifo] -> harmonics -> binning -> write channel
//! ```
//!
//! Splats keep their order. The setup units take them in turn, each accepts one every `setup_interval` cycles and works
//! in a pipeline of `setup_latency`; a full FIFO behind holds the splat in its unit. Colours of harmonics, if there are
//! any, are made splat after splat of those that are seen. A culled splat takes as long as another until it is known to
//! be culled, so that the phase does not end before the last one has come out, seen or not.

use super::accounts::{Account, Cause, Fifo};
use super::config::{Binning, Config};
use super::memory::Memory;
use super::workload::Workload;

/// The units of the phase after all splats have passed.
#[derive(Clone, Debug)]
pub(super) struct Geometry {
    pub fetch: Account,
    pub setup: Vec<Account>,
    pub binning: Account,
    pub write: Account,
    pub splats: Fifo,
    pub footprints: Fifo,
    /// When all splats so far have left setup.
    left: u64,
    /// When all that were seen so far have colours of their harmonics.
    coloured: u64,
    /// Splats that were handed on, and tiles that were examined for them.
    pub visible: u64,
    pub tiles: u64,
    /// List entries written.
    pub entries: u64,
    /// Packets written: one for every footprint with an entry.
    pub packets: u64,
}

impl Geometry {
    /// Passes all splats of `workload` through the phase.
    pub fn run<M: Memory>(workload: &Workload, config: &Config, memory: &mut M) -> Geometry {
        let mut geometry = Geometry {
            fetch: Account::default(),
            setup: vec![Account::default(); config.setup_units as usize],
            binning: Account::default(),
            write: Account::default(),
            splats: Fifo::new(config.setup_fifo),
            footprints: Fifo::new(config.bin_fifo),
            left: 0,
            coloured: 0,
            visible: 0,
            tiles: 0,
            entries: 0,
            packets: 0,
        };
        let mut last_start = 0;
        for (number, splat) in workload.splats.iter().enumerate() {
            let unit = number % geometry.setup.len();
            let free = geometry.splats.free_at();
            let read = memory.splat(&mut geometry.fetch, free, number as u64, splat.tiles > 0);
            let setup = &mut geometry.setup[unit];
            setup.wait(Cause::Memory, read.arrives);
            setup.wait(Cause::Upstream, last_start);
            last_start = setup.at();
            geometry.splats.pass(read.requested, last_start);
            setup.work(config.setup_interval.into());
            let ready = (last_start + u64::from(config.setup_latency)).max(setup.at());
            geometry.left = geometry.left.max(ready);
            if splat.tiles == 0 {
                continue;
            }
            let handed_on = ready.max(geometry.footprints.free_at());
            // The unit's pipeline stands still for as long as its result does.
            let until = setup.at() + (handed_on - ready);
            setup.wait(Cause::FifoFull, until);
            let entries = match config.binning {
                Binning::Box => splat.tiles,
                Binning::Exact => splat.visited_tiles,
            };
            geometry.bin(config, handed_on, splat.tiles);
            geometry.store(memory, number as u64, entries.into());
        }
        geometry
    }

    fn bin(&mut self, config: &Config, handed_on: u64, tiles: u32) {
        let mut upstream = handed_on;
        if config.harmonics_cycles > 0 {
            // They are asked for when it is known that the splat is seen, and while others' are in use.
            let read = handed_on + u64::from(config.latency);
            upstream = self.coloured.max(read) + u64::from(config.harmonics_cycles);
            self.coloured = upstream;
        }
        self.binning.wait(Cause::Upstream, upstream);
        self.footprints.pass(handed_on, self.binning.at());
        let of_tiles = u64::from(config.bin_tile_cycles) * u64::from(tiles);
        self.binning.work(u64::from(config.bin_cycles) + of_tiles);
        self.visible += 1;
        self.tiles += u64::from(tiles);
    }

    fn store<M: Memory>(&mut self, memory: &mut M, splat: u64, entries: u64) {
        memory.store(&mut self.binning, &mut self.write, splat, entries);
        self.packets += u64::from(entries > 0);
        self.entries += entries;
    }

    /// Cycles of the phase.
    pub fn cycles(&self) -> u64 {
        let others = [&self.fetch, &self.binning, &self.write];
        let units = self.setup.iter().chain(others).map(Account::at);
        units.fold(self.left, u64::max)
    }
}
