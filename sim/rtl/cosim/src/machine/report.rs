//! Frames of scenes by the machine as a table: words against the kernel's, cycles against the model's.

use super::bench::{MEMORIES, MachineFindings, MemoryTiming, draw};
use super::circuit::{MachineSpec, library};
use super::model::MachineModel;
use crate::order::loads::{SCENES, Seen, ordered, scenes};
use crate::setup::distant::enlarged;
use crate::setup::program::{SetupProgram, program, with_distance_scaling};
use anyhow::{Context, Result, ensure};
use splatline_sim::design::DesignChoice;
use splatline_sim::fixed::QuantisedScene;
use splatline_sim::hybrid::spacing;
use splatline_sim::machine::{Config, Timing, simulate_alone};
use splatline_sim::rules::{Antialias, Rules};

/// Machines that are compared: design, cores, lanes.
pub const SUBJECTS: [(&str, usize, usize); 2] = [("lean18", 8, 4), ("standard24", 8, 4)];

/// The model of the machine that `spec` describes around that memory. Every core of setup takes a splat in a round of the program.
pub fn machine(spec: &MachineSpec, memory: &MemoryTiming) -> Result<Config> {
    let program = (spec.program)(spec.widths)?;
    Ok(Config {
        latency: memory.latency,
        read_bandwidth: memory.bytes,
        write_bandwidth: memory.bytes,
        setup_units: spec.cores as u32,
        setup_interval: program.round as u32,
        setup_latency: program.latency() as u32,
        ..Config::machine(spec.lanes as u32)
    })
}

/// Scenes in pictures of so many pixels a side by every machine and memory: all of [`SCENES`], or the one of this name.
pub fn print(size: usize, only: Option<&str>) -> Result<()> {
    let seen = wanted(size, only)?;
    print_frames(&seen, program)
}

/// The same with distance scaling: each scene is given the spacing of its samples, which are estimated where they are not on a grid.
pub fn print_distance(size: usize, only: Option<&str>) -> Result<()> {
    let mut scenes = wanted(size, only)?;
    for seen in &mut scenes {
        seen.scene.natural_rules = spaced(seen);
        let (beyond, all) = beyond(seen)?;
        println!(
            "{}: samples {:.4} apart; {beyond} of {all} splats beyond k",
            seen.name, seen.scene.natural_rules.spacing
        );
    }
    println!();
    print_frames(&scenes, with_distance_scaling)
}

/// The rules of the scene with the spacing of its samples.
pub fn spaced(seen: &Seen) -> Rules {
    let spacing = spacing(&seen.scene);
    let rules = seen.scene.natural_rules;
    rules.with_antialias(Antialias::Swan(spacing))
}

/// How many splats lie beyond the distance k at which a spacing is a pixel, and how many there are.
pub fn beyond(seen: &Seen) -> Result<(usize, usize)> {
    let rules = seen.scene.natural_rules;
    let scene = QuantisedScene::new(&seen.scene, &seen.camera, &rules);
    let widths = DesignChoice::load(SUBJECTS[0].0)?.widths;
    let beyond = enlarged(&widths, &scene.view, &scene.rules(&rules), &scene.splats);
    Ok((beyond, scene.splats.len()))
}

fn wanted(size: usize, only: Option<&str>) -> Result<Vec<Seen>> {
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
    Ok(seen)
}

fn print_frames(scenes: &[Seen], program: SetupProgram) -> Result<()> {
    println!(
        "| machine | scene | splats | seen | entries | memory | pixels | mismatches | geometry: circuit, model | sort | lists | sort and lists: model | raster: circuit, model | all: model / circuit - 1 |"
    );
    println!("|---|---|---:|---:|---:|---|---:|---:|---|---:|---:|---:|---|---:|");
    let mut wrong = 0;
    for (name, cores, lanes) in SUBJECTS {
        let design = DesignChoice::load(name)?;
        let folder = tempfile::tempdir()?;
        let spec = MachineSpec {
            program,
            effort: "-O2",
            ..MachineSpec::new(name, &design.widths, cores, lanes)
        };
        let model = MachineModel::new(&library(folder.path(), &spec)?)?;
        for seen in scenes {
            for memory in MEMORIES {
                let config = machine(&spec, &memory)?;
                let (modelled, room) = modelled(seen, &design, &config);
                let found =
                    draw(&model, &spec, seen, memory, room, 1).with_context(|| seen.name)?;
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
