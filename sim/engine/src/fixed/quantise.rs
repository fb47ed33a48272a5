//! From double precision to the kernel's input formats.
//!
//! The numbers themselves are converted by the kernel's own front door ([`splatline::float`]); here is what depends on
//! a whole scene. Only what the kernel keeps in fixed point needs a unit. Colours above its range are divided by a
//! power of two, which the resolve multiplies again. Depths of sheets, gathered points and surfaces are UQ9.23, so that
//! their scenes are multiplied by a power of two that fills that range; a power of two moves no bit of any other
//! result.

use crate::camera::Camera;
use crate::metrics::median;
use crate::rules::{Compositing, Kernel, Rules};
use crate::scene::{Scene, SortOrder, Splat};
use rayon::prelude::*;
use splatline::float;
pub(super) use splatline::float::exp2;
pub use splatline::float::scaled;
use splatline::footprint::{Footprint, depth};
use splatline::format::Widths;
use splatline::kernel as shapes;
use splatline::math::Extended;
use splatline::rules as kernel;
use splatline::setup::Cull;
use splatline::splat::{Axis, Position, VolumeSplat};
use splatline::view::{Pose, Projection, View};

/// A scene and its camera in the kernel's formats.
#[derive(Clone, Debug, PartialEq)]
pub struct QuantisedScene {
    /// The camera.
    pub view: View,
    /// The kernel's statement of the rules that weighed the splats, lengths in the kernel's scene units.
    pub rules: kernel::Rules,
    /// The splats, in the scene's order.
    pub splats: Vec<VolumeSplat>,
    /// Kernel scene units per scene unit, as a power of two; 0 where no depth is kept in fixed point.
    pub scale_log2: i32,
    /// Unit of the colours as a power of two: they were divided by it, and pictures are to be multiplied by it.
    pub colour_log2: i32,
    /// Splats of which a value has no place in the kernel's formats: a colour or coordinate that is not finite.
    pub clamped: usize,
    /// What its splats are sorted by.
    pub order: SortOrder,
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
        let (quantiser, mut quantised) = Quantiser::new(scene, camera, rules, scale_log2);
        quantiser.append(&scene.splats, &mut quantised);
        quantised
    }

    /// The same of a scene that is left without splats: their memory is given back as they are quantised, since a
    /// million of them take 128 MB. Splats whose colours depend on the view are kept, for
    /// [`QuantisedScene::set_camera`].
    pub fn releasing(scene: &mut Scene, camera: &Camera, rules: &Rules) -> Self {
        if scene.harmonics.is_some() {
            return QuantisedScene::new(scene, camera, rules);
        }
        let (quantiser, mut quantised) = Quantiser::new(scene, camera, rules, 0);
        let splats = &mut scene.splats;
        while !splats.is_empty() {
            // From the back, where a list can be shortened.
            let first = splats.len().saturating_sub(RELEASED);
            let already = quantised.splats.len();
            quantiser.append(&splats[first..], &mut quantised);
            quantised.splats[already..].reverse();
            splats.truncate(first);
            splats.shrink_to_fit();
        }
        quantised.splats.reverse();
        quantised
    }

    /// The same scene seen by another camera: only the view, and colours where they depend on it.
    pub fn set_camera(&mut self, scene: &Scene, camera: &Camera) {
        self.view = view(camera, self.scale_log2);
        if scene.harmonics.is_none() {
            return;
        }
        let colours = scene.colours(camera);
        self.colour_log2 = colour_log2(colours.iter());
        let unit = exp2(-self.colour_log2);
        let splats = self.splats.par_iter_mut();
        splats.zip(&colours).for_each(|(splat, colour)| {
            splat.colour = colour.map(|value| float::colour(finite_or_zero(value) * unit));
        });
    }

    /// After setup of these splats: where the scene is sorted by distance, footprints get the key of the distance in
    /// the place of the depth's.
    ///
    /// A key is a number that splats are sorted by and nothing else, so that all that sorts them, on the host and in
    /// the machine's model, need not know which of the two it is.
    pub fn sort_keys(
        &self,
        widths: &Widths,
        splats: &[VolumeSplat],
        outcomes: &mut [Result<Footprint, Cull>],
    ) {
        if self.order == SortOrder::Depth || self.view.projection == Projection::Orthographic {
            return;
        }
        for (splat, outcome) in splats.iter().zip(outcomes) {
            if let Ok(footprint) = outcome {
                footprint.depth = distance_key(&self.view, widths, &splat.centre);
            }
        }
    }
}

/// The sort key of the distance sqrt(x^2 + y^2 + z^2) from the eye, of the words in camera space whose z is the depth.
///
/// The sum of squares is exact, and its root has 62 bits, of which a key holds 39.
fn distance_key(view: &View, widths: &Widths, centre: &Position) -> u64 {
    let point = view.pose.to_camera(&view.rotation, centre, widths);
    let square = |word: i64| u128::from(word.unsigned_abs()).pow(2);
    // Three squares of at most 2^126: below 2^128.
    let sum: u128 = point.value.map(square).into_iter().sum();
    // By an even number of places, so that the root moves by half of it.
    let up = sum.leading_zeros().min(126) & !1;
    depth::key(Extended {
        value: ((sum << up).isqrt() >> 1) as i64,
        exponent: point.exponent.saturating_add(1 - up as i32 / 2),
    })
}

