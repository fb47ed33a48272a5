//! Circuit and kernel side by side: every tile-buffer word, every cycle.

use crate::bench::{Bench, Outcome, Pauses};
use crate::clock::RasterClock;
use crate::golden;
use crate::workload::{Tile, Workload};
use splatline::blend::Pixel;
use splatline::format::Design;
use splatline::rules::Rules;
use std::ops::AddAssign;
use std::time::{Duration, Instant};

/// What a comparison found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Findings {
    /// Tiles drawn.
    pub tiles: u64,
    /// Pairs of a splat and a tile.
    pub splats: u64,
    /// Pixels at which a radial index was computed.
    pub visited: u64,
    /// Of these, pixels inside a footprint.
    pub covered: u64,
    /// Tile-buffer pixels (four words each) that differ from the kernel's.
    pub mismatches: u64,
    /// Tiles whose cycles differ from the closed form's, where nothing paused.
    pub wrong_cycles: u64,
    /// Cycles of the raster unit, where nothing paused.
    pub raster_cycles: u64,
    /// Time that the kernel and the closed form of the cycles took.
    pub kernel_time: Duration,
    /// Time that the verilated circuit took for the same.
    pub circuit_time: Duration,
    /// The first difference, in words.
    pub first_difference: Option<String>,
}

impl AddAssign for Findings {
    fn add_assign(&mut self, other: Findings) {
        self.tiles += other.tiles;
        self.splats += other.splats;
        self.visited += other.visited;
        self.covered += other.covered;
        self.mismatches += other.mismatches;
        self.wrong_cycles += other.wrong_cycles;
        self.raster_cycles += other.raster_cycles;
        self.kernel_time += other.kernel_time;
        self.circuit_time += other.circuit_time;
        if self.first_difference.is_none() {
            self.first_difference = other.first_difference;
        }
    }
}

impl Findings {
    /// Did nothing differ?
    pub fn agree(&self) -> bool {
        self.mismatches == 0 && self.wrong_cycles == 0 && self.first_difference.is_none()
    }
}

/// Draws tiles of a workload by both and compares them; stops at the first tile that differs.
pub fn compare<D: Design>(
    bench: &mut Bench,
    design: D,
    lanes: usize,
    rules: &Rules,
    workload: &Workload,
    tiles: impl IntoIterator<Item = usize>,
    pauses: Pauses,
) -> Findings {
    let mut findings = Findings::default();
    for index in tiles {
        let tile = &workload.tiles[index];
        let started = Instant::now();
        let (expected, coverage) = golden::draw(design, rules, tile, &workload.footprints);
        let cycles = closed_form(design, lanes, tile, workload);
        findings.kernel_time += started.elapsed();
        findings.tiles += 1;
        findings.splats += tile.list.len() as u64;
        findings.visited += coverage.visited;
        findings.covered += coverage.covered;
        let place = format!("{}, tile {index}", workload.name);
        let started = Instant::now();
        let drawn = bench.draw(tile, &workload.footprints, pauses);
        findings.circuit_time += started.elapsed();
        let got = match drawn {
            Ok(got) => got,
            Err(message) => {
                findings.mismatches += expected.len() as u64;
                findings.first_difference = Some(format!("{place}: {message}"));
                return findings;
            }
        };
        findings.mismatches += got
            .pixels
            .iter()
            .zip(&expected)
            .filter(|(got, expected)| got != expected)
            .count() as u64;
        let mut difference = difference(tile, &got.pixels, &expected);
        if pauses == Pauses::default() {
            findings.raster_cycles += got.raster_cycles;
            let wrong = wrong_cycles(tile, cycles, &got);
            findings.wrong_cycles += u64::from(wrong.is_some());
            difference = difference.or(wrong);
        }
        if let Some(difference) = difference {
            findings.first_difference = Some(format!("{place}: {difference}"));
            return findings;
        }
    }
    findings
}

fn difference(tile: &Tile, got: &[Pixel], expected: &[Pixel]) -> Option<String> {
    let at = got
        .iter()
        .zip(expected)
        .position(|(got, expected)| got != expected)?;
    let [columns, _] = tile.size();
    let (x, y) = (
        usize::from(tile.window.first[0]) + at % columns,
        usize::from(tile.window.first[1]) + at / columns,
    );
    Some(format!(
        "pixel ({x}, {y}): the kernel has {:x?}, the circuit {:x?}",
        expected[at], got[at]
    ))
}

fn closed_form<D: Design>(design: D, lanes: usize, tile: &Tile, workload: &Workload) -> u64 {
    if tile.list.is_empty() {
        return 0;
    }
    let mut clock = RasterClock::new(lanes);
    for index in &tile.list {
        clock.splat(design, &workload.footprints[*index as usize], &tile.window);
    }
    clock.cycles()
}

fn wrong_cycles(tile: &Tile, expected: u64, got: &Outcome) -> Option<String> {
    let (splats, taken) = (tile.list.len(), got.raster_cycles);
    (expected != taken).then(|| {
        format!("{splats} splats: the closed form says {expected} cycles, the circuit took {taken}")
    })
}
