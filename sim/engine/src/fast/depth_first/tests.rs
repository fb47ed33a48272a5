//! Boxes and depths against the kernel's footprints, and whole pictures with and without what is left out.

use super::spheres::Projected;
use super::*;
use crate::camera::Camera;
use crate::design::DesignChoice;
use crate::fast::tests::normalised;
use crate::fixed::{PaintEngine, QuantisedScene, kernel_rules};
use crate::renderer::{Renderer, Settings};
use crate::rules;
use crate::scene::{Scene, synthetic};
use fixed::types::U4F28;
use proptest::prelude::*;
use splatline::blend::Pixel;
use splatline::footprint::depth;
use splatline::format::{Design, RuntimeWidths, Standard24, Widths};
use splatline::math::SoftFloat;
use splatline::raster::Window;
use splatline::setup::setup;
use splatline::splat::Axis;

/// Around the view of [`camera`], from needles to balls around the eye, some of any bits.
fn splat() -> impl Strategy<Value = VolumeSplat> {
    let mantissa = prop_oneof![8 => any::<i32>(), 1 => -3i32..4, 1 => Just(i32::MIN)];
    let exponent = prop_oneof![8 => -44i32..-26, 1 => -600i32..600];
    let axis = (prop::array::uniform3(mantissa), exponent);
    let axis = axis.prop_map(|(mantissa, exponent)| Axis { mantissa, exponent });
    let coordinate = prop_oneof![20 => normalised(-33..-28), 1 => normalised(-200..200), 1 => Just(SoftFloat::ZERO)];
    (
        prop::array::uniform3(coordinate),
        prop::array::uniform3(axis),
        normalised(-40..-28),
    )
        .prop_map(|(centre, axes, weight)| VolumeSplat {
            centre,
            axes,
            weight,
            colour: [U4F28::ONE; 3],
        })
}

/// A view from an arbitrary place, near or far off.
fn camera() -> impl Strategy<Value = Camera> {
    let place = prop_oneof![4 => -3.0f64..3.0, 1 => -1e5f64..1e5];
    let field = prop_oneof![Just(1.0), Just(60.0), Just(140.0)];
    (
        prop::array::uniform3(place),
        prop::array::uniform3(-0.5f64..0.5),
        field,
    )
        .prop_map(|(eye, target, field)| {
            let target = [0, 1, 2].map(|axis: usize| target[axis] + eye[axis] * 1e-3);
            Camera::look_at(eye, target, [0.1, 1.0, 0.2], field, 320, 200).unwrap()
        })
}

fn widths() -> impl Strategy<Value = Widths> {
    (14u8..=60, 14u8..=31, 14u8..=31).prop_map(|(position, view, mantissa)| Widths {
        position,
        view,
        mantissa,
        ..Standard24.widths()
    })
}

fn key_of(depth: f32) -> u64 {
    depth::key(splatline::float::extended(depth.into()))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    /// The oracle is the kernel's setup.
    #[test]
    fn boxes_hold_footprints_and_bounds_their_depths(
        splats in prop::collection::vec(splat(), TOGETHER), camera in camera(), widths in widths(), ewa: bool,
    ) {
        let stated = if ewa { rules::Rules::EWA } else { rules::Rules::GAUSSIAN_3D };
        let rules = kernel_rules(&stated);
        let view = QuantisedScene::new(&synthetic::random_gaussians(1, 1, 1.0), &camera, &stated).view;
        let design = RuntimeWidths::new(widths).unwrap();
        let spheres = BoundingSpheres::new(&splats, &rules).unwrap();
        let projection = SphereProjection::new(&view, &widths, &spheres).unwrap();
        let seen = projection.project(&spheres.groups[0]);
        let Projected { least, most, bounds } = seen;
        // Through a splat; a frame's cuts are finite.
        let middle = least[0] / 2.0 + most[0] / 2.0;
        let cuts = [Cut::at(if middle > 0.0 && middle.is_finite() { middle } else { 1.0 })];
        let [low, high] = cuts::slices_of_depths(&cuts, &seen);
        for (k, splat) in splats.iter().enumerate() {
            let Ok(footprint) = setup(design, &view, &rules, splat) else { continue };
            let Window { first, end } = Window::of(&footprint);
            for axis in 0..2 {
                prop_assert!(bounds[axis][k] <= f32::from(first[axis]), "{footprint:?} {bounds:?} of {k}");
                prop_assert!(bounds[axis + 2][k] >= f32::from(end[axis]), "{footprint:?} {bounds:?} of {k}");
            }
            prop_assert!(most[k] >= 0.0 || most[k].is_nan());
            let slice = cuts::slice_of_key(&cuts, footprint.depth);
            prop_assert!((low[k]..=high[k]).contains(&(slice as u32)));
            if least[k] > 0.0 {
                prop_assert!(key_of(least[k]) <= footprint.depth);
            }
            if most[k] > 0.0 {
                prop_assert!(key_of(most[k]) >= footprint.depth);
            }
        }
    }

    #[test]
    fn sums_find_what_a_search_finds(tiles in prop::collection::vec(prop_oneof![Just(0u64), any::<u64>(), (0u32..64).prop_map(|bit| 1 << bit)], 6), corners in any::<[u16; 4]>()) {
        let mut live = LiveBlocks::default();
        live.open([180, 100]);
        live.tiles.copy_from_slice(&tiles);
        live.sum();
        let [a, b, c, d] = corners;
        let blocks = [a % 25, b % 17, c % 25, d % 17];
        let [left, top, right, bottom] = blocks.map(usize::from);
        let any = (top..bottom).any(|y| (left..right).any(|x| tiles[y / 8 * 3 + x / 8] >> (y % 8 * 8 + x % 8) & 1 == 1));
        prop_assert_eq!(live.any(&blocks), any);
    }
}

