//! `splatline sweep`: every point of a space, in one piece.

use super::machine_args::SimulationOptions;
use super::output::{Outputs, read_settings, write};
use super::say::print_result;
use super::search_args::{SweepOptions, draw_references};
use crate::explore::evaluator::Evaluator;
use crate::explore::folder::{self, Appender};
use crate::explore::front::{candidates, front, front_table};
use crate::explore::identity::{Identity, SettingsText};
use crate::explore::plot;
use crate::explore::space::Space;
use crate::explore::sweep;
use crate::explore::table::ResultTable;
use crate::machine::Config;
use crate::machine::area::synthesis;
use crate::progress::ProgressMeter;
use anyhow::Result;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Table of the points.
const POINTS: &str = "points.csv";

/// What a folder holds.
const FILES: [&str; 4] = ["sweep.json", POINTS, "front.csv", "front.html"];

/// Points of the front that are printed at most.
const FEW_POINTS: usize = 12;

/// Every point of the space.
pub fn run(options: &SweepOptions) -> Result<()> {
    let (search, file, output) = (&options.search, &options.space, &options.output);
    let outputs = Outputs::default().folder(Some(output), &FILES)?;
    let text = read_settings(file)?;
    let space = Space::from_toml(&file.display().to_string(), &text)?;
    let frames = search.request().frames()?;
    let name = match frames.len() {
        1 => frames[0].prepared.scene.name().to_owned(),
        all => format!("{all} frames, of which each point shows its slowest"),
    };
    let mut subject = search.subject(frames)?;
    if !options.no_error {
        draw_references(&mut subject)?;
    }
    let identity = Identity::new(&subject, &text, &settings(search, &space)?)?;
    outputs.spare_inputs()?;
    folder::claim(output, &identity)?;
    let path = output.join(POINTS);
    let (out, done) = Appender::open(&path, &space)?;

    let (all, before) = (space.points.len(), done.rows.len());
    let progress = ProgressMeter::new(all.saturating_sub(before));
    progress.doing(format!("{all} points"));
    let started = Instant::now();
    let evaluator = Evaluator::new(subject, true);
    sweep::run(&evaluator, &space, &done, &out, &|| progress.advance())?;
    drop(progress);
    let seconds = started.elapsed().as_secs_f64();
    print_result(&format!(
        "{}: {all} points, {} of them new, in {seconds:.1} s\n",
        path.display(),
        all - before.min(all)
    ))?;
    let note = format!(
        "{}{}",
        synthesis::statement(&evaluator.subject.calibration),
        clock_note(&evaluator.subject.machine, &space)
    );
    let table = folder::table(&path, &space)?;
    finish(&name, &note, &table, output)
}

/// That no clock was given, where it was not; nothing otherwise.
fn clock_note(machine: &Config, space: &Space) -> &'static str {
    let swept = space.axes.iter().any(|axis| axis.key == "clock_mhz");
    if machine.clock_mhz > 0 || swept {
        ""
    } else {
        "; frames a second by an assumed clock, that of the nearest circuit that was placed: --set clock_mhz=N says another"
    }
}

/// Front, plot and a line for each of the front's points.
fn finish(name: &str, note: &str, table: &ResultTable, folder: &Path) -> Result<()> {
    let all = candidates(table);
    let kept = front(&all);
    let file = folder.join("front.csv");
    write(&file, front_table(table, &kept).to_csv())?;
    let title = format!("Speed, error and area: {name}");
    let page = plot::page(&title, note, table, &all);
    write(&folder.join("front.html"), page)?;
    let mut text = String::new();
    let left_out: Vec<&str> = table.left_out().collect();
    if let Some(reason) = left_out.first() {
        let count = left_out.len();
        text += &format!(
            "{count} of the points left out, why in the column left_out, the first because of {reason}\n"
        );
    }
    text += &format!(
        "{note}\nfront of error, cycles, area and energy: {} of {} points\n",
        kept.len(),
        all.len()
    );
    for candidate in kept.iter().take(FEW_POINTS) {
        text += &format!("  {}\n", candidate.label);
    }
    if kept.len() > FEW_POINTS {
        text += &format!("  ... all of them in {}\n", file.display());
    }
    print_result(&text)
}

/// The texts of all settings files that take part: whatever they say, another text is another sweep.
fn settings(options: &SimulationOptions, space: &Space) -> Result<Vec<SettingsText>> {
    let design = Some(PathBuf::from(&options.frames.work.design));
    let machine = options.machine.machine.clone();
    let files = [
        ("plan", options.frames.view.from.clone()),
        ("transfer", options.frames.view.splats.transfer.clone()),
        ("camera", options.frames.view.camera.file.clone()),
        ("design", design.filter(|name| is_toml(name))),
        ("machine", machine.filter(|name| is_toml(name))),
        ("calibration", options.area.calibration.clone()),
        ("parts", options.area.parts.clone()),
        ("energy", options.energy.clone()),
    ];
    let named = files
        .into_iter()
        .filter_map(|(role, path)| Some((role, path?)));
    let read = |(role, path): (&'static str, PathBuf)| Ok((role, read_settings(&path)?));
    let mut all: Vec<SettingsText> = named.map(read).collect::<Result<_>>()?;
    let mut bases = String::new();
    // The files of designs that the space begins with.
    let of_bases = space.axes.iter().filter(|axis| axis.key == "base");
    let names = of_bases.flat_map(|axis| &axis.values);
    let names = names.filter_map(toml::Value::as_str).map(Path::new);
    for file in names.filter(|name| is_toml(name)) {
        bases += &read_settings(file)?;
    }
    if !bases.is_empty() {
        all.push(("bases", bases));
    }
    Ok(all)
}

/// Names of designs and machines have no extension.
fn is_toml(name: &Path) -> bool {
    name.extension().is_some()
}
