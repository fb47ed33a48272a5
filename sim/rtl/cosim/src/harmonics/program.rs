//! The program of the harmonics unit's basis: `harmonics_program.txt`, read.

use RightFactor::{Axis, Halves, Register, Root};
use anyhow::{Context, Result};
use std::f64::consts::PI;

/// Harmonics of the highest degree.
pub const HARMONICS: usize = 24;

/// The right factor of a term; the left one is a register.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RightFactor {
    Register(&'static str),
    /// A small number in halves: exact, no rounding but that of a half.
    Halves(u32),
    /// The root of numerator / (denominator pi) in Q2.29, for a polynomial clamped to 4.
    Root(u32, u32),
    /// None: the direction's axis is added to nothing.
    Axis,
}

/// Where a sum goes after a term.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// Nowhere yet.
    Nothing,
    Register(&'static str),
    /// The harmonic of this index, from 1 on.
    Harmonic(usize),
}

/// One term of a sum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Term {
    /// A register.
    pub left: &'static str,
    pub right: RightFactor,
    /// Is it subtracted?
    pub negated: bool,
    /// Does its sum begin with it?
    pub first: bool,
    /// Where the sum goes.
    pub target: Target,
}

/// A sum, whose terms stand one behind the other.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sum {
    /// The lowest degree that needs it.
    pub degree: usize,
    pub terms: Vec<Term>,
}

/// All of it. The direction is in "x", "y" and "z" before.
pub fn sums() -> Result<Vec<Sum>> {
    let lines = include_str!("../../harmonics_program.txt").lines();
    let lines = lines.filter(|line| !line.starts_with("//"));
    let sum = |line| sum(line).with_context(|| format!("harmonics_program.txt: '{line}'"));
    lines.map(sum).collect()
}

fn sum(line: &'static str) -> Option<Sum> {
    let (degree, terms) = line.split_once(": ")?;
    let mut terms: Vec<Term> = terms.split("; ").map(term).collect::<Option<_>>()?;
    terms.first_mut()?.first = true;
    let degree = degree.parse().ok()?;
    Some(Sum { degree, terms })
}

fn term(text: &'static str) -> Option<Term> {
    let (product, target) = text.split_once(" = ").unwrap_or((text, ""));
    let target = match target.strip_prefix('Y') {
        Some(index) => Target::Harmonic(index.parse().ok()?),
        None if target.is_empty() => Target::Nothing,
        None => Target::Register(target),
    };
    let positive = product.strip_prefix("- ");
    let (left, right) = positive.unwrap_or(product).split_once(" * ")?;
    let right = if let Some(quotient) = right.strip_prefix("root ") {
        let (numerator, denominator) = quotient.split_once('/')?;
        Root(numerator.parse().ok()?, denominator.parse().ok()?)
    } else if right == "1/2" {
        Halves(1)
    } else {
        let number = right.parse();
        number.map_or(Register(right), |number: u32| Halves(2 * number))
    };
    Some(Term {
        left,
        right,
        negated: positive.is_some(),
        first: false,
        target,
    })
}

impl Term {
    /// What loads an axis of the direction: a sum of nothing, which begins with it.
    pub fn load(axis: &'static str) -> Term {
        Term {
            left: "x",
            right: Axis,
            negated: false,
            first: true,
            target: Target::Register(axis),
        }
    }

    /// The registers that it reads.
    pub fn reads(&self) -> Vec<&'static str> {
        match self.right {
            Register(right) => vec![self.left, right],
            Halves(_) | Root(..) | Axis => vec![self.left],
        }
    }
}

impl RightFactor {
    /// The slot's constant: roots with 29 fraction bits for a quotient by 2^31, halves with 15 for one by 2^16.
    pub fn constant(self) -> u32 {
        match self {
            Register(_) | Axis => 0,
            Halves(number) => number << 15,
            Root(numerator, denominator) => {
                let square = f64::from(numerator) / (f64::from(denominator) * PI);
                (square.sqrt() * 2f64.powi(29)).round() as u32
            }
        }
    }
}
