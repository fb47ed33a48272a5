//! The scene: splats of a linear congruential generator, evaluated at compile time, and a camera before them.

use fixed::types::{I2F30, I32F32, U4F28};
#[cfg(not(feature = "lossless"))]
use fixed::types::{I8F24, I10F54};
use splatline::math::{Extended, SoftFloat};
use splatline::rules::Rules;
use splatline::splat::{Axis, VolumeSplat};
#[cfg(feature = "lossless")]
use splatline::view::Eye;
#[cfg(not(feature = "lossless"))]
use splatline::view::Translation;
use splatline::view::{Pose, Projection, RatioLimits, View};

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

/// Where the camera stands: the range of the scene is known, so that centres are in fixed point.
#[cfg(not(feature = "lossless"))]
pub type Stand = Translation;
/// Where the camera stands.
#[cfg(feature = "lossless")]
pub type Stand = Eye;

/// A splat of the scene.
pub type Splat = VolumeSplat<<Stand as Pose>::Centre>;

/// The splats.
pub static SCENE: [Splat; SPLATS] = splats();

struct SceneRandom(u32);

impl SceneRandom {
    const fn bits(&mut self) -> u32 {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        self.0
    }

    /// A position in [-2, 2).
    #[cfg(not(feature = "lossless"))]
    const fn position(&mut self) -> I8F24 {
        I8F24::from_bits(((self.bits() >> 8) as i32 - (1 << 23)) * 4)
    }

    /// A position in [-2, 2).
    #[cfg(feature = "lossless")]
    const fn position(&mut self) -> SoftFloat {
        SoftFloat {
            mantissa: ((self.bits() >> 8) as i32 - (1 << 23)) * 4,
            exponent: -24,
        }
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

#[cfg(not(feature = "lossless"))]
const ORIGIN: I8F24 = I8F24::ZERO;
#[cfg(feature = "lossless")]
const ORIGIN: SoftFloat = SoftFloat::ZERO;

/// A coordinate of the scene in units of 2^-24.
#[cfg(not(feature = "lossless"))]
pub const fn bits_of(coordinate: I8F24) -> i32 {
    coordinate.to_bits()
}

/// A coordinate of the scene in units of 2^-24.
#[cfg(feature = "lossless")]
pub const fn bits_of(coordinate: SoftFloat) -> i32 {
    coordinate.mantissa
}

/// 4 units before the origin.
#[cfg(not(feature = "lossless"))]
const STAND: Stand = Translation([I10F54::ZERO, I10F54::ZERO, I10F54::from_bits(4 << 54)]);
#[cfg(feature = "lossless")]
const STAND: Stand = Eye {
    position: [0, 0, -4],
    ..Eye::ORIGIN
};

const fn splats() -> [Splat; SPLATS] {
    let mut random = SceneRandom(7);
    let empty = VolumeSplat {
        centre: [ORIGIN; 3],
        axes: [Axis {
            mantissa: [0; 3],
            exponent: 0,
        }; 3],
        weight: SoftFloat::ZERO,
        colour: [U4F28::ZERO; 3],
    };
    let mut splats = [empty; SPLATS];
    let mut i = 0;
    while i < SPLATS {
        splats[i] = VolumeSplat {
            centre: [random.position(), random.position(), random.position()],
            axes: [random.axis(0), random.axis(1), random.axis(2)],
            weight: SoftFloat {
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
pub fn view() -> View<Stand> {
    let (zero, one) = (I2F30::ZERO, I2F30::ONE);
    let limit = I32F32::from_bits(3_435_973_837); // 0.8
    let focal = SoftFloat {
        mantissa: 60 << 24,
        exponent: -24,
    };
    View {
        rotation: [[one, zero, zero], [zero, one, zero], [zero, zero, one]],
        pose: STAND,
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