/// A picture, and how many splats were left out of it.
fn drawn(
    scene: &Scene,
    camera: &Camera,
    settings: Settings,
    threads: usize,
) -> (Vec<Pixel>, usize) {
    let mut frame = vec![Pixel::default(); camera.width * camera.height];
    let mut renderer = Renderer::new(scene, camera, settings)
        .with_threads(threads)
        .unwrap();
    // The second frame's memory is the first one's.
    let near = camera.zoomed(3.0).unwrap();
    renderer.set_camera(&near);
    renderer.draw(&mut frame, &|_, _| true).unwrap();
    renderer.set_camera(camera);
    let facts = renderer.draw(&mut frame, &|_, _| true).unwrap().facts;
    (frame, facts.left_out)
}

#[test]
fn what_is_left_out_moves_no_bit() {
    // Planes at right angles to an oblique view: each cut goes through one, whose depths differ by rounding alone.
    let mut equal_depths = synthetic::random_gaussians(6_000, 3, 11.0);
    let oblique = [2.0, 2.0, -3.0];
    let along = Camera::look_at(oblique, [0.0; 3], [0.0, -1.0, 0.0], 40.0, 200, 136).unwrap();
    let forward = oblique.map(|e| -e / 17f64.sqrt());
    for splat in &mut equal_depths.splats {
        let depth: f64 = (0..3).map(|k| forward[k] * splat.centre[k]).sum();
        let moved = (depth * 4.0).round() / 4.0 - depth;
        splat.centre = [0, 1, 2].map(|k: usize| splat.centre[k] + forward[k] * moved);
    }
    let mut far_off = synthetic::random_gaussians(6_000, 4, 11.0);
    for splat in &mut far_off.splats {
        splat.centre[0] += 1e5;
    }
    let camera = synthetic::camera(200, 136);
    let beside = Camera::look_at(
        [1e5, 0.3, -4.0],
        [1e5, 0.0, 0.0],
        [0.0, -1.0, 0.0],
        40.0,
        200,
        136,
    )
    .unwrap();
    let among =
        Camera::look_at([0.1, 0.2, -0.3], [0.5; 3], [0.0, -1.0, 0.0], 70.0, 200, 136).unwrap();
    let plain = synthetic::random_gaussians(6_000, 5, 11.0);
    let mut wild = synthetic::random_gaussians(6_000, 6, 11.0);
    for (number, splat) in wild.splats.iter_mut().enumerate() {
        match number % 97 {
            0 => splat.centre[number % 3] = f64::NAN,
            1 => splat.centre[number % 3] = f64::INFINITY,
            2 => splat.centre = splat.centre.map(|c| c * 1e30),
            3 => splat.axes[number % 3] = [1e20, -1e-20, 1e3],
            4 => splat.axes = [[0.0; 3]; 3],
            5 => splat.weight = f64::NAN,
            6 => splat.weight = -1.0,
            7 => splat.weight = 1e9,
            8 => splat.colour = [1e4; 3],
            _ => {}
        }
    }
    let cases = [
        (&plain, &camera),
        (&plain, &among),
        (&equal_depths, &along),
        (&far_off, &beside),
        (&wild, &camera),
        (&wild, &among),
    ];
    for (scene, camera) in cases {
        for stated in [rules::Rules::GAUSSIAN_3D, rules::Rules::EWA] {
            for name in ["lean18", "standard24", "deep32"] {
                let settings = |counts, engine| Settings {
                    design: DesignChoice::named(name).unwrap(),
                    counts,
                    engine,
                    ..Settings::new(stated)
                };
                let vectors = PaintEngine::Vectors;
                let whole = drawn(scene, camera, settings(true, vectors(VectorLevel::Best)), 2);
                assert_eq!(whole.1, 0);
                for (engine, threads) in [
                    (vectors(VectorLevel::Best), 1),
                    (vectors(VectorLevel::Avx2), 2),
                    (PaintEngine::Scalar, 2),
                ] {
                    let (picture, left_out) =
                        drawn(scene, camera, settings(false, engine), threads);
                    assert!(picture == whole.0, "{name}, {engine:?}");
                    assert!(left_out > scene.splats.len() / 10, "{name}: {left_out}");
                }
            }
        }
    }
}
