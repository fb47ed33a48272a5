//! Splats through the harmonics unit, with random pauses at all three ends and resets in between, every colour against the kernel's.

use super::model::{HarmonicsInputs, HarmonicsModel};
use crate::workload::split_mix;
use anyhow::{Result, ensure};
use fixed::types::{I2F30, I4F28};
use splatline::setup::harmonics::Harmonics;

/// A splat's direction and colours, as bits.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct HarmonicsSplat {
    /// Q1.30.
    pub direction: [i32; 3],
    /// As the port takes it: what is above 4 is 4.
    pub degree: u8,
    /// Q3.28.
    pub base: [i32; 3],
    /// Q3.28, as many as the degree has.
    pub coefficients: Vec<[i32; 3]>,
}

/// Splats of one kind.
#[derive(Clone, Debug)]
pub struct HarmonicsLoad {
    /// What they are.
    pub name: String,
    /// The splats.
    pub splats: Vec<HarmonicsSplat>,
}

/// How the unit is fed and emptied.
#[derive(Clone, Copy, Debug, Default)]
pub struct HarmonicsPauses {
    /// How many of 8 cycles, at random, hold a splat, a word or a colour back.
    pub of_eight: [u64; 3],
    /// One reset in so many cycles, at random; 0 for none.
    pub resets: u64,
}

/// At full speed; with every end as the slowest; with resets.
pub const PAUSES: [HarmonicsPauses; 6] = [
    HarmonicsPauses {
        of_eight: [0, 0, 0],
        resets: 0,
    },
    HarmonicsPauses {
        of_eight: [3, 3, 3],
        resets: 0,
    },
    HarmonicsPauses {
        of_eight: [0, 6, 0],
        resets: 0,
    },
    HarmonicsPauses {
        of_eight: [7, 0, 0],
        resets: 0,
    },
    HarmonicsPauses {
        of_eight: [0, 0, 0],
        resets: 501,
    },
    HarmonicsPauses {
        of_eight: [2, 1, 6],
        resets: 701,
    },
];

/// A colour waits for so many cycles in one of the passes: longer than a splat takes.
const LONG: u64 = 400;

/// What came of it.
#[derive(Clone, Debug, Default)]
pub struct HarmonicsFindings {
    /// Splats whose colour was compared.
    pub splats: u64,
    /// Of them with another colour than the kernel's.
    pub mismatches: u64,
    /// The first of those.
    pub first_difference: Option<String>,
    /// Cycles.
    pub cycles: u64,
    /// Resets in between.
    pub resets: u64,
}

impl HarmonicsFindings {
    /// Both together.
    pub fn and(&self, other: &HarmonicsFindings) -> HarmonicsFindings {
        let first = self.first_difference.as_ref();
        HarmonicsFindings {
            splats: self.splats + other.splats,
            mismatches: self.mismatches + other.mismatches,
            first_difference: first.or(other.first_difference.as_ref()).cloned(),
            cycles: self.cycles + other.cycles,
            resets: self.resets + other.resets,
        }
    }
}

/// Coefficients of a degree as the port takes it.
pub fn coefficients(degree: u8) -> usize {
    (usize::from(degree.min(4)) + 1).pow(2) - 1
}

impl HarmonicsSplat {
    /// The kernel's colour.
    pub fn colour(&self) -> [u32; 3] {
        let list: Vec<[I4F28; 3]> = self
            .coefficients
            .iter()
            .map(|coefficient| coefficient.map(I4F28::from_bits))
            .collect();
        let harmonics = Harmonics {
            base: self.base.map(I4F28::from_bits),
            coefficients: &list,
        };
        let direction = self.direction.map(I2F30::from_bits);
        harmonics.colour(direction).map(|channel| channel.to_bits())
    }

    /// Its words in their order.
    fn word(&self, index: usize) -> [i32; 3] {
        match index.checked_sub(1) {
            None => self.base,
            Some(index) => self.coefficients[index],
        }
    }
}

/// Cycles without a colour after which the unit counts as hanging.
const PATIENCE: u64 = 20_000;

