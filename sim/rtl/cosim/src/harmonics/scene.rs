//! The harmonics of a scene's splats in memory, and the kernel's colours of them.

use crate::random::Random;
use fixed::types::{I2F30, I4F28, U4F28};
use splatline::float::coefficient;
use splatline::format::Widths;
use splatline::setup::harmonics::{Harmonics, direction};
use splatline::splat::VolumeSplat;
use splatline::view::View;
use splatline_sim::scene;
use std::slice::Chunks;

/// Base and coefficients of every splat, Q3.28.
pub struct SceneHarmonics {
    /// Their degree, 0 to 4.
    pub degree: u8,
    colours: Vec<[I4F28; 3]>,
}

impl SceneHarmonics {
    /// Of a scene.
    pub fn new(harmonics: &scene::Harmonics) -> SceneHarmonics {
        let each = words(harmonics.degree) - 1;
        let fixed = |colour: &[f32; 3]| colour.map(|channel| coefficient(channel.into()));
        let of_splat = |(number, base)| {
            let coefficients = harmonics.coefficients[number * each..][..each].iter();
            [base].into_iter().chain(coefficients).map(fixed)
        };
        let splats = harmonics.base.iter().enumerate();
        SceneHarmonics {
            degree: harmonics.degree,
            colours: splats.flat_map(of_splat).collect(),
        }
    }

    /// Bytes of a splat.
    pub fn bytes(&self) -> u32 {
        16 * words(self.degree) as u32
    }

    /// The words that the machine reads; the last quarter of each is anything.
    pub fn words(&self) -> impl Iterator<Item = [u32; 4]> {
        let mut random = Random(7);
        self.colours.iter().map(move |colour| {
            let [red, green, blue] = colour.map(|channel| channel.to_bits() as u32);
            [red, green, blue, random.next() as u32]
        })
    }

    /// Gives splats the colours in which the kernel sees them.
    pub fn shine(&self, widths: &Widths, view: &View, splats: &mut [VolumeSplat]) {
        for (splat, colours) in splats.iter_mut().zip(self.splats()) {
            splat.colour = colour(colours, direction(widths, view, &splat.centre));
        }
    }

    /// Base and coefficients of each splat.
    pub fn splats(&self) -> Chunks<'_, [I4F28; 3]> {
        self.colours.chunks(words(self.degree))
    }
}

/// The kernel's colour by a base and coefficients.
pub fn colour(colours: &[[I4F28; 3]], direction: [I2F30; 3]) -> [U4F28; 3] {
    let (base, coefficients) = (colours[0], &colours[1..]);
    Harmonics { base, coefficients }.colour(direction)
}

/// Words of a splat: its base and its coefficients.
fn words(degree: u8) -> usize {
    (usize::from(degree) + 1).pow(2)
}
