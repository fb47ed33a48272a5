//! The stages of setup on vectors: one splat per word, in the order and with the names of `splatline::setup`.
//!
//! Where the kernel returns early with a reason, a vector goes on and keeps the first reason per word; what is computed for a culled
//! splat is defined but of no use.

use super::number::{Arithmetic, Number};
use super::position::CameraPoint;
use crate::fast::lanes::Wide;
use splatline::format::Widths;
use splatline::math::{SoftFloat, ln};
use splatline::rules::{Cutoff, Rules, THRESHOLD};
use splatline::setup::Cull;
use splatline::view::{View, round_entry};

type Word<W> = <W as Wide>::Word;

/// Splats, one per word.
#[derive(Clone, Copy)]
pub struct Splats<W: Wide> {
    pub centre: [Number<W>; 3],
    /// Mantissas of the axes.
    pub axes: [[Word<W>; 3]; 3],
    /// Exponents of the axes.
    pub exponents: [Word<W>; 3],
    pub weight: Number<W>,
}

/// Footprints, one per word, without their colours.
#[derive(Clone, Copy)]
pub struct Footprints<W: Wide> {
    /// 0, or one more than the place of the reason in [`Cull::ALL`].
    pub culled: Word<W>,
    pub depth: Word<W>,
    pub centre: [Word<W>; 2],
    pub first: [Word<W>; 2],
    pub last: [Word<W>; 2],
    /// The factors of the LDL form, in the order of `Ldl`.
    pub ldl: [Number<W>; 4],
    pub conic: [Word<W>; 3],
    pub conic_exponent: Word<W>,
    pub cutoff: Word<W>,
    pub peak: Word<W>,
}

/// Setup under one view, rules and widths.
#[derive(Clone, Copy)]
pub struct Stages<'a, W: Wide> {
    pub math: Arithmetic<W>,
    pub widths: Widths,
    pub view: &'a View,
    pub rules: &'a Rules,
}

/// A projected centre with what the Jacobian needs of it.
#[derive(Clone, Copy)]
pub struct Projected<W: Wide> {
    /// Camera-space depth, not rounded, and its sort key.
    pub depth: Number<W>,
    pub key: Word<W>,
    pub centre: [Word<W>; 2],
    pub ratio: [Number<W>; 2],
    gain: [Number<W>; 2],
}

#[derive(Clone, Copy)]
pub struct Variance<W: Wide> {
    pub xx: Number<W>,
    pub xy: Number<W>,
    pub yy: Number<W>,
    pub determinant: Number<W>,
}

