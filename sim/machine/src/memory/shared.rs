//! A memory part behind one port, as the units of a machine see it: where everything lies, and whose request is whose.

use super::parts::DramPart;
use super::port::{Access, Port, Stream};
use super::{Memory, MemoryFacts, Read, TileBuffer, TileWrite, Wanted};
use crate::accounts::{Account, Cause};
use crate::config::Config;
use crate::lanes::PairWork;
use crate::order::SortStep;
use crate::workload::Workload;

/// Regions begin at whole megabytes, so that none shares a row with another.
const MEGABYTE: u64 = 1 << 20;

/// Where everything lies, and how large it is there.
#[derive(Clone, Copy, Debug)]
struct Map {
    splat: [u64; 2],
    harmonics: [u64; 2],
    packet: [u64; 2],
    entry: [u64; 2],
    sorted: [u64; 2],
    tile: [u64; 2],
}

impl Map {
    /// Addresses for a picture's splats and list entries.
    fn new(config: &Config, workload: &Workload) -> Map {
        let packet_bytes = config.bytes_of_packet(workload.packet_bytes);
        let splats = workload.splats.len() as u64;
        let tiles = workload.splats.iter().map(|splat| u64::from(splat.tiles));
        let left = workload.order_changes.map_or(0, |changes| changes.left);
        let entries = tiles.sum::<u64>() + left;
        let mut next = 0;
        let mut region = |bytes: u64, count: u64| {
            let start = next;
            next = (next + bytes * count).next_multiple_of(MEGABYTE);
            [start, bytes]
        };
        let sorted = config.sorted_bytes().max(config.list_bytes).into();
        Map {
            splat: region(config.splat_bytes.into(), splats),
            harmonics: region(config.harmonics_bytes.into(), splats),
            packet: region(packet_bytes.into(), splats),
            entry: region(sorted, entries),
            sorted: region(sorted, entries),
            tile: region(config.tile_pixels() * u64::from(config.pixel_bytes), 1),
        }
    }

    fn of([start, bytes]: [u64; 2], number: u64) -> u64 {
        start + bytes * number
    }
}

/// One raster unit's reads.
#[derive(Clone, Copy, Debug, Default)]
struct SharedReader {
    /// One past the cycle in which it asked last.
    next: u64,
    list: Stream,
}

/// The part and all that wait for it.
pub struct Shared {
    part: &'static DramPart,
    port: Port,
    config: Config,
    map: Map,
    /// Next cycle in which geometry may ask, and its streams.
    geometry: u64,
    splats: Stream,
    packets: Stream,
    lists: Stream,
    entries: u64,
    readers: Vec<SharedReader>,
}

impl Shared {
    /// A part for a machine and a picture.
    pub fn new(
        part: &'static DramPart,
        config: &Config,
        workload: &Workload,
        traced: bool,
    ) -> Shared {
        let mut port = Port::new(part, config.clock_mhz, config.write_queue);
        port.trace = traced.then(Vec::new);
        Shared {
            part,
            port,
            config: *config,
            map: Map::new(config, workload),
            geometry: 0,
            splats: Stream::default(),
            packets: Stream::default(),
            lists: Stream::default(),
            entries: 0,
            readers: vec![SharedReader::default(); config.raster_units as usize],
        }
    }

    /// All accesses in the order in which they were served, in cycles of the picture.
    pub fn into_trace(self) -> Vec<Access> {
        self.port.trace.unwrap_or_default()
    }

    /// The units of the sort take what comes in no time; their own time goes on beside it.
    fn sort_step(&mut self, step: &SortStep) {
        let size = self.part.burst_bytes();
        let bursts = (step.entries * u64::from(self.config.sorted_bytes())).div_ceil(size);
        let place = bursts.div_ceil(step.places) * size;
        for pass in 0..step.passes {
            let [from, to] = match pass % 2 {
                0 => [self.map.entry[0], self.map.sorted[0]],
                _ => [self.map.sorted[0], self.map.entry[0]],
            };
            for burst in 0..bursts {
                let read = self.port.read(0, from + burst * size, size);
                let address = to + burst % step.places * place + burst / step.places * size;
                self.port.write(read.end, address, size);
            }
        }
    }

    /// Controller and wires, on top of the part's own latency.
    fn arrival(&self, end: u64) -> u64 {
        end + u64::from(self.config.latency)
    }
}

impl Memory for Shared {
    const IN_TURN: bool = true;

    fn splat(&mut self, fetch: &mut Account, free: u64, number: u64, seen: bool) -> Read {
        let requested = free.max(self.geometry);
        self.geometry = requested + 1;
        fetch.wait(Cause::FifoFull, requested);
        let [start, bytes] = [Map::of(self.map.splat, number), self.map.splat[1]];
        let mut end = requested;
        let mut note = |served: Option<super::port::Served>| {
            let Some(served) = served else { return };
            fetch.wait(Cause::Port, served.start);
            fetch.work(served.end.saturating_sub(fetch.at()));
            end = served.end;
        };
        note(self.port.read_on(&mut self.splats, requested, start, bytes));
        if seen && self.config.harmonics_bytes > 0 {
            let [address, bytes] = [Map::of(self.map.harmonics, number), self.map.harmonics[1]];
            note(Some(self.port.read(requested, address, bytes)));
        }
        let arrives = self.arrival(end.max(fetch.at()));
        Read { requested, arrives }
    }

