//! The usual formulas in any floating-point format, every operation rounded: what a machine with a 16-bit datapath
//! computes.
//!
//! A number is a double that is rounded to its format after each operation. For sums, products, quotients and roots of
//! formats with up to 25 significant bits that is the correctly rounded result: a double has more than twice as many
//! bits and two to spare, so that rounding twice changes nothing (Figueroa, When is double rounding innocuous, 1995).
//!
//! Each stage has a format of its own, so that a table can say which of them an error comes from:
//!
//! ```text
//! setup (centre, conic, opacity) -> raster (offset from the centre, radial index)
//!     -> kernel (exp, opacity at the pixel) -> blend
//! ```
//!
//! The formulas are those of [`plain`]. Machines with a narrow pixel path keep
//! pixel coordinates small; so here a splat's centre is handed to the raster stage relative to its tile of 16 x 16
//! pixels. Depths are compared in the format of setup, ties by index.

use super::plain::{self, Number, PlainFootprint};
use super::{BAND, Counts, FloatDrawing, PixelBox, compositor, in_bands};
use crate::camera::Camera;
use crate::picture::Picture;
use crate::rules::Rules;
use crate::scene::{Scene, SortOrder};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Columns of a tile, which has as many rows as a band.
const TILE: usize = BAND;

/// A binary floating-point format with gradual underflow, infinities, and rounding to nearest, ties to even.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FloatFormat {
    /// Bits behind the leading one.
    pub fraction_bits: i32,
    /// Exponent of the smallest normal number.
    pub min_exponent: i32,
    /// Exponent of the largest numbers.
    pub max_exponent: i32,
}

/// IEEE 754 binary32.
pub const FP32: FloatFormat = FloatFormat::new(23, -126, 127);

/// IEEE 754 binary16.
pub const FP16: FloatFormat = FloatFormat::new(10, -14, 15);

/// The upper half of a binary32.
pub const BFLOAT16: FloatFormat = FloatFormat::new(7, -126, 127);

/// 8 bits, of which 4 are the exponent's (E4M3); the two largest numbers, which some machines use for NaN, are numbers
/// here.
pub const FP8: FloatFormat = FloatFormat::new(3, -6, 8);

/// 8 bits, of which 5 are the exponent's (E5M2).
pub const FP8_WIDE: FloatFormat = FloatFormat::new(2, -14, 15);

impl FloatFormat {
    /// So many bits behind the leading one, and normal numbers from 2^min to those of the exponent max.
    const fn new(fraction_bits: i32, min_exponent: i32, max_exponent: i32) -> FloatFormat {
        FloatFormat {
            fraction_bits,
            min_exponent,
            max_exponent,
        }
    }

    /// The nearest value of the format.
    pub fn round(self, value: f64) -> f64 {
        if value == 0.0 || !value.is_finite() {
            return value;
        }
        // A double's own subnormal numbers lie far below those of every format here.
        let exponent = ((value.to_bits() >> 52) & 0x7ff) as i32 - 1023;
        let last = exponent.max(self.min_exponent) - self.fraction_bits;
        let rounded = (value * power(-last)).round_ties_even() * power(last);
        if rounded.abs() > self.largest() {
            f64::INFINITY.copysign(value)
        } else {
            rounded
        }
    }

    /// The largest finite value.
    pub fn largest(self) -> f64 {
        (2.0 - power(-self.fraction_bits)) * power(self.max_exponent)
    }

    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            FP32 => "fp32",
            FP16 => "fp16",
            BFLOAT16 => "bfloat16",
            FP8 => "e4m3",
            FP8_WIDE => "e5m2",
            _ => "a format of your own",
        }
    }

    /// Bits of a number: sign, exponent and fraction.
    pub fn bits(self) -> u32 {
        let exponents = (self.max_exponent - self.min_exponent + 3) as u32;
        1 + exponents.ilog2() + self.fraction_bits as u32
    }

    fn number(self, value: f64) -> Rounded {
        Rounded {
            value: self.round(value),
            format: self,
        }
    }
}

