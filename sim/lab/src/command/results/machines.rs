//! Machines of others beside ours, where bytes and energy go, and what memory parts make of the same picture.

use super::COMMAND;
use super::hardware::HardwareScene;
use anyhow::Result;
use splatline_sim::design::DesignChoice;
use splatline_sim::fixed::Options;
use splatline_sim::machine::energy::{Energy, EnergyTable, estimate};
use splatline_sim::machine::lanes::{LaneShape, LaneWork};
use splatline_sim::machine::memory::parts::PARTS;
use splatline_sim::machine::others;
use splatline_sim::machine::workload::{Workload, extract_if_room};
use splatline_sim::machine::{Config, Timing, simulate, simulate_alone};
use splatline_sim::plan::Splats;
use splatline_sim::report::machine::{Plot, plots, watch};
use splatline_sim::rules::Compositing;
use std::fmt::Write;

/// Clock of the machines with a memory part, MHz.
const CLOCK: u32 = 100;

/// The scene whose plots stand in the page.
const PLOTTED: &str = "guitar";

/// The page over all subjects, and the files that it shows.
pub fn page(subjects: &[HardwareScene]) -> Result<(String, Vec<(String, String)>)> {
    let mut files = Vec::new();
    let mut text = format!(
        "# Machines, memories and energy\n\nPrinted by `{COMMAND} --only machines`; do not edit.\n\n{}\n\
         Tested, inside and blended count pixels once per splat. Energy: {}.\n",
        others::note(),
        EnergyTable::default().statement()
    );
    for subject in subjects {
        let splats = splats(subject);
        let outcomes = others::run_all(&splats.without_points(), &EnergyTable::default())?;
        writeln!(
            text,
            "\n## {}\n\n{}",
            subject.name,
            others::table_of(&outcomes)
        )?;
        let design = DesignChoice::all().remove(2);
        let workload = workload(&splats, &design)?;
        text += &flow(&workload, &design)?;
        text += &memories(&workload)?;
        if subject.name == PLOTTED {
            text += "\nWhere the cycles of `primitive-4` go, which `splatline simulate -o` writes for any machine and scene:\n\n";
            for plot in cycles(&workload) {
                let file = format!("machines-{PLOTTED}-{}.svg", plot.file);
                writeln!(text, "![{}]({file})\n", plot.title)?;
                files.push((file, plot.alone()));
            }
        }
    }
    Ok((text, files))
}

/// Plots of the cycles of four lanes.
fn cycles(workload: &Workload) -> [Plot; 4] {
    let config = Config::primitive(4);
    let work = LaneWork::new(workload, LaneShape::from(&config));
    let timing = simulate(workload, &work, &config);
    let watched = watch(workload, &work, &config, &timing);
    plots(&timing, &watched, workload.columns, &config)
}

fn splats(subject: &HardwareScene) -> Splats<'_> {
    Splats {
        scene: &subject.scene,
        camera: &subject.camera,
        rules: &subject.rules,
        compositing: Compositing::FrontToBack,
        hybrid: None,
    }
}

fn workload(splats: &Splats, design: &DesignChoice) -> Result<Workload> {
    let options = Options {
        rules: splats.rules,
        compositing: splats.compositing,
        design,
        traversal: design.traversal,
    };
    let config = Config::primitive(4);
    Ok(extract_if_room(
        splats.scene,
        splats.camera,
        &options,
        [config.tile_width, config.tile_height],
    )?)
}

fn energy(timing: &Timing, config: &Config, design: &DesignChoice) -> Energy {
    let table = EnergyTable::default();
    estimate(&design.widths, design.traversal, config, timing, &table)
}

