//! Scenes made from a seed, for benchmarks and hard cases: the same on every machine.
//!
//! Numbers come from SplitMix64 and only from its sequence, so a seed names a scene for good.

use super::gaussian::rotation_matrix;
use super::view::look_at;
use super::{Harmonics, Scene, Splat};
use crate::camera::Camera;
use crate::rules::Rules;
use crate::vector;

/// Splats of the deep stack.
pub const DEEP_STACK_COUNT: usize = 20_000;
/// Most splats that a random scene may ask for, so that a slip of the finger does not fill the memory.
pub const MAX_COUNT: usize = 10_000_000;

/// Centres lie within this distance of the origin along each axis.
const HALF_SIDE: f64 = 2.0;
/// Median and spread (of the natural logarithm) of a random splat's scales.
const MEDIAN_SCALE: f64 = 0.02;
const LOG_SCALE_SPREAD: f64 = 0.6;
/// Opacities of a random splat.
const OPACITIES: (f64, f64) = (0.05, 0.95);
/// The deep stack's scales, large enough that hundreds of splats cover each pixel.
const DEEP_SCALES: (f64, f64) = (0.15, 0.3);
/// What makes the deep stack deep: opacities of a random scene times this.
const DEEP_OPACITY: f64 = 0.02;

/// Distance of the synthetic scenes' camera from the origin, and its vertical field of view in degrees.
const CAMERA_DISTANCE: f64 = 5.0;
const CAMERA_DEGREES: f64 = 60.0;

/// `count` random Gaussians: centres uniform in [-2, 2]^3, log-normal scales about 0.02 times `scale_multiplier`,
/// random rotations and colours, opacities from 0.05 to 0.95.
pub fn random_gaussians(count: usize, seed: u64, scale_multiplier: f64) -> Scene {
    let scale = |random: &mut Random| {
        scale_multiplier * MEDIAN_SCALE * (LOG_SCALE_SPREAD * random.normal()).exp()
    };
    gaussians(format!("random:{count}:{seed}"), count, seed, scale, 1.0)
}

/// Gaussians of such scales, and of a random scene's opacities times `dim`.
fn gaussians(
    name: impl Into<String>,
    count: usize,
    seed: u64,
    scale: impl Fn(&mut Random) -> f64,
    dim: f64,
) -> Scene {
    let mut random = Random(seed);
    let splats = (0..count)
        .map(|_| {
            let scales = random.triple(&scale);
            let opacity = dim * random.between(OPACITIES.0, OPACITIES.1);
            random.splat(scales, opacity)
        })
        .collect();
    Scene::of_splats(name, Rules::GAUSSIAN_3D, splats)
}

/// The same splats with view-dependent colours: coefficients of all degrees up to `degree`, normal with a deviation of
/// 0.15, as trained scenes have them.
pub fn random_harmonics(count: usize, seed: u64, degree: u8) -> Scene {
    let mut scene = random_gaussians(count, seed, 1.0);
    let mut random = Random(seed ^ 0x5e_ed0f_c010);
    let mut coefficient = || [(); 3].map(|()| (0.15 * random.normal()) as f32);
    let each = (usize::from(degree) + 1).pow(2) - 1;
    scene.harmonics = Some(Harmonics {
        degree,
        coefficients: (0..count * each).map(|_| coefficient()).collect(),
        base: scene
            .splats
            .iter()
            .map(|splat| splat.colour.map(|c| c as f32))
            .collect(),
    });
    scene
}

/// 20,000 large and nearly transparent Gaussians: hundreds of layers over each pixel of [`camera`].
pub fn deep_stack(seed: u64) -> Scene {
    let scale = |random: &mut Random| random.between(DEEP_SCALES.0, DEEP_SCALES.1);
    gaussians("deep-stack", DEEP_STACK_COUNT, seed, scale, DEEP_OPACITY)
}

/// The camera of the synthetic scenes: 5 before the origin on the z axis, 60 degrees.
pub fn camera(width: usize, height: usize) -> Camera {
    look_at(
        [0.0, 0.0, -CAMERA_DISTANCE],
        [0.0; 3],
        [0.0, -1.0, 0.0],
        CAMERA_DEGREES,
        width,
        height,
    )
}

