//! The scene: splats of a linear congruential generator, evaluated at compile time, and a camera before them.

use fixed::types::{I2F30, I8F24, I10F54, I32F32, U4F28};
use splatline::math::{Extended, Scaled};
use splatline::rules::Rules;
use splatline::splat::{Axis, FixedPosition, VolumeSplat};
use splatline::view::{Projection, RatioLimits, Translation, View};

/// Splats.
pub const SPLATS: usize = 40;
/// Columns of the picture.
pub const COLUMNS: u16 = 64;
/// Rows of the picture.
pub const ROWS: u16 = 48;
/// Rows of a strip.
pub const STRIP: u16 = 8;
/// Pixels of a strip.
pub const STRIP_PIXELS: usize = COLUMNS as usize * STRIP as usize;

/// Peak opacity, low-pass 0.3, alpha at least 1/255: the rules of most scenes one finds.
pub const RULES: Rules = Rules::GAUSSIAN_3D;

/// A splat: the range of the scene is known, so that its centre is in fixed point.
pub type Splat = VolumeSplat<FixedPosition>;

/// The splats.
pub static SCENE: [Splat; SPLATS] = splats();

struct Random(u32);

impl Random {
    const fn bits(&mut self) -> u32 {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        self.0
    }

    /// A position in [-2, 2), Q7.24.
    const fn position(&mut self) -> I8F24 {
        I8F24::from_bits(((self.bits() >> 8) as i32 - (1 << 23)) * 4)
    }

    /// A vector of up to 1/3 unit, from thick to thin.
    const fn axis(&mut self, power: i32) -> Axis {
        let mut mantissa = [0; 3];
        let mut i = 0;
        while i < 3 {
            mantissa[i] = (self.bits() >> 1) as i32 - (1 << 30);
            i += 1;
        }
        Axis {
            mantissa,
            exponent: -32 - power,
        }
    }

    const fn colour(&mut self) -> U4F28 {
        U4F28::from_bits(self.bits() >> 4)
    }
}

const fn splats() -> [Splat; SPLATS] {
    let mut random = Random(7);
    let empty = VolumeSplat {
        centre: [I8F24::ZERO; 3],
        axes: [Axis {
            mantissa: [0; 3],
            exponent: 0,
        }; 3],
        weight: Scaled::ZERO,
        colour: [U4F28::ZERO; 3],
    };
    let mut splats = [empty; SPLATS];
    let mut i = 0;
    while i < SPLATS {
        splats[i] = VolumeSplat {
            centre: [random.position(), random.position(), random.position()],
            axes: [random.axis(0), random.axis(1), random.axis(2)],
            weight: Scaled {
                mantissa: (random.bits() >> 2) as i32,
                exponent: -30,
            },
            colour: [random.colour(), random.colour(), random.colour()],
        };
        i += 1;
    }
    splats
}

/// A camera 4 units in front of the scene.
pub fn view() -> View<Translation> {
    let (zero, one) = (I2F30::ZERO, I2F30::ONE);
    let limit = I32F32::from_bits(3_435_973_837); // 0.8
    let focal = Scaled {
        mantissa: 60 << 24,
        exponent: -24,
    };
    View {
        rotation: [[one, zero, zero], [zero, one, zero], [zero, zero, one]],
        pose: Translation([I10F54::ZERO, I10F54::ZERO, I10F54::from_bits(4 << 54)]),
        focal: [focal; 2],
        principal: [
            I32F32::from_bits(i64::from(COLUMNS / 2) << 32),
            I32F32::from_bits(i64::from(ROWS / 2) << 32),
        ],
        near: Extended {
            value: 1,
            exponent: -6,
        },
        far: Extended {
            value: 200,
            exponent: 0,
        },
        viewport: [COLUMNS, ROWS],
        projection: Projection::Perspective,
        limits: RatioLimits {
            low: [I32F32::from_bits(-3_435_973_837); 2],
            high: [limit; 2],
        },
    }
}
