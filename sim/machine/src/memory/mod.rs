//! The memory that a machine reads splats and packets from and writes packets, lists and pixels to.
//!
//! Two kinds. `Channels` are a read and a write channel of a fixed bandwidth, shared evenly: a sentence instead of a
//! part, fast, and enough to compare machines. `Shared` is a real part behind one port, with bursts, banks, rows,
//! refresh and a bus that has to turn ([`dram`], [`port`]). The units are the same with both: they ask this trait for
//! data and are told when.
//!
//! ```text
//! scene | harmonics | packets, by splat | list entries, twice for the sort | frame, tile by tile
//! ```

pub mod dram;
pub mod parts;
pub mod port;
mod shared;

pub use port::Access;
pub(super) use shared::Shared;

use super::accounts::{Account, Cause};
use super::config::{Config, Sorter};
use super::lanes::PairWork;
use super::order::SortStep;
use super::workload::Workload;
use dram::DramCounts;
use port::WriteId;
use serde::Serialize;

/// A read: when it was asked for, and when its data have arrived.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Read {
    pub requested: u64,
    pub arrives: u64,
}

/// What a raster unit fetches for a pair.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wanted {
    pub unit: u32,
    /// When its queue has a place.
    pub free: u64,
    pub pair: u64,
    /// Whose packet; nobody's where the unit's cache holds it.
    pub splat: Option<u32>,
}

/// A tile buffer that is being written back: free in a cycle, or when a write of the port is over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum TileBuffer {
    Free(u64),
    Written {
        id: WriteId,
        blended: u64,
        least: u64,
    },
}

/// A tile to be written back.
pub(super) struct TileWrite {
    pub tile: u32,
    pub pixels: u32,
    /// When its last pixel has been blended.
    pub blended: u64,
    /// Cycles that it takes to begin, and to read it out at least.
    pub begin: u64,
    pub least: u64,
    /// Cycles to clear the buffer afterwards.
    pub clear: u64,
}

/// What units ask of a memory. Accounts move to the end of what was asked.
pub(super) trait Memory {
    /// Must requests come in the order of time, because the units share a port?
    const IN_TURN: bool;
    /// A splat for setup, with its harmonics if it is seen; `free` is when its queue has a place.
    fn splat(&mut self, fetch: &mut Account, free: u64, number: u64, seen: bool) -> Read;
    /// A footprint's packet and so many list entries; binning waits until they are taken.
    fn store(&mut self, binning: &mut Account, write: &mut Account, splat: u64, entries: u64);
    /// All steps of the sort, beside its own cycles.
    fn sort(&mut self, sort: &mut Account, steps: &[SortStep]);
    /// Sorted splats are read and list entries written, beside the cycles that the tiles take.
    fn fill(&mut self, fill: &mut Account, cycles: u64, splats: u64, entries: u64);
    /// A pair's list entry and its splat's packet.
    fn packet(&mut self, fetch: &mut Account, wanted: Wanted) -> Read;
    /// The first cycle in which a raster unit could ask for its next packet.
    fn next_request(&self, unit: u32, fetch: &Account, free: u64) -> u64;
    /// Packets that were on their way when their tile had finished.
    fn discarded(&mut self, unit: u32, fetch: &mut Account, first: u64, pairs: &[PairWork]);
    /// A tile's pixels; gives when writing them begins, and the buffer that becomes free.
    fn tile(&mut self, write_back: &mut Account, tile: &TileWrite) -> (u64, TileBuffer);
    /// The background of a tile without splats, for which nobody waits; gives the cycles for which it keeps the unit's
    /// write channel, which it takes when nobody else wants it. A port finds the time by itself.
    fn background(&mut self, write_back: &Account, tile: u32, pixels: u32) -> u64;
    /// When a buffer is free.
    fn buffer(&mut self, write_back: &mut Account, buffer: TileBuffer) -> u64;
    /// Ends a phase in which the units took so many cycles; gives the cycle in which the memory is idle, too. The next
    /// phase starts from 0 again.
    fn end_of_phase(&mut self, cycles: u64) -> u64;
    /// What a part did in a picture of so many cycles, if there is one.
    fn facts(&self, cycles: u64) -> Option<MemoryFacts>;
}

