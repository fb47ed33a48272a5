//! The program of the harmonics unit's basis: `harmonics_program.txt` is read as a list of sums, every term gets a
//! place, so that no operand is read before it is written, and `sim/rtl/harmonics_program.sv` is what a circuit reads.

use anyhow::{Context, Result, ensure};
use std::f64::consts::PI;

/// The generated file in the folder of the RTL.
pub const FILE: &str = "harmonics_program.sv";

/// Harmonics of the highest degree.
const HARMONICS: usize = 24;

/// Places from a term to the first that can read its result; from harmonics_unit.sv: the register file's words,
/// factors, clamps, magnitudes, product (2), quotient, sum, write.
const LATENCY: usize = 9;

/// What the first places load: the direction.
const AXES: [(&str, &str); 3] = [
    ("x", "x = direction"),
    ("y", "y = direction"),
    ("z", "z = direction"),
];

/// Channels of a word: cycles that the sum takes at least for a word.
const CHANNELS: usize = 3;

/// The unit's registers.
const REGISTERS: usize = 64;

/// Bits of a slot.
const SLOT: usize = 56;

const HEAD: &str = "\
// Program of the harmonics unit's basis: written by `rtl -- package` from sim/rtl/cosim/harmonics_program.txt; do not
// edit.
//
// A slot, from its lowest bit: left register (6), right register (6), target (6), constant (31), and a bit each: right
// is a register, left is clamped to 4, quotient by 2^16, subtracted, first of its sum, to a register, to a harmonic.
// `end_place` is a degree's last place; a `gap` has no term.
module harmonics_program (
    input logic clk,
    input logic [6:0] place,
    input logic [2:0] degree,
    output logic [55:0] slot,
    output logic [6:0] end_place,
    output logic gap
);
";

/// The right factor of a term; the left one is a register.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum RightFactor {
    Register(&'static str),
    /// A small number with 16 fraction bits, for a quotient by 2^16: exact, no rounding but that of a half. The
    /// direction of a load is added to nothing, its factor is 0.
    Small(usize),
    /// A root with 29 fraction bits, for a quotient by 2^31 and a polynomial clamped to 4.
    Root(usize),
}

/// Where a sum goes after a term.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Target {
    /// Nowhere yet.
    Nothing,
    Register(&'static str),
    /// The harmonic of this index, from 1 on.
    Harmonic(usize),
}

/// One term of a sum.
#[derive(Clone, Debug)]
struct Term {
    /// A register.
    left: &'static str,
    right: RightFactor,
    /// Is it subtracted?
    negated: bool,
    /// Does its sum begin with it?
    first: bool,
    /// Where the sum goes.
    target: Target,
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

/// The whole program.
struct Schedule {
    /// By place; nothing where a place waits.
    places: Vec<Option<Term>>,
    /// The last place of each degree.
    ends: [usize; 5],
    /// Registers by their numbers.
    registers: Vec<&'static str>,
}

/// All of it. The direction is in "x", "y" and "z" before.
fn sums() -> Result<Vec<Sum>> {
    let lines = include_str!("../../harmonics_program.txt").lines();
    let lines = lines.filter(|line| !line.starts_with("//"));
    let sum = |line| sum(line).with_context(|| format!("harmonics_program.txt: '{line}'"));
    lines.map(sum).collect()
}

fn sum(line: &'static str) -> Option<Sum> {
    let (degree, terms) = line.split_once(": ")?;
    let terms = terms.split("; ").enumerate();
    let terms = terms.map(|(index, text)| term(text, index == 0));
    Some(Sum {
        degree: degree.parse().ok()?,
        terms: terms.collect::<Option<_>>()?,
    })
}

/// A term in the words of the program, `-(left) right = target`.
fn term(words: &'static str, first: bool) -> Option<Term> {
    let (product, target) = words.split_once(" = ").unwrap_or((words, ""));
    let (sign, product) = product.split_once('(')?;
    let (left, right) = product.split_once(") ")?;
    let target = match target.strip_prefix("Y_") {
        Some(index) => Target::Harmonic(index.parse().ok()?),
        None if target.is_empty() => Target::Nothing,
        None => Target::Register(target),
    };
    Some(Term {
        left,
        right: right_factor(right)?,
        negated: sign.starts_with('-'),
        first,
        target,
        words,
    })
}

fn right_factor(text: &'static str) -> Option<RightFactor> {
    if let Some(name) = text.strip_prefix('(') {
        return Some(RightFactor::Register(name.strip_suffix(')')?));
    }
    if let Some(quotient) = text.strip_prefix("root(") {
        let (above, below) = quotient.strip_suffix(" pi)")?.split_once(" / ")?;
        let square = above.parse::<f64>().ok()? / (below.parse::<f64>().ok()? * PI);
        let root = (square.sqrt() * 2f64.powi(29)).round();
        return Some(RightFactor::Root(root as usize));
    }
    if text == "1 / 2" {
        return Some(RightFactor::Small(1 << 15));
    }
    Some(RightFactor::Small(text.parse::<usize>().ok()? << 16))
}

impl Term {
    /// What loads an axis of the direction: a sum of nothing, which begins with it.
    fn load((axis, words): (&'static str, &'static str)) -> Term {
        Term {
            left: "x",
            right: RightFactor::Small(0),
            negated: false,
            first: true,
            target: Target::Register(axis),
            words,
        }
    }

