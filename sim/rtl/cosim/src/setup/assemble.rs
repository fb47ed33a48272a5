//! From a list of sums to a microprogram: every operation gets its slots in a round of fixed length, and its result a register.
//!
//! The cores of `setup_unit.sv` have one issue slot a cycle and a pipeline of [`LATENCY`] cycles. A splat's operations depend on each other over
//! many such latencies, so a round starts the next splats long before the last ones are done: slot t of the list is issued in cycle t modulo the
//! round's length, for the splats that came t / length rounds before (modulo scheduling). Nothing branches; a culled splat runs through.
//!
//! A result has as many registers in a row as rounds pass until its last reader, and splats take them in turn. So a register is written again only
//! by a slot that is issued after the old value's last reader, and the sequencer may pause between any two rounds.
//!
//! Results leave by the second factor's port in slots that have no use for it, so that they take no slots of their own.

use crate::random::split_mix;
use anyhow::{Context, Result, ensure};

/// Cycles from the issue of a sum's last term until its result can be read.
pub const LATENCY: usize = 24;

/// Registers of a core.
pub const REGISTERS: usize = 256;

/// Constants of a picture.
pub const CONSTANTS: usize = 64;

/// Rounds that a splat may take: as many splats of one core are in flight.
pub const ROUNDS: usize = 16;

/// Cycles that a round may have.
const CYCLES: usize = 256;

/// Orders of the operations that are tried before the round is made a cycle longer.
const ATTEMPTS: u64 = 4_000;

/// So many cycles before a round ends the next splats' records may begin to come in.
pub const LOAD_AHEAD: usize = 48;

/// Results of a splat that leave the core at most.
pub const RESULTS: usize = 16;

/// So many cycles after a splat's last result its round goes on at least.
const OUT_AHEAD: usize = 4;

/// An operation's number; also its result's name.
pub type Value = usize;

/// Where a term takes a factor from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Operand {
    /// Nowhere.
    #[default]
    None,
    /// A result.
    Value(Value),
    /// An item of the record; only as first factor.
    Input(u8),
    /// The number at this address, which is the same for all splats of a picture.
    Constant(usize),
}

/// The core's table that gives a term.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Table {
    /// None.
    #[default]
    None,
    /// 1/x.
    Reciprocal,
    /// sqrt(x).
    Root,
    /// 1/middle and ln(middle).
    Logarithm,
}

/// What a plain term's value is, if not its first factor.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Pick {
    /// The first factor.
    #[default]
    None,
    /// The slot's constant where the first factor is negative, otherwise the second.
    Negative,
    /// The constant where it is not negative, otherwise the second.
    NotNegative,
}

/// One slot: a product, or one number, added to a sum.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Term {
    /// First factor.
    pub a: Operand,
    /// Second factor.
    pub b: Operand,
    /// The constant that is picked by the sign.
    pub picked: Option<usize>,
    /// The rules' or the view's flag without which `other` is taken.
    pub flag: Option<u8>,
    /// A constant as first factor, or a result instead of a product with a constant, which is then not rounded to
    /// less than 31 bits.
    pub other: Operand,
    /// The term is `a`, not the product.
    pub plain: bool,
    /// Twice as much.
    pub doubled: bool,
    /// Negated before it is aligned.
    pub before: bool,
    /// Negated after it is aligned.
    pub after: bool,
    /// Rounded down, not to nearest.
    pub floor: bool,
    /// The sum so far goes on in a unit coarser by the difference's low part, which this term gives.
    pub again: bool,
    /// Table of which `a` is the argument.
    pub table: Table,
    /// The table's entry itself; otherwise its step times the argument's rest.
    pub entry: bool,
    /// The position of a's leading bit instead of a.
    pub power: bool,
    /// Which value.
    pub pick: Pick,
}

/// Where a sum's last bit lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// So many bits below the end of the largest term's format; at most four terms, of normalised factors.
    Below(i32),
    /// So many powers above the first term's exponent.
    First(i32),
    /// There.
    At(i32),
}

/// A sum of terms.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Operation {
    /// What it is.
    pub name: String,
    /// One slot each, in a row.
    pub terms: Vec<Term>,
    /// Unit.
    pub unit: Unit,
    /// A constant in that unit, added.
    pub addend: Option<usize>,
    /// Rounded to a mantissa of so many bits, otherwise a word of the sum.
    pub bits: Option<u32>,
    /// Bits of the sum below the word.
    pub below: u32,
    /// The word has all bits above these, where others have their exponent.
    pub long: bool,
    /// Goes on with the sum of the operation before, right behind it.
    pub follows: bool,
}

