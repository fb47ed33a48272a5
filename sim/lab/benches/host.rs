//! `cargo bench -p splatline-lab --bench host`: whole pictures by the kernel and by the single-precision baselines, one thread.
//!
//! `splatline-lab results --only host` prints the comparison with ratios; this bench is for watching one engine change, and for comparing the
//! vectors: AVX-512, AVX2, arrays that the compiler may vectorise, and the kernel itself.

use divan::Bencher;
use rayon::ThreadPoolBuilder;
use splatline_lab::baseline::scene::BoxExtent;
use splatline_lab::baseline::{FloatScene, boxes, spans, textbook};
use splatline_sim::camera::Camera;
use splatline_sim::design::DesignChoice;
use splatline_sim::fast::lanes::VectorLevel;
use splatline_sim::fixed::PaintEngine;
use splatline_sim::renderer::{Renderer, Settings};
use splatline_sim::rules::Rules;
use splatline_sim::scene::{self, LoadOptions, Scene, synthetic};
use std::path::Path;

fn main() {
    let pool = ThreadPoolBuilder::new().num_threads(1).build_global();
    pool.expect("no other pool has been started");
    divan::main();
}

/// Random scenes by thousands of splats, some with larger scales, and captured ones, in the data that lies beside the project.
const SCENES: [&str; 6] = ["10", "10 x 2.5", "100", "100 x 2.5", "guitar", "brainsmall"];

fn scene(name: &str) -> Option<(Scene, Camera, Rules)> {
    let random = |thousands: usize, multiplier: f64| {
        let scene = synthetic::random_gaussians(1_000 * thousands, 1, multiplier);
        (scene, synthetic::camera(512, 512), Rules::GAUSSIAN_3D)
    };
    let captured = |file: &str| {
        let data = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data"));
        let scene = scene::load(&data.join(file), &LoadOptions::default()).ok()?;
        let (camera, rules) = (scene.default_camera(512, 512), scene.natural_rules);
        Some((scene, camera, rules))
    };
    match name {
        "10" => Some(random(10, 1.0)),
        "10 x 2.5" => Some(random(10, 2.5)),
        "100" => Some(random(100, 1.0)),
        "100 x 2.5" => Some(random(100, 2.5)),
        "guitar" => captured("gaussians/guitar.ply"),
        _ => captured("volumes/brainsmall.nhdr"),
    }
}

/// A scene as the baselines take it; `None` if its file is missing.
fn floats(name: &str) -> Option<FloatScene> {
    let (scene, camera, rules) = scene(name)?;
    Some(FloatScene::new(&scene, &camera, &rules))
}

#[divan::bench(args = SCENES, sample_count = 10)]
fn baseline_boxes(bencher: Bencher, what: &str) {
    if let Some(floats) = floats(what) {
        bencher.bench(|| boxes::draw(&floats, BoxExtent::Sigmas, VectorLevel::Avx2));
    }
}

#[divan::bench(args = SCENES, sample_count = 3)]
fn baseline_textbook(bencher: Bencher, what: &str) {
    if let Some(floats) = floats(what) {
        bencher.bench(|| textbook::draw(&floats, BoxExtent::Sigmas));
    }
}

#[divan::bench(args = SCENES, sample_count = 10)]
fn baseline_spans(bencher: Bencher, what: &str) {
    if let Some(floats) = floats(what) {
        bencher.bench(|| spans::draw(&floats, VectorLevel::Best));
    }
}

fn kernel(bencher: Bencher, what: &str, design: &str, engine: PaintEngine) {
    let Some((scene, camera, rules)) = scene(what) else {
        return;
    };
    let settings = Settings {
        design: DesignChoice::named(design).expect("the bench names a design"),
        engine,
        ..Settings::new(rules)
    };
    let mut renderer = Renderer::new(&scene, &camera, settings);
    let mut pixels = vec![[0.0; 4]; 512 * 512];
    bencher.bench_local(|| renderer.draw_floats(&mut pixels, &|_, _| true));
}

#[divan::bench(args = SCENES, sample_count = 10)]
fn lean18(bencher: Bencher, what: &str) {
    kernel(
        bencher,
        what,
        "lean18",
        PaintEngine::Vectors(VectorLevel::Best),
    );
}

#[divan::bench(args = SCENES, sample_count = 10)]
fn standard24(bencher: Bencher, what: &str) {
    kernel(
        bencher,
        what,
        "standard24",
        PaintEngine::Vectors(VectorLevel::Best),
    );
}

#[divan::bench(args = SCENES, sample_count = 10)]
fn standard24_eight_words(bencher: Bencher, what: &str) {
    kernel(
        bencher,
        what,
        "standard24",
        PaintEngine::Vectors(VectorLevel::Avx2),
    );
}

#[divan::bench(args = SCENES, sample_count = 5)]
fn standard24_arrays(bencher: Bencher, what: &str) {
    kernel(
        bencher,
        what,
        "standard24",
        PaintEngine::Vectors(VectorLevel::Portable),
    );
}

#[divan::bench(args = SCENES, sample_count = 3)]
fn standard24_scalar(bencher: Bencher, what: &str) {
    kernel(bencher, what, "standard24", PaintEngine::Scalar);
}
