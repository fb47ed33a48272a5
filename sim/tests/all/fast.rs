//! The fast engine against the kernel's scalar painter: whole pictures, word for word, and the same counts.

use splatline_sim::camera::Camera;
use splatline_sim::design::{DesignChoice, NAMES};
use splatline_sim::fast::lanes::VectorLevel;
use splatline_sim::fixed::{Engine, Options, QuantisedScene, draw_quantised};
use splatline_sim::renderer::{Renderer, Settings};
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
            for choice in [VectorLevel::Best, VectorLevel::Avx2, VectorLevel::Portable] {
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
                let uncounted = uncounted(scene, camera, &rules, &design, choice);
                assert!(uncounted == scalar.pixels, "{what}, without counts");
            }
        }
    }
}

/// The front door of the core, frame and strips, draws what the host's engine draws, word for word.
#[test]
fn the_front_door_draws_what_the_host_draws() {
    use splatline::{Compositing as Order, LentList, Pixel, Renderer, Standard24, Traversal};
    let scene = synthetic::random_gaussians(3_000, 5, 2.0);
    let camera = synthetic::camera(203, 149);
    let orders = [
        (Compositing::FrontToBack, Order::FrontToBack),
        (Compositing::BackToFront, Order::BackToFront),
        (Compositing::XRay, Order::XRay),
    ];
    for (rules, (compositing, order)) in BOTH.iter().flat_map(|rules| orders.map(|o| (rules, o))) {
        let options = Options {
            rules,
            compositing,
            design: &DesignChoice::named("standard24").unwrap(),
            traversal: Traversal::Spans,
        };
        let quantised = QuantisedScene::new(&scene, &camera, rules);
        let (host, _) = draw_quantised(
            &quantised,
            &camera,
            &options,
            Engine::Vectors(VectorLevel::Best),
        );
        let (view, what) = (&quantised.view, format!("{}, {order:?}", rules.name));
        let renderer = Renderer::with_rules(Standard24, quantised.rules(rules)).unwrap();
        let renderer = renderer.with_compositing(order);
        let mut footprints = vec![splatline::footprint::Footprint::EMPTY; 3_000];
        let mut numbers = vec![0; 3_000];
        let mut list = LentList::new(&mut footprints, &mut numbers);
        let mut pixels = vec![Pixel::default(); 203 * 149];
        let (frame, counts) = renderer
            .render(view, &quantised.splats, &mut list, &mut pixels)
            .unwrap();
        assert!(frame.pixels == host.pixels, "{what}");
        assert_eq!(frame.coverage, host.coverage, "{what}");
        assert_eq!(counts.culled.map(|count| count as usize), host.culled);
        let mut strip = vec![Pixel::default(); 203 * 16];
        let mut joined = Vec::new();
        for window in view.window().strips(16) {
            let part = renderer.draw(&list, window, &mut strip).unwrap();
            joined.extend_from_slice(part.pixels);
        }
        assert!(joined == host.pixels, "{what}, in strips");
        // What a PNG of 8 bits holds is what the front door reads.
        let bytes = host
            .picture
            .pixels
            .iter()
            .flat_map(|[r, g, b, _]| [*r, *g, *b]);
        let bytes: Vec<u8> = bytes
            .map(|c| (c.clamp(0.0, 1.0) * 255.0).round() as u8)
            .collect();
        let read: Vec<u8> = splatline::Frame {
            pixels: &joined,
            ..frame
        }
        .rgb8([0; 3])
        .flatten()
        .collect();
        assert!(read == bytes, "{what}, in 8 bits");
    }
}

/// The pixels of a renderer that leaves out what has finished.
fn uncounted(
    scene: &Scene,
    camera: &Camera,
    rules: &Rules,
    design: &DesignChoice,
    choice: VectorLevel,
) -> Vec<splatline::Pixel> {
    let settings = Settings {
        design: design.clone(),
        traversal: splatline::format::Traversal::Spans,
        engine: Engine::Vectors(choice),
        ..Settings::new(*rules)
    };
    let mut pixels = vec![splatline::Pixel::default(); camera.width * camera.height];
    let mut renderer = Renderer::new(scene, camera, settings);
    renderer.draw(&mut pixels, &|_, _| true).unwrap();
    pixels
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
