//! The built-in subject: random splats, every other one a hard case.

use fixed::types::{I2F30, I32F32, U4F28};
use splatline::format::Widths;
use splatline::math::{Extended, SoftFloat};
use splatline::splat::{Axis, VolumeSplat};
use splatline::view::{Eye, Pose, Projection, RatioLimits, View};

/// A linear congruential generator, so that anyone can make the same splats.
pub(super) struct BuiltinRandom(pub(super) u32);

impl BuiltinRandom {
    pub(super) fn bits(&mut self) -> u32 {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        self.0
    }
}

/// `count` splats before a camera of `size` pixels: in turn ordinary, needle, disc, huge, tiny, at the eye, beside the
/// picture, saturated and almost transparent.
pub fn hard_cases(count: usize, size: [u16; 2], seed: u32) -> (View, Vec<VolumeSplat>) {
    let mut random = BuiltinRandom(seed);
    let splats = (0..count).map(|index| splat(&mut random, index)).collect();
    (view(size), splats)
}

/// Splats at the ends of formats, of ranges and of roundings, one property each: what random splats meet once in a
/// billion.
pub fn stress_cases() -> Vec<VolumeSplat> {
    const FAR: i32 = 1 << 30;
    let mut splats = vec![usual([0.0; 3]), at_near(), at_far()];
    let mut add = |change: &dyn Fn(&mut VolumeSplat)| {
        let mut splat = usual([0.0, 0.0, 0.5]);
        change(&mut splat);
        splats.push(splat);
    };
    for exponent in [i32::MIN, -FAR, -513, -512, 511, 512, FAR, i32::MAX] {
        add(&|splat| splat.centre[0].exponent = exponent);
        add(&|splat| splat.centre = splat.centre.map(|c| SoftFloat { exponent, ..c }));
        add(&|splat| splat.axes[1].exponent = exponent);
        add(&|splat| splat.weight.exponent = exponent);
    }
    for mantissa in [i32::MIN, -i32::MAX, -1, 0, 1, i32::MAX] {
        add(&|splat| splat.centre[2].mantissa = mantissa);
        add(&|splat| splat.axes[0].mantissa = [mantissa; 3]);
        add(&|splat| splat.axes = [axis([mantissa, 0, 0], -31); 3]);
        add(&|splat| splat.weight.mantissa = mantissa);
    }
    // At the eye, and as deep as each other; then the eye of `stress_view` to the last bit, and small differences from
    // it.
    add(&|splat| splat.centre = world([0.0; 3]));
    add(&|splat| {
        splat.centre = world([0.0; 3]);
        splat.centre[1] = soft(EYE_HEIGHT as i32, EYE_EXPONENT);
    });
    for low in 1..8 {
        add(&|splat| splat.centre[1] = soft((1 << 29) + low, EYE_EXPONENT - 3));
    }
    // So bright that sums leave their word where they are not shares.
    for _ in 0..5 {
        add(&|splat| {
            splat.colour = [U4F28::MAX; 3];
            splat.weight = number(1.0);
        });
    }
    // Around the ends of centres (2^26 pixels) and of extents (2^28 pixels).
    for power in 17..26 {
        let side = 1.4 * f64::from(1 << power);
        add(&|splat| splat.centre = world([side, 0.1, 3.0]));
        add(&|splat| splat.centre = world([0.1, -side, 3.0]));
        add(&|splat| splat.axes[2].exponent = power - 29);
    }
    // Halves of the peak's and the colours' last bits, above an even and an odd word, and beside them.
    for fraction in [8, 14, 18, 24, 26, 28] {
        for last in [1, 2, 3, 5, 7] {
            let mantissa = (1 << (fraction - 1)) + last;
            add(&|splat| {
                splat.weight = soft(mantissa, -1 - fraction);
                splat.colour = [0u32, 1, 2].map(|channel| {
                    let below = 28 - fraction as u32;
                    U4F28::from_bits(((mantissa as u32 + channel) << below) >> 1)
                });
            });
        }
    }
    // Opacities around 1/255, where the cut-off begins, and around its end and the peak's.
    for step in -3..8 {
        add(&|splat| splat.weight = soft(1_077_952_576 + step, -38));
    }
    for mantissa in [7, 8, 15, 16, 17, 1000] {
        add(&|splat| splat.weight = soft(mantissa, 0));
    }
    // Covariances around the ends of their exponents, in all directions and between the two of the picture.
    for mantissa in [1 << 30, 7 << 28] {
        for exponent in (194..218).chain(-302..-284) {
            add(&|splat| {
                splat.axes = splat.axes.map(|axis| Axis { exponent, ..axis });
                splat.axes[0].mantissa[0] = mantissa;
            });
        }
        for exponent in -292..-270 {
            add(&|splat| splat.axes[0] = axis([1 << 30, mantissa, 0], exponent));
        }
    }
    // Long, flat and a little tilted: rows around the length and the shear where centres have fewer bits.
    for power in 10..17 {
        let along = |splat: &mut VolumeSplat, tilt: i32| {
            splat.axes[0] = axis([858_993_459, tilt, -644_245_094], power - 34);
            splat.weight = number(0.03125);
        };
        add(&|splat| {
            along(splat, 1 << (29 - power));
            splat.axes[1].exponent = -35;
        });
        add(&|splat| {
            *splat = small(world([0.1, 2.5 / 96.0, 5.0]), 0.5);
            along(splat, 1 << (30 - power));
            splat.axes[1].exponent = -40;
        });
    }
    // Cut-offs whose slack ends in the last bit at a row's sample point, where `lean18` has the centre between two
    // pixels.
    for mantissa in [1_431_683_088, 1_431_683_090, 1_431_683_096] {
        add(&|splat| {
            *splat = small(world([0.015_625, 0.0, 3.0]), 0.0);
            splat.weight = soft(mantissa, -33);
        });
    }
    // A needle so thin that its box' words leave 64 bits where there is no low-pass filter.
    add(&|splat| {
        let thin = |exponent| axis([1 << 30, 1 << 30, 0], exponent);
        splat.axes = [thin(-33), thin(-62), thin(-62)];
        splat.axes[1].mantissa[1] = -(1 << 30);
    });
    // Steep and bright, two pixels beside the end of a block of columns: differences leave lanes of 32 bits.
    for step in 0..24 {
        let place = f64::from(step);
        let at = world([3.0 * (0.1500 + 0.0001 * place), 0.02 * place - 0.25, 3.0]);
        add(&|splat| *splat = small(at, 16.0));
    }
    splats.extend(flat_cases());
    splats.extend(far_edges());
    splats.extend(slants());
    splats
}

