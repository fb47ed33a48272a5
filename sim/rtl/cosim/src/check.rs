//! Circuit and kernel side by side: every tile-buffer word, every cycle.

use crate::bench::{Bench, Pauses};
use crate::golden::Golden;
use crate::stamps::{Distances, STAGES};
use crate::units;
use crate::workload::{BenchTile, BenchWorkload};
use splatline::blend::Pixel;
use splatline::format::Design;
use splatline::rules::Rules;
use std::ops::AddAssign;

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
    /// Roots of the row unit compared with the kernel's.
    pub roots: u64,
    /// Pairs of a splat and a tile whose handshakes were compared with the model's clock: where the lanes never paused.
    pub timed: u64,
    /// Of these, pairs with a handshake in another cycle.
    pub wrong_cycles: u64,
    /// How many cycles model and circuit are apart, by stage of [`STAGES`].
    pub distances: [Distances; STAGES.len()],
    /// Cycles of the raster unit, where nothing paused.
    pub raster_cycles: u64,
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
        self.roots += other.roots;
        self.timed += other.timed;
        self.wrong_cycles += other.wrong_cycles;
        self.add_distances(&other.distances);
        self.raster_cycles += other.raster_cycles;
        if self.first_difference.is_none() {
            self.first_difference = other.first_difference;
        }
    }
}

impl Findings {
    fn add_distances(&mut self, others: &[Distances; STAGES.len()]) {
        for (own, other) in self.distances.iter_mut().zip(others) {
            own.add(other);
        }
    }

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
    workload: &BenchWorkload,
    tiles: impl IntoIterator<Item = usize>,
    pauses: Pauses,
) -> Findings {
    let mut findings = Findings::default();
    let golden = Golden::new(design, rules);
    findings.first_difference = units::first_difference(bench, design.widths().mantissa);
    if findings.first_difference.is_some() {
        return findings;
    }
    for index in tiles {
        let tile = &workload.tiles[index];
        let (expected, coverage) = golden.draw(tile, &workload.footprints);
        findings.tiles += 1;
        findings.splats += tile.list.len() as u64;
        findings.visited += coverage.visited;
        findings.covered += coverage.covered;
        let place = format!("{}, tile {index}", workload.name);
        let drawn = bench.draw(tile, &workload.footprints, pauses);
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
        difference = difference.or(got.roots.first_difference);
        difference = difference.or(got.broken);
        findings.roots += got.roots.compared;
        if pauses.lanes == 0 {
            let timed = got.stamps.compare(design, lanes, tile, workload);
            findings.timed += timed.splats;
            findings.wrong_cycles += timed.wrong;
            findings.add_distances(&timed.distances);
            difference = difference.or(timed.first_difference);
        }
        if pauses == Pauses::default() {
            findings.raster_cycles += got.stamps.raster_cycles();
        }
        if let Some(difference) = difference {
            findings.first_difference = Some(format!("{place}: {difference}"));
            return findings;
        }
    }
    findings
}

fn difference(tile: &BenchTile, got: &[Pixel], expected: &[Pixel]) -> Option<String> {
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
