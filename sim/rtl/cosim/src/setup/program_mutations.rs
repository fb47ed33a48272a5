//! Programs with one mistake each in what distance scaling and compensation add, which the comparison with the kernel must notice.
//!
//! A program is data of the circuit, in a package, and no choice can be made there: a circuit is built for each.

use super::assemble::{Operand, Operation, Program, Value};
use super::builder::{constant, plain, value};
use super::program::{Protection, SetupProgram, with_compensation, with_distance_scaling};
use super::unit::SetupUnit;
use crate::circuit::Effort;
use crate::unit::{Extent, Unit};
use anyhow::Result;
use splatline::format::Widths;

/// What went wrong, in words, and the program.
pub const DISTANCE_MUTATIONS: [(&str, SetupProgram); 7] = [
    ("the larger gain", |widths| {
        edited(with_distance_scaling, widths, |all| {
            factor(all, "smaller gain", constant("focal_u"))
        })
    }),
    ("k itself lies beyond", |widths| {
        edited(with_distance_scaling, widths, |all| {
            last(all, "beyond k").addend = Some("reciprocal_one")
        })
    }),
    ("enlarged nearer than k too", |widths| {
        edited(with_distance_scaling, widths, |all| {
            let term = &mut last(all, "d/k or 1").terms[0];
            *term = plain(term.b);
        })
    }),
    ("one direction of one axis not enlarged", |widths| {
        edited(with_distance_scaling, widths, |all| {
            factor(all, "enlarged", constant("one"))
        })
    }),
    ("dimmed by k/d alone", |widths| {
        edited(with_distance_scaling, widths, |all| {
            factor(all, "weight (k/d)^2", constant("one"))
        })
    }),
    ("weights rounded nearer than k", |widths| {
        let bits = u32::from(widths.mantissa);
        edited(with_distance_scaling, widths, |all| {
            last(all, "weight, dimmed or not").bits = Some(bits)
        })
    }),
    ("normalised kernels dimmed", |widths| {
        edited(with_distance_scaling, widths, |all| {
            let dimmed = place(all, "weight, dimmed or not");
            last(all, "weight of the area").terms[0].a = value(dimmed);
        })
    }),
];

/// The same of compensated opacities.
pub const COMPENSATION_MUTATIONS: [(&str, SetupProgram); 5] = [
    ("a minor left out", |widths| {
        edited(with_compensation, widths, |all| {
            last(all, "sharp determinant").terms.pop();
        })
    }),
    ("the quotient of variances, not of areas", |widths| {
        edited(with_compensation, widths, |all| {
            let whole = place(all, "determinant");
            last(all, "kept").terms[0].a = value(whole);
        })
    }),
    ("twice the root", |widths| {
        edited(with_compensation, widths, |all| {
            let twice = place(all, "kept, root, twice");
            factor(all, "weight, compensated", value(twice));
        })
    }),
    ("without the root", |widths| {
        edited(with_compensation, widths, |all| {
            let kept = place(all, "kept");
            factor(all, "weight, compensated", value(kept));
        })
    }),
    ("opacities as they are", |widths| {
        edited(with_compensation, widths, |all| {
            factor(all, "weight, compensated", constant("one"))
        })
    }),
];

/// All of them, with what the right program protects by.
pub fn program_mutations() -> impl Iterator<Item = (&'static str, Protection, SetupProgram)> {
    let of = |protection| move |(name, program)| (name, protection, program);
    let distance = DISTANCE_MUTATIONS.into_iter();
    let compensation = COMPENSATION_MUTATIONS.into_iter();
    let distance = distance.map(of(Protection::DistanceScaling));
    distance.chain(compensation.map(of(Protection::Compensation)))
}

fn edited(
    program: SetupProgram,
    widths: &Widths,
    edit: impl Fn(&mut [Operation]),
) -> Result<Program> {
    let mut all = program(widths)?.operations;
    edit(&mut all);
    Program::new(all)
}

/// The last operation of this name; the list has one.
fn place(all: &[Operation], name: &str) -> Value {
    let found = all.iter().rposition(|operation| operation.name == name);
    found.unwrap_or_else(|| panic!("the program has no '{name}'"))
}

fn last<'a>(all: &'a mut [Operation], name: &str) -> &'a mut Operation {
    let place = place(all, name);
    &mut all[place]
}

/// Another second factor.
fn factor(all: &mut [Operation], name: &str, factor: Operand) {
    last(all, name).terms[0].b = factor;
}

/// What the comparison says of a circuit of one core with a program, or with the right one: its first difference, or nothing if there is none.
pub fn verdict(protection: Protection, program: Option<SetupProgram>) -> Result<Option<String>> {
    let unit = SetupUnit::new("lean18", 1, protection)?;
    let circuit = unit.circuit().clone();
    let circuit = match program {
        Some(program) => circuit.with_program(program),
        None => circuit,
    };
    let library = circuit.library(Effort::Little)?;
    let unit = unit.around(circuit);
    let loads = unit.loads(Extent::Quick, &mut Vec::new())?;
    Ok(unit.first_difference(&library, 0, &loads))
}
