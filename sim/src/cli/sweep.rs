//! Draws one view by several designs and traversals and compares each with the reference.

use super::Failure;
use super::args::{DrawingOptions, Engine, TraversalChoice};
use super::drawing::Drawing;
use super::engines::{self, Task};
use super::output::write;
use super::progress::Progress;
use super::setup::{View, threads};
use crate::design::{DesignChoice, traversal_name};
use crate::hybrid::{Hybrid, Points, spacing};
use crate::machine::{Config, Timing};
use crate::metrics::{Errors, compare};
use crate::picture::{Backdrop, Depth, Picture};
use crate::report::error_map::ErrorMap;
use crate::report::facts::{CameraFacts, RulesFacts, SceneFacts, compositing_name};
use crate::report::{ErrorFacts, FORMAT, HostTimes, Report, Row, ScaleFacts, html};
use crate::rules::Compositing;
use crate::scene::{Scene, Weight};
use crate::systems::{Use, exercised};
use anyhow::{Context, Result};
use splatline::format::Traversal;
use std::path::Path;
use std::time::Instant;

/// How a view is drawn and measured.
pub struct Manner {
    /// Order and operator of blending.
    pub compositing: Compositing,
    /// Threads that draw.
    pub threads: usize,
    /// How often each is drawn; the times are medians.
    pub repeat: usize,
    /// Points and stamps instead of splats alone.
    pub hybrid: Option<Hybrid>,
    /// The machine whose cycles are counted.
    pub machine: Config,
}

/// One design walked by one traversal.
#[derive(Clone, PartialEq)]
pub struct Entry {
    /// Widths of its datapath.
    pub design: DesignChoice,
    /// How a footprint's pixels are walked.
    pub traversal: Traversal,
}

impl Manner {
    /// As the command line says.
    ///
    /// Points and stamps need distance scaling, which tells which samples are closer together than pixels.
    pub fn from_options(options: &DrawingOptions, view: &View) -> Result<Manner, Failure> {
        let hybrid = hybrid(options, &view.scene);
        let compositing: Compositing = options.compositing.into();
        if hybrid.is_some() && (view.rules.spacing <= 0.0 || !view.rules.cutoff.is_finite()) {
            let message = "--points and --traversal stamp need --rules ewa and --antialias swan";
            return Err(Failure::Usage(message.to_owned()));
        }
        if hybrid.is_some() && compositing != Compositing::FrontToBack {
            let message = "--points and --traversal stamp composite front to back only";
            return Err(Failure::Usage(message.to_owned()));
        }
        Ok(Manner {
            hybrid,
            ..Manner::without_points(options)
        })
    }

    /// As the command line says, for scenes that know neither points nor stamps.
    pub fn without_points(options: &DrawingOptions) -> Manner {
        Manner {
            hybrid: None,
            machine: Config::default(),
            compositing: options.compositing.into(),
            threads: threads(options.threads),
            repeat: options.repeat,
        }
    }
}

/// Depth range of gathered points, in sample spacings.
const DEPTH_RANGE: f64 = 0.5;

/// Points and stamps, if the options ask for them.
fn hybrid(options: &DrawingOptions, scene: &Scene) -> Option<Hybrid> {
    let stamped = options.traversal == Some(TraversalChoice::Stamp);
    if options.points.is_none() && !stamped {
        return None;
    }
    Some(Hybrid {
        points: options.points.map_or(Points::Auto, Points::from),
        depth_range: options.points.map(|_| DEPTH_RANGE * spacing(scene)),
        phase_bits: stamped.then_some(options.phase_bits),
    })
}

impl Manner {
    /// Name of the traversal in reports.
    fn traversal_name(&self, entry: &Entry) -> &'static str {
        match self.hybrid {
            Some(Hybrid {
                phase_bits: Some(_),
                ..
            }) => "stamp",
            Some(_) => "spans",
            None => traversal_name(entry.traversal),
        }
    }
}

