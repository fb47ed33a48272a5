//! The same raster unit as a clocked state machine: one loop turn per cycle, no recurrence, no accounts.
//!
//! It shares the bands with the fast model and nothing else. Within a cycle its stages act until nothing changes any
//! more, because a result may pass through an empty FIFO in the cycle in which it is ready.

use super::super::config::{Assignment, Config, LaneLayout, Overlap};
use super::super::lanes::{Band, LaneShape, LaneWork};
use super::super::simulate_alone;
use super::{machine, workload};
use proptest::prelude::*;
use std::collections::VecDeque;

/// Cycles until the last band of one tile has left the lanes.
fn ticking(work: &LaneWork, config: &Config, packet_bytes: u32) -> u64 {
    let transfer = u64::from((packet_bytes + config.list_bytes).div_ceil(config.read_bandwidth));
    let lanes = match config.layout {
        LaneLayout::Rows => config.lanes as usize,
        _ => 1,
    };
    let stretch = u64::from(config.stretch());
    let mut to_fetch: VecDeque<usize> = (0..work.pairs.len()).collect();
    let mut fetch_free_at = 0;
    let mut packets: VecDeque<(usize, u64)> = VecDeque::new();
    let mut in_setup: Option<(usize, u64)> = None;
    let mut splats: VecDeque<usize> = VecDeque::new();
    let mut bands: VecDeque<(Band, u64)> = VecDeque::new();
    let mut in_rows: Option<(Band, u64)> = None;
    let mut runs: Vec<VecDeque<Band>> = vec![VecDeque::new(); lanes];
    // When each lane is free.
    let mut lane_at = vec![0; lanes];
    let mut flights: Vec<(Band, u64)> = Vec::new();
    let mut last = 0;
    for now in 0..1_000_000 {
        loop {
            let mut changed = false;
            for (free_at, runs) in lane_at.iter_mut().zip(&mut runs) {
                let may = |band: &Band| {
                    let mut flights = flights.iter();
                    flights.all(|flight| may_start(band, flight, now, config))
                };
                if let Some(band) = runs.front().copied()
                    && *free_at <= now
                    && may(&band)
                {
                    *free_at = now + u64::from(band.groups) * stretch;
                    last = last.max(*free_at);
                    flights.push((band, now));
                    runs.pop_front();
                    changed = true;
                }
            }
            if let Some((band, done)) = in_rows
                && done <= now
            {
                let queue = &mut runs[usize::from(band.y) % lanes];
                if band.groups == 0 || queue.len() < config.row_fifo as usize {
                    if band.groups > 0 {
                        queue.push_back(band);
                    }
                    in_rows = None;
                    changed = true;
                }
            }
            if in_rows.is_none() {
                if let Some((band, service)) = bands.pop_front() {
                    in_rows = Some((band, now + service));
                    changed = true;
                } else if let Some(pair) = splats.pop_front() {
                    bands = services(work, pair, config);
                    changed = true;
                }
            }
            if let Some((pair, done)) = in_setup
                && done <= now
                && splats.len() < config.splat_fifo as usize
            {
                splats.push_back(pair);
                in_setup = None;
                changed = true;
            }
            if in_setup.is_none() && packets.front().is_some_and(|(_, arrival)| *arrival <= now) {
                in_setup = packets
                    .pop_front()
                    .map(|(pair, _)| (pair, now + u64::from(config.splat_cycles)));
                changed = true;
            }
            if fetch_free_at <= now
                && packets.len() < config.packet_fifo as usize
                && let Some(pair) = to_fetch.pop_front()
            {
                fetch_free_at = now + transfer;
                packets.push_back((pair, fetch_free_at + u64::from(config.latency)));
                changed = true;
            }
            if !changed {
                break;
            }
        }
        let waiting = to_fetch.len()
            + packets.len()
            + splats.len()
            + bands.len()
            + runs.iter().map(VecDeque::len).sum::<usize>();
        if waiting == 0 && in_setup.is_none() && in_rows.is_none() {
            return last;
        }
    }
    panic!("the oracle has come to a deadlock");
}

/// A pair's bands with the row generator's cycles: a step begins with every `rows_at_once`-th row.
fn services(work: &LaneWork, pair: usize, config: &Config) -> VecDeque<(Band, u64)> {
    let before = pair.checked_sub(1);
    let first = before.map_or(0, |before| work.pairs[before].bands_end as usize);
    let mut row = 0;
    let service = |band: &Band| {
        let rows = row..row + u32::from(band.rows);
        row = rows.end;
        let begun = rows.filter(|row| row % config.rows_at_once == 0).count();
        (*band, begun as u64 * u64::from(config.row_cycles))
    };
    let bands = &work.bands[first..work.pairs[pair].bands_end as usize];
    bands.iter().map(service).collect()
}

/// The document's interlock in signed numbers.
fn may_start(band: &Band, (flight, start): &(Band, u64), now: u64, config: &Config) -> bool {
    if flight.y != band.y || flight.first >= band.last || band.first >= flight.last {
        return true;
    }
    let (stretch, stride, latency) = (
        f64::from(config.stretch()),
        f64::from(LaneShape::from(config).stride()),
        f64::from(config.blend_latency),
    );
    let groups = ((f64::from(band.first) - f64::from(flight.first)) / stride).ceil()
        + f64::from(band.skipped);
    let settled = *start as f64 + f64::from(flight.groups) * stretch - stretch + latency;
    now as f64 >= (*start as f64 + latency + groups * stretch).min(settled)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]
    #[test]
    fn the_recurrence_is_the_clocked_machine(mut workload in workload(), config in machine()) {
        // One tile, one unit: tiles only chain these.
        let tile = &mut workload.tiles[0];
        tile.pairs_end = workload.pairs.len() as u32;
        workload.tiles.truncate(1);
        let config = Config {
            overlap: Overlap::Pipelined,
            assignment: Assignment::Static,
            raster_units: 1,
            tile_termination: 0,
            tile_buffers: 1,
            table_latency: 0,
            blend_latency: config.blend_latency,
            write_back_cycles: 1,
            pixel_bytes: 1,
            write_bandwidth: 65_536,
            ..config
        };
        let work = LaneWork::new(&workload, LaneShape::from(&config));
        let timing = simulate_alone(&workload, &config);
        let lanes = ticking(&work, &config, workload.packet_bytes);
        if work.pairs.is_empty() {
            return Ok(());
        }
        // The last group is blended, then one cycle begins and one moves the write-back; the generator may outlast it
        // on empty rows.
        let written_back = lanes + u64::from(config.blend_latency) + 2;
        prop_assert!(timing.raster >= written_back);
        if work.bands.last().is_some_and(|band| band.groups > 0) {
            prop_assert_eq!(timing.raster, written_back);
        }
    }
}
