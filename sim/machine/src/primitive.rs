//! The clock of the splat primitive in `sim/rtl`, handshake by handshake: in which cycle each packet, row and run moves
//! on.
//!
//! ```text
//! packet -> setup, 24 stages -> queue -> rows, 32 stages -> queue -> queue of each lane -> lane, one pixel a cycle
//! ```
//!
//! Stages take turns at some units, so that packets are taken in every fourth or eighth cycle since the reset alone,
//! and rows issued in every cycle or in every second one ([`Intervals`]). A splat fills one slot of the row pipeline
//! for each row of its box in the tile, or one if there is none. Pipelines never stand still: a packet is only taken,
//! and a row only issued, if the queue behind the pipeline has a place for it. Queues are registered: a place is free
//! in the cycle after its entry left. The queue of splats rests for a cycle after each. A lane holds a run back while a
//! pixel of it would come to a place less than [`INTERVAL`] cycles after an earlier one did. With t(s) the cycle in
//! which packet s is taken, b(s) the one in which its rows are begun, q(i) the one in which slot i is issued, e(i) the
//! one in which it leaves for its lane, m(i) the one in which its run comes to the front of that lane's queue and p(i)
//! the one in which it is popped, packets never running out, this is
//!
//! ```text
//! t(s) = max(t(s-1) + 1, b(s - SPLATS) + 1), put off to a multiple of setup's interval
//! b(s) = max(t(s) + 27, b(s-1) + 2, q(last slot of s-1))
//! q(i) = max(q(i-1) + 1, b(s) + 1, e(i - SLOTS) + 1), put off to a multiple of the rows' interval
//! e(i) = max(q(i) + 35, e(i-1) + 1, m(j) + 1)           j: where slot i has a run, the one `queue` places
//!                                                          before it in the same lane
//! m(i) = max(e(i) + 1, p(k))                            k: the run before in the same lane
//! p(i) = max(m(i) + 2, p(k) + length(k), p(h) + INTERVAL + column(i) - column(h))
//!                                                       h: runs before that meet it in a pixel
//! ```
//!
//! It is the machine's raster unit where `overlap = "primitive"`, and the co-simulation compares it with the circuit
//! cycle by cycle.

use super::accounts::Fifo;
use splatline::footprint::Footprint;
use splatline::format::Design;
use splatline::raster::{BLOCK, EllipseSpans, Spans, Window};

/// Runs that a lane's queue holds; `QUEUE` of splat_primitive.sv.
pub const QUEUE: u32 = 8;

/// Columns and rows of the tile buffer. The columns are those between two seeds, so that a row is one run.
pub const TILE: [u16; 2] = [BLOCK, 32];

/// Cycles between two visits of a pixel by its lane, at least; `INTERVAL` of lane.sv.
pub const INTERVAL: u64 = 7;

/// From a run's coming to the front of its lane's queue until it may be popped: meanwhile its pixels are compared with
/// those in flight.
const FRONT: u64 = 2;

/// Splats between packet and rows; `PLACES` of splat_setup.sv.
const SPLATS: u32 = 32;

/// Cycles between two packets, and between two rows, at least: the more, the more of the circuit's stages share a unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Intervals {
    /// `SETUP_INTERVAL` of splat_primitive.sv: 1, 4 or 8.
    pub setup: u32,
    /// `ROW_INTERVAL`: 1 or 2, of which `setup` is a multiple.
    pub rows: u32,
}

impl Intervals {
    /// As the circuit is usually built.
    pub const USUAL: Intervals = Intervals { setup: 4, rows: 1 };
    /// As small as it gets, for one lane.
    pub const SMALL: Intervals = Intervals { setup: 8, rows: 2 };
}

/// Cycles between two splats that leave their queue, at least; `RESTS` of fifo.sv.
const BEGINS: u64 = 2;

/// Slots between issue and the lanes' queues; `PLACES` of row_generator.sv.
const SLOTS: u32 = 64;

