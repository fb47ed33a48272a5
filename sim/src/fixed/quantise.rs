//! From double precision to the kernel's input formats.
//!
//! Positions are Q7.24 in the kernel's scene units, so the scene is first multiplied by the power of two that makes it fill that
//! range; a power of two moves no bit of any result. Axes and weights carry their own exponents and lose nothing below 31 bits.

use crate::camera::Camera;
use crate::rules::{Compositing, Kernel, Rules};
use crate::scene::Scene;
use fixed::types::{I2F30, I8F24, I10F54, I32F32, U4F28};
use splatline::kernel as shapes;
use splatline::math::Scaled;
use splatline::rules as kernel;
use splatline::splat::{Axis, VolumeSplat};
use splatline::view::{Projection, RatioLimits, View};

/// A scene and its camera in the kernel's formats.
#[derive(Clone, Debug)]
pub struct QuantisedScene {
    /// The camera.
    pub view: View,
    /// The splats, in the scene's order.
    pub splats: Vec<VolumeSplat>,
    /// Kernel scene units per scene unit, as a power of two.
    pub scale_log2: i32,
    /// Splats of which a colour or a coordinate had to be clamped to its format.
    pub clamped: usize,
}

impl QuantisedScene {
    /// Quantises what both engines draw: the scene as `rules` weigh it, seen by `camera`.
    pub fn new(scene: &Scene, camera: &Camera, rules: &Rules) -> Self {
        let scale_log2 = scale_log2(scene.splats.iter().map(|s| s.centre), camera);
        let weight_log2 = if rules.normalised { 2 * scale_log2 } else { 0 };
        let (colours, weights) = (scene.colours(camera), scene.weights_for(rules));
        let mut clamped = 0;
        let splats = scene
            .splats
            .iter()
            .zip(colours.iter().zip(&weights))
            .map(|(splat, (colour, weight))| {
                let position = splat.centre.map(|value| value * exp2(scale_log2));
                let fits =
                    position.iter().all(|p| p.abs() < 128.0) && colour.iter().all(|c| *c < 16.0);
                clamped += usize::from(!fits);
                VolumeSplat {
                    centre: position.map(I8F24::saturating_from_num),
                    axes: splat.axes.map(|axis| self::axis(axis, scale_log2)),
                    weight: scaled(*weight).scaled_by(weight_log2),
                    colour: colour.map(U4F28::saturating_from_num),
                }
            })
            .collect();
        QuantisedScene {
            view: view(camera, scale_log2),
            splats,
            scale_log2,
            clamped,
        }
    }

    /// The kernel's statement of the rules, lengths in the kernel's scene units.
    pub fn rules(&self, rules: &Rules) -> kernel::Rules {
        let stated = kernel_rules(rules);
        kernel::Rules {
            spacing: stated.spacing.scaled_by(self.scale_log2),
            ..stated
        }
    }
}

/// The largest power of two by which the splats stay below 128 and the eye's translation below 256 units.
///
/// Positions of a few stray splats far outside would cost all others their precision; they are clamped, counted and reported
/// instead once they are 2^10 times farther out than half of the splats.
pub(super) fn scale_log2(centres: impl Iterator<Item = [f64; 3]>, camera: &Camera) -> i32 {
    let mut reach: Vec<f64> = centres
        .map(|centre| centre.iter().fold(0.0, |m: f64, c| m.max(c.abs())))
        .collect();
    reach.sort_by(f64::total_cmp);
    let median = reach.get(reach.len() / 2).copied().unwrap_or(1.0);
    let farthest = reach
        .last()
        .copied()
        .unwrap_or(1.0)
        .min(median.max(1e-30) * 1024.0);
    let eye = camera
        .translation
        .iter()
        .fold(0.0, |m: f64, d| m.max(d.abs()));
    let largest = farthest.max(eye / 2.0).clamp(1e-30, 1e30);
    6 - largest.log2().floor() as i32
}

pub(super) fn exp2(power: i32) -> f64 {
    f64::from(power).exp2()
}

/// A double as mantissa and exponent, rounded to nearest to 31 bits; non-finite values count as 0.
pub fn scaled(value: f64) -> Scaled {
    if value == 0.0 || !value.is_finite() {
        return Scaled::ZERO;
    }
    let exponent = value.abs().log2().floor().clamp(-1000.0, 1000.0) as i32 - 61;
    Scaled::from_wide((value * exp2(-exponent)) as i64, exponent, 31)
}

