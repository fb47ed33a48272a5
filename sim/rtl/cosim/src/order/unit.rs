//! Splats through sorter and binning with a memory: every place of the order and of every list.

use super::loads::{OrderLoad, SortedSplat, hard, ordered};
use crate::bench::Bench;
use crate::circuit::{Circuit, ORDER};
use crate::findings::Findings;
use crate::memory::{Memory, MemoryTiming};
use crate::random::split_mix;
use crate::scenes::{SCENES, scenes};
use crate::simulation::Simulation;
use crate::unit::{Extent, Unit};
use anyhow::{Result, ensure};
use splatline_sim::design::DesignChoice;

/// How memory and feeder behave.
#[derive(Clone, Copy, Debug)]
struct OrderTiming {
    memory: MemoryTiming,
    /// Cycles from a splat to the next one at least.
    interval: u64,
    /// Is there no room for the last entry of the lists?
    full: bool,
}

/// At full speed; with pauses; with words that arrive after all that a digit's sums take; and lists without room.
const TIMINGS: [OrderTiming; 4] = [
    timing(20, 0, 8, false),
    timing(7, 3, 1, false),
    timing(400, 0, 1, false),
    timing(20, 0, 8, true),
];

const fn timing(latency: u64, pauses: u64, interval: u64, full: bool) -> OrderTiming {
    OrderTiming {
        memory: MemoryTiming {
            latency,
            pauses,
            bytes: 16,
        },
        interval,
        full,
    }
}

/// Cycles without an access to the memory after which the circuit hangs.
const PATIENCE: u64 = 1 << 17;

/// The unit with digits of some bits.
pub struct OrderUnit {
    circuit: Circuit,
}

impl OrderUnit {
    /// With digits of so many bits.
    pub fn new(digit: u32) -> Result<OrderUnit> {
        let circuit = Circuit::new(&ORDER, "lean18", digit)?;
        Ok(OrderUnit { circuit })
    }
}

impl Unit for OrderUnit {
    type Load = OrderLoad;
    const COUNTS: &'static [&'static str] = &["entries", "words read", "words written"];
    const PRESSURES: usize = TIMINGS.len();

    fn circuit(&self) -> &Circuit {
        &self.circuit
    }

    fn loads(&self, extent: Extent, missing: &mut Vec<&'static str>) -> Result<Vec<OrderLoad>> {
        let (names, size): (&[_], _) = match extent {
            Extent::Quick => (&["playbot"], 128),
            Extent::Full => (&SCENES, 512),
        };
        let design = DesignChoice::load("lean18")?;
        let mut loads = hard();
        for seen in scenes(names, size, missing)? {
            loads.push(ordered(&seen, &design).1);
        }
        Ok(loads)
    }

    fn name(&self, load: &OrderLoad) -> String {
        load.name.clone()
    }

    fn compare(&self, circuit: Simulation, load: &OrderLoad, pressure: usize) -> Result<Findings> {
        let timing = TIMINGS[pressure];
        let room = load.entries();
        if timing.full && room == 0 {
            return Ok(Findings::default());
        }
        OrderRun::new(circuit, load, timing, room - usize::from(timing.full))?.compare()
    }
}

/// A picture in the making.
struct OrderRun<'a> {
    bench: Bench,
    memory: Memory,
    load: &'a OrderLoad,
    timing: OrderTiming,
    /// Word at which the lists begin.
    lists: usize,
}