impl Entry {
    /// The design and the traversal that the command line says, or else the design's own traversal.
    pub fn from_options(options: &DrawingOptions) -> Result<Entry> {
        let design = DesignChoice::load(&options.design.0)?;
        let traversal = options.traversal.map_or(design.traversal, Traversal::from);
        Ok(Entry { design, traversal })
    }

    /// `lean18 by spans`.
    fn title(&self) -> String {
        format!("{} by {}", self.design.name, traversal_name(self.traversal))
    }
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
    pub map: ErrorMap,
    pub report: Report,
}

/// Runs `draw` as often as asked and keeps the last drawing.
pub fn measure(
    manner: &Manner,
    progress: &Progress,
    mut draw: impl FnMut() -> Result<Drawing> + Send,
) -> Result<Measured> {
    let mut runs = Vec::with_capacity(manner.repeat);
    engines::on_threads(manner.threads, || {
        loop {
            let start = Instant::now();
            let drawing = draw()?;
            let total_s = start.elapsed().as_secs_f64();
            runs.push(HostTimes {
                total_s,
                threads: manner.threads,
                ..drawing.stages
            });
            progress.part(runs.len(), manner.repeat);
            if runs.len() >= manner.repeat {
                return Ok(Measured {
                    drawing,
                    host: HostTimes::median_of(&runs),
                });
            }
        }
    })?
}

/// Draws by one of the double-precision engines.
pub fn draw_reference(
    view: &View,
    manner: &Manner,
    engine: Engine,
    progress: &Progress,
) -> Result<Measured> {
    measure(manner, progress, || {
        let task = task(view, manner);
        match &manner.hybrid {
            Some(hybrid) => engines::draw_hybrid_reference(engine, task, hybrid),
            None => engines::draw_reference(engine, task, &|done, of| progress.part(done, of)),
        }
    })
}

/// Draws one entry through the kernel.
pub fn draw_entry(
    view: &View,
    manner: &Manner,
    entry: &Entry,
    progress: &Progress,
) -> Result<Measured> {
    measure(manner, progress, || {
        let task = task(view, manner);
        match &manner.hybrid {
            Some(hybrid) => engines::draw_hybrid(task, &entry.design, hybrid),
            None => Ok(engines::draw_fixed(task, &entry.design, entry.traversal)),
        }
    })
}

/// A drawing's errors and its cycles on the manner's machine, which knows neither points nor stamps.
///
/// Side by side, because each has parts that only one thread can do.
fn judge(
    view: &View,
    manner: &Manner,
    entry: &Entry,
    drawing: &Drawing,
    float: &Picture,
) -> Result<(Errors, Option<Timing>)> {
    let Entry { design, traversal } = entry;
    let (task, machine) = (task(view, manner), &manner.machine);
    let footprints = &drawing.footprints;
    let cycles = || engines::cycles(task, footprints, design, *traversal, machine);
    let (errors, timing) = engines::on_threads(manner.threads, || {
        rayon::join(
            || compare(&drawing.picture, float),
            || manner.hybrid.is_none().then(cycles),
        )
    })?;
    let errors = errors.with_context(|| format!("design {} cannot be compared", entry.title()))?;
    Ok((errors, timing.transpose()?))
}

fn task<'a>(view: &'a View, manner: &Manner) -> Task<'a> {
    let View {
        scene,
        camera,
        rules,
        ..
    } = view;
    Task {
        scene,
        camera,
        rules,
        compositing: manner.compositing,
    }
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
    // Once is enough: the reference's time is not reported.
    let once = Manner {
        repeat: 1,
        ..*manner
    };
    let float = draw_reference(view, &once, reference, &progress)?
        .drawing
        .picture;
    progress.advance();

    let mut table = Vec::with_capacity(entries.len());
    let mut kept = None;
    for entry in &entries {
        progress.doing(entry.title());
        let measured = draw_entry(view, manner, entry, &progress)?;
        let (errors, cycles) = judge(view, manner, entry, &measured.drawing, &float)?;
        let pixels = measured.drawing.pixels.unwrap_or_default();
        let traversal = manner.traversal_name(entry);
        let row = Row::new(
            &entry.design.name,
            traversal,
            &errors,
            pixels,
            measured.host,
        );
        table.push(Row {
            cycles: cycles.as_ref().map(|cycles| cycles.total),
            ..row
        });
        if entry == chosen {
            kept = Some((measured, errors, cycles));
        }
        progress.advance();
    }
    let (measured, errors, cycles) = kept.context("the chosen design was not drawn")?;
    let map = ErrorMap::new(&measured.drawing.picture, &float);
    let report = Report {
        reference: Some(reference.name().to_owned()),
        error: Some(ErrorFacts::from(&errors)),
        error_map: Some(ScaleFacts::from(&map)),
        cycles: cycles.map(serde_json::to_value).transpose()?,
        table,
        ..report_of_entry(view, manner, chosen, &measured)?
    };
    Ok(Comparison {
        fixed: measured.drawing.picture,
        float,
        map,
        report,
    })
}

