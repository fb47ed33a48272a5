//! Properties of both reference engines, against oracles that are written once more and naively.

use super::oracle::{Engine, naive_picture};
use super::scenes::{scene_of, straight_camera};
use proptest::prelude::*;
use splatline_reference::camera::Camera;
use splatline_reference::engines::compositor::{self, ScreenSplat};
use splatline_reference::engines::golden::rotated_axes;
use splatline_reference::engines::{Culled, FloatDrawing, exact, float};
use splatline_reference::picture::Picture;
use splatline_reference::rules::{Compositing, Rules};
use splatline_reference::scene::{Scene, Splat, Weight};
use splatline_reference::vector;

const COMPOSITINGS: [Compositing; 3] = [
    Compositing::FrontToBack,
    Compositing::BackToFront,
    Compositing::XRay,
];

/// Rules without thresholds, under which a rounding error cannot switch a pixel on or off.
const SMOOTH: Rules = Rules {
    alpha_min: 0.0,
    minimum_transmittance: 0.0,
    ..Rules::GAUSSIAN_3D
};

/// A small camera, slightly turned, with oblong pixels and its principal point beside the centre.
fn camera(orthographic: bool) -> Camera {
    let turned = Camera::look_at(
        [0.1, 0.2, -0.3],
        [0.15, 0.1, 1.0],
        [0.1, -1.0, 0.0],
        60.0,
        48,
        40,
    )
    .unwrap();
    let focal_length = if orthographic { 8.0 } else { turned.fx };
    Camera {
        fx: focal_length,
        fy: 1.1 * focal_length,
        cx: 22.7,
        cy: 21.2,
        far: 7.0,
        orthographic,
        ..turned
    }
}

fn draw(
    engine: Engine,
    scene: &Scene,
    camera: &Camera,
    rules: &Rules,
    compositing: Compositing,
) -> FloatDrawing {
    match engine {
        Engine::Float => float::draw(scene, camera, rules, compositing),
        Engine::Exact => exact::draw(scene, camera, rules, compositing),
    }
}

fn largest_difference(a: &Picture, b: &Picture) -> f64 {
    assert_eq!(
        (a.width, a.height, a.pixels.len()),
        (b.width, b.height, b.pixels.len())
    );
    let channels = a.pixels.iter().flatten().zip(b.pixels.iter().flatten());
    // Of two infinities of one sign there is no difference.
    let unequal = channels.filter(|(a, b)| a != b);
    unequal.fold(0.0, |largest, (a, b)| f64::max(largest, (a - b).abs()))
}

/// Every splat at every pixel, through the engine's own opacity but without its bounds, bins and tiles.
fn every_splat_at_every_pixel<P: ScreenSplat>(
    projected: &[Result<P, Culled>],
    camera: &Camera,
    rules: &Rules,
    compositing: Compositing,
) -> Picture {
    let order = compositor::order(projected);
    super::oracle::gather(camera, rules, compositing, &order, |index, point| {
        let splat = projected[index].as_ref().ok()?;
        Some((
            compositor::opacity(splat, point, rules)?,
            splat.on_screen().colour,
        ))
    })
}

prop_compose! {
    /// Splats before and behind the eye, from specks to larger than the picture, needles and discs among them.
    fn any_splat()(
        centre in [-4.0..4.0, -4.0..4.0, -1.0..8.0],
        quaternion in [-1.0..1.0, -1.0..1.0, -1.0..1.0, 0.1..1.0],
        logarithms in [-6.0..0.7, -6.0..0.7, -6.0..0.7],
        weight in prop_oneof![0.0..1.0, Just(1.0), Just(0.0), 0.0..0.02],
        colour in [0.0..1.0, 0.0..1.0, 0.0..1.5],
    ) -> Splat {
        Splat { centre, axes: rotated_axes(quaternion, logarithms.map(f64::exp)), weight, colour }
    }
}

fn any_rules() -> impl Strategy<Value = Rules> {
    prop_oneof![Just(Rules::EWA), Just(Rules::GAUSSIAN_3D), Just(SMOOTH)]
}