impl<W: Wide> Stages<'_, W> {
    /// `splatline::setup::setup`.
    #[inline(always)]
    pub fn setup(&self, splats: &Splats<W>) -> Footprints<W> {
        let mut culled = self.math.splat(0);
        let projected = self.project(splats, &mut culled);
        let columns = [
            self.column(splats, 0, &projected),
            self.column(splats, 1, &projected),
            self.column(splats, 2, &projected),
        ];
        let variance = self.variance(&columns);
        let inverse = self
            .math
            .reciprocal(variance.determinant, self.widths.mantissa.into());
        let ldl = self.ldl(&variance, inverse, &mut culled);
        let (conic, conic_exponent) = self.conic(&variance, ldl[0], inverse, &mut culled);
        let peak = self.peak(splats.weight, &projected, inverse);
        let cutoff = self.cutoff(peak, &mut culled);
        let mut first = [self.math.splat(0); 2];
        let mut last = first;
        for (axis, spread) in [variance.xx, variance.yy].into_iter().enumerate() {
            (first[axis], last[axis]) =
                self.bounds(axis, projected.centre[axis], spread, cutoff, &mut culled);
        }
        let peak = self.peak_fixed(peak, &mut culled);
        Footprints {
            culled,
            depth: projected.key,
            centre: projected.centre,
            first,
            last,
            ldl,
            conic,
            conic_exponent,
            cutoff,
            peak,
        }
    }

    #[inline(always)]
    pub fn bits(&self) -> u32 {
        self.widths.mantissa.into()
    }

    /// Notes the reason where it holds and no other was noted before.
    #[inline(always)]
    fn cull(&self, culled: &mut Word<W>, reason: Cull, truth: W::Truth) {
        let code = self.math.splat(code(reason));
        let noted = self.math.greater(*culled, self.math.splat(0));
        let now = self.math.select(*culled, code, truth);
        *culled = self.math.select(now, *culled, noted);
    }

    /// Notes the reason where it does not hold.
    #[inline(always)]
    fn cull_unless(&self, culled: &mut Word<W>, reason: Cull, truth: W::Truth) {
        let math = self.math;
        let kept = math.select(math.splat(0), math.splat(1), truth);
        self.cull(culled, reason, math.greater(math.splat(1), kept));
    }

    /// W times a vector of integers, entries rounded as the kernel rounds them.
    #[inline(always)]
    fn rotate(&self, row: usize, vector: &[Word<W>; 3]) -> Word<W> {
        let math = self.math;
        let mut sum = math.splat(0);
        for (entry, part) in self.view.rotation[row].iter().zip(vector) {
            let entry = math.splat(round_entry(*entry, self.widths.view.into()));
            sum = math.add(sum, math.mul(entry, *part));
        }
        sum
    }

    /// A coordinate in camera space, rounded to the view's mantissa.
    #[inline(always)]
    fn coordinate(&self, mantissa: Word<W>, exponent: Word<W>) -> Number<W> {
        self.math
            .normalise(Number { mantissa, exponent }, self.widths.view.into())
    }

    /// Culls where a magnitude has more than so many bits.
    #[inline(always)]
    fn beyond(&self, value: Word<W>, bits: i64, culled: &mut Word<W>) {
        let math = self.math;
        let above = math.shr(math.magnitude(value), bits);
        self.cull(culled, Cull::Range, math.greater(above, math.splat(0)));
    }

    #[inline(always)]
    pub fn project(&self, splats: &Splats<W>, culled: &mut Word<W>) -> Projected<W> {
        let (math, bits) = (self.math, u32::from(self.widths.view));
        let CameraPoint { value, exponent } =
            math.to_camera(self.view, &self.widths, &splats.centre);
        let x = self.coordinate(value[0], exponent);
        let y = self.coordinate(value[1], exponent);
        let z = self.coordinate(value[2], exponent);
        let (behind_near, before_far) = math.depth_range(value[2], exponent, self.view);
        self.cull_unless(culled, Cull::Near, behind_near);
        self.cull_unless(culled, Cull::Far, before_far);
        let key = math.depth_key(value[2], exponent);
        let inverse = math.reciprocal(z, bits);
        let on_plane = [
            math.multiply(x, inverse, bits),
            math.multiply(y, inverse, bits),
        ];
        let [across, down] = self.view.focal;
        let focal = [math.number(across), math.number(down)];
        let mut centre = [math.splat(0); 2];
        for axis in 0..2 {
            let offset = math.to_fixed(math.times(focal[axis], on_plane[axis]), 32);
            let principal = math.splat(self.view.principal[axis].to_bits());
            let position = math.add(principal, offset);
            // What overflows is out of range as well, and was so before the principal point was added.
            self.beyond(offset, 60, culled);
            self.beyond(position, 58, culled);
            centre[axis] = math.round(position, 32 - u32::from(self.widths.subpixel));
        }
        let gain = [
            math.multiply(focal[0], inverse, self.bits()),
            math.multiply(focal[1], inverse, self.bits()),
        ];
        let ratio = [self.ratio(0, on_plane[0]), self.ratio(1, on_plane[1])];
        Projected {
            depth: Number {
                mantissa: value[2],
                exponent,
            },
            key,
            centre,
            ratio,
            gain,
        }
    }

    /// x/z or y/z as the Jacobian takes it.
    #[inline(always)]
    fn ratio(&self, axis: usize, on_plane: Number<W>) -> Number<W> {
        let math = self.math;
        if !self.rules.clamp_jacobian {
            return math.normalise(on_plane, self.bits());
        }
        let fixed = math.to_fixed(on_plane, 32);
        let low = math.splat(self.view.limits.low[axis].to_bits());
        let high = math.splat(self.view.limits.high[axis].to_bits());
        let clamped = math.max(math.min(fixed, high), low);
        let inside = math.lanes.wide_equal(clamped, fixed);
        let number = Number {
            mantissa: math.select(clamped, on_plane.mantissa, inside),
            exponent: math.select(math.splat(-32), on_plane.exponent, inside),
        };
        math.normalise(number, self.bits())
    }

    /// Axis `k` on the screen.
    #[inline(always)]
    fn column(&self, splats: &Splats<W>, k: usize, projected: &Projected<W>) -> [Number<W>; 2] {
        self.column_and_depth(splats, k, projected).0
    }

    /// Axis `k` on the screen, and its depth.
    #[inline(always)]
    pub fn column_and_depth(
        &self,
        splats: &Splats<W>,
        k: usize,
        projected: &Projected<W>,
    ) -> ([Number<W>; 2], Number<W>) {
        let exponent = self.axis_exponent(splats, k);
        let x = self.turned(splats, k, 0, exponent);
        let y = self.turned(splats, k, 1, exponent);
        let z = self.turned(splats, k, 2, exponent);
        let column = [
            self.shear(projected, 0, x, z),
            self.shear(projected, 1, y, z),
        ];
        (column, z)
    }

    /// Exponent of axis `k` times W.
    #[inline(always)]
    pub fn axis_exponent(&self, splats: &Splats<W>, k: usize) -> Word<W> {
        let (math, exponent) = (self.math, splats.exponents[k]);
        let exponent = math.max(math.min(exponent, math.splat(511)), math.splat(-512));
        math.plus(exponent, -30)
    }

    /// One row of W a.
    #[inline(always)]
    pub fn turned(&self, splats: &Splats<W>, k: usize, row: usize, exponent: Word<W>) -> Number<W> {
        let mantissa = self.rotate(row, &splats.axes[k]);
        self.math
            .normalise(Number { mantissa, exponent }, self.bits())
    }

    /// A component seen along the viewing ray, times the gain.
    #[inline(always)]
    fn shear(
        &self,
        projected: &Projected<W>,
        axis: usize,
        across: Number<W>,
        z: Number<W>,
    ) -> Number<W> {
        let (math, bits) = (self.math, self.bits());
        let along = math.opposite(math.times(projected.ratio[axis], z));
        math.multiply(math.sum([across, along], bits), projected.gain[axis], bits)
    }

    #[inline(always)]
    fn variance(&self, columns: &[[Number<W>; 2]; 3]) -> Variance<W> {
        let (math, bits) = (self.math, self.bits());
        let h = math.number(self.rules.low_pass);
        let [a, b, c] = columns;
        let xx = math.sum(
            [
                math.times(a[0], a[0]),
                math.times(b[0], b[0]),
                math.times(c[0], c[0]),
                h,
            ],
            bits,
        );
        let yy_sharp = math.sum(
            [
                math.times(a[1], a[1]),
                math.times(b[1], b[1]),
                math.times(c[1], c[1]),
            ],
            bits,
        );
        let xy = math.sum(
            [
                math.times(a[0], a[1]),
                math.times(b[0], b[1]),
                math.times(c[0], c[1]),
            ],
            bits,
        );
        let yy = math.sum([yy_sharp, h], bits);
        let trace = math.sum([xx, yy_sharp], bits);
        let terms = [
            self.minor_squared(a, b),
            self.minor_squared(a, c),
            self.minor_squared(b, c),
            math.times(h, trace),
        ];
        Variance {
            xx,
            xy,
            yy,
            determinant: math.sum(terms, bits),
        }
    }

    /// A 2x2 minor.
    #[inline(always)]
    pub fn minor(&self, j: &[Number<W>; 2], k: &[Number<W>; 2]) -> Number<W> {
        let math = self.math;
        let crossed = math.opposite(math.times(j[1], k[0]));
        math.sum([math.times(j[0], k[1]), crossed], self.bits())
    }

    /// The square of a 2x2 minor.
    #[inline(always)]
    fn minor_squared(&self, j: &[Number<W>; 2], k: &[Number<W>; 2]) -> Number<W> {
        let minor = self.minor(j, k);
        self.math.times(minor, minor)
    }

    /// The factors of the LDL form, in the order of `Ldl`.
    #[inline(always)]
    pub fn ldl(
        &self,
        variance: &Variance<W>,
        inverse: Number<W>,
        culled: &mut Word<W>,
    ) -> [Number<W>; 4] {
        let (math, bits) = (self.math, self.bits());
        let zero = math.splat(0);
        for value in [variance.yy, variance.determinant] {
            let nothing = math.lanes.wide_equal(value.mantissa, zero);
            self.cull(culled, Cull::Degenerate, nothing);
        }
        let vertical = math.reciprocal(variance.yy, bits);
        let horizontal = math.multiply(variance.yy, inverse, bits);
        let squared_width = math.multiply(variance.determinant, vertical, bits);
        let shear = math.multiply(variance.xy, vertical, bits);
        let tiny = math.greater(math.splat(-512), shear.exponent);
        let shear = Number {
            mantissa: math.select(shear.mantissa, zero, tiny),
            exponent: math.select(shear.exponent, zero, tiny),
        };
        for number in [horizontal, squared_width, vertical] {
            self.unpackable(number.exponent, culled);
        }
        [horizontal, squared_width, shear, vertical]
    }

    /// Culls where an exponent has no place in the packet.
    #[inline(always)]
    fn unpackable(&self, exponent: Word<W>, culled: &mut Word<W>) {
        let math = self.math;
        let above = math.greater(exponent, math.splat(511));
        let below = math.greater(math.splat(-512), exponent);
        self.cull(culled, Cull::Degenerate, above);
        self.cull(culled, Cull::Degenerate, below);
    }

    #[inline(always)]
    pub fn conic(
        &self,
        variance: &Variance<W>,
        curvature: Number<W>,
        inverse: Number<W>,
        culled: &mut Word<W>,
    ) -> ([Word<W>; 3], Word<W>) {
        const NONE: i64 = i32::MIN as i64;
        let (math, bits) = (self.math, self.bits());
        let coefficients = [
            curvature,
            math.opposite(math.multiply(variance.xy, inverse, bits)),
            math.multiply(variance.xx, inverse, bits),
        ];
        let mut leading = math.splat(NONE);
        for coefficient in coefficients {
            let nothing = math.lanes.wide_equal(coefficient.mantissa, math.splat(0));
            let own = math.select(math.leading(coefficient), math.splat(NONE), nothing);
            leading = math.max(leading, own);
        }
        let exponent = math.plus(leading, 1 - i64::from(bits));
        let mut mantissa = [math.splat(0); 3];
        for (mantissa, coefficient) in mantissa.iter_mut().zip(coefficients) {
            let aligned = Number {
                exponent: math.sub(coefficient.exponent, exponent),
                ..coefficient
            };
            *mantissa = math.to_fixed(aligned, 0);
        }
        self.unpackable(exponent, culled);
        (mantissa, exponent)
    }

    #[inline(always)]
    fn peak(&self, weight: Number<W>, projected: &Projected<W>, inverse: Number<W>) -> Number<W> {
        let (math, bits) = (self.math, self.bits());
        let mut peak = weight;
        if self.rules.normalised {
            // A variance without an inverse has been culled.
            let [x, y] = projected.ratio;
            let one = math.number(SoftFloat {
                mantissa: 1,
                exponent: 0,
            });
            let slant = math.sum([one, math.times(x, x), math.times(y, y)], bits);
            let density = math.square_root(math.multiply(slant, inverse, bits), bits);
            let area = math.multiply(projected.gain[0], projected.gain[1], bits);
            peak = math.multiply(weight, area, bits);
            peak = math.multiply(peak, density, bits);
            let integral = math.number(self.rules.kernel.inverse_integral());
            peak = math.multiply(peak, integral, bits);
        }
        self.where_positive(weight.mantissa, peak)
    }

    /// The number where the word is positive, else 0.
    #[inline(always)]
    pub fn where_positive(&self, word: Word<W>, number: Number<W>) -> Number<W> {
        let math = self.math;
        let zero = math.splat(0);
        let positive = math.greater(word, zero);
        let none = math.splat(SoftFloat::ZERO.exponent.into());
        Number {
            mantissa: math.select(zero, number.mantissa, positive),
            exponent: math.select(none, number.exponent, positive),
        }
    }

    #[inline(always)]
    pub fn cutoff(&self, peak: Number<W>, culled: &mut Word<W>) -> Word<W> {
        // As in the kernel's `cutoff`.
        const END: i64 = 15 << 28;
        let (math, end) = (self.math, self.rules.kernel.end());
        if let Cutoff::Radial(cutoff) = self.rules.cutoff {
            return math.splat(cutoff.min(end).into());
        }
        let least = (self.rules.alpha_min >> 1) as i64;
        let smallest = SoftFloat::from_wide(least, 1 - THRESHOLD as i32, 31);
        let below = ln(smallest).unwrap_or(i64::MAX >> 1);
        let dark = math.greater(math.splat(1), peak.mantissa);
        self.cull(culled, Cull::Transparent, dark);
        let cutoff = math.round(math.plus(math.ln(peak), -below), 3);
        let nowhere = math.greater(math.splat(1), cutoff);
        self.cull(culled, Cull::Transparent, nowhere);
        math.max(math.min(cutoff, math.splat(END)), math.splat(0))
    }

    /// First and one past the last pixel on one axis.
    #[inline(always)]
    pub fn bounds(
        &self,
        axis: usize,
        centre: Word<W>,
        spread: Number<W>,
        cutoff: Word<W>,
        culled: &mut Word<W>,
    ) -> (Word<W>, Word<W>) {
        let math = self.math;
        let number = Number {
            mantissa: cutoff,
            exponent: math.splat(-28),
        };
        let cutoff = math.normalise(number, 16);
        let squared = math.multiply(cutoff, spread, 16);
        let extent = math.to_fixed(math.square_root(squared, 16), 32);
        let wider = math.add(extent, math.sar(extent, 10));
        for value in [extent, wider] {
            let beyond = math.greater(math.shr(value, 60), math.splat(0));
            self.cull(culled, Cull::Range, beyond);
        }
        let sample = math.shl(centre, 32 - i64::from(self.widths.subpixel));
        let sample = math.plus(sample, -(1 << 31));
        let low = math.sar(math.plus(math.sub(sample, wider), (1 << 32) - 1), 32);
        let high = math.plus(math.sar(math.add(sample, wider), 32), 1);
        let limit = math.splat(self.view.viewport[axis].into());
        let zero = math.splat(0);
        let low = math.min(math.max(low, zero), limit);
        let high = math.min(math.max(high, zero), limit);
        self.cull(culled, Cull::Outside, math.greater(math.plus(low, 1), high));
        (low, high)
    }

    #[inline(always)]
    pub fn peak_fixed(&self, peak: Number<W>, culled: &mut Word<W>) -> Word<W> {
        let (math, fraction) = (self.math, u32::from(self.widths.peak));
        let fixed = math.to_fixed(peak, fraction);
        // An odd result of a half was rounded up: halves go to even.
        let dropped = math.negate(math.plus(peak.exponent, fraction.into()));
        let above = math
            .lanes
            .wide_shl(peak.mantissa, math.sub(math.splat(64), dropped));
        let half = math.lanes.wide_equal(above, math.splat(i64::MIN));
        let odd = math.and(fixed, 1);
        let fixed = math.sub(fixed, math.select(math.splat(0), odd, half));
        let largest = math.splat((16 << fraction.min(28)) - 1);
        let fixed = math.max(math.min(fixed, largest), math.splat(0));
        let dark = math.greater(math.splat(1), fixed);
        self.cull(culled, Cull::Transparent, dark);
        fixed
    }
}

/// One more than the reason's place in [`Cull::ALL`].
pub const fn code(reason: Cull) -> i64 {
    reason.place() as i64 + 1
}
