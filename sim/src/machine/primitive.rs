//! The clock of the splat primitive in `sim/rtl`, handshake by handshake: in which cycle each packet, row and run moves on.
//!
//! ```text
//! packet -> setup, 8 stages -> rows, 13 stages -> queue of each lane -> lane, one pixel a cycle
//! ```
//!
//! A splat fills one slot of the row pipeline for each row of its box in the tile, or one if there is none. Its stages move all
//! together or not at all (`Pipeline`); a slot whose run finds its lane's queue full stops them. Queues are registered: a run can be
//! popped in the cycle after it came, and its place is free in the cycle after that. With e(i) the cycle in which slot i
//! leaves the pipeline and p(i) the one in which its run is popped, packets never running out, this is
//!
//! ```text
//! e(0) = 21                                    cycles after its packet was taken
//! e(i) = max(e(i-1) + 1, p(j) + 1)             j: the run `queue` places before in the same lane, if slot i has a run
//! p(i) = max(e(i) + 1, p(k) + length(k))       k: the run before in the same lane
//! ```
//!
//! It is the machine's raster unit where `overlap = "primitive"`, and the co-simulation compares it with the circuit cycle by cycle.
//! Where packets never run out, [`picture_cycles`] gives the same cycles for whole pictures, several times as fast.

mod picture;
mod spans;

pub use picture::{picture_cycles, tile_cycles};

use splatline::footprint::Footprint;
use splatline::format::Design;
use splatline::raster::{BLOCK, Rows, SpanRows, Window};
use std::collections::VecDeque;

/// Runs that a lane's queue holds; `QUEUE` of splat_primitive.sv.
pub const QUEUE: u32 = 8;

/// Columns and rows of the tile buffer. The columns are those between two seeds, so that a row is one run.
pub const TILE: [u16; 2] = [BLOCK, 32];

/// Stages of splat_setup.sv.
const SETUP_STAGES: u64 = 8;

/// Stages of row_generator.sv, that of the row being issued among them.
const ROW_STAGES: u64 = 13;

/// Cycles from a packet's handshake until its first row reaches the queues, if nothing is in its way.
pub const LATENCY: u64 = SETUP_STAGES + ROW_STAGES;

/// A pipeline whose stages move all together, or none: it stands still while its last stage holds something that cannot leave.
///
/// Its *own time* counts the cycles in which it moves: what comes in at own time n can leave at n + stages. The cycle of
/// an own time is that time plus all cycles for which the pipeline has stood until then.
#[derive(Clone, Debug)]
struct Pipeline {
    stages: u64,
    /// Own time at which the next entry may come at the earliest.
    next: u64,
    /// Cycles stood up to that time, and in all.
    stood: u64,
    stood_in_all: u64,
    /// Own times at which it will stand, and for how long: behind entries that are still inside at `next`.
    stops: VecDeque<(u64, u64)>,
}

impl Pipeline {
    fn new(stages: u64) -> Self {
        Pipeline {
            stages,
            next: 0,
            stood: 0,
            stood_in_all: 0,
            stops: VecDeque::new(),
        }
    }

    /// Takes an entry in the first possible cycle from `earliest` on; gives that cycle and the own time at which it reaches its end.
    fn enter(&mut self, earliest: u64) -> (u64, u64) {
        let mut at = self.next;
        loop {
            while let Some((_, cycles)) = self.stops.pop_front_if(|(time, _)| *time <= at) {
                self.stood += cycles;
            }
            if at + self.stood >= earliest {
                break;
            }
            // Further on, but not beyond the next stop, which may be as long as it likes.
            let wanted = earliest - self.stood;
            at = self
                .stops
                .front()
                .map_or(wanted, |(time, _)| wanted.min(*time));
        }
        self.next = at + 1;
        (at + self.stood, at + self.stages)
    }

    /// Takes an entry as soon as it moves; gives the own time at which it reaches its end.
    #[inline(always)]
    fn enter_at_once(&mut self) -> u64 {
        // `stood` catches up when a cycle is asked for.
        self.next += 1;
        self.next - 1 + self.stages
    }

    /// The first cycle in which the entry that ends at this own time could leave; entries are asked for in their order.
    fn ready(&self, end: u64) -> u64 {
        end + self.stood_in_all
    }

    /// It leaves in a cycle, not before [`Pipeline::ready`].
    fn leave(&mut self, end: u64, cycle: u64) {
        let stands = cycle - self.ready(end);
        if stands > 0 {
            self.stops.push_back((end, stands));
            self.stood_in_all += stands;
        }
    }
}

/// A run that a slot may have: the lane that owns its row, and its pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LaneRun {
    /// Lane: the row modulo the number of lanes.
    pub lane: usize,
    /// Pixels, at least one.
    pub length: u16,
}

/// Cycles of a packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PacketStamp {
    /// Its handshake.
    pub taken: u64,
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
}

/// The primitive's clock: feed it packets and their slots in order.
#[derive(Clone, Debug)]
pub struct PrimitiveClock {
    setup: Pipeline,
    rows: Pipeline,
    /// Own time of the rows at which the first slot of the packet taken last reaches their end.
    first_end: Option<u64>,
    lanes: Vec<Lane>,
    idle_at: u64,
}

#[derive(Clone, Debug)]
struct Lane {
    /// Cycles in which the last runs were popped, a ring of the queue's size.
    pops: Vec<u64>,
    /// The oldest of them.
    place: usize,
    /// First cycle in which the next run may be popped.
    free: u64,
}

