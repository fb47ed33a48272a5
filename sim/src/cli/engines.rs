//! The one place where the commands meet the engines: their different results become one [`Drawing`].

use super::args::Engine;
use super::drawing::{Drawing, FootprintLine};
use super::setup::View;
use crate::camera::Camera;
use crate::design::DesignChoice;
use crate::fixed;
use crate::hybrid::Hybrid;
use crate::machine::workload::{extract_from, room_for};
use crate::machine::{Config, Timing, simulate_alone};
use crate::reference::compositor::Progress as Rows;
use crate::reference::{self, exact, float};
use crate::report::facts::{Counts, SceneFacts};
use crate::report::{HostTimes, Pixels};
use crate::rules::{Compositing, Rules};
use crate::scene::Scene;
use anyhow::{Context, Error, Result, bail};
use rayon::ThreadPoolBuilder;
use splatline::footprint::{Footprint, depth};
use splatline::format::{Traversal, Widths};
use splatline::setup::Cull;

/// What to draw, from where and how; the same for every engine.
#[derive(Clone, Copy)]
pub struct Task<'a> {
    pub scene: &'a Scene,
    pub camera: &'a Camera,
    pub rules: &'a Rules,
    pub compositing: Compositing,
}

/// Runs `work` on so many threads.
pub fn on_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> Result<T> {
    let pool = ThreadPoolBuilder::new().num_threads(threads).build();
    Ok(pool
        .with_context(|| format!("cannot start {threads} threads"))?
        .install(work))
}

/// Draws by one of the double-precision engines.
pub fn draw_reference(engine: Engine, task: Task, rows: Rows) -> Result<Drawing> {
    let Task {
        scene,
        camera,
        rules,
        compositing,
    } = task;
    Ok(of_reference(match engine {
        Engine::Float => float::draw_with_progress(scene, camera, rules, compositing, rows),
        Engine::Exact => exact::draw_with_progress(scene, camera, rules, compositing, rows),
        Engine::Fixed => bail!("engine 'fixed' is not a reference"),
    }))
}

/// A reference's drawing in the commands' terms.
fn of_reference(reference::Drawing { picture, counts }: reference::Drawing) -> Drawing {
    Drawing {
        picture,
        culled: reference_culled(&counts),
        clamped: 0,
        colour_log2: 0,
        pixels: None,
        stages: HostTimes::default(),
        footprints: Vec::new(),
    }
}

/// Draws through the kernel.
pub fn draw_fixed(task: Task, design: &DesignChoice, traversal: Traversal) -> Drawing {
    let options = fixed::Options {
        rules: task.rules,
        compositing: task.compositing,
        design,
        traversal,
    };
    let (drawing, footprints) = fixed::draw_with_footprints(task.scene, task.camera, &options);
    Drawing {
        footprints,
        ..described(drawing)
    }
}

/// Points and splats through the kernel.
pub fn draw_hybrid(task: Task, design: &DesignChoice, hybrid: &Hybrid) -> Result<Drawing> {
    let options = fixed::Options {
        rules: task.rules,
        compositing: task.compositing,
        design,
        traversal: Traversal::Spans,
    };
    let drawn = fixed::draw_hybrid(task.scene, task.camera, &options, hybrid);
    Ok(described(drawn.map_err(Error::msg)?.drawing))
}

/// Points and splats in double precision, centres of points where they are and not at a stamp's phase.
pub fn draw_hybrid_reference(engine: Engine, task: Task, hybrid: &Hybrid) -> Result<Drawing> {
    if engine != Engine::Float {
        bail!(
            "points and stamps have no engine '{}': use float",
            engine.name()
        );
    }
    let hybrid = Hybrid {
        phase_bits: None,
        ..*hybrid
    };
    let drawn = reference::hybrid::draw(task.scene, task.camera, task.rules, &hybrid);
    Ok(of_reference(drawn))
}

/// The kernel's drawing in the commands' terms.
fn described(drawing: fixed::Drawing) -> Drawing {
    let fixed::Times {
        setup,
        sort,
        raster,
    } = drawing.times;
    let stages = HostTimes {
        setup_s: setup,
        sort_s: sort,
        raster_s: raster,
        ..HostTimes::default()
    };
    Drawing {
        picture: drawing.picture,
        culled: cull_counts(drawing.culled),
        clamped: drawing.clamped as u64,
        colour_log2: drawing.colour_log2,
        pixels: Some(Pixels {
            covered: drawing.coverage.covered,
            visited: drawing.coverage.visited,
        }),
        stages,
        footprints: Vec::new(),
    }
}