/// Splats that are quantised before the memory of as many is given back.
const RELEASED: usize = 1 << 16;

/// What is the same for all splats of a scene.
struct Quantiser {
    /// Colours that depend on the view; none if they are the splats' own.
    colours: Vec<[f64; 3]>,
    weigh: fn(&Splat) -> f64,
    scale_log2: i32,
    weight_log2: i32,
    /// What colours are multiplied by.
    unit: f64,
}

impl Quantiser {
    /// With a scene that has no splats yet, but room for them.
    fn new(
        scene: &Scene,
        camera: &Camera,
        rules: &Rules,
        scale_log2: i32,
    ) -> (Self, QuantisedScene) {
        let colours = match scene.harmonics {
            Some(_) => scene.colours(camera),
            None => Vec::new(),
        };
        let own = scene.splats.iter().map(|splat| &splat.colour);
        let own = own.take_while(|_| scene.harmonics.is_none());
        let colour_log2 = colour_log2(own.chain(&colours));
        let quantiser = Quantiser {
            colours,
            weigh: scene.weighing(rules),
            scale_log2,
            weight_log2: if rules.normalised { 2 * scale_log2 } else { 0 },
            unit: exp2(-colour_log2),
        };
        let stated = kernel_rules(rules);
        let quantised = QuantisedScene {
            view: view(camera, scale_log2),
            rules: kernel::Rules {
                spacing: stated.spacing.scaled_by(scale_log2),
                ..stated
            },
            splats: Vec::with_capacity(scene.splats.len()),
            scale_log2,
            colour_log2,
            clamped: 0,
            order: scene.order,
        };
        (quantiser, quantised)
    }

    fn colour<'a>(&'a self, index: usize, splat: &'a Splat) -> &'a [f64; 3] {
        self.colours.get(index).unwrap_or(&splat.colour)
    }

    fn splat(&self, index: usize, splat: &Splat) -> VolumeSplat {
        let colour = self.colour(index, splat);
        VolumeSplat {
            centre: position(splat.centre, self.scale_log2),
            axes: splat.axes.map(|axis| self::axis(axis, self.scale_log2)),
            weight: scaled((self.weigh)(splat)).scaled_by(self.weight_log2),
            colour: colour.map(|value| float::colour(finite_or_zero(value) * self.unit)),
        }
    }

    /// Adds the scene's splats, or some of a scene whose colours are the splats' own, on all cores.
    fn append(&self, splats: &[Splat], to: &mut QuantisedScene) {
        let numbered = splats.par_iter().enumerate();
        let quantised = numbered.map(|(index, splat)| self.splat(index, splat));
        to.splats.par_extend(quantised);
        let beyond = |(index, splat): &(usize, &Splat)| {
            let mut values = splat.centre.iter().chain(self.colour(*index, splat));
            !values.all(|value| value.is_finite())
        };
        to.clamped += splats.par_iter().enumerate().filter(beyond).count();
    }
}

/// The least power of two, at least 1, by which all colours come below 8, the end of every named design's formats.
fn colour_log2<'a>(colours: impl Iterator<Item = &'a [f64; 3]>) -> i32 {
    let finite = colours.flatten().filter(|value| value.is_finite());
    let largest = finite.fold(0.0f64, |largest, value| largest.max(*value));
    (0..1000)
        .find(|power| largest * exp2(-power) < 8.0 - exp2(-14))
        .unwrap_or(1000)
}

fn finite_or_zero(value: f64) -> f64 {
    if value.is_finite() { value } else { 0.0 }
}