/// What a memory part did for a picture.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MemoryFacts {
    /// The part.
    pub part: &'static str,
    /// Its data sheet.
    pub source: &'static str,
    /// Bursts, rows, refreshes.
    pub counts: DramCounts,
    /// Bytes in whole bursts, whether they were wanted or not.
    pub bytes_moved: u64,
    /// What its bus could move in the picture's cycles.
    pub bytes_at_peak: u64,
}

/// A read and a write channel of a fixed bandwidth.
pub(super) struct Channels {
    config: Config,
    splat: u64,
    harmonics: u64,
    packet: u64,
    /// A list entry alone.
    entry: u64,
    /// A packet alone, and lists in whole words: where lists were filled in order, so that their entries follow each
    /// other in memory.
    packet_alone: u64,
    lists: Option<ListWords>,
    packet_bytes: u64,
    /// What geometry writes beside a packet: of each list entry, or of the splat.
    stored: [u64; 2],
    latency: u64,
    read_bandwidth: u64,
    write_bandwidth: u64,
    /// Bytes of a pixel times units, which share the bandwidth evenly.
    pixel_bytes: u64,
}

/// Reads of lists without gaps: what a cycle brings beyond an entry belongs to the next ones.
#[derive(Clone, Copy, Debug)]
struct ListWords {
    /// Bytes of a cycle, and of an entry.
    word: u64,
    entry: u64,
    /// Bytes that were read and not yet wanted.
    left: u64,
}

impl ListWords {
    /// Cycles that the next entry keeps the channel.
    #[inline(always)]
    fn read(&mut self) -> u64 {
        let cycles = self.entry.saturating_sub(self.left).div_ceil(self.word);
        self.left = self.left + cycles * self.word - self.entry;
        cycles
    }
}

impl Channels {
    pub fn new(config: &Config, workload: &Workload) -> Channels {
        let packet_bytes = config.bytes_of_packet(workload.packet_bytes);
        let units = u64::from(config.raster_units);
        let read_bandwidth = u64::from(config.read_bandwidth);
        let reading = |bytes: u64| bytes.div_ceil(read_bandwidth);
        let in_order = config.sorter != Sorter::Passes;
        Channels {
            config: *config,
            splat: reading(config.splat_bytes.into()),
            harmonics: reading(config.harmonics_bytes.into()),
            packet: reading(u64::from(packet_bytes + config.list_bytes) * units),
            entry: reading(u64::from(config.list_bytes) * units),
            packet_alone: reading(u64::from(packet_bytes) * units),
            lists: in_order.then_some(ListWords {
                word: read_bandwidth,
                entry: u64::from(config.list_bytes) * units,
                left: 0,
            }),
            packet_bytes: packet_bytes.into(),
            stored: if in_order {
                [0, config.sorted_bytes().into()]
            } else {
                [config.list_bytes.into(), 0]
            },
            latency: config.latency.into(),
            read_bandwidth,
            write_bandwidth: config.write_bandwidth.into(),
            pixel_bytes: u64::from(config.pixel_bytes) * units,
        }
    }
}

impl Memory for Channels {
    const IN_TURN: bool = false;

    #[inline(always)]
    fn splat(&mut self, fetch: &mut Account, free: u64, _: u64, seen: bool) -> Read {
        let requested = free.max(fetch.at());
        fetch.wait(Cause::FifoFull, requested);
        fetch.work(self.splat + if seen { self.harmonics } else { 0 });
        Read {
            requested,
            arrives: fetch.at() + self.latency,
        }
    }

