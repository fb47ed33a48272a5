//! Spheres around splats, and the boxes of pixels that no footprint leaves.
//!
//! With axes `a_k` of a splat, r^2 = sum |a_k|^2 bounds each of its variances. On the screen (\[EWA\] eq. 25 with x/z =
//! rho and the gain g = f / z) an axis is g (a_x - rho a_z), hence V'_xx <= g^2 (1 + rho^2) r^2, and the box ends at
//! sqrt(c (V'_xx + h)) from the centre with the cut-off c (`splatline::setup`'s bounds). All is computed in single
//! precision for the nearest point that the errors allow:
//!
//! - The camera-space error E is at most (2^-21 + 2^(3 - position)) (|u|_1 + |e|_1): six roundings of 2^-24 of the
//!   terms here, and in the kernel the difference and the rotation, each rounded to `position` bits of the largest
//!   coordinate. The smallest normal number covers what is below the normal ones.
//! - x/z is then off by at most E / (z - E) (1 + 2 |rho|), and f x/z by the kernel's three roundings to `view` bits.
//! - An axis is rounded to `axis_bits` of its block, which mantissas should use all of: where they are small, that can
//!   be more than the axis itself ([`AXIS_ERROR`]). One of length 0 stays 0.
//! - A variance goes through a dozen roundings to `mantissa` bits and the cut-off and the root have 16: with at least
//!   [`LEAST_BITS`] bits that is below 1/64 of the extent. Two pixels more are for the subpixel grid, the samples'
//!   places and the principal point.

use rayon::prelude::*;
use splatline::float::exp2;
use splatline::format::{Deep32, Widths};
use splatline::math::{Extended, SoftFloat};
use splatline::rules::{Cutoff, Rules, THRESHOLD};
use splatline::setup::axis_bits;
use splatline::splat::VolumeSplat;
use splatline::view::{Projection, View};

/// Narrower numbers of a design are not covered by the margins.
const LEAST_BITS: u8 = 14;

/// How much longer than it is the kernel can take an axis for, in units of its mantissa: sqrt(3) (1 + 3/4) of what
/// components are rounded to with [`LEAST_BITS`], for the axis itself and for the three products of a turned component.
const AXIS_ERROR: f64 = {
    let narrowest = Widths {
        mantissa: LEAST_BITS,
        ..Deep32::WIDTHS
    };
    (4u32 << (31 - axis_bits(&narrowest))) as f64
};

/// The largest cut-off by opacity.
const LARGEST_CUTOFF: f64 = 15.0;

/// Offsets from the principal point above this may be saturated by the kernel.
const FAR_OFF: f32 = (1 << 24) as f32;

/// Spheres that are projected together.
pub const TOGETHER: usize = 16;

/// So many numbers of as many spheres.
pub type Numbers = [f32; TOGETHER];

/// x, y, z and radii.
pub type Spheres = [Numbers; 4];

/// One for each splat.
#[derive(Clone, Debug, Default)]
pub struct BoundingSpheres {
    /// Centres, and radii times the root of the cut-off.
    pub(super) groups: Vec<Spheres>,
    /// The low-pass filter's variance times the largest cut-off.
    filter: f32,
}

impl BoundingSpheres {
    /// Around splats as the rules cut them off; `None` where rules enlarge footprints by distance.
    pub fn new(splats: &[VolumeSplat], rules: &Rules) -> Option<Self> {
        if rules.spacing.mantissa > 0 {
            return None;
        }
        let groups = splats.par_chunks(TOGETHER).map(|splats| {
            let mut group = [[0.0; TOGETHER]; 4];
            for (k, splat) in splats.iter().enumerate() {
                for (plane, number) in group.iter_mut().zip(sphere(splat, rules)) {
                    plane[k] = number;
                }
            }
            group
        });
        Some(BoundingSpheres {
            groups: groups.collect(),
            filter: (number(rules.low_pass) * largest_cutoff(rules)) as f32,
        })
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.groups.capacity() * size_of::<Spheres>()
    }
}

fn number(value: SoftFloat) -> f64 {
    f64::from(value.mantissa) * exp2(value.exponent)
}

fn extended(value: Extended) -> f64 {
    value.value as f64 * exp2(value.exponent)
}

fn largest_cutoff(rules: &Rules) -> f64 {
    let Cutoff::Radial(cutoff) = rules.cutoff else {
        return LARGEST_CUTOFF;
    };
    f64::from(cutoff) / exp2(28)
}

fn sphere(splat: &VolumeSplat, rules: &Rules) -> [f32; 4] {
    let squares = splat.axes.iter().map(|axis| {
        let mantissas = axis.mantissa.iter().map(|m| f64::from(*m).powi(2));
        let length = mantissas.sum::<f64>().sqrt();
        let most = if length > 0.0 {
            length + AXIS_ERROR
        } else {
            0.0
        };
        most * most * exp2(2 * axis.exponent.clamp(-512, 511))
    });
    let cutoff = match rules.cutoff {
        Cutoff::Opacity if !rules.normalised => {
            let least = rules.alpha_min as f64 * exp2(-(THRESHOLD as i32));
            let above = 2.0 * (number(splat.weight) / least).ln() + 0.01;
            if above > 0.0 {
                above.min(LARGEST_CUTOFF)
            } else {
                0.0
            }
        }
        _ => largest_cutoff(rules),
    };
    let [x, y, z] = splat.centre.map(|coordinate| number(coordinate) as f32);
    let radius = (squares.sum::<f64>() * cutoff).sqrt();
    [
        x,
        y,
        z,
        (radius * (1.0 + exp2(-20))) as f32 + f32::MIN_POSITIVE,
    ]
}

