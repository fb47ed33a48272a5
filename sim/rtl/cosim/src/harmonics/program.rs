//! The program of the harmonics unit's basis: `harmonics_program.txt` is read as a list of sums, every term gets a
//! place, so that no operand is read before it is written, and `sim/rtl/harmonics_program.sv` is what a circuit reads.

use crate::package::filled;
use anyhow::{Context, Result, ensure};
use std::f64::consts::PI;

/// The generated file in the folder of the RTL.
pub const FILE: &str = "harmonics_program.sv";

/// Harmonics of the highest degree.
const HARMONICS: usize = 24;

/// Places from a term to the first that can read its result; from harmonics_unit.sv: the register file's words,
/// factors, clamps, magnitudes, product (2), quotient, sum, write.
const LATENCY: usize = 9;

/// What the first places load, the direction, as terms and in words: nothing is added to nothing.
const AXES: [(&str, &str); 3] = [
    ("(x) 0 = x", "x = direction"),
    ("(x) 0 = y", "y = direction"),
    ("(x) 0 = z", "z = direction"),
];

/// Channels of a word: cycles that the sum takes at least for a word.
const CHANNELS: usize = 3;

/// The unit's registers.
const REGISTERS: usize = 64;

/// Flags of a slot.
const RIGHT_IS_REGISTER: usize = 1 << 49;
const LEFT_IS_CLAMPED: usize = 1 << 50;
const BY_2_16: usize = 1 << 51;
const SUBTRACTED: usize = 1 << 52;
const FIRST: usize = 1 << 53;
const TO_REGISTER: usize = 1 << 54;
const TO_HARMONIC: usize = 1 << 55;

/// One term of a sum.
#[derive(Clone, Debug)]
struct Term {
    /// A register.
    left: &'static str,
    /// The right factor, if it is a register.
    right: Option<&'static str>,
    /// What its slot has whatever the registers' numbers are: the right factor, if it is a constant, and flags.
    fields: usize,
    /// The register that the sum goes to.
    register: Option<&'static str>,
    /// The harmonic that the sum goes to, by its index from 1 on.
    harmonic: Option<usize>,
    /// The term in words, as the slot's comment.
    words: &'static str,
}

/// A sum, whose terms stand one behind the other.
#[derive(Debug)]
struct Sum {
    /// The lowest degree that needs it.
    degree: usize,
    terms: Vec<Term>,
}

/// The terms of every place, if it does not wait; the last place of each degree; registers by their numbers.
type Schedule = (Vec<Option<Term>>, [usize; 5], Vec<&'static str>);

/// All of it. The direction is in "x", "y" and "z" before.
fn sums() -> Result<Vec<Sum>> {
    let lines = include_str!("../../harmonics_program.txt").lines();
    let lines = lines.filter(|line| !line.starts_with("//"));
    let sum = |line| sum(line).with_context(|| format!("harmonics_program.txt: '{line}'"));
    lines.map(sum).collect()
}

fn sum(line: &'static str) -> Option<Sum> {
    let (degree, terms) = line.split_once(": ")?;
    let mut terms: Vec<Term> = terms.split("; ").map(term).collect::<Option<_>>()?;
    terms[0].fields |= FIRST;
    let degree = degree.parse().ok()?;
    Some(Sum { degree, terms })
}

/// A term in the words of the program, `-(left) right = target`.
fn term(words: &'static str) -> Option<Term> {
    let (product, target) = words.split_once(" = ").unwrap_or((words, ""));
    let (sign, product) = product.split_once('(')?;
    let (left, factor) = product.split_once(") ")?;
    let right = factor.strip_prefix('(');
    let right = right.and_then(|name| name.strip_suffix(')'));
    let mut fields = right.map_or_else(|| constant(factor), |_| Some(RIGHT_IS_REGISTER))?;
    if sign.starts_with('-') {
        fields |= SUBTRACTED;
    }
    let harmonic = target.strip_prefix("Y_");
    Some(Term {
        left,
        right,
        fields,
        register: Some(target).filter(|name| harmonic.is_none() && !name.is_empty()),
        harmonic: harmonic.map(str::parse).transpose().ok()?,
        words,
    })
}

/// A constant right factor in its slot: a root with 29 fraction bits, for a quotient by 2^31 and a polynomial clamped
/// to 4, or a small number with 16 fraction bits, for a quotient by 2^16: exact, no rounding but that of a half.
fn constant(text: &str) -> Option<usize> {
    if let Some(quotient) = text.strip_prefix("root(") {
        let (above, below) = quotient.strip_suffix(" pi)")?.split_once(" / ")?;
        let square = above.parse::<f64>().ok()? / (below.parse::<f64>().ok()? * PI);
        let root = (square.sqrt() * 2f64.powi(29)).round();
        return Some((root as usize) << 18 | LEFT_IS_CLAMPED);
    }
    let small = match text {
        "1 / 2" => 1 << 15,
        _ => text.parse::<usize>().ok()? << 16,
    };
    Some(small << 18 | BY_2_16)
}

impl Term {
    /// The registers that it reads.
    fn reads(&self) -> impl Iterator<Item = &'static str> {
        [self.left].into_iter().chain(self.right)
    }

    /// Its slot, by the registers' numbers.
    fn slot(&self, registers: &[&str]) -> Result<usize> {
        let number = |name| {
            let number = registers.iter().position(|known| *known == name);
            number.with_context(|| format!("no register {name}"))
        };
        let mut slot = self.fields | number(self.left)?;
        if let Some(right) = self.right {
            slot |= number(right)? << 6;
        }
        if let Some(register) = self.register {
            slot |= number(register)? << 12 | TO_REGISTER;
        }
        if let Some(index) = self.harmonic {
            slot |= index << 12 | TO_HARMONIC;
        }
        Ok(slot)
    }
}

