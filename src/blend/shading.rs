//! Deferred shading (SURF 4): Phong once per pixel, with the filtered normal and a material table.
//!
//! ```text
//! I = (ka + kd max(0, n.l)) c + ks max(0, r.v)^s a,   r = 2 (n.l) n - l
//! ```
//!
//! with c premultiplied, so that the highlight is weighted by the opacity a. All vectors are unit vectors in camera space in
//! Q1.30; n and v are normalised by the root and the reciprocal unit. The light is directional, the viewer is at
//! the eye: v is the pixel's own ray. Surfaces are two-sided: setup turns
//! every splat's normal towards the eye before they are averaged.

use super::surface::Filtered;
use crate::format::Widths;
use crate::math::{SoftFloat, reciprocal, shift_round, square_root, sum_of_products};
use crate::view::{Projection, View};

/// 1.0 in the vectors' Q1.30.
const ONE: i64 = 1 << 30;

/// Fraction bits of a material's coefficients: like a colour's rounding theirs would put all pixels of a surface on one side, so they are finer
/// than the pixels.
pub const COEFFICIENT: u32 = 27;

/// One row of the material table; coefficients are UQ5.27.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Material {
    /// Share of the colour that is there without light, ka.
    pub ambient: u32,
    /// Diffuse coefficient kd.
    pub diffuse: u32,
    /// Specular coefficient ks; highlights are white.
    pub specular: u32,
    /// Phong exponent s; 0 makes the highlight constant.
    pub exponent: u8,
}

impl Material {
    /// Colours as they are, for clouds whose colours already hold the light.
    pub const UNLIT: Material = Material {
        ambient: 1 << COEFFICIENT,
        diffuse: 0,
        specular: 0,
        exponent: 0,
    };
}

/// A unit vector in camera space, Q1.30.
pub type Direction = [i32; 3];

/// Shading of one picture.
#[derive(Clone, Copy, Debug)]
pub struct Shading<'a> {
    materials: &'a [Material],
    light: Direction,
    view: &'a View,
    inverse_focal: [SoftFloat; 2],
    bits: u32,
    accumulator: u32,
}

impl<'a> Shading<'a> {
    /// Shading with a material table, a direction towards the light in camera space (Q1.30; its length is the light's intensity)
    /// and the view that the rays belong to. Materials beyond the table are [`Material::UNLIT`].
    pub fn new(
        widths: &Widths,
        materials: &'a [Material],
        light: Direction,
        view: &'a View,
    ) -> Shading<'a> {
        let bits = u32::from(widths.mantissa);
        Shading {
            materials,
            light,
            view,
            inverse_focal: view
                .focal
                .map(|focal| reciprocal(focal, bits).unwrap_or(SoftFloat::ZERO)),
            bits,
            accumulator: widths.accumulator.into(),
        }
    }

    /// The pixel's premultiplied colour in UQ4.accumulator, saturated to 16.
    pub fn shade(&self, filtered: &Filtered, x: u16, y: u16) -> [u32; 3] {
        let material = self.materials.get(usize::from(filtered.material));
        let material = material.copied().unwrap_or(Material::UNLIT);
        let (diffuse, highlight) = self.reflect(filtered.normal, material.exponent, x, y);
        let lit = i64::from(material.ambient)
            .saturating_add(shift_round(i64::from(material.diffuse) * diffuse, 30));
        let glint = shift_round(i64::from(material.specular) * highlight, 30);
        let glint = scale(glint, filtered.opacity);
        let limit = (16i64 << self.accumulator).min(u32::MAX.into()) - 1;
        filtered
            .colour
            .map(|c| scale(lit, c).saturating_add(glint).clamp(0, limit) as u32)
    }

    /// max(0, n.l) and max(0, r.v)^s in Q1.30. A normal of length 0 gives neither.
    fn reflect(&self, normal: Direction, exponent: u8, x: u16, y: u16) -> (i64, i64) {
        let filtered = normal.map(|n| SoftFloat::from_wide(n.into(), -30, 31));
        let normal = unit(filtered, self.bits);
        if normal == [0; 3] {
            return (0, 0);
        }
        let ray = self.ray(x, y);
        let towards_eye = ray.map(|r| -r);
        let cosine = dot(normal, self.light);
        if cosine <= 0 {
            return (0, 0);
        }
        let mut reflected = [0; 3];
        for (r, (n, l)) in reflected.iter_mut().zip(normal.iter().zip(self.light)) {
            let part = shift_round(2 * cosine * i64::from(*n), 30) - i64::from(l);
            *r = part.clamp(-ONE, ONE) as i32;
        }
        (cosine, power(dot(reflected, towards_eye).max(0), exponent))
    }

    /// Direction from the eye through the sample point of a pixel, a unit vector.
    fn ray(&self, x: u16, y: u16) -> Direction {
        if self.view.projection == Projection::Orthographic {
            return [0, 0, ONE as i32];
        }
        let slope = |axis: usize, pixel: u16| {
            let sample = (i64::from(pixel) << 32) + (1 << 31);
            let offset = sample.wrapping_sub(self.view.principal[axis].to_bits());
            SoftFloat::from_wide(offset, -32, self.bits)
                .multiply(self.inverse_focal[axis], self.bits)
        };
        let one = SoftFloat {
            mantissa: ONE as i32,
            exponent: -30,
        };
        unit([slope(0, x), slope(1, y), one], self.bits)
    }
}