/// Cycles in which an entry passes through fifo.sv.
const FIFO_STAGES: u64 = 3;

/// From a packet's handshake until its rows may begin: the stages of splat_setup.sv and its queue.
const SETUP: u64 = 24 + FIFO_STAGES;

/// From a slot's issue until it may leave: the stages of row_generator.sv and its queue.
const ROW: u64 = 32 + FIFO_STAGES;

/// Cycles from a packet's handshake until its first row reaches the queues, if nothing is in its way.
pub const LATENCY: u64 = SETUP + 1 + ROW;

/// A run that a slot may have: the lane that owns its row, and its pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LaneRun {
    /// Lane: the row modulo the number of lanes.
    pub lane: usize,
    /// Row and first column, counted from anywhere.
    pub row: u16,
    /// See `row`.
    pub column: u16,
    /// Pixels, at least one.
    pub length: u16,
}

/// Cycles of a packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PacketStamp {
    /// Its handshake.
    pub accepted: u64,
    /// The row generator takes the splat over from setup.
    pub begun: u64,
}

/// Cycles of a slot of the row pipeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SlotStamp {
    /// It reaches the pipeline's end.
    pub ready: u64,
    /// It leaves the pipeline.
    pub left: u64,
    /// Its run, if it has one, is popped from the lane's queue; its pixels follow in the cycles after this one.
    pub popped: Option<u64>,
    /// Cycles of the wait before that for which pixels in flight held it back.
    pub held: u64,
}

/// The primitive's clock: feed it packets and their slots in order.
#[derive(Clone, Debug)]
pub struct PrimitiveClock {
    /// Packets are taken in cycles that are `phase` and a multiple of setup's interval, rows issued in cycles that are
    /// `phase` and a multiple of theirs.
    intervals: [u64; 2],
    phase: u64,
    /// First cycle in which the next packet may be taken.
    offered: u64,
    /// First cycles in which the next splat may be begun, the next slot issued and the next slot leave.
    begun: u64,
    issued: u64,
    left: u64,
    splats: Fifo,
    slots: Fifo,
    lanes: Vec<LaneClock>,
    idle_at: u64,
}

/// A lane's queue and its last runs.
#[derive(Clone, Debug)]
struct LaneClock {
    /// A run leaves it when it comes to its front.
    queue: Fifo,
    flights: Flights,
}

/// The last runs of a lane, whose pixels may be in flight.
#[derive(Clone, Debug, Default)]
struct Flights {
    /// When the last run was popped, and first cycle in which the next one may be.
    popped: u64,
    free: u64,
    /// Latest first: each run takes a cycle at least, so that one before these has settled.
    last: [SplatInFlight; INTERVAL as usize - 1],
}

#[derive(Clone, Copy, Debug, Default)]
struct SplatInFlight {
    row: u16,
    first: u16,
    end: u16,
    popped: u64,
}

impl Flights {
    /// Pops a run in the first possible cycle from `earliest` on; gives that, and for how long it was held back.
    #[inline(always)]
    fn pop(&mut self, earliest: u64, run: &LaneRun) -> (u64, u64) {
        let (row, column, length) = (run.row, run.column, run.length);
        let offered = self.free.max(earliest);
        let end = column + length;
        let mut popped = offered;
        for flight in &self.last {
            let meets = flight.row == row && flight.first < end && column < flight.end;
            let until = flight.popped + INTERVAL + u64::from(column);
            let until = until.saturating_sub(flight.first.into());
            popped = if meets { popped.max(until) } else { popped };
        }
        self.last.rotate_right(1);
        self.last[0] = SplatInFlight {
            row,
            first: column,
            end,
            popped,
        };
        self.popped = popped;
        self.free = popped + u64::from(length);
        (popped, popped - offered)
    }
}

