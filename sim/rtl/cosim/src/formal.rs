//! The units that keep the primitive's promises, proven: `sim/rtl/formal` says what they promise, and a solver that it holds in every cycle of every run.
//!
//! Safety is proven by induction: it holds for some cycles from reset on, and if it holds for a few cycles, then for the next. Liveness of several units
//! together is not inductive without a full account of their states; it is shown for every run of so many cycles from reset on. Each property is also seen
//! to fail where a unit has a mistake, since a property that cannot fail says nothing.

use crate::mutants::{Mutant, mutant, run};
use anyhow::{Context, Result, ensure};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A module, the parameters that it is proven for (all of them are small, and the argument does not depend on them), and mistakes in it.
#[derive(Clone, Copy, Debug)]
pub struct Proof {
    /// The module.
    pub unit: &'static str,
    /// The units that it is made of; those whose properties lie beside them stand alone.
    files: &'static [&'static str],
    parameters: &'static str,
    /// Cycles from reset on in which it is shown, and in which a mistake must show.
    cycles: &'static str,
    /// Cycles that induction goes by, if it does.
    induction: Option<&'static str>,
    /// Mistakes that have to be noticed.
    pub mistakes: &'static [Mutant],
}

/// What is proven.
pub const PROOFS: [Proof; 9] = [
    Proof {
        unit: "fifo",
        files: &["fifo.sv"],
        parameters: "-set BITS 4 -set PLACES 4",
        cycles: "7",
        induction: Some("2"),
        mistakes: &QUEUE_MISTAKES,
    },
    Proof {
        unit: "fifo",
        files: &["fifo.sv"],
        parameters: "-set BITS 4 -set PLACES 4 -set RESTS 1",
        cycles: "7",
        induction: Some("2"),
        mistakes: &RESTING_MISTAKES,
    },
    Proof {
        unit: "run_queue",
        files: &["run_queue.sv"],
        parameters: "-set DEPTH 2",
        cycles: "6",
        induction: Some("2"),
        mistakes: &RUN_QUEUE_MISTAKES,
    },
    Proof {
        unit: "visible_box",
        files: &["visible_box.sv"],
        parameters: "",
        cycles: "3",
        induction: Some("4"),
        mistakes: &BOX_MISTAKES,
    },
    Proof {
        unit: "row_counter",
        files: &["row_counter.sv"],
        parameters: "",
        cycles: "6",
        induction: Some("2"),
        mistakes: &ROW_MISTAKES,
    },
    Proof {
        unit: "row_window",
        files: &["row_window.sv"],
        parameters: "",
        cycles: "6",
        induction: Some("6"),
        mistakes: &WINDOW_MISTAKES,
    },
    Proof {
        unit: "lane",
        files: &["lane.sv"],
        parameters: "",
        cycles: "10",
        induction: Some("7"),
        mistakes: &LANE_MISTAKES,
    },
    Proof {
        unit: "splat_primitive",
        files: &[
            "delay.sv",
            "packet_decode.sv",
            "formal/idle_units.sv",
            "splat_primitive.sv",
        ],
        parameters: "-set LANES 2",
        cycles: "22",
        induction: Some("2"),
        mistakes: &END_MISTAKES,
    },
    Proof {
        unit: "chain",
        files: &["fifo.sv", "run_queue.sv", "lane.sv", "formal/chain.sv"],
        parameters: "",
        cycles: "40",
        induction: None,
        mistakes: &LIVENESS_MISTAKES,
    },
];

