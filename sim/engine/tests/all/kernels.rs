//! Kernels, distance scaling, points, stamps and spheres: fixed point against the float reference, and the reference
//! against first principles.

use splatline::setup::{Ellipse, Index as KernelIndex};
use splatline_engine::camera::Camera;
use splatline_engine::design::DesignChoice;
use splatline_engine::fast::lanes::VectorLevel;
use splatline_engine::fixed::{self, HybridFacts, HybridRenderer, Options, PaintEngine};
use splatline_engine::hybrid::{Hybrid, Points, spacing};
use splatline_engine::metrics::compare;
use splatline_engine::picture::Picture;
use splatline_engine::rules::{Antialias, Compositing, Kernel, Rules};
use splatline_engine::scene::{Scene, Splat, Weight};
use splatline_reference::engines::sphere::{Index, Shape};
use splatline_reference::engines::{self as reference, exact, float};

/// The bars of every system: PSNR against its own float counterpart, and bias.
const LEAST_PSNR: f64 = 60.0;
const LARGEST_BIAS: f64 = 5e-4;

/// Samples per side of the test volume.
const SIDE: i32 = 12;

/// A cube of spherical samples 1 apart, off the grid's symmetry so that no centre lies halfway between phases.
fn volume() -> Scene {
    let mut splats = Vec::new();
    for index in 0..SIDE.pow(3) {
        let place = [index % SIDE, index / SIDE % SIDE, index / SIDE / SIDE];
        let hash =
            f64::from(index.wrapping_mul(0x9e37_79b1u32 as i32).rotate_left(9) & 0xffff) / 65536.0;
        splats.push(Splat {
            centre: place.map(|i| f64::from(i) - 0.5 * f64::from(SIDE) + 0.0137),
            axes: [[0.82, 0.0, 0.0], [0.0, 0.82, 0.0], [0.0, 0.0, 0.82]],
            weight: 0.3 * hash,
            colour: [hash, 1.0 - hash, 0.5],
        });
    }
    Scene::of_splats("cube", Rules::EWA, splats)
}

/// Seen from `distance` on a slant; k is 60.
fn camera(distance: f64, orthographic: bool) -> Camera {
    let eye = [0.35 * distance, -0.4 * distance, -0.85 * distance];
    let mut camera = Camera::look_at(eye, [0.0; 3], [0.0, -1.0, 0.0], 45.0, 64, 64).unwrap();
    (camera.fx, camera.fy) = (60.0, 60.0);
    if orthographic {
        (camera.fx, camera.fy) = (60.0 / distance, 60.0 / distance);
        camera.orthographic = true;
    }
    camera
}

fn options<'a>(rules: &'a Rules, design: &'a DesignChoice) -> Options<'a> {
    Options::front_to_back(rules, design)
}

fn meets_the_bars(what: &str, fixed: &Picture, float: &Picture) {
    let errors = compare(fixed, float).unwrap();
    for (channel, error) in [("colour", errors.colour), ("alpha", errors.alpha)] {
        assert!(
            error.psnr_db >= LEAST_PSNR && error.bias.abs() <= LARGEST_BIAS,
            "{what}, {channel}: {:.1} dB, bias {:.1e}, largest {:.1e}",
            error.psnr_db,
            error.bias,
            error.max_abs
        );
    }
    let drawn = float.pixels.iter().filter(|pixel| pixel[3] > 0.01).count();
    assert!(drawn > 20, "{what}: only {drawn} pixels are drawn");
}

fn standard24() -> DesignChoice {
    DesignChoice::named("standard24").unwrap()
}

#[test]
fn kernels_and_filters_meet_the_bars() {
    let (scene, design) = (volume(), standard24());
    let filters = [Antialias::None, Antialias::Ewa(1.0), Antialias::Swan(1.0)];
    for kernel in [
        Kernel::Gaussian,
        Kernel::Cubic,
        Kernel::Quadratic,
        Kernel::Disc,
    ] {
        for antialias in filters {
            for (distance, orthographic) in [(30.0, false), (130.0, false), (130.0, true)] {
                let rules = Rules::EWA.with_kernel(kernel).with_antialias(antialias);
                let camera = camera(distance, orthographic);
                let drawn = fixed::draw(&scene, &camera, &options(&rules, &design));
                let expected = float::draw(&scene, &camera, &rules, Compositing::FrontToBack);
                let what = format!("{kernel:?}, {antialias:?}, {distance}, {orthographic}");
                meets_the_bars(&what, &drawn.picture, &expected.picture);
            }
        }
    }
}

