//! From a trained Gaussian's fields to a [`Splat`], and its view-dependent colour.
//!
//! Trainers store a logarithm per scale, a logit for the opacity and real spherical harmonics for the colour:
//! `rgb = 0.5 + Y_0 f_dc + sum_k Y_k(direction) f_k`, clamped at 0, the direction running from the eye to the splat.
//! The quaternion (w, x, y, z) is not always of unit length. Scene files come from strangers: a record that no
//! engine can draw is counted by its reason and left out.

use super::error::Problem;
use super::{Harmonics, Scene, Skipped, Splat};
use crate::memory;
use crate::rules::Rules;
use crate::vector;
use anyhow::bail;

/// The constant harmonic, 1 / (2 sqrt(pi)).
pub const HARMONIC_0: f64 = 0.282_094_791_773_878_14;

/// Up where y points down, as in the photographs' cameras that captures follow.
pub(super) const CAPTURE_UP: [f64; 3] = [0.0, -1.0, 0.0];

/// What a file says that was trained antialiased without saying how: gsplat's low-pass filter, and opacities
/// compensated for it.
pub(super) const TRAINED_ANTIALIASED: Rules = Rules {
    compensated: true,
    ..Rules::GAUSSIAN_3D
};

/// One Gaussian in a trainer's terms, its fields decoded but not yet checked.
#[derive(Clone, Copy, Debug)]
pub struct Gaussian {
    /// Centre, scene units.
    pub centre: [f64; 3],
    /// Standard deviations, scene units.
    pub scales: [f64; 3],
    /// w, x, y, z; any length but zero.
    pub rotation: [f64; 4],
    /// 0 to 1.
    pub opacity: f64,
    /// Colour of degree 0 before clamping.
    pub base: [f64; 3],
}

/// Peak opacity from a trained logit; +inf is 1 and -inf is 0 exactly.
pub(super) fn opacity_from_logit(logit: f64) -> f64 {
    1.0 / (1.0 + (-logit).exp())
}

/// Standard deviation from a trained logarithm. An infinite logarithm is no scale at all, not scale 0.
pub(super) fn scale_from_log(log: f64) -> f64 {
    if log.is_finite() { log.exp() } else { f64::NAN }
}

/// Colour of degree 0 from the trained constant coefficient.
pub(super) fn base_from_coefficient(coefficient: f64) -> f64 {
    0.5 + HARMONIC_0 * coefficient
}

/// Bytes of so many Gaussians.
pub(super) fn scene_bytes(degree: u8, count: u64) -> u64 {
    let coloured = coefficient_count(degree) + usize::from(degree > 0);
    let each = size_of::<Splat>() + coloured * size_of::<[f32; 3]>();
    count.saturating_mul(each as u64)
}

/// Is there room for so many Gaussians, and for so many bytes that they are unpacked to before?
pub(super) fn room_for(degree: u8, count: u64, unpacked: u64) -> Result<(), Problem> {
    let bytes = scene_bytes(degree, count).saturating_add(unpacked);
    let what = format!("{count} splats of degree {degree}");
    Ok(memory::room_for(bytes, &what, memory::FIX)?)
}

/// Collects Gaussians into a scene and counts those that cannot be drawn.
pub(super) struct GaussianScene {
    /// The rules that they were trained with; `3dgs` unless the file says otherwise.
    pub(super) rules: Rules,
    /// Coefficients of degree 1 and up of the next Gaussian.
    pub(super) harmonics: Vec<[f32; 3]>,
    splats: Vec<Splat>,
    /// Of all Gaussians.
    gathered: Harmonics,
    skipped: Skipped,
}

impl GaussianScene {
    /// With room for `count` Gaussians of this degree, which is refused if there is none.
    pub(super) fn new(degree: u8, count: u64) -> Result<Self, Problem> {
        room_for(degree, count, 0)?;
        let what = "the splats";
        let coloured = if degree > 0 { count } else { 0 };
        let each = coefficient_count(degree);
        let coefficients = count.saturating_mul(each as u64);
        Ok(GaussianScene {
            rules: Rules::GAUSSIAN_3D,
            harmonics: vec![[0.0; 3]; each],
            splats: memory::list(count, what)?,
            gathered: Harmonics {
                degree,
                coefficients: memory::list(coefficients, what)?,
                base: memory::list(coloured, what)?,
            },
            skipped: Skipped::default(),
        })
    }

    /// The same after an affine map, which takes Gaussians to Gaussians; the harmonics are the caller's matter.
    pub(super) fn push_transformed(
        &mut self,
        gaussian: &Gaussian,
        linear: &[[f64; 3]; 3],
        offset: [f64; 3],
    ) {
        let before = self.splats.len();
        self.push(gaussian);
        for splat in &mut self.splats[before..] {
            splat.centre = vector::add(vector::transform(linear, splat.centre), offset);
            splat.axes = splat.axes.map(|axis| vector::transform(linear, axis));
        }
    }

    /// Adds one Gaussian, or counts why not.
    pub(super) fn push(&mut self, gaussian: &Gaussian) {
        let harmonics = self.harmonics.as_flattened();
        if !(is_finite(gaussian) && harmonics.iter().all(|value| value.is_finite())) {
            self.skipped.non_finite += 1;
            return;
        }
        let Some(rotation) = rotation_matrix(gaussian.rotation) else {
            self.skipped.zero_rotation += 1;
            return;
        };
        self.splats.push(Splat {
            centre: gaussian.centre,
            axes: vector::scaled_columns(&rotation, gaussian.scales),
            weight: gaussian.opacity,
            colour: gaussian.base.map(|channel| channel.max(0.0)),
        });
        let gathered = &mut self.gathered;
        if gathered.degree > 0 {
            gathered.coefficients.extend_from_slice(&self.harmonics);
            let base = gaussian.base.map(|channel| channel as f32);
            gathered.base.push(base);
        }
    }