pub(super) fn axis(axis: [f64; 3], scale_log2: i32) -> Axis {
    let axis = Axis::from_components(axis.map(scaled));
    Axis {
        exponent: axis.exponent + scale_log2,
        ..axis
    }
}

pub(super) fn view(camera: &Camera, scale_log2: i32) -> View {
    let unit = exp2(scale_log2);
    let focal_unit = if camera.orthographic { -scale_log2 } else { 0 };
    let half_width = [
        camera.width as f64 / (2.0 * camera.fx),
        camera.height as f64 / (2.0 * camera.fy),
    ];
    let low = [
        -(camera.cx / camera.fx + 0.3 * half_width[0]),
        -(camera.cy / camera.fy + 0.3 * half_width[1]),
    ];
    let high = [
        (camera.width as f64 - camera.cx) / camera.fx + 0.3 * half_width[0],
        (camera.height as f64 - camera.cy) / camera.fy + 0.3 * half_width[1],
    ];
    View {
        rotation: camera
            .rotation
            .map(|row| row.map(I2F30::saturating_from_num)),
        translation: camera
            .translation
            .map(|d| I10F54::saturating_from_num(d * unit)),
        focal: [
            scaled(camera.fx).scaled_by(focal_unit),
            scaled(camera.fy).scaled_by(focal_unit),
        ],
        principal: [
            I32F32::saturating_from_num(camera.cx),
            I32F32::saturating_from_num(camera.cy),
        ],
        near: I10F54::saturating_from_num(camera.near * unit),
        far: I10F54::saturating_from_num(camera.far * unit),
        viewport: [camera.width, camera.height].map(|size| u16::try_from(size).unwrap_or(u16::MAX)),
        projection: if camera.orthographic {
            Projection::Orthographic
        } else {
            Projection::Perspective
        },
        limits: RatioLimits {
            low: low.map(I32F32::saturating_from_num),
            high: high.map(I32F32::saturating_from_num),
        },
    }
}

/// The kernel's statement of the same rules, lengths in the scene's own units.
pub fn kernel_rules(rules: &Rules) -> kernel::Rules {
    let unit = |value: f64| (value * 2f64.powi(31)).round().clamp(0.0, 2f64.powi(31)) as u32;
    let radial = rules.cutoff.is_finite();
    let shape = match rules.kernel {
        Kernel::Gaussian => shapes::Kernel::Gaussian,
        Kernel::Cubic => shapes::Kernel::Cubic,
        Kernel::Quadratic => shapes::Kernel::Quadratic,
        Kernel::Disc => shapes::Kernel::Disc,
    };
    let stated = kernel::Rules {
        normalised: rules.normalised,
        low_pass: scaled(rules.low_pass),
        spacing: scaled(rules.spacing),
        kernel: shape,
        cutoff: if radial {
            kernel::Cutoff::Radial(
                (rules.cutoff * 2f64.powi(28))
                    .round()
                    .clamp(0.0, 15.0 * 2f64.powi(28)) as u32,
            )
        } else {
            kernel::Cutoff::Opacity
        },
        alpha_max: unit(rules.alpha_max),
        alpha_min: unit(rules.alpha_min),
        stop: unit(rules.stop),
        stop_before: rules.stop_before,
        clamp_jacobian: rules.clamp_jacobian,
        table_range: if radial && rules.cutoff <= 4.0 { 2 } else { 4 },
    };
    stated.with_kernel(shape)
}

/// The kernel's name for the same compositing.
pub fn kernel_compositing(compositing: Compositing) -> kernel::Compositing {
    match compositing {
        Compositing::FrontToBack => kernel::Compositing::FrontToBack,
        Compositing::BackToFront => kernel::Compositing::BackToFront,
        Compositing::XRay => kernel::Compositing::XRay,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_statements_of_the_rules_agree() {
        assert_eq!(kernel_rules(&Rules::EWA), kernel::Rules::EWA);
        assert_eq!(
            kernel_rules(&Rules::GAUSSIAN_3D),
            kernel::Rules::GAUSSIAN_3D
        );
    }

    #[test]
    fn doubles_keep_31_bits() {
        for value in [1.0, -0.3, 1e-20, 12345.678, -7e25, 0.999_999_999_9] {
            let got = scaled(value);
            let back = f64::from(got.mantissa) * exp2(got.exponent);
            assert!(
                (back / value - 1.0).abs() <= 2f64.powi(-31),
                "{value}: {back}"
            );
        }
        assert_eq!(scaled(f64::NAN), Scaled::ZERO);
        assert_eq!(scaled(f64::INFINITY), Scaled::ZERO);
    }
}
