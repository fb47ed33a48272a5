//! From double precision to the kernel's input formats.
//!
//! Centres, axes and weights carry their own exponents and lose nothing below 31 bits: an f32 of a file arrives as it is, wherever in the
//! scene it lies. Only what the kernel keeps in fixed point needs a unit. Colours above its range are divided by a power of two, which
//! the resolve multiplies again. Depths of sheets, gathered points and surfaces are UQ9.23, so that their scenes are multiplied by a power
//! of two that fills that range; a power of two moves no bit of any other result.

use crate::camera::Camera;
use crate::rules::{Compositing, Kernel, Rules};
use crate::scene::Scene;
use fixed::types::{I2F30, I32F32, U4F28};
use splatline::kernel as shapes;
use splatline::math::{Extended, Scaled};
use splatline::rules as kernel;
use splatline::splat::{Axis, Position, VolumeSplat};
use splatline::view::{Eye, Projection, RatioLimits, Rotation, View};

/// A scene and its camera in the kernel's formats.
#[derive(Clone, Debug)]
pub struct QuantisedScene {
    /// The camera.
    pub view: View,
    /// The splats, in the scene's order.
    pub splats: Vec<VolumeSplat>,
    /// Kernel scene units per scene unit, as a power of two; 0 where no depth is kept in fixed point.
    pub scale_log2: i32,
    /// Unit of the colours as a power of two: they were divided by it, and pictures are to be multiplied by it.
    pub colour_log2: i32,
    /// Splats of which a value has no place in the kernel's formats: a colour or coordinate that is not finite.
    pub clamped: usize,
}

impl QuantisedScene {
    /// Quantises what both engines draw: the scene as `rules` weigh it, seen by `camera`.
    pub fn new(scene: &Scene, camera: &Camera, rules: &Rules) -> Self {
        QuantisedScene::scaled_by(scene, camera, rules, 0)
    }

    /// The same for compositing that keeps depths in fixed point: in units in which the scene fills their range.
    pub fn with_depths(scene: &Scene, camera: &Camera, rules: &Rules) -> Self {
        let scale_log2 = scale_log2(scene.splats.iter().map(|s| s.centre), camera);
        QuantisedScene::scaled_by(scene, camera, rules, scale_log2)
    }

