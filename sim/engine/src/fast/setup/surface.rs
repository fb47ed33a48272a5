//! Setup of many surface splats at once, bit for bit the kernel's [`setup_surface`].
//!
//! The stages of volume splats with two axes instead of three, the normal in the third one's place; and what surfaces
//! add: the weight at the centre, the tangent plane's depth, the normal towards the eye. Colours are numbers of one
//! splat each and stay so.

use super::number::{Arithmetic, BitDrop, power};
use super::real::Real;
use super::stages::{ProjectedWords, SplatLanes, Stages, Variance};
use super::{Batched, Lists, SplatFields};
use crate::fast::lanes::Lanes;
use splatline::footprint::surface::{
    Attributes, DEPTH_FRACTION, Plane, SurfaceFootprint, attribute_fraction,
};
use splatline::format::{RuntimeWidths, Widths};
use splatline::rules::Rules;
use splatline::setup::{Cull, setup_surface};
use splatline::splat::surface::SurfaceSplat;
use splatline::view::View;

/// The depth lane's units in one.
const DEPTH_UNIT: f64 = (1u64 << DEPTH_FRACTION) as f64;

/// What setup makes of a surface splat.
pub type SurfaceOutcome = Result<SurfaceFootprint, Cull>;

impl Batched for SurfaceSplat {
    type Outcome = SurfaceOutcome;
    type Lists = SurfaceLists;

    fn set_up_alone(&self, design: RuntimeWidths, view: &View, rules: &Rules) -> SurfaceOutcome {
        setup_surface(design, view, rules, self)
    }

    #[inline(always)]
    fn parts(&self) -> SplatFields {
        let [first, second] = self.frame;
        SplatFields {
            centre: self.centre,
            axes: [first, second, self.normal],
            weight: self.weight,
        }
    }

    #[inline(always)]
    fn set_up_together<L: Lanes>(stages: &Stages<L>, words: &SplatLanes<L>) -> SurfaceLists {
        stages.surface(words)
    }

    #[inline(always)]
    fn write(
        &self,
        lists: &SurfaceLists,
        k: usize,
        widths: &Widths,
        to: &mut SurfaceOutcome,
    ) -> bool {
        let certain = !lists.footprints.is_in_doubt(k);
        if certain {
            *to = lists.outcome(k, self, widths);
        }
        certain
    }
}

/// A vector's surface footprints, without their colours, as lists.
pub struct SurfaceLists {
    footprints: Lists,
    /// Depth at the centre, and what leads from there to the box's first sample point.
    origin: [[i64; 8]; 3],
    step: [[i64; 8]; 2],
    normal: [[i64; 8]; 3],
    /// 1 where the normal was turned.
    back: [i64; 8],
}

