//! The page of machines: throughput of the raster unit, machines of others beside ours, where bytes and energy go, and
//! what memory parts make of the same picture. The page shows the guitar; the CSV files have every scene.

use super::Page;
use crate::table::Table;
use crate::views::{BRAIN, GUITAR, LION, View};
use anyhow::{Context, Result};
use splatline::format::Traversal;
use splatline_sim::design::{DesignChoice, traversal_name};
use splatline_sim::fixed::Options;
use splatline_sim::machine::energy::{Energy, EnergyTable, estimate};
use splatline_sim::machine::lanes::{LaneShape, LaneWork};
use splatline_sim::machine::memory::parts::PARTS;
use splatline_sim::machine::others;
use splatline_sim::machine::workload::{Workload, extract};
use splatline_sim::machine::{Config, Timing, simulate, simulate_alone};
use splatline_sim::report::alone;
use splatline_sim::report::machine::{plots, watch};
use std::path::Path;

/// Pixels a side.
const SIZE: usize = 512;

const VIEWS: [&str; 5] = [BRAIN, GUITAR, "guitar close-up", "playbot", LION];

/// Clock of the machines with a memory part, MHz.
const CLOCK: u32 = 100;

/// The schedule of the public FPGA rasterizer: box_pixels + 3 rows + 8 pairs, no early termination.
const FPGA: &str =
    "overlap=serial row_cycles=3 rows_at_once=1 splat_cycles=8 tile_termination=0 latency=0";

/// Machines by name, as changes to the default one.
const MACHINES: [(&str, &str); 11] = [
    ("serial, 3 per row, 8 per pair", FPGA),
    ("1 lane", ""),
    ("1 lane, skips finished pixels", "pixel_termination=skip"),
    ("4 lanes, run", "lanes=4"),
    ("4 lanes, aligned", "lanes=4 layout=aligned"),
    ("4 lanes, quad", "lanes=4 layout=quad"),
    ("4 lanes, rows", "lanes=4 layout=rows rows_at_once=4"),
    (
        "4 lanes, rows, skips finished pixels",
        "lanes=4 layout=rows rows_at_once=4 pixel_termination=skip",
    ),
    ("8 lanes, run", "lanes=8 rows_at_once=4"),
    ("8 lanes, rows", "lanes=8 layout=rows rows_at_once=8"),
    ("4 x 1 lane, dynamic tiles", "raster_units=4"),
];

struct Tables {
    throughput: Table,
    others: Table,
    work: Table,
    energy: Table,
    memories: Table,
}

impl Tables {
    fn new() -> Tables {
        Tables {
            throughput: Table::new(
                "scene | machine | traversal | Mcycles | raster | covered | live | lanes busy | \
                 largest stall of the lanes",
            ),
            others: Table::new(
                "scene | machine | pixels tested | inside | blended | tested for one blended | \
                 products for one blended | cycles | raster cycles | MB | mJ | of this pixel path",
            ),
            work: Table::new("scene | what | of | count | %"),
            energy: Table::new("scene | unit | mJ | % | of this DRAM"),
            memories: Table::new(
                "scene | memory | cycles | geometry | sort | raster | MB moved | % of peak | rows hit, % | \
                 turns of the bus | ms",
            ),
        }
    }

    fn add(&mut self, view: &View, design: &DesignChoice) -> Result<()> {
        for traversal in [Traversal::Box, Traversal::Spans] {
            let workload = workload(view, design, traversal, &Config::default())?;
            for (machine, words) in MACHINES {
                let words: Vec<String> = words.split_whitespace().map(str::to_owned).collect();
                let mut config = Config::default();
                config.set_words(&words)?;
                let timing = simulate_alone(&workload, &config);
                let words = [view.name, machine, traversal_name(traversal)];
                self.throughput.push_behind(&words, lanes(&timing));
            }
        }
        let (drawn, energy) = (view.options(design), EnergyTable::default());
        for outcome in others::run_all(&view.scene, &view.camera, &drawn, &energy)? {
            self.others
                .push_behind(&[view.name], others::cells(&outcome));
        }
        let config = Config::primitive(4);
        let workload = workload(view, design, design.traversal, &config)?;
        let timing = simulate_alone(&workload, &config);
        for (of, whole, parts) in work(&workload, &timing) {
            for (what, count) in parts {
                let cells = [count.to_string(), percent(count, whole)];
                self.work.push_behind(&[view.name, what, of], cells);
            }
        }
        let energy = estimate(
            None,
            &design.widths,
            design.traversal,
            &config,
            &timing,
            &EnergyTable::default(),
        );
        for cells in energy_cells(&energy) {
            self.energy.push_behind(&[view.name], cells);
        }
        for part in 0..=PARTS.len() as u32 {
            self.memories
                .push_behind(&[view.name], memory_cells(&workload, part));
        }
        Ok(())
    }
}

