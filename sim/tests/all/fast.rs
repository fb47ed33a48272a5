//! The fast engine against the kernel's scalar painter: whole pictures, word for word, and the same counts.

use splatline_sim::camera::Camera;
use splatline_sim::design::{DesignChoice, NAMES};
use splatline_sim::fast::lanes::VectorLevel;
use splatline_sim::fixed::{
    Options, PaintEngine, QuantisedScene, draw_quantised, draw_with_footprints,
};
use splatline_sim::machine::workload::{Workload, extract_from};
use splatline_sim::metrics::compare;
use splatline_sim::picture::Picture;
use splatline_sim::reference;
use splatline_sim::renderer::{Renderer, Settings};
use splatline_sim::rules::{Compositing, Rules};
use splatline_sim::scene::{self, LoadOptions, Scene, SortOrder, Splat, synthetic};
use std::path::Path;

fn first_difference<T: PartialEq>(first: &[T], second: &[T]) -> Option<usize> {
    first.iter().zip(second).position(|(a, b)| a != b)
}

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
            let (scalar, scalar_setup) = draw_quantised(&quantised, &options, PaintEngine::Scalar);
            for choice in [VectorLevel::Best, VectorLevel::Avx2, VectorLevel::Portable] {
                let engine = PaintEngine::Vectors(choice);
                let (fast, fast_setup) = draw_quantised(&quantised, &options, engine);
                let what = format!("{name}, {}, {}, {choice:?}", rules.name, design.name);
                let splat = first_difference(&fast_setup, &scalar_setup);
                assert_eq!(splat, None, "{what}: first splat that differs");
                let pixel = first_difference(&fast.pixels, &scalar.pixels);
                assert_eq!(pixel, None, "{what}: first pixel that differs");
                assert_eq!(fast.facts.coverage, scalar.facts.coverage, "{what}");
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
            &options,
            PaintEngine::Vectors(VectorLevel::Best),
        );
        let (view, what) = (&quantised.view, format!("{}, {order:?}", rules.name));
        let renderer = Renderer::with_rules(Standard24, quantised.rules).unwrap();
        let renderer = renderer.with_compositing(order);
        let mut footprints = vec![splatline::footprint::Footprint::EMPTY; 3_000];
        let mut numbers = vec![0; 3_000];
        let mut list = LentList::new(&mut footprints, &mut numbers);
        let mut pixels = vec![Pixel::default(); 203 * 149];
        let (frame, counts) = renderer
            .render(view, &quantised.splats, &mut list, &mut pixels)
            .unwrap();
        assert!(frame.pixels == host.pixels, "{what}");
        assert_eq!(frame.coverage, Some(host.facts.coverage), "{what}");
        assert_eq!(counts.culled.map(|count| count as usize), host.facts.culled);
        let mut strip = vec![Pixel::default(); 203 * 16];
        let mut joined = Vec::new();
        for window in view.window().strips(16) {
            let part = renderer.draw(&list, window, &mut strip).unwrap();
            joined.extend_from_slice(part.pixels);
        }
        assert!(joined == host.pixels, "{what}, in strips");
        // What a PNG of 8 bits holds is what the front door reads.
        let colours = host.picture.pixels.iter().flat_map(|pixel| &pixel[..3]);
        let bytes = colours.map(|c| (c.clamp(0.0, 1.0) * 255.0).round() as u8);
        let joined = splatline::Frame {
            pixels: &joined,
            ..frame
        };
        assert!(joined.rgb8([0; 3]).flatten().eq(bytes), "{what}, in 8 bits");
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
        engine: PaintEngine::Vectors(choice),
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
    let small = synthetic::random_gaussians(3_000, 1, 1.0);
    agree("small splats", &small, &camera, &BOTH);
    let large = synthetic::random_gaussians(2_000, 2, 8.0);
    agree("large splats", &large, &camera, &BOTH);
}

