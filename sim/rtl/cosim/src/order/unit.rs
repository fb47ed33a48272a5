//! Splats through sorter and binning with a memory: every place of the order and of every list.

use super::loads::{OrderLoad, hard, ordered};
use crate::bench::Bench;
use crate::circuit::ORDER;
use crate::memory::{Memory, MemoryTiming, timing};
use crate::random::{Random, noise};
use crate::scenes::{SCENES, scenes};
use crate::unit::{Circuit, Extent, Findings, Loads, Missing, Simulation, Unit};
use anyhow::{Result, bail, ensure};

/// A memory, and cycles from a splat to the next one at least: at full speed; with pauses; with words that arrive after all that a digit's sums take; and
/// lists without room.
const TIMINGS: [(MemoryTiming, u64); 4] = [
    (timing([20, 0], 16, false), 8),
    (timing([7, 3], 16, false), 1),
    (timing([400, 0], 16, false), 1),
    (timing([20, 0], 16, true), 8),
];

/// Cycles without an access to the memory after which the circuit hangs.
const PATIENCE: u64 = 1 << 17;

/// The unit with digits of some bits.
pub struct OrderUnit(Circuit);

impl OrderUnit {
    /// With digits of so many bits.
    pub fn new(digit: u32) -> Result<OrderUnit> {
        Circuit::new(&ORDER, "lean18", digit).map(OrderUnit)
    }
}

impl Unit for OrderUnit {
    type Load = OrderLoad;

    fn circuit(&self) -> &Circuit {
        &self.0
    }

    fn pressures(&self) -> usize {
        TIMINGS.len()
    }

    fn loads(&self, extent: Extent, missing: &mut Missing) -> Result<Loads<OrderLoad>> {
        let (names, size): (&[_], _) = match extent {
            Extent::Quick => (&["playbot"], 128),
            Extent::Full => (&SCENES, 512),
        };
        let mut loads = hard();
        for seen in scenes(names, size, missing)? {
            let (.., load) = ordered(&seen, &self.0.design, &seen.scene.natural_rules);
            loads.push((seen.name.to_owned(), load));
        }
        Ok(loads)
    }

    fn compare(&self, circuit: Simulation, load: &Self::Load, pressure: usize) -> Result<Findings> {
        let (timing, interval) = TIMINGS[pressure];
        if timing.full && load.entries() == 0 {
            return Ok(Findings::default());
        }
        let room = load.entries() - usize::from(timing.full);
        let mut bench = Bench::new(circuit, 1)?;
        let count = load.splats.len();
        let lists = 7 + 2 * count;
        bench.set(&[
            ("base_a", 3),
            ("base_b", 5 + count as u64),
            ("base_lists", lists as u64),
            ("tile_columns", load.size[0].into()),
            ("tiles", load.lists.len() as u64),
            ("most", room as u64),
        ])?;
        // Bits of nothing in all places of the memory, a word or more between any two regions.
        let (mut words, mut random) = (Vec::new(), Random(1));
        words.resize_with(lists + room.div_ceil(4), || noise(&mut random));
        let mut memory = Memory::new(&bench.circuit, words, timing, 1)?;
        let mut findings = Findings::default();
        // Twice or once: neither what a picture leaves behind nor what registers hold before the first must reach the one that is judged.
        for _ in 0..2 - pressure % 2 {
            findings.cycles = order(&mut bench.circuit, &mut memory, load, interval)?;
        }
        findings.compared = count as u64;
        findings.counts = vec![
            ("entries", bench.circuit.read("entries")?),
            ("words read", memory.read),
            ("words written", memory.written),
        ];
        let mut ends = Vec::new();
        for tile in 0..load.lists.len() {
            bench.set(&[("end_tile", tile as u64)])?;
            memory.cycle(&mut bench.circuit);
            ends.push(bench.circuit.read("end_place")? as usize);
        }
        let full = bench.circuit.read("full")? == 1;
        findings.first_difference = memory.astray(full);
        if findings.first_difference.is_none() && !full {
            let splats = bench.circuit.read("splats")?;
            let sorted = memory
                .words
                .iter()
                .skip(bench.circuit.read("sorted")? as usize);
            let lists = memory.words[lists..].as_flattened();
            let order = order_difference(load, splats, sorted);
            findings.first_difference = order.or_else(|| list_difference(load, lists, &ends));
        }
        Ok(findings)
    }
}

/// Orders a picture; gives the cycles until its lists are written.
fn order(
    circuit: &mut Simulation,
    memory: &mut Memory,
    load: &OrderLoad,
    interval: u64,
) -> Result<u64> {
    let [begins, ends, done] = circuit.ports(["begins", "ends", "done"])?;
    let [valid, ready, word] = circuit.ports(["in_valid", "in_ready", "in"])?;
    circuit.set(ends, 0);
    circuit.set(begins, 1);
    memory.cycle(circuit);
    circuit.set(begins, 0);
    let splats = &load.splats;
    // A circuit that goes on reading and writing hangs as well.
    let limit = PATIENCE + 200 * splats.len() as u64 + 16 * load.entries() as u64;
    let (mut sent, mut next) = (0, 0);
    for cycle in 0..limit {
        let offered = splats.get(sent).filter(|_| cycle >= next);
        circuit.set(valid, offered.is_some().into());
        circuit.set(ends, (sent == splats.len()).into());
        if let Some(splat) = offered {
            circuit.set_words(word, &splat.word());
        }
        memory.settle(circuit);
        if offered.is_some() && circuit.is(ready) {
            (sent, next) = (sent + 1, cycle + interval);
        }
        let ended = circuit.is(done);
        memory.edge(circuit);
        if ended {
            return Ok(cycle + 1);
        }
        ensure!(memory.idle < PATIENCE, "the sorter hangs");
    }
    bail!("the sorter hangs")
}

fn order_difference<'a>(
    load: &OrderLoad,
    splats: u64,
    mut sorted: impl Iterator<Item = &'a [u32; 4]>,
) -> Option<String> {
    let wanted = load.sorted();
    if splats != wanted.len() as u64 {
        return Some(format!("{splats} splats, not {}", wanted.len()));
    }
    let mut wanted = wanted.iter();
    let place = wanted.position(|splat| sorted.next() != Some(&splat.word()))?;
    Some(format!("another splat at place {place} of the order"))
}

fn list_difference(load: &OrderLoad, listed: &[u32], ends: &[usize]) -> Option<String> {
    let mut begin = 0;
    for (tile, (list, end)) in load.lists.iter().zip(ends).enumerate() {
        if listed.get(begin..*end) != Some(list) {
            return Some(format!("another list of tile {tile}"));
        }
        begin = *end;
    }
    None
}