/// The page over the scenes of a folder.
pub fn page(data: &Path) -> Result<Page> {
    let design = DesignChoice::load("standard24")?;
    let mut page = Page::new("machines", "Machines, memories and energy");
    let mut tables = Tables::new();
    for name in VIEWS {
        tables.add(&View::load(name, data, SIZE)?, &design)?;
    }
    page.add(
        "Pictures of 512 x 512, tiles of 16 x 16, design standard24. Tables are of the guitar from afar; files of CSV beside this page have five scenes. \
         `splatline simulate` prints the same of any scene and machine.",
    );
    page.add(
        "## Throughput of the raster unit\n\nA machine is the default one with the changes that its name says. *Covered* is covered pixels (r < c) that lanes visited, per \
         cycle of the raster phase, lane and raster unit; *live* counts only those that had not finished. Both count memory stalls, hazards and \
         drains. Mcycles are all three phases. By spans; [throughput.csv](throughput.csv) has boxes too.",
    );
    page.add(
        tables
            .throughput
            .only(0, GUITAR)
            .only(1, traversal_name(Traversal::Spans))
            .markdown(),
    );
    page.beside("throughput.csv", tables.throughput.csv());
    page.add(format!(
        "## Machines of others\n\n{}\nTested, inside and blended count pixels once per splat. Energy: {}. [machines.csv](machines.csv)",
        others::note(),
        EnergyTable::default().statement()
    ));
    page.add(tables.others.only(0, GUITAR).markdown());
    page.beside("machines.csv", tables.others.csv());
    page.add(
        "## Beside what is published\n\nOthers' figures are their abstracts'; - is what these leave out. None names a scene that could be run again, so only rate and energy of a screen's \
         pixel stand side by side. Ours are sixteen lanes as above (guitar, energy estimated for 45 nm with its DRAM) and circuits in standard cells, mapped by Yosys, memories apart. Who has a \
         paper's scenes runs `splatline optimize` and `splatline simulate --machines`. [published.csv](published.csv)",
    );
    let published = published(&tables.others.only(0, GUITAR))?;
    page.add(published.markdown());
    page.beside("published.csv", published.csv());
    page.add("## Where the work goes\n\nstandard24 on `primitive-4`; [work.csv](work.csv), [energy.csv](energy.csv).");
    page.add(tables.work.only(0, GUITAR).markdown());
    page.beside("work.csv", tables.work.csv());
    page.beside("energy.csv", tables.energy.csv());
    add_plots(&mut page, &View::load(GUITAR, data, SIZE)?, &design)?;
    page.add(format!(
        "## Memories\n\n`primitive-4` at {CLOCK} MHz, eight passes of sort over entries of 8 bytes; [memories.csv](memories.csv)."
    ));
    page.add(tables.memories.only(0, GUITAR).markdown());
    page.beside("memories.csv", tables.memories.csv());
    Ok(page)
}

/// What papers print of their machines, by their abstracts.
const PUBLISHED: &str = include_str!("published.csv");
/// Our circuits in the cells of a library, as `rtl -- area asic` prints them: a line a unit, the whole circuit first.
const CELLS: &str = include_str!("../../../rtl/cosim/asic.csv");