    /// The registers that it reads.
    fn reads(&self) -> impl Iterator<Item = &'static str> {
        let right = match self.right {
            RightFactor::Register(right) => Some(right),
            RightFactor::Small(_) | RightFactor::Root(_) => None,
        };
        [self.left].into_iter().chain(right)
    }

    /// Its slot, by the registers' numbers.
    fn slot(&self, registers: &[&str]) -> Result<usize> {
        let number = |name| {
            let number = registers.iter().position(|known| *known == name);
            number.with_context(|| format!("no register {name}"))
        };
        let right = match self.right {
            RightFactor::Register(name) => number(name)? << 6 | 1 << 49,
            RightFactor::Root(root) => root << 18 | 1 << 50,
            RightFactor::Small(factor) => factor << 18 | 1 << 51,
        };
        let target = match self.target {
            Target::Nothing => 0,
            Target::Register(name) => number(name)? << 12 | 1 << 54,
            Target::Harmonic(index) => index << 12 | 1 << 55,
        };
        let flags = usize::from(self.negated) << 52 | usize::from(self.first) << 53;
        Ok(number(self.left)? | right | target | flags)
    }
}

/// Sums begin in the order of the program, each as soon as all that it reads has been written.
fn schedule() -> Result<Schedule> {
    let mut places = AXES.map(|axis| Some(Term::load(axis))).to_vec();
    // Registers in the order of their first writing, and the places from which on they can be read.
    let mut written: Vec<(&str, usize)> = (LATENCY..)
        .zip(AXES)
        .map(|(place, axis)| (axis.0, place))
        .collect();
    // The last place of each degree's terms, and the place of each harmonic.
    let mut ends = [AXES.len() - 1; 5];
    let mut harmonics = [0; HARMONICS + 1];
    for sum in sums()? {
        let ready = ready(&sum, &written);
        let ready = ready.with_context(|| format!("{sum:?} reads what is not written before"))?;
        places.resize(places.len().max(ready), None);
        for term in sum.terms {
            match term.target {
                Target::Register(name) => written.push((name, places.len() + LATENCY)),
                Target::Harmonic(index) => harmonics[index] = places.len(),
                Target::Nothing => {}
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

/// The generated file's text.
pub fn text() -> Result<String> {
    let schedule = schedule()?;
    let [lower @ .., highest] = schedule.ends;
    let ends = lower.iter().enumerate();
    let ends = ends.map(|(degree, end)| format!("      3'd{degree}: end_place = 7'd{end};\n"));
    let (mut gaps, mut slots) = (Vec::new(), String::new());
    for (place, term) in schedule.places.iter().enumerate() {
        match term {
            Some(term) => {
                let (word, words) = (term.slot(&schedule.registers)?, &term.words);
                slots += &format!("      7'd{place}: slot <= {SLOT}'h{word:014x};  // {words}\n");
            }
            None => gaps.push(format!("7'd{place}")),
        }
    }
    Ok(format!(
        "{HEAD}  always_comb begin
    case (degree)
{}      default: end_place = 7'd{highest};
    endcase
  end
  always_comb begin
    case (place)
      {}: gap = 1;
      default: gap = 0;
    endcase
  end
  always_ff @(posedge clk) begin
    case (place)
{slots}      default: slot <= {SLOT}'d0;
    endcase
  end
endmodule
",
        ends.collect::<String>(),
        gaps.join(", ")
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What the unit takes for granted: nothing is read before it is written, neither a register by a term nor a
    /// harmonic by the sum of its degree.
    #[test]
    fn nothing_is_read_too_early() {
        let schedule = schedule().unwrap();
        let place_of = |wanted: Target| {
            let of = |slot: &Option<Term>| slot.as_ref().is_some_and(|term| term.target == wanted);
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
