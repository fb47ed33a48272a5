//! The units that keep the primitive's promises, proven: `sim/rtl/formal` says what they promise, and a solver that it holds in every cycle of every run.
//!
//! Safety is proven by induction: it holds for some cycles from reset on, and if it holds for a few cycles, then for the next. Liveness of several units
//! together is not inductive without a full account of their states; it is shown for every run of so many cycles from reset on. Each property is also seen
//! to fail where a unit has a mistake (`mutations.tsv`), since a property that cannot fail says nothing.

use crate::mutation::{Mutation, mutations};
use crate::tools::{printed, rtl, yosys};
use anyhow::{Context, Result, ensure};
use std::fs;
use std::process::Command;

/// A module, and the parameters that it is proven for: all of them are small, and the argument does not depend on them.
#[derive(Clone, Copy, Debug)]
struct Proof {
    /// What it is the proof of among the judges of `mutations.tsv`.
    judge: &'static str,
    /// The module.
    unit: &'static str,
    /// The units that it is made of, if not one alone; those whose properties lie beside them stand alone.
    files: &'static [&'static str],
    /// Names and values.
    parameters: &'static str,
    /// Cycles from reset on in which it is shown, and in which a mistake must show.
    cycles: &'static str,
    /// Cycles that induction goes by, if it does.
    induction: Option<&'static str>,
}

/// What is proven.
const PROOFS: [Proof; 10] = [
    inductive("fifo", "BITS 4 PLACES 4", ["7", "2"]),
    Proof {
        judge: "fifo at rest",
        ..inductive("fifo", "BITS 4 PLACES 4 RESTS 1", ["7", "2"])
    },
    Proof {
        judge: "fifo of parts",
        ..inductive(
            "fifo",
            "BITS 4 PLACES 4 PARTS 2 ENDS 262146 SEEN 2",
            ["7", "2"],
        )
    },
    inductive("run_queue", "DEPTH 2", ["6", "2"]),
    inductive("visible_box", "", ["3", "4"]),
    inductive("row_counter", "", ["6", "2"]),
    inductive("row_window", "", ["6", "6"]),
    inductive("lane", "", ["10", "7"]),
    Proof {
        files: &[
            "delay.sv",
            "packet_decode.sv",
            "run_paint.sv",
            "formal/idle_units.sv",
            "splat_primitive.sv",
        ],
        ..inductive("splat_primitive", "LANES 2", ["22", "2"])
    },
    Proof {
        files: &["fifo.sv", "run_queue.sv", "lane.sv", "formal/chain.sv"],
        induction: None,
        ..inductive("chain", "", ["40", ""])
    },
];

