//! Sorters that are built while the program runs: with digits of any width, or with one mistake in them.

use crate::mutants::Mutant;
use crate::verilate::{self, VerilatorTarget, units, write};
use anyhow::Result;
use std::path::{Path, PathBuf};

/// Builds the circuit as a shared library in a folder.
pub fn library(
    folder: &Path,
    digit: u32,
    mistake: Option<&Mutant>,
    effort: &str,
) -> Result<PathBuf> {
    let sources = write(folder, units("order_files.txt")?, mistake)?;
    let target = VerilatorTarget {
        top: "splat_order",
        parameters: &[format!("DIGIT={digit}")],
        prefix: "Vorder",
        shims: &["order_shim.cpp"],
        definitions: &[],
        effort,
    };
    verilate::library(folder, &sources, &target)
}