    fn scaled_by(scene: &Scene, camera: &Camera, rules: &Rules, scale_log2: i32) -> Self {
        let weight_log2 = if rules.normalised { 2 * scale_log2 } else { 0 };
        let (colours, weights) = (scene.colours(camera), scene.weights_for(rules));
        let colour_log2 = colour_log2(&colours);
        let unit = exp2(-colour_log2);
        let mut clamped = 0;
        let splats = scene
            .splats
            .iter()
            .zip(colours.iter().zip(&weights))
            .map(|(splat, (colour, weight))| {
                let finite = splat
                    .centre
                    .iter()
                    .chain(colour)
                    .all(|value| value.is_finite());
                clamped += usize::from(!finite);
                VolumeSplat {
                    centre: position(splat.centre, scale_log2),
                    axes: splat.axes.map(|axis| self::axis(axis, scale_log2)),
                    weight: scaled(*weight).scaled_by(weight_log2),
                    colour: colour.map(|value| self::colour(finite_or_zero(value) * unit)),
                }
            })
            .collect();
        QuantisedScene {
            view: view(camera, scale_log2),
            splats,
            scale_log2,
            colour_log2,
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

/// The least power of two, at least 1, by which all colours come below the format's 16.
fn colour_log2(colours: &[[f64; 3]]) -> i32 {
    let finite = colours.iter().flatten().filter(|value| value.is_finite());
    let largest = finite.fold(0.0f64, |largest, value| largest.max(*value));
    // The largest number of the format is a little less than 16.
    (0..1000)
        .find(|power| largest * exp2(-power) < 16.0 - exp2(-28))
        .unwrap_or(1000)
}

/// A colour in UQ4.28, saturated; rounded to odd, that is, with the last bit set where bits below it are lost.
///
/// The design rounds once more, to fewer bits. Rounded to nearest here, one colour in sixteen would lie in the middle between two numbers of
/// 24 bits there and go up: a bias of `2^-29` in every picture.
fn colour(value: f64) -> U4F28 {
    let scaled = value * exp2(28);
    let whole = scaled.clamp(0.0, u32::MAX.into()).floor();
    U4F28::from_bits(whole as u32 | u32::from(whole < scaled))
}

fn finite_or_zero(value: f64) -> f64 {
    if value.is_finite() { value } else { 0.0 }
}

/// The largest power of two by which the splats stay below 128 and the eye's translation below 256 units.
///
/// A few stray splats far outside would cost the depths of all others their precision: once they are 2^10 times farther out than half of
/// the splats they are left out here, and their depths saturate.
pub(super) fn scale_log2(centres: impl Iterator<Item = [f64; 3]>, camera: &Camera) -> i32 {
    let mut reach: Vec<f64> = centres
        .map(|centre| centre.iter().fold(0.0, |m: f64, c| m.max(c.abs())))
        .collect();
    let middle = reach.len() / 2;
    let median = match reach.is_empty() {
        true => 1.0,
        false => *reach.select_nth_unstable_by(middle, f64::total_cmp).1,
    };
    let farthest = reach
        .iter()
        .fold(0.0f64, |m, value| m.max(*value))
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

/// A double as it is: 53 bits and an exponent; non-finite values count as 0.
fn extended(value: f64) -> Extended {
    const FRACTION: u32 = f64::MANTISSA_DIGITS - 1;
    if !value.is_finite() {
        return Extended::ZERO;
    }
    let bits = value.to_bits();
    let below = (bits & ((1 << FRACTION) - 1)) as i64;
    let power = (bits >> FRACTION & 0x7ff) as i32;
    // Subnormal numbers have no leading one.
    let magnitude = if power == 0 {
        below
    } else {
        below | 1 << FRACTION
    };
    Extended {
        value: if value < 0.0 { -magnitude } else { magnitude },
        exponent: power.max(1) - 1075,
    }
}

/// A double as mantissa and exponent, rounded to nearest to 31 bits; non-finite values count as 0.
pub fn scaled(value: f64) -> Scaled {
    let Extended { value, exponent } = extended(value);
    Scaled::from_wide(value, exponent, 31)
}

pub(super) fn axis(axis: [f64; 3], scale_log2: i32) -> Axis {
    let axis = Axis::from_components(axis.map(scaled));
    Axis {
        exponent: axis.exponent + scale_log2,
        ..axis
    }
}

pub(super) fn position(centre: [f64; 3], scale_log2: i32) -> Position {
    centre.map(|value| scaled(value).scaled_by(scale_log2))
}

/// W in the kernel's two parts: 30 fraction bits to nearest, and the rest to 60.
fn rotation(rows: [[f64; 3]; 3]) -> (Rotation, [[i32; 3]; 3]) {
    let fine = rows.map(|row| row.map(|entry| (entry.clamp(-1.0, 1.0) * exp2(60)).round() as i64));
    let coarse = fine.map(|row| row.map(|entry| (entry + (1 << 29)) >> 30));
    let rest = [0, 1, 2].map(|i| [0, 1, 2].map(|j| (fine[i][j] - (coarse[i][j] << 30)) as i32));
    let entry = |bits: i64| I2F30::from_bits(bits as i32);
    (coarse.map(|row| row.map(entry)), rest)
}

/// Where the camera stands: e = -W^-1 d, by the inverse and not the transpose, so that W (u - e) is W u + d for any W.
fn eye_position(camera: &Camera) -> [f64; 3] {
    let [a, b, c] = camera.rotation;
    let cross = |u: [f64; 3], v: [f64; 3]| {
        [
            u[1] * v[2] - u[2] * v[1],
            u[2] * v[0] - u[0] * v[2],
            u[0] * v[1] - u[1] * v[0],
        ]
    };
    // Columns of the inverse are the rows' cross products over the determinant.
    let columns = [cross(b, c), cross(c, a), cross(a, b)];
    let determinant: f64 = (0..3).map(|i| a[i] * columns[0][i]).sum();
    [0, 1, 2].map(|i| {
        let sum: f64 = (0..3).map(|k| columns[k][i] * camera.translation[k]).sum();
        -sum / determinant
    })
}

/// Three doubles with one exponent; of the smaller ones the bits beyond 60 below the largest are rounded away.
fn eye(camera: &Camera, rotation_rest: [[i32; 3]; 3], scale_log2: i32) -> Eye {
    let position = eye_position(camera);
    let largest = position.iter().fold(0.0f64, |m, value| m.max(value.abs()));
    if largest == 0.0 || !largest.is_finite() {
        return Eye {
            rotation_rest,
            ..Eye::ORIGIN
        };
    }
    let leading = extended(largest).leading();
    Eye {
        position: position.map(|value| (value * exp2(58 - leading)).round() as i64),
        exponent: leading - 58 + scale_log2,
        rotation_rest,
    }
}

pub(super) fn view(camera: &Camera, scale_log2: i32) -> View {
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
    let (rotation, rotation_rest) = rotation(camera.rotation);
    let depth = |value: f64| {
        let number = extended(value);
        Extended {
            exponent: number.exponent + scale_log2,
            ..number
        }
    };
    View {
        rotation,
        pose: eye(camera, rotation_rest, scale_log2),
        focal: [
            scaled(camera.fx).scaled_by(focal_unit),
            scaled(camera.fy).scaled_by(focal_unit),
        ],
        principal: [
            I32F32::saturating_from_num(camera.cx),
            I32F32::saturating_from_num(camera.cy),
        ],
        near: depth(camera.near),
        far: if camera.far.is_finite() {
            depth(camera.far)
        } else {
            Extended::MAX
        },
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
    let threshold =
        |value: f64| (value.clamp(0.0, 1.0) * exp2(kernel::THRESHOLD as i32)).round() as u64;
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
        alpha_min: threshold(rules.alpha_min),
        stop: threshold(rules.stop),
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
