//! Splats in ordinary numbers, and their way to the kernel's types.
//!
//! Fields are f32, as files hold them: a centre keeps all of its 24 bits. A rotation's matrix and the axes are computed
//! in f64 and rounded once, to 31 bits of an axis' largest component.

use super::{axis, colour, position, scaled};
use crate::footprint::Footprint;
use crate::footprint::surface::SurfaceFootprint;
use crate::format::Design;
use crate::front::{Primitive, Rejected};
use crate::rules::Rules;
use crate::setup::{setup, setup_surface};
use crate::splat::surface::SurfaceSplat;
use crate::splat::{Axis, SphereSplat, VolumeSplat};
use crate::view::{Eye, View};
use fixed::types::U4F28;

/// A 3D Gaussian: covariance `R diag(scales)^2 R^T` (\[EWA\] 6.2), R the rotation's matrix.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Gaussian {
    /// Mean, scene units.
    pub mean: [f32; 3],
    /// Quaternion (w, x, y, z) of any length but 0.
    pub rotation: [f32; 4],
    /// Standard deviations along the rotated axes, scene units; 0 is a flat one, the sign does not count.
    pub scales: [f32; 3],
    /// Opacity at the centre, 0 to 1 (rules `3dgs`; above 1 it acts where the Gaussian has fallen below 1, negative is
    /// 0), or extinction times volume in square scene units (normalised kernels, rules `ewa`).
    pub opacity: f32,
    /// Linear red, green, blue: 0 to 16, 1 is white; what lies beyond saturates.
    pub colour: [f32; 3],
}

/// A spherical kernel, as points of a cloud and samples of a volume have.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Point {
    /// Centre, scene units.
    pub position: [f32; 3],
    /// Standard deviation, scene units; the sign does not count.
    pub deviation: f32,
    /// Opacity, as [`Gaussian::opacity`].
    pub opacity: f32,
    /// Linear red, green, blue, as [`Gaussian::colour`].
    pub colour: [f32; 3],
}

/// A point of a surface: an elliptical Gaussian in its tangent plane (\[SURF\] 3.3).
///
/// ```
/// use splatline::Surfel;
///
/// let surfel = Surfel {
///     position: [0.0, 0.0, 2.0],
///     tangents: [[0.1, 0.0, 0.0], [0.0, 0.1, 0.0]], // Its normal is z.
///     weight: 0.4,
///     colour: [1.0, 0.5, 0.2],
///     opacity: 1.0,
///     material: 0,
/// };
/// assert!(surfel.splat().is_some());
/// let edge = Surfel { tangents: [[0.1, 0.0, 0.0]; 2], ..surfel }; // Spans no plane.
/// assert!(edge.splat().is_none());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Surfel {
    /// Centre, scene units.
    pub position: [f32; 3],
    /// The two axes in the tangent plane, each one standard deviation long, scene units; the normal is that of their
    /// plane.
    pub tangents: [[f32; 3]; 2],
    /// Height of the basis function at its centre. Where neighbours' functions sum to about 1, a pixel's weight sum is
    /// its coverage.
    pub weight: f32,
    /// Linear red, green, blue, not premultiplied, 0 to 1.
    pub colour: [f32; 3],
    /// Opacity of the surface, 0 to 1.
    pub opacity: f32,
    /// Row of the material table.
    pub material: u8,
}

impl Gaussian {
    /// White and opaque at the origin, standard deviation 1: for the fields that one does not state.
    pub const UNIT: Gaussian = Gaussian {
        mean: [0.0; 3],
        rotation: [1.0, 0.0, 0.0, 0.0],
        scales: [1.0; 3],
        opacity: 1.0,
        colour: [1.0; 3],
    };

    /// From the numbers that trainers store: logarithms of the scales, the logit of the opacity (infinite is opacity 0
    /// or 1 exactly) and the constant coefficient of the colour's spherical harmonics, colour = 0.5 + f_dc / (2
    /// sqrt(pi)), not below 0.
    ///
    /// ```
    /// use splatline::Gaussian;
    ///
    /// let (logit, grey) = (2.2, [0.0; 3]);
    /// let gaussian = Gaussian::from_trained([0.0, 1.0, 2.0], [1.0, 0.0, 0.0, 0.0], [-3.0; 3], logit, grey);
    /// assert!((gaussian.opacity - 0.9).abs() < 1e-3);
    /// assert_eq!(gaussian.colour, [0.5; 3]);
    /// ```
    pub fn from_trained(
        mean: [f32; 3],
        rotation: [f32; 4],
        log_scales: [f32; 3],
        opacity_logit: f32,
        f_dc: [f32; 3],
    ) -> Gaussian {
        const HARMONIC_0: f64 = 0.282_094_791_773_878_14;
        // An infinite logarithm is no scale at all, not scale 0.
        let scale = |log: f32| {
            if log.is_finite() {
                libm::exp(log.into()) as f32
            } else {
                f32::NAN
            }
        };
        Gaussian {
            mean,
            rotation,
            scales: log_scales.map(scale),
            opacity: (1.0 / (1.0 + libm::exp(-f64::from(opacity_logit)))) as f32,
            colour: f_dc.map(|f| (0.5 + HARMONIC_0 * f64::from(f)).max(0.0) as f32),
        }
    }

