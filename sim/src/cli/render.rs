//! `splatline render`: one picture.

use super::args::{Engine, RenderOptions};
use super::output::{self, write};
use super::progress::Progress;
use super::setup::{DRAWN, View, room_for_picture};
use super::sweep::{Entry, Manner, draw_entry, draw_reference, report_of_drawing, report_of_entry};
use super::{Failure, complain, say, warn};
use crate::picture::{EXTENSIONS, Format, Picture};
use crate::report::Report;
use crate::report::facts::Counts;
use std::path::Path;

pub fn run(options: &RenderOptions) -> Result<(), Failure> {
    let drawing = &options.drawing;
    let inputs = [options.view.inputs(), options.surface.inputs()].concat();
    let inputs = [inputs, output::files([drawing.inputs().as_ref()])].concat();
    output::check(&options.output, &EXTENSIONS, &inputs)?;
    if let Some(json) = &drawing.json {
        output::check(json, &["json"], &inputs)?;
        refuse_one_name(&options.output, json)?;
    }
    if drawing.engine != Engine::Fixed && drawing.traversal.is_some() {
        let engine = drawing.engine.name();
        return Err(Failure::Usage(format!(
            "--traversal has no meaning for --engine {engine}"
        )));
    }
    if options.surface.kind.is_some() {
        return super::surface::render(options);
    }
    let view = View::from_options(&options.view)?;
    room_for_picture(&view.camera, DRAWN)?;
    let manner = Manner::from_options(drawing, &view)?;
    let progress = Progress::new(1);
    progress.doing(format!("drawing {}", view.scene.name));
    let (measured, report) = match drawing.engine {
        Engine::Fixed => {
            let entry = Entry::from_options(drawing)?;
            let measured = draw_entry(&view, &manner, &entry, &progress)?;
            let report = report_of_entry(&view, &manner, &entry, &measured)?;
            (measured, report)
        }
        engine => {
            let measured = draw_reference(&view, &manner, engine, &progress)?;
            let report = report_of_drawing(&view, &manner, engine, &measured);
            (measured, report)
        }
    };
    write_picture(&measured.drawing.picture, options)?;
    if let Some(path) = &drawing.json {
        write(path, report.to_json()?.as_bytes())?;
    }
    drop(progress);
    warn(&report.warnings);
    complain(&if_nothing_is_seen(&measured.drawing.picture, &report));
    say(&summary(&report))?;
    Ok(())
}

/// Why a picture is empty, for the standard error: an empty picture and exit code 0 look like success. Nothing if it is not.
pub fn if_nothing_is_seen(picture: &Picture, report: &Report) -> String {
    let scene = &report.scene;
    let clear = |pixel: &[f64; 4]| *pixel == [0.0; 4];
    if !picture.pixels.iter().all(clear) {
        return String::new();
    }
    let all = scene.splats;
    let culled = scene.culled.values().sum::<u64>();
    let why = match culled {
        _ if all == 0 => "the scene has no splats".to_owned(),
        0 => "all splats are transparent or smaller than a pixel".to_owned(),
        _ => format!(
            "of {all} splats{}; the rest is transparent or smaller than a pixel",
            reasons("are culled", &scene.culled)
        ),
    };
    format!("{}: the picture is empty: {why}\n", scene.name)
}

/// Writes the picture in the format that the output's extension names; a stream gets a PNG.
pub fn write_picture(picture: &Picture, options: &RenderOptions) -> Result<(), Failure> {
    let format = Format::of(&options.output).unwrap_or(Format::Png);
    let drawing = &options.drawing;
    let bytes = picture.encode(format, drawing.depth, drawing.backdrop())?;
    write(&options.output, &bytes)
}

fn refuse_one_name(picture: &Path, json: &Path) -> Result<(), Failure> {
    match picture == json {
        true => Err(Failure::Usage(format!(
            "picture and report cannot both be written to '{}'",
            json.display()
        ))),
        false => Ok(()),
    }
}

/// What was drawn, what was left out and how long it took.
pub fn summary(report: &Report) -> String {
    let scene = &report.scene;
    let clamped = if scene.clamped > 0 {
        format!(", {} clamped", scene.clamped)
    } else {
        String::new()
    };
    format!(
        "{}: {} splats{}{}{clamped}\n{}\n",
        scene.name,
        scene.splats,
        reasons("skipped", &scene.skipped),
        reasons("culled", &scene.culled),
        times(report),
    )
}

/// Only the kernel's host side tells its stages apart.
fn times(report: &Report) -> String {
    let host = &report.host;
    let runs = if host.repeat > 1 {
        format!(", median of {} runs", host.repeat)
    } else {
        String::new()
    };
    let total = format!("{:.1} ms{runs}", host.total_s * 1e3);
    let before = match host.prepare_s > 0.0 {
        true => format!(
            ", after {:.1} ms of loading and preparing",
            host.prepare_s * 1e3
        ),
        false => String::new(),
    };
    if report.traversal.is_none() {
        return total + &before;
    }
    let stages = [
        ("setup", host.setup_s),
        ("sort", host.sort_s),
        ("raster", host.raster_s),
        ("convert", host.convert_s),
    ];
    let stages = stages.map(|(name, seconds)| format!("{name} {:.1}", seconds * 1e3));
    format!("{total} ({}){before}", stages.join(", "))
}

/// `, 7 culled (near 3, outside 4)`; nothing where nothing was left out.
fn reasons(what: &str, counts: &Counts) -> String {
    let named: Vec<String> = counts
        .iter()
        .filter(|(_, count)| **count > 0)
        .map(|(reason, count)| format!("{reason} {count}"))
        .collect();
    if named.is_empty() {
        return String::new();
    }
    let total = counts
        .values()
        .fold(0u64, |sum, count| sum.saturating_add(*count));
    format!(", {total} {what} ({})", named.join(", "))
}
