//! `cargo bench -p splatline-sim`: whole pictures of random scenes by the kernel and by both single-precision baselines, one thread.
//!
//! `splatline results --only host` prints the comparison with ratios, on captured scenes too; this bench is for watching one engine change.

use divan::Bencher;
use rayon::ThreadPoolBuilder;
use splatline::format::Traversal;
use splatline_sim::baseline::scene::Reach;
use splatline_sim::baseline::{FloatScene, boxes, spans};
use splatline_sim::camera::Camera;
use splatline_sim::design::DesignChoice;
use splatline_sim::fast::lanes::Choice;
use splatline_sim::fixed::{Engine, Options, QuantisedScene, draw_quantised};
use splatline_sim::rules::{Compositing, Rules};
use splatline_sim::scene::{Scene, synthetic};

fn main() {
    let pool = ThreadPoolBuilder::new().num_threads(1).build_global();
    pool.expect("no other pool has been started");
    divan::main();
}

/// Thousands of splats and what their scales are multiplied by.
const SCENES: [(usize, f64); 4] = [(10, 1.0), (10, 2.5), (100, 1.0), (100, 2.5)];

const RULES: &Rules = &Rules::GAUSSIAN_3D;

fn scene((thousands, multiplier): (usize, f64)) -> (Scene, Camera) {
    let scene = synthetic::random_gaussians(1_000 * thousands, 1, multiplier);
    (scene, synthetic::camera(512, 512))
}

#[divan::bench(args = SCENES, sample_count = 10)]
fn baseline_boxes(bencher: Bencher, what: (usize, f64)) {
    let (scene, camera) = scene(what);
    let floats = FloatScene::new(&scene, &camera, RULES);
    bencher.bench(|| boxes::draw(&floats, Reach::Sigmas));
}

#[divan::bench(args = SCENES, sample_count = 10)]
fn baseline_spans(bencher: Bencher, what: (usize, f64)) {
    let (scene, camera) = scene(what);
    let floats = FloatScene::new(&scene, &camera, RULES);
    bencher.bench(|| spans::draw(&floats, Choice::Best));
}

fn kernel(bencher: Bencher, what: (usize, f64), design: &str, engine: Engine) {
    let (scene, camera) = scene(what);
    let quantised = QuantisedScene::new(&scene, &camera, RULES);
    let design = DesignChoice::named(design).expect("the bench names a design");
    let options = Options {
        rules: RULES,
        compositing: Compositing::FrontToBack,
        design: &design,
        traversal: Traversal::Spans,
    };
    bencher.bench(|| draw_quantised(&quantised, &camera, &options, engine));
}

#[divan::bench(args = SCENES, sample_count = 10)]
fn lean18(bencher: Bencher, what: (usize, f64)) {
    kernel(bencher, what, "lean18", Engine::Vectors(Choice::Best));
}

#[divan::bench(args = SCENES, sample_count = 10)]
fn standard24(bencher: Bencher, what: (usize, f64)) {
    kernel(bencher, what, "standard24", Engine::Vectors(Choice::Best));
}

#[divan::bench(args = SCENES, sample_count = 10)]
fn standard24_eight_words(bencher: Bencher, what: (usize, f64)) {
    kernel(bencher, what, "standard24", Engine::Vectors(Choice::Eight));
}

#[divan::bench(args = SCENES, sample_count = 3)]
fn standard24_scalar(bencher: Bencher, what: (usize, f64)) {
    kernel(bencher, what, "standard24", Engine::Scalar);
}
