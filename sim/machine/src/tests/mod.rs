//! The machine against a ticking oracle, closed forms and properties that hold for every workload and configuration.

mod golden;
mod oracle;
mod primitive;
mod properties;

use super::config::{Assignment, Binning, Config, LaneLayout, Overlap, Termination};
use super::workload::{Pair, SplatWork, Tile, Workload, WorkloadRow, mask};
use proptest::prelude::*;

/// Rows with arbitrary spans and pixels; a quarter of them is empty.
fn row() -> impl Strategy<Value = WorkloadRow> {
    (0u32..16, 0u32..20, any::<u64>(), any::<u64>()).prop_map(|(x, length, open, covered)| {
        let length = (length.saturating_sub(4)).min(16 - x);
        if length == 0 {
            return WorkloadRow::default();
        }
        let visited = mask(x, length);
        WorkloadRow {
            open: open & visited,
            covered: covered & visited,
            x: x as u8,
            length: length as u8,
        }
    })
}

/// Tiles of 16 x 8 pixels with arbitrary pairs, some of them finished after some pair.
pub(crate) fn workload() -> impl Strategy<Value = Workload> {
    let pair = (0u8..8, proptest::collection::vec(row(), 1..6));
    let tile = (
        proptest::collection::vec(pair, 0..8),
        proptest::option::of(1u32..8),
    );
    proptest::collection::vec(tile, 1..6).prop_map(|tiles| {
        let mut workload = Workload {
            tile: [16, 8],
            packet_bytes: 48,
            ..Workload::default()
        };
        for (pairs, finished) in tiles {
            let count = pairs.len() as u32;
            for (first_row, mut rows) in pairs {
                rows.truncate(8 - usize::from(first_row));
                let visits = rows.iter().any(|row| row.length > 0);
                workload.rows.extend(rows);
                let splat = workload.splats.len() as u32;
                workload.splats.push(SplatWork {
                    tiles: 1,
                    visited_tiles: visits.into(),
                });
                workload.pairs.push(Pair {
                    splat,
                    rows_end: workload.rows.len() as u32,
                    first_row,
                    visits,
                });
            }
            let finished_after = finished.filter(|after| *after <= count).unwrap_or(u32::MAX);
            workload.tiles.push(Tile {
                pairs_end: workload.pairs.len() as u32,
                finished_after,
                pixels: 128,
            });
        }
        workload.splats.push(SplatWork::default());
        workload
    })
}

/// Machines with small numbers everywhere, so that every limit is met.
pub(crate) fn machine() -> impl Strategy<Value = Config> {
    let choices = (0usize..4, 0usize..5, any::<[bool; 4]>(), 1u32..4, 0u32..6);
    let raster = (0u32..9, 0u32..5, 1u32..4, 1u32..4, 1u32..4, 1u32..5);
    let memory = (1u32..100, 1u32..100, 0u32..40, 1u32..5);
    let rest = (0u32..9, 1u32..12, 1u32..3, 1u32..4, 0u32..3, 0u32..3);
    (choices, raster, memory, rest).prop_map(|(choices, raster, memory, rest)| {
        let (layout, lanes, [serial, fixed, skip, exact], raster_units, tile_termination) = choices;
        let layout = [
            LaneLayout::Run,
            LaneLayout::Aligned,
            LaneLayout::Quad,
            LaneLayout::Rows,
        ][layout];
        let serial = serial && layout != LaneLayout::Rows;
        Config {
            tile_width: 16,
            tile_height: 8,
            lanes: (1 << lanes).max(if layout == LaneLayout::Quad { 2 } else { 1 }),
            layout,
            overlap: if serial {
                Overlap::Serial
            } else {
                Overlap::Pipelined
            },
            assignment: if fixed {
                Assignment::Static
            } else {
                Assignment::Dynamic
            },
            pixel_termination: if skip {
                Termination::Skip
            } else {
                Termination::Discard
            },
            binning: if exact { Binning::Exact } else { Binning::Box },
            raster_units,
            tile_termination,
            splat_cycles: raster.0,
            row_cycles: raster.1,
            rows_at_once: raster.2,
            packet_fifo: raster.3,
            splat_fifo: raster.4,
            row_fifo: raster.5,
            read_bandwidth: memory.0,
            write_bandwidth: memory.1,
            latency: memory.2,
            setup_units: memory.3,
            table_latency: rest.0,
            blend_latency: rest.1,
            blend_interval: rest.2,
            tile_buffers: rest.3,
            table_ports: rest.4,
            buffer_banks: rest.5,
            setup_fifo: raster.3,
            bin_fifo: raster.4,
            ..Config::default()
        }
    })
}
