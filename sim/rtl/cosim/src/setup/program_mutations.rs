//! Programs with one mistake each in what distance scaling adds, which the comparison with the kernel must notice.
//!
//! A program is data of the circuit, in a package, and no choice can be made there: a circuit is built for each.

use super::assemble::{Operand, Operation, Program, Value};
use super::builder::{constant, plain, value};
use super::program::{SetupProgram, with_distance_scaling};
use super::unit::SetupUnit;
use crate::circuit::Effort;
use crate::unit::{Extent, Unit};
use anyhow::Result;
use splatline::format::Widths;

/// What went wrong, in words, and the program.
pub const PROGRAM_MUTATIONS: [(&str, SetupProgram); 7] = [
    ("the larger gain", |widths| {
        edited(widths, |all| {
            factor(all, "smaller gain", constant("focal_u"))
        })
    }),
    ("k itself lies beyond", |widths| {
        edited(widths, |all| {
            last(all, "beyond k").addend = Some("reciprocal_one")
        })
    }),
    ("enlarged nearer than k too", |widths| {
        edited(widths, |all| {
            let term = &mut last(all, "d/k or 1").terms[0];
            *term = plain(term.b);
        })
    }),
    ("one direction of one axis not enlarged", |widths| {
        edited(widths, |all| factor(all, "enlarged", constant("one")))
    }),
    ("dimmed by k/d alone", |widths| {
        edited(widths, |all| factor(all, "weight (k/d)^2", constant("one")))
    }),
    ("weights rounded nearer than k", |widths| {
        let bits = u32::from(widths.mantissa);
        edited(widths, |all| {
            last(all, "weight, dimmed or not").bits = Some(bits)
        })
    }),
    ("normalised kernels dimmed", |widths| {
        edited(widths, |all| {
            let dimmed = place(all, "weight, dimmed or not");
            last(all, "weight of the area").terms[0].a = value(dimmed);
        })
    }),
];

fn edited(widths: &Widths, edit: impl Fn(&mut [Operation])) -> Result<Program> {
    let mut all = with_distance_scaling(widths)?.operations;
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

/// What the comparison says of a program in a circuit of one core: its first difference, or nothing if there is none.
pub fn verdict(program: SetupProgram) -> Result<Option<String>> {
    let unit = SetupUnit::with_distance_scaling("lean18", 1)?;
    let circuit = unit.circuit().clone().with_program(program);
    let library = circuit.library(Effort::Little)?;
    let unit = unit.around(circuit);
    let loads = unit.loads(Extent::Quick, &mut Vec::new())?;
    Ok(unit.first_difference(&library, 0, &loads))
}