fn any_engine() -> impl Strategy<Value = Engine> {
    prop_oneof![Just(Engine::Float), Just(Engine::Exact)]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn tiles_equal_a_loop_over_everything(
        splats in prop::collection::vec(any_splat(), 1..40),
        rules in any_rules(),
        orthographic: bool,
    ) {
        let (scene, camera) = (scene_of(splats), camera(orthographic));
        for compositing in COMPOSITINGS {
            let projected = float::footprints(&scene, &camera, &rules);
            let naive = every_splat_at_every_pixel(&projected, &camera, &rules, compositing);
            let drawn = float::draw(&scene, &camera, &rules, compositing).picture;
            prop_assert!(largest_difference(&drawn, &naive) <= 1e-12, "float {compositing:?}");
            let projected = exact::footprints(&scene, &camera, &rules);
            let naive = every_splat_at_every_pixel(&projected, &camera, &rules, compositing);
            let drawn = exact::draw(&scene, &camera, &rules, compositing).picture;
            prop_assert!(largest_difference(&drawn, &naive) <= 1e-12, "exact {compositing:?}");
        }
    }

    #[test]
    fn engines_equal_the_formulas_written_once_more(
        splats in prop::collection::vec(any_splat(), 1..12),
        rules in any_rules(),
        engine in any_engine(),
        orthographic: bool,
    ) {
        let (mut scene, camera) = (scene_of(splats), camera(orthographic));
        scene.weight = if rules.normalised { Weight::Mass } else { Weight::Opacity };
        for compositing in COMPOSITINGS {
            let drawn = draw(engine, &scene, &camera, &rules, compositing).picture;
            let naive = naive_picture(engine, &scene, &camera, &rules, compositing);
            let difference = largest_difference(&drawn, &naive);
            prop_assert!(difference <= 1e-7, "{engine:?} {compositing:?}: {difference:e}");
        }
    }

    #[test]
    fn turning_the_world_with_the_camera_changes_nothing(
        splats in prop::collection::vec(any_splat(), 1..20),
        quaternion in [-1.0..1.0, -1.0..1.0, -1.0..1.0, 0.1..1.0],
        shift in [-5.0..5.0, -5.0..5.0, -5.0..5.0],
        engine in any_engine(),
    ) {
        let camera = camera(false);
        let turn = rotated_axes(quaternion, [1.0; 3]);
        let moved = |point| vector::add(vector::transform(&turn, point), shift);
        let turned_splat = |splat: &Splat| Splat {
            centre: moved(splat.centre),
            axes: splat.axes.map(|axis| vector::transform(&turn, axis)),
            ..*splat
        };
        let rotation = camera.rotation.map(|row| vector::transform(&turn, row));
        let translation = vector::subtract(camera.translation, vector::transform(&rotation, shift));
        let turned_camera = Camera { rotation, translation, ..camera.clone() };
        let turned = scene_of(splats.iter().map(turned_splat).collect());
        let before = draw(engine, &scene_of(splats), &camera, &SMOOTH, Compositing::FrontToBack);
        let after = draw(engine, &turned, &turned_camera, &SMOOTH, Compositing::FrontToBack);
        let difference = largest_difference(&before.picture, &after.picture);
        prop_assert!(difference <= 1e-9, "{engine:?}: {difference:e}");
    }

    #[test]
    fn variance_is_positive_and_the_conic_is_its_inverse(splat in any_splat(), rules in any_rules()) {
        let splat = Splat { weight: 0.5, ..splat };
        let Ok(footprint) = float::project(&splat, &camera(false), &rules) else {
            return Err(TestCaseError::reject("culled"));
        };
        let v = footprint.variance;
        let [a, b, c] = footprint.variance.conic();
        prop_assert!(v.a > 0.0 && v.c > 0.0 && v.determinant > 0.0);
        prop_assert!(v.determinant >= rules.low_pass * rules.low_pass);
        prop_assert!((v.a * a + v.b * b - 1.0).abs() <= 1e-12 * v.a * a);
        prop_assert!((v.b * b + v.c * c - 1.0).abs() <= 1e-12 * v.c * c);
        for [x, y] in [[1.0, 0.0], [0.3, -2.0], [-5.0, 4.0]] {
            let r = a * x * x + 2.0 * b * x * y + c * y * y;
            let size = a * x * x + c * y * y;
            prop_assert!((v.radial_index([x, y]) - r).abs() <= 1e-12 * size);
            prop_assert!(r >= -1e-12 * size);
        }
    }

    #[test]
    fn splats_are_all_accounted_for(
        splats in prop::collection::vec(any_splat(), 0..40),
        rules in any_rules(),
        engine in any_engine(),
    ) {
        let expected = splats.len();
        let counts = draw(engine, &scene_of(splats), &camera(false), &rules, Compositing::FrontToBack).counts;
        let reasons = [Culled::Near, Culled::Far, Culled::OutsideViewport, Culled::Transparent, Culled::Degenerate, Culled::NonFinite];
        let culled: usize = reasons.map(|reason| counts.culled(reason)).iter().sum();
        prop_assert_eq!(counts.splats, expected);
        prop_assert_eq!(counts.drawn + culled, expected);
    }

    #[test]
    fn no_bit_pattern_panics_or_spoils_the_picture(
        numbers in prop::collection::vec(prop::num::f64::ANY, 32),
        ordinary in any_splat(),
        choose in prop::collection::vec(any::<bool>(), 32),
        rules in any_rules(),
        engine in any_engine(),
        orthographic: bool,
    ) {
        let mut hostile = numbers.into_iter().zip(choose);
        // Half of the numbers stay ordinary, so that the hostile ones get past the first check.
        let mut mixed = |usual: f64| hostile.next().map_or(usual, |(n, replace)| if replace { n } else { usual });
        let splat = Splat {
            centre: ordinary.centre.map(&mut mixed),
            axes: ordinary.axes.map(|axis| axis.map(&mut mixed)),
            weight: mixed(ordinary.weight),
            colour: ordinary.colour,
        };
        let usual = camera(orthographic);
        let strange = Camera {
            fx: mixed(usual.fx),
            cx: mixed(usual.cx),
            near: mixed(usual.near),
            far: mixed(usual.far),
            translation: usual.translation.map(&mut mixed),
            ..usual.clone()
        };
        for camera in [usual, strange] {
            for compositing in COMPOSITINGS {
                let scene = scene_of(vec![splat, ordinary]);
                let drawing = draw(engine, &scene, &camera, &rules, compositing);
                prop_assert!(drawing.picture.pixels.iter().flatten().all(|channel| channel.is_finite()));
                prop_assert_eq!(drawing.counts.splats, 2);
            }
        }
    }

    #[test]
    fn exact_is_the_integral_along_the_ray(
        splat in any_splat(),
        column in 0.0..48.0,
        row in 0.0..40.0,
    ) {
        let camera = Camera { far: 1e10, ..straight_camera() };
        let splat = Splat { centre: [splat.centre[0], splat.centre[1], splat.centre[2].abs() + 0.5], weight: 1.0, ..splat };
        // All of the picture, however faint.
        let everything = Rules { cutoff: f64::INFINITY, ..Rules::EWA };
        let projected = exact::project(&splat, &camera, &everything).unwrap();
        let (r, peak) = projected.radial_index_and_peak([column, row]);
        let (integral, smallest) = super::oracle::integral_and_distance(&splat, &camera, [column, row], 1.0);
        let closed_form = peak * (-0.5 * r).exp();
        prop_assert!((r - smallest).abs() <= 1e-6 * (1.0 + smallest), "r {r}, sampled {smallest}");
        prop_assert!((closed_form - integral).abs() <= 1e-6 * (peak + integral), "{closed_form} {integral}");
    }
}

