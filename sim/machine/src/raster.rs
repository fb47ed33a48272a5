//! One raster unit: the recurrence over pairs and bands, `docs/hardware-model.md` sections 1 and 2.
//!
//! Every stage is a server. With start S, service time and departure D of item k:
//!
//! ```text
//! S[k] = max(D[k-1] of this stage, D[k] of the stage before)
//! D[k] = max(S[k] + service, the time at which the FIFO behind has a place)
//! ```
//!
//! so that a result that finds no place blocks its unit. All operations are maxima and sums of non-negative numbers: no
//! time can decrease when a service time or latency grows.

use super::accounts::{Account, Cause, Fifo};
use super::area::surface::RESOLVE_LATENCY;
use super::cache::PacketCache;
use super::config::{Config, LaneLayout, Overlap};
use super::lanes::{Band, LaneShape, PairWork};
use super::memory::{Memory, TileBuffer, TileWrite, Wanted};
use super::observe::{Event, Observer, Stage};
use super::primitive::{LaneRun, PrimitiveClock};
use super::sequencer::{Sequencer, Steps, VisitCosts};
use std::collections::VecDeque;

/// One raster unit's state.
#[derive(Clone, Debug)]
pub(super) struct RasterUnit {
    number: u32,
    config: Config,
    visit: VisitCosts,
    /// From a group's issue to its write.
    drain: u64,
    pub fetch: Account,
    pub splat: Account,
    pub rows: Account,
    pub sequencers: Vec<Sequencer>,
    pub write_back: Account,
    pub packets: Fifo,
    pub splats: Fifo,
    /// Its clock where it is the circuit of `sim/rtl`.
    primitive: PrimitiveClock,
    /// Tile buffers by when they become free, oldest first.
    buffers: VecDeque<TileBuffer>,
    /// Cycles for which backgrounds that are not written yet will keep the write channel.
    owed: u64,
    /// When the circuit takes a tile's first packet at the earliest: it draws one tile after the other, whatever the
    /// number of buffers. The first tile's own handshake takes a cycle.
    handed_over: u64,
    pub prefetched_discarded: u64,
    pub cache: PacketCache,
}

/// From the handshake that ends a tile until the circuit takes the next tile's first packet.
const HAND_OVER: u64 = 2;

/// A tile to be drawn.
pub(super) struct TileJob<'a> {
    pub tile: u32,
    pub pixels: u32,
    /// Fragments of surfaces that are normalised while the tile is read out.
    pub resolved: u32,
    /// The pairs that are drawn, the first one's first band, and the pairs that follow them.
    pub pairs: &'a [PairWork],
    pub first_pair: usize,
    pub first_band: usize,
    pub left_out: &'a [PairWork],
    pub bands: &'a [Band],
}

/// How far a tile has been drawn.
pub(super) struct TileDrawing {
    /// When its buffer was free.
    buffer: u64,
    pair: usize,
    band: usize,
}

impl TileDrawing {
    /// Has its last pair been drawn?
    pub fn is_over(&self, job: &TileJob) -> bool {
        self.pair >= job.pairs.len()
    }
}

impl RasterUnit {
    pub fn new(number: u32, config: &Config) -> RasterUnit {
        let sequencer = Sequencer::new(config.row_fifo, config.tile_height.into());
        let lanes = config.lanes as usize;
        let sequencers = match config.layout {
            LaneLayout::Rows => lanes,
            _ => 1,
        };
        let free = TileBuffer::Free(config.clear_cycles.into());
        RasterUnit {
            number,
            config: *config,
            visit: VisitCosts {
                stretch: config.stretch().into(),
                stride: LaneShape::from(config).stride().into(),
                blend_latency: config.blend_latency.into(),
            },
            drain: u64::from(config.table_latency) + u64::from(config.blend_latency),
            fetch: Account::default(),
            splat: Account::default(),
            rows: Account::default(),
            sequencers: vec![sequencer; sequencers],
            write_back: Account::default(),
            packets: Fifo::new(config.packet_fifo),
            splats: Fifo::new(config.splat_fifo),
            primitive: PrimitiveClock::new(lanes, config.row_fifo, config.intervals(), 0),
            buffers: vec![free; config.tile_buffers as usize].into(),
            owed: 0,
            handed_over: 1,
            prefetched_discarded: 0,
            cache: PacketCache::new(config.packet_cache),
        }
    }

    /// The cycle from which the unit could begin to fetch another tile.
    pub fn ready_at(&self) -> u64 {
        self.fetch.at()
    }

    /// The cycle after which the lanes do nothing any more.
    fn lanes_at(&self) -> u64 {
        let lanes = self.sequencers.iter().map(|lanes| lanes.account.at());
        lanes.max().unwrap_or(0)
    }