    /// The kernel's splat; `None` if a number is not finite, or the quaternion has length 0.
    pub fn splat(&self) -> Option<VolumeSplat> {
        let sound = is_finite(&self.mean)
            && is_finite(&self.scales)
            && is_finite(&self.colour)
            && self.opacity.is_finite();
        let [[xx, xy, xz], [yx, yy, yz], [zx, zy, zz]] = rotation_matrix(self.rotation)?;
        let [a, b, c] = self.scales.map(f64::from);
        sound.then(|| VolumeSplat {
            centre: position(self.mean.map(f64::from)),
            axes: [
                axis([xx * a, yx * a, zx * a]),
                axis([xy * b, yy * b, zy * b]),
                axis([xz * c, yz * c, zz * c]),
            ],
            weight: scaled(self.opacity.into()),
            colour: self.colour.map(|channel| colour(channel.into())),
        })
    }
}

impl Point {
    /// The kernel's splat, round: axes along those of the scene. `None` if a number is not finite.
    pub fn splat(&self) -> Option<VolumeSplat> {
        let sphere = self.sphere()?;
        let radius = f64::from(self.deviation.abs());
        Some(VolumeSplat {
            centre: sphere.centre,
            axes: [
                axis([radius, 0.0, 0.0]),
                axis([0.0, radius, 0.0]),
                axis([0.0, 0.0, radius]),
            ],
            weight: sphere.weight,
            colour: sphere.colour,
        })
    }

    /// The kernel's spherical splat, for which perspective can be exact (\[HYBRID\] 4.2). `None` if a number is not
    /// finite.
    pub fn sphere(&self) -> Option<SphereSplat> {
        let sound = is_finite(&self.position)
            && is_finite(&self.colour)
            && is_finite(&[self.deviation, self.opacity]);
        sound.then(|| SphereSplat {
            centre: position(self.position.map(f64::from)),
            deviation: scaled(self.deviation.abs().into()),
            weight: scaled(self.opacity.into()),
            colour: self.colour.map(|channel| colour(channel.into())),
        })
    }
}

impl Surfel {
    /// The kernel's surface splat; `None` if a number is not finite, or the tangents span no plane.
    pub fn splat(&self) -> Option<SurfaceSplat> {
        let [first, second] = self.tangents.map(|tangent| tangent.map(f64::from));
        let normal = unit_normal(first, second)?;
        let sound = is_finite(&self.position)
            && is_finite(&self.colour)
            && is_finite(&[self.weight, self.opacity]);
        sound.then(|| SurfaceSplat {
            centre: position(self.position.map(f64::from)),
            frame: [axis(first), axis(second)],
            normal,
            weight: scaled(self.weight.into()),
            colour: self.colour.map(unit_interval),
            opacity: unit_interval(self.opacity),
            material: self.material,
        })
    }
}

/// A channel of 0 to 1 in UQ4.28, rounded as [`colour`] is.
fn unit_interval(value: f32) -> U4F28 {
    colour(value.clamp(0.0, 1.0).into())
}

/// The plane's normal at length 1. Products of f32 neither overflow nor vanish in f64, but their squares may.
fn unit_normal([a, b, c]: [f64; 3], [x, y, z]: [f64; 3]) -> Option<Axis> {
    let normal = [b * z - c * y, c * x - a * z, a * y - b * x];
    let largest = normal.iter().fold(0.0f64, |m, value| m.max(value.abs()));
    if !normal.iter().all(|value| value.is_finite()) || largest == 0.0 {
        return None;
    }
    let [x, y, z] = normal.map(|value| value / largest);
    let length = libm::sqrt(x * x + y * y + z * z);
    Some(axis([x / length, y / length, z / length]))
}

/// Rotation matrix of a quaternion of any length, none if the length is 0 or not finite.
fn rotation_matrix(quaternion: [f32; 4]) -> Option<[[f64; 3]; 3]> {
    let [w, x, y, z] = quaternion.map(f64::from);
    let length = libm::sqrt(w * w + x * x + y * y + z * z);
    if length == 0.0 || !length.is_finite() {
        return None;
    }
    let [w, x, y, z] = [w / length, x / length, y / length, z / length];
    Some([
        [
            1.0 - 2.0 * (y * y + z * z),
            2.0 * (x * y - w * z),
            2.0 * (x * z + w * y),
        ],
        [
            2.0 * (x * y + w * z),
            1.0 - 2.0 * (x * x + z * z),
            2.0 * (y * z - w * x),
        ],
        [
            2.0 * (x * z - w * y),
            2.0 * (y * z + w * x),
            1.0 - 2.0 * (x * x + y * y),
        ],
    ])
}

fn is_finite(numbers: &[f32]) -> bool {
    numbers.iter().all(|number| number.is_finite())
}

/// Set up as the kernel's splat, or invalid.
macro_rules! primitive {
    ($type:ty) => {
        impl Primitive<Eye> for $type {
            type Footprint = Footprint;

            #[inline(always)]
            fn set_up<D: Design>(
                &self,
                design: D,
                view: &View,
                rules: &Rules,
            ) -> Result<Footprint, Rejected> {
                let splat = self.splat().ok_or(Rejected::Invalid)?;
                setup(design, view, rules, &splat).map_err(Rejected::Culled)
            }
        }
    };
}
primitive!(Gaussian);
primitive!(Point);

impl Primitive<Eye> for Surfel {
    type Footprint = SurfaceFootprint;

    #[inline(always)]
    fn set_up<D: Design>(
        &self,
        design: D,
        view: &View,
        rules: &Rules,
    ) -> Result<SurfaceFootprint, Rejected> {
        let splat = self.splat().ok_or(Rejected::Invalid)?;
        setup_surface(design, view, rules, &splat).map_err(Rejected::Culled)
    }
}