    /// Packets and entries come in the order of the splats; the queue of writes holds them until the port has time.
    fn store(&mut self, binning: &mut Account, write: &mut Account, splat: u64, entries: u64) {
        if entries == 0 {
            return;
        }
        let at = binning.at();
        write.wait(Cause::Upstream, at);
        let address = Map::of(self.map.packet, splat);
        let (port, [_, bytes]) = (&mut self.port, self.map.packet);
        let packet = port.write_on(&mut self.packets, at, address, bytes);
        let [first, each] = [Map::of(self.map.entry, self.entries), self.map.entry[1]];
        self.entries += entries;
        let list = port.write_on(&mut self.lists, at, first, each * entries);
        binning.wait(Cause::WriteChannel, packet.max(list));
        write.wait(Cause::Port, packet.max(list));
    }

    /// A pass reads the entries from one region in their order and writes them into the places of the other; each place
    /// gets a burst when it is whole.
    fn sort(&mut self, sort: &mut Account, steps: &[SortStep]) {
        sort.work(SortStep::cycles(steps, self.config.sort_cycles.into()));
        for step in steps {
            self.sort_step(step);
        }
    }

    /// Machines with a part sort list entries, so that no list is filled afterwards.
    fn fill(&mut self, fill: &mut Account, cycles: u64, _: u64, _: u64) {
        fill.work(cycles);
    }

    fn packet(&mut self, fetch: &mut Account, wanted: Wanted) -> Read {
        let requested = self.next_request(wanted.unit, fetch, wanted.free);
        fetch.wait(Cause::FifoFull, requested);
        let reader = &mut self.readers[wanted.unit as usize];
        reader.next = requested + 1;
        let entry = Map::of(self.map.sorted, wanted.pair);
        let each = self.map.sorted[1];
        self.port.read_on(&mut reader.list, requested, entry, each);
        // Machines with a part have no packet cache, so that a splat is always named.
        let packet = Map::of(self.map.packet, wanted.splat.unwrap_or_default().into());
        let served = self.port.read(requested, packet, self.map.packet[1]);
        fetch.wait(Cause::Port, served.start);
        fetch.work(served.end.saturating_sub(fetch.at()));
        let arrives = self.arrival(served.end.max(fetch.at()));
        Read { requested, arrives }
    }

    fn next_request(&self, unit: u32, _: &Account, free: u64) -> u64 {
        free.max(self.readers[unit as usize].next)
    }

    fn discarded(&mut self, unit: u32, fetch: &mut Account, first: u64, pairs: &[PairWork]) {
        for (pair, work) in (first..).zip(pairs) {
            let wanted = Wanted {
                unit,
                free: 0,
                pair,
                splat: Some(work.splat),
            };
            self.packet(fetch, wanted);
        }
    }

    fn tile(&mut self, write_back: &mut Account, tile: &TileWrite) -> (u64, TileBuffer) {
        let bytes = u64::from(tile.pixels) * u64::from(self.config.pixel_bytes);
        let address = Map::of(self.map.tile, tile.tile.into());
        let start = tile.blended.max(write_back.at());
        let id = self.port.write_kept(start + tile.begin, address, bytes);
        let buffer = TileBuffer::Written {
            id,
            blended: tile.blended,
            least: tile.begin + tile.least,
        };
        (start, buffer)
    }

    fn background(&mut self, write_back: &Account, tile: u32, pixels: u32) -> u64 {
        let bytes = u64::from(pixels) * u64::from(self.config.pixel_bytes);
        let address = Map::of(self.map.tile, tile.into());
        self.port.write(write_back.at(), address, bytes);
        0
    }

    fn buffer(&mut self, write_back: &mut Account, buffer: TileBuffer) -> u64 {
        let clear = u64::from(self.config.clear_cycles);
        match buffer {
            TileBuffer::Free(at) => at,
            TileBuffer::Written { id, blended, least } => {
                let served = self.port.completed(id);
                write_back.wait(Cause::Lanes, blended);
                let least = write_back.at() + least;
                write_back.wait(Cause::Port, served.start);
                let end = served.end.max(least);
                write_back.work(end.saturating_sub(write_back.at()));
                write_back.at() + clear
            }
        }
    }

    fn end_of_phase(&mut self, cycles: u64) -> u64 {
        self.port.end_of_phase(cycles)
    }

    fn facts(&self, cycles: u64) -> Option<MemoryFacts> {
        let counts = self.port.counts();
        let clock = 1_000_000 * u128::from(self.config.clock_mhz.max(1));
        let at_peak = u128::from(cycles) * u128::from(self.part.peak_bytes_per_s()) / clock;
        Some(MemoryFacts {
            part: &self.part.name,
            source: &self.part.source,
            counts,
            bytes_moved: (counts.reads + counts.writes) * self.part.burst_bytes(),
            bytes_at_peak: u64::try_from(at_peak).unwrap_or(u64::MAX),
        })
    }
}