/// All entries, the chosen one in its place among the others or else last.
fn entries(chosen: &Entry, others: &[Entry]) -> Vec<Entry> {
    let mut entries = others.to_vec();
    if !entries.contains(chosen) {
        entries.push(chosen.clone());
    }
    entries
}

/// The report of one picture through the kernel that was compared with nothing.
pub fn report_of_entry(
    view: &View,
    manner: &Manner,
    entry: &Entry,
    measured: &Measured,
) -> Result<Report> {
    Ok(Report {
        design: serde_json::to_value(entry.design.resolved())?,
        traversal: Some(manner.traversal_name(entry).to_owned()),
        ..report_of_drawing(view, manner, Engine::Fixed, measured)
    })
}

/// The report of one picture by whatever engine, without design and traversal.
pub fn report_of_drawing(
    view: &View,
    manner: &Manner,
    engine: Engine,
    measured: &Measured,
) -> Report {
    let scene = SceneFacts::new(
        &view.scene,
        measured.drawing.culled.clone(),
        measured.drawing.clamped,
        measured.drawing.colour_log2,
    );
    Report {
        format: FORMAT.to_owned(),
        engine: engine.name().to_owned(),
        reference: None,
        design: serde_json::Value::Null,
        traversal: None,
        warnings: scene.warnings(&view.warnings),
        scene,
        camera: CameraFacts::from(&view.camera),
        rules: RulesFacts::from(&view.rules),
        compositing: compositing_name(manner.compositing).to_owned(),
        error: None,
        systems: exercised(&Use::Volume {
            rules: &view.rules,
            compositing: manner.compositing,
            hybrid: manner.hybrid.as_ref(),
            classified: view.scene.weight == Weight::Mass,
        }),
        error_map: None,
        cycles: None,
        pixels: measured.drawing.pixels,
        host: HostTimes {
            prepare_s: view.prepare_s,
            ..measured.host
        },
        table: Vec::new(),
    }
}

/// What a comparison writes into its folder.
pub const FILES: [&str; 5] = [
    "fixed.png",
    "float.png",
    "error.png",
    "report.json",
    "report.html",
];

impl Comparison {
    /// Writes fixed.png, float.png, error.png, report.json and report.html.
    pub fn write(&self, folder: &Path, drawing: &DrawingOptions) -> Result<(), Failure> {
        self.write_as(folder, drawing.depth, drawing.backdrop())
    }

    /// The same with the pictures' depth and backdrop.
    pub fn write_as(&self, folder: &Path, depth: Depth, backdrop: Backdrop) -> Result<(), Failure> {
        let picture = |picture: &Picture, name: &str| {
            picture.write_png_on(&folder.join(name), depth, backdrop)
        };
        picture(&self.fixed, "fixed.png")?;
        picture(&self.float, "float.png")?;
        write(&folder.join("error.png"), &self.map.to_rgb().to_png()?)?;
        write(
            &folder.join("report.json"),
            self.report.to_json()?.as_bytes(),
        )?;
        write(
            &folder.join("report.html"),
            html::page(&self.report, &self.fixed, &self.float, &self.map)?.as_bytes(),
        )
    }
}
