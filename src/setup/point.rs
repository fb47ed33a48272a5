//! Point or splat, and setup of points (\[HYBRID\] 2 and 4).
//!
//! A sample whose neighbours lie less than a pixel away (s g < 1, the condition of \[SWAN\] 4.3) is minified: it
//! becomes a point and is gathered by a circular filter, the same for all points. The others are magnified and stay
//! splats.
//!
//! The filter is the footprint that a spherical splat has at the distance k where the choice changes, so that nothing
//! pops there: its variance is (deviation / s)^2 square pixels. A point costs a projection and three multiplications:
//! no axes, no Jacobian, no determinant, no reciprocal of a shape.

use super::covariance::Covariance2d;
use super::distance;
use super::project::project;
use super::{Cull, bounding_box, colour, conic, ldl, opacity_fixed};
use crate::footprint::{Conic, Footprint, Ldl, depth};
use crate::format::{Design, Widths};
use crate::math::{SoftFloat, reciprocal};
use crate::rules::{Cutoff, Rules};
use crate::splat::VolumeSplat;
use crate::view::{Pose, View};

/// The circular filter by which pixels gather points. Constant for a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PointFilter {
    covariance: Covariance2d,
    ldl: Ldl,
    conic: Conic,
    cutoff: u32,
    /// 1 / (pi I v): the peak of a normalised filter.
    peak: SoftFloat,
    /// s^2, for peak opacities: a point covers (s g)^2 of a pixel.
    spacing: SoftFloat,
}

impl PointFilter {
    /// The filter for samples of standard deviation `deviation` (scene units) at the rules' spacing.
    ///
    /// `None` if the rules have no spacing or the filter no area.
    pub fn new(widths: &Widths, rules: &Rules, deviation: SoftFloat) -> Option<PointFilter> {
        let bits = u32::from(widths.mantissa);
        let pixels = deviation.multiply(reciprocal(rules.spacing, bits)?, bits);
        let area = pixels.multiply(pixels, bits);
        let covariance = Covariance2d {
            xx: area,
            xy: SoftFloat::ZERO,
            yy: area,
            determinant: area.multiply(area, bits),
        };
        let ldl = ldl(widths, &covariance)?;
        let Cutoff::Radial(_) = rules.cutoff else {
            return None;
        };
        Some(PointFilter {
            covariance,
            conic: conic(widths, &covariance, ldl.horizontal)?,
            cutoff: rules.end(),
            peak: ldl
                .horizontal
                .multiply(rules.kernel.inverse_integral(), bits),
            spacing: rules.spacing,
            ldl,
        })
    }
}

/// Is the sample at `splat` minified, so that it becomes a point? Culled splats are not.
pub fn is_minified<P: Pose>(
    widths: &Widths,
    view: &View<P>,
    rules: &Rules,
    splat: &VolumeSplat<P::Centre>,
) -> bool {
    project(widths, view, rules, &splat.centre)
        .is_ok_and(|projected| distance::enlargement(widths, rules, &projected).is_some())
}

/// Setup of a point: its footprint is the filter's. Total: defined for every bit pattern.
pub fn setup_point<D: Design, P: Pose>(
    design: D,
    view: &View<P>,
    rules: &Rules,
    splat: &VolumeSplat<P::Centre>,
    filter: &PointFilter,
) -> Result<Footprint, Cull> {
    let widths = design.widths();
    let bits = u32::from(widths.mantissa);
    let projected = project(&widths, view, rules, &splat.centre)?;
    if splat.weight.mantissa <= 0 {
        return Err(Cull::Transparent);
    }
    let gain = projected.gain[0].multiply(projected.gain[1], bits);
    let share = if rules.normalised {
        filter.peak
    } else {
        filter.spacing.multiply(filter.spacing, bits)
    };
    let peak = splat.weight.multiply(gain, bits).multiply(share, bits);
    let (first, last) = bounding_box(
        &widths,
        view,
        projected.centre,
        &filter.covariance,
        filter.cutoff,
    )?;
    Ok(Footprint {
        depth: depth::key(projected.depth),
        centre: projected.centre,
        first,
        end: last,
        ldl: filter.ldl,
        conic: filter.conic,
        cutoff: filter.cutoff,
        opacity: opacity_fixed(peak, widths.peak.into()).ok_or(Cull::Transparent)?,
        colour: colour(&widths, splat.colour),
    })
}
