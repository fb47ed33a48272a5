//! Frames of scenes by the machine as a table: words against the kernel's, cycles against the model's.

use super::bench::{MEMORIES, MachineFindings, MemoryTiming, draw};
use super::circuit::{MachineSpec, library};
use super::model::MachineModel;
use crate::order::loads::{SCENES, Seen, ordered, scenes};
use crate::setup::program::program;
use anyhow::{Context, Result, ensure};
use splatline::format::Widths;
use splatline_sim::design::DesignChoice;
use splatline_sim::machine::{Config, Timing, simulate_alone};

/// Machines that are compared: design, cores, lanes.
pub const SUBJECTS: [(&str, usize, usize); 2] = [("lean18", 8, 4), ("standard24", 8, 4)];

/// The model of a machine with so many cores and lanes around that memory. Every core of setup takes a splat in
/// a round of the program.
pub fn machine(
    widths: &Widths,
    cores: usize,
    lanes: usize,
    memory: &MemoryTiming,
) -> Result<Config> {
    let program = program(widths)?;
    Ok(Config {
        latency: memory.latency,
        read_bandwidth: memory.bytes,
        write_bandwidth: memory.bytes,
        setup_units: cores as u32,
        setup_interval: program.round as u32,
        setup_latency: program.latency() as u32,
        ..Config::machine(lanes as u32)
    })
}

/// Every scene by every machine and memory, pictures of so many pixels a side.
pub fn print(size: usize, only: Option<&str>) -> Result<()> {
    println!(
        "| machine | scene | splats | seen | entries | memory | pixels | mismatches | geometry: circuit, model | sort | lists | sort and lists: model | raster: circuit, model | all: model / circuit - 1 |"
    );
    println!("|---|---|---:|---:|---:|---|---:|---:|---|---:|---:|---:|---|---:|");
    let wanted = |name: &&str| only.is_none_or(|only| only == *name);
    let names: Vec<&'static str> = SCENES.into_iter().filter(wanted).collect();
    ensure!(
        !names.is_empty(),
        "no such scene; there are {}",
        SCENES.join(", ")
    );
    let (seen, missing) = scenes(&names, size)?;
    for name in missing {
        println!("(no {name}: its data is not at hand)");
    }
    let mut wrong = 0;
    for (name, cores, lanes) in SUBJECTS {
        let design = DesignChoice::load(name)?;
        let folder = tempfile::tempdir()?;
        let spec = MachineSpec {
            design: name,
            widths: &design.widths,
            cores,
            lanes,
            mistake: None,
            choices: &[],
            effort: "-O2",
        };
        let model = MachineModel::new(&library(folder.path(), &spec)?)?;
        for seen in &seen {
            for memory in MEMORIES {
                let config = machine(&design.widths, cores, lanes, &memory)?;
                let (modelled, room) = modelled(seen, &design, &config);
                let found = draw(&model, &design.widths, seen, memory, room, 1)
                    .with_context(|| seen.name)?;
                wrong += usize::from(!found.agree());
                print_line(
                    &format!("{name}, {cores} cores, {lanes} lanes"),
                    seen,
                    memory,
                    &found,
                    &modelled,
                );
            }
        }
    }
    ensure!(wrong == 0, "{wrong} frames differ");
    Ok(())
}

/// The model's cycles, and the list entries of the picture.
pub fn modelled(seen: &Seen, design: &DesignChoice, config: &Config) -> (Timing, usize) {
    let (workload, load) = ordered(seen, design);
    let room = load.lists.iter().map(Vec::len).sum();
    (simulate_alone(&workload, config), room)
}

fn print_line(
    machine: &str,
    seen: &Seen,
    memory: MemoryTiming,
    found: &MachineFindings,
    model: &Timing,
) {
    let MachineFindings {
        pixels,
        mismatches,
        splats,
        outcome,
        ..
    } = found;
    let apart = match memory.pauses {
        0 => format!(
            "{:+.2} %",
            100.0 * (model.total as f64 / outcome.cycles() as f64 - 1.0)
        ),
        _ => "not modelled".to_owned(),
    };
    let pauses = match memory.pauses {
        0 => String::new(),
        pauses => format!(", pauses in {pauses} of 8 cycles"),
    };
    let behind = format!("{} bytes, latency {}{pauses}", memory.bytes, memory.latency);
    println!(
        "| {machine} | {} | {splats} | {} | {} | {behind} | {pixels} | {mismatches} | {}, {} | {} | {} | {} | {}, {} | {apart} |",
        seen.name,
        outcome.visible,
        outcome.entries,
        outcome.geometry,
        model.geometry,
        outcome.sort,
        outcome.fill,
        model.sort,
        outcome.raster,
        model.raster,
    );
}
