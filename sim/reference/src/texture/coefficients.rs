//! Texture coefficients: which colour each point of a surface gets, so that the splatted surface looks like the texture
//! (\[SURF\] 5).
//!
//! The continuous texture function of a splatted surface is f(u) = sum_k w_k r_k(u) (\[SURF\] eq. 2), with r_k the
//! basis functions divided by their sum: that is what the accumulation buffer divides (eq. 9). Three ways to the
//! coefficients w_k:
//!
//! - [`Method::Plain`]: the texture's colour at the point. The basis functions blur it again when it is drawn.
//! - [`Method::Prefiltered`], view-independent EWA: the texture is filtered by the point's basis function convolved
//!   with the texel's unit Gaussian before it is sampled. Nothing aliases where points are farther apart than texels;
//!   it is blurred twice.
//! - [`Method::Optimised`]: the w that minimises sum_j |f(u_j) - c_j|^2 over all texels, R w = c with R_jk = r_k(u_j).

use super::Texture;
use super::solve::NormalEquations;
use anyhow::Result;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::ops::Range;
use std::str::FromStr;

/// The pre-filter ends at this radial index, three standard deviations.
const PREFILTER_CUTOFF: f64 = 9.0;

/// Rows of texels whose equations are made at a time, to keep memory small.
const BAND: usize = 32;

/// How coefficients come from a texture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// The texture at the point.
    Plain,
    /// The texture under the point's view-independent EWA filter.
    Prefiltered,
    /// Least squares over all texels.
    Optimised,
}

impl Method {
    /// All methods, the plainest first.
    pub const ALL: [Method; 3] = [Method::Plain, Method::Prefiltered, Method::Optimised];

    /// Name on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Method::Plain => "plain",
            Method::Prefiltered => "prefiltered",
            Method::Optimised => "optimised",
        }
    }
}

impl FromStr for Method {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        let named = Method::ALL.into_iter().find(|method| method.name() == name);
        named.ok_or_else(|| {
            format!(
                "expected one of {}",
                Method::ALL.map(Method::name).join(", ")
            )
        })
    }
}

/// A point of a surface on its texture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SamplePoint {
    /// Texture coordinates, texels.
    pub place: [f64; 2],
    /// The basis function's two axes, each one standard deviation long, texels.
    pub axes: [[f64; 2]; 2],
}

impl SamplePoint {
    /// Variance (xx, xy, yy), square texels.
    pub fn variance(&self) -> [f64; 3] {
        let [a, b] = self.axes;
        [
            a[0] * a[0] + b[0] * b[0],
            a[0] * a[1] + b[0] * b[1],
            a[1] * a[1] + b[1] * b[1],
        ]
    }
}

/// Coefficients of `points` on `texture`, one colour per point; the optimised ones may leave 0 to 1 on either side of
/// an edge. The basis functions end where the radial index reaches `cutoff`, as in the drawing.
pub fn coefficients(
    texture: &Texture,
    points: &[SamplePoint],
    method: Method,
    cutoff: f64,
) -> Result<Vec<[f64; 3]>> {
    let plain = points.par_iter().map(|point| texture.sample(point.place));
    let filtered = points.par_iter().map(|point| prefiltered(texture, point));
    match method {
        Method::Plain => Ok(plain.collect()),
        Method::Prefiltered => Ok(filtered.collect()),
        Method::Optimised => optimised(texture, points, cutoff),
    }
}

/// The weighted mean of the texels around a point: Gaussian of variance V_k + I.
fn prefiltered(texture: &Texture, point: &SamplePoint) -> [f64; 3] {
    let [xx, xy, yy] = point.variance();
    let filter = TexelEllipse::new(point.place, [xx + 1.0, xy, yy + 1.0], PREFILTER_CUTOFF);
    let (mut sum, mut colour) = (0.0, [0.0; 3]);
    filter.for_each_texel(texture, 0..texture.height, |index, weight| {
        sum += weight;
        for (total, channel) in colour.iter_mut().zip(texture.texels[index]) {
            *total += weight * channel;
        }
    });
    if sum > 0.0 {
        colour.map(|total| total / sum)
    } else {
        // A point beyond the texture takes the border's colour.
        texture.sample(point.place)
    }
}

/// Least squares from the plain samples on.
fn optimised(texture: &Texture, points: &[SamplePoint], cutoff: f64) -> Result<Vec<[f64; 3]>> {
    let plain: Vec<[f64; 3]> = points.iter().map(|p| texture.sample(p.place)).collect();
    let basis: Vec<TexelEllipse> = points
        .iter()
        .map(|point| TexelEllipse::new(point.place, point.variance(), cutoff))
        .collect();
    let mut equations = NormalEquations::new(points.len());
    for first in (0..texture.height).step_by(BAND) {
        let rows = first..(first + BAND).min(texture.height);
        for (mut row, index) in heights(texture, &basis, rows)
            .into_iter()
            .zip(first * texture.width..)
        {
            let sum: f64 = row.iter().map(|(_, height)| height).sum();
            row.iter_mut().for_each(|(_, height)| *height /= sum);
            equations.add(&row, texture.texels[index]);
        }
    }
    equations.solve(&plain)
}

/// For every texel of a band of rows the points whose basis functions reach it, with their heights there.
fn heights(
    texture: &Texture,
    basis: &[TexelEllipse],
    rows: Range<usize>,
) -> Vec<Vec<(usize, f64)>> {
    let mut heights = vec![Vec::new(); rows.len() * texture.width];
    let offset = rows.start * texture.width;
    for (number, ellipse) in basis.iter().enumerate() {
        ellipse.for_each_texel(texture, rows.clone(), |index, height| {
            heights[index - offset].push((number, height));
        });
    }
    heights
}

/// A Gaussian on the texture.
struct TexelEllipse {
    place: [f64; 2],
    conic: [f64; 3],
    half: [f64; 2],
    cutoff: f64,
}

impl TexelEllipse {
    fn new(place: [f64; 2], [xx, xy, yy]: [f64; 3], cutoff: f64) -> TexelEllipse {
        let determinant = xx * yy - xy * xy;
        TexelEllipse {
            place,
            conic: [yy / determinant, -xy / determinant, xx / determinant],
            half: [(cutoff * xx).sqrt(), (cutoff * yy).sqrt()],
            cutoff,
        }
    }

    /// Calls `see` with index and height of every texel of the rows that lies inside the cut-off.
    fn for_each_texel(
        &self,
        texture: &Texture,
        rows: Range<usize>,
        mut see: impl FnMut(usize, f64),
    ) {
        let range = |axis: usize, allowed: Range<usize>| {
            let first = (self.place[axis] - self.half[axis] - 0.5).ceil().max(0.0);
            let last = (self.place[axis] + self.half[axis] - 0.5).floor();
            allowed.start.max(first as usize)..allowed.end.min((last + 1.0).max(0.0) as usize)
        };
        let [a, b, c] = self.conic;
        for y in range(1, rows) {
            let dy = y as f64 + 0.5 - self.place[1];
            for x in range(0, 0..texture.width) {
                let dx = x as f64 + 0.5 - self.place[0];
                let index = a * dx * dx + 2.0 * b * dx * dy + c * dy * dy;
                if index < self.cutoff {
                    see(y * texture.width + x, (-0.5 * index).exp());
                }
            }
        }
    }
}