#[test]
fn peak_opacities_are_dimmed_by_distance_scaling() {
    let (mut scene, design) = (volume(), standard24());
    scene.weight = Weight::Opacity;
    let rules = Rules::GAUSSIAN_3D.with_antialias(Antialias::Swan(1.0));
    let camera = camera(100.0, false);
    let drawn = fixed::draw(&scene, &camera, &options(&rules, &design));
    let expected = float::draw(&scene, &camera, &rules, Compositing::FrontToBack);
    meets_the_bars("3dgs", &drawn.picture, &expected.picture);
}

/// A scene as points and splats, and what drawing it told.
pub fn draw_hybrid(
    scene: &Scene,
    camera: &Camera,
    options: Options,
    hybrid: &Hybrid,
) -> Result<(Picture, HybridFacts), String> {
    let engine = (fixed::best_engine(), true);
    let mut renderer = HybridRenderer::new(scene, camera, options, hybrid, engine)?;
    let mut picture = Picture::default();
    let facts = renderer.draw_picture(&mut picture)?;
    Ok((picture, facts))
}

#[test]
fn points_and_stamps_meet_the_bars() {
    let (scene, design) = (volume(), standard24());
    let rules = Rules::EWA.with_antialias(Antialias::Swan(spacing(&scene)));
    let ranges = [None, Some(0.5 * spacing(&scene)), Some(2.3)];
    for points in [Points::Auto, Points::All, Points::None] {
        for depth_range in ranges {
            for phase_bits in [None, Some(0), Some(3)] {
                for distance in [45.0, 61.0, 120.0] {
                    let hybrid = Hybrid {
                        points,
                        depth_range,
                        phase_bits,
                    };
                    let camera = camera(distance, false);
                    let options = options(&rules, &design);
                    let (drawn, _) = draw_hybrid(&scene, &camera, options, &hybrid).unwrap();
                    let expected = reference::hybrid::draw(&scene, &camera, &rules, &hybrid);
                    let what = format!("{hybrid:?} from {distance}");
                    meets_the_bars(&what, &drawn, &expected.picture);
                }
            }
        }
    }
}

/// Frame after frame in the same memory, by vectors or the kernel, counted or not: the same bits.
#[test]
fn frames_of_points_and_splats_are_the_kernels() {
    let (mut scene, design) = (volume(), standard24());
    // More than one part of a scene, so that splats are numbered across parts.
    scene.splats.extend_from_within(..);
    scene.splats.extend_from_within(..);
    let rules = Rules::EWA.with_antialias(Antialias::Swan(spacing(&scene)));
    let ways = [
        (Points::None, None, None),
        (Points::Auto, None, None),
        (Points::Auto, Some(2.3), Some(2)),
        (Points::Auto, None, Some(3)),
        (Points::All, None, Some(3)),
    ];
    for (points, depth_range, phase_bits) in ways {
        let hybrid = Hybrid {
            points,
            depth_range,
            phase_bits,
        };
        let camera = camera(61.0, false);
        let frames = |engine, counts| {
            let options = options(&rules, &design);
            let engine = (engine, counts);
            let mut renderer =
                HybridRenderer::new(&scene, &camera, options, &hybrid, engine).unwrap();
            let mut frame = || {
                let mut picture = Picture::new(0, 0);
                let facts = renderer.draw_picture(&mut picture).unwrap();
                let counted = counts.then_some(facts.frame.coverage);
                let culled = facts.frame.culled;
                (picture.pixels, [facts.points, facts.drawn], culled, counted)
            };
            let [first, second] = [frame(), frame()];
            assert!(first == second, "{hybrid:?}, {engine:?}");
            first
        };
        let expected = frames(PaintEngine::Scalar, true);
        assert!(expected.1[1] > 3_000);
        for level in [VectorLevel::Best, VectorLevel::Avx2, VectorLevel::Portable] {
            let engine = PaintEngine::Vectors(level);
            assert!(frames(engine, true) == expected, "{hybrid:?}, {level:?}");
            assert!(
                frames(engine, false).0 == expected.0,
                "{hybrid:?}, {level:?}"
            );
        }
    }
}

/// Auto chooses by the projected size: splats before k, points beyond, both around it.
#[test]
fn points_are_chosen_by_projected_size() {
    let (scene, design) = (volume(), standard24());
    let rules = Rules::EWA.with_antialias(Antialias::Swan(spacing(&scene)));
    let share = |distance: f64| {
        let camera = camera(distance, false);
        let hybrid = Hybrid::default();
        let drawn = draw_hybrid(&scene, &camera, options(&rules, &design), &hybrid);
        let (_, facts) = drawn.unwrap();
        facts.points as f64 / facts.drawn as f64
    };
    assert_eq!((share(40.0), share(80.0)), (0.0, 1.0));
    assert!((0.3..0.7).contains(&share(60.0)), "{}", share(60.0));
}

