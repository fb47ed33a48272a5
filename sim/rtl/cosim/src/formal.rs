//! The queues, proven: `sim/rtl/formal` says what they promise, and a solver that it holds in every cycle of every run.
//!
//! The proof is by induction: it holds for some cycles from reset on, and if it holds for two cycles, then for the next. Each property is also seen to
//! fail where the unit has a mistake, since a property that cannot fail says nothing.

use crate::mutants::run;
use anyhow::{Context, Result, ensure};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A unit, the parameters that it is proven for (all of them are small, and the argument does not depend on them), and mistakes in it.
#[derive(Clone, Copy, Debug)]
pub struct Proof {
    /// The module.
    pub unit: &'static str,
    parameters: &'static str,
    /// Cycles from reset on in which a mistake must show.
    cycles: &'static str,
    /// What goes wrong, text of the unit, and the mistake.
    pub mistakes: &'static [[&'static str; 3]],
}

/// What is proven.
pub const PROOFS: [Proof; 2] = [
    Proof {
        unit: "fifo",
        parameters: "-set BITS 4 -set PLACES 4",
        cycles: "7",
        mistakes: &[
            [
                "a place too many",
                "free <= claimed_next != PLACES[INDEX:0]",
                "free <= 1'b1",
            ],
            [
                "places come back too early",
                "{{INDEX{1'b0}}, out_valid && out_ready};\n  assign none",
                "{{INDEX{1'b0}}, out_valid};\n  assign none",
            ],
            [
                "an entry that waits is overwritten",
                "assign word_moves = !word_valid || out_moves",
                "assign word_moves = 1'b1",
            ],
            [
                "an entry is read twice",
                "if (head != tail) head <= head + 1'b1",
                "if (head != tail && out_moves) head <= head + 1'b1",
            ],
            [
                "an entry is lost",
                "if (in_valid) tail",
                "if (in_valid && !out_valid) tail",
            ],
        ],
    },
    Proof {
        unit: "run_queue",
        parameters: "-set DEPTH 2",
        cycles: "6",
        mistakes: &[
            [
                "taken when full",
                "assign put = in_valid && in_ready",
                "assign put = in_valid",
            ],
            [
                "a run that waits is overwritten",
                "count != 0 && (!out_valid || out_ready)",
                "count != 0",
            ],
            [
                "the last run stays",
                "moves || (out_valid && !out_ready)",
                "moves || out_valid",
            ],
            [
                "a run comes twice",
                "if (moves) head <= head + 1'b1",
                "if (moves && put) head <= head + 1'b1",
            ],
        ],
    },
];

/// Proves everything and every mistake's counterexample; prints a table.
pub fn report() -> Result<()> {
    println!("| unit | with | from reset on | by induction |\n|---|---|---|---|");
    for proof in &PROOFS {
        let text = fs::read_to_string(rtl().join(format!("{}.sv", proof.unit)))?;
        let [base, step] = verdict(proof, &text)?;
        println!("| {} | no mistake | {base} | {step} |", proof.unit);
        ensure!(base && step, "{} does not keep its promises", proof.unit);
        for [name, from, to] in proof.mistakes {
            let places = text.matches(from).count();
            ensure!(
                places == 1,
                "{}: '{from}' occurs {places} times, not once; adapt the mistake",
                proof.unit
            );
            let [base, _] = verdict(proof, &text.replace(from, to))?;
            println!("| {} | {name} | {base} | |", proof.unit);
            ensure!(!base, "{}: '{name}' is not noticed", proof.unit);
        }
    }
    Ok(())
}

fn rtl() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Do the properties hold for some cycles from reset on, and does induction close?
fn verdict(proof: &Proof, text: &str) -> Result<[bool; 2]> {
    let folder = tempfile::tempdir()?;
    let unit = folder.path().join(format!("{}.sv", proof.unit));
    fs::write(&unit, text)?;
    let problem = folder.path().join("problem.smt2");
    let Proof {
        unit: name,
        parameters,
        ..
    } = proof;
    let script = format!(
        "read_verilog -sv -formal lean18/splatline_pkg.sv splatline_math.sv {}; chparam {parameters} {name}; hierarchy -top {name}; proc; opt_clean; \
         memory -nomap -nordff; dffunmap; write_smt2 -wires {}",
        unit.display(),
        problem.display()
    );
    run(Command::new("yosys")
        .args(["-q", "-p", &script])
        .current_dir(rtl()))?;
    let holds = |options: &[&str]| -> Result<bool> {
        let output = Command::new("yosys-smtbmc")
            .args(["-s", "z3"])
            .args(options)
            .arg(&problem)
            .output()
            .context("cannot run yosys-smtbmc: is Yosys installed, and z3?")?;
        let said = String::from_utf8_lossy(&output.stdout).into_owned();
        ensure!(
            said.contains("Status: "),
            "yosys-smtbmc came to no verdict:\n{said}{}",
            String::from_utf8_lossy(&output.stderr)
        );
        Ok(said.contains("Status: PASSED"))
    };
    Ok([holds(&["-t", proof.cycles])?, holds(&["-i", "-t", "2"])?])
}