/// Where pairs, rows, pixels, bytes and energy go.
fn flow(workload: &Workload, design: &DesignChoice) -> Result<String> {
    let config = Config::primitive(4);
    let timing = simulate_alone(workload, &config);
    let all = workload.totals();
    let (pixels, splats, bytes) = (&timing.pixels, &timing.splats, &timing.bytes);
    let percent = |part: u64, whole: u64| 100.0 * part as f64 / whole.max(1) as f64;
    let empty = pixels.rows - pixels.runs.min(pixels.rows);
    let finished = pixels.covered - pixels.live;
    let mut text = String::from(
        "Where the work goes, standard24 on `primitive-4`:\n\n| what | of | count | % |\n|---|---|---:|---:|\n",
    );
    let lines = [
        (
            "splats that are seen",
            "splats",
            splats.visible,
            splats.fetched,
        ),
        (
            "pairs without a pixel",
            "pairs",
            workload.pairs.iter().filter(|pair| !pair.visits).count() as u64,
            workload.pairs.len() as u64,
        ),
        (
            "pairs left out, their tile having finished",
            "pairs",
            pixels.pairs_left_out,
            workload.pairs.len() as u64,
        ),
        ("rows without a pixel", "rows drawn", empty, pixels.rows),
        (
            "pixels outside the footprint",
            "pixels visited",
            pixels.visited - pixels.covered,
            pixels.visited,
        ),
        (
            "pixels that had finished",
            "pixels visited",
            finished,
            pixels.visited,
        ),
        (
            "pixels blended",
            "pixels visited",
            pixels.live,
            pixels.visited,
        ),
        (
            "pixels blended",
            "pixels of all pairs",
            pixels.live,
            all.visited,
        ),
        ("bytes of splats", "bytes", bytes.splats_read, bytes.all()),
        (
            "bytes of packets and lists written",
            "bytes",
            bytes.packets_written,
            bytes.all(),
        ),
        ("bytes of the sort", "bytes", bytes.sort_moved, bytes.all()),
        (
            "bytes of packets and lists read",
            "bytes",
            bytes.packets_read,
            bytes.all(),
        ),
        (
            "bytes of pixels",
            "bytes",
            bytes.pixels_written,
            bytes.all(),
        ),
    ];
    for (what, of, count, whole) in lines {
        writeln!(
            text,
            "| {what} | {of} | {count} | {:.1} |",
            percent(count, whole)
        )?;
    }
    let energy = energy(&timing, &config, design);
    text += "\n| unit | mJ | % | of this DRAM, mJ |\n|---|---:|---:|---:|\n";
    for unit in &energy.units {
        writeln!(
            text,
            "| {} | {:.4} | {:.1} | {:.4} |",
            unit.unit,
            unit.attojoules as f64 / 1e15,
            percent(unit.attojoules, energy.attojoules),
            unit.dram_attojoules as f64 / 1e15
        )?;
    }
    writeln!(
        text,
        "| all | {:.4} | 100.0 | |\n\n{:.0} pJ a pixel of the screen, {:.0} pJ a splat, {:.1} pJ a blended pixel.\n",
        energy.mj_per_frame, energy.pj_per_pixel, energy.pj_per_splat, energy.pj_per_blend
    )?;
    Ok(text)
}

/// The same machine with two channels and with each part; eight passes of sort over entries of eight bytes.
fn memories(workload: &Workload) -> Result<String> {
    let mut text = format!(
        "Memories, `primitive-4` at {CLOCK} MHz, eight passes of sort over entries of 8 bytes:\n\n\
         | memory | cycles | geometry | sort | raster | MB moved | % of peak | rows hit, % | turns of the bus | ms |\n\
         |---|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n"
    );
    let base = Config {
        clock_mhz: CLOCK,
        sort_passes: 8,
        sort_bytes: 8,
        ..Config::primitive(4)
    };
    for memory_part in 0..=PARTS.len() as u32 {
        let timing = simulate_alone(
            workload,
            &Config {
                memory_part,
                ..base
            },
        );
        let Timing {
            total,
            geometry,
            sort,
            raster,
            ..
        } = timing;
        let ms = total as f64 / (1000.0 * f64::from(CLOCK));
        let cells = match &timing.memory {
            None => format!("{:.2} | | | ", timing.bytes.all() as f64 / 1e6),
            Some(facts) => {
                let c = &facts.counts;
                let bursts = (c.reads + c.writes).max(1) as f64;
                format!(
                    "{:.2} | {:.1} | {:.1} | {}",
                    facts.bytes_moved as f64 / 1e6,
                    100.0 * facts.bytes_moved as f64 / facts.bytes_at_peak.max(1) as f64,
                    100.0 * c.row_hits as f64 / bursts,
                    c.turnarounds
                )
            }
        };
        let name = timing
            .memory
            .as_ref()
            .map_or("two channels, 64 and 32 bytes a cycle", |facts| facts.part);
        writeln!(
            text,
            "| {name} | {total} | {geometry} | {sort} | {raster} | {cells} | {ms:.2} |"
        )?;
    }
    Ok(text)
}
