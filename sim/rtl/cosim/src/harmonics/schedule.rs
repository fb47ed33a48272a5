//! The program in its order: every term at a place, so that no operand is read before it is written, and where each degree ends.

use super::program::{HARMONICS, RightFactor, Sum, Target, Term, sums};
use anyhow::{Context, Result, ensure};

/// Places from a term to the first that can read its result; from harmonics_unit.sv: the register file's words, factors, clamps, magnitudes, product (2), quotient,
/// sum, write.
pub const LATENCY: usize = 9;

/// Places that load the direction.
pub const LOADS: usize = 3;

/// Channels of a word: cycles that the sum takes at least for a word.
const CHANNELS: usize = 3;

/// The unit's registers.
pub const REGISTERS: usize = 64;

/// A term at its place; the first of a sum begins it anew.
#[derive(Clone, Copy, Debug)]
pub struct PlacedTerm {
    /// The term.
    pub term: Term,
    /// Does its sum begin with it?
    pub first: bool,
}

/// The whole program.
#[derive(Clone, Debug)]
pub struct Schedule {
    /// By place; nothing where a place waits. The first [`LOADS`] load x, y and z.
    pub places: Vec<Option<PlacedTerm>>,
    /// The last place of each degree.
    pub ends: [usize; 5],
    /// Registers by their numbers.
    pub registers: Vec<&'static str>,
}

/// Names in the order of their first writing.
struct Written {
    names: Vec<(&'static str, usize)>,
}

impl Written {
    /// The place from which on a register can be read; nothing before its term has a place.
    fn ready(&self, name: &str) -> Option<usize> {
        let known = self.names.iter().find(|known| known.0 == name)?;
        Some(known.1)
    }

    /// The place from which on a sum can begin.
    fn ready_for(&self, sum: &Sum) -> Option<usize> {
        let mut ready = 0;
        for (offset, term) in sum.terms.iter().enumerate() {
            ready = ready.max(self.ready(term.left)?.saturating_sub(offset));
            if let RightFactor::Register(name) = term.right {
                ready = ready.max(self.ready(name)?.saturating_sub(offset));
            }
        }
        Some(ready)
    }
}

/// Takes the sum of the lowest degree that can begin, of those the one with the longest way behind it, place by place.
pub fn schedule() -> Result<Schedule> {
    let sums = sums()?;
    let ways = ways(&sums);
    let mut places: Vec<Option<PlacedTerm>> = vec![None; LOADS];
    let mut written = Written {
        names: ["x", "y", "z"]
            .iter()
            .enumerate()
            .map(|(place, name)| (*name, place + LATENCY))
            .collect(),
    };
    let mut left: Vec<usize> = (0..sums.len()).collect();
    // The last place of each degree's terms, and the place of each harmonic.
    let mut ends = [LOADS - 1; 5];
    let mut harmonics = [0; HARMONICS + 1];
    while !left.is_empty() {
        let now = places.len();
        let can = |index: &&usize| {
            let ready = written.ready_for(&sums[**index]);
            ready.is_some_and(|ready| ready <= now)
        };
        let next = left.iter().filter(can);
        let next = next.min_by_key(|index| (sums[**index].degree, usize::MAX - ways[**index]));
        let Some(next) = next.copied() else {
            places.push(None);
            continue;
        };
        left.retain(|index| *index != next);
        let sum = &sums[next];
        for (offset, term) in sum.terms.iter().enumerate() {
            match term.target {
                Target::Register(name) => written.names.push((name, places.len() + LATENCY)),
                Target::Harmonic(index) => harmonics[index] = places.len(),
                Target::Nothing => {}
            }
            places.push(Some(PlacedTerm {
                term: *term,
                first: offset == 0,
            }));
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
    let registers: Vec<&str> = written.names.iter().map(|known| known.0).collect();
    ensure!(registers.len() <= REGISTERS, "too many registers");
    Ok(Schedule {
        places,
        ends,
        registers,
    })
}

/// Places from each sum to the end of all that follows from it.
fn ways(sums: &[Sum]) -> Vec<usize> {
    let mut ways: Vec<usize> = sums.iter().map(|sum| sum.terms.len()).collect();
    // Sums that read a result stand behind it or are harmonics: as often as a way is long.
    for _ in 0..sums.len() {
        for index in 0..sums.len() {
            let follows =
                |other: &Sum| other.degree == sums[index].degree && reads(other, &sums[index]);
            let behind = sums.iter().zip(&ways).filter(|(other, _)| follows(other));
            let behind = behind.map(|(_, way)| *way).max().unwrap_or(0);
            ways[index] = sums[index].terms.len() + behind + LATENCY * usize::from(behind > 0);
        }
    }
    ways
}

fn reads(reader: &Sum, of: &Sum) -> bool {
    let written = |name: &str| {
        let targets = of.terms.iter().map(|term| term.target);
        targets
            .into_iter()
            .any(|target| matches!(target, Target::Register(written) if written == name))
    };
    let right = |term: &Term| matches!(term.right, RightFactor::Register(name) if written(name));
    reader
        .terms
        .iter()
        .any(|term| written(term.left) || right(term))
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
            let of =
                |slot: &Option<PlacedTerm>| slot.is_some_and(|placed| placed.term.target == wanted);
            schedule.places.iter().position(of)
        };
        let written = |name: &'static str| {
            let load = ["x", "y", "z"].iter().position(|axis| *axis == name);
            load.or_else(|| place_of(Target::Register(name))).unwrap()
        };
        for (place, placed) in schedule.places.iter().enumerate() {
            let Some(PlacedTerm { term, .. }) = placed else {
                continue;
            };
            assert!(place >= written(term.left) + LATENCY, "{term:?}");
            if let RightFactor::Register(name) = term.right {
                assert!(place >= written(name) + LATENCY, "{term:?}");
            }
        }
        for (degree, end) in schedule.ends.iter().enumerate() {
            for index in 1..(degree + 1).pow(2) {
                let place = place_of(Target::Harmonic(index)).unwrap();
                assert!(
                    place <= *end && place + LATENCY <= end + 1 + 3 * index,
                    "{index}"
                );
            }
        }
    }
}
