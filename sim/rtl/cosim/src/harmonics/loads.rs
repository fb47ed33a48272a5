//! What the harmonics unit is given: a scene's splats, random ones, and bits that round, clamp and wrap where others do
//! not.

use crate::scenes::scenes;
use crate::unit::{Loads, Missing};
use anyhow::{Context, Result};
use fixed::types::{I2F30, I4F28, U4F28};
use splatline::float::coefficient;
use splatline::format::{Lean18, Widths};
use splatline::setup::harmonics::{self, direction};
use splatline_sim::fixed::QuantisedScene;
use splatline_sim::rules::Rules;
use splatline_sim::scene::Harmonics;
use splatline_sim::scene::synthetic::Random;

/// A splat's direction and colours.
#[derive(Clone, Debug)]
pub struct HarmonicsSplat {
    pub direction: [I2F30; 3],
    /// As the port takes it: what is above 4 is 4.
    pub degree: u8,
    /// Its base, then as many coefficients as the degree has.
    pub colours: Vec<[I4F28; 3]>,
}

impl HarmonicsSplat {
    /// By bits of its direction, Q1.30, and of its colours, Q3.28.
    fn new(direction: [i32; 3], degree: u8, colours: Vec<[i32; 3]>) -> HarmonicsSplat {
        let colours = colours.into_iter();
        HarmonicsSplat {
            direction: direction.map(I2F30::from_bits),
            degree,
            colours: colours.map(|bits| bits.map(I4F28::from_bits)).collect(),
        }
    }

    /// The kernel's colour.
    pub fn colour(&self) -> [U4F28; 3] {
        let (base, coefficients) = (self.colours[0], &self.colours[1..]);
        harmonics::Harmonics { base, coefficients }.colour(self.direction)
    }
}

/// The harmonics of a scene, whose splats are these, in the kernel's directions.
pub fn of_scene(
    harmonics: &Harmonics,
    widths: &Widths,
    scene: &QuantisedScene,
) -> Vec<HarmonicsSplat> {
    let each = colours(harmonics.degree) - 1;
    let fixed = |colour: &[f32; 3]| colour.map(|channel| coefficient(channel.into()));
    let splats = scene.splats.iter().zip(&harmonics.base).enumerate();
    let splats = splats.map(|(number, (splat, base))| {
        let coefficients = harmonics.coefficients[number * each..][..each].iter();
        HarmonicsSplat {
            direction: direction(widths, &scene.view, &splat.centre),
            degree: harmonics.degree,
            colours: [base].into_iter().chain(coefficients).map(fixed).collect(),
        }
    });
    splats.collect()
}

/// A splat's base and coefficients of a degree as the port takes it.
fn colours(degree: u8) -> usize {
    (usize::from(degree.min(4)) + 1).pow(2)
}

/// 1.0 of a direction.
const ONE: i64 = 1 << 30;

/// Random numbers of a load.
struct LoadRandom(Random);

impl LoadRandom {
    fn below(&mut self, end: u64) -> u64 {
        (self.0.next() >> 11) % end
    }

    /// Within -1 and 1.
    fn number(&mut self) -> f64 {
        self.0.next() as i64 as f64 / 2f64.powi(63)
    }

    fn bits(&mut self) -> i32 {
        (self.0.next() >> 32) as i32
    }

    /// A unit vector.
    fn direction(&mut self) -> [i32; 3] {
        loop {
            let vector = [(); 3].map(|()| self.number());
            let square: f64 = vector.iter().map(|x| x * x).sum();
            if (1e-6..=1.0).contains(&square) {
                return unit(vector);
            }
        }
    }

    /// A coefficient as scenes have them.
    fn usual(&mut self) -> [i32; 3] {
        [(); 3].map(|()| (self.number().powi(3) * 2f64.powi(28)) as i32)
    }

    /// Ends of the format, powers of two and their neighbours, few bits, and any.
    fn hard(&mut self) -> i32 {
        let power = 1i32.wrapping_shl(self.below(32) as u32);
        match self.below(8) {
            0 => [0, 1, -1, i32::MAX, i32::MIN, i32::MIN + 1][self.below(6) as usize],
            1 => power,
            2 => power.wrapping_sub(1),
            3 => power.wrapping_neg(),
            4 => power.wrapping_neg().wrapping_sub(1),
            5 => self.bits() >> self.below(31),
            6 => ((self.bits() >> 24) | 1).wrapping_shl(self.below(24) as u32),
            _ => self.bits(),
        }
    }

    fn splat(&mut self, direction: [i32; 3], degree: u8, colour: Draw) -> HarmonicsSplat {
        let colours = (0..colours(degree)).map(|_| colour(self)).collect();
        HarmonicsSplat::new(direction, degree, colours)
    }

    /// A splat of any degree below an end.
    fn drawn(&mut self, direction: Draw, degrees: u64, colour: Draw) -> HarmonicsSplat {
        let (direction, degree) = (direction(self), self.below(degrees) as u8);
        self.splat(direction, degree, colour)
    }
}

/// A vector by a load's random numbers.
type Draw = fn(&mut LoadRandom) -> [i32; 3];

fn unit(vector: [f64; 3]) -> [i32; 3] {
    let length = vector.iter().map(|x| x * x).sum::<f64>().sqrt();
    vector.map(|x| (x / length * ONE as f64).round() as i32)
}

/// Unit directions and usual coefficients of one degree, for the cycles of each.
pub fn of_degree(count: usize, degree: u8) -> Vec<HarmonicsSplat> {
    let mut random = LoadRandom(Random(1));
    let splats = (0..count).map(|_| {
        let direction = random.direction();
        random.splat(direction, degree, LoadRandom::usual)
    });
    splats.collect()
}