/// Where the feeder is.
struct Feeder<'a> {
    splats: &'a [HarmonicsSplat],
    /// The next splat to be offered.
    offered: usize,
    /// The next word: of which splat, and which.
    word: [usize; 2],
    random: u64,
}

impl Feeder<'_> {
    fn inputs(&mut self, pauses: &HarmonicsPauses, cycle: u64) -> HarmonicsInputs {
        let held = split_mix(&mut self.random);
        let goes = |end: usize| (held >> (8 * end)) % 8 >= pauses.of_eight[end];
        // What is not offered is noise.
        let mut noise = || [(); 3].map(|()| split_mix(&mut self.random) as i32);
        let (mut direction, mut word) = (noise(), noise());
        let mut degree = held as u8 >> 3;
        let splat = self.splats.get(self.offered).filter(|_| goes(0));
        if let Some(splat) = splat {
            (direction, degree) = (splat.direction, splat.degree);
        }
        let source = self.splats.get(self.word[0]).filter(|_| goes(1));
        if let Some(source) = source {
            word = source.word(self.word[1]);
        }
        let waits = pauses.of_eight[2] > 4 && cycle % (3 * LONG) < LONG;
        HarmonicsInputs {
            rst: (pauses.resets > 0 && (held >> 32).is_multiple_of(pauses.resets)).into(),
            splat_valid: splat.is_some().into(),
            degree: degree & 7,
            word_valid: source.is_some().into(),
            colour_ready: (goes(2) && !waits).into(),
            direction,
            word,
            ..HarmonicsInputs::default()
        }
    }

    fn word_taken(&mut self) {
        let [splat, index] = &mut self.word;
        *index += 1;
        if *index > self.splats[*splat].coefficients.len() {
            (*splat, *index) = (*splat + 1, 0);
        }
    }
}

/// Gives `load` to the circuit. After a reset it begins anew with the first splat whose colour has not come.
pub fn run(
    model: &mut HarmonicsModel,
    load: &HarmonicsLoad,
    pauses: &HarmonicsPauses,
    seed: u64,
) -> Result<HarmonicsFindings> {
    let mut findings = HarmonicsFindings::default();
    let mut feeder = Feeder {
        splats: &load.splats,
        offered: 0,
        word: [0, 0],
        random: seed,
    };
    let mut last = 0;
    while findings.splats < load.splats.len() as u64 {
        let inputs = feeder.inputs(pauses, findings.cycles);
        let out = model.tick(&inputs);
        findings.cycles += 1;
        ensure!(
            findings.cycles - last < PATIENCE,
            "{}: the harmonics unit hangs after {} splats",
            load.name,
            findings.splats
        );
        let done = findings.splats as usize;
        if inputs.rst == 1 {
            findings.resets += 1;
            (feeder.offered, feeder.word) = (done, [done, 0]);
            continue;
        }
        feeder.offered += usize::from(inputs.splat_valid & out.splat_ready);
        if inputs.word_valid & out.word_ready == 1 {
            feeder.word_taken();
        }
        if inputs.colour_ready & out.colour_valid == 1 {
            compare(&mut findings, &load.splats[done], out.colour);
            last = findings.cycles;
        }
    }
    // Nothing may come behind the last.
    let quiet = HarmonicsInputs {
        colour_ready: 1,
        ..HarmonicsInputs::default()
    };
    for _ in 0..LONG {
        let more = model.tick(&quiet).colour_valid == 1;
        ensure!(!more, "{}: a colour too many", load.name);
    }
    Ok(findings)
}

fn compare(findings: &mut HarmonicsFindings, splat: &HarmonicsSplat, got: [u32; 3]) {
    let wanted = splat.colour();
    let index = findings.splats;
    findings.splats += 1;
    if got == wanted {
        return;
    }
    findings.mismatches += 1;
    if findings.first_difference.is_none() {
        let degree = splat.degree;
        findings.first_difference = Some(format!(
            "splat {index}, degree {degree}: {got:08x?}, not {wanted:08x?}"
        ));
    }
}
