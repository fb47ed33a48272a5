//! The fast engine against the kernel's scalar painter: whole pictures, word for word, and the same counts.

use splatline_sim::camera::Camera;
use splatline_sim::design::{DesignChoice, NAMES};
use splatline_sim::fast::lanes::Choice;
use splatline_sim::fixed::{Engine, Options, QuantisedScene, draw_quantised};
use splatline_sim::rules::{Compositing, Rules};
use splatline_sim::scene::{Scene, synthetic};

/// Draws the scene by every engine, in every design, under both rules.
fn agree(name: &str, scene: &Scene, camera: &Camera) {
    for rules in [Rules::GAUSSIAN_3D, Rules::EWA] {
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

#[test]
fn random_scenes() {
    // Neither side is a multiple of a tile.
    let camera = synthetic::camera(203, 149);
    agree(
        "small splats",
        &synthetic::random_gaussians(3_000, 1, 1.0),
        &camera,
    );
    agree(
        "large splats",
        &synthetic::random_gaussians(2_000, 2, 8.0),
        &camera,
    );
}