/// 2^exponent, for the exponents of normal doubles.
fn power(exponent: i32) -> f64 {
    f64::from_bits(((exponent + 1023).clamp(1, 2046) as u64) << 52)
}

/// A value of a format. Operations round to the format of their left operand.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Rounded {
    value: f64,
    format: FloatFormat,
}

impl Rounded {
    fn to(self, format: FloatFormat) -> Rounded {
        format.number(self.value)
    }

    fn of(self, value: f64) -> Rounded {
        self.format.number(value)
    }

    /// Of the exponential only the double's value is rounded: it is within a billionth of the true one's neighbourhood.
    fn exp(self) -> Rounded {
        self.of(libm::exp(self.value))
    }
}

impl Number for Rounded {
    fn value(self) -> f64 {
        self.value
    }

    fn sqrt(self) -> Rounded {
        self.of(self.value.sqrt())
    }
}

impl Add for Rounded {
    type Output = Rounded;
    fn add(self, other: Rounded) -> Rounded {
        self.of(self.value + other.value)
    }
}

impl Sub for Rounded {
    type Output = Rounded;
    fn sub(self, other: Rounded) -> Rounded {
        self.of(self.value - other.value)
    }
}

impl Mul for Rounded {
    type Output = Rounded;
    fn mul(self, other: Rounded) -> Rounded {
        self.of(self.value * other.value)
    }
}

impl Div for Rounded {
    type Output = Rounded;
    fn div(self, other: Rounded) -> Rounded {
        self.of(self.value / other.value)
    }
}

impl Neg for Rounded {
    type Output = Rounded;
    fn neg(self) -> Rounded {
        Rounded {
            value: -self.value,
            ..self
        }
    }
}

/// The formats of a datapath's stages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RoundedStages {
    /// From the splat to centre, conic and opacity.
    pub setup: FloatFormat,
    /// Offset of a pixel and radial index.
    pub raster: FloatFormat,
    /// Kernel and opacity at the pixel.
    pub kernel: FloatFormat,
    /// Transmittance and colours.
    pub blend: FloatFormat,
}

impl RoundedStages {
    /// One format after a setup in single precision, as the machines of the literature have it.
    pub fn pixels(format: FloatFormat) -> RoundedStages {
        RoundedStages {
            setup: FP32,
            raster: format,
            kernel: format,
            blend: format,
        }
    }

    /// One format throughout.
    pub fn all(format: FloatFormat) -> RoundedStages {
        RoundedStages {
            setup: format,
            ..RoundedStages::pixels(format)
        }
    }
}

/// A footprint in the format of setup.
#[derive(Clone, Copy, Debug)]
struct RoundedFootprint {
    plain: PlainFootprint<Rounded>,
    /// What it is sorted by: the depth, or the distance from the eye.
    place: Rounded,
    colour: [f64; 3],
}

/// Draws front to back. Kernels other than the Gaussian are drawn as one: callers ask for `3dgs` or `ewa`.
pub fn draw(scene: &Scene, camera: &Camera, rules: &Rules, stages: &RoundedStages) -> FloatDrawing {
    let by_distance = scene.order == SortOrder::Distance && !camera.orthographic;
    let projected = compositor::project_all(scene, camera, rules, |splat| {
        let n = |value| stages.setup.number(value);
        let plain = plain::project(splat, camera, rules, n)?;
        let place = if by_distance {
            plain::dot(plain.position, plain.position).sqrt()
        } else {
            plain.position[2]
        };
        Ok(RoundedFootprint {
            plain,
            place,
            colour: splat.colour,
        })
    });
    let mut counts = Counts::of_projected(&projected);
    let mut drawn: Vec<RoundedFootprint> = projected.into_iter().flatten().collect();
    // Stable: equal places stay in the order of their numbers.
    drawn.sort_by(|a, b| a.place.value.total_cmp(&b.place.value));
    let boxed: Vec<(RoundedFootprint, PixelBox)> = drawn
        .into_iter()
        .map(|footprint| (footprint, footprint.plain.bounds(camera, rules)))
        .filter(|(_, bounds)| !bounds.is_empty())
        .collect();
    let mut picture = Picture::new(camera.width, camera.height);
    counts.covered_pixels = in_bands(&mut picture.pixels, camera.width, |rows, pixels| {
        let [nothing, all] = [0.0, 1.0].map(|value| stages.blend.number(value));
        let mut tiles = RowBand {
            rows,
            rules,
            stages,
            gathered: vec![[nothing, nothing, nothing, all]; pixels.len()],
            finished: vec![false; pixels.len()],
            covered: 0,
        };
        for (footprint, bounds) in &boxed {
            tiles.splat(footprint, bounds);
        }
        for (pixel, [r, g, b, clear]) in pixels.iter_mut().zip(&tiles.gathered) {
            *pixel = [r.value, g.value, b.value, 1.0 - clear.value];
        }
        tiles.covered
    });
    FloatDrawing { picture, counts }
}

