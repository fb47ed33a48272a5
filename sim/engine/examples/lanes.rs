//! Frames of lean18 in single precision beside the same widths on 64-bit words: time on one thread, and whether a pixel
//! differs.
//!
//! ```text
//! cargo run --release -p splatline-engine --example lanes [GUITAR.ply]
//! ```

use splatline::blend::Pixel;
use splatline_engine::camera::Camera;
use splatline_engine::design::DesignChoice;
use splatline_engine::fast::lanes::VectorLevel;
use splatline_engine::fixed::PaintEngine;
use splatline_engine::renderer::{Renderer, Settings};
use splatline_engine::rules::Rules;
use splatline_engine::scene::{LoadOptions, Scene, load, synthetic};
use std::error::Error;
use std::path::Path;
use std::time::Instant;

/// Paired rounds; the median of each counts.
const ROUNDS: usize = 15;

fn main() -> Result<(), Box<dyn Error>> {
    println!(
        "| scene | vectors | single, ms | words, ms | ratio | pixels that differ |\n|---|---|--:|--:|--:|--:|"
    );
    let square = synthetic::camera(512, 512);
    for (name, count, scale) in [
        ("random 10k", 10_000, 1.0),
        ("random 100k", 100_000, 1.0),
        ("random 100k x 2.5", 100_000, 2.5),
    ] {
        let scene = synthetic::random_gaussians(count, 1, scale);
        all_levels(name, &scene, &square)?;
    }
    if let Some(file) = std::env::args().nth(1) {
        let scene = load(Path::new(&file), &LoadOptions::default())?;
        let [eye, target] = [[5.5, -2.1, 0.2], [0.1, -2.1, 0.1]];
        let camera = Camera::look_at(eye, target, [0.0, -1.0, 0.0], 50.0, 512, 512)?;
        all_levels("guitar", &scene, &camera)?;
    }
    Ok(())
}

fn all_levels(name: &str, scene: &Scene, camera: &Camera) -> Result<(), Box<dyn Error>> {
    for (level, choice) in VectorLevel::levels() {
        if choice != VectorLevel::Portable {
            println!("| {name} | {level} | {} |", paired(scene, camera, choice)?);
        }
    }
    Ok(())
}

/// Both ways in turn.
fn paired(scene: &Scene, camera: &Camera, choice: VectorLevel) -> Result<String, Box<dyn Error>> {
    let single = DesignChoice::named("lean18").ok_or("lean18 is a named design")?;
    let words = single.at_run_time();
    let mut renderers = Vec::new();
    for design in [single, words] {
        let settings = Settings {
            design,
            engine: PaintEngine::Vectors(choice),
            ..Settings::new(Rules::GAUSSIAN_3D)
        };
        renderers.push(Renderer::new(scene, camera, settings).with_threads(1)?);
    }
    let mut frames = vec![vec![Pixel::default(); camera.width * camera.height]; 2];
    let mut times = [const { Vec::new() }; 2];
    for _ in 0..ROUNDS {
        for ((renderer, frame), times) in renderers.iter_mut().zip(&mut frames).zip(&mut times) {
            let start = Instant::now();
            renderer.draw(frame, &|_, _| true)?;
            times.push(start.elapsed().as_secs_f64() * 1e3);
        }
    }
    let [single, words] = times.map(|mut times| {
        times.sort_by(f64::total_cmp);
        times[ROUNDS / 2]
    });
    let differ = frames[0]
        .iter()
        .zip(&frames[1])
        .filter(|(a, b)| a != b)
        .count();
    Ok(format!(
        "{single:.2} | {words:.2} | {:.2} | {differ}",
        words / single
    ))
}