/// 2D Gaussians by their own formula (Huang et al., SIGGRAPH 2024, eq. 4): where the ray meets the splat's plane, the
/// two axes' coordinates are the Gaussian's. `exact` draws axes of length 0 by its limit.
#[test]
fn flat_splats_are_where_rays_meet_their_planes() {
    let camera = straight_camera();
    let mut shown = 0;
    for (turn, centre) in [
        ([1.0, 0.2, -0.3, 0.1], [0.2, -0.1, 3.0]),
        ([0.4, 0.7, 0.2, -0.5], [-0.4, 0.3, 2.0]),
        ([0.9, -0.5, 0.4, 0.3], [0.0, 0.0, 5.0]),
    ] {
        let [a, b, _] = rotated_axes(turn, [0.5, 0.2, 0.0]);
        let splat = Splat {
            centre,
            axes: [a, b, [0.0; 3]],
            weight: 0.8,
            colour: [1.0; 3],
        };
        let rules = Rules {
            low_pass: 0.0,
            ..SMOOTH
        };
        let scene = scene_of(vec![splat]);
        let picture = exact::draw(&scene, &camera, &rules, Compositing::FrontToBack).picture;
        for (at, pixel) in picture.pixels.iter().enumerate() {
            let [x, y] = [at % picture.width, at / picture.width].map(|place| place as f64 + 0.5);
            let [across, down] = camera.slopes([x, y]);
            let ray = [across, down, 1.0];
            // t ray = centre + u a + v b.
            let columns = [0, 1, 2].map(|k: usize| [ray[k], -a[k], -b[k]]);
            let [_, u, v] = vector::solve(&columns, centre);
            let expected = 0.8 * (-0.5 * (u * u + v * v)).exp();
            if expected > 1e-3 {
                assert!(
                    (pixel[3] - expected).abs() < 1e-9,
                    "{turn:?} {x} {y}: {} {expected}",
                    pixel[3]
                );
                shown += 1;
            }
        }
    }
    assert!(shown > 300, "{shown}");
}

