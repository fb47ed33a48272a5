//! The exact ellipse of a projected sphere (\[HYBRID\] 4.2 and appendix A), and its approximation.
//!
//! A spherical kernel of standard deviation s ends at the radius R = s sqrt(c). The rays that touch that sphere form a
//! cone with sin a = R/|C| around its centre C = (x, y, z). With (u, v) = (x/z, y/z), e = (R/z)^2, g = 1 - e and
//! L = 1 + u^2 + v^2 = |C|^2/z^2 the cone meets the image plane in the ellipse with
//!
//! ```text
//! centre       (u, v) / g                      pushed outwards from the projected centre
//! minor axis   sqrt(e / g)                     across the direction to the principal point
//! major axis   sqrt(e (L - e)) / g             along it
//! ```
//!
//! In the form of a covariance, with r = c / (1 - e/L) on the outline, that is
//!
//! ```text
//! V = (s/z)^2 (1 - e/L) / g  ( I + (u, v)^T (u, v) / g )
//! ```
//!
//! where nothing cancels but 1 - e. The perspective-correct index ([`kernel`](crate::kernel), spread s^2/|C|^2) brings
//! r back to c there and is exact along both axes' directions for a sphere in the middle of the picture. The
//! approximate ellipse is the limit e -> 0, V = (s/z)^2 (I + (u, v)^T (u, v)) around the projected centre: \[EWA\]'s
//! affine footprint.
//!
//! Through a Gaussian ball the integral along a ray is weight / (2 pi s^2) exp(-d^2 / 2 s^2), whatever the ray's
//! direction: normalised kernels need no Jacobian's determinant here.

use super::covariance::Covariance2d;
use super::project::Projected;
use super::{Cull, bounding_box, colour, conic, cutoff, ldl, opacity_fixed, project};
use crate::footprint::{Footprint, depth};
use crate::format::{Design, Widths};
use crate::kernel::covering_cutoff;
use crate::math::{SoftFloat, reciprocal, sum_of_products};
use crate::rules::Rules;
use crate::splat::SphereSplat;
use crate::view::{Pose, Projection, View};

/// Which ellipse a projected sphere gets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ellipse {
    /// From the tangent cone.
    Exact,
    /// First order in the sphere's radius over its depth.
    Approximate,
}

/// How a pixel's place within the ellipse becomes a radial index.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Index {
    /// In proportion to the ellipse's radius, as every affine footprint does.
    Affine,
    /// By the distance of the ray from the centre, as in the middle of the picture (\[HYBRID\] 4.2).
    Perspective,
    /// By the distance of the pixel's own ray from the centre: exact anywhere, whatever the ellipse
    /// ([`Rays`](crate::kernel::Rays)).
    Ray,
}

/// A footprint with the spread that its index is to be corrected by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SphereFootprint {
    /// The ellipse; its cut-off is that of the uncorrected index.
    pub footprint: Footprint,
    /// s^2 / |C|^2, UQ0.32; 0 asks for no correction (orthographic views).
    pub spread: u32,
    /// L = |C|^2/z^2 where the index follows each pixel's ray.
    pub slant: Option<SoftFloat>,
    /// Corrected radial index at which the footprint ends, UQ4.28.
    pub end: u32,
}

/// Largest cut-off of the uncorrected index, UQ4.28. A sphere seen under more than 118 degrees ends early there.
const LARGEST_CUTOFF: u32 = 15 << 28;

