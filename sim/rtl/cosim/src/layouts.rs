//! Arrangements of the pixel lanes, compared by their cycles on guitar: why each lane owns rows.
//!
//! Utilisation is covered pixels / (cycles * lanes). For interleaved rows, cycles are the circuit's own ([`PrimitiveClock`]). The others are
//! given the benefit of the doubt: each tile takes the larger of its row slots (one a cycle) and its groups of pixels, as though
//! queues were endless, plus the pipeline's latency.

use crate::golden::Golden;
use crate::workload::{BenchTile, BenchWorkload, GuitarView, TILE, guitar, tiles};
use anyhow::{Context, Result};
use splatline::footprint::Footprint;
use splatline::format::Lean18;
use splatline::raster::{EllipseSpans, Spans, Window};
use splatline_sim::design::DesignChoice;
use splatline_sim::fixed::kernel_rules;
use splatline_sim::machine::primitive::{LATENCY, PrimitiveClock, QUEUE, for_each_slot};
use splatline_sim::rules::Rules;

/// Where the table is kept.
pub const REPORT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../docs/lanes.md");

const LANES: usize = 4;

/// Columns and rows of the pictures.
const SIZE: usize = 512;

/// How four lanes share a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum PacketLayout {
    /// Four adjacent pixels from the run's first on: a bank for each column modulo 4 and a rotation.
    Unaligned,
    /// Four adjacent pixels from a multiple of 4 on: one wide word.
    Aligned,
    /// 2 x 2 pixels at even places, two rows of the splat at a time.
    Quads,
    /// A lane for each row modulo 4, with queues of so many runs.
    Rows(u32),
}

/// The whole table.
pub fn report() -> Result<String> {
    let mut text =
        HEAD.to_owned() + "| arrangement | tile | close-up | whole |\n|---|---|---|---|\n";
    let design = DesignChoice::named("lean18").context("a named design")?;
    let missing = "guitar.ply is not at hand";
    let load = |view| guitar(&design, &Rules::GAUSSIAN_3D, view, SIZE)?.context(missing);
    let views = [load(GuitarView::Close)?, load(GuitarView::Whole)?];
    let rows = [1, 2, 4, QUEUE, 16, 32].map(PacketLayout::Rows);
    let tile_sizes = [[16, 16], [32, 16], [64, 32], [64, 64]];
    let cases = [
        PacketLayout::Unaligned,
        PacketLayout::Aligned,
        PacketLayout::Quads,
    ]
    .into_iter()
    .chain(rows)
    .map(|layout| (layout, TILE))
    .chain(tile_sizes.map(|size| (PacketLayout::Rows(QUEUE), size)));
    for (layout, size) in cases {
        let [close, whole] = [0, 1].map(|view: usize| utilisation(&views[view], layout, size));
        let line = format!(
            "| {} | {} x {} | {close:.3} | {whole:.3} |\n",
            layout.name(),
            size[0],
            size[1]
        );
        eprint!("{line}");
        text += &line;
    }
    Ok(text + FOOT)
}

const HEAD: &str = "# Arrangements of four lanes

This page is for architects who lay out pixel lanes. It says why each lane of the circuit owns rows of the tile, and is not one of a group of adjacent pixels.

Several lanes are worth their area only if they are busy. The table has covered pixels per cycle and lane; the bar is 0.9. It is printed by `cargo run --release -p splatline-rtl --example rtl -- layouts`: guitar, 512 x 512, rules 3dgs, lean18,
without early termination, as a close-up and whole.

";

const FOOT: &str = "
The circuit is the arrangement by rows, with queues of 8 runs and a tile of 32 x 32.

On the whole guitar it misses the bar, because splats are small. A splat has 6.4 rows of 5.0 pixels in a tile: 32 pixels, or 8 cycles of four lanes. Its box has 7.0 rows, at one row a cycle. So the row unit is nearly as busy as the lanes, and every
imbalance between them shows. Larger tiles cut fewer splats in two. Deeper queues smooth the imbalance, at 200 bits a run and lane.
";

impl PacketLayout {
    fn name(self) -> String {
        match self {
            PacketLayout::Unaligned => "groups of 4 from the run's start".to_owned(),
            PacketLayout::Aligned => "groups of 4 at multiples of 4".to_owned(),
            PacketLayout::Quads => "2 x 2 quads".to_owned(),
            PacketLayout::Rows(queue) => format!("a lane for each row modulo 4, queues of {queue}"),
        }
    }
}

fn utilisation(workload: &BenchWorkload, layout: PacketLayout, size: [u16; 2]) -> f64 {
    let tiles = tiles(&workload.footprints, [SIZE as u16; 2], size);
    let rules = kernel_rules(&Rules::GAUSSIAN_3D);
    let golden = Golden::new(Lean18, &rules);
    let (mut covered, mut cycles) = (0, 0);
    for tile in tiles.iter().filter(|tile| !tile.list.is_empty()) {
        covered += golden.draw(tile, &workload.footprints).1.covered;
        cycles += tile_cycles(tile, &workload.footprints, layout);
    }
    covered as f64 / (cycles as f64 * LANES as f64)
}

fn tile_cycles(tile: &BenchTile, footprints: &[Footprint], layout: PacketLayout) -> u64 {
    let drawn = tile.list.iter().map(|index| &footprints[*index as usize]);
    if let PacketLayout::Rows(queue) = layout {
        let mut clock = PrimitiveClock::new(LANES, queue);
        for footprint in drawn {
            clock.packet(0);
            for_each_slot(Lean18, footprint, &tile.window, LANES, |run| {
                clock.slot(run);
            });
        }
        return clock.idle_at();
    }
    let (mut slots, mut groups) = (0, 0);
    for footprint in drawn {
        let bounds = Window::of(footprint);
        let visible = bounds.intersect(&tile.window);
        slots += u64::from(visible.end[1] - visible.first[1]);
        groups += splat_groups(footprint, &tile.window, layout);
    }
    slots.max(groups) + LATENCY
}

/// Groups of pixels that a splat's runs take.
fn splat_groups(footprint: &Footprint, window: &Window, layout: PacketLayout) -> u64 {
    let mut rows = EllipseSpans::new(Lean18, footprint, window);
    let runs: Vec<(u16, u16, u16)> = std::iter::from_fn(|| rows.next_span())
        .map(|run| (run.y, run.x, run.x + run.length))
        .collect();
    match layout {
        PacketLayout::Unaligned => runs
            .iter()
            .map(|(_, x, end)| u64::from((end - x).div_ceil(4)))
            .sum(),
        PacketLayout::Aligned => runs
            .iter()
            .map(|(_, x, end)| u64::from(end.div_ceil(4) - x / 4))
            .sum(),
        PacketLayout::Quads | PacketLayout::Rows(_) => runs
            .chunk_by(|(a, ..), (b, ..)| a / 2 == b / 2)
            .map(|pair| {
                let first = pair.iter().map(|(_, x, _)| x / 2).min().unwrap_or(0);
                let last = pair
                    .iter()
                    .map(|(.., end)| end.div_ceil(2))
                    .max()
                    .unwrap_or(0);
                u64::from(last - first)
            })
            .sum(),
    }
}
