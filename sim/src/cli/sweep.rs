//! Draws one view by several designs and traversals and compares each with the reference.

use super::Failure;
use super::args::{Engine, TraversalChoice};
use super::drawing::{Design, Drawing};
use super::engines;
use super::progress::Progress;
use super::setup::{View, write};
use anyhow::{Context, Result};
use splatline_sim::metrics::{Errors, compare};
use splatline_sim::picture::Picture;
use splatline_sim::report::error_map::ErrorMap;
use splatline_sim::report::facts::{CameraFacts, RulesFacts, SceneFacts, compositing_name};
use splatline_sim::report::{ErrorFacts, FORMAT, HostTimes, Report, Row, html};
use splatline_sim::rules::Compositing;
use std::path::Path;
use std::time::Instant;

/// How a view is drawn and measured.
pub struct Manner {
    pub compositing: Compositing,
    pub threads: usize,
    pub repeat: usize,
}

/// One design walked by one traversal.
#[derive(Clone)]
pub struct Entry {
    pub design: Design,
    pub traversal: TraversalChoice,
}

/// A drawing and the median times of all its runs.
pub struct Measured {
    pub drawing: Drawing,
    pub host: HostTimes,
}

/// The chosen design's pictures and the report about all designs.
pub struct Comparison {
    pub fixed: Picture,
    pub float: Picture,
    pub report: Report,
}

/// Runs `draw` as often as asked and keeps the last drawing.
pub fn measure(manner: &Manner, mut draw: impl FnMut() -> Result<Drawing>) -> Result<Measured> {
    let mut runs = Vec::with_capacity(manner.repeat);
    loop {
        let start = Instant::now();
        let drawing = draw()?;
        let total_s = start.elapsed().as_secs_f64();
        runs.push(HostTimes { total_s, threads: manner.threads, ..drawing.stages });
        if runs.len() >= manner.repeat {
            return Ok(Measured { drawing, host: HostTimes::median_of(&runs) });
        }
    }
}

/// Draws one entry through the kernel.
pub fn draw_entry(view: &View, manner: &Manner, entry: &Entry) -> Result<Measured> {
    let View { scene, camera, rules } = view;
    let Manner { compositing, threads, .. } = *manner;
    measure(manner, || {
        engines::draw_fixed(scene, camera, rules, compositing, &entry.design, entry.traversal, threads)
    })
}

/// Draws `chosen` and `others`, which may hold `chosen` again, against the reference.
pub fn run(
    view: &View,
    manner: &Manner,
    reference: Engine,
    chosen: &Entry,
    others: &[Entry],
) -> Result<Comparison, Failure> {
    let entries = entries(chosen, others);
    let progress = Progress::new(entries.len() + 1);
    progress.doing(format!("{} reference", reference.name()));
    let View { scene, camera, rules } = view;
    let float = engines::draw_reference(reference, scene, camera, rules, manner.compositing, manner.threads)?.picture;
    progress.advance();

    let mut table = Vec::with_capacity(entries.len());
    let mut kept = None;
    for entry in &entries {
        progress.doing(format!("{} {}", entry.design.name, entry.traversal.name()));
        let measured = draw_entry(view, manner, entry)?;
        let errors = compare(&measured.drawing.picture, &float).with_context(|| {
            format!("design '{}' by {} cannot be compared", entry.design.name, entry.traversal.name())
        })?;
        let pixels = measured.drawing.pixels.unwrap_or_default();
        table.push(Row::new(&entry.design.name, entry.traversal.name(), &errors, pixels, measured.host));
        if is_same(entry, chosen) {
            kept = Some((measured, errors));
        }
        progress.advance();
    }
    let (measured, errors) = kept.context("the chosen design was not drawn")?;
    let report = report(view, manner, reference, chosen, (&measured, &errors), table);
    Ok(Comparison { fixed: measured.drawing.picture, float, report })
}

/// All entries, the chosen one in its place among the others or else last.
fn entries(chosen: &Entry, others: &[Entry]) -> Vec<Entry> {
    let mut entries = others.to_vec();
    if !entries.iter().any(|entry| is_same(entry, chosen)) {
        entries.push(chosen.clone());
    }
    entries
}

fn is_same(a: &Entry, b: &Entry) -> bool {
    a.design.name == b.design.name && a.design.facts == b.design.facts && a.traversal == b.traversal
}

fn report(
    view: &View,
    manner: &Manner,
    reference: Engine,
    chosen: &Entry,
    (measured, errors): (&Measured, &Errors),
    table: Vec<Row>,
) -> Report {
    Report {
        reference: Some(reference.name().to_owned()),
        design: chosen.design.facts.clone(),
        traversal: Some(chosen.traversal.name().to_owned()),
        error: Some(ErrorFacts::from(errors)),
        table,
        ..report_of_drawing(view, manner, Engine::Fixed, measured)
    }
}

/// The report of one picture that was compared with nothing; design and traversal are the caller's to fill in.
pub fn report_of_drawing(view: &View, manner: &Manner, engine: Engine, measured: &Measured) -> Report {
    Report {
        format: FORMAT.to_owned(),
        engine: engine.name().to_owned(),
        reference: None,
        design: serde_json::Value::Null,
        traversal: None,
        scene: SceneFacts::new(&view.scene, measured.drawing.culled.clone()),
        camera: CameraFacts::from(&view.camera),
        rules: RulesFacts::from(&view.rules),
        compositing: compositing_name(manner.compositing).to_owned(),
        error: None,
        cycles: None,
        pixels: measured.drawing.pixels,
        host: measured.host,
        table: Vec::new(),
    }
}

impl Comparison {
    /// Writes fixed.png, float.png, error.png, report.json and report.html.
    pub fn write(&self, folder: &Path, depth: u8) -> Result<(), Failure> {
        engines::write_picture(&self.fixed, &folder.join("fixed.png"), depth)?;
        engines::write_picture(&self.float, &folder.join("float.png"), depth)?;
        let map = ErrorMap::new(&self.fixed, &self.float).to_rgb().to_png()?;
        write(&folder.join("error.png"), &map)?;
        write(&folder.join("report.json"), self.report.to_json()?.as_bytes())?;
        write(&folder.join("report.html"), html::page(&self.report, &self.fixed, &self.float)?.as_bytes())
    }
}
