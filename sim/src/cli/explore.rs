//! `splatline explore` and `splatline merge`: sweeps, in one piece or in shards.

use super::compare::create_folder;
use super::machine_args::{AreaOptions, ExploreOptions, MergeOptions, WorkOptions};
use super::model::machine;
use super::output::write;
use super::progress::Progress;
use super::setup::View;
use super::{Failure, say};
use anyhow::{Context, anyhow};
use splatline_sim::design::DesignChoice;
use splatline_sim::explore::front::{candidates, front, front_table};
use splatline_sim::explore::plot;
use splatline_sim::explore::space::Space;
use splatline_sim::explore::sweep::{self, Shard, Subject};
use splatline_sim::explore::table::{Appender, Table, heading};
use splatline_sim::machine::area::{Calibration, Family, synthesis};
use splatline_sim::picture::Picture;
use splatline_sim::reference::float;
use splatline_sim::rules::Compositing;
use std::path::Path;
use std::time::Instant;

pub fn run(options: &ExploreOptions) -> Result<(), Failure> {
    create_folder(&options.output)?;
    let text = read(&options.space)?;
    let space = Space::from_toml(&options.space.display().to_string(), &text)?;
    let view = View::from_options(&options.view)?;
    let reference = (!options.no_error).then(|| reference(&view, &options.work));
    let subject = Subject {
        scene: &view.scene,
        camera: &view.camera,
        rules: &view.rules,
        compositing: options.work.compositing.into(),
        design: DesignChoice::load(&options.work.design.0)?,
        traversal: options.work.traversal.map(Into::into),
        machine: machine(&options.machine)?,
        calibration: calibration(&options.area)?,
        reference: reference.as_ref(),
    };
    keep_identity(&options.output, &sweep::identity(&subject, &text)?)?;
    let path = options.output.join(table_name(options.shard));
    let done = if path.exists() {
        table(&path)?
    } else {
        Table::default()
    };
    let out = Appender::open(&path, &heading(&space))
        .with_context(|| format!("cannot write '{}'", path.display()))?;

    let mine = (0..space.points.len())
        .filter(|point| options.shard.holds(*point, space.points.len()))
        .count();
    let before = done.lines.len();
    let progress = Progress::new(mine.saturating_sub(before));
    progress.doing(format!("{} points", mine));
    let started = Instant::now();
    sweep::run(&subject, &space, options.shard, &done, &out, &|| {
        progress.advance()
    })?;
    drop(progress);
    let seconds = started.elapsed().as_secs_f64();
    say(&format!(
        "{}: {} points, {} of them new, in {seconds:.1} s\n",
        path.display(),
        mine,
        mine - before.min(mine)
    ));
    if options.shard.count == 1 {
        let note = synthesis::statement(&subject.calibration);
        finish(&view.scene.name, &note, &table(&path)?, &options.output)?;
    }
    Ok(())
}

pub fn merge(options: &MergeOptions) -> Result<(), Failure> {
    create_folder(&options.output)?;
    let mut merged: Option<(Table, String)> = None;
    for folder in &options.folders {
        let identity = read(&folder.join("sweep.json"))?;
        for path in tables_in(folder)? {
            let next = table(&path)?;
            match &mut merged {
                None => merged = Some((next, identity.clone())),
                Some((_, known)) if *known != identity => {
                    return Err(anyhow!(
                        "{}: another sweep than the folders before it (sweep.json differs)",
                        folder.display()
                    )
                    .into());
                }
                Some((all, _)) => all
                    .merge(next)
                    .map_err(|problem| anyhow!("{}: {problem}", path.display()))?,
            }
        }
    }
    let Some((merged, identity)) = merged else {
        return Err(anyhow!("no points.csv or points-i-of-n.csv in these folders").into());
    };
    write(
        &options.output.join("points.csv"),
        merged.to_csv().as_bytes(),
    )?;
    write(&options.output.join("sweep.json"), identity.as_bytes())?;
    say(&format!("{} points\n", merged.lines.len()));
    finish(
        "merged sweep",
        &note_of(&identity),
        &merged,
        &options.output,
    )
}

/// Front, plot and a line for each of the front's points.
fn finish(name: &str, note: &str, table: &Table, folder: &Path) -> Result<(), Failure> {
    let all = candidates(table);
    let kept = front(&all);
    write(
        &folder.join("front.csv"),
        front_table(table, &kept).to_csv().as_bytes(),
    )?;
    write(
        &folder.join("front.html"),
        plot::page(&format!("Speed, error and area: {name}"), note, &all).as_bytes(),
    )?;
    say(&format!("{note}\n"));
    say(&format!(
        "front of error, cycles and area: {} of {} points\n",
        kept.len(),
        all.len()
    ));
    for candidate in kept.iter().take(12) {
        say(&format!("  {}\n", candidate.label));
    }
    if kept.len() > 12 {
        say(&format!(
            "  ... all of them in {}\n",
            folder.join("front.csv").display()
        ));
    }
    Ok(())
}

/// The float reference's picture for a view.
pub fn reference(view: &View, work: &WorkOptions) -> Picture {
    let compositing: Compositing = work.compositing.into();
    float::draw(&view.scene, &view.camera, &view.rules, compositing).picture
}

fn table_name(shard: Shard) -> String {
    match shard {
        Shard { count: 1, .. } => "points.csv".to_owned(),
        Shard { index, count } => format!("points-{index}-of-{count}.csv"),
    }
}

/// A folder holds one sweep only: results of different sweeps must never share a table.
fn keep_identity(folder: &Path, identity: &str) -> Result<(), Failure> {
    let path = folder.join("sweep.json");
    match std::fs::read_to_string(&path) {
        Ok(known) if known == identity => Ok(()),
        Ok(_) => Err(anyhow!(
            "'{}' holds another sweep (sweep.json differs in scene, camera, design, machine or space): choose another folder with -o",
            folder.display()
        )
        .into()),
        Err(_) => write(&path, identity.as_bytes()),
    }
}

/// What the sweep's identity says of its area.
fn note_of(identity: &str) -> String {
    let facts: Option<serde_json::Value> = serde_json::from_str(identity).ok();
    let note = facts.and_then(|facts| Some(facts.get("area")?.as_str()?.to_owned()));
    note.unwrap_or_default()
}

/// The prices that the options name.
pub fn calibration(options: &AreaOptions) -> Result<Calibration, Failure> {
    match &options.calibration {
        None => Ok(Family::from(options.family).calibration()),
        Some(path) => {
            let text = read(path)?;
            Ok(Calibration::from_toml(&path.display().to_string(), &text)
                .map_err(|problem| anyhow!(problem))?)
        }
    }
}

fn read(path: &Path) -> Result<String, Failure> {
    Ok(std::fs::read_to_string(path)
        .with_context(|| format!("cannot read '{}'", path.display()))?)
}

fn table(path: &Path) -> Result<Table, Failure> {
    Ok(
        Table::from_csv(&read(path)?)
            .map_err(|problem| anyhow!("{}: {problem}", path.display()))?,
    )
}

fn tables_in(folder: &Path) -> Result<Vec<std::path::PathBuf>, Failure> {
    let entries =
        std::fs::read_dir(folder).with_context(|| format!("cannot read '{}'", folder.display()))?;
    let mut paths: Vec<_> = entries
        .filter_map(|entry| Some(entry.ok()?.path()))
        .collect();
    paths.retain(|path| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        name.starts_with("points") && name.ends_with(".csv")
    });
    paths.sort();
    Ok(paths)
}