const QUEUE_MISTAKES: [Mutant; 5] = [
    mutant(
        "a place too many",
        "fifo.sv",
        "free <= leaves || !(claimed == PLACES[INDEX:0] || (claim && claimed == (INDEX + 1)'(PLACES - 1)))",
        "free <= 1'b1",
    ),
    mutant(
        "places come back too early",
        "fifo.sv",
        "assign leaves = out_valid && out_ready",
        "assign leaves = out_valid",
    ),
    mutant(
        "an entry that waits is overwritten",
        "fifo.sv",
        "assign word_moves = !word_valid || out_moves",
        "assign word_moves = 1'b1",
    ),
    mutant(
        "an entry is read twice",
        "fifo.sv",
        "if (head != tail) head <= head + 1'b1",
        "if (head != tail && out_moves) head <= head + 1'b1",
    ),
    mutant(
        "an entry is lost",
        "fifo.sv",
        "if (in_valid) tail",
        "if (in_valid && !out_valid) tail",
    ),
];

const RESTING_MISTAKES: [Mutant; 2] = [
    mutant(
        "an entry comes twice",
        "fifo.sv",
        "else if (out_ready) out_valid <= 0",
        "else if (out_ready) out_valid <= 1",
    ),
    mutant(
        "an entry is overwritten while the queue rests",
        "fifo.sv",
        "assign word_moves = !word_valid || out_moves",
        "assign word_moves = !word_valid || out_moves || out_ready",
    ),
];

const RUN_QUEUE_MISTAKES: [Mutant; 4] = [
    mutant(
        "taken when full",
        "run_queue.sv",
        "assign put = in_valid && !full",
        "assign put = in_valid",
    ),
    mutant(
        "a run that waits is overwritten",
        "run_queue.sv",
        "some && (!out_valid || out_ready)",
        "some",
    ),
    mutant(
        "the last run stays",
        "run_queue.sv",
        "moves || (out_valid && !out_ready)",
        "moves || out_valid",
    ),
    mutant(
        "a run comes twice",
        "run_queue.sv",
        "if (moves) head <= head + 1'b1",
        "if (moves && put) head <= head + 1'b1",
    ),
];

/// Rows and columns outside the window.
const BOX_MISTAKES: [Mutant; 5] = [
    mutant(
        "rows above the window",
        "visible_box.sv",
        "first_row22 > window.first_row ? first_row22 : window.first_row",
        "first_row22",
    ),
    mutant(
        "rows below the window",
        "visible_box.sv",
        "end_row22 < window.end_row ? end_row22 : window.end_row",
        "end_row22",
    ),
    mutant(
        "a row too many",
        "visible_box.sv",
        "end_row23 - row23 :",
        "end_row23 - row23 + 16'd1 :",
    ),
    mutant(
        "rows of boxes beside the window",
        "visible_box.sv",
        "first_column23 < end_column23 && row23",
        "row23",
    ),
    mutant(
        "rows of boxes that end before they begin",
        "visible_box.sv",
        "&& row23 < end_row23",
        "",
    ),
];

/// Rows beyond a splat's last, missing ones, and some that come twice.
const ROW_MISTAKES: [Mutant; 5] = [
    mutant(
        "a row beyond the last",
        "row_counter.sv",
        "last <= left == 16'd2",
        "last <= left == 16'd1",
    ),
    mutant(
        "the last row is left out",
        "row_counter.sv",
        "last <= left == 16'd2",
        "last <= left <= 16'd3",
    ),
    mutant(
        "a splat without rows has all of them",
        "row_counter.sv",
        "last <= rows <= 16'd1",
        "last <= rows == 16'd1",
    ),
    mutant(
        "rows without a place",
        "row_counter.sv",
        "end else if (issue) begin",
        "end else begin",
    ),
    mutant(
        "the next splat comes before the last row",
        "row_counter.sv",
        "!busy || (issue && last)",
        "!busy || issue",
    ),
];