/// Cycles on a machine of the picture that was drawn with these footprints.
pub fn cycles(
    task: Task,
    footprints: &[Result<Footprint, Cull>],
    design: &DesignChoice,
    traversal: Traversal,
    machine: &Config,
) -> Result<Timing> {
    let options = fixed::Options {
        rules: task.rules,
        compositing: task.compositing,
        design,
        traversal,
    };
    let tile = [machine.tile_width, machine.tile_height];
    room_for(footprints, [task.camera.width, task.camera.height], tile)?;
    let workload = extract_from(footprints, task.camera, &options, tile);
    Ok(simulate_alone(&workload, machine))
}

/// Footprints by the kernel's setup, in splat order; nothing for culled splats.
pub fn fixed_footprints(task: Task, design: &DesignChoice) -> Vec<Option<FootprintLine>> {
    let traversal = design.traversal;
    let options = fixed::Options {
        rules: task.rules,
        compositing: task.compositing,
        design,
        traversal,
    };
    let footprints = fixed::footprints(task.scene, task.camera, &options);
    let line = |footprint: &Footprint| line_of(footprint, &design.widths);
    footprints
        .iter()
        .map(|result| result.as_ref().ok().map(line))
        .collect()
}

/// What the kernel cannot take as it is given, for commands that make no report: the view's own warnings and those of a setup.
pub fn warnings(view: &View, design: &DesignChoice) -> Vec<String> {
    let View {
        scene,
        camera,
        rules,
        warnings,
        ..
    } = view;
    let options = fixed::Options {
        rules,
        compositing: Compositing::FrontToBack,
        design,
        traversal: design.traversal,
    };
    let mut culled = [0; Cull::ALL.len()];
    for reason in fixed::footprints(scene, camera, &options)
        .iter()
        .filter_map(|f| f.err())
    {
        culled[Cull::ALL.iter().position(|r| *r == reason).unwrap_or(0)] += 1;
    }
    let quantised = fixed::QuantisedScene::new(scene, camera, rules);
    let (clamped, colour_log2) = (quantised.clamped as u64, quantised.colour_log2);
    SceneFacts::new(scene, cull_counts(culled), clamped, colour_log2).warnings(warnings)
}

/// Footprints in double precision, in splat order; nothing for culled splats.
pub fn float_footprints(task: Task) -> Vec<Option<FootprintLine>> {
    let footprints = float::footprints(task.scene, task.camera, task.rules);
    let line = |footprint: &float::Footprint| {
        let bounds = &footprint.bounds;
        FootprintLine {
            centre: footprint.centre,
            depth: footprint.depth,
            conic: footprint.conic,
            bounds: [bounds.x0, bounds.y0, bounds.x1, bounds.y1],
            cutoff: footprint.cutoff,
        }
    };
    footprints
        .iter()
        .map(|result| result.as_ref().ok().map(line))
        .collect()
}

/// A packet's integers as numbers: depth as a sort key, Q27.subpixel centre, conic mantissas with their exponent.
fn line_of(footprint: &Footprint, widths: &Widths) -> FootprintLine {
    let depth = depth::number(footprint.depth);
    let power_of_two = |power: i32| f64::from(power).exp2();
    let step = power_of_two(-i32::from(widths.subpixel));
    let ([x0, y0], [x1, y1]) = (footprint.first, footprint.last);
    FootprintLine {
        centre: footprint.centre.map(|coordinate| coordinate as f64 * step),
        depth: depth.value as f64 * power_of_two(depth.exponent),
        conic: footprint
            .conic
            .mantissa
            .map(|m| f64::from(m) * power_of_two(footprint.conic.exponent)),
        bounds: [x0, y0, x1, y1].map(usize::from),
        cutoff: f64::from(footprint.cutoff) * power_of_two(-28),
    }
}

/// The kernel's counts under the reports' names, in the order of [`Cull::ALL`].
pub fn cull_counts(culled: [usize; Cull::ALL.len()]) -> Counts {
    let counts = Cull::ALL.iter().zip(culled);
    counts
        .map(|(reason, count)| (cull_name(*reason).to_owned(), count as u64))
        .collect()
}

/// The kernel's reasons in the words of the reports.
fn cull_name(reason: Cull) -> &'static str {
    match reason {
        Cull::Near => "near",
        Cull::Far => "far",
        Cull::Range => "out_of_range",
        Cull::Degenerate => "degenerate",
        Cull::Transparent => "transparent",
        Cull::Outside => "outside",
    }
}

pub fn reference_culled(counts: &reference::Counts) -> Counts {
    let reasons = [
        ("near", counts.near),
        ("far", counts.far),
        ("outside", counts.outside),
        ("transparent", counts.transparent),
        ("degenerate", counts.degenerate),
        ("non_finite", counts.non_finite),
    ];
    reasons
        .map(|(reason, count)| (reason.to_owned(), count as u64))
        .into()
}