/// Setup of a spherical kernel. Total: defined for every bit pattern. The eye inside the sphere's end culls as `Near`.
///
/// The low-pass filter of the rules is added to V as for every footprint; the outline is exact without it.
pub fn setup_sphere<D: Design, P: Pose>(
    design: D,
    view: &View<P>,
    rules: &Rules,
    splat: &SphereSplat<P::Centre>,
    (ellipse, index): (Ellipse, Index),
) -> Result<SphereFootprint, Cull> {
    let widths = design.widths();
    let bits = u32::from(widths.mantissa);
    let projected = project(&widths, view, rules, &splat.centre)?;
    let peak = ball_opacity(&widths, rules, splat);
    let end = cutoff(rules, peak).ok_or(Cull::Transparent)?;
    let cone =
        Cone::new(&widths, view, &projected, splat, end, (ellipse, index)).ok_or(Cull::Near)?;
    let covariance = cone.covariance(bits, projected.gain, splat.deviation, rules.low_pass);
    let ldl = ldl(&widths, &covariance).ok_or(Cull::Degenerate)?;
    let conic = conic(&widths, &covariance, ldl.horizontal).ok_or(Cull::Degenerate)?;
    let centre = cone.centre(&widths, view, &projected);
    let (first, last) = bounding_box(&widths, view, centre, &covariance, cone.cutoff)?;
    let footprint = Footprint {
        depth: depth::key(projected.depth),
        centre,
        first,
        end: last,
        ldl,
        conic,
        cutoff: cone.cutoff,
        opacity: opacity_fixed(peak, widths.peak.into()).ok_or(Cull::Transparent)?,
        colour: colour(&widths, splat.colour),
    };
    Ok(SphereFootprint {
        footprint,
        spread: cone.spread,
        slant: cone.slant,
        end,
    })
}

/// weight / (pi I s^2) for normalised kernels, else the weight.
fn ball_opacity<C>(widths: &Widths, rules: &Rules, splat: &SphereSplat<C>) -> SoftFloat {
    let bits = u32::from(widths.mantissa);
    if splat.weight.mantissa <= 0 {
        return SoftFloat::ZERO;
    }
    if !rules.normalised {
        return splat.weight;
    }
    let area = splat.deviation.multiply(splat.deviation, bits);
    let inverse = reciprocal(area, bits).unwrap_or(SoftFloat::ZERO);
    splat
        .weight
        .multiply(inverse, bits)
        .multiply(rules.kernel.inverse_integral(), bits)
}

/// The tangent cone in the terms of the module's head.
struct Cone {
    /// (u, v).
    ratio: [SoftFloat; 2],
    /// 1/g, and (1 - e/L) / g; without the correction 1/g, so that r = c lies on the outline.
    inverse: SoftFloat,
    shrink: SoftFloat,
    /// c / (1 - e/L), UQ4.28.
    cutoff: u32,
    /// (s/z)^2 / L, UQ0.32.
    spread: u32,
    /// L, where the index follows each pixel's ray.
    slant: Option<SoftFloat>,
}

const ONE: SoftFloat = SoftFloat {
    mantissa: 1 << 30,
    exponent: -30,
};

