//! What each step of the datapath may lose at most, derived in `docs/error-analysis.md`, for one splat and one design.
//!
//! u is one rounding to the mantissa, q the rounding of a difference to the eye, relative to its length.
//! G = 1 / sqrt(1 - rho^2) grows with a needle's axis ratio on the screen's diagonals; K >= 1 says how much of the
//! columns of M cancels (`RationalFootprint::cancellation`). The bounds hold for designs that scan rows by LDL and
//! round to nearest.

use super::exact::RationalFootprint;
use super::pictures::Edge;
use crate::camera::Camera;
use splatline::footprint::depth::MANTISSA;
use splatline::format::Widths;
use splatline::raster::{BLOCK, vertical_fraction};

/// Bounds of the steps for one splat.
#[derive(Clone, Copy, Debug)]
pub(super) struct ErrorBounds {
    pub centre: f64,
    pub depth: f64,
    pub peak: f64,
    pub variance: f64,
    pub determinant: f64,
    pub form: f64,
    widths: Widths,
    footprint: RationalFootprint,
}

/// Half a unit of a format with `bits` fraction bits.
fn half(bits: u8) -> f64 {
    (-f64::from(bits) - 1.0).exp2()
}

impl ErrorBounds {
    pub fn new(
        widths: &Widths,
        footprint: &RationalFootprint,
        camera: &Camera,
        normalised: bool,
    ) -> ErrorBounds {
        let u = 2.0 * half(widths.mantissa);
        let middle = [(camera.cx, camera.fx), (camera.cy, camera.fy)];
        let offset = [0, 1].map(|i| (footprint.centre[i] - middle[i].0).abs());
        // The difference to the eye, whose length over the depth is the slant, and the rotation.
        let [x, y] = [0, 1].map(|i| offset[i] / middle[i].1);
        let slant = if camera.orthographic {
            (footprint.depth.powi(2) + x * x + y * y).sqrt() / footprint.depth.abs()
        } else {
            (1.0 + (x * x + y * y)).sqrt()
        };
        let near = 8.0 * half(widths.position) * slant;
        let lost = (6.0 * u + 2.0 * near) * footprint.cancellation;
        let gain = footprint.gain();
        let determinant = 4.0 * lost * gain + 2.0 * lost + 5.0 * u;
        let centre =
            [0, 1].map(|i| 8.0 * half(widths.view) * offset[i] + near * (middle[i].1 + offset[i]));
        // Dimmed by the area and the root of the determinant, or the weight itself.
        let scaled = if normalised {
            0.5 * determinant + 10.0 * u + 2.0 * near
        } else {
            half(30)
        };
        ErrorBounds {
            centre: half(widths.subpixel) + half(31) + centre[0].max(centre[1]),
            depth: 2.0 * near + 2.0 * half(MANTISSA as u8),
            peak: scaled + half(widths.peak) / footprint.peak,
            variance: 2.0 * lost + u,
            determinant,
            form: 8.0 * (lost + u) * (1.0 + gain),
            widths: *widths,
            footprint: *footprint,
        }
    }

    /// Of the radial index in the lanes, where it is `r`.
    pub fn radial(&self, r: f64) -> f64 {
        let of = &self.footprint;
        let (horizontal, shear, vertical) = (of.horizontal, of.shear, of.vertical);
        let u = 2.0 * half(self.widths.mantissa);
        // Moving the centre by d changes r by at most 2 sqrt(r k) d + k d^2, k the largest eigenvalue of Q. The
        // distance of a block's first row is rounded to a mantissa, and the rows' sums drift by 16 units of theirs, or
        // 17 where rows are long or far apart.
        let steepest = horizontal * (1.0 + shear * shear) + vertical;
        let reach = (self.footprint.cutoff * self.footprint.variance[2]).sqrt() + 1.0;
        let first_row = reach.min(self.footprint.centre[1].abs() + 0.5);
        let subpixel = self.widths.subpixel;
        let drift = if horizontal < (-21f64).exp2() || shear.abs() > 12f64.exp2() {
            17.0 * (2.0 - f64::from(subpixel)).exp2()
        } else {
            half(subpixel + 3)
        };
        let moved = std::f64::consts::SQRT_2 * self.centre + u * first_row + drift;
        let block = f64::from(BLOCK);
        let units = [
            f64::from(self.widths.radial),
            vertical_fraction(&self.widths).into(),
        ];
        let unit: f64 = units.map(|bits| (-bits).exp2()).iter().sum();
        let lanes = (block * block / 32.0 + block + 2.0) * unit;
        self.form * r
            + 2.0 * (r * steepest).sqrt() * moved
            + steepest * moved * moved
            + (16.0 * r.sqrt() + 8.0 * self.footprint.cutoff) * u
            + lanes
    }

    /// How far from its cut-off a pixel may be decided otherwise, and how close in depth another splat may change
    /// places with this one.
    pub fn edge(&self, range: u8) -> Edge {
        let end = self.footprint.cutoff;
        let faintest = self.footprint.peak * (-0.5 * end).exp();
        Edge {
            radial: 2.0 * self.radial(end)
                + 4.0 * self.opacity(end, range) / faintest
                + 64.0 * self.layer(),
            depth: 2.0 * self.depth * self.footprint.depth,
        }
    }

    /// Of a layer's share and colour, once it has its opacity.
    pub fn layer(&self) -> f64 {
        half(self.widths.transmittance) + half(self.widths.accumulator) + half(self.widths.colour)
    }

    /// Of the opacity at a pixel, where the radial index is `r`.
    pub fn opacity(&self, r: f64, range: u8) -> f64 {
        let weight = (-0.5 * r).exp();
        let step = (f64::from(range) - f64::from(self.widths.table)).exp2();
        let position = step * (-f64::from(self.widths.interpolation)).exp2();
        let table = weight * (0.5 * step).exp() * (step * step / 48.0 + 0.5 * position)
            + 2.0 * half(self.widths.weight);
        let shifted = weight * (0.5 * self.radial(r)).exp_m1();
        let peak = self.footprint.peak;
        let lost = peak * (table + shifted) + self.peak * peak * weight;
        (lost + half(self.widths.alpha)).min(1.0)
    }
}