    /// The cycle after which the unit does nothing any more.
    pub fn finished_at(&self) -> u64 {
        let stages = [&self.fetch, &self.splat, &self.rows, &self.write_back].map(Account::at);
        stages.into_iter().fold(self.lanes_at(), u64::max)
    }

    /// The first cycle in which it could ask for another packet.
    pub fn next_request<M: Memory>(&self, memory: &M) -> u64 {
        memory.next_request(self.number, &self.fetch, self.packets.free_at())
    }

    /// Draws one tile.
    pub fn draw<O: Observer, M: Memory>(
        &mut self,
        job: &TileJob,
        observer: &mut O,
        memory: &mut M,
    ) {
        if self.is_background(job) {
            return self.write_background(job, memory);
        }
        let mut drawing = self.begin(job, memory);
        for _ in job.pairs {
            self.draw_pair(job, &mut drawing, observer, memory);
        }
        self.end(job, &drawing, observer, memory);
    }

    /// Does nobody draw this tile? Whoever hands out tiles to the circuit writes the background of those without splats
    /// himself: their read-out would keep the circuit for a cycle a pixel.
    pub fn is_background(&self, job: &TileJob) -> bool {
        let empty = job.pairs.is_empty() && job.left_out.is_empty();
        empty && self.config.overlap == Overlap::Primitive
    }

    /// Writes such a tile, when the write channel has nothing else to do.
    pub fn write_background<M: Memory>(&mut self, job: &TileJob, memory: &mut M) {
        self.owed += memory.background(&self.write_back, job.tile, job.pixels);
    }

    /// Takes the tile buffer that is free first.
    pub fn begin<M: Memory>(&mut self, job: &TileJob, memory: &mut M) -> TileDrawing {
        let oldest = self.buffers.pop_front().unwrap_or(TileBuffer::Free(0));
        let mut buffer = memory.buffer(&mut self.write_back, oldest);
        if self.config.overlap == Overlap::Primitive {
            buffer = buffer.max(self.handed_over);
        }
        // Another tile's pixels lie in another buffer.
        self.sequencers.iter_mut().for_each(Sequencer::begin_tile);
        TileDrawing {
            buffer,
            pair: 0,
            band: job.first_band,
        }
    }

    /// Draws the tile's next pair, if there is one.
    #[inline]
    pub fn draw_pair<O: Observer, M: Memory>(
        &mut self,
        job: &TileJob,
        drawing: &mut TileDrawing,
        observer: &mut O,
        memory: &mut M,
    ) {
        let Some(pair) = job.pairs.get(drawing.pair) else {
            return;
        };
        let bands = &job.bands[drawing.band..pair.bands_end as usize];
        let mut at = TracePlace {
            unit: self.number,
            tile: job.tile,
            splat: pair.splat,
            pair: (job.first_pair + drawing.pair) as u64,
            buffer: drawing.buffer,
            drain: self.drain,
            observer,
            memory,
        };
        drawing.band = pair.bands_end as usize;
        drawing.pair += 1;
        match self.config.overlap {
            Overlap::Serial => self.serial_pair(bands, &mut at),
            Overlap::Pipelined => self.pipelined_pair(bands, &mut at),
            Overlap::Primitive => self.primitive_pair(bands, &mut at),
        }
    }

    /// Drops what was fetched and is not needed and writes the tile back.
    pub fn end<O: Observer, M: Memory>(
        &mut self,
        job: &TileJob,
        drawing: &TileDrawing,
        observer: &mut O,
        memory: &mut M,
    ) {
        let first = (job.first_pair + job.pairs.len()) as u64;
        self.drop_prefetched(first, job.left_out, memory);
        self.write_back(job, drawing.buffer, observer, memory);
    }

    /// Waits for the last tiles, and for the backgrounds that found no time before.
    pub fn settle<M: Memory>(&mut self, memory: &mut M) {
        while let Some(buffer) = self.buffers.pop_front() {
            memory.buffer(&mut self.write_back, buffer);
        }
        self.write_back.work(self.owed);
        self.owed = 0;
    }

    /// Requests a packet as soon as it has a place; gives when, and its arrival.
    #[inline(always)]
    fn fetch<O: Observer, M: Memory>(&mut self, at: &mut TracePlace<O, M>) -> [u64; 2] {
        let wanted = Wanted {
            unit: self.number,
            free: self.packets.free_at(),
            pair: at.pair,
            splat: (!self.cache.look_up(at.splat)).then_some(at.splat),
        };
        let read = at.memory.packet(&mut self.fetch, wanted);
        at.event(Stage::Fetch, 0, 0, read.requested, read.arrives);
        [read.requested, read.arrives]
    }

