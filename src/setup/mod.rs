//! Splat setup: from a splat in the scene to a footprint on the screen, in integers only.
//!
//! ```text
//! splat -> project -> jacobian -> covariance -> shape, opacity -> footprint
//!       -> harmonics (optional) -> colour -----------------^
//! ```
//!
//! Each unit is one file with its equation at its head. Positions are fixed point; everything after the
//! reciprocal of the depth is block floating point with the design's mantissa.

pub mod distance;
pub mod harmonics;

mod colour;
mod covariance;
mod jacobian;
mod opacity;
mod point;
mod project;
mod shape;
mod sphere;
mod surface;
#[cfg(test)]
pub(crate) mod tests;

pub use colour::colour;
pub use covariance::{Covariance2d, covariance, sharp_determinant};
pub use jacobian::{ScreenAxis, axis_bits, project_axes};
pub use opacity::{centre_opacity, compensate, cutoff, opacity_fixed};
pub use point::{PointFilter, is_minified, setup_point};
pub use project::{Projected, depth_of, project};
pub use shape::{conic, ldl};
pub use sphere::{Ellipse, Index, SphereFootprint, setup_sphere};
pub use surface::{depth_gradient, setup_surface, surface_opacity};

use crate::footprint::{Conic, Footprint, Ldl, depth};
use crate::format::{Design, Widths};
use crate::math::{SoftFloat, square_root};
use crate::rules::Rules;
use crate::splat::VolumeSplat;
use crate::view::{Pose, View};

/// Why a splat has no footprint. Every culled splat has exactly one reason, the first that applies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Cull {
    /// z <= near.
    Near,
    /// z >= far.
    Far,
    /// The centre is more than 2^26 pixels away from the origin of the screen, or the footprint reaches more than
    /// 2^28 pixels to a side.
    Range,
    /// The footprint has no area, or one beyond the packet's exponents (only without a low-pass filter).
    Degenerate,
    /// The opacity is below what the rules ever draw.
    Transparent,
    /// The bounding box does not touch the viewport.
    Outside,
}

impl Cull {
    /// All reasons, in the order in which they are tested.
    pub const ALL: [Cull; 6] = [
        Cull::Near,
        Cull::Far,
        Cull::Range,
        Cull::Degenerate,
        Cull::Transparent,
        Cull::Outside,
    ];

    /// Its place in [`Cull::ALL`].
    #[inline(always)]
    pub const fn place(self) -> usize {
        self as usize
    }
}

const _: () = {
    let mut place = 0;
    while place < Cull::ALL.len() {
        assert!(Cull::ALL[place].place() == place);
        place += 1;
    }
};

/// The whole of setup for one volume splat (\[EWA\] 6.2 and 7.1).
///
/// Total: defined for every bit pattern of its inputs.
pub fn setup<D: Design, P: Pose>(
    design: D,
    view: &View<P>,
    rules: &Rules,
    splat: &VolumeSplat<P::Centre>,
) -> Result<Footprint, Cull> {
    footprint(design, view, rules, splat, |widths, covariance, ldl| {
        conic(widths, covariance, ldl.horizontal)
    })
}

/// Setup for a small image that only traverses by `spans`: the same footprint with a conic of zeros.
///
/// A splat whose conic has no place in the packet is not culled for it.
pub fn setup_for_spans<D: Design, P: Pose>(
    design: D,
    view: &View<P>,
    rules: &Rules,
    splat: &VolumeSplat<P::Centre>,
) -> Result<Footprint, Cull> {
    footprint(design, view, rules, splat, |_, _, _| Some(Conic::default()))
}

#[inline(always)]
fn footprint<D: Design, P: Pose>(
    design: D,
    view: &View<P>,
    rules: &Rules,
    splat: &VolumeSplat<P::Centre>,
    conic: impl Fn(&Widths, &Covariance2d, &Ldl) -> Option<Conic>,
) -> Result<Footprint, Cull> {
    let widths = design.widths();
    let projected = project(&widths, view, rules, &splat.centre)?;
    let mut columns = project_axes(&widths, &view.rotation, &projected, &splat.axes);
    let mut weight = splat.weight;
    if let Some(factor) = distance::enlargement(&widths, rules, &projected) {
        columns = distance::enlarge(&widths, columns, factor);
        weight = distance::dim(&widths, rules, weight, factor);
    }
    let covariance = covariance(&widths, rules.low_pass, &columns);
    let ldl = ldl(&widths, &covariance).ok_or(Cull::Degenerate)?;
    let conic = conic(&widths, &covariance, &ldl).ok_or(Cull::Degenerate)?;
    if rules.compensated {
        weight = compensate(&widths, weight, &columns, &covariance);
    }
    let peak = centre_opacity(&widths, rules, weight, &projected, &covariance);
    let cutoff = cutoff(rules, peak).ok_or(Cull::Transparent)?;
    let (first, last) = bounding_box(&widths, view, projected.centre, &covariance, cutoff)?;
    let colour = colour(&widths, splat.colour);
    let peak = opacity_fixed(peak, widths.peak.into()).ok_or(Cull::Transparent)?;
    Ok(Footprint {
        depth: depth::key(projected.depth),
        centre: projected.centre,
        first,
        end: last,
        ldl,
        conic,
        cutoff,
        opacity: peak,
        colour,
    })
}

/// Half-extents sqrt(c Vxx), sqrt(c Vyy) around the centre: the pixels whose sample points lie within, clipped to the
/// viewport.
///
/// Extents are taken 2^-10 larger, relatively, than the root unit's 16-bit result, so that no pixel is missed.
fn bounding_box<P>(
    widths: &Widths,
    view: &View<P>,
    centre: [i64; 2],
    covariance: &Covariance2d,
    cutoff: u32,
) -> Result<([u16; 2], [u16; 2]), Cull> {
    let [subpixel, bits] = [widths.subpixel, widths.mantissa].map(u32::from);
    let cutoff = SoftFloat::from_wide(cutoff.into(), -28, 16);
    let mut first = [0; 2];
    let mut last = [0; 2];
    for (axis, spread) in [covariance.xx, covariance.yy].into_iter().enumerate() {
        let squared = cutoff.times_within(spread, 16 + bits).normalise(16);
        let extent = square_root(squared, 16).to_fixed(32);
        // What leaves the word is negative, and so out of range too. What remains is far from the word's ends, and
        // upper words say it all.
        let extent = extent.wrapping_add(extent >> 10);
        if extent >> (32 + 28) != 0 {
            return Err(Cull::Range);
        }
        let sample = (centre[axis] << (32 - subpixel)).wrapping_sub(1 << 31);
        let low = (sample.wrapping_sub(extent).wrapping_add((1 << 32) - 1) >> 32) as i32;
        let high = (sample.wrapping_add(extent) >> 32) as i32 + 1;
        let limit = i32::from(view.viewport[axis]);
        let (low, high) = (low.clamp(0, limit), high.clamp(0, limit));
        if low >= high {
            return Err(Cull::Outside);
        }
        first[axis] = low as u16;
        last[axis] = high as u16;
    }
    Ok((first, last))
}
