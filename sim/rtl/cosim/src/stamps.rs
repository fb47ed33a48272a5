//! In which cycle every handshake inside the circuit took place, and whether the machine's clock says the same, splat by splat.

use crate::model::Outputs;
use crate::workload::{BenchTile, BenchWorkload};
use splatline::format::Design;
use splatline_sim::machine::primitive::{LaneRun, PrimitiveClock, QUEUE, for_each_slot};
use std::collections::BTreeMap;

/// Lanes that a circuit may have.
const MOST_LANES: usize = 16;

/// Cycles of a tile's handshakes, in the order in which they took place.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Stamps {
    /// Cycles between two packets for which the circuit is built.
    pub setup_interval: u32,
    /// From which cycle on each packet was offered.
    pub offered: Vec<u64>,
    /// Each packet's handshake.
    pub taken: Vec<u64>,
    /// The row generator takes each splat over from setup.
    pub begun: Vec<u64>,
    /// Each run leaves the row generator.
    pub left: Vec<u64>,
    /// Each run is popped from the queue of its lane.
    pub popped: [Vec<u64>; MOST_LANES],
    /// The last packet's last pixel has left its lane.
    pub idle_at: u64,
}

/// How many cycles apart model and circuit are, of the events of one stage: how often each distance was found.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Distances(BTreeMap<u64, u64>);

impl Distances {
    /// Notes an event; one that the circuit never had is as far away as can be.
    fn note(&mut self, model: u64, circuit: Option<&u64>) {
        let apart = circuit.map_or(u64::MAX, |circuit| circuit.abs_diff(model));
        *self.0.entry(apart).or_default() += 1;
    }

    /// Adds those of another tile.
    pub fn add(&mut self, other: &Distances) {
        for (apart, events) in &other.0 {
            *self.0.entry(*apart).or_default() += events;
        }
    }

    /// Events.
    pub fn events(&self) -> u64 {
        self.0.values().sum()
    }

    /// The smallest distance that so many of 100 events do not exceed; 0 of none.
    pub fn percentile(&self, percent: u64) -> u64 {
        let rank = (self.events() * percent).div_ceil(100).max(1);
        let mut passed = 0;
        let found = self.0.iter().find(|(_, events)| {
            passed += **events;
            passed >= rank
        });
        found.map_or(0, |(apart, _)| *apart)
    }
}

/// The stages whose events are compared.
pub const STAGES: [&str; 5] = [
    "packet taken",
    "rows begun",
    "run left the rows",
    "run popped",
    "last pixel",
];

/// What a comparison of stamps found.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Timed {
    /// Distances of all events by stage.
    pub distances: [Distances; STAGES.len()],
    /// Splats whose handshakes were compared.
    pub splats: u64,
    /// Of these, splats of which any handshake took place in another cycle than the clock says.
    pub wrong: u64,
    /// The first difference, in words.
    pub first_difference: Option<String>,
}

impl Stamps {
    /// Notes what the circuit's outputs of a cycle say.
    pub fn note(&mut self, now: u64, out: &Outputs) {
        if out.splat_begun == 1 {
            self.begun.push(now);
        }
        if out.run_left == 1 {
            self.left.push(now);
        }
        let mut lanes = out.lanes_popped;
        while lanes != 0 {
            self.popped[lanes.trailing_zeros() as usize].push(now);
            lanes &= lanes - 1;
        }
    }

    /// Cycles from the first packet's handshake to the last packet's last pixel; 0 without packets.
    pub fn raster_cycles(&self) -> u64 {
        self.taken.first().map_or(0, |first| self.idle_at - first)
    }

    /// Compares every splat's handshakes with the machine's clock, to which the same packets are offered in the same cycles.
    pub fn compare<D: Design>(
        &self,
        design: D,
        lanes: usize,
        tile: &BenchTile,
        workload: &BenchWorkload,
    ) -> Timed {
        let mut timed = Timed::default();
        // The first packet is offered before its tile has begun; time is counted from its handshake, and with it the turns of setup.
        let first = self.taken.first().copied().unwrap_or(0);
        let mut clock = PrimitiveClock::with_interval(lanes, QUEUE, self.setup_interval, first);
        let mut left = self.left.iter();
        let mut popped = self.popped.each_ref().map(|lane| lane.iter());
        for (place, index) in tile.list.iter().enumerate() {
            let footprint = &workload.footprints[*index as usize];
            let mut same = Same::new(&mut timed.distances);
            let offered = self.offered.get(place).copied().unwrap_or(0);
            let stamp = clock.packet(offered.max(first));
            same.check("packet taken", stamp.taken, self.taken.get(place));
            same.check("rows begun", stamp.begun, self.begun.get(place));
            for_each_slot(design, footprint, &tile.window, lanes, |run| {
                let slot = clock.slot(run);
                if let (Some(LaneRun { lane, .. }), Some(cycle)) = (run, slot.popped) {
                    same.check("run left the rows", slot.left, left.next());
                    same.check("run popped", cycle, popped[lane].next());
                }
            });
            timed.splats += 1;
            let first_difference = same.first;
            timed.wrong += u64::from(first_difference.is_some());
            if let (None, Some(text)) = (&timed.first_difference, first_difference) {
                timed.first_difference = Some(format!("splat {place}: {text}"));
            }
        }
        let mut same = Same::new(&mut timed.distances);
        if !tile.list.is_empty() {
            same.check("last pixel", clock.idle_at(), Some(&self.idle_at));
        }
        same.check("runs left over", 0, Some(&(left.len() as u64)));
        let first_difference = same.first;
        timed.first_difference = timed.first_difference.or(first_difference);
        timed
    }
}

/// The first cycle that is not the same, in words, and how far apart all of them are.
struct Same<'a> {
    first: Option<String>,
    distances: &'a mut [Distances; STAGES.len()],
}

impl<'a> Same<'a> {
    fn new(distances: &'a mut [Distances; STAGES.len()]) -> Same<'a> {
        Same {
            first: None,
            distances,
        }
    }

    fn check(&mut self, what: &str, model: u64, circuit: Option<&u64>) {
        if let Some(stage) = STAGES.iter().position(|stage| *stage == what) {
            self.distances[stage].note(model, circuit);
        }
        if self.first.is_none() && circuit != Some(&model) {
            let circuit = circuit.map_or("never".to_owned(), |cycle| format!("in cycle {cycle}"));
            self.first = Some(format!(
                "{what} in cycle {model} by the model, {circuit} by the circuit"
            ));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_have_their_percentiles() {
        let mut some = Distances::default();
        for model in 0..90u64 {
            some.note(model, Some(&model));
        }
        let mut others = Distances::default();
        for apart in 1..=9u64 {
            others.note(100, Some(&(100 - apart)));
        }
        others.note(5, None);
        some.add(&others);
        assert_eq!(some.events(), 100);
        let found = [50, 90, 91, 95, 99, 100].map(|percent| some.percentile(percent));
        assert_eq!(found, [0, 0, 1, 5, 9, u64::MAX]);
        assert_eq!(Distances::default().percentile(95), 0);
    }
}
