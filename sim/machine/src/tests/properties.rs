//! Closed forms where they exist, conservation, monotonicity, and safety of the interlock pixel by pixel.

use super::super::config::{
    Assignment, Config, LaneLayout, Overlap, Termination, TileWalk, setting,
};
use super::super::lanes::{LaneShape, LaneWork};
use super::super::observe::{Event, Stage};
use super::super::timing::PixelWork;
use super::super::workload::{Workload, mask};
use super::super::{simulate_alone, simulate_observed};
use super::{machine, workload};
use proptest::prelude::*;
use std::collections::HashMap;

/// A machine in which nothing but the raster unit's own service costs time.
fn unlimited(config: Config) -> Config {
    Config {
        read_bandwidth: 65_536,
        write_bandwidth: 65_536,
        latency: 0,
        blend_latency: 1,
        blend_interval: 1,
        table_ports: 0,
        buffer_banks: 0,
        tile_buffers: 64,
        raster_units: 1,
        tile_termination: 0,
        ..config
    }
}

/// A setting's value and so much more.
fn more_of(config: &Config, key: &str, more: u32) -> toml::Value {
    let value = setting(key).unwrap().value(config).as_integer().unwrap();
    (value + i64::from(more)).into()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn one_serial_unit_costs_its_closed_form(workload in workload(), config in machine(), lanes in 0u32..5) {
        let config = Config {
            overlap: Overlap::Serial,
            layout: LaneLayout::Run,
            lanes: 1 << lanes,
            pixel_termination: Termination::Discard,
            binning: super::Binning::Box,
            rows_at_once: 1,
            ..unlimited(config)
        };
        let timing = simulate_alone(&workload, &config);
        let groups: u64 = workload.rows.iter().map(|row| u64::from(row.length).div_ceil(u64::from(config.lanes))).sum();
        let expected = groups
            + u64::from(config.row_cycles) * workload.rows.len() as u64
            + u64::from(config.splat_cycles) * workload.pairs.len() as u64;
        let busy: u64 = ["lanes", "row_generator", "splat_setup"].iter().map(|unit| timing.units[unit].busy).sum();
        prop_assert_eq!(busy, expected);
        let lanes = &timing.units["lanes"];
        // One cycle for the only packet that nothing hides, none for hazards: a row takes a cycle or more.
        let waited = lanes.stalled.get("memory").copied().unwrap_or(0);
        prop_assert_eq!(lanes.busy + lanes.stalled.get("turn").copied().unwrap_or(0), expected);
        prop_assert!(waited <= workload.pairs.len() as u64);
    }

    /// A cache that holds every splat reads each once a unit; whatever it saves is accounted for, and no picture takes
    /// longer by it.
    #[test]
    fn a_cache_saves_what_it_says(mut workload in workload(), config in machine(), order in 0usize..4) {
        workload.pairs.iter_mut().for_each(|pair| pair.splat %= 3);
        workload.columns = 2;
        let orders = [TileWalk::Raster, TileWalk::Serpentine, TileWalk::Morton, TileWalk::Hilbert];
        let without = Config { raster_units: 1, tile_order: orders[order], ..config };
        let with = Config { packet_cache: 16, ..without };
        let [before, after] = [without, with].map(|config| simulate_alone(&workload, &config));
        prop_assert_eq!(after.bytes.packets_read + after.bytes.packets_cached, before.bytes.packets_read);
        prop_assert_eq!(before.bytes.packets_cached, 0);
        prop_assert!(after.total <= before.total);
        prop_assert_eq!(after.pixels, PixelWork { packet_hits: after.pixels.packet_hits, covered_per_cycle_and_lane: after.pixels.covered_per_cycle_and_lane,
            live_per_cycle_and_lane: after.pixels.live_per_cycle_and_lane, ..before.pixels });
        let misses = before.pixels.pairs - after.bytes.packets_cached / u64::from(workload.packet_bytes);
        prop_assert!(misses <= 3, "{} misses of three splats", misses);
        let raster = simulate_alone(&workload, &Config { tile_order: TileWalk::Raster, ..without });
        prop_assert_eq!(raster.pixels.pairs, before.pixels.pairs);
        prop_assert_eq!(raster.bytes, before.bytes);
    }

    #[test]
    fn lanes_alone_cost_their_groups(workload in workload(), config in machine()) {
        let config = Config {
            overlap: Overlap::Pipelined,
            splat_cycles: 0,
            row_cycles: 0,
            packet_fifo: 64,
            row_fifo: 64,
            ..unlimited(config)
        };
        let timing = simulate_alone(&workload, &config);
        let lanes = &timing.units["lanes"];
        prop_assert_eq!(lanes.busy, timing.pixels.groups);
        if config.layout != LaneLayout::Rows {
            prop_assert_eq!(lanes.stalled.get("row_generator"), None);
            prop_assert_eq!(lanes.stalled.get("hazard"), None);
        }
    }

    #[test]
    fn accounts_add_up_and_pixels_are_conserved(workload in workload(), config in machine()) {
        let timing = simulate_alone(&workload, &config);
        prop_assert_eq!(timing.total, timing.geometry + timing.sort + timing.raster);
        for (name, unit) in &timing.units {
            prop_assert_eq!(unit.busy + unit.stalled_sum() + unit.idle, unit.instances * timing.total, "{}", name);
        }
        for (name, fifo) in &timing.fifos {
            prop_assert!(fifo.high_water <= fifo.depth, "{}", name);
        }
        let pixels = &timing.pixels;
        prop_assert!(pixels.live <= pixels.covered && pixels.covered <= pixels.visited);
        if config.layout != LaneLayout::Rows || config.stretch() == 1 {
            prop_assert!(pixels.visited <= pixels.slots);
        }
        let totals = workload.totals();
        if config.tile_termination == 0 && config.pixel_termination == Termination::Discard {
            prop_assert_eq!((pixels.visited, pixels.covered, pixels.live), (totals.visited, totals.covered, totals.live));
        }
        // Skipping never loses a pixel that matters.
        if config.tile_termination == 0 {
            prop_assert_eq!(pixels.live, totals.live);
        }
    }

    /// Units that take their tiles as they become free are left out: a longer step may hand a tile to another unit and
    /// end the frame sooner, as in any list schedule (docs/hardware-model.md, "Tiles"). A unit by itself may not.
    #[test]
    fn nothing_gets_faster_by_waiting_longer(workload in workload(), config in machine(), key in 0usize..12, more in 1u32..9) {
        let config = match config.raster_units {
            1 => config,
            _ => Config { assignment: Assignment::Static, ..config },
        };
        let key = [
            "latency", "setup_interval", "setup_latency", "bin_cycles", "bin_tile_cycles", "sort_cycles", "splat_cycles", "row_cycles",
            "table_latency", "blend_latency", "write_back_cycles", "harmonics_cycles",
        ][key];
        let mut slower = config;
        slower.set("test", key, &more_of(&config, key, more)).unwrap();
        prop_assert!(simulate_alone(&workload, &slower).total >= simulate_alone(&workload, &config).total, "{}", key);
    }

    #[test]
    fn bandwidth_and_depth_never_hurt(workload in workload(), config in machine(), key in 0usize..7, more in 1u32..9) {
        // Without tile termination: with it, deeper packet FIFOs fetch more that is dropped.
        let config = Config { tile_termination: 0, ..config };
        let key = ["read_bandwidth", "write_bandwidth", "packet_fifo", "splat_fifo", "row_fifo", "setup_fifo", "tile_buffers"][key];
        let mut better = Config { assignment: Assignment::Static, ..config };
        let before = simulate_alone(&workload, &better).total;
        better.set("test", key, &more_of(&config, key, more)).unwrap();
        prop_assert!(simulate_alone(&workload, &better).total <= before, "{}", key);
    }

    #[test]
    fn more_lanes_never_cost_cycles_without_hazards(workload in workload(), config in machine(), lanes in 1u32..4) {
        let config = Config { pixel_termination: Termination::Discard, lanes: 1 << lanes, ..unlimited(config) };
        let wider = Config { lanes: 2 << lanes, ..config };
        prop_assert!(simulate_alone(&workload, &wider).total <= simulate_alone(&workload, &config).total);
    }

    #[test]
    fn a_pixel_is_never_read_before_it_is_written(workload in workload(), config in machine()) {
        let mut events = Vec::new();
        let work = LaneWork::new(&workload, LaneShape::from(&config));
        simulate_observed(&workload, &work, &config, &mut events);
        let spans = spans(&workload, &config);
        let mut written: HashMap<(u32, u32, u32), u64> = HashMap::new();
        for event in events.iter().filter(|event| event.stage == Stage::Lanes) {
            for (column, issue) in issues(&spans[&(event.splat, event.row)], event, &config) {
                let place = (event.tile, event.row, column);
                if let Some(before) = written.insert(place, issue + u64::from(config.blend_latency)) {
                    prop_assert!(before <= issue, "{:?} of {:?}", place, event);
                }
            }
        }
    }

    #[test]
    fn splitting_the_run_of_tiles_changes_nothing(workload in workload(), config in machine()) {
        // Tiles are independent but for the state that the unit carries: an empty tile in between must cost its
        // write-back only.
        let config = Config { raster_units: 1, tile_buffers: 64, write_bandwidth: 65_536, write_back_cycles: 0, ..config };
        let mut split = workload.clone();
        let tiles = std::mem::take(&mut split.tiles);
        for tile in tiles {
            split.tiles.push(tile);
            split.tiles.push(super::Tile { pairs_end: tile.pairs_end, finished_after: u32::MAX, pixels: 0 });
        }
        let (whole, split) = (simulate_alone(&workload, &config), simulate_alone(&split, &config));
        prop_assert_eq!(&whole.units["lanes"], &split.units["lanes"]);
        prop_assert_eq!(&whole.pixels, &split.pixels);
    }
}

