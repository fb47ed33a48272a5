//! The stages of setup on vectors: one splat per word, in the order and with the names of `splatline::setup`.
//!
//! Where the kernel returns early with a reason, a vector goes on and keeps the first reason per word; what is computed for a culled
//! splat is defined but of no use.

use super::number::{Arithmetic, Number};
use crate::fast::lanes::Wide;
use splatline::format::Widths;
use splatline::math::{Scaled, log2_upper};
use splatline::rules::{Cutoff, Rules};
use splatline::setup::Cull;
use splatline::view::{View, round_entry};

type Word<W> = <W as Wide>::Word;

/// Splats, one per word.
#[derive(Clone, Copy)]
pub struct Splats<W: Wide> {
    pub centre: [Word<W>; 3],
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
    /// Curvature, spread, slope, stretch.
    pub scan: [Number<W>; 4],
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
struct Projected<W: Wide> {
    depth: Word<W>,
    centre: [Word<W>; 2],
    ratio: [Number<W>; 2],
    gain: [Number<W>; 2],
}

#[derive(Clone, Copy)]
struct Variance<W: Wide> {
    xx: Number<W>,
    xy: Number<W>,
    yy: Number<W>,
    determinant: Number<W>,
}

impl<W: Wide> Stages<'_, W> {
    /// `splatline::setup::setup`.
    #[inline(always)]
    pub fn setup(&self, splats: &Splats<W>) -> Footprints<W> {
        let mut culled = self.math.splat(0);
        let projected = self.project(splats, &mut culled);
        let columns = [0, 1, 2].map(|k| self.column(splats, k, &projected));
        let variance = self.variance(&columns);
        let inverse = self
            .math
            .reciprocal(variance.determinant, self.widths.mantissa.into());
        let scan = self.scan(&variance, inverse, &mut culled);
        let (conic, conic_exponent) = self.conic(&variance, scan[0], inverse, &mut culled);
        let peak = self.peak(splats.weight, &projected, &variance, inverse);
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
            depth: projected.depth,
            centre: projected.centre,
            first,
            last,
            scan,
            conic,
            conic_exponent,
            cutoff,
            peak,
        }
    }

    fn bits(&self) -> u32 {
        self.widths.mantissa.into()
    }

    /// Notes the reason where it holds and no other was noted before.
    #[inline(always)]
    fn cull(&self, culled: &mut Word<W>, reason: Cull, truth: W::Truth) {
        let place = Cull::ALL.iter().position(|r| *r == reason).unwrap_or(0);
        let code = self.math.splat(place as i64 + 1);
        let noted = self.math.greater(*culled, self.math.splat(0));
        let now = self.math.select(*culled, code, truth);
        *culled = self.math.select(now, *culled, noted);
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

    #[inline(always)]
    fn project(&self, splats: &Splats<W>, culled: &mut Word<W>) -> Projected<W> {
        let (math, bits) = (self.math, u32::from(self.widths.view));
        let [x, y, z] = [0, 1, 2].map(|row| {
            let d = math.splat(self.view.translation[row].to_bits());
            math.add(d, self.rotate(row, &splats.centre))
        });
        let (near, far) = (self.view.near.to_bits(), self.view.far.to_bits());
        let near = math.splat(near.max(0));
        self.cull(culled, Cull::Near, math.greater(math.plus(near, 1), z));
        self.cull(culled, Cull::Far, math.greater(z, math.splat(far - 1)));
        let depth = math.round(z, 31);
        let depth = math.max(math.min(depth, math.splat(u32::MAX.into())), math.splat(0));
        let camera = |coordinate| {
            let number = Number {
                mantissa: coordinate,
                exponent: math.splat(-54),
            };
            math.normalise(number, bits)
        };
        let inverse = math.reciprocal(camera(z), bits);
        let on_plane = [x, y].map(|coordinate| math.multiply(camera(coordinate), inverse, bits));
        let focal = self.view.focal.map(|focal| math.number(focal));
        let mut centre = [math.splat(0); 2];
        for axis in 0..2 {
            let offset = math.to_fixed(math.times(focal[axis], on_plane[axis]), 32);
            let principal = math.splat(self.view.principal[axis].to_bits());
            let position = math.add(principal, offset);
            // What overflows is out of range as well, and was so before the principal point was added.
            let beyond = |value| math.greater(math.shr(math.magnitude(value), 58), math.splat(0));
            let far_off = math.shr(math.magnitude(offset), 60);
            self.cull(culled, Cull::Range, math.greater(far_off, math.splat(0)));
            self.cull(culled, Cull::Range, beyond(position));
            centre[axis] = math.round(position, 32 - u32::from(self.widths.subpixel));
        }
        let gain = focal.map(|focal| math.multiply(focal, inverse, self.bits()));
        let ratio = [0, 1].map(|axis| self.ratio(axis, on_plane[axis]));
        Projected {
            depth,
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
        let (math, bits) = (self.math, self.bits());
        let exponent = splats.exponents[k];
        let exponent = math.max(math.min(exponent, math.splat(511)), math.splat(-512));
        let exponent = math.plus(exponent, -30);
        let [x, y, z] = [0, 1, 2].map(|row| {
            let mantissa = self.rotate(row, &splats.axes[k]);
            math.normalise(Number { mantissa, exponent }, bits)
        });
        let shear = |across, axis: usize| {
            let along = math.opposite(math.times(projected.ratio[axis], z));
            math.multiply(math.sum([across, along], bits), projected.gain[axis], bits)
        };
        [shear(x, 0), shear(y, 1)]
    }

    #[inline(always)]
    fn variance(&self, columns: &[[Number<W>; 2]; 3]) -> Variance<W> {
        let (math, bits) = (self.math, self.bits());
        let h = math.number(self.rules.low_pass);
        let [a, b, c] = columns;
        let product = |i: usize, j: usize| columns.map(|m| math.times(m[i], m[j]));
        let [ax, bx, cx] = product(0, 0);
        let xx = math.sum([ax, bx, cx, h], bits);
        let yy_sharp = math.sum(product(1, 1), bits);
        let xy = math.sum(product(0, 1), bits);
        let yy = math.sum([yy_sharp, h], bits);
        let trace = math.sum([xx, yy_sharp], bits);
        let minor = |j: &[Number<W>; 2], k: &[Number<W>; 2]| {
            let crossed = math.opposite(math.times(j[1], k[0]));
            math.sum([math.times(j[0], k[1]), crossed], bits)
        };
        let squared = |minor| math.times(minor, minor);
        let terms = [
            squared(minor(a, b)),
            squared(minor(a, c)),
            squared(minor(b, c)),
            math.times(h, trace),
        ];
        Variance {
            xx,
            xy,
            yy,
            determinant: math.sum(terms, bits),
        }
    }

    /// Curvature, spread, slope and stretch.
    #[inline(always)]
    fn scan(
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
        let stretch = math.reciprocal(variance.yy, bits);
        let curvature = math.multiply(variance.yy, inverse, bits);
        let spread = math.multiply(variance.determinant, stretch, bits);
        let slope = math.multiply(variance.xy, stretch, bits);
        let tiny = math.greater(math.splat(-512), slope.exponent);
        let slope = Number {
            mantissa: math.select(slope.mantissa, zero, tiny),
            exponent: math.select(slope.exponent, zero, tiny),
        };
        for number in [curvature, spread, stretch] {
            self.unpackable(number.exponent, culled);
        }
        [curvature, spread, slope, stretch]
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
    fn conic(
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
        let mantissa = coefficients.map(|coefficient| {
            let aligned = Number {
                exponent: math.sub(coefficient.exponent, exponent),
                ..coefficient
            };
            math.to_fixed(aligned, 0)
        });
        self.unpackable(exponent, culled);
        (mantissa, exponent)
    }

    #[inline(always)]
    fn peak(
        &self,
        weight: Number<W>,
        projected: &Projected<W>,
        variance: &Variance<W>,
        inverse: Number<W>,
    ) -> Number<W> {
        let (math, bits) = (self.math, self.bits());
        let mut peak = weight;
        if self.rules.normalised {
            let [x, y] = projected.ratio;
            let one = math.number(Scaled {
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
            // A variance without an inverse has been culled.
            let _ = variance;
        }
        let zero = math.splat(0);
        let positive = math.greater(weight.mantissa, zero);
        Number {
            mantissa: math.select(zero, peak.mantissa, positive),
            exponent: math.select(
                math.splat(Scaled::ZERO.exponent.into()),
                peak.exponent,
                positive,
            ),
        }
    }

    #[inline(always)]
    fn cutoff(&self, peak: Number<W>, culled: &mut Word<W>) -> Word<W> {
        // As in the kernel's `cutoff`.
        const TWO_LN_2: i64 = 90_852;
        const END: i64 = 15 << 28;
        let (math, end) = (self.math, self.rules.kernel.end());
        if let Cutoff::Radial(cutoff) = self.rules.cutoff {
            return math.splat(cutoff.min(end).into());
        }
        let smallest = Scaled::from_wide(self.rules.alpha_min.into(), -31, 31);
        let zero = math.splat(0);
        let below = log2_upper(smallest).unwrap_or(i32::MAX);
        let octaves = math.plus(math.log2_upper(peak), 32 - i64::from(below));
        let dark = math.greater(math.splat(1), peak.mantissa);
        self.cull(culled, Cull::Transparent, dark);
        self.cull(
            culled,
            Cull::Transparent,
            math.greater(math.splat(1), octaves),
        );
        let octaves = math.max(octaves, zero);
        let cutoff = math.shr(math.mul(octaves, math.splat(TWO_LN_2)), 4);
        math.min(cutoff, math.splat(END))
    }

    /// First and one past the last pixel on one axis.
    #[inline(always)]
    fn bounds(
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
        let clamp = |value| math.min(math.max(value, math.splat(0)), limit);
        let (low, high) = (clamp(low), clamp(high));
        self.cull(culled, Cull::Outside, math.greater(math.plus(low, 1), high));
        (low, high)
    }

    #[inline(always)]
    fn peak_fixed(&self, peak: Number<W>, culled: &mut Word<W>) -> Word<W> {
        let (math, fraction) = (self.math, u32::from(self.widths.peak));
        let fixed = math.to_fixed(peak, fraction);
        let largest = math.splat((16 << fraction.min(28)) - 1);
        let fixed = math.max(math.min(fixed, largest), math.splat(0));
        let dark = math.greater(math.splat(1), fixed);
        self.cull(culled, Cull::Transparent, dark);
        fixed
    }
}