impl Cone {
    /// `None` where the sphere reaches the plane of the eye.
    fn new<P, C>(
        widths: &Widths,
        view: &View<P>,
        projected: &Projected,
        splat: &SphereSplat<C>,
        end: u32,
        (ellipse, index): (Ellipse, Index),
    ) -> Option<Cone> {
        let bits = u32::from(widths.view);
        let flat = Cone {
            ratio: projected.ratio,
            inverse: ONE,
            shrink: ONE,
            cutoff: end,
            spread: 0,
            slant: None,
        };
        if view.projection == Projection::Orthographic {
            return Some(flat);
        }
        let [u, v] = projected.ratio;
        let slant = sum_of_products([ONE.times(ONE), u.times(u), v.times(v)], bits);
        // s/z = s g / f: the gain is f/z with the mantissa's bits.
        let depth = reciprocal(view.focal[0], bits)?.multiply(projected.gain[0], bits);
        let angle = splat.deviation.multiply(depth, bits);
        let spread = angle.multiply(angle, bits);
        let limit = spread.multiply(SoftFloat::from_wide(end.into(), -28, 31), bits); // e
        let rest = sum_of_products([ONE.times(ONE), limit.times(ONE).negated()], bits); // g
        if rest.mantissa <= 0 {
            return None;
        }
        let inverse_slant = reciprocal(slant, bits)?;
        let cosine = sum_of_products([ONE.times(ONE), limit.times(inverse_slant).negated()], bits);
        let cutoff = SoftFloat::from_wide(end.into(), -28, bits)
            .multiply(reciprocal(cosine, bits)?, bits)
            .to_fixed(28)
            .clamp(0, LARGEST_CUTOFF.into()) as u32;
        let spread = spread
            .multiply(inverse_slant, bits)
            .to_fixed(32)
            .clamp(0, u32::MAX.into()) as u32;
        if index == Index::Ray {
            let aside = sum_of_products([u.times(u), v.times(v)], bits);
            return Some(Cone {
                cutoff: covering_cutoff(end, aside, limit, rest, bits),
                slant: Some(slant),
                ..flat
            });
        }
        let rim = match index {
            Index::Affine | Index::Ray => flat,
            Index::Perspective => Cone {
                cutoff,
                spread,
                shrink: cosine,
                ..flat
            },
        };
        match ellipse {
            Ellipse::Approximate => Some(Cone { shrink: ONE, ..rim }),
            Ellipse::Exact => {
                let inverse = reciprocal(rest, bits)?;
                let shrink = rim.shrink.multiply(inverse, bits);
                Some(Cone {
                    inverse,
                    shrink,
                    ..rim
                })
            }
        }
    }

    /// V in square pixels with its determinant k^2 (1 + |(u, v)|^2 / g) and the low-pass added by Cauchy-Binet.
    fn covariance(
        &self,
        bits: u32,
        gain: [SoftFloat; 2],
        deviation: SoftFloat,
        low_pass: SoftFloat,
    ) -> Covariance2d {
        let [u, v] = self.ratio;
        let radius = gain.map(|gain| gain.multiply(deviation, bits));
        let stretch = |a: SoftFloat, b: SoftFloat| a.multiply(b, bits).times(self.inverse);
        let plain = |value: SoftFloat| value.times(ONE);
        let along = |i: usize, ratio: SoftFloat| {
            let form = sum_of_products([plain(ONE), stretch(ratio, ratio)], bits);
            let area = radius[i].multiply(radius[i], bits);
            area.multiply(self.shrink, bits).multiply(form, bits)
        };
        let area = radius[0]
            .multiply(radius[1], bits)
            .multiply(self.shrink, bits);
        let (sharp_x, sharp_y) = (along(0, u), along(1, v));
        let xy = area.multiply(stretch(u, v).normalise(bits), bits);
        let form = sum_of_products([plain(ONE), stretch(u, u), stretch(v, v)], bits);
        let xx = sum_of_products([plain(sharp_x), plain(low_pass)], bits);
        let yy = sum_of_products([plain(sharp_y), plain(low_pass)], bits);
        let sharp = area.multiply(area, bits).times(form);
        let trace = sum_of_products([plain(xx), plain(sharp_y)], bits);
        let determinant = sum_of_products([sharp, low_pass.times(trace)], bits);
        Covariance2d {
            xx,
            xy,
            yy,
            determinant,
        }
    }

    /// The ellipse's centre in Q27.subpixel: the projected centre moved outwards by (u, v) f (1/g - 1).
    fn centre<P>(&self, widths: &Widths, view: &View<P>, projected: &Projected) -> [i64; 2] {
        let bits = u32::from(widths.view);
        let push = sum_of_products([self.inverse.times(ONE), ONE.times(ONE).negated()], bits);
        let mut centre = projected.centre;
        for (axis, value) in centre.iter_mut().enumerate() {
            let shift = view.focal[axis]
                .multiply(self.ratio[axis], bits)
                .times(push)
                .to_fixed(widths.subpixel.into());
            *value = value.saturating_add(shift).clamp(-LIMIT, LIMIT);
        }
        centre
    }
}

/// Centres stay within the packet's 52 bits.
const LIMIT: i64 = 1 << 50;