impl PrimitiveClock {
    /// A unit with so many lanes and queues of so many runs, at least one each, idle from cycle 0 on, that takes
    /// packets and issues rows in cycles so far apart from `phase` on.
    pub fn new(lanes: usize, queue: u32, intervals: Intervals, phase: u64) -> Self {
        let lane = LaneClock {
            queue: Fifo::new(queue),
            flights: Flights::default(),
        };
        let intervals = [intervals.setup, intervals.rows].map(|cycles| u64::from(cycles.max(1)));
        let phase = phase % intervals[0];
        PrimitiveClock {
            intervals,
            phase,
            offered: phase,
            begun: 0,
            issued: 0,
            left: 0,
            splats: Fifo::new(SPLATS),
            slots: Fifo::new(SLOTS),
            lanes: vec![lane; lanes.max(1)],
            idle_at: 0,
        }
    }

    /// A packet that is offered from this cycle on. Its slots, at least one, must follow by [`PrimitiveClock::slot`].
    pub fn packet(&mut self, offered: u64) -> PacketStamp {
        let earliest = offered.max(self.offered).max(self.splats.free_at());
        let accepted = self.turn(0, earliest);
        self.offered = accepted + 1;
        let begun = self.begun.max(accepted + SETUP);
        self.splats.pass(accepted, begun + 1);
        self.begun = begun + BEGINS;
        self.issued = self.issued.max(begun + 1);
        PacketStamp { accepted, begun }
    }

    /// The first cycle from `earliest` on in which it is setup's or the rows' turn.
    fn turn(&self, unit: usize, earliest: u64) -> u64 {
        self.phase + (earliest - self.phase).next_multiple_of(self.intervals[unit])
    }

    /// The next row of the packet's box in the tile, with the run that it has.
    #[inline]
    pub fn slot(&mut self, run: Option<LaneRun>) -> SlotStamp {
        let issued = self.turn(1, self.issued.max(self.slots.free_at()));
        self.issued = issued + 1;
        self.begun = self.begun.max(issued);
        let ready = self.left.max(issued + ROW);
        let mut stamp = SlotStamp {
            ready,
            left: ready,
            popped: None,
            held: 0,
        };
        let mut last = ready;
        if let Some(run) = run {
            let lane = &mut self.lanes[run.lane];
            stamp.left = ready.max(lane.queue.free_at());
            let moved = lane.flights.popped.max(stamp.left + 1);
            lane.queue.pass(stamp.left, moved + 1);
            let (popped, held) = lane.flights.pop(moved + FRONT, &run);
            (stamp.popped, stamp.held) = (Some(popped), held);
            last = lane.flights.free;
        }
        self.left = stamp.left + 1;
        self.slots.pass(issued, self.left);
        self.idle_at = self.idle_at.max(last + 2);
        stamp
    }

    /// The first cycle in which the unit says that nothing is in it any more, of what has been fed.
    pub fn idle_at(&self) -> u64 {
        self.idle_at
    }
}

/// The slots that a footprint fills in a window: what [`PrimitiveClock::slot`] takes, row by row. `lanes` must be a
/// power of two. In a window wider than a seed's block (the circuit takes none) every further seed of a row is a
/// further slot.
#[inline]
pub fn for_each_slot<D: Design>(
    design: D,
    footprint: &Footprint,
    window: &Window,
    lanes: usize,
    mut slot: impl FnMut(Option<LaneRun>),
) {
    let bounds = Window::of(footprint);
    let visible = bounds.intersect(window);
    if visible.is_empty() {
        return slot(None);
    }
    let mut rows = EllipseSpans::new(design, footprint, window);
    let mut row = visible.first[1];
    while let Some(run) = rows.next_span() {
        (row..run.y).for_each(|_| slot(None));
        row = run.y + 1;
        slot(Some(LaneRun {
            lane: usize::from(run.y) & (lanes - 1),
            row: run.y,
            column: run.x,
            length: run.length,
        }));
    }
    (row..visible.end[1]).for_each(|_| slot(None));
}
