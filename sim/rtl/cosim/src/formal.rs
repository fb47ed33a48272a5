//! The units that keep the primitive's promises, proven: `sim/rtl/formal` says what they promise, and Yosys' solver
//! that it holds in every cycle of every run.
//!
//! Safety is proven by induction: it holds for some cycles from reset on, and if it holds for a few cycles, then for
//! the next. Liveness of several units together is not inductive without a full account of their states; it is shown
//! for every run of so many cycles from reset on. Each property is also seen to fail where a unit has a mistake
//! (`mutations.tsv`), since a property that cannot fail says nothing.

use crate::circuit::{Parameter, Source, set, write};
use crate::mutation::{Mutation, mutations, replaced};
use crate::tools::{printed, rtl};
use anyhow::{Context, Result, ensure};
use serde::Deserialize;
use std::fs;
use std::process::Command;

/// A module, and the parameters that it is proven for: all of them are small, and the argument does not depend on them.
#[derive(Debug, Deserialize)]
struct Proof {
    /// What it is the proof of among the judges of `mutations.tsv`.
    judge: &'static str,
    /// The module.
    unit: &'static str,
    /// The units that it is made of, and last the one whose properties are shown.
    files: Vec<&'static str>,
    parameters: Vec<Parameter>,
    /// What is written otherwise in the package. The whole primitive has tiles of 2 x 4 pixels, which are cleared
    /// within the cycles that are looked at.
    #[serde(default)]
    package: Vec<(&'static str, &'static str)>,
    /// Cycles from reset on in which it is shown, and in which a mistake must show.
    cycles: u32,
    /// Cycles that induction goes by at most, if it does.
    induction: Option<u32>,
}

/// What is proven.
fn proofs() -> Result<Vec<Proof>> {
    serde_json::from_str(include_str!("../../formal/proofs.json")).context("proofs.json")
}

impl Proof {
    /// What a mistake must show in.
    fn after_reset(&self) -> String {
        format!("-tempinduct-baseonly -maxsteps {}", self.cycles)
    }
}

/// Proves everything and every mutation's counterexample; prints a table.
pub fn report() -> Result<()> {
    println!(
        "| unit | with | from reset on, cycles | holds | by induction |\n|---|---|---|---|---|"
    );
    for proof in &proofs()? {
        let Proof { cycles, .. } = proof;
        let parameters = proof.parameters.iter();
        let parameters = parameters.map(|(name, value)| format!(" {name} {value}"));
        let unit = proof.unit.to_owned() + &parameters.collect::<String>();
        let base = holds(proof, None, &proof.after_reset())?;
        let step = |most| holds(proof, None, &format!("-tempinduct -maxsteps {most}"));
        let step = proof.induction.map(step).transpose()?;
        let by_induction = step.map_or("not tried".to_owned(), |step| step.to_string());
        println!("| {unit} | no mistake | {cycles} | {base} | {by_induction} |");
        let kept = base && step != Some(false);
        ensure!(kept, "{unit} does not keep its promises");
        for mutation in mutations(&format!("proof of {}", proof.judge))? {
            let base = holds(proof, Some(&mutation), &proof.after_reset())?;
            let name = &mutation.name;
            println!("| {unit} | {name} | {cycles} | {base} | |");
            ensure!(!base, "{unit}: '{name}' is not noticed");
        }
    }
    Ok(())
}

/// A unit's file without its folder, and its text, with the mutation if it is in this one.
fn source(file: &str, mutation: Option<&Mutation>) -> Result<Source> {
    let text = fs::read_to_string(rtl().join(file))?;
    let name = file.trim_start_matches("formal/").to_owned();
    match mutation.filter(|mutation| mutation.file == file) {
        Some(mutation) => Ok((name, mutation.applied(&text)?)),
        None => Ok((name, text)),
    }
}

/// Do the properties hold, shown by the solver in this way?
fn holds(proof: &Proof, mutation: Option<&Mutation>, way: &str) -> Result<bool> {
    let folder = tempfile::tempdir()?;
    let mut package = fs::read_to_string(rtl().join("lean18/splatline_pkg.sv"))?;
    for (usual, few) in &proof.package {
        package = replaced(&package, usual, few)?;
    }
    let mut sources = vec![("splatline_pkg.sv".to_owned(), package)];
    let packages = ["splatline_tables.sv", "splatline_math.sv"];
    for file in packages.iter().chain(&proof.files) {
        sources.push(source(file, mutation)?);
    }
    let paths = write(folder.path(), &sources)?;
    // The units' own properties lie beside them; only the last file's are asked for here.
    let (last, others) = paths.split_last().context("a proof of no file")?;
    let Proof { unit, .. } = proof;
    let script = format!(
        "read_verilog -sv {}; read_verilog -sv -formal {last}; {}hierarchy -top {unit}; \
         proc; flatten; opt_clean; memory; opt -full; techmap; opt -full; dffunmap; opt_clean; \
         sat {way} -prove-asserts -set-assumes {unit}",
        others.join(" "),
        set(unit, &proof.parameters)
    );
    let mut command = Command::new("yosys");
    let words = printed(command.args(["-p", &script]).current_dir(rtl()))?;
    let says = |verdict: &str| words.contains(verdict);
    let fails = says("model found for base case") || says("-> proof failed");
    ensure!(
        fails || says("proved base case for") || says("Induction step proven"),
        "Yosys came to no verdict:\n{words}"
    );
    Ok(!fails)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mutations_are_made_in_the_units_that_there_are() {
        for proof in &proofs().unwrap() {
            for mutation in mutations(&format!("proof of {}", proof.judge)).unwrap() {
                let file = mutation.file.as_str();
                assert!(proof.files.contains(&file), "{}", mutation.name);
                let (_, text) = source(file, Some(&mutation)).unwrap();
                assert!(text.contains(&mutation.to), "{}", mutation.name);
            }
        }
    }
}