/// Whether a scene's name is one of this module's.
pub(super) fn is_synthetic(name: &str) -> bool {
    name == "deep-stack" || name.starts_with("random:")
}

/// SplitMix64 (Steele, Lea, Flood 2014), from its state: the numbers are those of any host.
#[derive(Clone, Debug)]
pub struct Random(pub u64);

impl Random {
    /// 64 bits.
    #[allow(clippy::should_implement_trait)]
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    /// Uniform in [0, 1).
    pub fn uniform(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Uniform in [low, high).
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.uniform()
    }

    /// Standard normal (Box and Muller).
    pub fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.uniform()).ln()).sqrt();
        radius * (std::f64::consts::TAU * self.uniform()).cos()
    }

    /// Three draws.
    pub fn triple(&mut self, mut draw: impl FnMut(&mut Self) -> f64) -> [f64; 3] {
        std::array::from_fn(|_| draw(self))
    }

    /// Four normal numbers point in a uniform direction, which makes a uniform rotation.
    pub fn rotation(&mut self) -> [[f64; 3]; 3] {
        let quaternion = std::array::from_fn(|_| self.normal());
        rotation_matrix(quaternion).unwrap_or(vector::diagonal([1.0; 3]))
    }

    fn splat(&mut self, scales: [f64; 3], opacity: f64) -> Splat {
        Splat {
            centre: self.triple(|random| random.between(-HALF_SIDE, HALF_SIDE)),
            axes: vector::scaled_columns(&self.rotation(), scales),
            weight: opacity,
            colour: self.triple(Self::uniform),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_seed_names_a_scene() {
        let scene = random_gaussians(100, 7, 1.0);
        assert_eq!(scene, random_gaussians(100, 7, 1.0));
        assert_ne!(scene.splats, random_gaussians(100, 8, 1.0).splats);
        // SplitMix64's published first output for seed 0.
        assert_eq!(Random(0).next(), 0xe220_a839_7b1d_cdaf);
    }

    #[test]
    fn random_scenes_follow_their_description() {
        let scene = random_gaussians(20_000, 1, 3.0);
        let mut logs = Vec::new();
        for splat in &scene.splats {
            assert!(splat.centre.iter().all(|part| part.abs() <= 2.0));
            assert!((0.05..0.95).contains(&splat.weight));
            assert!(
                splat
                    .colour
                    .iter()
                    .all(|channel| (0.0..1.0).contains(channel))
            );
            logs.extend(
                splat
                    .axes
                    .map(|axis| axis.iter().map(|part| part * part).sum::<f64>().ln() / 2.0),
            );
        }
        let mean = logs.iter().sum::<f64>() / logs.len() as f64;
        let variance = logs.iter().map(|log| (log - mean).powi(2)).sum::<f64>() / logs.len() as f64;
        assert!(
            (mean - 0.06f64.ln()).abs() < 0.01,
            "median scale {}",
            mean.exp()
        );
        assert!(
            (variance.sqrt() - 0.6).abs() < 0.01,
            "spread {}",
            variance.sqrt()
        );
    }

    #[test]
    fn hundreds_of_layers_of_the_deep_stack_cover_each_pixel() {
        let scene = deep_stack(1);
        assert_eq!(scene.splats.len(), 20_000);
        let camera = camera(64, 64);
        // Counted low: only where the ray comes within two of the smallest scale of the centre.
        for (i, j) in [(32, 32), (12, 20), (50, 44), (10, 54)] {
            let x = (i as f64 + 0.5 - camera.cx) / camera.fx;
            let y = (j as f64 + 0.5 - camera.cy) / camera.fy;
            let covers = |splat: &&Splat| {
                let z = splat.centre[2] + CAMERA_DISTANCE;
                (splat.centre[0] - x * z).hypot(splat.centre[1] - y * z) < 2.0 * DEEP_SCALES.0
            };
            let layers = scene.splats.iter().filter(covers).count();
            assert!(layers > 120, "{layers} layers at ({i}, {j})");
        }
    }
}