    #[inline(always)]
    fn pipelined_pair<O: Observer, M: Memory>(
        &mut self,
        bands: &[Band],
        at: &mut TracePlace<O, M>,
    ) {
        let [requested, arrival] = self.fetch(at);
        self.splat.wait(Cause::Memory, arrival);
        let start = self.splat.at();
        self.packets.pass(requested, start);
        self.splat.work(self.config.splat_cycles.into());
        at.event(Stage::Setup, 0, 0, start, self.splat.at());
        self.splat.wait(Cause::FifoFull, self.splats.free_at());
        let handed_on = self.splat.at();

        self.rows.wait(Cause::Memory, arrival);
        self.rows.wait(Cause::SplatSetup, handed_on);
        self.splats.pass(handed_on, self.rows.at());
        let mut generator = Steps::new(self.config.rows_at_once);
        for band in bands {
            let began = self.rows.at();
            let steps = generator.make(band.rows);
            self.rows.work(steps * u64::from(self.config.row_cycles));
            at.event(Stage::Rows, 0, band.y, began, self.rows.at());
            if band.groups > 0 {
                self.hand_over(band, [arrival, handed_on], at);
            }
        }
    }

    /// From the row generator through the FIFO into the lanes; the splat's packet arrived and was set up at these
    /// times.
    #[inline(always)]
    fn hand_over<O: Observer, M: Memory>(
        &mut self,
        band: &Band,
        [arrived, set_up]: [u64; 2],
        at: &mut TracePlace<O, M>,
    ) {
        let lane = self.lane_of(band);
        let sequencer = &mut self.sequencers[lane];
        self.rows.wait(Cause::FifoFull, sequencer.fifo.free_at());
        let entered = self.rows.at();
        let lanes = &mut sequencer.account;
        lanes.wait(Cause::Memory, arrived);
        lanes.wait(Cause::SplatSetup, set_up);
        lanes.wait(Cause::RowGenerator, entered);
        let start = sequencer.visit(band, at.buffer, &self.visit);
        sequencer.fifo.pass(entered, start);
        at.lanes(lane, band, start, sequencer.account.at());
    }

    /// All three stages take turns, so each of them waits while another works.
    fn serial_pair<O: Observer, M: Memory>(&mut self, bands: &[Band], at: &mut TracePlace<O, M>) {
        let [requested, arrival] = self.fetch(at);
        let RasterUnit {
            splat,
            rows,
            sequencers,
            config,
            packets,
            ..
        } = self;
        let Some(sequencer) = sequencers.first_mut() else {
            return;
        };
        for account in [&mut *splat, &mut *rows, &mut sequencer.account] {
            account.wait(Cause::Memory, arrival);
        }
        packets.pass(requested, splat.at());
        let began = splat.at();
        splat.work(config.splat_cycles.into());
        at.event(Stage::Setup, 0, 0, began, splat.at());
        rows.wait(Cause::Turn, splat.at());
        let mut generator = Steps::new(config.rows_at_once);
        for band in bands {
            let began = rows.at();
            let steps = generator.make(band.rows);
            rows.work(steps * u64::from(config.row_cycles));
            at.event(Stage::Rows, 0, band.y, began, rows.at());
            sequencer.account.wait(Cause::Turn, rows.at());
            if band.groups > 0 {
                let start = sequencer.visit(band, at.buffer, &self.visit);
                at.lanes(0, band, start, sequencer.account.at());
            }
            rows.wait(Cause::Turn, sequencer.account.at());
        }
        sequencer.account.wait(Cause::Turn, rows.at());
        splat.wait(Cause::Turn, rows.at());
    }

