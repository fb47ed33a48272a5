//! Drawings repeated, timed and compared: a plan by several designs and traversals, each against the reference.

use super::draw::on_threads;
use super::record::report_of;
use super::{DesignVariant, Drawing, Engine, Prepared};
use crate::atomic;
use crate::design::DesignChoice;
use crate::fast::lanes::VectorLevel;
use crate::fixed::QuantisedScene;
use crate::machine::Timing;
use crate::machine::area::Family;
use crate::machine::clock::{Clock, Throughput};
use crate::machine::energy::{EnergyTable, of_pixel};
use crate::picture::{Backdrop, Depth, Picture};
use crate::progress::ProgressMeter;
use crate::report::error_map::ErrorMap;
use crate::report::{ErrorFacts, FormatRow, HostTimes, Report, ReportRow, ScaleFacts, html};
use anyhow::{Context, Result};
use splatline::format::Traversal;
use std::num::NonZero;
use std::path::Path;
use std::time::{Duration, Instant};

/// Threads, and runs, that may be asked for: the upper bound keeps a slip of the finger from asking for a million.
pub fn count_of_threads_or_runs(count: usize) -> Result<usize, String> {
    if (1..=1024).contains(&count) {
        Ok(count)
    } else {
        Err("expected a whole number from 1 to 1024".to_owned())
    }
}

/// What drawing may take of this computer; it changes times and no picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Effort {
    /// Threads that draw.
    pub threads: usize,
    /// How often each is drawn; the times are medians.
    pub repeat: usize,
    /// After so long it is not drawn once more.
    pub limit: Duration,
    /// Vectors of the engine `fixed`; the processor's best if none are named.
    pub vectors: Option<VectorLevel>,
    /// Are culled splats and pixels counted? If not, the engine `fixed` sets up no splat that finished pixels alone
    /// would see.
    pub counts: bool,
}

impl Effort {
    /// So many runs on the threads asked for, or one per processor.
    pub fn new(threads: Option<usize>, repeat: usize) -> Effort {
        let all = || std::thread::available_parallelism().map_or(1, NonZero::get);
        Effort {
            threads: threads.unwrap_or_else(all),
            repeat,
            limit: Duration::MAX,
            vectors: None,
            counts: true,
        }
    }
}

/// The plan's pictures and the report about all designs.
pub struct Comparison {
    /// By the plan's own design and traversal.
    pub fixed: Picture,
    /// By the reference.
    pub float: Picture,
    /// How they differ.
    pub map: ErrorMap,
    /// What came of it.
    pub report: Report,
    /// Pixels of `fixed` at which more layers met than the style keeps.
    pub merged: usize,
}

/// Runs `draw` as often as asked, or until the limit, and keeps the last drawing, with the median times of all.
fn measure(
    effort: &Effort,
    progress: &ProgressMeter,
    mut draw: impl FnMut() -> Result<Drawing> + Send,
) -> Result<Drawing> {
    let mut runs = Vec::with_capacity(effort.repeat);
    on_threads(effort.threads, || {
        let began = Instant::now();
        loop {
            let start = Instant::now();
            let mut drawing = draw()?;
            let total_s = start.elapsed().as_secs_f64();
            runs.push(HostTimes {
                total_s,
                threads: effort.threads,
                ..drawing.host
            });
            progress.part(runs.len(), effort.repeat);
            if runs.len() >= effort.repeat || began.elapsed() > effort.limit {
                drawing.host = HostTimes::median_of(&runs);
                return Ok(drawing);
            }
        }
    })?
}

/// Draws the plan by its own engine, with a report that compares it with nothing; of a scene that is not needed
/// afterwards, so that it need not be in memory twice.
pub fn draw_last(
    prepared: &mut Prepared,
    effort: &Effort,
    progress: &ProgressMeter,
) -> Result<(Drawing, Report)> {
    let started = Instant::now();
    let released = match prepared.plan.engine {
        Engine::Fixed => on_threads(effort.threads, || prepared.release())?,
        _ => None,
    };
    prepared.prepare_s += started.elapsed().as_secs_f64();
    draw_alone(prepared, released, effort, progress)
}

/// The same of a scene that stays, or of splats that were [released](Prepared::release).
pub fn draw_alone(
    prepared: &Prepared,
    released: Option<QuantisedScene>,
    effort: &Effort,
    progress: &ProgressMeter,
) -> Result<(Drawing, Report)> {
    let plan = &prepared.plan;
    let entry = (plan.engine == Engine::Fixed).then_some(&plan.entry);
    let drawing = match entry {
        Some(entry) => measure_fixed(prepared, released, effort, entry, progress)?,
        None => measure_reference(prepared, effort, plan.engine, progress)?,
    };
    let report = report_of(prepared, plan.engine, entry, &drawing)?;
    Ok((drawing, report))
}

/// The scene is brought into the kernel's formats once, before the first picture.
fn measure_fixed(
    prepared: &Prepared,
    released: Option<QuantisedScene>,
    effort: &Effort,
    entry: &DesignVariant,
    progress: &ProgressMeter,
) -> Result<Drawing> {
    let started = Instant::now();
    let prepare = || prepared.kernel(released, entry, effort.vectors, effort.counts);
    let mut kernel = on_threads(effort.threads, prepare)??;
    let prepare_s = started.elapsed().as_secs_f64();
    let mut measured = measure(effort, progress, || {
        kernel.draw(&|done, of| {
            if effort.repeat == 1 {
                progress.part(done, of);
            }
        })
    })?;
    kernel.finish(&mut measured);
    measured.host.prepare_s = prepare_s;
    Ok(measured)
}