/// A unit with its parameters, shown for some cycles from reset on and by an induction of some.
const fn inductive(
    unit: &'static str,
    parameters: &'static str,
    [cycles, induction]: [&'static str; 2],
) -> Proof {
    Proof {
        judge: unit,
        unit,
        files: &[],
        parameters,
        cycles,
        induction: Some(induction),
    }
}

impl Proof {
    fn files(&self) -> Vec<String> {
        match self.files {
            [] => vec![format!("{}.sv", self.unit)],
            files => files.iter().map(|file| (*file).to_owned()).collect(),
        }
    }
}

/// Proves everything and every mutation's counterexample; prints a table.
pub fn report() -> Result<()> {
    println!(
        "| unit | with | from reset on, cycles | holds | by induction |\n|---|---|---|---|---|"
    );
    for proof in &PROOFS {
        let Proof { cycles, .. } = proof;
        let unit = format!("{} {}", proof.unit, proof.parameters);
        let unit = unit.trim_end();
        let (base, step) = verdict(proof, None)?;
        let by_induction = step.map_or("not tried".to_owned(), |step| step.to_string());
        println!("| {unit} | no mistake | {cycles} | {base} | {by_induction} |");
        ensure!(
            base && step != Some(false),
            "{unit} does not keep its promises"
        );
        for mutation in mutations(&format!("proof of {}", proof.judge))? {
            let (base, _) = verdict(proof, Some(&mutation))?;
            let name = &mutation.name;
            println!("| {unit} | {name} | {cycles} | {base} | |");
            ensure!(!base, "{unit}: '{name}' is not noticed");
        }
    }
    Ok(())
}

/// The package that a unit is proven with. The whole primitive has tiles of 2 x 4 pixels, which are cleared within the cycles that are looked at.
fn package_text(unit: &str) -> Result<String> {
    let text = fs::read_to_string(rtl().join("lean18/splatline_pkg.sv"))?;
    if unit != "splat_primitive" {
        return Ok(text);
    }
    let mut small = text;
    for (usual, few) in [
        ("TILE_COLUMN_BITS = 5", "TILE_COLUMN_BITS = 1"),
        ("BLOCK_BITS = 5", "BLOCK_BITS = 1"),
        ("TILE_ROW_BITS = 5", "TILE_ROW_BITS = 2"),
    ] {
        ensure!(small.contains(usual), "the package has no '{usual}'");
        small = small.replace(usual, few);
    }
    Ok(small)
}

/// A unit's text, with the mutation if it is in this one.
fn source(file: &str, mutation: Option<&Mutation>) -> Result<String> {
    let text = fs::read_to_string(rtl().join(file))?;
    match mutation.filter(|mutation| mutation.file == file) {
        Some(mutation) => mutation.applied(&text),
        None => Ok(text),
    }
}

/// Do the properties hold for some cycles from reset on, and does induction close?
fn verdict(proof: &Proof, mutation: Option<&Mutation>) -> Result<(bool, Option<bool>)> {
    let folder = tempfile::tempdir()?;
    let mut paths = Vec::new();
    for (number, file) in proof.files().iter().enumerate() {
        let path = folder.path().join(format!("{number}.sv"));
        fs::write(&path, source(file, mutation)?)?;
        paths.push(path.display().to_string());
    }
    let Some(induction) = proof.induction else {
        return Ok((within(proof, &paths)?, None));
    };
    let problem = folder.path().join("problem.smt2");
    let unit = proof.unit;
    let words: Vec<&str> = proof.parameters.split_whitespace().collect();
    let sets = words
        .chunks(2)
        .map(|set| format!(" -set {}", set.join(" ")));
    let parameters = match sets.collect::<String>() {
        sets if sets.is_empty() => sets,
        sets => format!("chparam{sets} {unit}; "),
    };
    let package = folder.path().join("splatline_pkg.sv");
    fs::write(&package, package_text(unit)?)?;
    let script = format!(
        "read_verilog -sv -formal {} splatline_math.sv {}; {parameters}hierarchy -top {unit}; proc; opt_clean; \
         memory -nomap -nordff; dffunmap; write_smt2 -wires {}",
        package.display(),
        paths.join(" "),
        problem.display()
    );
    yosys(&script)?;
    let holds = |options: &[&str]| -> Result<bool> {
        let mut solver = Command::new("yosys-smtbmc");
        solver.args(["-s", "z3"]).args(options).arg(&problem);
        let words = printed(&mut solver)?;
        ensure!(
            words.contains("Status: "),
            "yosys-smtbmc came to no verdict:\n{words}"
        );
        Ok(words.contains("Status: PASSED"))
    };
    let base = holds(&["-t", proof.cycles])?;
    // A mistake has shown: induction would say nothing more.
    let step = base.then(|| holds(&["-i", "-t", induction])).transpose()?;
    Ok((base, step))
}

/// The same for several units together and from reset on only: Yosys' own solver on their gates, which is far quicker here.
fn within(proof: &Proof, paths: &[String]) -> Result<bool> {
    let Proof { unit, cycles, .. } = proof;
    // The units' own properties lie beside them; only the last file's are asked for here.
    let (last, units) = paths.split_last().context("a proof of no file")?;
    let script = format!(
        "read_verilog -sv splatline_tables.sv lean18/splatline_pkg.sv splatline_math.sv {}; read_verilog -sv -formal {last}; hierarchy -top {unit}; \
         proc; flatten; opt_clean; memory; opt -full; techmap; opt -full; dffunmap; opt_clean; \
         sat -tempinduct-baseonly -maxsteps {cycles} -prove-asserts -set-assumes {unit}",
        units.join(" ")
    );
    let mut command = Command::new("yosys");
    let words = printed(command.args(["-p", &script]).current_dir(rtl()))?;
    let fails = words.contains("model found for base case");
    ensure!(
        fails || words.contains(&format!("proved base case for {cycles} steps")),
        "Yosys came to no verdict:\n{words}"
    );
    Ok(!fails)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mutations_are_made_in_the_units_that_there_are() {
        for proof in &PROOFS {
            for mutation in mutations(&format!("proof of {}", proof.judge)).unwrap() {
                let file = mutation.file.as_str();
                assert!(
                    proof.files().iter().any(|own| own == file),
                    "{}",
                    mutation.name
                );
                let text = source(file, Some(&mutation)).unwrap();
                assert!(text.contains(&mutation.to), "{}", mutation.name);
            }
        }
    }
}