    /// The circuit of `sim/rtl`: the clock says when, the accounts why.
    fn primitive_pair<O: Observer, M: Memory>(
        &mut self,
        bands: &[Band],
        at: &mut TracePlace<O, M>,
    ) {
        let ([requested, arrival], buffer) = (self.fetch(at), at.buffer);
        let stamp = self.primitive.packet(arrival.max(buffer));
        // The place of a packet that has been taken is free in the next cycle.
        self.packets.pass(requested, stamp.accepted + 1);
        self.splat.wait(Cause::Memory, arrival);
        self.splat.wait(Cause::TileBuffer, buffer);
        self.splat.wait(Cause::FifoFull, stamp.accepted);
        self.splat.work(1);
        at.event(Stage::Setup, 0, 0, stamp.accepted, stamp.begun);
        for band in bands {
            for row in 1..=band.rows {
                let last = row == band.rows && band.groups > 0;
                let lane = self.lane_of(band);
                let slot = self.primitive.slot(last.then_some(LaneRun {
                    lane,
                    row: band.y.into(),
                    column: band.first.into(),
                    length: band.groups.into(),
                }));
                self.rows.wait(Cause::Memory, arrival);
                self.rows.wait(Cause::TileBuffer, buffer);
                self.rows.wait(Cause::SplatSetup, slot.ready);
                self.rows.wait(Cause::FifoFull, slot.left);
                self.rows.work(1);
                at.event(Stage::Rows, 0, band.y, slot.left, slot.left + 1);
                let Some(popped) = slot.popped else { continue };
                let sequencer = &mut self.sequencers[lane];
                sequencer.fifo.pass(slot.left, popped);
                let lanes = &mut sequencer.account;
                lanes.wait(Cause::Memory, arrival);
                lanes.wait(Cause::TileBuffer, buffer);
                lanes.wait(Cause::SplatSetup, stamp.begun);
                lanes.wait(Cause::RowGenerator, popped + 1 - slot.held);
                lanes.wait(Cause::Hazard, popped + 1);
                lanes.work(band.groups.into());
                at.lanes(lane, band, popped + 1, lanes.at());
            }
        }
    }

    #[inline(always)]
    fn lane_of(&self, band: &Band) -> usize {
        // Lanes that own their rows are a power of two.
        match self.config.layout {
            LaneLayout::Rows => usize::from(band.y) & (self.sequencers.len() - 1),
            _ => 0,
        }
    }

    /// Packets of a finished tile that were already on their way.
    fn drop_prefetched<M: Memory>(&mut self, first: u64, left_out: &[PairWork], memory: &mut M) {
        let pairs = &left_out[..left_out.len().min(self.config.packet_fifo as usize)];
        self.prefetched_discarded += pairs.len() as u64;
        memory.discarded(self.number, &mut self.fetch, first, pairs);
    }

    /// A tile is written back when its last pixel has been blended.
    fn write_back<O: Observer, M: Memory>(
        &mut self,
        job: &TileJob,
        buffer: u64,
        observer: &mut O,
        memory: &mut M,
    ) {
        // The circuit reads its buffer out when its rows have come to an end as well, and a pixel a cycle; a surface
        // unit normalises fragment by fragment.
        let (last, least) = match self.config.overlap {
            Overlap::Primitive => (self.lanes_at().max(self.rows.at()), job.pixels.into()),
            _ => {
                let interval = u64::from(self.config.resolve_interval);
                (self.lanes_at(), u64::from(job.resolved) * interval)
            }
        };
        let blended = if job.pairs.is_empty() {
            buffer
        } else {
            let resolve = if job.resolved > 0 { RESOLVE_LATENCY } else { 0 };
            last.max(buffer) + self.drain + resolve
        };
        let gap = blended.saturating_sub(self.write_back.at());
        let filled = self.owed.min(gap);
        self.write_back.work(filled);
        self.owed -= filled;
        let tile = TileWrite {
            tile: job.tile,
            pixels: job.pixels,
            blended,
            begin: self.config.write_back_cycles.into(),
            least,
            clear: self.config.clear_cycles.into(),
        };
        let (start, free) = memory.tile(&mut self.write_back, &tile);
        self.handed_over = start + HAND_OVER;
        self.buffers.push_back(free);
        let mut at = TracePlace {
            unit: self.number,
            tile: job.tile,
            splat: u32::MAX,
            pair: 0,
            buffer,
            drain: self.drain,
            observer,
            memory,
        };
        let end = self.write_back.at().max(start);
        at.event(Stage::WriteBack, 0, 0, start, end);
    }
}

/// Where an event takes place.
struct TracePlace<'a, O, M> {
    unit: u32,
    tile: u32,
    splat: u32,
    /// Number of the pair in all lists.
    pair: u64,
    /// When the tile's buffer was free.
    buffer: u64,
    /// From a group's issue to its write.
    drain: u64,
    observer: &'a mut O,
    memory: &'a mut M,
}

impl<O: Observer, M> TracePlace<'_, O, M> {
    #[inline(always)]
    fn event(&mut self, stage: Stage, lane: usize, row: u8, start: u64, end: u64) {
        if O::WATCHES {
            self.observer.event(Event {
                unit: self.unit,
                stage,
                lane: lane as u32,
                tile: self.tile,
                splat: self.splat,
                row: row.into(),
                start,
                end,
            });
        }
    }

    #[inline(always)]
    fn lanes(&mut self, lane: usize, band: &Band, start: u64, end: u64) {
        self.event(Stage::Lanes, lane, band.y, start, end);
        self.event(Stage::Blend, lane, band.y, end, end + self.drain);
    }
}