impl OrderRun<'_> {
    /// Bits of nothing in all places of the memory, a word or more between any two regions.
    fn new(
        circuit: Simulation,
        load: &OrderLoad,
        timing: OrderTiming,
        room: usize,
    ) -> Result<OrderRun<'_>> {
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
        let mut state = 1;
        let noise =
            (0..lists + room.div_ceil(4)).map(|_| [(); 4].map(|()| split_mix(&mut state) as u32));
        let memory = Memory::new(&bench.circuit, noise.collect(), timing.memory, 1)?;
        Ok(OrderRun {
            bench,
            memory,
            load,
            timing,
            lists,
        })
    }

    /// Twice: what a picture leaves behind must not reach the next one.
    fn compare(mut self) -> Result<Findings> {
        let mut findings = Findings::default();
        for _ in 0..2 {
            findings.cycles = self.picture()?;
        }
        findings.count("words read", self.memory.read);
        findings.count("words written", self.memory.written);
        let mut ends = Vec::new();
        for tile in 0..self.load.lists.len() {
            self.bench.set(&[("end_tile", tile as u64)])?;
            self.memory.cycle(&mut self.bench.circuit);
            ends.push(self.read("end_place")? as usize);
        }
        let full = self.read("full")? == 1;
        findings.count("entries", self.read("entries")?);
        findings.compared = self.load.splats.len() as u64;
        findings.first_difference = if self.memory.beyond > 0 || full != self.timing.full {
            Some(format!(
                "{} accesses astray, full: {full}",
                self.memory.beyond
            ))
        } else if full {
            None
        } else {
            self.difference(self.read("sorted")? as usize, self.read("splats")?, &ends)
        };
        Ok(findings)
    }

    /// Gives the cycles until the lists are written.
    fn picture(&mut self) -> Result<u64> {
        let Bench { circuit, .. } = &mut self.bench;
        let port = |circuit: &Simulation, name| circuit.port(name);
        let [begins, ends, done] = ["begins", "ends", "done"].map(|name| port(circuit, name));
        let [valid, ready, word] = ["in_valid", "in_ready", "in"].map(|name| port(circuit, name));
        let (begins, ends, done, valid, ready, word) =
            (begins?, ends?, done?, valid?, ready?, word?);
        circuit.set(ends, 0);
        circuit.set(begins, 1);
        self.memory.cycle(circuit);
        circuit.set(begins, 0);
        let splats = &self.load.splats;
        // A circuit that goes on reading and writing hangs as well.
        let limit = PATIENCE + 200 * splats.len() as u64 + 16 * self.load.entries() as u64;
        let (mut taken, mut next, mut idle) = (0, 0, 0);
        for cycle in 0.. {
            let offered = splats.get(taken).filter(|_| cycle >= next);
            circuit.set(valid, offered.is_some().into());
            circuit.set(ends, (taken == splats.len()).into());
            if let Some(splat) = offered {
                circuit.set_words(word, &splat.word());
            }
            let moved = self.memory.read + self.memory.written;
            self.memory.settle(circuit);
            let goes = offered.is_some() && circuit.is(ready);
            let ended = circuit.is(done);
            self.memory.edge(circuit);
            if goes {
                (taken, next) = (taken + 1, cycle + self.timing.interval);
            }
            if ended {
                return Ok(cycle + 1);
            }
            idle += 1;
            if goes || self.memory.read + self.memory.written != moved {
                idle = 0;
            }
            ensure!(idle < PATIENCE && cycle < limit, "the sorter hangs");
        }
        unreachable!("the loop has no end")
    }

    fn read(&self, name: &str) -> Result<u64> {
        let circuit = &self.bench.circuit;
        Ok(circuit.get(circuit.port(name)?))
    }

    fn difference(&self, sorted: usize, splats: u64, ends: &[usize]) -> Option<String> {
        let wanted = self.load.sorted();
        if splats != wanted.len() as u64 {
            return Some(format!("{splats} splats, not {}", wanted.len()));
        }
        let words = self.memory.words.iter().skip(sorted);
        let differs = |(word, splat): (&[u32; 4], &SortedSplat)| *word != splat.word();
        if let Some(place) = words.zip(&wanted).position(differs) {
            return Some(format!("another splat at place {place} of the order"));
        }
        let listed = self.memory.words[self.lists..].as_flattened();
        let mut begin = 0;
        for (tile, (list, end)) in self.load.lists.iter().zip(ends).enumerate() {
            if listed.get(begin..*end) != Some(list) {
                return Some(format!("another list of tile {tile}"));
            }
            begin = *end;
        }
        None
    }
}