/// How a view sees spheres.
#[derive(Clone, Copy, Debug)]
pub struct SphereProjection {
    rotation: [[f32; 3]; 3],
    eye: [f32; 3],
    /// Sum of the eye's coordinates' magnitudes.
    eye_size: f32,
    /// E relative to the coordinates.
    relative: f32,
    /// What the kernel's projection may be off, relative to the offset from the principal point.
    along: f32,
    focal: [f32; 2],
    principal: [f32; 2],
    margin: f32,
    filter: f32,
    viewport: [f32; 2],
}

impl SphereProjection {
    /// `None` for parallel projection, a clamp of the Jacobian away from the viewing direction, and numbers too narrow
    /// for the margins.
    pub fn new(view: &View, widths: &Widths, spheres: &BoundingSpheres) -> Option<Self> {
        let bits = [widths.position, widths.view, widths.mantissa];
        let limits = view.limits;
        let around = (0..2).all(|axis| limits.low[axis] <= 0 && limits.high[axis] >= 0);
        if view.projection != Projection::Perspective
            || !around
            || bits.iter().any(|bits| *bits < LEAST_BITS)
        {
            return None;
        }
        let eye = view.pose.position.map(|value| {
            extended(Extended {
                value,
                exponent: view.pose.exponent,
            }) as f32
        });
        let principal = view.principal.map(|value| value.to_num::<f64>() as f32);
        let largest = principal
            .iter()
            .fold(0.0f32, |largest, p| largest.max(p.abs()));
        let power = |bits: i32| exp2(bits) as f32;
        Some(SphereProjection {
            rotation: view
                .rotation
                .map(|row| row.map(|entry| entry.to_num::<f64>() as f32)),
            eye,
            eye_size: eye.iter().map(|e| e.abs()).sum(),
            relative: power(-21) + power(3 - i32::from(widths.position)),
            along: power(-20) + power(5 - i32::from(widths.view)),
            focal: view.focal.map(|focal| number(focal) as f32),
            principal,
            margin: 2.0 + largest * power(-20),
            filter: spheres.filter,
            viewport: view.viewport.map(f32::from),
        })
    }

    /// What the view sees of a group of spheres.
    #[inline(always)]
    pub fn project(&self, spheres: &Spheres) -> Projected {
        let mut seen = Projected::default();
        let [xs, ys, zs, radii] = spheres;
        for (k, radius) in radii.iter().enumerate() {
            let (point, error) = self.camera([xs[k], ys[k], zs[k]]);
            let bounds = self.pixels(&point, error, *radius);
            seen.least[k] = point[2] - error;
            seen.most[k] = point[2] + error;
            seen.bounds[0][k] = bounds[0];
            seen.bounds[1][k] = bounds[1];
            seen.bounds[2][k] = bounds[2];
            seen.bounds[3][k] = bounds[3];
        }
        seen
    }

    /// A centre in camera space, and the largest error of its coordinates.
    #[inline(always)]
    fn camera(&self, [x, y, z]: [f32; 3]) -> ([f32; 3], f32) {
        let size = x.abs() + y.abs() + z.abs() + self.eye_size;
        let [x, y, z] = [x - self.eye[0], y - self.eye[1], z - self.eye[2]];
        let [a, b, c] = self.rotation;
        let point = [
            a[0] * x + a[1] * y + a[2] * z,
            b[0] * x + b[1] * y + b[2] * z,
            c[0] * x + c[1] * y + c[2] * z,
        ];
        (point, self.relative * size + f32::MIN_POSITIVE)
    }

    /// Left, top, right and bottom of the box in pixels, within the viewport. What is not certain is the whole
    /// viewport.
    #[inline(always)]
    fn pixels(&self, point: &[f32; 3], error: f32, radius: f32) -> [f32; 4] {
        let nearest = point[2] - error;
        let inverse = 1.0 / nearest;
        let mut bounds = [0.0; 4];
        for axis in 0..2 {
            let ratio = point[axis] * inverse;
            let off = error * inverse * (1.0 + 2.0 * ratio.abs());
            let steepest = ratio.abs() + off;
            let side = self.focal[axis] * inverse * radius;
            let squared = side * side * (1.0 + steepest * steepest) + self.filter;
            let offset = self.focal[axis] * ratio;
            let extent = squared.sqrt() * (1.0 + 1.0 / 64.0)
                + self.focal[axis] * off
                + offset.abs() * self.along
                + self.margin;
            let certain = (nearest > 0.0) & (offset.abs() < FAR_OFF);
            let extent = if certain { extent } else { f32::INFINITY };
            let centre = self.principal[axis] + offset;
            let (low, high, end) = (centre - extent, centre + extent, self.viewport[axis]);
            // No number is the end of the viewport.
            let low = if low > 0.0 { low } else { 0.0 };
            bounds[axis] = if low < end { low } else { end };
            let high = if high < end { high } else { end };
            bounds[axis + 2] = if high > 0.0 { high } else { 0.0 };
        }
        bounds
    }

    /// Columns times rows of the viewport.
    pub fn area(&self) -> f32 {
        self.viewport.iter().product()
    }
}

/// A group of spheres on the screen.
#[derive(Clone, Copy, Debug, Default)]
pub struct Projected {
    /// The least depth that each centre can have in the kernel.
    pub least: Numbers,
    /// The largest.
    pub most: Numbers,
    /// Left, top, right and bottom of the boxes in pixels.
    pub bounds: [Numbers; 4],
}
