//! Accounts of time: for every unit, busy + stalled (by cause) + idle = total, by construction and asserted.
//!
//! A unit's account is a cursor on its own time axis. Every interval is entered once, by moving the cursor to the
//! interval's end; the cursor never moves back, so no counter can become negative and no cycle can be counted twice.

use serde::Serialize;
use std::collections::BTreeMap;

/// What a unit does with a cycle in which it does not work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    /// Its input has been requested from memory and has not arrived.
    Memory,
    /// It waits for splat setup.
    SplatSetup,
    /// It waits for the row generator.
    RowGenerator,
    /// It waits for the lanes or the blend to finish a tile.
    Lanes,
    /// It waits for the geometry unit before it.
    Upstream,
    /// The FIFO behind it is full.
    FifoFull,
    /// A pixel's blend before has not been written yet.
    Hazard,
    /// No tile buffer is free.
    TileBuffer,
    /// Another stage of a serial raster unit works.
    Turn,
    /// The write channel is busy.
    WriteChannel,
    /// The port to memory serves somebody else, or opens a row, refreshes or turns its bus.
    Port,
}

/// All causes, with their names in reports.
pub const CAUSES: [(Cause, &str); 11] = [
    (Cause::Memory, "memory"),
    (Cause::SplatSetup, "splat_setup"),
    (Cause::RowGenerator, "row_generator"),
    (Cause::Lanes, "lanes"),
    (Cause::Upstream, "upstream"),
    (Cause::FifoFull, "fifo_full"),
    (Cause::Hazard, "hazard"),
    (Cause::TileBuffer, "tile_buffer"),
    (Cause::Turn, "turn"),
    (Cause::WriteChannel, "write_channel"),
    (Cause::Port, "port"),
];

/// One unit's time so far.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Account {
    at: u64,
    busy: u64,
    stalled: [u64; CAUSES.len()],
}

impl Account {
    /// The cycle up to which time is accounted for.
    #[inline(always)]
    pub fn at(&self) -> u64 {
        self.at
    }

    /// The unit works for so many cycles from now on.
    #[inline(always)]
    pub fn work(&mut self, cycles: u64) {
        self.busy += cycles;
        self.at += cycles;
    }

    /// The unit waits until a cycle; nothing if that has passed.
    #[inline(always)]
    pub fn wait(&mut self, cause: Cause, until: u64) {
        let waited = until.saturating_sub(self.at);
        self.stalled[cause as usize] += waited;
        self.at += waited;
    }
}

/// One unit's time as reports show it. With several instances all cycles are sums over them.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct UnitTime {
    /// Units of this kind.
    pub instances: u64,
    /// Cycles of useful service.
    pub busy: u64,
    /// Cycles stalled, by cause; causes that never occurred are left out.
    pub stalled: BTreeMap<&'static str, u64>,
    /// Cycles with nothing left to do.
    pub idle: u64,
    /// busy / (instances x total).
    pub utilisation: f64,
}

impl UnitTime {
    /// Closes the accounts of one kind of unit at `total`, which no account may exceed.
    pub fn close<'a>(accounts: impl IntoIterator<Item = &'a Account>, total: u64) -> UnitTime {
        let mut time = UnitTime::default();
        let mut stalled = [0; CAUSES.len()];
        for account in accounts {
            time.instances += 1;
            time.busy += account.busy;
            let at = account.at;
            assert!(at <= total, "a unit worked until {at} of {total} cycles");
            time.idle += total - at;
            for (sum, cycles) in stalled.iter_mut().zip(account.stalled) {
                *sum += cycles;
            }
        }
        let named = CAUSES.iter().zip(stalled).filter(|(_, cycles)| *cycles > 0);
        time.stalled = named.map(|((_, name), cycles)| (*name, cycles)).collect();
        let all = time.instances * total;
        let sum = time.busy + time.stalled_sum() + time.idle;
        assert_eq!(sum, all, "accounts must add up to the total");
        time.utilisation = time.busy as f64 / all.max(1) as f64;
        time
    }

    /// Stalled cycles of all causes.
    pub fn stalled_sum(&self) -> u64 {
        self.stalled.values().sum()
    }
}

/// A FIFO's places by the time at which each became free again, and the most that was ever in it.
///
/// Entry `k` may enter when entry `k - depth` has left. Departures are noted in the order of entry, in a ring whose
/// size is a power of two, because a remainder by a variable would be the slowest step of the whole model.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fifo {
    left: Vec<u64>,
    mask: usize,
    depth: usize,
    entered: usize,
    high_water: usize,
}

impl Fifo {
    /// A FIFO for so many entries, at least one.
    pub fn new(depth: u32) -> Fifo {
        let depth = depth.max(1) as usize;
        let size = depth.next_power_of_two();
        Fifo {
            left: vec![0; size],
            mask: size - 1,
            depth,
            entered: 0,
            high_water: 0,
        }
    }

    /// The first cycle at which the next entry finds a place.
    #[inline(always)]
    pub fn free_at(&self) -> u64 {
        // Before `depth` entries have come this is a place of the ring that still holds 0.
        self.left[self.entered.wrapping_sub(self.depth) & self.mask]
    }

    /// An entry comes in at `enter`, not before [`Fifo::free_at`], and goes out at `leave`. Neither goes back from
    /// entry to entry.
    ///
    /// An entry finds at most one more inside than the one before it found, so the mark can only rise by one: when the
    /// entry that came `high_water` before is still there. That is one comparison, and it almost never holds.
    #[inline(always)]
    pub fn pass(&mut self, enter: u64, leave: u64) {
        let before = self.left[self.entered.wrapping_sub(self.high_water) & self.mask];
        if self.high_water == 0 || before > enter {
            self.high_water += 1;
        }
        self.left[self.entered & self.mask] = leave;
        self.entered += 1;
    }

    /// The most entries that were in it at once.
    pub fn high_water(&self) -> u64 {
        self.high_water as u64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_causes_are_listed_in_their_order() {
        for (index, (cause, _)) in CAUSES.iter().enumerate() {
            assert_eq!(*cause as usize, index);
        }
    }

    proptest! {
        #[test]
        fn a_fifo_is_never_fuller_than_it_is_deep(depth in 1u32..9, steps in proptest::collection::vec((0u64..4, 0u64..9), 1..60)) {
            let mut fifo = Fifo::new(depth);
            let (mut enter, mut leave) = (0, 0);
            let mut inside: Vec<u64> = Vec::new();
            let mut most = 0;
            for (gap, stay) in steps {
                enter = (enter + gap).max(fifo.free_at());
                leave = (enter + stay).max(leave);
                fifo.pass(enter, leave);
                inside.retain(|left| *left > enter);
                inside.push(leave);
                most = most.max(inside.len());
            }
            prop_assert!(most <= depth as usize);
            prop_assert_eq!(fifo.high_water(), most as u64);
        }
    }
}
