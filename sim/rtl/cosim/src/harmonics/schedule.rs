//! The program in its order: every term at a place, so that no operand is read before it is written, and where each degree ends.

use super::program::{HARMONICS, Sum, Target, Term, sums};
use anyhow::{Context, Result, ensure};

/// Places from a term to the first that can read its result; from harmonics_unit.sv: the register file's words, factors, clamps, magnitudes, product (2), quotient,
/// sum, write.
pub const LATENCY: usize = 9;

/// What the first places load: the direction.
const AXES: [&str; 3] = ["x", "y", "z"];

/// Channels of a word: cycles that the sum takes at least for a word.
const CHANNELS: usize = 3;

/// The unit's registers.
const REGISTERS: usize = 64;

/// The whole program.
pub struct Schedule {
    /// By place; nothing where a place waits.
    pub places: Vec<Option<Term>>,
    /// The last place of each degree.
    pub ends: [usize; 5],
    /// Registers by their numbers.
    pub registers: Vec<&'static str>,
}

/// Sums begin in the order of the program, each as soon as all that it reads has been written.
pub fn schedule() -> Result<Schedule> {
    let mut places = AXES.map(|axis| Some(Term::load(axis))).to_vec();
    // Registers in the order of their first writing, and the places from which on they can be read.
    let mut written: Vec<(&str, usize)> = AXES.into_iter().zip(LATENCY..).collect();
    // The last place of each degree's terms, and the place of each harmonic.
    let mut ends = [AXES.len() - 1; 5];
    let mut harmonics = [0; HARMONICS + 1];
    for sum in sums()? {
        let ready = ready(&sum, &written);
        let ready = ready.with_context(|| format!("{sum:?} reads what is not written before"))?;
        places.resize(places.len().max(ready), None);
        for term in &sum.terms {
            match term.target {
                Target::Register(name) => written.push((name, places.len() + LATENCY)),
                Target::Harmonic(index) => harmonics[index] = places.len(),
                Target::Nothing => {}
            }
            places.push(Some(*term));
        }
        for end in &mut ends[sum.degree..] {
            *end = (*end).max(places.len() - 1);
        }
    }
    // The sum begins in the cycle after the end, with the base, and reads a harmonic in every third cycle.
    for (degree, end) in ends.iter_mut().enumerate() {
        let of_degree = harmonics.iter().enumerate().take((degree + 1).pow(2));
        for (index, place) in of_degree.skip(1) {
            *end = (*end).max((place + LATENCY).saturating_sub(1 + CHANNELS * index));
        }
    }
    places.resize(places.len().max(ends[4] + 1), None);
    let registers: Vec<&str> = written.iter().map(|known| known.0).collect();
    ensure!(registers.len() <= REGISTERS, "too many registers");
    Ok(Schedule {
        places,
        ends,
        registers,
    })
}

/// The place from which on a sum can begin; nothing before all that it reads has been written.
fn ready(sum: &Sum, written: &[(&str, usize)]) -> Option<usize> {
    let mut ready = 0;
    for (offset, term) in sum.terms.iter().enumerate() {
        for name in term.reads() {
            let (_, place) = written.iter().find(|known| known.0 == name)?;
            ready = ready.max(place.saturating_sub(offset));
        }
    }
    Some(ready)
}

impl Schedule {
    /// A register's number.
    pub fn number(&self, name: &str) -> Result<usize> {
        let number = self.registers.iter().position(|known| *known == name);
        number.with_context(|| format!("no register {name}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What the unit takes for granted: nothing is read before it is written, neither a register by a term nor a harmonic by the sum of its degree.
    #[test]
    fn nothing_is_read_too_early() {
        let schedule = schedule().unwrap();
        let place_of = |wanted: Target| {
            let of = |slot: &Option<Term>| slot.is_some_and(|term| term.target == wanted);
            schedule.places.iter().position(of).unwrap()
        };
        for (place, term) in schedule.places.iter().enumerate().skip(AXES.len()) {
            for name in term.iter().flat_map(Term::reads) {
                let written = place_of(Target::Register(name));
                assert!(place >= written + LATENCY, "{term:?}");
            }
        }
        for (degree, end) in schedule.ends.iter().enumerate() {
            for index in 1..(degree + 1).pow(2) {
                let place = place_of(Target::Harmonic(index));
                assert!(
                    place <= *end && place + LATENCY <= end + 1 + 3 * index,
                    "{index}"
                );
            }
        }
    }
}
