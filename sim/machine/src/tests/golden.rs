//! What the model computes, to the last digit, for machines that meet every setting: a change of its code must change
//! no figure.
//!
//! `SPLATLINE_WRITE_GOLDEN=1 cargo test -p splatline-machine golden` writes the table again; a line that changes needs
//! its reason in the same commit.

use super::super::area::{self, Family};
use super::super::clock::{Clock, Throughput};
use super::super::energy::{self, Energy, EnergyTable};
use super::super::histogram::Histograms;
use super::super::lanes::{LaneShape, LaneWork};
use super::super::memory::Access;
use super::super::observe::Event;
use super::super::workload::{Workload, extract};
use super::super::{Config, Timing, others, simulate_observed, timing};
use super::changed;
use crate::design::DesignChoice;
use crate::fixed::Options;
use crate::scene::{Scene, synthetic};
use std::fmt::Write;

/// Machines by the settings in which they differ from the default or from a named machine.
const MACHINES: [&str; 24] = [
    "",
    "lanes=4 layout=run rows_at_once=4",
    "lanes=4 layout=aligned binning=exact pixel_termination=skip",
    "lanes=4 layout=quad tile_height=8 table_ports=2",
    "lanes=4 layout=rows row_fifo=4 raster_units=3 assignment=static",
    "lanes=8 layout=rows raster_units=2 tile_order=hilbert packet_cache=64",
    "overlap=serial splat_cycles=3 row_cycles=2 tile_order=serpentine",
    "tile_width=32 tile_height=32 tile_order=morton packet_cache=16 buffer_banks=2 lanes=8",
    "tile_width=64 tile_height=64 tile_termination=0 tile_buffers=1 clear_cycles=256 blend_interval=2",
    "tile_width=8 tile_height=8 tile_termination=16 bin_fifo=1 setup_fifo=2 setup_units=2 setup_interval=5",
    "sorter=radix sort_bytes=12 sort_digit=6",
    "sorter=merge sort_bytes=12 sort_run=64 sort_ways=4 overlap_frames=2 clock_mhz=150",
    "sort_passes=3 sort_cycles=2 overlap_frames=3 harmonics_bytes=90",
    "read_bandwidth=6 write_bandwidth=3 latency=200 packet_bytes=64 list_bytes=8 pixel_bytes=16 packet_fifo=4",
    "memory_part=ddr3-1600-x16 clock_mhz=100",
    "memory_part=lpddr4-3200-x32 clock_mhz=200 raster_units=4 assignment=static harmonics_bytes=48 sort_passes=2",
    "memory_part=lpddr4-3200-x32 clock_mhz=400 write_queue=2 lanes=4 layout=rows binning=exact",
    "memory_part=sdr-166-x16 clock_mhz=50 overlap=serial tile_buffers=1",
    "primitive-1",
    "primitive-4 raster_units=2",
    "primitive-16 splat_cycles=1 memory_part=ddr3-1600-x16 clock_mhz=100",
    "machine-1",
    "machine-4",
    "machine-8 tile_buffers=3 read_bandwidth=32",
];

const DESIGNS: [&str; 4] = ["classic8", "lean18", "standard24", "deep32"];

fn machine(words: &str) -> Config {
    let (name, others) = words.split_once(' ').unwrap_or((words, ""));
    match Config::named(name) {
        Some(named) => changed(named, others),
        None => changed(Config::default(), words),
    }
}

fn work(scene: &Scene, design: &DesignChoice, config: &Config) -> Workload {
    let options = Options::front_to_back(&scene.natural_rules, design);
    let tile = [config.tile_width, config.tile_height];
    extract(scene, &synthetic::camera(150, 110), &options, tile).unwrap()
}

/// A checksum of everything in a result, its last digits included.
fn checksum(result: &impl serde::Serialize) -> u32 {
    crc32fast::hash(serde_json::to_string(result).unwrap().as_bytes())
}

/// The cells of a timing and an energy: both in numbers and as checksums.
fn cells(timing: &Timing, energy: &Energy) -> String {
    format!(
        "{},{},{},{},{},{},{:08x},{:08x}",
        timing.total,
        timing.geometry,
        timing.sort,
        timing.raster,
        timing.bytes.all(),
        energy.attojoules,
        checksum(timing),
        checksum(&energy.units)
    )
}

