//! From a list of sums to a microprogram: every operation gets its slots in a round of fixed length, and its result a register.
//!
//! The cores of `setup_unit.sv` have one issue slot a cycle and a pipeline of [`LATENCY`](super::schedule::LATENCY)
//! cycles. A splat's operations depend on each other over many such latencies, so a round starts the next splats long before the last ones are done: slot t of the list is issued in cycle t modulo the
//! round's length, for the splats that came t / length rounds before (modulo scheduling). Nothing branches; a culled splat runs through.
//!
//! A result has as many registers in a row as rounds pass until its last reader, and splats take them in turn. So a register is written again only
//! by a slot that is issued after the old value's last reader, and the sequencer may pause between any two rounds.
//!
//! Results leave by the second factor's port in slots that have no use for it, so that they take no slots of their own.

use anyhow::{Result, ensure};
use std::collections::BTreeMap;

/// Constants of a picture.
const CONSTANTS: usize = 64;

/// Cycles that a round may have.
const CYCLES: usize = 256;

/// Orders of the operations that are tried before the round is made a cycle longer.
const ATTEMPTS: u64 = 4_000;

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
    /// The number at this address, which is the same for all splats of a picture.
    Constant(usize),
}

/// Fields of a slot that are not 0, by their names in `setup_types.svh`.
pub type Fields = BTreeMap<&'static str, i64>;

/// One slot: a product, or one number, added to a sum.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Term {
    pub a: Operand,
    pub b: Operand,
    /// The constant that is picked by the sign.
    pub picked: Option<usize>,
    /// What is taken without the flag of rules or view: a constant as first factor, or a result instead of a product with a constant, which is then not
    /// rounded to less than 31 bits.
    pub other: Operand,
    /// What does not depend on where operations stand.
    pub fields: Fields,
}

/// A sum of terms.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Operation {
    pub name: String,
    /// One slot each, in a row.
    pub terms: Vec<Term>,
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
    pub places: Vec<Place>,
    /// All in one round, in their order.
    pub exits: Vec<Exit>,
    /// Cycles of a round.
    pub round: usize,
    /// In the order of their addresses.
    pub constants: Vec<String>,
}

impl Program {
    /// The shortest round that holds the operations, of which these are the results.
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
            places: Vec::new(),
            exits: Vec::new(),
            round: 0,
            constants,
        };
        let mut rounds = slots..=CYCLES;
        let mut fits =
            |round| (0..ATTEMPTS).any(|seed| program.place(round, seed, results).is_some());
        ensure!(rounds.any(&mut fits), "no round holds the operations");
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
}

/// The constant that a slot's factors read; an error if it were two. What is added has a memory of its own.
pub fn constant(operation: &Operation, term: usize) -> Result<Option<usize>> {
    let (name, term) = (&operation.name, &operation.terms[term]);
    let factors = [term.a, term.b, term.other].into_iter();
    let mut all = factors.filter_map(|factor| match factor {
        Operand::Constant(address) => Some(address),
        _ => None,
    });
    let first = all.next().or(term.picked);
    let mut others = all.chain(term.picked);
    let same = others.all(|other| Some(other) == first);
    ensure!(same, "{name}: a slot has one constant");
    Ok(first)
}