/// Pixels outside the window's columns, and runs without pixels.
const WINDOW_MISTAKES: [Mutant; 4] = [
    mutant(
        "the window's end is not cut off",
        "row_window.sv",
        "end18 <= high17 < end_column17 ? high17 : end_column17",
        "end18 <= high17",
    ),
    mutant(
        "the window's beginning is not cut off",
        "row_window.sv",
        "head20 <= head19[4:0];\n    count20 <= length19[COLUMN_BITS:0] - head19[COLUMN_BITS:0];\n    column20 <= x19 + head19[COLUMN_BITS-1:0]",
        "head20 <= head19[4:0];\n    count20 <= length19[COLUMN_BITS:0];\n    column20 <= x19",
    ),
    mutant(
        "what is cut off counts",
        "row_window.sv",
        "count20 <= length19[COLUMN_BITS:0] - head19[COLUMN_BITS:0]",
        "count20 <= length19[COLUMN_BITS:0]",
    ),
    mutant(
        "rows without a pixel hold one",
        "row_window.sv",
        "assign fits19 = head19 < length19",
        "assign fits19 = head19 <= length19",
    ),
];

/// Pixels outside the run, and pixels that come again too early.
const LANE_MISTAKES: [Mutant; 4] = [
    mutant(
        "a pixel beyond the run",
        "lane.sv",
        "(1) : at.count == (COLUMN_BITS + 1)'(2)",
        "(1) : at.count == (COLUMN_BITS + 1)'(1)",
    ),
    mutant(
        "a run of one pixel has two",
        "lane.sv",
        "!apart || run.count == (COLUMN_BITS + 1)'(1)",
        "!apart || run.count == 0",
    ),
    mutant(
        "a pixel comes again a cycle too early",
        "lane.sv",
        "d < INTERVAL - 1 - i",
        "d < INTERVAL - 2 - i",
    ),
    mutant(
        "the pixel that leaves next is forgotten",
        "lane.sv",
        "{left_valid, active, active && !final_pixel}",
        "{left_valid, active, 1'b0}",
    ),
];

/// Ends of tiles that come too early, and packets between two.
const END_MISTAKES: [Mutant; 9] = [
    mutant(
        "a tile ends while a packet comes",
        PRIMITIVE,
        "idle && !packet_valid && !reading",
        "idle && !reading",
    ),
    mutant(
        "packets are taken between tiles",
        PRIMITIVE,
        "packet_ready = decode_ready && state == DRAW",
        "packet_ready = decode_ready",
    ),
    mutant(
        "packets are drawn between tiles",
        PRIMITIVE,
        ".packet_valid(packet_valid && state == DRAW)",
        ".packet_valid(packet_valid)",
    ),
    mutant(
        "a packet just taken is forgotten",
        PRIMITIVE,
        "!packet_taken && &pixels_idle",
        "&pixels_idle",
    ),
    mutant(
        "pixels that are being blended are forgotten",
        PRIMITIVE,
        "!packet_taken && &pixels_idle",
        "!packet_taken",
    ),
    mutant(
        "runs that wait are forgotten",
        PRIMITIVE,
        "assign lane_idle[l] = empty && lane_quiet",
        "assign lane_idle[l] = lane_quiet",
    ),
    mutant(
        "rows are forgotten",
        PRIMITIVE,
        "setup_idle && rows_idle &&",
        "setup_idle &&",
    ),
    mutant(
        "a pixel between lane and blending is forgotten",
        PRIMITIVE,
        "!inside2 && !inside3 &&",
        "!inside2 &&",
    ),
    mutant(
        "the side that is drawn is read out",
        PRIMITIVE,
        "finishes ? ~scanned : scanned",
        "scanned",
    ),
];

const PRIMITIVE: &str = "splat_primitive.sv";

/// What would make runs wait for ever.
const LIVENESS_MISTAKES: [Mutant; 3] = [
    mutant(
        "places do not come back",
        "fifo.sv",
        "assign leaves = out_valid && out_ready",
        "assign leaves = 1'b0",
    ),
    mutant(
        "the last run never comes to the front",
        "run_queue.sv",
        "assign moves = some &&",
        "assign moves = count > 1 &&",
    ),
    mutant(
        "places are never left",
        "lane.sv",
        "left_valid <= been_valid[LEFT:1]",
        "left_valid <= left_valid | been_valid[LEFT:1]",
    ),
];

