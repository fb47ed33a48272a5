//! The setup unit against the kernel as a table: every design, load and rule.

use super::area::{COMPARED, COMPARED_DISTANT, COMPARED_FEW};
use super::bench::{LONG, SetupFindings, SetupLoad, run};
use super::circuit::{SetupSpec, library};
use super::distant::distant;
use super::exact::exact;
use super::loads::{captured, synthetic};
use super::model::SetupModel;
use super::program::{SetupProgram, program, with_distance_scaling};
use anyhow::{Context, Result, ensure};
use rayon::prelude::*;
use splatline::format::{Lean18, RuntimeWidths, Standard24, Widths};
use splatline_sim::atomic;
use std::path::Path;

/// Designs and cores that are compared: of several cores a number that divides no round.
pub const SUBJECTS: [(&str, Widths, usize); 2] = [
    ("lean18", Lean18::WIDTHS, 7),
    ("standard24", Standard24::WIDTHS, 7),
];

/// Splats that one simulation takes: several run side by side.
const CHUNK: usize = 10_000;

/// Every splat of three scenes and a hundred thousand others, under both kinds of rules.
pub fn full() -> Result<()> {
    let (scenes, missing) = captured(1)?;
    for name in missing {
        println!("(no {name}: its data is not at hand)");
    }
    let loads = [scenes, synthetic(12_000, 1)].concat();
    compared(program, loads, COMPARED)
}

/// Splats of few bits, for which a minute is enough.
pub fn few() -> Result<()> {
    compared(program, exact(12_000, 1), COMPARED_FEW)
}

/// The unit with distance scaling.
pub fn with_spacing() -> Result<()> {
    compared(with_distance_scaling, distant(4_000, 1), COMPARED_DISTANT)
}

/// Prints the loads' lines, and writes them where the page takes them from.
fn compared(program: SetupProgram, loads: Vec<SetupLoad>, kept: &str) -> Result<()> {
    let mut page = String::new();
    let mut say = |line: &str| {
        println!("{line}");
        page += line;
        page.push('\n');
    };
    say(
        "| design | cores | load | splats | near | far | range | degenerate | transparent | outside | cycles a splat, without pauses | mismatches |",
    );
    say("|---|---|---|---|---|---|---|---|---|---|---|---|");
    let mut total = SetupFindings::default();
    for (design, widths, cores) in SUBJECTS {
        let folder = tempfile::tempdir()?;
        let spec = SetupSpec {
            program,
            effort: "-O2",
            ..SetupSpec::new(design, &widths, cores)
        };
        let library = library(folder.path(), &spec)?;
        for load in &loads {
            let findings = all(&library, &widths, program, load)?;
            say(&line(design, cores, load, &findings));
            total = total.and(&findings);
        }
    }
    say(&format!(
        "\n{} splats, {} mismatches, {} without a place in a record",
        total.splats, total.mismatches, total.unfit
    ));
    atomic::write(kept.as_ref(), page.as_bytes())?;
    ensure!(
        total.mismatches == 0,
        "{}",
        total.first_difference.unwrap_or_default()
    );
    Ok(())
}

/// A load in parts: the first without pauses, so that its cycles say something, the others with them.
fn all(
    library: &Path,
    widths: &Widths,
    program: SetupProgram,
    load: &SetupLoad,
) -> Result<SetupFindings> {
    let design = RuntimeWidths::new(*widths)
        .ok()
        .context("widths out of range")?;
    let parts: Vec<SetupFindings> = load
        .splats
        .par_chunks(CHUNK)
        .enumerate()
        .map(|(part, splats)| {
            let load = SetupLoad {
                splats: splats.to_vec(),
                ..load.clone_without_splats()
            };
            let pauses = if part == 0 {
                0
            } else {
                part as u64 % (LONG + 2)
            };
            run(
                &mut SetupModel::new(library, part as u32 + 1)?,
                design,
                program,
                &load,
                pauses,
            )
        })
        .collect::<Result<_>>()?;
    let cycles = parts.first().map_or(0, |first| first.cycles);
    let first = load.splats.len().min(CHUNK) as u64;
    let sum = parts
        .iter()
        .fold(SetupFindings::default(), |sum, part| sum.and(part));
    Ok(SetupFindings {
        cycles: cycles * 100 / first.max(1),
        ..sum
    })
}

fn line(design: &str, cores: usize, load: &SetupLoad, findings: &SetupFindings) -> String {
    let culled = findings.culled.map(|count| count.to_string()).join(" | ");
    format!(
        "| {design} | {cores} | {} | {} | {culled} | {:.2} | {} |",
        load.name,
        findings.splats,
        findings.cycles as f64 / 100.0,
        findings.mismatches
    )
}