    #[inline(always)]
    fn store(&mut self, binning: &mut Account, write: &mut Account, _: u64, entries: u64) {
        let bytes = match entries {
            0 => 0,
            _ => self.packet_bytes + self.stored[0] * entries + self.stored[1],
        };
        binning.wait(Cause::WriteChannel, write.at());
        write.wait(Cause::Upstream, binning.at());
        write.work(bytes.div_ceil(self.write_bandwidth));
    }

    /// Reading and writing go on beside the comparisons, each in its channel; sums of counts do not, since they say
    /// where everything goes.
    fn sort(&mut self, sort: &mut Account, steps: &[SortStep]) {
        let sorted = u64::from(self.config.sorted_bytes());
        for step in steps {
            let moves = sort.at() + step.passes * step.begins;
            sort.work(step.work(self.config.sort_cycles.into()));
            let bytes = step.passes * step.entries * sorted;
            sort.wait(Cause::Memory, moves + bytes.div_ceil(self.read_bandwidth));
            sort.wait(
                Cause::WriteChannel,
                moves + bytes.div_ceil(self.write_bandwidth),
            );
            sort.wait(Cause::Memory, sort.at() + step.passes * step.waits);
        }
    }

    fn fill(&mut self, fill: &mut Account, cycles: u64, splats: u64, entries: u64) {
        fill.work(cycles);
        let read = splats * u64::from(self.config.sorted_bytes());
        let written = entries * u64::from(self.config.list_bytes);
        fill.wait(Cause::Memory, read.div_ceil(self.read_bandwidth));
        fill.wait(Cause::WriteChannel, written.div_ceil(self.write_bandwidth));
        if entries > 0 {
            fill.wait(Cause::Memory, fill.at() + 2 * self.latency);
        }
    }

    #[inline(always)]
    fn packet(&mut self, fetch: &mut Account, wanted: Wanted) -> Read {
        let requested = wanted.free.max(fetch.at());
        fetch.wait(Cause::FifoFull, requested);
        let cycles = match (&mut self.lists, wanted.splat) {
            (Some(lists), splat) => lists.read() + splat.map_or(0, |_| self.packet_alone),
            (None, Some(_)) => self.packet,
            (None, None) => self.entry,
        };
        fetch.work(cycles);
        Read {
            requested,
            arrives: fetch.at() + self.latency,
        }
    }

    #[inline(always)]
    fn next_request(&self, _: u32, fetch: &Account, free: u64) -> u64 {
        free.max(fetch.at())
    }

    #[inline(always)]
    fn discarded(&mut self, _: u32, fetch: &mut Account, _: u64, pairs: &[PairWork]) {
        fetch.work(pairs.len() as u64 * self.packet);
    }

    fn tile(&mut self, write_back: &mut Account, tile: &TileWrite) -> (u64, TileBuffer) {
        write_back.wait(Cause::Lanes, tile.blended);
        let start = write_back.at();
        let bytes = u64::from(tile.pixels) * self.pixel_bytes;
        let transfer = bytes.div_ceil(self.write_bandwidth).max(tile.least);
        write_back.work(tile.begin + transfer);
        (start, TileBuffer::Free(write_back.at() + tile.clear))
    }

    fn background(&mut self, _: &Account, _: u32, pixels: u32) -> u64 {
        let bytes = u64::from(pixels) * self.pixel_bytes;
        bytes.div_ceil(self.write_bandwidth)
    }

    #[inline(always)]
    fn buffer(&mut self, _: &mut Account, buffer: TileBuffer) -> u64 {
        match buffer {
            TileBuffer::Free(at) => at,
            // No buffer of these channels waits for a port.
            TileBuffer::Written { blended, .. } => blended,
        }
    }

    fn end_of_phase(&mut self, cycles: u64) -> u64 {
        cycles
    }

    fn facts(&self, _: u64) -> Option<MemoryFacts> {
        None
    }
}

#[cfg(test)]
mod tests;
