//! Cycles of the raster unit in closed form: what the circuit takes, exactly, while packets never run out and lanes never wait.
//!
//! A splat occupies one slot of the row pipeline for each row of its box in the window, or one if there is none. Slot i leaves
//! the pipeline in cycle e(i); its run waits in the queue of lane `row mod lanes` and is popped in cycle p(i):
//!
//! ```text
//! e(0) = 21                                    cycles after its packet was taken
//! e(i) = max(e(i-1) + 1, p(j) + 1)             j: the run QUEUE places before in the same lane, if slot i has a run
//! p(i) = max(e(i) + 1, p(k) + length(k))       k: the run before in the same lane
//! ```
//!
//! The unit is idle after the last slot has left and the last run's last pixel, p + length.

use splatline::footprint::Footprint;
use splatline::format::Design;
use splatline::raster::{Rows, SpanRows, Window};

/// Runs that a lane's queue holds; `QUEUE` of splat_primitive.sv.
pub const QUEUE: usize = 8;

/// Cycles from a packet's handshake until its first row reaches the queues: 8 of setup, 1 to take it over, 12 of the rows.
pub const LATENCY: u64 = 21;

/// The raster unit's clock: feed it splats in order, read the cycle in which it will be idle.
#[derive(Clone, Debug)]
pub struct RasterClock {
    lanes: Vec<Lane>,
    /// Cycle in which the last slot left the pipeline.
    exit: u64,
    queue: usize,
}

#[derive(Clone, Debug, Default)]
struct Lane {
    /// Cycles in which the last runs were popped, a ring of the queue's size.
    pops: Vec<u64>,
    runs: usize,
    /// First cycle in which the next run may be popped.
    free: u64,
}

impl RasterClock {
    /// A unit with so many lanes (a power of two) and the circuit's queues; the first packet is taken in cycle 0.
    pub fn new(lanes: usize) -> Self {
        Self::with_queue(lanes, QUEUE)
    }

    /// The same with queues of another size, for exploration.
    pub fn with_queue(lanes: usize, queue: usize) -> Self {
        let lane = Lane {
            pops: vec![0; queue],
            ..Lane::default()
        };
        RasterClock {
            lanes: vec![lane; lanes],
            exit: LATENCY - 1,
            queue,
        }
    }

    /// One slot with the row's run, if it has pixels: row and length.
    pub fn slot(&mut self, run: Option<(u16, u16)>) {
        self.exit += 1;
        let Some((row, length)) = run else { return };
        let lanes = self.lanes.len();
        let lane = &mut self.lanes[usize::from(row) % lanes];
        let place = lane.runs % self.queue;
        if lane.runs >= self.queue {
            self.exit = self.exit.max(lane.pops[place] + 1);
        }
        let pop = lane.free.max(self.exit + 1);
        lane.pops[place] = pop;
        lane.runs += 1;
        lane.free = pop + u64::from(length);
    }

    /// All slots of a footprint in a window.
    pub fn splat<D: Design>(&mut self, design: D, footprint: &Footprint, window: &Window) {
        let bounds = Window {
            first: footprint.first,
            last: footprint.last,
        };
        let visible = bounds.intersect(window);
        if visible.is_empty() {
            return self.slot(None);
        }
        let mut rows = SpanRows::new(design, footprint, window);
        let mut run = rows.next_run();
        for row in visible.first[1]..visible.last[1] {
            match run {
                Some(here) if here.y == row => {
                    self.slot(Some((row, here.length)));
                    run = rows.next_run();
                }
                _ => self.slot(None),
            }
        }
    }

    /// Cycles from the first packet's handshake until the unit is idle.
    pub fn cycles(&self) -> u64 {
        let lanes = self.lanes.iter().map(|lane| lane.free).max().unwrap_or(0);
        lanes.max(self.exit) + 1
    }
}

/// Cycles of one footprint in a window, alone.
pub fn rtl_cycles<D: Design>(
    design: D,
    footprint: &Footprint,
    window: &Window,
    lanes: usize,
) -> u64 {
    let mut clock = RasterClock::new(lanes);
    clock.splat(design, footprint, window);
    clock.cycles()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Slots leave in cycles 21, 22, 23; the first run is popped in 22 and keeps its lane until 27, the second until 29.
    #[test]
    fn three_rows_of_which_one_is_empty() {
        let mut clock = RasterClock::new(1);
        for run in [Some((7, 5)), None, Some((9, 2))] {
            clock.slot(run);
        }
        assert_eq!(clock.cycles(), 30);
    }

    /// Rows of one lane each: no waiting, so that the last of four runs of 5 ends five cycles after it is popped in 25.
    #[test]
    fn four_lanes_take_four_rows_at_once() {
        let mut clock = RasterClock::new(4);
        for row in 0..4 {
            clock.slot(Some((row, 5)));
        }
        assert_eq!(clock.cycles(), 25 + 5 + 1);
    }

    /// With room for one run the third waits until the second is popped, in 22 + 10, and leaves a cycle later.
    #[test]
    fn a_full_queue_stops_the_rows() {
        let mut clock = RasterClock::with_queue(1, 1);
        for row in 0..3 {
            clock.slot(Some((row, 10)));
        }
        clock.slot(None);
        assert_eq!(clock.exit, 32 + 1 + 1);
        assert_eq!(clock.cycles(), 22 + 30 + 1);
    }

    #[test]
    fn a_splat_without_rows_takes_a_slot() {
        let mut clock = RasterClock::new(4);
        clock.slot(None);
        assert_eq!(clock.cycles(), LATENCY + 1);
    }
}
