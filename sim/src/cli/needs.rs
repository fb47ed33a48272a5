//! `splatline needs`: which units, layers, ranges, widths and FIFO depths a scene exercises.

use super::args::TraversalChoice;
use super::engines;
use super::fit;
use super::machine_args::NeedsOptions;
use super::model::{from_scene, machine};
use super::output::{self, write};
use super::progress::Progress;
use super::setup::View;
use super::surface::SurfaceView;
use super::{Failure, say, warn};
use crate::design::DesignChoice;
use crate::explore::fit::Metric;
use crate::explore::needs::{Needs, SLACK, needs};
use crate::fixed;
use crate::hybrid::Hybrid;
use crate::scene::Weight;
use crate::systems::{Use, Verdict, exercised};
use serde_json::json;
use splatline::format::Traversal;
use std::fmt::Write;

pub fn run(options: &NeedsOptions) -> Result<(), Failure> {
    if let Some(path) = &options.json {
        let mut inputs = [options.view.inputs(), options.surface.inputs()].concat();
        inputs.extend(output::design_file(&options.work.design));
        inputs.extend(options.machine.machine.clone());
        output::check(path, &["json"], &inputs)?;
    }
    if options.surface.kind.is_some() {
        return run_surface(options);
    }
    let config = machine(&options.machine)?;
    let view = View::from_options(&options.view)?;
    let design = DesignChoice::load(&options.work.design.0)?;
    warn(&engines::warnings(&view, &design));
    let traversal = options
        .work
        .traversal
        .map_or(design.traversal, Traversal::from);
    let drawing = fixed::Options {
        rules: &view.rules,
        compositing: options.work.compositing.into(),
        design: &design,
        traversal,
    };
    let progress = Progress::spinner("setting up every splat");
    let footprints: Vec<_> = fixed::footprints(&view.scene, &view.camera, &drawing)
        .into_iter()
        .filter_map(Result::ok)
        .collect();
    progress.doing("walking the rows of every tile");
    let workload = from_scene(&view, &options.work, &config)?;
    progress.doing("trying the depths of every FIFO");
    let found = needs(&workload, &footprints, design.widths.peak, &config);
    drop(progress);
    let systems = systems_of_volume(&view, options);
    say(&text(&view.scene.name, &found))?;
    say(&systems_text(&systems))?;
    let fitted = match options.max_error {
        Some(budget) => Some(fit::fitted(&view, &options.work, Metric::Largest, budget)?),
        None => None,
    };
    match &fitted {
        Some(fitted) => say(&fit::text(&design, fitted))?,
        None => say("widths: give --max-error E to find the smallest ones within an error\n")?,
    }
    if let Some(path) = &options.json {
        let answer = json!({"format": "splatline-needs/1", "scene": view.scene.name, "systems": systems, "needs": found, "fit": fitted});
        write(path, format!("{answer:#}\n").as_bytes())?;
    }
    Ok(())
}

/// A cloud or height field: its systems; units and FIFOs are those of the volume machine and not examined.
fn run_surface(options: &NeedsOptions) -> Result<(), Failure> {
    let view = SurfaceView::from_options(&options.view, &options.surface)?;
    let systems = exercised(&Use::Surface {
        style: &view.style,
        textured: options.surface.texture.is_some(),
    });
    let (name, count) = (&view.scene.name, view.scene.points.len());
    say(&format!("{name}: {count} points of a surface\n"))?;
    say(&systems_text(&systems))?;
    if let Some(path) = &options.json {
        let answer = json!({"format": "splatline-needs/1", "scene": name, "systems": systems});
        write(path, format!("{answer:#}\n").as_bytes())?;
    }
    Ok(())
}

fn systems_of_volume(view: &View, options: &NeedsOptions) -> Vec<Verdict> {
    let stamps = Hybrid {
        phase_bits: Some(3),
        ..Hybrid::default()
    };
    let stamped = options.work.traversal == Some(TraversalChoice::Stamp);
    exercised(&Use::Volume {
        rules: &view.rules,
        compositing: options.work.compositing.into(),
        hybrid: stamped.then_some(&stamps),
        classified: view.scene.weight == Weight::Mass,
    })
}

fn systems_text(systems: &[Verdict]) -> String {
    let line = |verdict: &Verdict| {
        let used = if verdict.used { "used" } else { "not needed" };
        format!(
            "  {:>2} {:<48} {used}: {}\n",
            verdict.number, verdict.name, verdict.reason
        )
    };
    let lines: String = systems.iter().map(line).collect();
    format!("systems of the papers:\n{lines}")
}

fn text(name: &str, needs: &Needs) -> String {
    let mut text = format!("{name}: {} visible splats\nunits:\n", needs.visible);
    // Writing to a String cannot fail.
    for (unit, verdict) in &needs.units {
        let _ = writeln!(text, "  {unit:<18} {verdict}");
    }
    let _ = writeln!(
        text,
        "FIFOs (depth within {} % of the cycles of deep ones; fullest when deep):",
        SLACK * 100.0
    );
    for ((name, depth), high) in needs.fifo_depths.iter().zip(needs.fifo_high_water.values()) {
        let _ = writeln!(text, "  {name:<18} {depth:>5} {high:>6}");
    }
    let [columns, rows] = needs.largest_box;
    let _ = writeln!(
        text,
        "layers: at most {} in a pixel; longest tile list {}; largest box {columns} x {rows}; longest run {}",
        needs.deepest_pixel, needs.longest_tile_list, needs.longest_run
    );
    if let (Some([low, high]), Some([most, least])) = (needs.curvature_log2, needs.peaks) {
        let _ = writeln!(
            text,
            "ranges: curvature 2^{low} to 2^{high} per square pixel; peak opacity {least:.5} to {most:.5}"
        );
    }
    text
}
