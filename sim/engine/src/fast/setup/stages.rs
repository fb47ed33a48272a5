//! The stages of setup on vectors: one splat per word, in the order and with the names of `splatline::setup`.
//!
//! Where the kernel returns early with a reason, a vector goes on and keeps the first reason per word; what is computed
//! for a culled splat is defined but of no use.

use super::Lists;
use super::number::{Arithmetic, Number, Word, power};
use super::position::CameraPoints;
use super::real::{Real, Reals, Term};
use crate::fast::lanes::Lanes;
use splatline::format::Widths;
use splatline::math::{GUARD, SoftFloat, ln};
use splatline::rules::{Cutoff, Rules, THRESHOLD};
use splatline::setup::{Cull, axis_bits};
use splatline::view::View;

/// Splats, one per word.
#[derive(Clone, Copy)]
pub struct SplatLanes<W: Lanes> {
    pub centre: [Number<W>; 3],
    /// Mantissas of the axes.
    pub axes: [[Word<W>; 3]; 3],
    /// Exponents of the axes.
    pub exponents: [Word<W>; 3],
    pub weight: Number<W>,
}

/// Setup under one view, rules and widths.
#[derive(Clone, Copy)]
pub struct Stages<'a, W: Lanes> {
    pub lanes: W,
    pub reals: Reals<'a, W>,
    pub widths: Widths,
    /// W, whole numbers of 30 bits, rounded as the kernel rounds them.
    pub rotation: [[Word<W>; 3]; 3],
    pub view: &'a View,
    pub rules: &'a Rules,
}

/// A projected centre with what the Jacobian needs of it.
#[derive(Clone, Copy)]
pub struct ProjectedWords<W: Lanes> {
    /// Camera-space depth, not rounded, and its sort key.
    pub depth: Number<W>,
    pub key: Word<W>,
    pub centre: [Word<W>; 2],
    pub ratio: [Real<W>; 2],
    gain: [Real<W>; 2],
}

#[derive(Clone, Copy)]
pub struct Variance<W: Lanes> {
    pub xx: Real<W>,
    pub xy: Real<W>,
    pub yy: Real<W>,
    pub determinant: Real<W>,
}