/// The published machines, and ours by the rows of machines that were run on one scene.
fn published(run: &Table) -> Result<Table> {
    let mut lines = PUBLISHED.lines();
    let headings = lines.next().context("published.csv is empty")?;
    let mut table = Table::new(&headings.replace(',', " | "));
    lines.for_each(|line| table.push(line.split(',').map(str::to_owned)));
    let screen = (SIZE * SIZE) as f64;
    for row in run
        .rows()
        .iter()
        .filter(|row| row[0].starts_with("splatline "))
    {
        let number = |place: usize| row[place].parse::<f64>();
        let (cycles, whole, path) = (number(6)?, number(9)?, number(10)?);
        let nanojoules = |millijoules: f64| 1e6 * millijoules / screen;
        table.push([
            row[0].clone(),
            "fixed".to_owned(),
            "setup; sort; sixteen lanes by rows".to_owned(),
            "estimate for 45 nm".to_owned(),
            "`rtl -- area`".to_owned(),
            "-".to_owned(),
            format!("{:.3} pixels a cycle", screen / cycles),
            format!(
                "{:.2} nJ a pixel; {:.2} in the pixel path",
                nanojoules(whole),
                nanojoules(path)
            ),
            "[accuracy](accuracy.md)".to_owned(),
            "whole frame with its DRAM".to_owned(),
        ]);
    }
    add_circuits(&mut table)?;
    Ok(table)
}

/// Primitives of four lanes in standard cells, each by the line of its top.
fn add_circuits(table: &mut Table) -> Result<()> {
    let lines = CELLS
        .lines()
        .map(|line| line.split(',').collect::<Vec<_>>());
    for line in lines.filter(|line| line[1] == "splat_primitive") {
        let number = |place: usize| line[place].parse::<f64>();
        let (design, _) = line[0]
            .split_once(' ')
            .context("asic.csv names no circuit")?;
        table.push([
            format!("splatline {design}"),
            "fixed".to_owned(),
            "splat primitive, four lanes".to_owned(),
            "SKY130 (synthesised)".to_owned(),
            format!(
                "{:.2} mm2 ({:.2} scaled to 28 nm); {:.0} k gates; {:.0} kbit",
                number(3)? / 1e6,
                number(8)?,
                number(4)? / 1e3,
                number(6)? / 1024.0
            ),
            format!("{:.0} without wires", 1e3 / number(7)?),
            "-".to_owned(),
            "-".to_owned(),
            "[accuracy](accuracy.md)".to_owned(),
            "`rtl -- area asic`".to_owned(),
        ]);
    }
    Ok(())
}

/// Plots of the cycles of four lanes.
fn add_plots(page: &mut Page, view: &View, design: &DesignChoice) -> Result<()> {
    let config = Config::primitive(4);
    let workload = workload(view, design, design.traversal, &config)?;
    let work = LaneWork::new(&workload, LaneShape::from(&config));
    let timing = simulate(&workload, &work, &config);
    let watched = watch(&workload, &work, &config, &timing);
    page.add("Where the cycles of `primitive-4` go, which `splatline model -o` writes for any machine and scene:");
    for plot in plots(&timing, &watched, &config) {
        let file = format!("machines-guitar-{}.svg", plot.file);
        page.add(format!("![{}]({file})", plot.title));
        page.beside(&file, alone(&plot.svg));
    }
    Ok(())
}

fn workload(
    view: &View,
    design: &DesignChoice,
    traversal: Traversal,
    config: &Config,
) -> Result<Workload> {
    let options = Options {
        traversal,
        ..view.options(design)
    };
    let tile = [config.tile_width, config.tile_height];
    Ok(extract(&view.scene, &view.camera, &options, tile)?)
}

fn percent(part: u64, whole: u64) -> String {
    format!("{:.1}", 100.0 * part as f64 / whole.max(1) as f64)
}

/// What the lanes do within the raster phase: what the other phases take is no fault of theirs.
fn lanes(timing: &Timing) -> [String; 6] {
    let lanes = timing.units.get("lanes").cloned().unwrap_or_default();
    let within = lanes.instances * timing.raster;
    let stall = lanes.stalled.iter().max_by_key(|(_, cycles)| **cycles);
    let stall = stall.map(|(cause, cycles)| {
        format!("{} {} %", cause.replace('_', " "), percent(*cycles, within))
    });
    [
        format!("{:.3}", timing.total as f64 / 1e6),
        format!("{:.3}", timing.raster as f64 / 1e6),
        format!("{:.3}", timing.pixels.covered_per_cycle_and_lane),
        format!("{:.3}", timing.pixels.live_per_cycle_and_lane),
        format!("{} %", percent(lanes.busy, within)),
        stall.unwrap_or_else(|| "-".to_owned()),
    ]
}