/// Hardly any height: where there is no low-pass filter, the inverse's exponent ends, in the one form of a footprint or
/// the other, and rows lie so far apart that centres have fewer bits.
fn flat_cases() -> impl Iterator<Item = VolumeSplat> {
    /// An axis along the picture's rows, and a height and its exponent.
    const ENDS: [(Axis, i32, i32); 5] = [
        (
            axis([858_389_504, 0, -643_792_128], -270),
            2_024_673_279,
            -300,
        ),
        (
            axis([1_733_005_860, 0, -1_299_754_395], -274),
            2_049_975_331,
            -304,
        ),
        (axis([1 << 30, 0, -3 << 28], -271), 1 << 30, -299),
        (axis([1 << 30, 0, -3 << 28], -274), 1 << 30, -303),
        (axis([1 << 30, 2, -3 << 28], -274), 1_700_000_000, -304),
    ];
    let flat = |(width, height, low)| VolumeSplat {
        axes: [width, axis([0, height, 0], low), axis([0; 3], 0)],
        ..usual([0.0, 0.0, 0.5])
    };
    let tilted = |tilt| {
        let mut splat = small(world([0.1, 2.5 / 64.0, 5.0]), 0.5);
        splat.axes.iter_mut().for_each(|axis| axis.exponent = -40);
        splat.axes[0] = axis([858_993_459, tilt, -644_245_094], -21);
        splat
    };
    let tilted = [180_000, 100_000].map(tilted);
    ENDS.map(flat).into_iter().chain(tilted)
}

/// Needles that begin far beside the picture and end in it: the last bits of extents decide at which pixel.
fn far_edges() -> impl Iterator<Item = VolumeSplat> {
    (0u32..12).map(|step| {
        // Opacities, and 1/sqrt(2 ln(255 opacity)) for each.
        let choice = step as usize % 4;
        let weight = [0.5, 0.6, 0.8, 0.9][choice];
        let deviations = [0.321_143_02, 0.315_269_61, 0.306_623_85, 0.303_283_76][choice];
        let reach = f64::from(2048u32 << (step % 3));
        let place = f64::from(step);
        let centre = [3.0 * (0.02 * place - 0.24 - reach), 0.06 * place - 0.4, 3.0];
        let mut splat = small(world(centre), weight);
        let width = (0.6 * reach * deviations / (1.0 + 1.0 / 1024.0) * 16_384.0) as i32;
        splat.axes[0] = axis([4 * width, 0, -3 * width], -14);
        splat
    })
}

/// Directions whose slant is rounded with the last of its guard bits.
fn slants() -> impl Iterator<Item = VolumeSplat> {
    /// Mantissas, and their exponents.
    const CENTRES: [([i32; 3], [i32; 3]); 4] = [
        (
            [-1_447_683_977, -2_123_898_671, -1_268_099_187],
            [-29, -32, -29],
        ),
        (
            [-1_422_409_378, 2_067_257_454, -1_217_554_025],
            [-29, -32, -29],
        ),
        (
            [-1_876_433_978, -1_344_705_664, -2_044_897_691],
            [-29, -34, -30],
        ),
        (
            [-1_281_711_169, -2_051_097_418, -1_086_513_205],
            [-30, -32, -28],
        ),
    ];
    CENTRES.into_iter().map(|(mantissas, exponents)| {
        let centre = [0, 1, 2].map(|axis| soft(mantissas[axis], exponents[axis]));
        VolumeSplat {
            centre,
            ..usual([0.0; 3])
        }
    })
}

