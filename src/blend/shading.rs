//! Deferred shading (SURF 4): Phong once per pixel, with the filtered normal and a material table.
//!
//! ```text
//! I = (ka + kd max(0, n.l)) c + ks max(0, r.v)^s a,   r = 2 (n.l) n - l
//! ```
//!
//! with c premultiplied, so that the highlight is weighted by the opacity a. All vectors are unit vectors in camera
//! space in Q1.30; n and v are normalised by the root and the reciprocal unit. The light is directional, the viewer is
//! at the eye: v is the pixel's own ray. Surfaces are two-sided: setup turns
//! every splat's normal towards the eye before they are averaged.

use super::surface::Filtered;
use crate::format::Widths;
use crate::math::{SoftFloat, reciprocal, shift_round, square_root, sum_of_products};
use crate::view::{Projection, View};

/// 1.0 in the vectors' Q1.30.
const ONE: i64 = 1 << 30;

/// Fraction bits of a material's coefficients: like a colour's rounding theirs would put all pixels of a surface on one
/// side, so they are finer than the pixels.
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
    /// Shading with a material table, a direction towards the light in camera space (Q1.30; its length is the light's
    /// intensity) and the view that the rays belong to. Materials beyond the table are [`Material::UNLIT`].
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
    use fixed::types::{I2F30, I32F32};
    use proptest::prelude::*;

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

    fn view(projection: Projection) -> View {
        let (one, zero) = (I2F30::from_bits(1 << 30), I2F30::ZERO);
        let end = |value| crate::math::Extended { value, exponent: 0 };
        View {
            rotation: [[one, zero, zero], [zero, one, zero], [zero, zero, one]],
            pose: crate::view::Eye::ORIGIN,
            focal: [80, 100].map(|focal| SoftFloat::from_wide(focal, 0, 31)),
            principal: [40, 30].map(I32F32::from_num),
            near: end(0),
            far: end(1 << 40),
            viewport: [96; 2],
            projection,
            limits: crate::view::RatioLimits {
                low: [I32F32::MIN; 2],
                high: [I32F32::MAX; 2],
            },
        }
    }

    fn length(vector: [f64; 3]) -> f64 {
        vector.map(|v| v * v).iter().sum::<f64>().sqrt()
    }

    proptest! {
        /// The formula at the module's head in double precision, each material by its number and others unlit.
        #[test]
        fn shading_is_the_formula(
            terms in [0.0f64..4.0, 0.0..4.0, 0.0..4.0], exponent in 0u8..24, light in [-1.0f64..1.0, -1.0..1.0, -1.0..1.0],
            normal in [-1.0f64..1.0, -1.0..1.0, -1.0..0.0], colour in [0.0f64..1.0, 0.0..1.0, 0.0..1.0], opacity in 0.0f64..=1.0,
            x in 0u16..96, y in 0u16..96, flat: bool, number in 0u8..3,
        ) {
            prop_assume!(length(normal) > 0.1 && length(light) > 0.1);
            let widths = crate::format::Deep32::WIDTHS;
            let light = light.map(|l| l / length(light).max(1.0));
            let normal = normal.map(|n| n / length(normal).max(1.0));
            let projection = if flat { Projection::Orthographic } else { Projection::Perspective };
            let view = view(projection);
            let [ambient, diffuse, specular] = terms.map(|t| (t * f64::from(1 << COEFFICIENT)) as u32);
            let material = Material { ambient, diffuse, specular, exponent };
            let materials = [Material::UNLIT, material];
            let fixed = |vector: [f64; 3]| vector.map(|v| (v * ONE as f64) as i32);
            let shading = Shading::new(&widths, &materials, fixed(light), &view);
            let one = f64::from(1u32 << widths.accumulator);
            let filtered = Filtered {
                colour: colour.map(|c| (c * one) as u32),
                opacity: (opacity * one) as u32,
                normal: fixed(normal),
                material: number,
            };
            let found = shading.shade(&filtered, x, y).map(|c| f64::from(c) / one);
            let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
            let n = normal.map(|v| v / length(normal));
            let cosine = dot(n, light);
            prop_assume!(cosine.abs() > 1e-6);
            let ray = match projection {
                Projection::Orthographic => [0.0, 0.0, 1.0],
                _ => [(f64::from(x) + 0.5 - 40.0) / 80.0, (f64::from(y) + 0.5 - 30.0) / 100.0, 1.0],
            };
            let towards = ray.map(|r| -r / length(ray));
            let reflected = [0, 1, 2].map(|i: usize| 2.0 * cosine * n[i] - light[i]);
            let lit = cosine > 0.0;
            let glint = if lit { dot(reflected, towards).clamp(0.0, 1.0).powi(exponent.into()) } else { 0.0 };
            let [ambient, diffuse, specular] = if number == 1 { terms } else { [1.0, 0.0, 0.0] };
            for i in 0..3 {
                let exact = (ambient + diffuse * cosine.max(0.0)) * colour[i] + specular * glint * opacity;
                prop_assert!((found[i] - exact).abs() < 2e-6, "{} {}", found[i], exact);
            }
        }
    }

    /// What is exactly known: no light from behind, or without a normal; a mirror's image at an angle; and black that
    /// stays black.
    #[test]
    fn light_at_its_ends() {
        const UNIT: u32 = 1 << 27;
        let glossy = Material {
            ambient: 1 << 26,
            diffuse: 1 << 30,
            specular: 1 << 30,
            exponent: 0,
        };
        let mirror = Material {
            ambient: 0,
            diffuse: 0,
            specular: 1 << 30,
            exponent: 1,
        };
        let black = Material {
            specular: 0,
            ..mirror
        };
        let one = ONE as i32;
        // In fives: 3, 4.
        let [across, towards] = [644_245_094, 858_993_459];
        let eye = [0, 0, -one];
        let cases = [
            (glossy, eye, [0; 3], 1 << 26),
            (glossy, eye, [0, 0, one], 1 << 26),
            (glossy, eye, [one, 0, 0], 1 << 26),
            // The least light that is any.
            (glossy, [0, 0, -1], eye, (1 << 26) + 1 + (1 << 30)),
            (mirror, [across, 0, -towards], eye, towards as u32),
            (mirror, [0, across, -towards], eye, towards as u32),
            // Its image lies behind the eye.
            (
                mirror,
                [-one / 2, 0, -929_887_697],
                [towards, 0, -across],
                0,
            ),
            (black, eye, eye, 0),
        ];
        for (material, light, normal, seen) in cases {
            let (materials, view) = ([material], view(Projection::Orthographic));
            let shading = Shading::new(&crate::format::Deep32::WIDTHS, &materials, light, &view);
            let filtered = Filtered {
                colour: [UNIT; 3],
                opacity: UNIT,
                normal,
                material: 0,
            };
            assert_eq!(
                shading.shade(&filtered, 40, 30),
                [seen; 3],
                "{material:?} {light:?} {normal:?}"
            );
        }
        let got = power(ONE * 99 / 100, 200) as f64 / ONE as f64;
        assert!((got - 0.99f64.powi(200)).abs() < 1e-6, "{got}");
    }
}
