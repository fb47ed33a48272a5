//! The machine against a ticking oracle, closed forms and properties that hold for every workload and configuration.

mod golden;
mod oracle;
mod primitive;
mod properties;

use super::config::{Assignment, Binning, Config, LaneLayout, Overlap, Termination};
use super::workload::{Pair, SplatWork, Tile, Workload, WorkloadRow, mask};
use proptest::prelude::*;
use proptest::sample::select;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;

/// A machine with settings changed by words, `key=value` each, of which the machine must be one.
pub(crate) fn changed(mut config: Config, words: &str) -> Config {
    let words: Vec<String> = words.split_whitespace().map(str::to_owned).collect();
    config.set_words(&words).unwrap();
    config
}

/// What a machine is told that is no machine once it is changed by these words.
pub(crate) fn refused(mut config: Config, words: &str) -> String {
    let words: Vec<String> = words.split_whitespace().map(str::to_owned).collect();
    config.set_words(&words).unwrap_err().to_string()
}

/// Asserts that a message says all of this.
#[track_caller]
pub(crate) fn says(message: &str, all: &[&str]) {
    for words in all {
        assert!(message.contains(words), "{words}: {message}");
    }
}

/// A settings file in which a line, counted from 0, is another one.
pub(crate) fn with_line(text: &str, index: usize, line: &str) -> String {
    let mut lines: Vec<&str> = text.lines().collect();
    lines[index] = line;
    lines.join("\n") + "\n"
}

/// Tiles of 16 x 8 pixels, as those of [`workload`].
pub(crate) fn small_tiles() -> Config {
    Config {
        tile_width: 16,
        tile_height: 8,
        ..Config::default()
    }
}

/// One of [`workload`]'s, always the same.
pub(crate) fn one_workload() -> Workload {
    let tree = workload().new_tree(&mut TestRunner::deterministic());
    tree.unwrap().current()
}

/// A row of which these pixels are covered and visited.
pub(crate) fn covered_row(x: u32, length: u32, open: bool) -> WorkloadRow {
    let covered = mask(x, length);
    WorkloadRow {
        open: if open { covered } else { 0 },
        covered,
        x: x as u8,
        length: length as u8,
    }
}

/// Rows with arbitrary spans and pixels; a quarter of them is empty.
fn row() -> impl Strategy<Value = WorkloadRow> {
    (0u32..16, 0u32..20, any::<u64>(), any::<u64>()).prop_map(|(x, length, open, covered)| {
        let length = (length.saturating_sub(4)).min(16 - x);
        if length == 0 {
            return WorkloadRow::default();
        }
        let visited = covered_row(x, length, true);
        WorkloadRow {
            open: open & visited.open,
            covered: covered & visited.covered,
            ..visited
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
    use LaneLayout::{Aligned, Quad, Rows, Run};
    let choices = (
        select(vec![Run, Aligned, Quad, Rows]),
        0usize..5,
        select(vec![Overlap::Serial, Overlap::Pipelined]),
        select(vec![Assignment::Static, Assignment::Dynamic]),
        select(vec![Termination::Skip, Termination::Discard]),
        select(vec![Binning::Exact, Binning::Box]),
        1u32..4,
        0u32..6,
    );
    let raster = (0u32..9, 0u32..5, 1u32..4, 1u32..4, 1u32..4, 1u32..5);
    let memory = (1u32..100, 1u32..100, 0u32..40, 1u32..5);
    let rest = (0u32..9, 1u32..12, 1u32..3, 1u32..4, 0u32..3, 0u32..3);
    (choices, raster, memory, rest).prop_map(|(choices, raster, memory, rest)| {
        let (layout, lanes, overlap, assignment, pixel_termination, binning, units, checked) =
            choices;
        Config {
            lanes: (1 << lanes).max(if layout == Quad { 2 } else { 1 }),
            layout,
            overlap: match layout {
                Rows => Overlap::Pipelined,
                _ => overlap,
            },
            assignment,
            pixel_termination,
            binning,
            raster_units: units,
            tile_termination: checked,
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
            ..small_tiles()
        }
    })
}