/// Splats larger than the picture, and the camera among them.
#[test]
fn from_within() {
    let (eye, target) = ([0.0, 0.1, -0.3], [0.3, 0.0, 1.0]);
    let camera = Camera::look_at(eye, target, [0.0, -1.0, 0.0], 90.0, 131, 97);
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

/// A wall that faces the camera in the middle of the view and one at its edge, which is less deep but farther away:
/// which covers which depends on the order. Among them some of random depth and place.
fn two_walls() -> (Scene, Camera) {
    let camera = Camera::look_at([0.0; 3], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0], 100.0, 96, 64);
    let mut scene = synthetic::random_gaussians(300, 5, 2.0);
    for splat in &mut scene.splats {
        splat.centre[2] += 4.0;
    }
    let wall = |centre: [f64; 3], colour: [f64; 3]| Splat {
        centre,
        axes: [[1.2, 0.0, 0.0], [0.0, 1.2, 0.0], [0.0, 0.0, 0.01]],
        weight: 0.95,
        colour,
    };
    scene.splats.push(wall([0.0, 0.0, 3.0], [0.9, 0.1, 0.1]));
    scene.splats.push(wall([2.2, 0.0, 2.7], [0.1, 0.1, 0.9]));
    (scene, camera.unwrap())
}

/// The places of a machine's work, tile by tile, never come before the one that was drawn last.
fn assert_work_is_sorted(work: &Workload, places: &[f64], backwards: bool) {
    let mut first = 0;
    for tile in &work.tiles {
        let pairs = &work.pairs[first..tile.pairs_end as usize];
        let mut met: Vec<f64> = pairs.iter().map(|p| places[p.splat as usize]).collect();
        if backwards {
            met.reverse();
        }
        assert!(met.len() > 9 && met.is_sorted(), "{met:?}");
        first = tile.pairs_end as usize;
    }
}

fn psnr(a: &Picture, b: &Picture) -> f64 {
    compare(a, b).unwrap().colour.psnr_db
}

/// Both orders: all engines draw the same bits, near the reference's picture in that order and far from the one in the
/// other; the machine meets the splats in that order as well.
#[test]
fn every_engine_sorts_as_the_scene_asks() {
    let (mut scene, camera) = two_walls();
    let design = DesignChoice::named("standard24").unwrap();
    let rules = Rules::GAUSSIAN_3D;
    let mut floats = Vec::new();
    for order in [SortOrder::Depth, SortOrder::Distance] {
        scene.order = order;
        agree(order.name(), &scene, &camera, &[rules]);
        let centres = scene.splats.iter().map(|splat| splat.centre);
        let places: Vec<f64> = centres.map(|c| order.place(&camera, c)).collect();
        for compositing in [Compositing::FrontToBack, Compositing::BackToFront] {
            let options = Options {
                rules: &rules,
                compositing,
                design: &design,
                traversal: design.traversal,
            };
            let (drawing, setup) = draw_with_footprints(&scene, &camera, &options);
            let float = reference::float::draw(&scene, &camera, &rules, compositing).picture;
            assert!(psnr(&drawing.picture, &float) > 60.0, "{order:?}");
            let work = extract_from(&setup, &camera, &options, [64, 64]);
            let backwards = compositing == Compositing::BackToFront;
            assert_work_is_sorted(&work, &places, backwards);
            floats.push(float);
        }
        let float = &floats[floats.len() - 2];
        let front = Compositing::FrontToBack;
        let exact = reference::exact::draw(&scene, &camera, &rules, front).picture;
        let stages = reference::formats::RoundedStages::pixels(reference::formats::FP32);
        let single = reference::formats::draw(&scene, &camera, &rules, &stages).picture;
        assert!(psnr(&single, float) > 60.0, "{order:?}");
        floats.push(exact);
    }
    // Front to back, back to front, and along rays, by depth and then by distance.
    let found: Vec<f64> = (0..3).map(|k| psnr(&floats[k], &floats[k + 3])).collect();
    assert!(
        found.iter().all(|db| *db < 30.0),
        "they differ by {found:?} dB"
    );
}
