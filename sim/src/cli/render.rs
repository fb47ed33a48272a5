//! `splatline render`: one picture.

use super::args::{Engine, RenderOptions};
use super::progress::Progress;
use super::setup::{View, check_folder_of, write};
use super::sweep::{Entry, Manner, draw_entry, draw_reference, report_of_drawing, report_of_entry};
use super::{Failure, say};
use splatline_sim::report::Report;
use splatline_sim::report::facts::Counts;

pub fn run(options: &RenderOptions) -> Result<(), Failure> {
    let drawing = &options.drawing;
    check_folder_of(&options.output)?;
    drawing.json.as_deref().map_or(Ok(()), check_folder_of)?;
    if drawing.engine != Engine::Fixed && drawing.traversal.is_some() {
        let engine = drawing.engine.name();
        return Err(Failure::Usage(format!(
            "--traversal has no meaning for --engine {engine}"
        )));
    }
    let view = View::from_options(&options.view)?;
    let manner = Manner::from_options(drawing, &view)?;
    let progress = Progress::new(1);
    progress.doing(format!("drawing {}", view.scene.name));
    let (measured, report) = match drawing.engine {
        Engine::Fixed => {
            let entry = Entry::from_options(drawing)?;
            let measured = draw_entry(&view, &manner, &entry)?;
            let report = report_of_entry(&view, &manner, &entry, &measured)?;
            (measured, report)
        }
        engine => {
            let measured = draw_reference(&view, &manner, engine)?;
            let report = report_of_drawing(&view, &manner, engine, &measured);
            (measured, report)
        }
    };
    measured
        .drawing
        .picture
        .write_png(&options.output, drawing.depth)?;
    if let Some(path) = &drawing.json {
        write(path, report.to_json()?.as_bytes())?;
    }
    drop(progress);
    say(&summary(&report));
    Ok(())
}

/// What was drawn, what was left out and how long it took.
fn summary(report: &Report) -> String {
    let host = &report.host;
    format!(
        "{}: {} splats{}{}{}\n{:.1} ms (median of {}; setup {:.1}, sort {:.1}, raster {:.1})\n",
        report.scene.name,
        report.scene.splats,
        reasons("skipped", &report.scene.skipped),
        reasons("culled", &report.scene.culled),
        if report.scene.clamped > 0 {
            format!(", {} clamped", report.scene.clamped)
        } else {
            String::new()
        },
        host.total_s * 1e3,
        host.repeat,
        host.setup_s * 1e3,
        host.sort_s * 1e3,
        host.raster_s * 1e3,
    )
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
