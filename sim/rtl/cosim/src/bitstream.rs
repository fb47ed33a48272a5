//! A bitstream of the primitive for the ECP5 LFE5U-85F: synthesised, placed, routed and packed by open tools alone.
//!
//! The primitive stands between shift registers on three pins, as where its Fmax is measured, since a device has fewer pins than it has ports. So
//! the bitstream shows that the circuit goes through all tools to its end and what it occupies; a board puts its own shell in the registers' place.

use crate::fmax::{configuration, first_that_runs};
use crate::mutants::run;
use anyhow::{Context, Result};
use splatline_sim::atomic;
use splatline_sim::machine::area::synthesis::subjects;
use std::fs;
use std::path::Path;
use std::process::Command;

/// Programs that pack a bitstream: the first that runs is taken.
const PACKERS: &[&str] = &["ecppack", "yowasp-ecppack"];

/// Writes the bitstream of a design with so many lanes into a file; gives a line about it.
pub fn write(design: &str, lanes: u32, file: &Path) -> Result<String> {
    let subject = subjects()
        .into_iter()
        .find(|subject| subject.name == design);
    let subject = subject.with_context(|| format!("{design}: no such design"))?;
    let packer =
        first_that_runs(PACKERS).with_context(|| format!("{} not found", PACKERS.join(" or ")))?;
    let folder = tempfile::tempdir()?;
    let (fabric, fmax) = configuration(&subject, lanes, folder.path())?;
    run(Command::new(packer)
        .args(["--compress", "circuit.config", "circuit.bit"])
        .current_dir(folder.path()))?;
    let bits = fs::read(folder.path().join("circuit.bit"))?;
    atomic::write(file, &bits)?;
    let resources = fabric
        .resources()
        .map(|(name, count)| format!("{count} {name}"));
    Ok(format!(
        "{design}, {lanes} lanes: {}, {fmax:.1} MHz, {} bytes",
        resources.join(", "),
        bits.len()
    ))
}
