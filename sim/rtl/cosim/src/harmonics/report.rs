//! The harmonics unit against the kernel as a table: every load for each number of multipliers, and the cycles of each degree.

use super::bench::{HarmonicsFindings, HarmonicsLoad, HarmonicsPauses, PAUSES, run};
use super::circuit::{HarmonicsSpec, MULTIPLIERS, library};
use super::loads::{captured, of_degree, synthetic};
use super::model::HarmonicsModel;
use anyhow::{Result, ensure};
use rayon::prelude::*;
use std::fs;
use std::path::Path;

/// Splats of each kind, and of each degree for its cycles.
const COUNT: usize = 12_000;
const TIMED: usize = 2_000;

/// Splats that one simulation takes: several run side by side.
const CHUNK: usize = 1_000;

/// Every splat of a scene and thousands of each other kind.
pub fn full() -> Result<()> {
    let mut loads = synthetic(COUNT, 1);
    match captured(1)? {
        Some(load) => loads.push(load),
        None => println!("(no playbot: its data is not at hand)"),
    }
    println!("| MULTIPLIERS | load | splats | resets in between | mismatches |");
    println!("|---:|---|---:|---:|---:|");
    let folder = tempfile::tempdir()?;
    let mut libraries = Vec::new();
    let mut total = HarmonicsFindings::default();
    for multipliers in MULTIPLIERS {
        let own = folder.path().join(multipliers.to_string());
        fs::create_dir(&own)?;
        let spec = HarmonicsSpec {
            effort: "-O2",
            ..HarmonicsSpec::new(multipliers)
        };
        let library = library(&own, &spec)?;
        for load in &loads {
            let found = all(&library, load)?;
            println!(
                "| {multipliers} | {} | {} | {} | {} |",
                load.name, found.splats, found.resets, found.mismatches
            );
            total = total.and(&found);
        }
        libraries.push(library);
    }
    println!(
        "\n{} splats, {} mismatches\n",
        total.splats, total.mismatches
    );
    println!("Cycles a splat, without pauses:\n");
    println!("| MULTIPLIERS | degree 0 | 1 | 2 | 3 | 4 |\n|---:|---:|---:|---:|---:|---:|");
    for (multipliers, library) in MULTIPLIERS.iter().zip(&libraries) {
        let cells = (0..=4).map(|degree| Ok(format!(" {:.1} |", cycles(library, degree)?)));
        let cells: Vec<String> = cells.collect::<Result<_>>()?;
        println!("| {multipliers} |{}", cells.concat());
    }
    ensure!(
        total.mismatches == 0,
        "{}",
        total.first_difference.unwrap_or_default()
    );
    Ok(())
}

/// A load in parts, each with one of the ways of pausing.
fn all(library: &Path, load: &HarmonicsLoad) -> Result<HarmonicsFindings> {
    let parts: Vec<HarmonicsFindings> = load
        .splats
        .par_chunks(CHUNK)
        .enumerate()
        .map(|(part, splats)| {
            let load = HarmonicsLoad {
                name: load.name.clone(),
                splats: splats.to_vec(),
            };
            let mut model = HarmonicsModel::new(library, part as u32 + 1)?;
            run(&mut model, &load, &PAUSES[part % PAUSES.len()], part as u64)
        })
        .collect::<Result<_>>()?;
    let none = HarmonicsFindings::default();
    Ok(parts.iter().fold(none, |sum, part| sum.and(part)))
}

/// Cycles a splat of one degree at full speed.
fn cycles(library: &Path, degree: u8) -> Result<f64> {
    let mut model = HarmonicsModel::new(library, 1)?;
    let load = of_degree(TIMED, degree, 1);
    let found = run(&mut model, &load, &HarmonicsPauses::default(), 1)?;
    ensure!(found.mismatches == 0, "{:?}", found.first_difference);
    Ok(found.cycles as f64 / TIMED as f64)
}