/// Where an operation stands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Place {
    /// Cycle of its first slot after the round in which its splat began.
    pub time: usize,
    /// First register of its result.
    pub register: usize,
    /// Registers that splats take in turn: a power of two.
    pub copies: usize,
}

/// When a splat's results leave.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Exits {
    /// Rounds after the splat's first one.
    pub round: usize,
    /// Cycle in that round and value of every result.
    pub results: Vec<(usize, Value)>,
}

impl Exits {
    /// The cycle after which all are out.
    pub fn last(&self) -> usize {
        let cycles = self.results.iter().map(|(cycle, _)| *cycle);
        cycles.max().unwrap_or(0)
    }
}

/// A program with places.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Program {
    /// The operations.
    pub operations: Vec<Operation>,
    /// Their places.
    pub places: Vec<Place>,
    /// When the results leave.
    pub exits: Exits,
    /// Cycles of a round.
    pub round: usize,
    /// Constants in the order of their addresses.
    pub constants: Vec<String>,
}

impl Program {
    /// The shortest round that holds the operations, of which these are the results.
    pub fn new(
        operations: Vec<Operation>,
        results: &[Value],
        constants: Vec<String>,
    ) -> Result<Program> {
        ensure!(constants.len() <= CONSTANTS, "there are too many constants");
        ensure!(results.len() <= RESULTS, "there are too many results");
        let slots: usize = operations.iter().map(|o| o.terms.len()).sum();
        let found = (slots..=CYCLES).find_map(|round| {
            let placed = (0..ATTEMPTS).find_map(|seed| {
                let times = schedule(&operations, round, seed)?;
                let exits = exits(&operations, results, &times, round)?;
                let registers = registers(&operations, &times, &exits, round)?;
                Some((times, registers, exits))
            })?;
            Some((round, placed))
        });
        let (round, (times, registers, exits)) = found.context("no round holds the operations")?;
        let places = times.into_iter().zip(registers);
        Ok(Program {
            places: places
                .map(|(time, (register, copies))| Place {
                    time,
                    register,
                    copies,
                })
                .collect(),
            operations,
            exits,
            round,
            constants,
        })
    }

    /// Cycles from a splat's first slot to that of its last result.
    pub fn latency(&self) -> usize {
        self.exits.round * self.round + self.exits.last()
    }

    /// The slot of every cycle of a round: operation and term.
    pub fn slots(&self) -> Vec<Option<(usize, usize)>> {
        let times: Vec<usize> = self.places.iter().map(|place| place.time).collect();
        slots(&self.operations, &times, self.round)
    }
}

fn slots(operations: &[Operation], times: &[usize], round: usize) -> Vec<Option<(usize, usize)>> {
    let mut slots = vec![None; round];
    for (index, time) in times.iter().enumerate() {
        for term in 0..operations[index].terms.len() {
            slots[time % round + term] = Some((index, term));
        }
    }
    slots
}

/// The results that an operation reads.
fn read(operation: &Operation) -> impl Iterator<Item = Value> + '_ {
    let terms = operation.terms.iter();
    let factors = terms.flat_map(|term| [term.a, term.b, term.other]);
    factors.filter_map(|factor| match factor {
        Operand::Value(value) => Some(value),
        _ => None,
    })
}

fn reads_input(operation: &Operation) -> bool {
    operation
        .terms
        .iter()
        .any(|term| matches!(term.a, Operand::Input(_)))
}

