//! In which cycle every handshake inside the circuit took place, and whether the machine's clock says the same, splat
//! by splat.

use super::workload::{BenchTile, BenchWorkload};
use crate::bench::Channel;
use crate::circuit::Circuit;
use crate::simulation::Simulation;
use splatline_sim::machine::primitive::{Intervals, LaneRun, PrimitiveClock, QUEUE, for_each_slot};

/// Lanes that a circuit may have.
const MOST_LANES: usize = 16;

/// Cycles of a tile's handshakes, in the order in which they took place.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Stamps {
    /// From which cycle on each packet was offered.
    pub offered: Vec<u64>,
    /// Each packet's handshake.
    pub accepted: Vec<u64>,
    /// The row generator takes each splat over from setup.
    pub begun: Vec<u64>,
    /// Each run leaves the row generator.
    pub left: Vec<u64>,
    /// Each run is popped from the queue of its lane.
    pub popped: [Vec<u64>; MOST_LANES],
    /// The last packet's last pixel has left its lane.
    pub idle_at: Option<u64>,
}

/// The ports that show what happens inside: lanes that pop a run, a bit for each; a splat begun, a run left, and an
/// idle raster.
const INSIDE: [&str; 4] = ["lanes_popped", "splat_begun", "run_left", "raster_idle"];

impl Stamps {
    /// Notes what the channel of packets and the ports of [`INSIDE`] say in a cycle, for a tile of so many packets.
    pub fn note(&mut self, circuit: &Simulation, packet: &Channel, now: u64, packets: usize) {
        let [mut lanes, begun, left, idle] = INSIDE.map(|name| circuit.read(name));
        if self.accepted.len() == packets && idle == 1 {
            self.idle_at.get_or_insert(now);
        }
        if circuit.is(packet.valid) && self.offered.len() == self.accepted.len() {
            self.offered.push(now);
        }
        for (happens, stamps) in [
            (packet.moves(circuit), &mut self.accepted),
            (begun == 1, &mut self.begun),
            (left == 1, &mut self.left),
        ] {
            if happens {
                stamps.push(now);
            }
        }
        while lanes != 0 {
            self.popped[lanes.trailing_zeros() as usize].push(now);
            lanes &= lanes - 1;
        }
    }

    /// Cycles from the first packet's handshake to the last packet's last pixel; 0 without packets.
    pub fn raster_cycles(&self) -> u64 {
        let ends = self.accepted.first().zip(self.idle_at);
        ends.map_or(0, |(first, last)| last - first)
    }

    /// The first handshake in another cycle than the machine's clock says, to which the same packets are offered in the
    /// same cycles.
    pub fn difference(
        &self,
        circuit: &Circuit,
        tile: &BenchTile,
        workload: &BenchWorkload,
    ) -> Option<String> {
        let mut difference = None;
        let mut check = |splat: usize, what: &str, model: u64, found: Option<&u64>| {
            if difference.is_none() && found != Some(&model) {
                let found = found.map_or("never".to_owned(), |cycle| format!("in cycle {cycle}"));
                difference = Some(format!(
                    "splat {splat}: {what} in cycle {model} by the model, {found} by the circuit"
                ));
            }
        };
        // The first packet is offered before its tile has begun; time is counted from its handshake, and with it the
        // turns of setup.
        let first = self.accepted.first().copied().unwrap_or(0);
        let [lanes, setup, rows] = ["LANES", "SETUP_INTERVAL", "ROW_INTERVAL"]
            .map(|name| circuit.parameter(name).unwrap_or(1));
        let (design, lanes) = (circuit.design.in_fields(), lanes as usize);
        let mut clock = PrimitiveClock::new(lanes, QUEUE, Intervals { setup, rows }, first);
        let mut left = self.left.iter();
        let mut popped = self.popped.each_ref().map(|lane| lane.iter());
        for (place, index) in tile.list.iter().enumerate() {
            let footprint = &workload.footprints[*index as usize];
            let offered = self.offered.get(place).copied().unwrap_or(0);
            let stamp = clock.packet(offered.max(first));
            let accepted = self.accepted.get(place);
            check(place, "packet taken", stamp.accepted, accepted);
            check(place, "rows begun", stamp.begun, self.begun.get(place));
            for_each_slot(design, footprint, &tile.window, lanes, |run| {
                let slot = clock.slot(run);
                if let (Some(LaneRun { lane, .. }), Some(cycle)) = (run, slot.popped) {
                    check(place, "run left the rows", slot.left, left.next());
                    check(place, "run popped", cycle, popped[lane].next());
                }
            });
        }
        let last = tile.list.len().saturating_sub(1);
        if !tile.list.is_empty() {
            check(last, "last pixel", clock.idle_at(), self.idle_at.as_ref());
        }
        check(last, "runs left over", 0, Some(&(left.len() as u64)));
        difference
    }
}