/// Visited and wanted columns per splat and band.
fn spans(workload: &Workload, config: &Config) -> HashMap<(u32, u32), (u64, u64)> {
    let mut spans = HashMap::new();
    for (number, pair) in workload.pairs.iter().enumerate() {
        for (y, row) in (u32::from(pair.first_row)..).zip(workload.rows_of(number)) {
            let y = match config.layout {
                LaneLayout::Quad => y / 2,
                _ => y,
            };
            let wanted = match config.pixel_termination {
                Termination::Skip => row.open,
                Termination::Discard => row.visited(),
            };
            let entry = spans.entry((pair.splat, y)).or_insert((0, 0));
            *entry = (entry.0 | row.visited(), entry.1 | wanted);
        }
    }
    spans
}

/// Columns and the cycle in which each is issued, group by group.
fn issues((visited, wanted): &(u64, u64), event: &Event, config: &Config) -> Vec<(u32, u64)> {
    let stride = LaneShape::from(config).stride();
    let low = visited.trailing_zeros();
    let start = match config.layout {
        LaneLayout::Run => low,
        _ => low - low % stride,
    };
    let mut issue = event.start;
    let mut columns = Vec::new();
    for group in (start..64 - visited.leading_zeros()).step_by(stride as usize) {
        if wanted & mask(group, stride) != 0 {
            let all = (group..group + stride).filter(|column| *column < 64);
            let seen = all.filter(|column| visited >> column & 1 == 1);
            columns.extend(seen.map(|column| (column, issue)));
            issue += u64::from(config.stretch());
        }
    }
    assert_eq!(issue, event.end, "an event's groups must fill its cycles");
    columns
}
