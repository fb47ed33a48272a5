//! Harmonics units that are built while the program runs: with one multiplier or two, or with mistakes in them.

use crate::mutants::Mutant;
use crate::switch::with_choices;
use crate::verilate::{self, VerilatorTarget, units, write};
use anyhow::Result;
use std::path::{Path, PathBuf};

/// Numbers of multipliers for which there is a circuit.
pub const MULTIPLIERS: [u32; 2] = [1, 2];

/// What is built.
#[derive(Clone, Copy)]
pub struct HarmonicsSpec<'a> {
    /// Multipliers.
    pub multipliers: u32,
    /// A mistake.
    pub mistake: Option<&'a Mutant>,
    /// Mistakes of which a number picks one when it is simulated.
    pub choices: &'a [Mutant],
    /// The C++ compiler's effort.
    pub effort: &'a str,
}

impl HarmonicsSpec<'_> {
    /// The unit as it is.
    pub fn new(multipliers: u32) -> HarmonicsSpec<'static> {
        HarmonicsSpec {
            multipliers,
            mistake: None,
            choices: &[],
            effort: "-O1",
        }
    }
}

/// Builds the unit as a shared library in a folder.
pub fn library(folder: &Path, spec: &HarmonicsSpec) -> Result<PathBuf> {
    let files = with_choices(units("harmonics_files.txt")?, spec.choices)?;
    let sources = write(folder, files, spec.mistake)?;
    let target = VerilatorTarget {
        top: "harmonics_unit",
        parameters: &[format!("MULTIPLIERS={}", spec.multipliers)],
        prefix: "Vharmonics",
        shims: &["harmonics_shim.cpp"],
        definitions: &[],
        effort: spec.effort,
    };
    verilate::library(folder, &sources, &target)
}
