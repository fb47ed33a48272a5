//! Programs with one mistake each in what distance scaling adds: does the comparison with the kernel notice it?
//!
//! A program is data of the circuit, in a package, and no choice can be made there: a circuit is built for each mistake.

use super::assemble::{Operand, Operation, Program, Value};
use super::builder::{constant, plain, value};
use super::circuit::{SetupSpec, library};
use super::distant::distant;
use super::mistakes::{WIDTHS, first_difference};
use super::program::{SetupProgram, with_distance_scaling};
use anyhow::Result;
use splatline::format::Widths;

/// A program that is wrong.
pub struct ProgramMistake {
    /// What went wrong, in words.
    pub name: &'static str,
    /// The program.
    pub program: SetupProgram,
}

/// The mistakes.
pub const PROGRAM_MISTAKES: [ProgramMistake; 7] = [
    mistake("the larger gain", |widths| {
        edited(widths, |all| {
            factor(all, "smaller gain", constant("focal_u"))
        })
    }),
    mistake("k itself lies beyond", |widths| {
        edited(widths, |all| {
            last(all, "beyond k").addend = Some("reciprocal_one")
        })
    }),
    mistake("enlarged nearer than k too", |widths| {
        edited(widths, |all| {
            let term = &mut last(all, "d/k or 1").terms[0];
            *term = plain(term.b);
        })
    }),
    mistake("one direction of one axis not enlarged", |widths| {
        edited(widths, |all| factor(all, "enlarged", constant("one")))
    }),
    mistake("dimmed by k/d alone", |widths| {
        edited(widths, |all| factor(all, "weight (k/d)^2", constant("one")))
    }),
    mistake("weights rounded nearer than k", |widths| {
        let bits = u32::from(widths.mantissa);
        edited(widths, |all| {
            last(all, "weight, dimmed or not").bits = Some(bits)
        })
    }),
    mistake("normalised kernels dimmed", |widths| {
        edited(widths, |all| {
            let dimmed = place(all, "weight, dimmed or not");
            last(all, "weight of the area").terms[0].a = value(dimmed);
        })
    }),
];

const fn mistake(name: &'static str, program: SetupProgram) -> ProgramMistake {
    ProgramMistake { name, program }
}

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
    let folder = tempfile::tempdir()?;
    let spec = SetupSpec {
        program,
        effort: "-O0",
        ..SetupSpec::new("lean18", &WIDTHS, 1)
    };
    let library = library(folder.path(), &spec)?;
    first_difference(&library, 0, program, &distant(100, 1), &[0])
}