/// Without a depth range, drawing points one by one is drawing the splats that they are, up to their slant.
#[test]
fn points_without_a_range_are_splats_seen_head_on() {
    let scene = volume();
    let rules = Rules::EWA.with_antialias(Antialias::Swan(spacing(&scene)));
    let camera = camera(120.0, true);
    let picture = |points| {
        let hybrid = Hybrid {
            points,
            ..Hybrid::default()
        };
        reference::hybrid::draw(&scene, &camera, &rules, &hybrid).picture
    };
    let errors = compare(&picture(Points::All), &picture(Points::None)).unwrap();
    assert!(errors.colour.max_abs < 1e-9 && errors.alpha.max_abs < 1e-9);
}

fn ball(aside: f64) -> (Scene, Camera) {
    let mut scene = volume();
    scene.splats.truncate(1);
    scene.splats[0].centre = [aside, 0.3 * aside, 1.0];
    scene.splats[0].axes = [[0.25, 0.0, 0.0], [0.0, 0.25, 0.0], [0.0, 0.0, 0.25]];
    scene.splats[0].weight = 0.3;
    let mut camera = camera(1.0, false);
    camera.rotation = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    camera.translation = [0.0; 3];
    (camera.fx, camera.fy) = (24.0, 27.0);
    (scene, camera)
}

#[test]
fn spheres_meet_the_bars_and_the_ray_index_is_exact() {
    let design = standard24();
    let rules = Rules::EWA.with_antialias(Antialias::None);
    let indices = [
        (Index::Affine, KernelIndex::Affine),
        (Index::Perspective, KernelIndex::Perspective),
        (Index::Ray, KernelIndex::Ray),
    ];
    for aside in [0.0, 0.31, -0.55] {
        let (scene, camera) = ball(aside);
        let truth = exact::draw(&scene, &camera, &rules, Compositing::FrontToBack).picture;
        for exact_ellipse in [false, true] {
            for (index, in_kernel) in indices {
                let shape = Shape {
                    exact_ellipse,
                    index,
                };
                let ellipse = if exact_ellipse {
                    Ellipse::Exact
                } else {
                    Ellipse::Approximate
                };
                let options = options(&rules, &design);
                let drawn = fixed::draw_spheres(&scene, &camera, &options, (ellipse, in_kernel));
                let expected = reference::sphere::draw(
                    &scene,
                    &camera,
                    &rules,
                    Compositing::FrontToBack,
                    shape,
                );
                let what = format!("{shape:?} at {aside}");
                meets_the_bars(&what, &drawn.picture, &expected.picture);
                let head_on = aside == 0.0 && index == Index::Perspective;
                if index == Index::Ray || head_on {
                    let model = compare(&expected.picture, &truth).unwrap();
                    assert!(
                        model.alpha.max_abs < 1e-9,
                        "{what}: {:.1e}",
                        model.alpha.max_abs
                    );
                }
            }
        }
    }
}

/// The approximate ellipse with the affine index is EWA's own footprint (system 1).
#[test]
fn the_approximate_ellipse_is_the_affine_footprint() {
    let rules = Rules::EWA.with_antialias(Antialias::None);
    let (scene, mut camera) = ball(0.4);
    camera.fy = camera.fx;
    let shape = Shape {
        exact_ellipse: false,
        index: Index::Affine,
    };
    let sphere = reference::sphere::draw(&scene, &camera, &rules, Compositing::FrontToBack, shape);
    let affine = float::draw(&scene, &camera, &rules, Compositing::FrontToBack);
    let errors = compare(&sphere.picture, &affine.picture).unwrap();
    assert!(errors.alpha.max_abs < 1e-9, "{:.1e}", errors.alpha.max_abs);
}

#[test]
fn an_eye_inside_a_sphere_culls_it_and_a_wrong_rule_is_named() {
    let design = standard24();
    let (mut scene, camera) = ball(0.0);
    scene.splats[0].centre = [0.0, 0.0, 0.3];
    let rules = Rules::EWA;
    let drawn = fixed::draw_spheres(
        &scene,
        &camera,
        &options(&rules, &design),
        (Ellipse::Exact, KernelIndex::Perspective),
    );
    assert_eq!(drawn.facts.culled.iter().sum::<usize>(), 1);
    let hybrid = Hybrid::default();
    let refused = draw_hybrid(&scene, &camera, options(&rules, &design), &hybrid);
    let error = refused.unwrap_err();
    assert!(error.contains("spacing"), "{error}");
}
