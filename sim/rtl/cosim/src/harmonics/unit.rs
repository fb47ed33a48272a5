//! The harmonics unit against the kernel: every colour, with random pauses at all three ends and resets in between.

use super::loads::{HarmonicsLoad, HarmonicsSplat, captured, of_degree, synthetic};
use crate::bench::{Bench, Channel, Channels, Checker, Item, Offer, Pressure};
use crate::circuit::{Circuit, Effort, HARMONICS};
use crate::findings::Findings;
use crate::simulation::Simulation;
use crate::unit::{Extent, Unit};
use anyhow::Result;
use fixed::types::{I2F30, I4F28};
use splatline::setup::harmonics::Harmonics;

/// Numbers of multipliers for which there is a circuit.
pub const MULTIPLIERS: [u32; 2] = [1, 2];

/// At full speed; with every end as the slowest; with resets.
const PRESSURES: [Pressure; 6] = [
    pressure([0, 0, 0], 0, 0),
    pressure([96, 96, 96], 0, 0),
    pressure([0, 192, 0], 0, 0),
    pressure([224, 0, 0], 0, 0),
    pressure([0, 0, 0], 0, 501),
    pressure([64, 32, 192], 400, 701),
];

const fn pressure([splats, words, colours]: [u8; 3], stalls: u64, resets: u64) -> Pressure {
    Pressure {
        offers: [splats, words],
        answers: colours,
        inside: 0,
        stalls,
        resets,
        retracts: true,
    }
}

/// The unit with some multipliers.
pub struct HarmonicsUnit {
    circuit: Circuit,
}

impl HarmonicsUnit {
    /// With so many multipliers.
    pub fn new(multipliers: u32) -> Result<HarmonicsUnit> {
        let circuit = Circuit::new(&HARMONICS, "lean18", multipliers)?;
        Ok(HarmonicsUnit { circuit })
    }

    /// Prints the cycles that a splat of each degree takes at full speed.
    pub fn print_cycles(&self) -> Result<()> {
        const TIMED: usize = 2_000;
        let library = self.circuit.library(Effort::Much)?;
        println!("| cycles a splat | degree 0 | 1 | 2 | 3 | 4 |\n|---|---:|---:|---:|---:|---:|");
        print!("| {} |", self.circuit);
        for degree in 0..=4 {
            let load = of_degree(TIMED, degree, 1);
            let found = self.compare(Simulation::new(&library, 1, 0)?, &load, 0)?;
            print!(" {:.1} |", found.cycles as f64 / TIMED as f64);
        }
        println!();
        Ok(())
    }
}

/// Splats of one part of a load.
const PART: usize = 1_000;

impl Unit for HarmonicsUnit {
    type Load = HarmonicsLoad;
    const COUNTS: &'static [&'static str] = &["resets"];
    const PRESSURES: usize = PRESSURES.len();

    fn circuit(&self) -> &Circuit {
        &self.circuit
    }

    fn loads(&self, extent: Extent, missing: &mut Vec<&'static str>) -> Result<Vec<HarmonicsLoad>> {
        let (count, step) = match extent {
            Extent::Quick => (240, 100),
            Extent::Full => (12_000, 1),
        };
        let mut loads = synthetic(count, 1);
        match captured(step)? {
            Some(load) => loads.push(load),
            None => missing.push("playbot"),
        }
        let parts = |load: HarmonicsLoad| {
            let part = |splats: &[HarmonicsSplat]| HarmonicsLoad {
                name: load.name.clone(),
                splats: splats.to_vec(),
            };
            load.splats.chunks(PART).map(part).collect::<Vec<_>>()
        };
        Ok(loads.into_iter().flat_map(parts).collect())
    }

    fn name(&self, load: &HarmonicsLoad) -> String {
        load.name.clone()
    }

    fn compare(
        &self,
        circuit: Simulation,
        load: &HarmonicsLoad,
        pressure: usize,
    ) -> Result<Findings> {
        let mut bench = Bench::new(circuit, 1)?;
        let channels = Channels {
            sources: vec![
                Channel::new(&bench.circuit, "splat", &["direction", "degree"])?,
                Channel::new(&bench.circuit, "word", &["word"])?,
            ],
            sink: Channel::new(&bench.circuit, "colour", &["colour"])?,
            enable: None,
        };
        let items: Vec<Item> = load.splats.iter().map(item).collect();
        let mut checker = HarmonicsChecker(&load.splats);
        bench.run(&channels, &items, &PRESSURES[pressure], &mut checker)
    }
}

/// The splat in one lane, its words in the other.
fn item(splat: &HarmonicsSplat) -> Item {
    let bits = |vector: &[i32; 3]| vector.map(|axis| axis as u32).to_vec();
    let splat_offer = Offer {
        source: 0,
        data: vec![bits(&splat.direction), vec![splat.degree.into()]],
    };
    let words = [&splat.base].into_iter().chain(&splat.coefficients);
    let words = words.map(|word| Offer {
        source: 1,
        data: vec![bits(word)],
    });
    Item {
        lanes: vec![vec![splat_offer], words.collect()],
        answers: 1,
    }
}

struct HarmonicsChecker<'a>(&'a [HarmonicsSplat]);

impl Checker for HarmonicsChecker<'_> {
    fn check(&mut self, number: usize, answer: &[Vec<u32>]) -> Option<String> {
        let splat = &self.0[number];
        let (got, wanted) = (&answer[0], colour(splat));
        let degree = splat.degree;
        (got[..] != wanted)
            .then(|| format!("splat {number}, degree {degree}: {got:08x?}, not {wanted:08x?}"))
    }
}

/// The kernel's colour.
fn colour(splat: &HarmonicsSplat) -> [u32; 3] {
    let fixed = |coefficient: &[i32; 3]| coefficient.map(I4F28::from_bits);
    let list: Vec<[I4F28; 3]> = splat.coefficients.iter().map(fixed).collect();
    let harmonics = Harmonics {
        base: fixed(&splat.base),
        coefficients: &list,
    };
    let direction = splat.direction.map(I2F30::from_bits);
    harmonics.colour(direction).map(|channel| channel.to_bits())
}
