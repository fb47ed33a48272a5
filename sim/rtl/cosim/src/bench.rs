//! The bench of units that take and give words by valid and ready: random back-pressure at all ends, resets in between,
//! every answer compared.
//!
//! What a unit is given are items (a splat, a tile). An item has offers in several lanes, each taken in order and at
//! its own pace, and a number of answers that must come before the next item's. After a reset the bench begins anew
//! with the first item whose answers have not all come.

use crate::mutation::MutationNumber;
use crate::simulation::{Port, Simulation};
use crate::unit::Findings;
use anyhow::{Result, ensure};
use splatline_sim::scene::synthetic::Random;
use std::path::Path;

/// Cycles for which a new circuit is reset.
const RESET_CYCLES: u64 = 4;

/// Cycles in which answers are taken and none comes, nor anything is taken that is offered, after which the circuit
/// hangs.
const PATIENCE: u64 = 1 << 18;

/// Cycles behind the last answer in which no other may come.
const QUIET: usize = 400;

/// Ports of words that go in or out.
pub(crate) struct Channel {
    pub valid: Port,
    pub ready: Port,
    pub data: Vec<Port>,
}

impl Channel {
    /// The channel with ports `NAME_valid`, `NAME_ready` and these for its words.
    pub fn new(circuit: &Simulation, name: &str, data: &[&str]) -> Channel {
        Channel {
            valid: circuit.port(&format!("{name}_valid")),
            ready: circuit.port(&format!("{name}_ready")),
            data: data.iter().map(|name| circuit.port(name)).collect(),
        }
    }

    /// Is a word handed over in this cycle?
    pub fn moves(&self, circuit: &Simulation) -> bool {
        circuit.is(self.valid) && circuit.is(self.ready)
    }
}

/// A unit's channels.
pub(crate) struct Channels {
    /// Where words are offered.
    pub sources: Vec<Channel>,
    /// Where answers come.
    pub sink: Channel,
    /// An input that lets the unit's inside move, if it has one.
    pub enable: Option<Port>,
}

impl Channels {
    /// By the names of the channels and of their words' ports.
    pub fn new(
        circuit: &Simulation,
        sources: &[(&str, &[&str])],
        (sink, answers): (&str, &[&str]),
    ) -> Channels {
        let sources = sources.iter();
        let sources = sources.map(|(name, data)| Channel::new(circuit, name, data));
        Channels {
            sources: sources.collect(),
            sink: Channel::new(circuit, sink, answers),
            enable: None,
        }
    }
}

/// One of the sources, and the words that are offered there, for each of its ports.
pub(crate) type Offer = (usize, Vec<Vec<u32>>);

/// Offers that belong together, in lanes of one offer or more, and how many answers they have.
pub(crate) struct Item {
    pub lanes: Vec<Vec<Offer>>,
    pub answers: u64,
}

/// What comes next of a lane of the items: an item, one of its offers, and whether it is offered in this cycle.
#[derive(Clone, Default)]
struct Lane {
    item: usize,
    offer: usize,
    valid: bool,
}

/// Back-pressure, in 256ths of the cycles.
pub(crate) struct Pressure {
    /// The next offer of a lane is held back.
    pub offers: [u8; 2],
    /// No answer is taken.
    pub answers: u8,
    /// The unit's inside may not move.
    pub inside: u8,
    /// Of blocks of so many cycles, half take no answer at all; 0 for none.
    pub stalls: u64,
    /// One reset in so many cycles, at random; 0 for none.
    pub resets: u64,
    /// What was offered is taken back in some cycles, and offered again.
    pub retracts: bool,
}

impl Pressure {
    /// At the first lane, at the others and at the sink, with blocks and resets of so many cycles.
    pub const fn new([first, others, answers]: [u8; 3], stalls: u64, resets: u64) -> Pressure {
        Pressure {
            offers: [first, others],
            answers,
            inside: 0,
            stalls,
            resets,
            retracts: true,
        }
    }
}

/// A circuit with its channels.
pub struct Bench {
    /// The circuit.
    pub circuit: Simulation,
    reset: Port,
    /// Cycles since reset.
    pub cycles: u64,
    random: Random,
}

impl Bench {
    /// The circuit in a library after reset; the seed and the mutation are those of [`Simulation::new`].
    pub fn new(library: &Path, seed: u32, mutation: MutationNumber) -> Result<Bench> {
        let circuit = Simulation::new(library, seed, mutation)?;
        let mut bench = Bench {
            reset: circuit.port("rst"),
            circuit,
            cycles: 0,
            random: Random(1),
        };
        bench.circuit.set(bench.reset, 1);
        for _ in 0..RESET_CYCLES {
            bench.cycle();
        }
        bench.circuit.set(bench.reset, 0);
        Ok(bench)
    }

    /// One cycle with the inputs as they are.
    pub fn cycle(&mut self) {
        self.circuit.settle();
        self.circuit.edge();
        self.cycles += 1;
    }

    /// Drives ports by name.
    pub fn set(&mut self, values: &[(&str, u64)]) {
        for (name, value) in values {
            self.circuit.set(self.circuit.port(name), *value);
        }
    }