/// A row of tiles.
struct RowBand<'a> {
    rows: PixelBox,
    rules: &'a Rules,
    stages: &'a RoundedStages,
    /// Premultiplied colour and the light that is left.
    gathered: Vec<[Rounded; 4]>,
    finished: Vec<bool>,
    covered: u64,
}

impl RowBand<'_> {
    fn splat(&mut self, footprint: &RoundedFootprint, bounds: &PixelBox) {
        let inside = bounds.intersection(&self.rows);
        if inside.is_empty() {
            return;
        }
        for first in (inside.x0 / TILE * TILE..inside.x1).step_by(TILE) {
            let part = PixelBox {
                x0: inside.x0.max(first),
                x1: inside.x1.min(first + TILE),
                ..inside
            };
            self.tile(footprint, [first, self.rows.y0], &part);
        }
    }

    fn tile(&mut self, footprint: &RoundedFootprint, corner: [usize; 2], part: &PixelBox) {
        let raster = self.stages.raster;
        // Relative to the tile while still in the format of setup, then handed over.
        let centre: [Rounded; 2] = [0, 1].map(|axis| {
            let at = footprint.plain.centre[axis];
            (at - at.of(corner[axis] as f64)).to(raster)
        });
        let conic = footprint.plain.conic.map(|q| q.to(raster));
        let peak = footprint.plain.peak.to(self.stages.kernel);
        let colour = footprint
            .colour
            .map(|channel| self.stages.blend.number(channel));
        for y in part.y0..part.y1 {
            let dy = raster.number((y - corner[1]) as f64 + 0.5) - centre[1];
            for x in part.x0..part.x1 {
                let index = (y - self.rows.y0) * self.rows.x1 + x;
                if self.finished[index] {
                    continue;
                }
                let dx = raster.number((x - corner[0]) as f64 + 0.5) - centre[0];
                let r = plain::radial(conic, dx, dy);
                if let Some(alpha) = opacity(r, peak, self.rules) {
                    self.covered += 1;
                    self.blend(index, alpha.to(self.stages.blend), colour);
                }
            }
        }
    }

    fn blend(&mut self, index: usize, alpha: Rounded, colour: [Rounded; 3]) {
        let pixel = &mut self.gathered[index];
        let clear = pixel[3];
        let rest = clear * (clear.of(1.0) - alpha);
        let finished = rest.value <= self.rules.minimum_transmittance;
        self.finished[index] = finished;
        if finished && self.rules.omit_finishing {
            return;
        }
        let share = clear * alpha;
        for (sum, channel) in pixel.iter_mut().zip(colour) {
            *sum = *sum + share * channel;
        }
        pixel[3] = rest;
    }
}

/// Opacity at a radial index, clamped and cut off by the rules.
fn opacity(r: Rounded, peak: Rounded, rules: &Rules) -> Option<Rounded> {
    if !(0.0..rules.cutoff).contains(&r.value) {
        return None;
    }
    let weight = (peak.of(-0.5) * r.to(peak.format)).exp();
    let alpha = (peak * weight).min(peak.of(rules.alpha_max));
    (alpha.value > 0.0 && alpha.value >= rules.alpha_min).then_some(alpha)
}

#[cfg(test)]
#[path = "formats_tests.rs"]
mod tests;
