//! The harmonics unit against the kernel: every colour, with random pauses at all three ends and resets in between.

use super::loads::{HarmonicsSplat, captured, of_degree, synthetic};
use crate::bench::{Bench, Channels, Item, Pressure};
use crate::unit::{Circuit, Extent, Findings, Load, Loads, Missing};
use anyhow::Result;
use fixed::types::I4F28;

/// Numbers of multipliers for which there is a circuit.
pub const MULTIPLIERS: [u32; 2] = [1, 2];

/// At full speed; with every end as the slowest, of splats, of words and of colours; with resets.
const PRESSURES: [Pressure; 6] = [
    Pressure::new([0, 0, 0], 0, 0),
    Pressure::new([96, 96, 96], 0, 0),
    Pressure::new([0, 192, 0], 0, 0),
    Pressure::new([224, 0, 0], 0, 0),
    Pressure::new([0, 0, 0], 0, 501),
    Pressure::new([64, 32, 192], 400, 701),
];

/// Prints the cycles that a splat of each degree takes at full speed.
pub fn print_cycles(circuit: &Circuit) -> Result<()> {
    const TIMED: usize = 2_000;
    let library = circuit.library(Extent::Full)?;
    println!("| cycles a splat | degree 0 | 1 | 2 | 3 | 4 |\n|---|---:|---:|---:|---:|---:|");
    print!("| {circuit} |");
    for degree in 0..=4 {
        let load = of_degree(TIMED, degree);
        let found = load.compare(circuit, Bench::new(&library, 1, 0)?, 0)?;
        print!(" {:.1} |", found.cycles as f64 / TIMED as f64);
    }
    println!();
    Ok(())
}

/// Splats of one part of a load.
const PART: usize = 1_000;

/// What the unit is given.
pub type HarmonicsLoad = Vec<HarmonicsSplat>;

impl Load for HarmonicsLoad {
    const WAYS: usize = PRESSURES.len();

    fn all(_: &Circuit, extent: Extent, missing: &mut Missing) -> Result<Loads<HarmonicsLoad>> {
        let (count, step) = extent.of((240, 100), (12_000, 1));
        let loads = [synthetic(count), captured(step, missing)?].concat();
        let parts = loads.iter().flat_map(|(name, splats)| {
            let parts = splats.chunks(PART);
            parts.map(|part| (name.clone(), part.to_vec()))
        });
        Ok(parts.collect())
    }

    fn compare(&self, _: &Circuit, mut bench: Bench, pressure: usize) -> Result<Findings> {
        let sources: [(_, &[_]); 2] = [("splat", &["direction", "degree"]), ("word", &["word"])];
        let channels = Channels::new(&bench.circuit, &sources, ("colour", &["colour"]));
        let items: Vec<Item> = self.iter().map(item).collect();
        let check = |number: usize, answer: &[Vec<u32>]| {
            let (splat, got) = (&self[number], &answer[0]);
            let wanted = splat.colour().map(|channel| channel.to_bits());
            let degree = splat.degree;
            (got[..] != wanted)
                .then(|| format!("splat {number}, degree {degree}: {got:08x?}, not {wanted:08x?}"))
        };
        let pressure = &PRESSURES[pressure];
        let mut findings = bench.run(&channels, &items, pressure, check, |_, _, _| None)?;
        // A column of the report, also where there are none.
        findings.count("resets", 0);
        Ok(findings)
    }
}

/// The splat in one lane, its words in the other.
fn item(splat: &HarmonicsSplat) -> Item {
    let direction = splat.direction.map(|axis| axis.to_bits() as u32);
    let first = vec![direction.to_vec(), vec![splat.degree.into()]];
    let bits = |colour: &[I4F28; 3]| colour.map(|channel| channel.to_bits() as u32).to_vec();
    let words = splat.colours.iter().map(|colour| (1, vec![bits(colour)]));
    Item {
        lanes: vec![vec![(0, first)], words.collect()],
        answers: 1,
    }
}
