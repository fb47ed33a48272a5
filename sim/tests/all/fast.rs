//! The fast engine against the kernel's scalar painter: whole pictures, word for word, and the same counts.

use splatline_sim::camera::Camera;
use splatline_sim::design::{DesignChoice, NAMES};
use splatline_sim::fast::lanes::Choice;
use splatline_sim::fixed::{Engine, Options, QuantisedScene, draw_quantised};
use splatline_sim::rules::{Compositing, Rules};
use splatline_sim::scene::{self, LoadOptions, Scene, synthetic};
use std::path::Path;

/// Draws the scene by every engine, in every design, under these rules.
fn agree(name: &str, scene: &Scene, camera: &Camera, rules: &[Rules]) {
    for rules in rules.iter().copied() {
        for design in NAMES.iter().filter_map(|name| DesignChoice::named(name)) {
            let options = Options {
                rules: &rules,
                compositing: Compositing::FrontToBack,
                design: &design,
                traversal: splatline::format::Traversal::Spans,
            };
            let quantised = QuantisedScene::new(scene, camera, &rules);
            let (scalar, scalar_setup) =
                draw_quantised(&quantised, camera, &options, Engine::Scalar);
            for choice in [Choice::Best, Choice::Eight, Choice::Portable] {
                let engine = Engine::Vectors(choice);
                let (fast, fast_setup) = draw_quantised(&quantised, camera, &options, engine);
                let what = format!("{name}, {}, {}, {choice:?}", rules.name, design.name);
                let differ = fast_setup
                    .iter()
                    .zip(&scalar_setup)
                    .position(|(a, b)| a != b);
                assert_eq!(differ, None, "{what}: first splat that differs");
                let differ = fast
                    .pixels
                    .iter()
                    .zip(&scalar.pixels)
                    .position(|(a, b)| a != b);
                assert_eq!(differ, None, "{what}: first pixel that differs");
                assert_eq!(fast.coverage, scalar.coverage, "{what}");
            }
        }
    }
}

const BOTH: [Rules; 2] = [Rules::GAUSSIAN_3D, Rules::EWA];

#[test]
fn random_scenes() {
    // Neither side is a multiple of a tile.
    let camera = synthetic::camera(203, 149);
    agree(
        "small splats",
        &synthetic::random_gaussians(3_000, 1, 1.0),
        &camera,
        &BOTH,
    );
    agree(
        "large splats",
        &synthetic::random_gaussians(2_000, 2, 8.0),
        &camera,
        &BOTH,
    );
}

/// Splats larger than the picture, and the camera among them.
#[test]
fn from_within() {
    let camera = Camera::look_at(
        [0.0, 0.1, -0.3],
        [0.3, 0.0, 1.0],
        [0.0, -1.0, 0.0],
        90.0,
        131,
        97,
    );
    let scene = synthetic::random_gaussians(600, 3, 40.0);
    agree("from within", &scene, &camera.unwrap(), &BOTH);
}

/// Captured scenes: needles, tiny splats, saturated pixels; each under the rules it was made for.
#[test]
#[cfg_attr(
    not(has_data),
    ignore = "the shared data were not beside the project when this was built"
)]
fn captured_scenes() {
    let data = concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/data");
    for file in [
        "gaussians/guitar.ply",
        "gaussians/playbot_lod4.ply",
        "volumes/fuel.nhdr",
    ] {
        let path = Path::new(data).join(file);
        let scene = scene::load(&path, &LoadOptions::default()).unwrap();
        let camera = scene.default_camera(151, 113);
        agree(file, &scene, &camera, &[scene.natural_rules]);
    }
}
