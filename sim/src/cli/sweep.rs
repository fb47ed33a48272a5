//! `splatline sweep` and `splatline merge`: sweeps, in one piece or in shards.

use super::output::{Outputs, create_folder, read_settings, write};
use super::say::{Failure, print_result};
use super::search_args::{MergeOptions, SearchOptions, SweepOptions};
use crate::explore::folder::{self, Appender};
use crate::explore::front::{candidates, front, front_table};
use crate::explore::identity::{Identity, SettingsText};
use crate::explore::plot::{self, Sweep};
use crate::explore::space::Space;
use crate::explore::sweep::{self, Shard};
use crate::explore::table::{ResultTable, heading};
use crate::machine::Config;
use crate::machine::area::synthesis;
use crate::progress::ProgressMeter;
use anyhow::anyhow;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// What a folder holds beside the tables of points.
const FILES: [&str; 3] = ["sweep.json", "front.csv", "front.html"];

/// Every point of the space.
pub fn run(options: &SweepOptions) -> Result<(), Failure> {
    let (search, file, output) = (&options.search, &options.space, &options.output);
    let table = table_name(options.shard);
    let outputs = Outputs::default()
        .folder(output, &FILES)?
        .folder(output, &[&table])?;
    let text = read_settings(file)?;
    let space = Space::from_toml(&file.display().to_string(), &text)?;
    let frames = search.frames()?;
    let subject = search.subject(&frames, !options.no_error)?;
    let identity = Identity::new(&subject, &text, &settings(search, &space)?)?;
    outputs.spare_inputs()?;
    folder::claim(output, &identity)?;
    let path = output.join(table);
    let (out, done) = Appender::resume(&path, &heading(&space), &identity)?;

    let mine = (0..space.points.len())
        .filter(|point| options.shard.holds(*point, space.points.len()))
        .count();
    let before = done.rows.len();
    let progress = ProgressMeter::new(mine.saturating_sub(before));
    progress.doing(format!("{} points", mine));
    let started = Instant::now();
    sweep::run(&subject, &space, options.shard, &done, &out, &|| {
        progress.advance()
    })?;
    drop(progress);
    let seconds = started.elapsed().as_secs_f64();
    print_result(&format!(
        "{}: {} points, {} of them new, in {seconds:.1} s\n",
        path.display(),
        mine,
        mine - before.min(mine)
    ))?;
    if options.shard.count == 1 {
        let note = format!(
            "{}{}",
            synthesis::statement(&subject.calibration),
            clock_note(&subject.machine, &space)
        );
        let table = folder::table(&path, &identity)?;
        let name = match frames.len() {
            1 => frames[0].prepared.scene.name().to_owned(),
            all => format!("{all} frames, of which each point shows its slowest"),
        };
        finish(&name, &note, &table, output)?;
    }
    Ok(())
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

pub fn merge(options: &MergeOptions) -> Result<(), Failure> {
    create_folder(&options.output)?;
    let mut folders = options.folders.clone();
    let path = options.output.join("points.csv");
    if path.exists() {
        // What an earlier merge left there is not to be lost.
        folders.push(options.output.clone());
    }
    let (merged, identity) = folder::merge(&folders)?;
    let space = identity.space()?;
    let (missing, all) = (merged.missing(&space), space.points.len());
    if missing > 0 && !options.partial {
        let first = (0..all).find(|point| !merged.rows.contains_key(point));
        let first = first.unwrap_or_default();
        return Err(anyhow!(
            "{missing} of the sweep's {all} points are missing, the first of them is point {first}: run the shards that hold them, or merge what is \
             there with --partial"
        )
        .into());
    }
    folder::claim(&options.output, &identity)?;
    folder::replace(&path, &merged)?;
    let lacking = match missing {
        0 => String::new(),
        _ => format!("; {missing} of {all} are missing"),
    };
    print_result(&format!("{} points{lacking}\n", merged.rows.len()))?;
    finish("merged sweep", identity.area(), &merged, &options.output)
}

/// Front, plot and a line for each of the front's points.
fn finish(name: &str, note: &str, table: &ResultTable, folder: &Path) -> Result<(), Failure> {
    let all = candidates(table);
    let kept = front(&all);
    write(
        &folder.join("front.csv"),
        front_table(table, &kept).to_csv().as_bytes(),
    )?;
    write(
        &folder.join("front.html"),
        plot::page(&Sweep {
            title: &format!("Speed, error and area: {name}"),
            note,
            table,
            candidates: &all,
        })
        .as_bytes(),
    )?;
    print_result(&format!("{note}\n"))?;
    print_result(&format!(
        "front of error, cycles, area and energy: {} of {} points\n",
        kept.len(),
        all.len()
    ))?;
    for candidate in kept.iter().take(12) {
        print_result(&format!("  {}\n", candidate.label))?;
    }
    if kept.len() > 12 {
        print_result(&format!(
            "  ... all of them in {}\n",
            folder.join("front.csv").display()
        ))?;
    }
    Ok(())
}

fn table_name(shard: Shard) -> String {
    match shard {
        Shard { count: 1, .. } => "points.csv".to_owned(),
        Shard { index, count } => format!("points-{index}-of-{count}.csv"),
    }
}

/// The texts of all settings files that take part: whatever they say, another text is another sweep.
fn settings(options: &SearchOptions, space: &Space) -> Result<Vec<SettingsText>, Failure> {
    let design = Some(PathBuf::from(&options.work.design.0));
    let machine = options.machine.machine.clone();
    let files = [
        ("plan", options.view.from.clone()),
        ("transfer", options.view.transfer.clone()),
        ("camera", options.view.camera.clone()),
        ("design", design.filter(|name| is_toml(name))),
        ("machine", machine.filter(|name| is_toml(name))),
        ("calibration", options.area.calibration.clone()),
        ("parts", options.area.parts.clone()),
        ("energy", options.energy.energy.clone()),
    ];
    let named = files
        .into_iter()
        .filter_map(|(role, path)| Some((role, path?)));
    let read = |(role, path): (&'static str, PathBuf)| {
        let text = read_settings(&path)?;
        Ok(SettingsText { role, text })
    };
    let mut all: Vec<SettingsText> = named.map(read).collect::<Result<_, Failure>>()?;
    let mut bases = String::new();
    for file in base_files(space) {
        bases += &read_settings(&file)?;
    }
    if !bases.is_empty() {
        let (role, text) = ("bases", bases);
        all.push(SettingsText { role, text });
    }
    Ok(all)
}

/// The files of designs that a space begins with.
fn base_files(space: &Space) -> Vec<PathBuf> {
    let bases = space.axes.iter().filter(|axis| axis.key == "base");
    let values = bases.flat_map(|axis| &axis.values);
    let names = values.filter_map(toml::Value::as_str).map(PathBuf::from);
    names.filter(|name| is_toml(name)).collect()
}

/// Names of designs and machines have no extension.
fn is_toml(name: &Path) -> bool {
    name.extension().is_some()
}