fn measure_reference(
    prepared: &Prepared,
    effort: &Effort,
    engine: Engine,
    progress: &ProgressMeter,
) -> Result<Drawing> {
    let rows = |done, of| progress.part(done, of);
    measure(effort, progress, || prepared.draw_reference(engine, &rows))
}

/// A drawing's errors and its cycles on the plan's machine.
///
/// Side by side, because each has parts that only one thread can do.
fn judge(
    prepared: &Prepared,
    threads: usize,
    entry: &DesignVariant,
    drawing: &Drawing,
    float: &Picture,
) -> Result<(ErrorFacts, Option<Timing>)> {
    let (errors, timing) = on_threads(threads, || {
        rayon::join(
            || ErrorFacts::between(&drawing.picture, float),
            || prepared.cycles(entry, drawing),
        )
    })?;
    let errors = errors.with_context(|| format!("design {} cannot be compared", entry.title()))?;
    Ok((errors, timing?))
}

/// Every named design by both traversals, and the chosen design by both if it is none of them.
pub fn all_entries(chosen: &DesignChoice) -> Vec<DesignVariant> {
    let mut designs = DesignChoice::all();
    if !designs.contains(chosen) {
        designs.push(chosen.clone());
    }
    let both = |design: &DesignChoice| {
        [Traversal::Box, Traversal::Spans].map(|traversal| DesignVariant {
            design: design.clone(),
            traversal,
        })
    };
    designs.iter().flat_map(both).collect()
}

/// Draws the plan's own entry and `others`, which may hold it again, against the plan's reference.
pub fn compare_all(
    prepared: &Prepared,
    effort: &Effort,
    others: &[DesignVariant],
) -> Result<Comparison> {
    let chosen = &prepared.plan.entry;
    let reference = prepared.plan.reference.unwrap_or(Engine::Float);
    // The chosen one in its place among the others or else last.
    let mut entries = others.to_vec();
    if !entries.contains(chosen) {
        entries.push(chosen.clone());
    }
    let progress = ProgressMeter::new(entries.len() + 1);
    progress.doing(format!("{} reference", reference.name()));
    // Once is enough: the reference's time is not reported.
    let once = Effort {
        repeat: 1,
        ..*effort
    };
    let float = measure_reference(prepared, &once, reference, &progress)?;
    let float = float.picture;
    progress.advance();

    let mut table = Vec::with_capacity(entries.len());
    let mut kept = None;
    for entry in &entries {
        progress.doing(entry.title());
        let measured = measure_fixed(prepared, None, effort, entry, &progress)?;
        let (error, cycles) = judge(prepared, effort.threads, entry, &measured, &float)?;
        let pixels = measured.pixels.unwrap_or_default();
        table.push(ReportRow {
            design: entry.design.name.clone(),
            traversal: prepared.traversal_name(entry).to_owned(),
            error: error.rgb,
            flip: error.flip,
            visited: pixels.visited,
            covered: pixels.covered,
            visited_per_covered: pixels.ratio(),
            cycles: cycles.as_ref().map(|cycles| cycles.total),
            host: measured.host,
        });
        if entry == chosen {
            kept = Some((measured, error, cycles));
        }
        progress.advance();
    }
    let (measured, error, cycles) = kept.context("the chosen design was not drawn")?;
    let map = ErrorMap::new(&measured.picture, &float);
    let machine = &prepared.plan.machine;
    let pace = cycles.as_ref().map(|timing| {
        let clock = Clock::of(machine, &chosen.design.widths, Family::default());
        Throughput::new(timing, machine, clock)
    });
    let report = Report {
        reference: Some(reference.name().to_owned()),
        error: Some(error),
        error_map: Some(ScaleFacts::from(&map)),
        pace,
        cycles,
        table,
        ..report_of(prepared, Engine::Fixed, Some(chosen), &measured)?
    };
    Ok(Comparison {
        merged: measured.merged,
        fixed: measured.picture,
        float,
        map,
        report,
    })
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
    /// Draws the plan by the engines of floating-point formats as well and notes how far each is from the reference.
    pub fn add_formats(&mut self, prepared: &Prepared) -> Result<()> {
        for engine in Engine::FORMATS {
            let picture = prepared.draw_reference(engine, &|_, _| ())?.picture;
            let error = ErrorFacts::between(&picture, &self.float)
                .with_context(|| format!("engine {} cannot be compared", engine.name()))?;
            let lane = engine.lane();
            let units = lane.map(|lane| lane.units(Family::default()));
            let widths = &prepared.plan.entry.design.widths;
            self.report.formats.push(FormatRow {
                engine: engine.name().to_owned(),
                error,
                transistors: units.unwrap_or_default().transistors,
                pj_per_pixel: of_pixel(lane.as_ref(), widths, &EnergyTable::default()),
            });
        }
        Ok(())
    }

    /// Writes fixed.png, float.png, error.png, report.json and report.html.
    pub fn write(&self, folder: &Path, depth: Depth, backdrop: Backdrop) -> Result<()> {
        let picture =
            |picture: &Picture, name: &str| picture.write_png(&folder.join(name), depth, backdrop);
        let file = |name: &str, bytes: &[u8]| {
            let path = folder.join(name);
            atomic::write(&path, bytes)
                .with_context(|| format!("cannot write '{}'", path.display()))
        };
        picture(&self.fixed, "fixed.png")?;
        picture(&self.float, "float.png")?;
        file("error.png", &self.map.to_rgb().to_png()?)?;
        file("report.json", self.report.to_json()?.as_bytes())?;
        let page = html::page(&self.report, &self.fixed, &self.float, &self.map)?;
        file("report.html", page.as_bytes())
    }
}
