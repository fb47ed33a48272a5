//! When operations are issued, where their results stand, and when those of a splat leave; see [`assemble`](super::assemble).

use super::assemble::{Exit, Operand, Operation, Place, Program, Term, Value};
use crate::random::Random;

/// Cycles from the issue of a sum's last term until its result can be read.
pub const LATENCY: usize = 24;

/// Registers of a core.
const REGISTERS: usize = 256;

/// Rounds that a splat may take: as many splats of one core are in flight.
const ROUNDS: usize = 16;

/// So many cycles before a round ends the next splats' records may begin to come in.
pub const LOAD_AHEAD: usize = 48;

/// So many cycles after a splat's last result its round goes on at least.
const OUT_AHEAD: usize = 4;

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
    let mut terms = operation.terms.iter();
    terms.any(|term| matches!(term.a, Operand::Input(_)))
}

/// Cycles of every operation's first slot; nothing if the round is too short.
///
/// What has the most behind it comes first; the seed stirs that order by a latency, since not every order fills a round without gaps.
fn schedule(operations: &[Operation], round: usize, seed: u64) -> Option<Vec<usize>> {
    let mut random = Random(seed);
    let mut stir = vec![0; operations.len()];
    if seed > 0 {
        stir.fill_with(|| random.next() as usize % (LATENCY << (seed % 4)));
    }
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
    let mut waits = vec![0; operations.len()];
    let mut ready = vec![0; operations.len()];
    let mut readers = vec![Vec::new(); operations.len()];
    for (index, operation) in operations.iter().enumerate() {
        for value in read(operation) {
            waits[index] += 1;
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
    used == [false; 2] && !term.fields.contains_key("pick")
}

impl Program {
    /// Places the operations in a round of so many cycles, of which these are the results; nothing if it is too short.
    pub(super) fn place(
        &mut self,
        round: usize,
        seed: u64,
        results: &[(usize, Value)],
    ) -> Option<()> {
        self.round = round;
        let times = schedule(&self.operations, round, seed)?.into_iter();
        let place = |time| Place {
            time,
            register: 0,
            copies: 1,
        };
        self.places = times.map(place).collect();
        self.exits = self.leaving(results)?;
        self.take_registers()
    }

    /// The operation and the term of every cycle of a round.
    pub fn slots(&self) -> Vec<Option<(usize, usize)>> {
        let mut slots = vec![None; self.round];
        for (index, operation) in self.operations.iter().enumerate() {
            for term in 0..operation.terms.len() {
                slots[self.places[index].time % self.round + term] = Some((index, term));
            }
        }
        slots
    }

    fn last_slot(&self, index: usize) -> usize {
        self.places[index].time + self.operations[index].terms.len() - 1
    }

    /// When the results leave, all of them in one round: as soon as they are ready, in slots that spare the second factor, before that round ends.
    fn leaving(&self, results: &[(usize, Value)]) -> Option<Vec<Exit>> {
        let ready = |(word, value): &(usize, Value)| Exit {
            time: self.last_slot(*value) + LATENCY,
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
        let operations = self.operations.iter().enumerate();
        let reads = operations.flat_map(|(index, operation)| {
            let last = self.last_slot(index);
            read(operation).map(move |value| (value, last))
        });
        let exits = self.exits.iter().map(|exit| (exit.value, exit.time));
        let reads: Vec<(Value, usize)> = reads.chain(exits).collect();
        for (value, until) in reads {
            let rounds = (until - self.last_slot(value)).div_ceil(self.round);
            let copies = &mut self.places[value].copies;
            *copies = rounds.next_power_of_two().max(*copies);
        }
        let mut order: Vec<&mut Place> = self.places.iter_mut().collect();
        // The widest first, so that all stand at a multiple of their width.
        order.sort_by_key(|place| REGISTERS - place.copies);
        let mut free = 0;
        for place in order {
            place.register = free;
            free += place.copies;
        }
        (free <= REGISTERS).then_some(())
    }
}