/// The largest power of two by which the splats stay below 128 and the eye's translation below 256 units.
///
/// A few stray splats far outside would cost the depths of all others their precision: once they are 2^10 times farther
/// out than half of the splats they are left out here, and their depths saturate.
pub(super) fn scale_log2(centres: impl Iterator<Item = [f64; 3]>, camera: &Camera) -> i32 {
    let mut reach: Vec<f64> = centres
        .map(|centre| centre.iter().fold(0.0, |m: f64, c| m.max(c.abs())))
        .collect();
    let median = median(&mut reach).unwrap_or(1.0);
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

pub(super) fn axis(axis: [f64; 3], scale_log2: i32) -> Axis {
    let axis = float::axis(axis);
    Axis {
        exponent: axis.exponent + scale_log2,
        ..axis
    }
}

pub(super) fn position(centre: [f64; 3], scale_log2: i32) -> Position {
    float::position(centre).map(|coordinate| coordinate.scaled_by(scale_log2))
}

/// The kernel's view, in units in which the scene fills the range of fixed depths.
pub(super) fn view(camera: &Camera, scale_log2: i32) -> View {
    let size = |pixels: usize| u16::try_from(pixels).unwrap_or(u16::MAX);
    splatline::Camera {
        size: [size(camera.width), size(camera.height)],
        focal: [camera.fx, camera.fy],
        principal: [camera.cx, camera.cy],
        rotation: camera.rotation,
        translation: camera.translation,
        near: camera.near,
        far: camera.far,
        projection: if camera.orthographic {
            Projection::Orthographic
        } else {
            Projection::Perspective
        },
    }
    .quantised(scale_log2)
}

/// The kernel's statement of the same rules, lengths in the scene's own units.
pub fn kernel_rules(rules: &Rules) -> kernel::Rules {
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
        compensated: rules.compensated,
        spacing: scaled(rules.spacing),
        kernel: shape,
        cutoff: if radial {
            kernel::Cutoff::Radial(float::radial_cutoff(rules.cutoff))
        } else {
            kernel::Cutoff::Opacity
        },
        alpha_max: float::opacity_limit(rules.alpha_max),
        alpha_min: float::threshold(rules.alpha_min),
        minimum_transmittance: float::threshold(rules.minimum_transmittance),
        omit_finishing: rules.omit_finishing,
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

    /// Whatever the magnitude, the key is that of the reference's distance; at the eye it is that of 0.
    #[test]
    fn distance_keys_are_distances() {
        let target = [0.5, -1.0, 2.0];
        let camera = Camera::look_at([0.0; 3], target, [0.0, -1.0, 0.0], 50.0, 64, 64).unwrap();
        let (view, widths) = (view(&camera, 0), splatline::format::Deep32::WIDTHS);
        let key = |place: [f64; 3]| distance_key(&view, &widths, &position(place, 0));
        for power in -60..=60 {
            for direction in [[1.0, 0.0, 0.0], [-0.3, 0.4, -2.0], [0.1, -5.0, 1e-3]] {
                let place = direction.map(|part| part * exp2(power));
                let Extended { value, exponent } = depth::number(key(place));
                let found = value as f64 * f64::from(exponent).exp2();
                let expected = SortOrder::Distance.place(&camera, place);
                let error = (found / expected - 1.0).abs();
                assert!(error < 1e-8, "2^{power}: {found} {expected}");
            }
        }
        assert_eq!(key([0.0; 3]), depth::key(Extended::ZERO));
    }

    #[test]
    fn released_scenes_are_quantised_alike() {
        use crate::scene::synthetic::{camera, random_gaussians, random_harmonics};
        let mut bad = random_gaussians(2 * RELEASED + 3, 1, 1.0);
        bad.splats[5].centre[1] = f64::NAN;
        bad.splats[7].colour[2] = 40.0;
        let camera = camera(8, 8);
        for (mut scene, left) in [(bad, 0), (random_harmonics(50, 1, 2), 50)] {
            let expected = QuantisedScene::new(&scene, &camera, &Rules::GAUSSIAN_3D);
            let found = QuantisedScene::releasing(&mut scene, &camera, &Rules::GAUSSIAN_3D);
            assert_eq!(found, expected);
            assert_eq!(scene.splats.len(), left);
        }
    }

    #[test]
    fn both_statements_of_the_rules_agree() {
        assert_eq!(kernel_rules(&Rules::EWA), kernel::Rules::EWA);
        assert_eq!(
            kernel_rules(&Rules::GAUSSIAN_3D),
            kernel::Rules::GAUSSIAN_3D
        );
    }

    /// A Gaussian of the kernel's front door and the same one of a file become the same splat.
    #[test]
    fn both_front_doors_make_the_same_splats() {
        use crate::scene::{Splat, rotation_matrix};
        let mut state = 7u32;
        let mut next = |from: f32, to: f32| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            from + (to - from) * (state >> 8) as f32 / 16_777_216.0
        };
        let gaussians: Vec<_> = (0..500)
            .map(|_| splatline::Gaussian {
                mean: [next(-9.0, 9.0), next(-9.0, 9.0), next(-9.0, 9.0)],
                rotation: [(); 4].map(|()| next(-1.0, 1.0)),
                scales: [(); 3].map(|()| next(0.0, 0.5)),
                opacity: next(0.0, 1.0),
                colour: [(); 3].map(|()| next(0.0, 2.0)),
            })
            .collect();
        let splat = |g: &splatline::Gaussian| {
            let rotation = rotation_matrix(g.rotation.map(f64::from)).unwrap();
            let axis = |k: usize| [0, 1, 2].map(|row| rotation[row][k] * f64::from(g.scales[k]));
            Splat {
                centre: g.mean.map(f64::from),
                axes: [axis(0), axis(1), axis(2)],
                weight: g.opacity.into(),
                colour: g.colour.map(f64::from),
            }
        };
        let splats = gaussians.iter().map(splat).collect();
        let scene = Scene::of_splats("front", Rules::GAUSSIAN_3D, splats);
        let camera = Camera::look_at([0.0, 0.0, -9.0], [0.0; 3], scene.up, 50.0, 64, 64).unwrap();
        let quantised = QuantisedScene::new(&scene, &camera, &Rules::GAUSSIAN_3D);
        let expected: Vec<_> = gaussians.iter().map(|g| g.splat().unwrap()).collect();
        assert_eq!(quantised.splats, expected);
    }
}
