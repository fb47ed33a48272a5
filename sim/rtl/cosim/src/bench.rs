//! The bench of units that take and give words by valid and ready: random back-pressure at all ends, resets in between, every answer compared.
//!
//! What a unit is given are items (a splat, a tile). An item has offers in several lanes, each taken in order and at its own pace, and a number of answers that
//! must come before the next item's. After a reset the bench begins anew with the first item whose answers have not all come.

use crate::random::Random;
use crate::simulation::Port;
use crate::unit::{Findings, Simulation};
use anyhow::{Result, ensure};

/// Cycles for which a new circuit is reset.
const RESET_CYCLES: u64 = 4;

/// Cycles in which answers are taken and none comes, nor anything is taken that is offered, after which the circuit hangs.
const PATIENCE: u64 = 1 << 18;

/// Cycles behind the last answer in which no other may come.
const QUIET: usize = 400;

/// Ports of words that go in or out.
#[derive(Clone, Debug)]
pub(crate) struct Channel {
    pub valid: Port,
    pub ready: Port,
    pub data: Vec<Port>,
}

impl Channel {
    /// The channel with ports `NAME_valid`, `NAME_ready` and these for its words.
    pub fn new(circuit: &Simulation, name: &str, data: &[&str]) -> Result<Channel> {
        let [valid, ready] = ["valid", "ready"].map(|end| format!("{name}_{end}"));
        let data = data.iter().map(|name| circuit.port(name));
        Ok(Channel {
            valid: circuit.port(&valid)?,
            ready: circuit.port(&ready)?,
            data: data.collect::<Result<_>>()?,
        })
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

/// One of the sources, and the words that are offered there, for each of its ports.
pub(crate) type Offer = (usize, Vec<Vec<u32>>);

/// Offers that belong together, in lanes, and how many answers they have.
#[derive(Clone, Debug)]
pub(crate) struct Item {
    pub lanes: Vec<Vec<Offer>>,
    pub answers: usize,
}

/// Back-pressure, in 256ths of the cycles.
#[derive(Clone, Copy, Debug)]
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
    /// At the first lane, at the others, and at the sink.
    pub const fn at_ends([first, others, answers]: [u8; 3]) -> Pressure {
        Pressure {
            offers: [first, others],
            answers,
            inside: 0,
            stalls: 0,
            resets: 0,
            retracts: true,
        }
    }
}

/// What compares the answers.
pub(crate) trait Checker {
    /// The difference of the next answer from what is expected, in words.
    fn check(&mut self, number: usize, answer: &[Vec<u32>]) -> Option<String>;

    /// Looks at the circuit in every cycle, before its edge; gives a rule that it broke, in words.
    fn observe(&mut self, _circuit: &Simulation, _cycle: u64) -> Option<String> {
        None
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
    /// The circuit after reset.
    pub fn new(circuit: Simulation, seed: u64) -> Result<Bench> {
        let mut bench = Bench {
            reset: circuit.port("rst")?,
            circuit,
            cycles: 0,
            random: Random(seed),
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
    pub fn set(&mut self, values: &[(&str, u64)]) -> Result<()> {
        for (name, value) in values {
            let port = self.circuit.port(name)?;
            self.circuit.set(port, *value);
        }
        Ok(())
    }

    /// True in `share` of 256 cases.
    fn chance(&mut self, share: u8) -> bool {
        share > 0 && self.random.next() >> 56 < u64::from(share)
    }

    /// Gives the items to the circuit and compares what comes until the first difference.
    pub(crate) fn run(
        &mut self,
        channels: &Channels,
        items: &[Item],
        pressure: &Pressure,
        checker: &mut impl Checker,
    ) -> Result<Findings> {
        let mut findings = Findings::default();
        let mut feeder = Feeder::new(items);
        let (start, mut idle) = (self.cycles, 0);
        while findings.compared < feeder.total() {
            let resets = pressure.resets > 0 && self.random.next().is_multiple_of(pressure.resets);
            self.circuit.set(self.reset, resets.into());
            self.drive(channels, &mut feeder, pressure);
            let mut difference = checker.observe(&self.circuit, self.cycles);
            idle += u64::from(self.circuit.is(channels.sink.ready));
            if resets {
                findings.count("resets", 1);
                findings.compared = feeder.restart(findings.compared);
            } else {
                for lane in &mut feeder.lanes {
                    let offer = lane.offers.get(lane.next).filter(|_| lane.valid);
                    let source = offer.map(|(_, (source, _))| &channels.sources[*source]);
                    if source.is_some_and(|source| source.moves(&self.circuit)) {
                        (lane.next, lane.valid) = (lane.next + 1, false);
                        idle = 0;
                    }
                }
                if channels.sink.moves(&self.circuit) {
                    let ports = channels.sink.data.iter();
                    let answer: Vec<_> = ports.map(|port| self.circuit.words(*port)).collect();
                    let other = checker.check(findings.compared as usize, &answer);
                    difference = difference.or(other);
                    findings.compared += 1;
                    idle = 0;
                }
            }
            self.circuit.edge();
            self.cycles += 1;
            ensure!(
                idle < PATIENCE,
                "the circuit hangs after {} answers",
                findings.compared
            );
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
    fn drive(&mut self, channels: &Channels, feeder: &mut Feeder, pressure: &Pressure) {
        for source in &channels.sources {
            self.circuit.set(source.valid, 0);
        }
        for (number, lane) in feeder.lanes.iter_mut().enumerate() {
            let share = pressure.offers[number.min(1)];
            let stays = lane.valid && !pressure.retracts;
            let next = lane.offers.get(lane.next);
            lane.valid = next.is_some() && (stays || !self.chance(share));
            let Some((_, (source, data))) = next else {
                continue;
            };
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

/// What is left of the items.
struct Feeder<'a> {
    lanes: Vec<Lane<'a>>,
    /// Answers of each item and all before it.
    answers: Vec<u64>,
}

struct Lane<'a> {
    /// All offers, each with its item's number.
    offers: Vec<(usize, &'a Offer)>,
    /// The next one, and whether it is offered in this cycle.
    next: usize,
    valid: bool,
}

impl<'a> Feeder<'a> {
    fn new(items: &'a [Item]) -> Feeder<'a> {
        let count = items.first().map_or(0, |item| item.lanes.len());
        let lane = |number: usize| {
            let of_item = |(index, item): (usize, &'a Item)| {
                let offers = item.lanes[number].iter();
                offers.map(move |offer| (index, offer))
            };
            Lane {
                offers: items.iter().enumerate().flat_map(of_item).collect(),
                next: 0,
                valid: false,
            }
        };
        let answers = items.iter().scan(0, |sum, item| {
            *sum += item.answers as u64;
            Some(*sum)
        });
        Feeder {
            lanes: (0..count).map(lane).collect(),
            answers: answers.collect(),
        }
    }

    /// How many answers there are.
    fn total(&self) -> u64 {
        self.answers.last().copied().unwrap_or(0)
    }

    /// Begins anew with the item whose answers were coming, so many in all; gives the number of those before it.
    fn restart(&mut self, compared: u64) -> u64 {
        let item = self.answers.partition_point(|last| *last <= compared);
        for lane in &mut self.lanes {
            lane.next = lane.offers.partition_point(|(other, _)| *other < item);
            lane.valid = false;
        }
        item.checked_sub(1).map_or(0, |before| self.answers[before])
    }
}