    /// The scene; a file of which nothing can be drawn is an error.
    pub(super) fn finish(self, name: &str) -> Result<Scene, Problem> {
        if self.splats.is_empty() {
            bail!(
                "splats: none is left ({} with non-finite fields, {} with a zero rotation); \
                 export the scene again",
                self.skipped.non_finite,
                self.skipped.zero_rotation
            );
        }
        Ok(Scene {
            harmonics: Some(self.gathered).filter(|harmonics| harmonics.degree > 0),
            skipped: self.skipped,
            ..Scene::of_splats(name, self.rules, self.splats)
        })
    }
}

/// Finite in single precision, the files' own: what overflows there cannot be squared safely anywhere.
fn is_finite(gaussian: &Gaussian) -> bool {
    let small = |value: &f64| (*value as f32).is_finite();
    gaussian.centre.iter().all(small)
        && gaussian.scales.iter().all(small)
        && gaussian.rotation.iter().all(small)
        && gaussian.opacity.is_finite()
        && gaussian.base.iter().all(small)
}

/// Rotation matrix of a quaternion of any length, none if the length is zero.
pub fn rotation_matrix(quaternion: [f64; 4]) -> Option<[[f64; 3]; 3]> {
    let length = quaternion
        .iter()
        .map(|part| part * part)
        .sum::<f64>()
        .sqrt();
    if length == 0.0 {
        return None;
    }
    let [w, x, y, z] = quaternion.map(|part| part / length);
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

/// RGB coefficients of degree 1 and up that a scene of this degree holds per splat.
pub(super) fn coefficient_count(degree: u8) -> usize {
    let side = usize::from(degree) + 1;
    side * side - 1
}

/// Highest degree of harmonics that any format stores.
pub(super) const MAX_DEGREE: u8 = 4;
/// Harmonics of degrees 1 to [`MAX_DEGREE`].
pub(super) const HARMONICS: usize = 24;

/// The degree that has so many RGB coefficients beyond the constant one.
pub(super) fn degree_of(coefficients: usize) -> Option<u8> {
    (0..=MAX_DEGREE).find(|degree| coefficient_count(*degree) == coefficients)
}

/// The 24 real harmonics of degrees 1 to 4 in a unit direction, in the trainers' order and signs (those of the
/// Condon-Shortley phase). Each is homogeneous, so that a direction of zero leaves the constant colour alone.
pub(super) fn harmonic_basis([x, y, z]: [f64; 3]) -> [f64; HARMONICS] {
    let (xx, yy, zz) = (x * x, y * y, z * z);
    let rr = xx + yy + zz;
    [
        -0.488_602_511_902_919_9 * y,
        0.488_602_511_902_919_9 * z,
        -0.488_602_511_902_919_9 * x,
        1.092_548_430_592_079_2 * x * y,
        -1.092_548_430_592_079_2 * y * z,
        0.315_391_565_252_520_05 * (2.0 * zz - xx - yy),
        -1.092_548_430_592_079_2 * x * z,
        0.546_274_215_296_039_6 * (xx - yy),
        -0.590_043_589_926_643_5 * y * (3.0 * xx - yy),
        2.890_611_442_640_554 * x * y * z,
        -0.457_045_799_464_465_7 * y * (4.0 * zz - xx - yy),
        0.373_176_332_590_115_4 * z * (2.0 * zz - 3.0 * xx - 3.0 * yy),
        -0.457_045_799_464_465_7 * x * (4.0 * zz - xx - yy),
        1.445_305_721_320_277 * z * (xx - yy),
        -0.590_043_589_926_643_5 * x * (xx - 3.0 * yy),
        2.503_342_941_796_704_6 * x * y * (xx - yy),
        -1.770_130_769_779_930_4 * y * z * (3.0 * xx - yy),
        0.946_174_695_757_560_1 * x * y * (7.0 * zz - rr),
        -0.669_046_543_557_289_2 * y * z * (7.0 * zz - 3.0 * rr),
        0.105_785_546_915_204_31 * (35.0 * zz * zz - 30.0 * zz * rr + 3.0 * rr * rr),
        -0.669_046_543_557_289_2 * x * z * (7.0 * zz - 3.0 * rr),
        0.473_087_347_878_780_04 * (xx - yy) * (7.0 * zz - rr),
        -1.770_130_769_779_930_4 * x * z * (xx - 3.0 * yy),
        0.625_835_735_449_176_1 * (xx * (xx - 3.0 * yy) - yy * (3.0 * xx - yy)),
    ]
}

/// Colour in one direction, clamped at 0.
pub(super) fn colour(base: [f32; 3], coefficients: &[[f32; 3]], direction: [f64; 3]) -> [f64; 3] {
    let mut sum = base.map(f64::from);
    for (harmonic, coefficient) in harmonic_basis(direction).iter().zip(coefficients) {
        for (channel, part) in sum.iter_mut().zip(coefficient) {
            *channel += harmonic * f64::from(*part);
        }
    }
    sum.map(|channel| channel.max(0.0))
}

#[cfg(test)]
#[path = "gaussian_tests.rs"]
mod tests;