/// Of how many things of a kind how many are what.
type Shares = (&'static str, u64, Vec<(&'static str, u64)>);

/// Where splats, pairs, rows, pixels and bytes go.
fn work(workload: &Workload, timing: &Timing) -> [Shares; 6] {
    let (pixels, splats, bytes) = (&timing.pixels, &timing.splats, &timing.bytes);
    let pairs = workload.pairs.len() as u64;
    let without = workload.pairs.iter().filter(|pair| !pair.visits).count() as u64;
    let of_pairs = vec![
        ("pairs without a pixel", without),
        (
            "pairs left out, their tile having finished",
            pixels.pairs_left_out,
        ),
    ];
    let empty = pixels.rows - pixels.runs.min(pixels.rows);
    let blended = ("pixels blended", pixels.live);
    let of_pixels = vec![
        (
            "pixels outside the footprint",
            pixels.visited - pixels.covered,
        ),
        ("pixels that had finished", pixels.covered - pixels.live),
        blended,
    ];
    let of_bytes = vec![
        ("bytes of splats", bytes.splats_read),
        ("bytes of packets and lists written", bytes.packets_written),
        ("bytes of the sort", bytes.sort_moved),
        ("bytes of packets and lists read", bytes.packets_read),
        ("bytes of pixels", bytes.pixels_written),
    ];
    let seen = vec![("splats that are seen", splats.visible)];
    let all_visited = workload.totals().visited;
    [
        ("splats", splats.fetched, seen),
        ("pairs", pairs, of_pairs),
        (
            "rows drawn",
            pixels.rows,
            vec![("rows without a pixel", empty)],
        ),
        ("pixels visited", pixels.visited, of_pixels),
        ("pixels of all pairs", all_visited, vec![blended]),
        ("bytes", bytes.all(), of_bytes),
    ]
}

fn energy_cells(energy: &Energy) -> Vec<[String; 4]> {
    let millijoules = |attojoules: u64| format!("{:.4}", attojoules as f64 / 1e15);
    let mut cells: Vec<_> = energy
        .units
        .iter()
        .map(|unit| {
            let [own, dram] = [unit.attojoules, unit.dram_attojoules].map(millijoules);
            [
                unit.unit.to_owned(),
                own,
                percent(unit.attojoules, energy.attojoules),
                dram,
            ]
        })
        .collect();
    cells.push([
        "all".to_owned(),
        format!("{:.4}", energy.mj_per_frame),
        "100.0".to_owned(),
        String::new(),
    ]);
    cells
}

/// The same machine with two channels (part 0) or with a part; eight passes of sort over entries of eight bytes.
fn memory_cells(workload: &Workload, memory_part: u32) -> Vec<String> {
    let config = Config {
        clock_mhz: CLOCK,
        sort_passes: 8,
        sort_bytes: 8,
        memory_part,
        ..Config::primitive(4)
    };
    let timing = simulate_alone(workload, &config);
    let (name, moved, of_part) = match &timing.memory {
        None => {
            let name = "two channels, 64 and 32 bytes a cycle";
            (name, timing.bytes.all(), <[String; 3]>::default())
        }
        Some(facts) => {
            let counts = &facts.counts;
            let of_part = [
                percent(facts.bytes_moved, facts.bytes_at_peak),
                percent(counts.row_hits, counts.reads + counts.writes),
                counts.turnarounds.to_string(),
            ];
            (facts.part, facts.bytes_moved, of_part)
        }
    };
    let cycles = [timing.total, timing.geometry, timing.sort, timing.raster]
        .map(|cycles| cycles.to_string());
    let ms = format!("{:.2}", timing.total as f64 / (1000.0 * f64::from(CLOCK)));
    [name.to_owned()]
        .into_iter()
        .chain(cycles)
        .chain([format!("{:.2}", moved as f64 / 1e6)])
        .chain(of_part)
        .chain([ms])
        .collect()
}
