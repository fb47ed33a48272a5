//! The built-in subject: random splats, every other one a hard case.

use fixed::types::{I2F30, I32F32, U4F28};
use splatline::math::{Extended, SoftFloat};
use splatline::splat::{Axis, VolumeSplat};
use splatline::view::{Eye, Projection, RatioLimits, View};

/// A linear congruential generator, so that anyone can make the same splats.
struct BuiltinRandom(u32);

impl BuiltinRandom {
    fn bits(&mut self) -> u32 {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        self.0
    }
}

/// `count` splats before a camera of `size` pixels: in turn ordinary, needle, disc, huge, tiny, at the eye, beside the picture,
/// saturated and almost transparent.
pub fn hard_cases(count: usize, size: [u16; 2], seed: u32) -> (View, Vec<VolumeSplat>) {
    let mut random = BuiltinRandom(seed);
    let splats = (0..count).map(|index| splat(&mut random, index)).collect();
    (view(size), splats)
}

fn splat(random: &mut BuiltinRandom, index: usize) -> VolumeSplat {
    let mut centre = [(); 3].map(|()| ((random.bits() >> 8) as i32 - (1 << 23)) * 4);
    // Powers of two by which the axes are smaller than about a third of a unit, and the colour and opacity's sizes.
    let (mut thin, mut opacity, mut bright) = ([0, 0, 0], -30, 0);
    if index % 2 == 1 {
        match (index / 2) % 8 {
            0 => thin = [0, 8, 12],
            1 => thin = [0, 0, 14],
            2 => thin = [-5, -5, -5],
            3 => thin = [10, 10, 10],
            4 => centre[2] = (-4 << 24) + (random.bits() >> 9) as i32,
            5 => centre[0] *= 3,
            6 => (opacity, bright) = (-27, 4),
            _ => opacity = -36,
        }
    }
    let axes = thin.map(|power| Axis {
        mantissa: [(); 3].map(|()| (random.bits() >> 1) as i32 - (1 << 30)),
        exponent: -32 - power,
    });
    VolumeSplat {
        centre: centre.map(|mantissa| SoftFloat {
            mantissa,
            exponent: -24,
        }),
        axes,
        weight: SoftFloat {
            mantissa: (random.bits() >> 2) as i32,
            exponent: opacity,
        },
        colour: [(); 3].map(|()| U4F28::from_bits(random.bits() >> (4 - bright))),
    }
}

/// Turned by 36.87 degrees about the vertical (3-4-5), 4 units away, 53 degrees wide.
fn view(size: [u16; 2]) -> View {
    let entry = |value: f64| I2F30::from_num(value);
    let (zero, one, sine, cosine) = (I2F30::ZERO, I2F30::ONE, entry(0.6), entry(0.8));
    let focal = SoftFloat::from_wide(size[0].into(), 0, 31);
    let half = size.map(|side| I32F32::from_num(side) / 2);
    let limit = |axis: usize| {
        half[axis].saturating_mul(I32F32::from_num(1.3)) / I32F32::from_num(size[0].max(1))
    };
    View {
        rotation: [
            [cosine, zero, -sine],
            [zero, one, zero],
            [sine, zero, cosine],
        ],
        // t = W u + d with d = (0, 0, 4): e = -W^T d.
        pose: Eye {
            position: [-24, 0, -32],
            exponent: -3,
            rotation_rest: [[0; 3]; 3],
        },
        focal: [focal; 2],
        principal: half,
        near: Extended {
            value: 1,
            exponent: -6,
        },
        far: Extended {
            value: 200,
            exponent: 0,
        },
        viewport: size,
        projection: Projection::Perspective,
        limits: RatioLimits {
            low: [-limit(0), -limit(1)],
            high: [limit(0), limit(1)],
        },
    }
}
