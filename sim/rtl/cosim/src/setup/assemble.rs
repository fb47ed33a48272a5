//! From a list of sums to a microprogram: every operation gets its slots in a round of fixed length, and its result a
//! register.
//!
//! The cores of `setup_unit.sv` have one issue slot a cycle and a pipeline of [`LATENCY`] cycles. A splat's operations
//! depend on each other over many such latencies, so a round starts the next splats long before the last ones are done:
//! slot t of the list is issued in cycle t modulo the round's length, for the splats that came t / length rounds before
//! (modulo scheduling). Nothing branches; a culled splat runs through.
//!
//! A result has as many registers in a row as rounds pass until its last reader, and splats take them in turn. So a
//! register is written again only by a slot that is issued after the old value's last reader, and the sequencer may
//! pause between any two rounds.
//!
//! Results leave by the second factor's port in slots that have no use for it, so that they take no slots of their own.

use anyhow::{Context, Result, ensure};
use splatline_sim::scene::synthetic::Random;
use std::collections::BTreeMap;

/// Constants of a picture.
const CONSTANTS: usize = 64;

/// Cycles that a round may have.
const CYCLES: usize = 256;

/// Orders of the operations that are tried for a round.
const ATTEMPTS: u64 = 4_000;

/// Cycles from the issue of a sum's last term until its result can be read.
pub const LATENCY: usize = 22;

/// Registers of a core.
const REGISTERS: usize = 256;

/// Rounds that a splat may take: as many splats of one core are in flight.
const ROUNDS: usize = 16;

/// So many cycles before a round ends the next splats' records may begin to come in.
pub const LOAD_AHEAD: usize = 48;

/// So many cycles after a splat's last result its round goes on at least.
const OUT_AHEAD: usize = 4;

/// Words of a splat that leave the core at most: two of them at a time, and beside these the direction's.
const WORDS: usize = 24;

/// The first word of the direction.
const DIRECTION: usize = 16;

/// An operation's number; also its result's name.
pub type Value = usize;

/// Where a term takes a factor from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Operand {
    #[default]
    None,
    /// A result.
    Value(Value),
    /// An item of the record; only as first factor.
    Input(u8),
    /// The slot's constant, which is the same for all splats of a picture.
    Constant,
}

/// Fields of a slot that are not 0, by their names in `setup_types.svh`.
pub type Fields = BTreeMap<&'static str, i64>;

/// One slot: a product, or one number, added to a sum.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Term {
    pub a: Operand,
    pub b: Operand,
    /// What is taken without the flag of rules or view: a constant as first factor, or a result instead of a product
    /// with a constant, which is then not rounded to less than 31 bits.
    pub other: Operand,
    /// What does not depend on where operations stand, the constant's address among it.
    pub fields: Fields,
}

/// A sum of terms, and where it stands.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Operation {
    pub name: String,
    /// One slot each, in a row.
    pub terms: Vec<Term>,
    /// Goes on with the sum of the operation before, right behind it.
    pub follows: bool,
    /// Cycle of its first slot after the round in which its splat began.
    pub time: usize,
    /// First register of its result.
    pub register: usize,
    /// Registers that splats take in turn: a power of two.
    pub copies: usize,
}

/// A result that leaves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Exit {
    /// Cycle after the round in which its splat began.
    pub time: usize,
    pub value: Value,
    /// As this word.
    pub word: usize,
}

/// A program with places.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Program {
    pub operations: Vec<Operation>,
    /// All in one round, in their order.
    pub exits: Vec<Exit>,
    /// Cycles of a round.
    pub round: usize,
    /// In the order of their addresses.
    pub constants: Vec<String>,
}

impl Program {
    /// The shortest round that holds the operations, of which these are the results, and in it what ends first.
    pub fn new(
        operations: Vec<Operation>,
        results: &[(usize, Value)],
        constants: Vec<String>,
    ) -> Result<Program> {
        ensure!(constants.len() <= CONSTANTS, "there are too many constants");
        let fits = |(word, _): &(usize, Value)| *word < WORDS;
        ensure!(results.iter().all(fits), "there are too many results");
        let slots: usize = operations.iter().map(|o| o.terms.len()).sum();
        let mut program = Program {
            operations,
            exits: Vec::new(),
            round: 0,
            constants,
        };
        let found = (slots..=CYCLES).find_map(|round| {
            let placed = (0..ATTEMPTS).filter_map(|seed| {
                program.place(round, seed, results)?;
                Some((program.latency(), seed))
            });
            Some((round, placed.min()?.1))
        });
        let placed = found.and_then(|(round, seed)| program.place(round, seed, results));
        placed.context("no round holds the operations")?;
        Ok(program)
    }

    /// Cycles from a splat's first slot to that of its last result.
    pub fn latency(&self) -> usize {
        self.exits.last().map_or(0, |exit| exit.time)
    }

    /// Does a direction leave beside the words of the packet?
    pub fn directs(&self) -> bool {
        self.exits.iter().any(|exit| exit.word >= DIRECTION)
    }

    /// Places the operations in a round of so many cycles, of which these are the results; nothing if it is too short.
    fn place(&mut self, round: usize, seed: u64, results: &[(usize, Value)]) -> Option<()> {
        self.round = round;
        let times = schedule(&self.operations, round, seed)?;
        for (operation, time) in self.operations.iter_mut().zip(times) {
            (operation.time, operation.copies) = (time, 1);
        }
        self.exits = self.leaving(results)?;
        self.take_registers()
    }