    /// True in `share` of 256 cases.
    fn chance(&mut self, share: u8) -> bool {
        share > 0 && self.random.next() >> 56 < u64::from(share)
    }

    /// Gives the items to the circuit until the first difference. `check` compares an answer of this number with what
    /// is expected; `observe` looks at the circuit in every cycle, before its edge, and gives a rule that it broke.
    pub(crate) fn run(
        &mut self,
        channels: &Channels,
        items: &[Item],
        pressure: &Pressure,
        mut check: impl FnMut(usize, &[Vec<u32>]) -> Option<String>,
        mut observe: impl FnMut(&Simulation, &Channels, u64) -> Option<String>,
    ) -> Result<Findings> {
        let mut findings = Findings::default();
        let lanes = items.first().map_or(0, |item| item.lanes.len());
        let mut lanes = vec![Lane::default(); lanes];
        let total: u64 = items.iter().map(|item| item.answers).sum();
        let (start, mut idle) = (self.cycles, 0);
        while findings.compared < total {
            let resets = pressure.resets > 0 && self.random.next().is_multiple_of(pressure.resets);
            self.circuit.set(self.reset, resets.into());
            self.drive(channels, items, &mut lanes, pressure);
            let mut difference = observe(&self.circuit, channels, self.cycles);
            idle += u64::from(self.circuit.is(channels.sink.ready));
            if resets {
                findings.count("resets", 1);
                let item;
                (item, findings.compared) = unanswered(items, findings.compared);
                lanes.fill(Lane {
                    item,
                    ..Lane::default()
                });
            } else {
                for (number, lane) in lanes.iter_mut().enumerate().filter(|(_, lane)| lane.valid) {
                    let offers = &items[lane.item].lanes[number];
                    if channels.sources[offers[lane.offer].0].moves(&self.circuit) {
                        (lane.offer, lane.valid, idle) = (lane.offer + 1, false, 0);
                        if lane.offer == offers.len() {
                            (lane.item, lane.offer) = (lane.item + 1, 0);
                        }
                    }
                }
                if channels.sink.moves(&self.circuit) {
                    let ports = channels.sink.data.iter();
                    let answer: Vec<_> = ports.map(|port| self.circuit.words(*port)).collect();
                    difference = difference.or(check(findings.compared as usize, &answer));
                    findings.compared += 1;
                    idle = 0;
                }
            }
            self.circuit.edge();
            self.cycles += 1;
            let answers = findings.compared;
            ensure!(idle < PATIENCE, "the circuit hangs after {answers} answers");
            if difference.is_some() {
                findings.first_difference = difference;
                return Ok(findings);
            }
        }
        findings.cycles = self.cycles - start;
        self.expect_quiet(channels)?;
        Ok(findings)
    }

    /// Offers what is to be offered in this cycle, and lets the outputs follow. What is not offered is noise.
    fn drive(
        &mut self,
        channels: &Channels,
        items: &[Item],
        lanes: &mut [Lane],
        pressure: &Pressure,
    ) {
        for source in &channels.sources {
            self.circuit.set(source.valid, 0);
        }
        for (number, lane) in lanes.iter_mut().enumerate() {
            let Some(item) = items.get(lane.item) else {
                continue;
            };
            let stays = lane.valid && !pressure.retracts;
            lane.valid = stays || !self.chance(pressure.offers[number.min(1)]);
            let (source, data) = &item.lanes[number][lane.offer];
            let source = &channels.sources[*source];
            for (port, words) in source.data.iter().zip(data) {
                if lane.valid {
                    self.circuit.set_words(*port, words);
                } else {
                    let noise = words.iter().map(|_| self.random.next() as u32);
                    let noise: Vec<u32> = noise.collect();
                    self.circuit.set_words(*port, &noise);
                }
            }
            self.circuit.set(source.valid, lane.valid.into());
        }
        let block = self.cycles.checked_div(pressure.stalls);
        let stalls = block.is_some_and(|block| Random(block).next() & 1 == 1);
        let ready = !self.chance(pressure.answers) && !stalls;
        self.circuit.set(channels.sink.ready, ready.into());
        if let Some(enable) = channels.enable {
            let moves = !self.chance(pressure.inside);
            self.circuit.set(enable, moves.into());
        }
        self.circuit.settle();
    }

    fn expect_quiet(&mut self, channels: &Channels) -> Result<()> {
        self.circuit.set(self.reset, 0);
        for source in &channels.sources {
            self.circuit.set(source.valid, 0);
        }
        self.circuit.set(channels.sink.ready, 1);
        for _ in 0..QUIET {
            self.cycle();
            ensure!(!self.circuit.is(channels.sink.valid), "an answer too many");
        }
        Ok(())
    }
}

/// The first item of which not all answers are among so many, and the number of those before it.
fn unanswered(items: &[Item], answers: u64) -> (usize, u64) {
    let (mut item, mut before) = (0, 0);
    while before + items[item].answers <= answers {
        before += items[item].answers;
        item += 1;
    }
    (item, before)
}
