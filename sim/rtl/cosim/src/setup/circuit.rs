//! Setup units that are built while the program runs: of any design, with any number of cores, or with one mistake in them.

use super::program::{SetupProgram, program};
use super::text::with_program;
use crate::mutants::Mutant;
use crate::package;
use crate::switch::with_choices;
use crate::verilate::{self, VerilatorTarget, units, write};
use anyhow::Result;
use splatline::format::Widths;
use std::path::{Path, PathBuf};

/// What is built.
#[derive(Clone, Copy)]
pub struct SetupSpec<'a> {
    /// Name of the design, for its packages.
    pub design: &'a str,
    /// Its widths.
    pub widths: &'a Widths,
    /// What the cores compute.
    pub program: SetupProgram,
    /// Cores.
    pub cores: usize,
    /// A mistake.
    pub mistake: Option<&'a Mutant>,
    /// Mistakes of which a number picks one when it is simulated.
    pub choices: &'a [Mutant],
    /// The C++ compiler's effort: little where building takes longer than running.
    pub effort: &'a str,
}

impl<'a> SetupSpec<'a> {
    /// The unit as it is.
    pub fn new(design: &'a str, widths: &'a Widths, cores: usize) -> SetupSpec<'a> {
        SetupSpec {
            design,
            widths,
            program,
            cores,
            mistake: None,
            choices: &[],
            effort: "-O1",
        }
    }
}

/// Builds the unit as a shared library in a folder.
pub fn library(folder: &Path, spec: &SetupSpec) -> Result<PathBuf> {
    let SetupSpec { design, widths, .. } = *spec;
    let mut files = vec![
        (
            "splatline_pkg.sv".to_owned(),
            package::text(design, widths)?,
        ),
        (
            "splatline_setup_pkg.sv".to_owned(),
            with_program(design, widths, spec.program)?,
        ),
    ];
    files.extend(units("setup_files.txt")?);
    let files = with_choices(files, spec.choices)?;
    let sources = write(folder, files, spec.mistake)?;
    let target = VerilatorTarget {
        top: "setup_unit",
        parameters: &[format!("CORES={}", spec.cores)],
        prefix: "Vsetup",
        shims: &["setup_shim.cpp"],
        definitions: &[],
        effort: spec.effort,
    };
    verilate::library(folder, &sources, &target)
}
