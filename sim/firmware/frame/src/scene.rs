//! The scenes: 200, 1000 and 3000 splats of a linear congruential generator in 24 bytes each, evaluated at compile
//! time, and a camera.
//!
//! Splats become smaller as they become more, so that about 2.6 of them cover a pixel in each scene.

use fixed::types::{I2F30, I32F32};
use splatline::front::{CompactScene, CompactSplat};
use splatline::math::{Extended, SoftFloat};
use splatline::view::{Eye, Projection, RatioLimits, View};

/// Columns and rows of the picture: those of round and square displays with a GC9A01 or an ST7789.
pub const SIDE: u16 = 240;

/// Splats of the largest scene.
pub const MOST: usize = 3000;

static FEW: [CompactSplat; 200] = splats(809);
static MANY: [CompactSplat; 1000] = splats(334);
static ALL: [CompactSplat; MOST] = splats(169);

/// The scenes, by number of splats.
pub const SCENES: [CompactScene<'static>; 3] = [scene(&FEW), scene(&MANY), scene(&ALL)];

const fn scene(splats: &'static [CompactSplat]) -> CompactScene<'static> {
    CompactScene {
        origin: [0; 3],
        exponent: -14,
        axis_exponent: -18,
        colour_unit: (1 << 28) / 255,
        splats,
    }
}

struct SceneRandom(u32);

impl SceneRandom {
    /// A number below `end`, from `first` on.
    const fn between(&mut self, first: i32, end: i32) -> i32 {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        // Of the widest ranges the product wraps, and some numbers lie below `first`.
        first + (((self.0 >> 16) as i32).wrapping_mul(end - first) >> 16)
    }
}

/// Splats in a box of 3.2 x 3.2 x 2 units, their axes up to `size` / 1024 of 1/8 of a unit.
const fn splats<const N: usize>(size: i32) -> [CompactSplat; N] {
    let mut random = SceneRandom(7);
    let mut splats = [[0; 24]; N];
    let mut i = 0;
    while i < N {
        // The last number holds the columns' own exponents, 5 bits each.
        let numbers = [
            random.between(-26_214, 26_214),
            random.between(-26_214, 26_214),
            random.between(-16_384, 16_384),
            (random.between(12_000, 32_000) * size) >> 10,
            (random.between(-20_000, 20_000) * size) >> 10,
            (random.between(-20_000, 20_000) * size) >> 10,
            (random.between(12_000, 32_000) * size) >> 10,
            (random.between(-20_000, 20_000) * size) >> 10,
            (random.between(12_000, 32_000) * size) >> 10,
            0,
        ];
        let mut k = 0;
        while k < 10 {
            let [low, high] = (numbers[k] as i16).to_le_bytes();
            (splats[i][2 * k], splats[i][2 * k + 1]) = (low, high);
            k += 1;
        }
        let mut channel = 20;
        while channel < 23 {
            splats[i][channel] = random.between(0, 256) as u8;
            channel += 1;
        }
        splats[i][23] = random.between(40, 256) as u8;
        i += 1;
    }
    splats
}

/// 4 units in front of the middle.
pub fn view() -> View {
    let (zero, one) = (I2F30::ZERO, I2F30::ONE);
    let focal = SoftFloat {
        mantissa: 300 << 22,
        exponent: -22,
    };
    let middle = I32F32::from_bits(i64::from(SIDE / 2) << 32);
    // 1.3 times the half of the picture over the focal length: 0.52.
    let limit = I32F32::from_bits(2_233_382_994);
    View {
        rotation: [[one, zero, zero], [zero, one, zero], [zero, zero, one]],
        pose: Eye {
            position: [0, 0, -4],
            ..Eye::ORIGIN
        },
        focal: [focal; 2],
        principal: [middle; 2],
        near: Extended {
            value: 1,
            exponent: -6,
        },
        far: Extended {
            value: 200,
            exponent: 0,
        },
        viewport: [SIDE; 2],
        projection: Projection::Perspective,
        limits: RatioLimits {
            low: [I32F32::from_bits(-2_233_382_994); 2],
            high: [limit; 2],
        },
    }
}