/// Sums begin in the order of the program, each as soon as all that it reads has been written.
fn schedule() -> Result<Schedule> {
    let mut places = Vec::new();
    // Registers in the order of their first writing, and the places from which on they can be read.
    let mut written = Vec::new();
    for (place, (text, words)) in AXES.into_iter().enumerate() {
        let mut load = term(text).context("a load of the direction")?;
        (load.fields, load.words) = (load.fields | FIRST, words);
        written.extend(load.register.map(|axis| (axis, place + LATENCY)));
        places.push(Some(load));
    }
    // The last place of each degree's terms, and the place of each harmonic.
    let mut ends = [AXES.len() - 1; 5];
    let mut harmonics = [0; HARMONICS + 1];
    for sum in sums()? {
        let ready = ready(&sum, &written);
        let ready = ready.with_context(|| format!("{sum:?} reads what is not written before"))?;
        places.resize(places.len().max(ready), None);
        for term in sum.terms {
            written.extend(term.register.map(|name| (name, places.len() + LATENCY)));
            if let Some(index) = term.harmonic {
                harmonics[index] = places.len();
            }
            places.push(Some(term));
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
    Ok((places, ends, registers))
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

/// The generated file's text.
pub fn text() -> Result<String> {
    let (places, [lower @ .., highest], registers) = schedule()?;
    let ends = lower.iter().enumerate();
    let ends = ends.map(|(degree, end)| format!("      3'd{degree}: end_place = 7'd{end};\n"));
    let (mut gaps, mut slots) = (Vec::new(), String::new());
    for (place, term) in places.iter().enumerate() {
        match term {
            Some(term) => {
                let (word, words) = (term.slot(&registers)?, &term.words);
                slots += &format!("      7'd{place}: slot <= 56'h{word:014x};  // {words}\n");
            }
            None => gaps.push(format!("7'd{place}")),
        }
    }
    Ok(filled(
        include_str!("../../templates/harmonics_program.txt"),
        &[
            ("ends", &ends.collect::<String>()),
            ("highest", &highest),
            ("gaps", &gaps.join(", ")),
            ("slots", &slots),
        ],
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What the unit takes for granted: nothing is read before it is written, neither a register by a term nor a
    /// harmonic by the sum of its degree.
    #[test]
    fn nothing_is_read_too_early() {
        let (places, ends, _) = schedule().unwrap();
        let place_of = |wanted: &dyn Fn(&Term) -> bool| {
            let of = |slot: &Option<Term>| slot.as_ref().is_some_and(wanted);
            places.iter().position(of).unwrap()
        };
        for (place, term) in places.iter().enumerate().skip(AXES.len()) {
            for name in term.iter().flat_map(Term::reads) {
                let written = place_of(&|term| term.register == Some(name));
                assert!(place >= written + LATENCY, "{term:?}");
            }
        }
        for (degree, end) in ends.iter().enumerate() {
            for index in 1..(degree + 1).pow(2) {
                let place = place_of(&|term| term.harmonic == Some(index));
                assert!(
                    place <= *end && place + LATENCY <= end + 1 + 3 * index,
                    "{index}"
                );
            }
        }
    }
}