/// Cycles of every operation's first slot; nothing if the round is too short.
///
/// What has the most behind it comes first; the seed stirs that order by a latency, since not every order fills a round without gaps.
fn schedule(operations: &[Operation], round: usize, seed: u64) -> Option<Vec<usize>> {
    let mut state = seed;
    let stir: Vec<usize> = operations
        .iter()
        .map(|_| {
            if seed == 0 {
                0
            } else {
                split_mix(&mut state) as usize % (LATENCY << (seed % 4))
            }
        })
        .collect();
    let mut taken = vec![false; round];
    let mut times = vec![0; operations.len()];
    // Cycles from an operation's issue to the end of everything that follows from it.
    let mut rest = vec![0; operations.len()];
    for (index, operation) in operations.iter().enumerate().rev() {
        let length = rest[index] + operation.terms.len() - 1 + LATENCY;
        let before = operation.follows.then(|| index - 1);
        for value in read(operation).chain(before) {
            rest[value] = rest[value].max(length);
        }
    }
    // Factors that an operation waits for, and the cycle from which those that are there can be read.
    let mut waits: Vec<usize> = operations.iter().map(|o| read(o).count()).collect();
    let mut ready = vec![0; operations.len()];
    let mut readers = vec![Vec::new(); operations.len()];
    for (index, operation) in operations.iter().enumerate() {
        for value in read(operation) {
            readers[value].push(index);
        }
    }
    let mut left: Vec<usize> = (0..operations.len()).collect();
    while !left.is_empty() {
        let can = left.iter().copied();
        let can = can.filter(|index| waits[*index] == 0 && !operations[*index].follows);
        let first = can.min_by_key(|index| {
            let input = !reads_input(&operations[*index]);
            (input, usize::MAX - rest[*index] - stir[*index], *index)
        })?;
        let behind = operations[first + 1..].iter();
        let last = first + behind.take_while(|operation| operation.follows).count();
        let length: usize = operations[first..=last].iter().map(|o| o.terms.len()).sum();
        let fits = |time: &usize| {
            let slot = time % round;
            slot + length <= round && !taken[slot..slot + length].iter().any(|taken| *taken)
        };
        let time = (ready[first]..ready[first] + round).find(fits)?;
        if reads_input(&operations[first]) && time + length + LOAD_AHEAD > round
            || time / round >= ROUNDS
        {
            return None;
        }
        taken[time % round..time % round + length].fill(true);
        left.retain(|index| !(first..=last).contains(index));
        let mut end = time;
        for index in first..=last {
            times[index] = end;
            end += operations[index].terms.len();
            for reader in &readers[index] {
                waits[*reader] -= 1;
                ready[*reader] = ready[*reader].max(end - 1 + LATENCY);
            }
        }
    }
    Some(times)
}

/// Has a slot no use for a register as second factor?
fn spares_second(term: &Term) -> bool {
    let used = [term.b, term.other].map(|factor| matches!(factor, Operand::Value(_)));
    used == [false; 2] && term.pick == Pick::None
}

/// Cycles in which the results leave, all of them in one round: the earliest for which they are ready, in slots that
/// spare the second factor. They are counted before that round ends.
fn exits(
    operations: &[Operation],
    results: &[Value],
    times: &[usize],
    round: usize,
) -> Option<Exits> {
    let mut ready: Vec<(usize, usize)> = results
        .iter()
        .map(|value| times[*value] + operations[*value].terms.len() - 1 + LATENCY)
        .zip(0..)
        .collect();
    ready.sort_unstable();
    let first = ready.last()?.0 / round;
    let slots = slots(operations, times, round);
    (first..ROUNDS).find_map(|of_round| {
        let free = slots.iter().enumerate().take(round - OUT_AHEAD);
        let mut free = free.filter(|(_, slot)| {
            slot.is_none_or(|(operation, term)| spares_second(&operations[operation].terms[term]))
        });
        let mut exits = Exits {
            round: of_round,
            results: results.iter().map(|value| (0, *value)).collect(),
        };
        for (time, number) in &ready {
            let (cycle, _) = free.find(|(cycle, _)| of_round * round + cycle >= *time)?;
            exits.results[*number].0 = cycle;
        }
        Some(exits)
    })
}

/// Registers for every result: the first, and how many. Nothing if there are too few.
fn registers(
    operations: &[Operation],
    times: &[usize],
    exits: &Exits,
    round: usize,
) -> Option<Vec<(usize, usize)>> {
    let last_slot = |index: usize| times[index] + operations[index].terms.len() - 1;
    let mut copies = vec![1; operations.len()];
    let mut lasts = |value: usize, until: usize| {
        let rounds = (until - last_slot(value)).div_ceil(round);
        copies[value] = copies[value].max(rounds.next_power_of_two());
    };
    for (index, operation) in operations.iter().enumerate() {
        for value in read(operation) {
            lasts(value, last_slot(index));
        }
    }
    for (cycle, value) in &exits.results {
        lasts(*value, exits.round * round + cycle);
    }
    let mut order: Vec<usize> = (0..operations.len()).collect();
    // The widest first, so that all stand at a multiple of their width.
    order.sort_by_key(|index| REGISTERS - copies[*index]);
    let mut free = 0;
    let mut places = vec![(0, 1); operations.len()];
    for index in order {
        places[index] = (free, copies[index]);
        free += copies[index];
    }
    (free <= REGISTERS).then_some(places)
}

/// The constant that a slot's factors read; an error if it were two. What is added has a memory of its own.
pub fn constant(operation: &Operation, term: usize) -> Result<Option<usize>> {
    let Term {
        a,
        b,
        picked,
        other,
        ..
    } = operation.terms[term];
    let address = |operand| match operand {
        Operand::Constant(address) => Some(address),
        _ => None,
    };
    let all = [address(a), address(b), address(other), picked];
    let mut all = all.into_iter().flatten();
    let first = all.next();
    ensure!(
        all.all(|other| Some(other) == first),
        "{}: a slot has one constant",
        operation.name
    );
    Ok(first)
}
