//! Covered pixels per cycle and lane: traversals, lanes and layouts, against the public FPGA rasterizer's schedule.

use super::{COMMAND, HardwareScene};
use anyhow::Result;
use splatline::format::Traversal;
use splatline_sim::design::{DesignChoice, traversal_name};
use splatline_sim::fixed::Options;
use splatline_sim::machine::workload::{Workload, extract};
use splatline_sim::machine::{Config, Timing, simulate_alone};
use splatline_sim::progress::ProgressMeter;
use splatline_sim::rules::Compositing;
use std::fmt::Write;
use std::time::Instant;

/// The schedule of the public FPGA rasterizer: box_pixels + 3 rows + 8 pairs, no early termination.
const FPGA: &[&str] = &[
    "overlap=serial",
    "row_cycles=3",
    "rows_at_once=1",
    "splat_cycles=8",
    "tile_termination=0",
    "latency=0",
];

/// Machines, as changes to the default one. The FPGA's schedule comes first, by both traversals.
const MACHINES: [(&str, &[&str]); 11] = [
    ("serial, 3 per row, 8 per pair", FPGA),
    ("1 lane", &[]),
    ("1 lane, skips finished pixels", &["pixel_termination=skip"]),
    ("4 lanes, run", &["lanes=4"]),
    ("4 lanes, aligned", &["lanes=4", "layout=aligned"]),
    ("4 lanes, quad", &["lanes=4", "layout=quad"]),
    (
        "4 lanes, rows",
        &["lanes=4", "layout=rows", "rows_at_once=4"],
    ),
    (
        "4 lanes, rows, skips finished pixels",
        &[
            "lanes=4",
            "layout=rows",
            "rows_at_once=4",
            "pixel_termination=skip",
        ],
    ),
    ("8 lanes, run", &["lanes=8", "rows_at_once=4"]),
    (
        "8 lanes, rows",
        &["lanes=8", "layout=rows", "rows_at_once=8"],
    ),
    ("4 x 1 lane, dynamic tiles", &["raster_units=4"]),
];

/// One machine on one scene by one traversal.
pub struct ThroughputLine {
    machine: &'static str,
    traversal: Traversal,
    timing: Timing,
    cycles_per_second: f64,
}

/// All lines of one scene.
pub struct ThroughputTable {
    name: &'static str,
    splats: usize,
    visible: usize,
    lines: Vec<ThroughputLine>,
}

pub fn measure(
    subjects: &[HardwareScene],
    progress: &ProgressMeter,
) -> Result<Vec<ThroughputTable>> {
    subjects
        .iter()
        .map(|subject| {
            progress.doing(subject.name);
            let table = table(subject);
            progress.advance();
            table
        })
        .collect()
}

fn table(subject: &HardwareScene) -> Result<ThroughputTable> {
    let mut lines = Vec::new();
    let mut visible = 0;
    for traversal in [Traversal::Box, Traversal::Spans] {
        let workload = workload(subject, traversal);
        visible = workload.visible();
        for (machine, words) in MACHINES {
            let words: Vec<String> = words.iter().map(|word| (*word).to_owned()).collect();
            let mut config = Config::default();
            config.set_words(&words)?;
            let started = Instant::now();
            let timing = simulate_alone(&workload, &config);
            let cycles_per_second = timing.total as f64 / started.elapsed().as_secs_f64();
            lines.push(ThroughputLine {
                machine,
                traversal,
                timing,
                cycles_per_second,
            });
        }
    }
    Ok(ThroughputTable {
        name: subject.name,
        splats: subject.scene.splats.len(),
        visible,
        lines,
    })
}

/// The work of a scene for the default machine's tiles.
pub fn workload(subject: &HardwareScene, traversal: Traversal) -> Workload {
    let config = Config::default();
    let design = DesignChoice::all()
        .into_iter()
        .find(|design| design.name == "standard24");
    let design = design.unwrap_or_else(|| DesignChoice::all().remove(0));
    let options = Options {
        rules: &subject.rules,
        compositing: Compositing::FrontToBack,
        design: &design,
        traversal,
    };
    extract(
        &subject.scene,
        &subject.camera,
        &options,
        [config.tile_width, config.tile_height],
    )
}

/// The page.
pub fn text(tables: &[ThroughputTable], missing: &[&str]) -> String {
    let mut text = format!(
        "# Throughput of the raster unit\n\nPrinted by `{COMMAND}`. Pictures of 512 x 512, tiles of 16 x 16, design standard24; a machine is the \
         default one (`splatline simulate` with `-o` writes it out) with the changes that its name says.\n\n\
         *Covered* is covered pixels (r < c) that lanes visited, per cycle of the raster phase, lane and raster unit; *live* counts only those \
         that had not finished. Both count memory stalls, hazards and drains. Mcycles are all three phases. *Host* is million simulated \
         cycles per second of wall-clock time, lane grouping included; it is noisy.\n"
    );
    for table in tables {
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "\n## {}: {} splats, {} visible\n",
            table.name, table.splats, table.visible
        );
        text.push_str("| machine | traversal | Mcycles | raster | covered | live | lanes busy | largest stall of the lanes | host |\n");
        text.push_str("|---|---|--:|--:|--:|--:|--:|---|--:|\n");
        for line in &table.lines {
            let _ = writeln!(text, "{}", row(line));
        }
    }
    if !missing.is_empty() {
        let _ = writeln!(
            text,
            "\nNot measured, because the data folder has no such file: {}.",
            missing.join(", ")
        );
    }
    text
}

fn row(line: &ThroughputLine) -> String {
    let Timing {
        total,
        raster,
        units,
        pixels,
        ..
    } = &line.timing;
    let lanes = units.get("lanes").cloned().unwrap_or_default();
    // Within the raster phase: what the other phases take is no fault of the lanes.
    let within = (lanes.instances * raster).max(1) as f64;
    let stall = lanes.stalled.iter().max_by_key(|(_, cycles)| **cycles);
    let stall = stall.map_or("-".to_owned(), |(cause, cycles)| {
        format!(
            "{} {:.1} %",
            cause.replace('_', " "),
            100.0 * *cycles as f64 / within
        )
    });
    format!(
        "| {} | {} | {:.3} | {:.3} | {:.3} | {:.3} | {:.1} % | {stall} | {:.0} |",
        line.machine,
        traversal_name(line.traversal),
        *total as f64 / 1e6,
        *raster as f64 / 1e6,
        pixels.covered_per_cycle_and_lane,
        pixels.live_per_cycle_and_lane,
        100.0 * lanes.busy as f64 / within,
        line.cycles_per_second / 1e6,
    )
}