/// Gives the eye all its bits and the rotation its rests, and puts near and far plane where [`stress_cases`] has a
/// centre each, to the last bit of the design's camera space.
pub fn stress_view(view: &mut View, widths: &Widths) {
    let (sine, cosine) = (REST_OF_SINE, REST_OF_COSINE);
    view.pose = Eye {
        position: [-3 << 57, EYE_HEIGHT, -4 << 57],
        exponent: EYE_EXPONENT,
        rotation_rest: [[cosine, 0, -sine], [0, 3, 0], [sine, 0, cosine]],
    };
    between(view, widths, at_near(), at_far());
}

const EYE_HEIGHT: i64 = 0x5a5a_5a5b;
const EYE_EXPONENT: i32 = -57;
/// What 0.6 and 0.8 have beyond 30 bits, in units of `2^-60`.
const REST_OF_SINE: i32 = 429_496_730;
const REST_OF_COSINE: i32 = 214_748_365;

fn between(view: &mut View, widths: &Widths, near: VolumeSplat, far: VolumeSplat) {
    let depth = |splat: VolumeSplat| {
        let point = view.pose.to_camera(&view.rotation, &splat.centre, widths);
        let depth = point.coordinate(2);
        // The same depth in a longer word, as a camera's own has.
        Extended {
            value: depth.value << 1,
            exponent: depth.exponent - 1,
        }
    };
    (view.near, view.far) = (depth(near), depth(far));
}

/// The same camera without perspective and at the origin, from `-2^329` to `2^329`, and splats on its axis at the ends
/// of these depths and of sort keys, on both sides of the eye, and as close to it as words allow.
pub fn stress_orthographic(view: &mut View, splats: &mut Vec<VolumeSplat>, widths: &Widths) {
    /// The rotation's entries: what lies along them has x = 0 exactly.
    const SINE: i32 = 644_245_094;
    const COSINE: i32 = 858_993_459;
    let at = |x: i32, z: i32, exponent: i32| {
        let mut splat = usual([0.0; 3]);
        splat.centre = [x, 0, z].map(|mantissa| soft(mantissa, exponent));
        splat
    };
    view.projection = Projection::Orthographic;
    view.focal = view.focal.map(|focal| SoftFloat {
        exponent: focal.exponent - 3,
        ..focal
    });
    view.pose = Eye {
        position: [0; 3],
        exponent: 0,
        rotation_rest: [[0; 3]; 3],
    };
    between(view, widths, at(-SINE, -COSINE, 300), at(SINE, COSINE, 300));
    for exponent in [-287, -286, -285, -40, 226, 227, 228, 299, 300, 301] {
        splats.push(at(SINE, COSINE, exponent));
        splats.push(at(-SINE, -COSINE, exponent));
    }
    for part in [-1, 1] {
        splats.push(at(SINE + part, COSINE, 300));
        splats.push(at(part - SINE, -COSINE, 300));
        splats.push(at(COSINE, -SINE, -31 + 400 * (part + 1)));
        // SINE x + COSINE z is one unit.
        for exponent in [-60, 500] {
            splats.push(at(858_993_455 * part, -644_245_091 * part, exponent));
        }
    }
}

fn at_near() -> VolumeSplat {
    usual([-2.990_1, 0.001, -3.987_6])
}

fn at_far() -> VolumeSplat {
    usual([117.3, 1.7, 156.1])
}

/// Round, half opaque, at a place in the scene.
fn usual(place: [f64; 3]) -> VolumeSplat {
    let unit = |k: usize| axis([0, 1, 2].map(|part| i32::from(part == k) << 30), -33);
    VolumeSplat {
        centre: place.map(number),
        axes: [0, 1, 2].map(unit),
        weight: number(0.5),
        colour: [0.25, 0.5, 0.75].map(U4F28::from_num),
    }
}

/// Smaller than a pixel.
fn small(centre: [SoftFloat; 3], weight: f64) -> VolumeSplat {
    let mut splat = usual([0.0; 3]);
    splat.centre = centre;
    splat.axes.iter_mut().for_each(|axis| axis.exponent = -48);
    splat.weight = number(weight);
    splat
}

/// A place in the scene from one in the camera's space: [`view`]'s rotation and eye, undone.
fn world([x, y, z]: [f64; 3]) -> [SoftFloat; 3] {
    [0.8 * x + 0.6 * z - 3.0, y, 0.8 * z - 0.6 * x - 4.0].map(number)
}

/// A number by its words.
pub(super) fn soft(mantissa: i32, exponent: i32) -> SoftFloat {
    SoftFloat { mantissa, exponent }
}

const fn axis(mantissa: [i32; 3], exponent: i32) -> Axis {
    Axis { mantissa, exponent }
}

/// With 31 bits, for magnitudes below `2^30`.
fn number(value: f64) -> SoftFloat {
    SoftFloat::from_wide((value * 4_294_967_296.0) as i64, -32, 31)
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
    let mut entry = || (random.bits() >> 1) as i32 - (1 << 30);
    let axes = thin.map(|power| axis([(); 3].map(|()| entry()), -32 - power));
    VolumeSplat {
        centre: centre.map(|mantissa| soft(mantissa, -24)),
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