/// Proves everything and every mistake's counterexample; prints a table.
pub fn report() -> Result<()> {
    println!(
        "| unit | with | from reset on, cycles | holds | by induction |\n|---|---|---|---|---|"
    );
    for proof in &PROOFS {
        let Proof { cycles, .. } = proof;
        let unit = format!("{} {}", proof.unit, proof.parameters.replace("-set ", ""));
        let unit = unit.trim_end();
        let (base, step) = verdict(proof, None)?;
        let by_induction = step.map_or("not tried".to_owned(), |step| step.to_string());
        println!("| {unit} | no mistake | {cycles} | {base} | {by_induction} |");
        ensure!(
            base && step != Some(false),
            "{unit} does not keep its promises"
        );
        for mistake in proof.mistakes {
            let (base, _) = verdict(proof, Some(mistake))?;
            let name = mistake.name;
            println!("| {unit} | {name} | {cycles} | {base} | |");
            ensure!(!base, "{unit}: '{name}' is not noticed");
        }
    }
    Ok(())
}

fn rtl() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
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
        ("TILE_ROW_BITS = 5", "TILE_ROW_BITS = 2"),
    ] {
        ensure!(small.contains(usual), "no {usual} in the package");
        small = small.replace(usual, few);
    }
    Ok(small)
}

/// A unit's text, with the mistake if it is in this one.
fn source(file: &str, mistake: Option<&Mutant>) -> Result<String> {
    let text = fs::read_to_string(rtl().join(file))?;
    let Some(mistake) = mistake.filter(|mistake| mistake.file == file) else {
        return Ok(text);
    };
    mistake.applied(&text)
}

/// Do the properties hold for some cycles from reset on, and does induction close?
fn verdict(proof: &Proof, mistake: Option<&Mutant>) -> Result<(bool, Option<bool>)> {
    let folder = tempfile::tempdir()?;
    let mut paths = Vec::new();
    for (number, file) in proof.files.iter().enumerate() {
        let path = folder.path().join(format!("{number}.sv"));
        fs::write(&path, source(file, mistake)?)?;
        paths.push(path.display().to_string());
    }
    let Some(induction) = proof.induction else {
        return Ok((within(proof, &paths)?, None));
    };
    let problem = folder.path().join("problem.smt2");
    let Proof {
        unit, parameters, ..
    } = proof;
    let parameters = match *parameters {
        "" => String::new(),
        parameters => format!("chparam {parameters} {unit}; "),
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
    run(Command::new("yosys")
        .args(["-q", "-p", &script])
        .current_dir(rtl()))?;
    let holds = |options: &[&str]| -> Result<bool> {
        let mut solver = Command::new("yosys-smtbmc");
        solver.args(["-s", "z3"]).args(options).arg(&problem);
        let said = said(&mut solver)?;
        ensure!(
            said.contains("Status: "),
            "yosys-smtbmc came to no verdict:\n{said}"
        );
        Ok(said.contains("Status: PASSED"))
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
    let said = said(
        Command::new("yosys")
            .args(["-p", &script])
            .current_dir(rtl()),
    )?;
    let fails = said.contains("model found for base case");
    ensure!(
        fails || said.contains(&format!("proved base case for {cycles} steps")),
        "Yosys came to no verdict:\n{said}"
    );
    Ok(!fails)
}

/// What a program prints, whatever its exit code.
fn said(program: &mut Command) -> Result<String> {
    let name = program.get_program().to_string_lossy().into_owned();
    let output = program
        .output()
        .with_context(|| format!("cannot run {name}: are Yosys and z3 installed?"))?;
    Ok(String::from_utf8_lossy(&output.stdout).into_owned()
        + &String::from_utf8_lossy(&output.stderr))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mistakes_are_made_in_the_units_that_there_are() {
        for proof in &PROOFS {
            for mistake in proof.mistakes {
                assert!(proof.files.contains(&mistake.file), "{}", mistake.name);
                let text = source(mistake.file, Some(mistake)).unwrap();
                assert!(text.contains(mistake.to), "{}", mistake.name);
            }
        }
    }
}