/// A vector divided by its length, Q1.30; 0 for 0. Error below 2^-(bits - 2) per component.
pub fn unit(vector: [SoftFloat; 3], bits: u32) -> Direction {
    let square = sum_of_products(vector.map(|v| v.times(v)), bits);
    let Some(inverse) = reciprocal(square_root(square, bits), bits) else {
        return [0; 3];
    };
    vector.map(|v| v.times(inverse).to_fixed(30).clamp(-ONE, ONE) as i32)
}

/// Scalar product in Q1.30, saturated to [-1, 1].
fn dot(a: Direction, b: Direction) -> i64 {
    let [x, y, z] = [0, 1, 2].map(|i: usize| i64::from(a[i]) * i64::from(b[i]));
    // Three products of at most 2^60 for unit vectors; halved, any bit pattern fits.
    let halved = (x >> 1) + (y >> 1) + (z >> 1);
    shift_round(halved, 29).clamp(-ONE, ONE)
}

/// base^exponent in Q1.30 for base in [0, 1] by squaring: at most 16 multiplications.
fn power(base: i64, exponent: u8) -> i64 {
    let mut result = ONE;
    let mut square = base;
    for bit in 0..8 {
        if exponent >> bit & 1 != 0 {
            result = shift_round(result * square, 30);
        }
        square = shift_round(square * square, 30);
    }
    result
}

/// Coefficient (UQ5.27, saturated) times value.
fn scale(coefficient: i64, value: u32) -> i64 {
    let coefficient = coefficient.clamp(0, u32::MAX.into());
    shift_round(
        coefficient * i64::from(value.min(i32::MAX as u32)),
        COEFFICIENT,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_of_a_half() {
        let half = ONE / 2;
        for exponent in [0u8, 1, 2, 5, 20, 30] {
            let expected = 0.5f64.powi(exponent.into());
            let got = power(half, exponent) as f64 / ONE as f64;
            assert!((got - expected).abs() < 1e-8, "{exponent}: {got}");
        }
        assert_eq!(power(ONE, 255), ONE);
        assert_eq!(power(0, 255), 0);
    }

    #[test]
    fn unit_vectors_have_length_one() {
        for vector in [[3, 4, 0], [1, -1, 1], [1 << 30, 5, -7], [0, 0, -9]] {
            let got = unit(vector.map(|v| SoftFloat::from_wide(v, 3, 31)), 24);
            let length = got
                .iter()
                .map(|g| (f64::from(*g) / ONE as f64).powi(2))
                .sum::<f64>();
            assert!((length - 1.0).abs() < 1e-6, "{vector:?}: {length}");
        }
        assert_eq!(unit([SoftFloat::ZERO; 3], 24), [0; 3]);
    }
}