impl<W: Lanes> Stages<'_, W> {
    /// `splatline::setup::setup`.
    #[inline(always)]
    pub fn setup(&self, splats: &SplatLanes<W>) -> Lists {
        let mut culled = self.lanes.splat(0);
        self.doubt_inputs(splats);
        let projected = self.project(splats, &mut culled);
        let mut columns = [
            self.column(splats, 0, &projected).0,
            self.column(splats, 1, &projected).0,
            self.column(splats, 2, &projected).0,
        ];
        let mut weight = self.reals.of_parts(splats.weight);
        if self.rules.spacing.mantissa > 0 {
            weight = self.enlarge(&mut columns, weight, &projected);
        }
        let [a, b, c] = &columns;
        let minors = [
            self.minor_squared(a, b),
            self.minor_squared(a, c),
            self.minor_squared(b, c),
        ];
        let variance = self.variance(&columns, &minors);
        let inverse = self.reals.reciprocal(variance.determinant, self.bits());
        let ldl = self.ldl(&variance, inverse, &mut culled);
        let conic = self.conic(&variance, ldl[0], inverse, &mut culled);
        if self.rules.compensated {
            weight = self.compensate(weight, minors, inverse);
        }
        let peak = self.peak(weight, &projected, inverse);
        let cutoff = self.cutoff(peak, &mut culled);
        let [u, v] = projected.centre;
        let (left, right) = self.bounds(0, u, variance.xx, cutoff, &mut culled);
        let (top, bottom) = self.bounds(1, v, variance.yy, cutoff, &mut culled);
        let peak = self.peak_fixed(peak, &mut culled);
        let bounds = [left, top, right, bottom];
        self.lists(&projected, bounds, ldl, conic, [cutoff, peak, culled])
    }

    #[inline(always)]
    pub fn bits(&self) -> u32 {
        self.widths.mantissa.into()
    }

    #[inline(always)]
    pub fn project(&self, splats: &SplatLanes<W>, culled: &mut Word<W>) -> ProjectedWords<W> {
        let (lanes, reals, bits) = (self.lanes, self.reals, u32::from(self.widths.view));
        let inputs = reals.doubt.get();
        let CameraPoints { value, exponent } = self.camera_points(&splats.centre);
        let (behind_near, before_far) = self.depth_range(value[2], exponent);
        self.cull_unless(culled, Cull::Near, behind_near);
        self.cull_unless(culled, Cull::Far, before_far);
        let key = self.depth_key(value[2], exponent);
        let unit = reals.power(exponent);
        let x = reals.wide(value[0], unit, bits);
        let y = reals.wide(value[1], unit, bits);
        let z = reals.wide(value[2], unit, bits);
        let inverse = reals.reciprocal(z, bits);
        let on_plane = [
            reals.multiply(x, inverse, bits),
            reals.multiply(y, inverse, bits),
        ];
        let [across, down] = self.view.focal;
        let focal = [reals.number(across), reals.number(down)];
        let mut centre = [lanes.splat(0); 2];
        self.doubt_ranges(z, &on_plane);
        for axis in 0..2 {
            // Never out of the kernel's range: what does not fit 51 bits is in doubt, and the principal point has
            // fewer.
            let offset = reals.times_to_fixed(focal[axis], on_plane[axis], power(32));
            let principal = lanes.splat(self.view.principal[axis].to_bits());
            let position = lanes.add(principal, offset);
            centre[axis] = lanes.round(position, 32 - u32::from(self.widths.subpixel));
        }
        // Whatever was computed of splats before or behind the view, that they are there is not in doubt.
        self.trust(*culled, inputs);
        let gain = [
            reals.multiply(focal[0], inverse, self.bits()),
            reals.multiply(focal[1], inverse, self.bits()),
        ];
        let ratio = [self.ratio(0, on_plane[0]), self.ratio(1, on_plane[1])];
        ProjectedWords {
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
    fn ratio(&self, axis: usize, on_plane: Real<W>) -> Real<W> {
        let (lanes, reals) = (self.lanes, self.reals);
        if !self.rules.clamp_jacobian {
            return reals.narrow(on_plane, self.bits());
        }
        let fixed = reals.to_short_word(reals.to_fixed(on_plane, power(32)));
        let low = lanes.splat(self.view.limits.low[axis].to_bits());
        let high = lanes.splat(self.view.limits.high[axis].to_bits());
        let clamped = lanes.max(lanes.min(fixed, high), low);
        let inside = lanes.equal(clamped, fixed);
        let clamped = reals.scaled(reals.short(clamped), 1.0 / power(32));
        let number = lanes.select(clamped.0, on_plane.0, inside);
        reals.narrow(Real(number), self.bits())
    }

    /// Axis `k` on the screen, and its depth.
    #[inline(always)]
    pub fn column(
        &self,
        splats: &SplatLanes<W>,
        k: usize,
        projected: &ProjectedWords<W>,
    ) -> ([Real<W>; 2], Real<W>) {
        let [x, y, z] = self.turned(splats, k);
        let column = [
            self.shear(projected, 0, x, z),
            self.shear(projected, 1, y, z),
        ];
        (column, z)
    }

    /// `rotate_axis`.
    #[inline(always)]
    pub fn turned(&self, splats: &SplatLanes<W>, k: usize) -> [Real<W>; 3] {
        let (lanes, reals) = (self.lanes, self.reals);
        let window = self.bits() + GUARD;
        let unit = lanes.plus(splats.exponents[k], 31 - i64::from(window));
        let unit = reals.power(unit);
        let mut axis = splats.axes[k];
        for part in &mut axis {
            let kept = lanes.masked(*part, -1 << (31 - axis_bits(&self.widths)));
            *part = reals.short(kept).0;
        }
        [
            self.turned_row(0, &axis, unit),
            self.turned_row(1, &axis, unit),
            self.turned_row(2, &axis, unit),
        ]
    }

    /// One row of W times a vector of whole numbers.
    #[inline(always)]
    fn turned_row(&self, row: usize, [x, y, z]: &[Word<W>; 3], unit: Real<W>) -> Real<W> {
        let (reals, bits) = (self.reals, self.bits());
        let kept = axis_bits(&self.widths);
        let [wx, wy, wz] = self.rotation[row];
        let length = kept + kept.min(30);
        let terms = [
            reals.product(Real(*x), Real(wx), length),
            reals.product(Real(*y), Real(wy), length),
            reals.product(Real(*z), Real(wz), length),
        ];
        let sum = reals.cuts(&terms, reals.constant(power(61 - bits - GUARD)));
        reals.times(reals.narrow(Real(sum), bits), unit)
    }

    /// A product of two mantissas of the design as a term of a sum.
    #[inline(always)]
    pub fn product(&self, a: Real<W>, b: Real<W>) -> Term<W> {
        self.reals.product(a, b, 2 * self.bits())
    }

    /// A component seen along the viewing ray, times the gain.
    #[inline(always)]
    fn shear(
        &self,
        projected: &ProjectedWords<W>,
        axis: usize,
        across: Real<W>,
        z: Real<W>,
    ) -> Real<W> {
        let (reals, bits) = (self.reals, self.bits());
        let along = self.product(reals.opposite(projected.ratio[axis]), z);
        let sheared = reals.sum([reals.term(across), along], bits);
        reals.multiply(sheared, projected.gain[axis], bits)
    }

    /// `distance::enlarge` of columns, and `distance::dim` of a weight.
    #[inline(always)]
    fn enlarge(
        &self,
        columns: &mut [[Real<W>; 2]; 3],
        weight: Real<W>,
        projected: &ProjectedWords<W>,
    ) -> Real<W> {
        let (lanes, reals, bits) = (self.lanes, self.reals, self.bits());
        let [across, down] = projected.gain;
        let gain = Real(lanes.double_min(across.0, down.0));
        let distance = reals.multiply(reals.number(self.rules.spacing), gain, bits);
        let one = reals.constant(1.0);
        let far = lanes.double_greater(one, distance.0);
        self.doubt_unless_near(distance);
        // A column times 1 is the column, which has been rounded to as many bits.
        let factor = reals.reciprocal(distance, bits);
        let factor = Real(lanes.select(one, factor.0, far));
        for part in columns.iter_mut().flatten() {
            *part = reals.multiply(*part, factor, bits);
        }
        if self.rules.normalised {
            return weight;
        }
        let inverse = reals.reciprocal(factor, bits);
        let dimmed = reals.multiply(reals.multiply(weight, inverse, bits), inverse, bits);
        Real(lanes.select(weight.0, dimmed.0, far))
    }

    /// The variance of two or three columns, whose minors have these squares.
    #[inline(always)]
    pub fn variance(&self, columns: &[[Real<W>; 2]], minors: &[Term<W>]) -> Variance<W> {
        let (reals, bits) = (self.reals, self.bits());
        let h = reals.number(self.rules.low_pass);
        let [mut square_x, mut square_y, mut mixed] = [[reals.term(h); 4]; 3];
        for (k, [x, y]) in columns.iter().enumerate() {
            square_x[k] = self.product(*x, *x);
            square_y[k] = self.product(*y, *y);
            mixed[k] = self.product(*x, *y);
        }
        let count = columns.len();
        let xx = reals.sum(&square_x[..=count], bits);
        let yy_sharp = reals.sum(&square_y[..count], bits);
        let xy = reals.sum(&mixed[..count], bits);
        let yy = reals.sum([reals.term(yy_sharp), reals.term(h)], bits);
        let trace = reals.sum([reals.term(xx), reals.term(yy_sharp)], bits);
        let mut terms = [reals.product(h, trace, 31 + bits); 4];
        terms[..minors.len()].copy_from_slice(minors);
        let determinant = reals.sum(&terms[..=minors.len()], bits);
        self.doubt_unless_large([xx, yy, determinant]);
        Variance {
            xx,
            xy,
            yy,
            determinant,
        }
    }

    /// A 2x2 minor.
    #[inline(always)]
    pub fn minor(&self, j: &[Real<W>; 2], k: &[Real<W>; 2]) -> Real<W> {
        let (reals, bits) = (self.reals, self.bits());
        let crossed = self.product(reals.opposite(j[1]), k[0]);
        reals.sum([self.product(j[0], k[1]), crossed], bits)
    }

    /// The square of a 2x2 minor.
    #[inline(always)]
    fn minor_squared(&self, j: &[Real<W>; 2], k: &[Real<W>; 2]) -> Term<W> {
        let minor = self.minor(j, k);
        self.product(minor, minor)
    }

    /// The factors of the LDL form, in the order of `Ldl`. A variance of 0 is in doubt, so that no reciprocal lacks.
    #[inline(always)]
    pub fn ldl(
        &self,
        variance: &Variance<W>,
        inverse: Real<W>,
        culled: &mut Word<W>,
    ) -> [Real<W>; 4] {
        let (reals, bits) = (self.reals, self.bits());
        let vertical = reals.reciprocal(variance.yy, bits);
        let horizontal = reals.multiply(variance.yy, inverse, bits);
        let squared_width = reals.multiply(variance.determinant, vertical, bits);
        let shear = reals.multiply(variance.xy, vertical, bits);
        let exponents = [
            reals.exponent(horizontal, bits),
            reals.exponent(squared_width, bits),
            reals.exponent(vertical, bits),
        ];
        self.unpackable(exponents, culled);
        [horizontal, squared_width, shear, vertical]
    }

    /// The factors as mantissas and exponents.
    #[inline(always)]
    pub fn packed(
        &self,
        [horizontal, squared_width, shear, vertical]: [Real<W>; 4],
    ) -> [Number<W>; 4] {
        let (lanes, reals, bits) = (self.lanes, self.reals, self.bits());
        let zero = lanes.splat(0);
        let shear = reals.parts(shear, bits);
        let tiny = lanes.greater(lanes.splat(-512), shear.exponent);
        let shear = Number {
            mantissa: lanes.select(shear.mantissa, zero, tiny),
            exponent: lanes.select(shear.exponent, zero, tiny),
        };
        [
            reals.parts(horizontal, bits),
            reals.parts(squared_width, bits),
            shear,
            reals.parts(vertical, bits),
        ]
    }

    /// Mantissas and exponent of the conic.
    #[inline(always)]
    pub fn conic(
        &self,
        variance: &Variance<W>,
        horizontal: Real<W>,
        inverse: Real<W>,
        culled: &mut Word<W>,
    ) -> [Word<W>; 4] {
        let (lanes, reals, bits) = (self.lanes, self.reals, self.bits());
        let coefficients = [
            horizontal,
            reals.opposite(reals.multiply(variance.xy, inverse, bits)),
            reals.multiply(variance.xx, inverse, bits),
        ];
        let mut largest = lanes.splat(0);
        for coefficient in coefficients {
            let magnitude = reals.magnitude(coefficient).0;
            largest = lanes.double_max(largest, magnitude);
        }
        let exponent = reals.exponent(Real(largest), bits);
        let unit = reals.power(lanes.negate(exponent));
        let mut conic = [exponent; 4];
        for (mantissa, coefficient) in conic.iter_mut().zip(coefficients) {
            let aligned = reals.times(coefficient, unit);
            *mantissa = reals.to_short_word(reals.to_fixed(aligned, 1.0));
        }
        self.unpackable([exponent], culled);
        conic
    }

    #[inline(always)]
    fn compensate(&self, weight: Real<W>, minors: [Term<W>; 3], inverse: Real<W>) -> Real<W> {
        let (reals, bits) = (self.reals, self.bits());
        let sharp = reals.sum(minors, bits);
        self.doubt_unless_large([sharp]);
        let kept = reals.multiply(sharp, inverse, bits);
        reals.multiply(weight, reals.square_root(kept, bits), bits)
    }

    #[inline(always)]
    fn peak(&self, weight: Real<W>, projected: &ProjectedWords<W>, inverse: Real<W>) -> Real<W> {
        let (reals, bits) = (self.reals, self.bits());
        let mut peak = weight;
        if self.rules.normalised {
            // A variance without an inverse is in doubt.
            let [x, y] = projected.ratio;
            let one = Real(reals.constant(1.0));
            let slant = [reals.term(one), self.product(x, x), self.product(y, y)];
            let slant = reals.sum(slant, bits);
            let density = reals.square_root(reals.multiply(slant, inverse, bits), bits);
            let area = reals.multiply(projected.gain[0], projected.gain[1], bits);
            peak = reals.multiply(weight, area, bits);
            peak = reals.multiply(peak, density, bits);
            let integral = reals.number(self.rules.kernel.inverse_integral());
            peak = reals.multiply(peak, integral, bits);
        }
        self.where_positive(weight, peak)
    }

    /// The number where the other is positive, else 0.
    #[inline(always)]
    pub fn where_positive(&self, other: Real<W>, number: Real<W>) -> Real<W> {
        let lanes = self.lanes;
        let zero = lanes.splat(0);
        let positive = lanes.double_greater(other.0, zero);
        Real(lanes.select(zero, number.0, positive))
    }

    #[inline(always)]
    pub fn cutoff(&self, peak: Real<W>, culled: &mut Word<W>) -> Word<W> {
        // As in the kernel's `cutoff`.
        const END: i64 = 15 << 28;
        let (lanes, end) = (self.lanes, self.rules.kernel.end());
        if let Cutoff::Radial(cutoff) = self.rules.cutoff {
            return lanes.splat(cutoff.min(end).into());
        }
        let least = (self.rules.alpha_min >> 1) as i64;
        let smallest = SoftFloat::from_wide(least, 1 - THRESHOLD as i32, 31);
        let below = ln(smallest).unwrap_or(i64::MAX >> 1);
        let bright = lanes.double_greater(peak.0, lanes.splat(0));
        self.cull_unless(culled, Cull::Transparent, bright);
        let cutoff = lanes.round(lanes.plus(self.reals.ln(peak), -below), 3);
        let nowhere = lanes.greater(lanes.splat(1), cutoff);
        self.cull(culled, Cull::Transparent, nowhere);
        lanes.max(lanes.min(cutoff, lanes.splat(END)), lanes.splat(0))
    }

    /// First and one past the last pixel on one axis.
    #[inline(always)]
    pub fn bounds(
        &self,
        axis: usize,
        centre: Word<W>,
        variance: Real<W>,
        cutoff: Word<W>,
        culled: &mut Word<W>,
    ) -> (Word<W>, Word<W>) {
        let (lanes, reals) = (self.lanes, self.reals);
        let cutoff = reals.scaled(reals.short(cutoff), 1.0 / power(28));
        let squared = reals.multiply(reals.narrow(cutoff, 16), variance, 16);
        let extent = reals.to_fixed(reals.square_root(squared, 16), power(32));
        let extent = reals.to_word(extent);
        let wider = lanes.add(extent, lanes.shr_by(extent, 10));
        let sample = lanes.shl_by(centre, 32 - i64::from(self.widths.subpixel));
        let sample = lanes.plus(sample, -(1 << 31));
        let low = lanes.sar_by(lanes.plus(lanes.sub(sample, wider), (1 << 32) - 1), 32);
        let high = lanes.plus(lanes.sar_by(lanes.add(sample, wider), 32), 1);
        let limit = lanes.splat(self.view.viewport[axis].into());
        let zero = lanes.splat(0);
        let low = lanes.min(lanes.max(low, zero), limit);
        let high = lanes.min(lanes.max(high, zero), limit);
        self.cull(
            culled,
            Cull::Outside,
            lanes.greater(lanes.plus(low, 1), high),
        );
        (low, high)
    }

    #[inline(always)]
    pub fn peak_fixed(&self, peak: Real<W>, culled: &mut Word<W>) -> Word<W> {
        let (lanes, reals) = (self.lanes, self.reals);
        let fraction = u32::from(self.widths.peak);
        let largest = reals.constant(((16i64 << fraction.min(28)) - 1) as f64);
        let scaled = reals.scaled(peak, power(fraction)).0;
        // The conversion rounds halves to even, as the kernel does here; what the limit cuts off is cut off after
        // rounding as well.
        let fixed = reals.to_short_word(lanes.double_min(scaled, largest));
        let fixed = lanes.max(fixed, lanes.splat(0));
        let dark = lanes.greater(lanes.splat(1), fixed);
        self.cull(culled, Cull::Transparent, dark);
        fixed
    }
}
