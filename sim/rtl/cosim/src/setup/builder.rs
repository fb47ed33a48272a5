//! What programs are written with: terms, sums, and the kernel's functions as sums.
//!
//! Names are the kernel's; what a sum, a rounding or a table is stands in `setup_core.sv`.

use super::assemble::{Operand, Operation, Pick, Program, Table, Term, Unit, Value};
use anyhow::Result;
use splatline::math::GUARD;

/// A result.
pub(super) const fn value(value: Value) -> Operand {
    Operand::Value(value)
}

/// A number that is the same for all splats.
pub(super) const fn constant(name: &'static str) -> Operand {
    Operand::Constant(name)
}

/// The product of two factors.
pub(super) const fn product(a: Operand, b: Operand) -> Term {
    Term {
        a,
        b,
        picked: None,
        plain: false,
        before: false,
        after: false,
        floor: false,
        again: false,
        doubled: false,
        table: Table::None,
        entry: false,
        power: false,
        pick: Pick::None,
    }
}

/// One number.
pub(super) const fn plain(a: Operand) -> Term {
    Term {
        plain: true,
        ..product(a, Operand::None)
    }
}

/// Taken off before it is aligned: rounded with its sign.
pub(super) const fn less(term: Term) -> Term {
    Term {
        before: true,
        ..term
    }
}

/// Taken off after it is aligned and rounded.
pub(super) const fn taken_off(term: Term) -> Term {
    Term {
        after: true,
        ..term
    }
}

/// Rounded down.
pub(super) fn cut(terms: Vec<Term>) -> Vec<Term> {
    let down = |term| Term {
        floor: true,
        ..term
    };
    terms.into_iter().map(down).collect()
}

/// A program in the making.
#[derive(Default)]
pub(super) struct Builder {
    operations: Vec<Operation>,
}

impl Builder {
    /// A sum in a unit, rounded to a mantissa of `bits` bits or left as it is.
    pub(super) fn add(
        &mut self,
        name: &str,
        terms: Vec<Term>,
        unit: Unit,
        bits: Option<u32>,
    ) -> Value {
        self.operations.push(Operation {
            name: name.to_owned(),
            terms,
            unit,
            addend: None,
            bits,
            below: 0,
            follows: false,
            out: false,
        });
        self.operations.len() - 1
    }

    /// A sum with a constant in its unit.
    pub(super) fn add_to(
        &mut self,
        name: &str,
        addend: &'static str,
        terms: Vec<Term>,
        unit: Unit,
    ) -> Value {
        let value = self.add(name, terms, unit, None);
        self.operations[value].addend = Some(addend);
        value
    }

    /// Only the word of the result that begins so many bits up.
    pub(super) fn from(&mut self, value: Value, below: u32) -> Value {
        self.operations[value].below = below;
        value
    }

    /// The sum of the last operation, and this term, in another form.
    pub(super) fn further(&mut self, name: &str, term: Term, below: u32) -> Value {
        let unit = self.operations[self.operations.len() - 1].unit;
        let value = self.add(name, vec![term], unit, None);
        self.operations[value].follows = true;
        self.from(value, below)
    }

    /// The same without another term.
    pub(super) fn word(&mut self, name: &str, below: u32) -> Value {
        self.further(name, plain(constant("nothing")), below)
    }

    /// `sum_of_products`.
    pub(super) fn sum(&mut self, name: &str, terms: Vec<Term>, bits: u32) -> Value {
        let window = Unit::Below((bits + GUARD) as i32);
        self.add(name, cut(terms), window, Some(bits))
    }

    /// Twice the sum of seed and quotient in `square_root`.
    pub(super) fn heron(&mut self, name: &str, seed: Value, quotient: Term, bits: u32) -> Value {
        let above = 32 - (bits + GUARD) as i32;
        let terms = cut(vec![plain(value(seed)), quotient]);
        self.add(name, terms, Unit::First(above), Some(bits))
    }

    /// `SoftFloat::multiply`.
    pub(super) fn multiply(&mut self, name: &str, a: Operand, b: Operand, bits: u32) -> Value {
        self.add(name, vec![product(a, b)], Unit::First(0), Some(bits))
    }

    /// `SoftFloat::from_wide`.
    pub(super) fn round(&mut self, name: &str, a: Operand, bits: u32) -> Value {
        self.add(name, vec![plain(a)], Unit::First(0), Some(bits))
    }

    /// `a` or `b`, or the constant `picked`, as [`Pick`] says.
    pub(super) fn pick(
        &mut self,
        name: &str,
        pick: Pick,
        a: Value,
        b: Operand,
        picked: Option<&'static str>,
    ) -> Value {
        let term = Term {
            pick,
            picked,
            b,
            ..plain(value(a))
        };
        self.add(name, vec![term], Unit::First(0), None)
    }

    /// A table's entry and its step times the argument's rest.
    pub(super) fn looked_up(table: Table, a: Value) -> Vec<Term> {
        let entry = Term {
            table,
            entry: true,
            ..plain(value(a))
        };
        let step = Term {
            table,
            ..product(value(a), Operand::None)
        };
        vec![entry, step]
    }

    /// `reciprocal` of a positive number.
    pub(super) fn reciprocal(&mut self, name: &str, a: Value, bits: u32) -> Value {
        let mut terms = Self::looked_up(Table::Reciprocal, a);
        terms[1].before = true;
        let seed = self.add(&format!("{name}, seed"), terms, Unit::First(0), None);
        let wrong = vec![less(product(value(a), value(seed)))];
        let defect = self.add_to(
            &format!("{name}, defect"),
            "reciprocal_one",
            wrong,
            Unit::At(-47),
        );
        let terms = vec![plain(value(seed)), product(value(seed), value(defect))];
        self.add(name, terms, Unit::First(-30), Some(bits))
    }

    /// `root_seed`.
    pub(super) fn root(&mut self, name: &str, a: Value, bits: u32) -> Value {
        self.add(
            name,
            Self::looked_up(Table::Root, a),
            Unit::First(0),
            Some(bits),
        )
    }

    /// The factors of these results as the core's outputs, and the program.
    pub(super) fn finish(mut self, results: [[Value; 2]; 8]) -> Result<Program> {
        let terms = results.map(|[a, b]| product(value(a), value(b)));
        let out = self.add("results", terms.to_vec(), Unit::First(0), None);
        self.operations[out].out = true;
        Program::new(self.operations)
    }
}
