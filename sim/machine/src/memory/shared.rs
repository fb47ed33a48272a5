//! A memory part behind one port, as the units of a machine see it: where everything lies, and whose request is whose.

use super::parts::DramPart;
use super::port::{Access, Port, Stream};
use super::{Memory, MemoryFacts, Read, Sort, TileBuffer, TileWrite, Wanted};
use crate::accounts::{Account, Cause};
use crate::config::Config;
use crate::lanes::PairWork;
use crate::order::SortStep;

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
    /// Addresses for so many splats and list entries.
    fn new(config: &Config, packet_bytes: u32, splats: u64, entries: u64) -> Map {
        let mut next = 0;
        let mut region = |bytes: u64, count: u64| {
            let start = next;
            next = (next + bytes * count).next_multiple_of(MEGABYTE);
            [start, bytes]
        };
        let sorted = config.sorted_bytes().max(config.list_bytes).into();
        let pixels = u64::from(config.tile_width) * u64::from(config.tile_height);
        Map {
            splat: region(config.splat_bytes.into(), splats),
            harmonics: region(config.harmonics_bytes.into(), splats),
            packet: region(packet_bytes.into(), splats),
            entry: region(sorted, entries),
            sorted: region(sorted, entries),
            tile: region(pixels * u64::from(config.pixel_bytes), 1),
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
    sort: Sort,
    packet_bytes: u64,
    /// Next cycle in which geometry may ask, and its streams.
    geometry: u64,
    splats: Stream,
    packets: Stream,
    lists: Stream,
    entries: u64,
    readers: Vec<SharedReader>,
    /// Phases that are over: their cycles, what was counted, and their accesses.
    before: u64,
    counts: super::DramCounts,
    traced: Option<Vec<Access>>,
}

impl Shared {
    /// A part for a machine and a picture of so many splats and list entries.
    pub fn new(
        part: &'static DramPart,
        config: &Config,
        packet_bytes: u32,
        splats: u64,
        entries: u64,
        traced: bool,
    ) -> Shared {
        let mut port = Port::new(part, config.clock_mhz, config.write_queue);
        port.trace = traced.then(Vec::new);
        Shared {
            part,
            port,
            config: *config,
            map: Map::new(config, packet_bytes, splats, entries),
            sort: Sort::new(config),
            packet_bytes: packet_bytes.into(),
            geometry: 0,
            splats: Stream::default(),
            packets: Stream::default(),
            lists: Stream::default(),
            entries: 0,
            readers: vec![SharedReader::default(); config.raster_units as usize],
            before: 0,
            counts: super::DramCounts::default(),
            traced: traced.then(Vec::new),
        }
    }

    /// All accesses in the order in which they were served, in cycles of the picture.
    pub fn into_trace(self) -> Vec<Access> {
        self.traced.unwrap_or_default()
    }

    /// The units of the sort take what comes in no time; their own time goes on beside it.
    fn sort_step(&mut self, step: &SortStep) {
        let size = self.part.burst_bytes();
        let bursts = (step.entries * self.sort.bytes).div_ceil(size);
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
            let address = Map::of(self.map.harmonics, number);
            note(Some(self.port.read(
                requested,
                address,
                self.map.harmonics[1],
            )));
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
        let packet = self
            .port
            .write_on(&mut self.packets, at, address, self.packet_bytes);
        let [first, each] = [Map::of(self.map.entry, self.entries), self.map.entry[1]];
        self.entries += entries;
        let list = self
            .port
            .write_on(&mut self.lists, at, first, each * entries);
        binning.wait(Cause::WriteChannel, packet.max(list));
        write.wait(Cause::Port, packet.max(list));
    }

    /// A pass reads the entries from one region in their order and writes them into the places of the other; each place gets a burst when it is whole.
    fn sort(&mut self, sort: &mut Account, steps: &[SortStep]) {
        sort.work(SortStep::cycles(steps, self.sort.cycles));
        for step in steps {
            self.sort_step(step);
        }
    }

    /// Machines with a part sort list entries, so that no list is filled afterwards.
    fn fill(&mut self, fill: &mut Account, cycles: u64, _: u64, _: u64) {
        fill.work(cycles);
    }

    fn packet(&mut self, fetch: &mut Account, wanted: Wanted) -> Read {
        let Wanted {
            unit,
            free,
            pair,
            splat,
        } = wanted;
        let requested = self.next_request(unit, fetch, free);
        fetch.wait(Cause::FifoFull, requested);
        let reader = &mut self.readers[unit as usize];
        reader.next = requested + 1;
        let [entry, each] = [Map::of(self.map.sorted, pair), self.map.sorted[1]];
        self.port.read_on(&mut reader.list, requested, entry, each);
        // Machines with a part have no packet cache, so that a splat is always named.
        let packet = Map::of(self.map.packet, splat.unwrap_or_default().into());
        let served = self.port.read(requested, packet, self.packet_bytes);
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
        let end = self.port.drain();
        self.counts += self.port.counts();
        let config = &self.config;
        let next = Port::new(self.part, config.clock_mhz, config.write_queue);
        let port = std::mem::replace(&mut self.port, next);
        if let (Some(all), Some(phase)) = (&mut self.traced, port.trace) {
            self.port.trace = Some(Vec::new());
            let before = self.before;
            all.extend(phase.into_iter().map(|access| Access {
                cycle: before + access.cycle,
                ..access
            }));
        }
        self.before += end.max(cycles);
        end
    }

    fn facts(&self, cycles: u64) -> Option<MemoryFacts> {
        let counts = self.counts;
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