impl<W: Lanes> Stages<'_, W> {
    /// `splatline::setup::setup_surface`.
    #[inline(always)]
    fn surface(&self, splats: &SplatLanes<W>) -> SurfaceLists {
        let (lanes, reals) = (self.lanes, self.reals);
        let mut culled = lanes.splat(0);
        self.doubt_inputs(splats);
        let projected = self.project(splats, &mut culled);
        let (first, z1) = self.column(splats, 0, &projected);
        let (second, z2) = self.column(splats, 1, &projected);
        let area = self.minor(&first, &second);
        let variance = self.variance(&[first, second], &[self.product(area, area)]);
        let inverse = reals.reciprocal(variance.determinant, self.bits());
        let ldl = self.ldl(&variance, inverse, &mut culled);
        let conic = self.conic(&variance, ldl[0], inverse, &mut culled);
        let peak = self.surface_peak(reals.of_parts(splats.weight), area, &variance);
        let cutoff = self.cutoff(peak, &mut culled);
        let peak = self.peak_fixed(peak, &mut culled);
        let [u, v] = projected.centre;
        let (left, right) = self.bounds(0, u, variance.xx, cutoff, &mut culled);
        let (top, bottom) = self.bounds(1, v, variance.yy, cutoff, &mut culled);
        // The kernel knows no more reasons.
        let gradient = [
            self.slope(
                area,
                inverse,
                [second[1], first[1]],
                [first[0], second[0]],
                [z1, z2],
            ),
            self.slope(
                area,
                inverse,
                [first[0], second[0]],
                [second[1], first[1]],
                [z2, z1],
            ),
        ];
        let depth = lanes.to_fixed(projected.depth, DEPTH_FRACTION);
        let across = self.rise(left, u, gradient[0]);
        let down = self.rise(top, v, gradient[1]);
        let ([x, y, z], back) = self.facing_normal(splats, &projected);
        let step = [
            reals.to_word(reals.to_fixed(gradient[0], DEPTH_UNIT)),
            reals.to_word(reals.to_fixed(gradient[1], DEPTH_UNIT)),
        ];
        let bounds = [left, top, right, bottom];
        SurfaceLists {
            footprints: self.lists(&projected, bounds, ldl, conic, [cutoff, peak, culled]),
            origin: [lanes.list(depth), lanes.list(across), lanes.list(down)],
            step: [lanes.list(step[0]), lanes.list(step[1])],
            normal: [lanes.list(x), lanes.list(y), lanes.list(z)],
            back: lanes.list(back),
        }
    }

    /// `surface_peak`.
    #[inline(always)]
    fn surface_peak(&self, weight: Real<W>, area: Real<W>, variance: &Variance<W>) -> Real<W> {
        let (reals, bits) = (self.reals, self.bits());
        let root = reals.square_root(variance.determinant, bits);
        let inverse = reals.reciprocal(root, bits);
        let magnitude = reals.magnitude(area);
        let peak = reals.multiply(reals.multiply(weight, magnitude, bits), inverse, bits);
        self.where_positive(weight, peak)
    }

    /// One component of `depth_gradient`: area (s0 z0 - s1 z1) + h (f0 z0 + f1 z1) over the determinant.
    #[inline(always)]
    fn slope(
        &self,
        area: Real<W>,
        inverse: Real<W>,
        sharp: [Real<W>; 2],
        filtered: [Real<W>; 2],
        z: [Real<W>; 2],
    ) -> Real<W> {
        let (reals, bits) = (self.reals, self.bits());
        let crossed = self.product(reals.opposite(sharp[1]), z[1]);
        let sharp_sum = reals.sum([self.product(sharp[0], z[0]), crossed], bits);
        let terms = [
            self.product(filtered[0], z[0]),
            self.product(filtered[1], z[1]),
        ];
        let filtered_sum = reals.sum(terms, bits);
        let h = reals.number(self.rules.low_pass);
        let both = [
            self.product(area, sharp_sum),
            reals.product(h, filtered_sum, 31 + bits),
        ];
        reals.multiply(reals.sum(both, bits), inverse, bits)
    }

    /// What the plane rises from the centre to the sample point of a pixel.
    #[inline(always)]
    fn rise(&self, pixel: W::Word, centre: W::Word, slope: Real<W>) -> W::Word {
        let (lanes, reals) = (self.lanes, self.reals);
        let subpixel = i64::from(self.widths.subpixel);
        let sample = lanes.shl_by(lanes.plus(lanes.shl_by(pixel, 1), 1), subpixel - 1);
        let distance = reals.short(lanes.sub(sample, centre));
        let distance = reals.narrow(distance, self.bits());
        let distance = reals.scaled(distance, 1.0 / power(subpixel));
        reals.times_to_fixed(slope, distance, DEPTH_UNIT)
    }

    /// `facing_normal`: the third axis turned towards the eye, and 1 where that turned it around.
    #[inline(always)]
    fn facing_normal(
        &self,
        splats: &SplatLanes<W>,
        projected: &ProjectedWords<W>,
    ) -> ([W::Word; 3], W::Word) {
        let (lanes, reals) = (self.lanes, self.reals);
        let normal = self.turned(splats, 2);
        let [ratio_x, ratio_y] = projected.ratio;
        let terms = [
            self.product(normal[0], ratio_x),
            self.product(normal[1], ratio_y),
            reals.term(normal[2]),
        ];
        let away = reals.sum_is_positive(terms, self.bits());
        let one = power(attribute_fraction(&self.widths));
        let [limit, least] = [reals.constant(one), reals.constant(-one)];
        let mut facing = [lanes.splat(0); 3];
        for (facing, component) in facing.iter_mut().zip(normal) {
            let fixed = reals.to_fixed(component, one);
            let fixed = lanes.double_max(lanes.double_min(fixed, limit), least);
            let fixed = reals.to_short_word(fixed);
            *facing = lanes.select(fixed, lanes.negate(fixed), away);
        }
        (facing, lanes.select(lanes.splat(0), lanes.splat(1), away))
    }
}

impl SurfaceLists {
    /// What setup makes of splat `k`.
    #[inline(always)]
    fn outcome(&self, k: usize, splat: &SurfaceSplat, widths: &Widths) -> SurfaceOutcome {
        self.footprints.reason(k)?;
        let fraction = u32::from(attribute_fraction(widths));
        let one = 1u64 << fraction;
        let drops = [
            28 - fraction,
            fraction,
            fraction.saturating_sub(widths.colour.into()),
        ];
        let [to_unit, to_colour, to_footprint] = [
            BitDrop::new(drops[0], widths.rounding),
            BitDrop::new(drops[1], widths.rounding),
            BitDrop::new(drops[2], widths.rounding),
        ];
        let opacity = to_unit.of(splat.opacity.to_bits().into()).min(one);
        // Loops, because closures of arrays are calls here.
        let [mut colour, mut rounded] = [[0; 3]; 2];
        for (channel, value) in splat.colour.iter().enumerate() {
            let unit = to_unit.of(value.to_bits().into()).min(one);
            let product = to_colour.of(unit * opacity);
            colour[channel] = product as u32;
            rounded[channel] = to_footprint.of(product) as u32;
        }
        let [depth, across, down] = [0, 1, 2].map(|part| self.origin[part][k]);
        Ok(SurfaceFootprint {
            footprint: self.footprints.footprint(k, rounded),
            plane: Plane {
                origin: depth.saturating_add(across).saturating_add(down),
                step: [self.step[0][k], self.step[1][k]],
            },
            attributes: Attributes {
                colour,
                opacity: opacity as u32,
                normal: [0, 1, 2].map(|axis| self.normal[axis][k] as i32),
                material: splat.material,
            },
            back: self.back[k] != 0,
        })
    }
}