#[test]
fn exact_converges_to_float_for_small_splats() {
    let camera = camera(false);
    for centre in [[0.0, 0.0, 4.0], [1.0, -0.8, 4.0]] {
        for rules in [
            Rules {
                cutoff: 30.0,
                ..Rules::EWA
            },
            SMOOTH,
        ] {
            let difference = |size: f64| {
                let axes = rotated_axes([0.3, 0.8, -0.5, 0.4], [size, 0.6 * size, 0.3 * size]);
                let weight = if rules.normalised { size * size } else { 0.7 };
                let scene = scene_of(vec![Splat {
                    centre,
                    axes,
                    weight,
                    colour: [1.0; 3],
                }]);
                let draw = |engine| {
                    draw(engine, &scene, &camera, &rules, Compositing::FrontToBack).picture
                };
                largest_difference(&draw(Engine::Float), &draw(Engine::Exact))
            };
            let [large, small, tiny] = [0.4, 0.04, 0.004].map(difference);
            assert!(
                small < 0.2 * large && tiny < 0.2 * small && tiny < 1e-4,
                "{} at {centre:?}: {large:e}, {small:e}, {tiny:e}",
                rules.name
            );
        }
    }
}

#[test]
fn both_engines_agree_in_parallel_projection() {
    let axes = rotated_axes([0.3, 0.8, -0.5, 0.4], [1.0, 0.2, 0.05]);
    let scene = scene_of(vec![Splat {
        centre: [0.4, -0.3, 2.0],
        axes,
        weight: 0.7,
        colour: [0.2, 0.5, 1.0],
    }]);
    for rules in [Rules::EWA, Rules::GAUSSIAN_3D] {
        let (camera, order) = (camera(true), Compositing::FrontToBack);
        let draw = |engine| draw(engine, &scene, &camera, &rules, order).picture;
        let float = draw(Engine::Float);
        assert!(largest_difference(&float, &draw(Engine::Exact)) <= 1e-14);
        assert!(float.pixels.iter().any(|pixel| pixel[3] > 0.1));
    }
}

#[test]
fn splats_are_culled_for_the_right_reason() {
    let camera = straight_camera();
    let axes = rotated_axes([1.0, 0.0, 0.0, 0.0], [0.1; 3]);
    let culled = |centre: [f64; 3], weight: f64, rules: &Rules| {
        let splat = Splat {
            centre,
            axes,
            weight,
            colour: [1.0; 3],
        };
        float::project(&splat, &camera, rules).err()
    };
    let (rules, ewa, ahead) = (Rules::GAUSSIAN_3D, Rules::EWA, [0.0, 0.0, 2.0]);
    for (centre, weight, rules, expected) in [
        (ahead, 0.5, rules, None),
        ([0.0, 0.0, camera.near], 0.5, rules, Some(Culled::Near)),
        ([0.0, 0.0, -2.0], 0.5, rules, Some(Culled::Near)),
        ([0.0, 0.0, camera.far], 0.5, rules, Some(Culled::Far)),
        ([9.0, 0.0, 2.0], 0.5, rules, Some(Culled::OutsideViewport)),
        (ahead, 0.9 / 255.0, rules, Some(Culled::Transparent)),
        (ahead, 0.9 / 255.0, ewa, None),
        (ahead, 0.0, ewa, Some(Culled::Transparent)),
        (ahead, f64::NAN, rules, Some(Culled::NonFinite)),
        (
            [0.0, f64::INFINITY, 2.0],
            0.5,
            rules,
            Some(Culled::NonFinite),
        ),
    ] {
        assert_eq!(
            culled(centre, weight, &rules),
            expected,
            "{centre:?} {weight}"
        );
    }
    let vast = Splat {
        centre: [0.0, 0.0, 2.0],
        axes: [[1e200; 3]; 3],
        weight: 0.5,
        colour: [1.0; 3],
    };
    let found = float::project(&vast, &camera, &rules).err();
    assert_eq!(found, Some(Culled::Degenerate));
}

#[test]
fn a_normalised_splat_carries_its_mass_to_the_screen() {
    // On the axis at depth z a mass covers fx fy / z^2 times as many square pixels, whatever the splat's shape.
    let camera = straight_camera();
    let rules = Rules {
        cutoff: 60.0,
        ..Rules::EWA
    };
    let axes = rotated_axes([0.3, 0.8, -0.5, 0.4], [0.15, 0.1, 0.02]);
    let mut scene = scene_of(vec![Splat {
        centre: [0.0, 0.0, 4.0],
        axes,
        weight: 0.001,
        colour: [1.0; 3],
    }]);
    scene.weight = Weight::Mass;
    let picture = float::draw(&scene, &camera, &rules, Compositing::XRay).picture;
    let sum: f64 = picture.pixels.iter().map(|pixel| pixel[3]).sum();
    let expected = 0.001 * camera.fx * camera.fy / 16.0;
    assert!(
        (sum / expected - 1.0).abs() < 1e-6,
        "{sum} instead of {expected}"
    );
}