    /// The operation and the term of every cycle of a round.
    pub fn slots(&self) -> Vec<Option<(usize, usize)>> {
        let mut slots = vec![None; self.round];
        for (index, operation) in self.operations.iter().enumerate() {
            for term in 0..operation.terms.len() {
                slots[operation.time % self.round + term] = Some((index, term));
            }
        }
        slots
    }

    /// When the results leave, all of them in one round: as soon as they are ready, in slots that spare the second
    /// factor, before that round ends.
    fn leaving(&self, results: &[(usize, Value)]) -> Option<Vec<Exit>> {
        let ready = |(word, value): &(usize, Value)| Exit {
            time: self.operations[*value].last_slot() + LATENCY,
            value: *value,
            word: *word,
        };
        let mut ready: Vec<Exit> = results.iter().map(ready).collect();
        ready.sort_by_key(|exit| exit.time);
        let first = ready.last()?.time / self.round;
        let spares = |slot: Option<(usize, usize)>| {
            slot.is_none_or(|(index, term)| spares_second(&self.operations[index].terms[term]))
        };
        let slots = self.slots();
        (first..ROUNDS).find_map(|round| {
            let free = (0..self.round - OUT_AHEAD).filter(|cycle| spares(slots[*cycle]));
            let mut free = free.map(|cycle| round * self.round + cycle);
            let mut exits = ready.clone();
            for exit in &mut exits {
                exit.time = free.find(|time| *time >= exit.time)?;
            }
            Some(exits)
        })
    }

    /// Registers for every result; nothing if there are too few.
    fn take_registers(&mut self) -> Option<()> {
        let reads = self.operations.iter().flat_map(|operation| {
            let last = operation.last_slot();
            operation.reads().map(move |value| (value, last))
        });
        let exits = self.exits.iter().map(|exit| (exit.value, exit.time));
        let reads: Vec<(Value, usize)> = reads.chain(exits).collect();
        for (value, until) in reads {
            let operation = &mut self.operations[value];
            let rounds = (until - operation.last_slot()).div_ceil(self.round);
            operation.copies = rounds.next_power_of_two().max(operation.copies);
        }
        let mut order: Vec<&mut Operation> = self.operations.iter_mut().collect();
        // The widest first, so that all stand at a multiple of their width.
        order.sort_by_key(|operation| REGISTERS - operation.copies);
        let mut free = 0;
        for operation in order {
            operation.register = free;
            free += operation.copies;
        }
        (free <= REGISTERS).then_some(())
    }
}

impl Operation {
    /// The results that it reads.
    fn reads(&self) -> impl Iterator<Item = Value> {
        let terms = self.terms.iter();
        let factors = terms.flat_map(|term| [term.a, term.b, term.other]);
        factors.filter_map(|factor| match factor {
            Operand::Value(value) => Some(value),
            _ => None,
        })
    }

    fn reads_input(&self) -> bool {
        let mut terms = self.terms.iter();
        terms.any(|term| matches!(term.a, Operand::Input(_)))
    }

    fn last_slot(&self) -> usize {
        self.time + self.terms.len() - 1
    }
}

/// Cycles of every operation's first slot; nothing if the round is too short.
///
/// What has the most behind it comes first; the seed stirs that order by a latency, since not every order fills a round
/// without gaps.
fn schedule(operations: &[Operation], round: usize, seed: u64) -> Option<Vec<usize>> {
    let mut random = Random(seed);
    let mut stir = vec![0; operations.len()];
    if seed > 0 {
        stir.fill_with(|| random.next() as usize % (LATENCY << (seed % 4)));
    }
    // Cycles from an operation's issue to the end of everything that follows from it.
    let mut rest = vec![0; operations.len()];
    for (index, operation) in operations.iter().enumerate().rev() {
        let length = rest[index] + operation.terms.len() - 1 + LATENCY;
        let before = operation.follows.then(|| index - 1);
        for value in operation.reads().chain(before) {
            rest[value] = rest[value].max(length);
        }
    }
    let mut taken = vec![false; round];
    let mut times: Vec<Option<usize>> = vec![None; operations.len()];
    while times.contains(&None) {
        // From which cycle on all that an operation reads can be read, if all of it has its time.
        let ready = |index: usize| {
            let end = |value: Value| Some(times[value]? + operations[value].terms.len() - 1);
            let mut ends = operations[index].reads().map(end);
            ends.try_fold(0, |ready, end| Some(ready.max(end? + LATENCY)))
        };
        let can = (0..operations.len())
            .filter(|index| times[*index].is_none() && !operations[*index].follows)
            .filter_map(|index| Some((index, ready(index)?)));
        let (first, ready) = can.min_by_key(|(index, _)| {
            let input = !operations[*index].reads_input();
            (input, usize::MAX - rest[*index] - stir[*index], *index)
        })?;
        let behind = operations[first + 1..].iter();
        let last = first + behind.take_while(|operation| operation.follows).count();
        let length: usize = operations[first..=last].iter().map(|o| o.terms.len()).sum();
        let fits = |time: &usize| {
            let slot = time % round;
            slot + length <= round && !taken[slot..slot + length].contains(&true)
        };
        let time = (ready..ready + round).find(fits)?;
        if operations[first].reads_input() && time + length + LOAD_AHEAD > round
            || time / round >= ROUNDS
        {
            return None;
        }
        taken[time % round..time % round + length].fill(true);
        let mut next = time;
        for index in first..=last {
            times[index] = Some(next);
            next += operations[index].terms.len();
        }
    }
    times.into_iter().collect()
}

/// Has a slot no use for a register as second factor?
fn spares_second(term: &Term) -> bool {
    let used = [term.b, term.other].map(|factor| matches!(factor, Operand::Value(_)));
    used == [false; 2] && !term.fields.contains_key("pick")
}
