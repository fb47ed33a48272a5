//! The reference against data that other people's code computed.

use std::path::{Path, PathBuf};

use splatline_reference::camera::Camera;
use splatline_reference::engines::compositor::{self, OnScreen, ScreenSplat};
use splatline_reference::engines::float::Footprint;
use splatline_reference::engines::golden::{self, ALL, Deviation, GoldenA, GoldenSplat};
use splatline_reference::engines::{Culled, exact, float};
use splatline_reference::metrics::compare;
use splatline_reference::picture::Picture;
use splatline_reference::rules::{Compositing, Rules};
use splatline_reference::scene::{LoadOptions, Splat, load};

/// The small scene of another renderer, which is not ours to publish.
fn shared_folder() -> PathBuf {
    Path::new(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../../shared/data/golden"
    ))
    .to_path_buf()
}

fn print_table(deviations: &[Deviation]) {
    println!("largest differences of float     conic     centre      depth    picture");
    for d in deviations {
        print!("{:<18} {:>8} ", d.category, d.splats);
        println!(
            "{:>10.1e} {:>10.1e} {:>10.1e} {:>10.1e}",
            d.conic, d.centre, d.depth, d.picture
        );
    }
}

#[test]
fn float_agrees_with_sixty_digits_and_with_independent_pictures() {
    let golden = GoldenA::load(&golden::archive()).unwrap();
    assert_eq!(golden.splats.len(), 256);
    assert_eq!(golden.categories.len(), 11);
    let deviations = golden.measure();
    print_table(&deviations);
    for d in &deviations {
        assert!(d.splats > 0, "{}: nothing compared", d.category);
        for (name, found, most) in [
            ("conic", d.conic, 1e-9),
            ("centre", d.centre, 1e-12),
            ("depth", d.depth, 1e-15),
            ("picture", d.picture, 2e-5),
        ] {
            assert!(found <= most, "{}: {name} differs by {found:e}", d.category);
        }
    }
}

/// gsplat's own factor, of every splat before the camera: 1e-6 of it and of 1.
#[test]
fn compensation_of_the_low_pass_filter_is_gsplats() {
    let golden = GoldenA::load(&golden::archive()).unwrap();
    let rules = Rules {
        compensated: true,
        ..golden.rules
    };
    let mut compared = 0;
    for golden_splat in &golden.splats {
        let opaque = Splat {
            weight: 1.0,
            ..golden_splat.splat
        };
        let projected = float::project_beyond_viewport(&opaque, &golden.camera, &rules);
        let factor = match projected {
            Ok(footprint) => footprint.peak,
            Err(Culled::Transparent) => {
                // Below the smallest opacity, with the factor alone: it is small.
                assert!(golden_splat.compensation < 1.0 / 255.0);
                continue;
            }
            Err(_) => continue,
        };
        let difference = (factor - golden_splat.compensation).abs();
        let least = rules.alpha_min;
        assert!(
            difference <= 1e-6 * golden_splat.compensation.max(least),
            "{factor} {}",
            golden_splat.compensation
        );
        compared += 1;
    }
    assert!(compared > 180, "{compared}");
}

/// The largest opacity of a golden splat at any pixel, from the 60-digit conic.
fn largest_opacity(golden: &GoldenSplat, camera: &Camera) -> f64 {
    let [a, b, c] = golden.exact_conic;
    let opacity = |column: usize, row: usize| {
        let x = column as f64 + 0.5 - golden.centre[0];
        let y = row as f64 + 0.5 - golden.centre[1];
        golden.splat.weight * (-0.5 * (a * x * x + 2.0 * b * x * y + c * y * y)).exp()
    };
    let pixels =
        (0..camera.height).flat_map(|row| (0..camera.width).map(move |column| (column, row)));
    pixels
        .map(|(column, row)| opacity(column, row))
        .fold(0.0, f64::max)
}

#[test]
fn only_splats_that_leave_no_trace_are_culled() {
    let golden = GoldenA::load(&golden::archive()).unwrap();
    let projected = float::footprints(&golden.scene(ALL), &golden.camera, &golden.rules);
    for (index, (golden_splat, outcome)) in golden.splats.iter().zip(projected).enumerate() {
        match outcome {
            Ok(_) => assert!(
                golden_splat.depth > golden.camera.near,
                "splat {index} lies before the near plane"
            ),
            Err(Culled::Near) => assert!(
                golden_splat.depth <= golden.camera.near,
                "splat {index} is in view"
            ),
            Err(why) => {
                let opacity = largest_opacity(golden_splat, &golden.camera);
                assert!(
                    opacity < 1.0 / 255.0,
                    "splat {index} is culled as {why:?} with opacity {opacity}"
                );
            }
        }
    }
}

/// A footprint whose Gaussian is lowered to reach zero at three standard deviations: how the renderer of the tiny
/// scene avoids a visible edge, and its one difference from the `3dgs` rules.
struct FadedTail(Footprint);

impl FadedTail {
    const END: f64 = 9.0;
}

impl ScreenSplat for FadedTail {
    fn on_screen(&self) -> OnScreen {
        self.0.on_screen()
    }

    fn radial_index_and_peak(&self, point: [f64; 2]) -> (f64, f64) {
        let (r, peak) = self.0.radial_index_and_peak(point);
        if r >= Self::END {
            return (f64::INFINITY, peak);
        }
        let floor = (-0.5 * Self::END).exp();
        let weight = ((-0.5 * r).exp() - floor) / (1.0 - floor);
        (0.0, peak * weight)
    }
}

#[test]
#[cfg_attr(not(has_data), ignore = "needs the shared data")]
fn tiny_scene_agrees_with_an_independent_renderer() {
    let folder = shared_folder();
    let scene = load(&folder.join("tiny.ply"), &LoadOptions::default()).unwrap();
    assert_eq!(scene.splats.len(), 400);
    let expected = Picture::read_png(&folder.join("tiny.png")).unwrap();
    let (eye, up) = ([0.0, -5.0, -8.0], [0.0, -1.0, 0.0]);
    let camera = Camera::look_at(eye, [0.0; 3], up, 60.0, 320, 240).unwrap();
    let (rules, order) = (Rules::GAUSSIAN_3D, Compositing::FrontToBack);

    let psnr = |drawn: &Picture| compare(drawn, &expected).unwrap().colour.psnr_db;
    let plain = psnr(&float::draw(&scene, &camera, &rules, order).picture);
    let exact = psnr(&exact::draw(&scene, &camera, &rules, order).picture);
    let faded: Vec<_> = float::footprints(&scene, &camera, &rules)
        .into_iter()
        .map(|outcome| outcome.map(FadedTail))
        .collect();
    let faded = psnr(&compositor::draw(&faded, &camera, &rules, order, &|_, _| ()).picture);
    println!(
        "tiny scene: float {plain:.2} dB, exact {exact:.2} dB, float with faded tails {faded:.2} dB"
    );
    assert!(plain >= 47.0 && exact >= 47.0);
    // What is left is mostly the stored picture's rounding to 8 bits: 58.9 dB for evenly spread errors.
    assert!(faded >= 57.0);
}