impl PrimitiveClock {
    /// A unit with so many lanes and queues of so many runs, at least one each, idle from cycle 0 on.
    pub fn new(lanes: usize, queue: u32) -> Self {
        let lane = Lane {
            pops: vec![0; queue.max(1) as usize],
            place: 0,
            free: 0,
        };
        PrimitiveClock {
            setup: Pipeline::new(SETUP_STAGES),
            rows: Pipeline::new(ROW_STAGES),
            first_end: None,
            lanes: vec![lane; lanes.max(1)],
            idle_at: 0,
        }
    }

    /// A packet that is offered from this cycle on. Its slots, at least one, must follow by [`PrimitiveClock::slot`].
    pub fn packet(&mut self, offered: u64) -> PacketStamp {
        let (taken, setup_end) = self.setup.enter(offered);
        let (begun, rows_end) = self.rows.enter(self.setup.ready(setup_end));
        self.setup.leave(setup_end, begun);
        self.first_end = Some(rows_end);
        PacketStamp { taken, begun }
    }

    /// The next row of the packet's box in the tile, with the run that it has.
    #[inline]
    pub fn slot(&mut self, run: Option<LaneRun>) -> SlotStamp {
        let end = match self.first_end.take() {
            Some(end) => end,
            None => self.rows.enter_at_once(),
        };
        let ready = self.rows.ready(end);
        let Some(run) = run else {
            self.idle_at = self.idle_at.max(ready + 1);
            return SlotStamp {
                ready,
                left: ready,
                popped: None,
            };
        };
        let lane = &mut self.lanes[run.lane];
        // Before the queue has been full once this place holds 0, and no slot is ready in cycle 0.
        let left = ready.max(lane.pops[lane.place] + 1);
        self.rows.leave(end, left);
        let popped = lane.free.max(left + 1);
        lane.pops[lane.place] = popped;
        lane.place += 1;
        if lane.place == lane.pops.len() {
            lane.place = 0;
        }
        lane.free = popped + u64::from(run.length);
        self.idle_at = self.idle_at.max(lane.free + 1);
        SlotStamp {
            ready,
            left,
            popped: Some(popped),
        }
    }

    /// The first cycle in which nothing is in the unit any more, of what has been fed.
    pub fn idle_at(&self) -> u64 {
        self.idle_at
    }
}

/// The slots that a footprint fills in a window: what [`PrimitiveClock::slot`] takes, row by row. `lanes` must be a power of two. In a window
/// wider than a seed's block (the circuit takes none) every further seed of a row is a further slot.
#[inline]
pub fn for_each_slot<D: Design>(
    design: D,
    footprint: &Footprint,
    window: &Window,
    lanes: usize,
    mut slot: impl FnMut(Option<LaneRun>),
) {
    let bounds = Window {
        first: footprint.first,
        last: footprint.last,
    };
    let visible = bounds.intersect(window);
    if visible.is_empty() {
        return slot(None);
    }
    let mut rows = SpanRows::new(design, footprint, window);
    let mut row = visible.first[1];
    while let Some(run) = rows.next_run() {
        (row..run.y).for_each(|_| slot(None));
        row = run.y + 1;
        slot(Some(LaneRun {
            lane: usize::from(run.y) & (lanes - 1),
            length: run.length,
        }));
    }
    (row..visible.last[1]).for_each(|_| slot(None));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(lane: usize, length: u16) -> Option<LaneRun> {
        Some(LaneRun { lane, length })
    }

    /// One splat with these rows, offered in cycle 0.
    fn alone(lanes: usize, queue: u32, rows: impl IntoIterator<Item = Option<LaneRun>>) -> u64 {
        let mut clock = PrimitiveClock::new(lanes, queue);
        clock.packet(0);
        rows.into_iter().for_each(|row| {
            clock.slot(row);
        });
        clock.idle_at()
    }

    /// Slots leave in cycles 21, 22, 23; the first run is popped in 22 and keeps its lane until 27, the second until 29.
    #[test]
    fn three_rows_of_which_one_is_empty() {
        assert_eq!(alone(1, QUEUE, [run(0, 5), None, run(0, 2)]), 30);
    }

    /// Rows of one lane each: no waiting, so that the last of four runs of 5 ends five cycles after it is popped in 25.
    #[test]
    fn four_lanes_take_four_rows_at_once() {
        assert_eq!(alone(4, QUEUE, (0..4).map(|lane| run(lane, 5))), 25 + 5 + 1);
    }

    /// With room for one run the third waits until the second is popped, in 22 + 10, and leaves a cycle later.
    #[test]
    fn a_full_queue_stops_the_rows() {
        let mut clock = PrimitiveClock::new(1, 1);
        clock.packet(0);
        let left = [0; 3].map(|lane| clock.slot(run(lane, 10)).left);
        assert_eq!(left, [21, 23, 33]);
        assert_eq!(clock.slot(None).left, 34);
        assert_eq!(clock.idle_at(), 22 + 30 + 1);
    }

    #[test]
    fn a_splat_without_rows_takes_a_slot() {
        assert_eq!(alone(4, QUEUE, [None]), LATENCY + 1);
    }

    /// A packet that comes late leaves a bubble, which a stop at the end of the rows does not close.
    #[test]
    fn bubbles_stay_where_they_are() {
        let mut clock = PrimitiveClock::new(1, 1);
        for (offered, stamp) in [(0, (0, 8)), (0, (1, 9)), (5, (5, 13))] {
            let PacketStamp { taken, begun } = clock.packet(offered);
            assert_eq!((taken, begun), stamp);
            clock.slot(run(0, 20));
        }
        // The second run waits in the queue for the first, the third before the queue, until 43.
        assert_eq!(clock.slot(None).left, 44);
    }
}
