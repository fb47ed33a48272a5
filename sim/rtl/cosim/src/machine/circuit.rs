//! Machines that are built while the program runs: of any design, with any number of cores and lanes, or with one mistake in them.

use crate::mutants::Mutant;
use crate::setup::program::{SetupProgram, program};
use crate::setup::text::with_program;
use crate::switch::with_choices;
use crate::verilate::{self, VerilatorTarget, units, write};
use crate::{area, package};
use anyhow::Result;
use splatline::format::Widths;
use std::path::{Path, PathBuf};

/// What is built.
#[derive(Clone, Copy)]
pub struct MachineSpec<'a> {
    /// Name of the design, for its packages.
    pub design: &'a str,
    /// Its widths.
    pub widths: &'a Widths,
    /// What the cores of setup compute.
    pub program: SetupProgram,
    /// Cores of setup.
    pub cores: usize,
    /// Lanes.
    pub lanes: usize,
    /// A mistake.
    pub mistake: Option<&'a Mutant>,
    /// Mistakes of which a number picks one when it is simulated.
    pub choices: &'a [Mutant],
    /// The C++ compiler's effort.
    pub effort: &'a str,
}

impl<'a> MachineSpec<'a> {
    /// The machine as it is.
    pub fn new(design: &'a str, widths: &'a Widths, cores: usize, lanes: usize) -> MachineSpec<'a> {
        MachineSpec {
            design,
            widths,
            program,
            cores,
            lanes,
            mistake: None,
            choices: &[],
            effort: "-O1",
        }
    }
}

/// Builds the machine as a shared library in a folder.
pub fn library(folder: &Path, spec: &MachineSpec) -> Result<PathBuf> {
    let MachineSpec { design, widths, .. } = *spec;
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
    files.extend(units("machine_files.txt")?);
    let files = with_choices(files, spec.choices)?;
    let mut sources = write(folder, files, spec.mistake)?;
    sources.push(area::rtl().join("cosim/flat_machine.sv"));
    let target = VerilatorTarget {
        top: "flat_machine",
        parameters: &[
            format!("CORES={}", spec.cores),
            format!("LANES={}", spec.lanes),
        ],
        prefix: "Vmachine",
        shims: &["machine_shim.cpp"],
        definitions: &[],
        effort: spec.effort,
    };
    verilate::library(folder, &sources, &target)
}