/// All that is made of random numbers, `count` splats of each kind.
pub fn synthetic(count: usize) -> Loads<Vec<HarmonicsSplat>> {
    let hard: Draw = |random| [(); 3].map(|()| random.hard());
    let bits: Draw = |random| [(); 3].map(|()| random.bits());
    let cube: Draw = |random| [(); 3].map(|()| near_one(random));
    let (mut random, mut loads) = (LoadRandom(Random(1)), Loads::new());
    let mut load = |name: &str, make: &dyn Fn(&mut LoadRandom, usize) -> HarmonicsSplat| {
        let splats = (0..count).map(|index| make(&mut random, index));
        loads.push((name.to_owned(), splats.collect()));
    };
    load("unit directions", &|random, _| {
        random.drawn(LoadRandom::direction, 5, LoadRandom::usual)
    });
    load("axes, corners, few bits", &|random, _| {
        random.drawn(cube, 5, hard)
    });
    load("harmonics one by one", &|random, index| {
        one_harmonic(cube(random), index % 24)
    });
    load("halves subtracted", &|random, _| {
        one_harmonic(halves(random), 23)
    });
    load("arbitrary words", &|random, _| random.drawn(hard, 8, hard));
    load("arbitrary bits", &|random, _| random.drawn(bits, 8, bits));
    load("colours near 0 and 16", &|random, _| near_the_ends(random));
    load("products at the ends of 64 bits", &|_, index| {
        one_harmonic(WRAPPING[index % WRAPPING.len()], 19)
    });
    loads
}

/// 1, 0, their neighbours, and numbers of few bits, whose products are halves: corners of the cube are far from any
/// unit vector.
fn near_one(random: &mut LoadRandom) -> i32 {
    let sign = 1 - 2 * random.below(2) as i64;
    let value = match random.below(10) {
        0 => 0,
        1..=3 => ONE + random.below(3) as i64 - 1,
        4 => random.below(3) as i64,
        5 => (2 * random.below(1 << 14) as i64 + 1) << 15,
        6 => (2 * random.below(1 << 15) as i64 + 1) << 14,
        7 => 1 << (22 + random.below(9)),
        8 => random.below(ONE as u64) as i64,
        _ => ((2 * random.below(8) as i64 + 1) << random.below(28)).min(ONE),
    };
    (sign * value) as i32
}

/// y is 1/2, so that yy (3 xx - yy) is a half of the last bit in one of four cases: the kernel subtracts it after its
/// rounding.
fn halves(random: &mut LoadRandom) -> [i32; 3] {
    let x = random.below(ONE as u64) as i32;
    [x, 1 << 29, near_one(random)]
}

/// A colour that shows all of one harmonic's bits: the first channel the lowest, the others those above, also of
/// negative ones.
fn one_harmonic(direction: [i32; 3], which: usize) -> HarmonicsSplat {
    let mut colours = vec![[0; 3]; 25];
    colours[0] = [4 << 28; 3];
    colours[1 + which] = [1 << 28, 1 << 30, -(1 << 28)];
    HarmonicsSplat::new(direction, 4, colours)
}

/// A splat whose colours are within a unit of 0 or of 16, or have no bit but the one that rounding to odd leaves.
fn near_the_ends(random: &mut LoadRandom) -> HarmonicsSplat {
    let (direction, degree) = (random.direction(), random.below(5) as u8);
    let ends = [0, 1, -1, i32::MAX, i32::MAX - 1];
    let base = [(); 3].map(|()| ends[random.below(5) as usize]);
    let mut small = || [(); 3].map(|()| (random.hard() >> 16) >> random.below(16));
    let mut colours: Vec<[i32; 3]> = (1..colours(degree)).map(|_| small()).collect();
    if degree > 0 && random.below(2) == 0 {
        // Two large ones in the same direction: from 8 to 16 and above.
        colours[random.below(3) as usize] = [(); 3].map(|()| random.hard());
    }
    colours.insert(0, base);
    HarmonicsSplat::new(direction, degree, colours)
}

/// Directions for which a product of the kernel's polynomial of degree 4 and order 0 is so near below an odd multiple
/// of 2^63 that its rounding leaves 64 bits: (5 zz - 30 s) zz = -2^63 - a little, for the rounded s = xx + yy that is
/// nearest.
const WRAPPING: [[i32; 3]; 6] = [
    [4_522_707, 773_855_139, 864_464_815],
    [495_782_127, 545_971_964, 948_605_561],
    [521_280_113, 573_312_162, 862_561_705],
    [93_388_246, 792_913_185, 821_777_491],
    [233_563_961, 704_703_798, 935_003_196],
    [446_326_359, 576_139_655, 975_374_862],
];

/// Every `step`-th splat of the scene with harmonics in the kernel's directions from its camera.
pub fn captured(step: usize, missing: &mut Missing) -> Result<Loads<Vec<HarmonicsSplat>>> {
    let mut loads = Vec::new();
    for mut seen in scenes(&["playbot"], 480, missing)? {
        let harmonics = seen.scene.harmonics.take();
        let harmonics = harmonics.context("a scene without harmonics")?;
        let quantised = QuantisedScene::new(&seen.scene, &seen.camera, &Rules::EWA);
        let splats = of_scene(&harmonics, &Lean18::WIDTHS, &quantised).into_iter();
        let name = format!("{}, degree {}", seen.name, harmonics.degree);
        loads.push((name, splats.step_by(step).collect()));
    }
    Ok(loads)
}
