//! `splatline needs`: which units, layers, ranges, widths and FIFO depths a scene exercises.

use super::fit;
use super::machine_args::NeedsOptions;
use super::model::{from_scene, machine};
use super::setup::{View, check_folder_of, write};
use super::{Failure, say};
use serde_json::json;
use splatline::format::Traversal;
use splatline_sim::design::DesignChoice;
use splatline_sim::explore::fit::Metric;
use splatline_sim::explore::needs::{Needs, SLACK, needs};
use splatline_sim::fixed;
use std::fmt::Write;

pub fn run(options: &NeedsOptions) -> Result<(), Failure> {
    options.json.as_deref().map_or(Ok(()), check_folder_of)?;
    let config = machine(&options.machine)?;
    let view = View::from_options(&options.view)?;
    let design = DesignChoice::load(&options.work.design.0)?;
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
    let footprints: Vec<_> = fixed::footprints(&view.scene, &view.camera, &drawing)
        .into_iter()
        .filter_map(Result::ok)
        .collect();
    let workload = from_scene(&view, &options.work, &config)?;
    let found = needs(&workload, &footprints, design.widths.peak, &config);
    say(&text(&view.scene.name, &found));
    let fitted = match options.max_error {
        Some(budget) => Some(fit::fitted(&view, &options.work, Metric::Largest, budget)?),
        None => None,
    };
    match &fitted {
        Some(fitted) => say(&fit::text(&design, fitted)),
        None => say("widths: give --max-error E to find the smallest ones within an error\n"),
    }
    if let Some(path) = &options.json {
        let answer = json!({"format": "splatline-needs/1", "scene": view.scene.name, "needs": found, "fit": fitted});
        write(path, format!("{answer:#}\n").as_bytes())?;
    }
    Ok(())
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