fn checksum_of_words(words: impl Iterator<Item = u64>) -> u32 {
    let bytes: Vec<u8> = words.flat_map(u64::to_le_bytes).collect();
    crc32fast::hash(&bytes)
}

fn checksum_of_events(events: &[Event]) -> u32 {
    checksum_of_words(events.iter().flat_map(|event| {
        let Event {
            unit,
            stage,
            lane,
            tile,
            splat,
            row,
            start,
            end,
        } = *event;
        let places = [unit, stage as u32, lane, tile, splat, row];
        places.map(u64::from).into_iter().chain([start, end])
    }))
}

fn checksum_of_requests(accesses: &[Access]) -> u32 {
    let words = |access: &Access| [access.cycle, access.address, access.write.into()];
    checksum_of_words(accesses.iter().flat_map(words))
}

/// One machine with one design on one picture.
fn row(words: &str, name: &str, design: &DesignChoice, workload: &Workload) -> String {
    let config = machine(words);
    let work = LaneWork::new(workload, LaneShape::from(&config));
    let mut events: Vec<Event> = Vec::new();
    let timing: Timing = simulate_observed(workload, &work, &config, &mut events);
    let requests = timing::accesses(workload, &work, &config).unwrap_or_default();
    let (widths, traversal) = (&design.widths, design.traversal);
    let table = EnergyTable::default();
    let energy = energy::estimate(None, widths, traversal, &config, &timing, &table);
    let mut line = format!(
        "{words},{name},{},{:08x},{:08x},{:08x}",
        cells(&timing, &energy),
        checksum(&Histograms::new(&work, &config, workload.splats.len())),
        checksum_of_events(&events),
        checksum_of_requests(&requests),
    );
    for family in Family::ALL {
        let area = area::estimate(widths, traversal, &config, &family.calibration());
        let mut pace = Throughput::new(&timing, &config, Clock::of(&config, widths, family));
        // Which page a clock is from is no figure.
        pace.clock.of.clear();
        let resources = [area.raster, area.around].map(|fabric| fabric.resources());
        let luts = resources.map(|[(_, luts), ..]| luts);
        let area = serde_json::json!([area.raster, area.around, area.weight]);
        let _ = write!(
            line,
            ",{},{},{:.3},{:08x},{:08x}",
            luts[0],
            luts[1],
            pace.clock.mhz,
            checksum(&area),
            checksum(&pace)
        );
    }
    line
}

fn table() -> String {
    let mut text = String::from(
        "machine,design,cycles,geometry,sort,raster,bytes,attojoules,timing,energy,histograms,events,requests",
    );
    for family in Family::ALL {
        let name = family.name();
        let _ = write!(
            text,
            ",{name} raster LUT,{name} other LUT,{name} MHz,{name} area,{name} pace"
        );
    }
    text.push('\n');
    let scene = synthetic::random_gaussians(700, 4, 3.0);
    for words in MACHINES {
        for name in DESIGNS {
            let design = DesignChoice::named(name).unwrap();
            let workload = work(&scene, &design, &machine(words));
            let _ = writeln!(text, "{}", row(words, name, &design, &workload));
        }
    }
    for preset in others::PRESETS.iter() {
        let design = preset.design();
        let workload = work(&scene, &design, &preset.config());
        let outcome = others::outcome(preset, &workload, &EnergyTable::default());
        let cells = cells(&outcome.timing, &outcome.energy);
        let (name, design, products) = (&preset.name, &design.name, outcome.products);
        let _ = writeln!(text, "{name},{design},{cells},{products}");
    }
    text
}

#[test]
fn golden_figures_stay_to_the_last_digit() {
    let (now, before) = (table(), include_str!("golden.csv"));
    if std::env::var_os("SPLATLINE_WRITE_GOLDEN").is_some() {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/src/tests/golden.csv");
        std::fs::write(file, &now).unwrap();
        return;
    }
    for (now, before) in now.lines().zip(before.lines()) {
        assert_eq!(now, before);
    }
    assert_eq!(now.lines().count(), before.lines().count());
}
