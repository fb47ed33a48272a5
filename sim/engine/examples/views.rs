//! Milliseconds of whole frames on one thread, for the views that `.ci/faster.py` compares two builds by: it compiles
//! this file in both.
//!
//! ```text
//! cargo run --release -p splatline-engine --example views [avx2|avx512|portable] [FOLDER OF SCENES] [VIEW]
//! ```

use splatline_engine::camera::Camera;
use splatline_engine::design::DesignChoice;
use splatline_engine::fast::lanes::VectorLevel;
use splatline_engine::fixed::PaintEngine;
use splatline_engine::renderer::{Renderer, Settings};
use splatline_engine::scene::{LoadOptions, Scene, load, synthetic};
use std::error::Error;
use std::path::Path;
use std::time::Instant;

const ROUNDS: usize = 8;
const VIEWS: [&str; 6] = ["100k", "100k x 2.5", "1M", "guitar", "close-up", "stack"];

fn main() -> Result<(), Box<dyn Error>> {
    let mut options = std::env::args().skip(1);
    let vectors: VectorLevel = options.next().unwrap_or("avx2".into()).parse()?;
    let folder = options.next().unwrap_or("../shared/data".into());
    let wanted = options.next();
    println!("view,design,milliseconds");
    for name in VIEWS {
        if wanted.as_deref().is_some_and(|wanted| wanted != name) {
            continue;
        }
        let (scene, camera) = view(name, Path::new(&folder))?;
        for design in ["lean18", "standard24"] {
            let settings = Settings {
                design: DesignChoice::named(design).ok_or("a named design")?,
                engine: PaintEngine::Vectors(vectors),
                ..Settings::new(scene.natural_rules)
            };
            let mut renderer = Renderer::new(&scene, &camera, settings).with_threads(1)?;
            let mut frame = vec![[0.0; 4]; camera.width * camera.height];
            // The first frame takes the memory.
            renderer.draw_floats(&mut frame, &|_, _| true)?;
            let mut times = [0.0; ROUNDS];
            for time in &mut times {
                let started = Instant::now();
                renderer.draw_floats(&mut frame, &|_, _| true)?;
                *time = started.elapsed().as_secs_f64() * 1e3;
            }
            times.sort_by(f64::total_cmp);
            println!("{name},{design},{:.3}", times[ROUNDS / 2]);
        }
    }
    Ok(())
}

/// A scene and its camera.
fn view(name: &str, folder: &Path) -> Result<(Scene, Camera), Box<dyn Error>> {
    let random = |count, scale| synthetic::random_gaussians(count, 1, scale);
    let guitar = |eye, target| -> Result<_, Box<dyn Error>> {
        let scene = load(
            &folder.join("gaussians/guitar.ply"),
            &LoadOptions::default(),
        )?;
        let camera = Camera::look_at(eye, target, [0.0, -1.0, 0.0], 50.0, 512, 512)?;
        Ok((scene, camera))
    };
    Ok(match name {
        "100k" => (random(100_000, 1.0), synthetic::camera(512, 512)),
        "100k x 2.5" => (random(100_000, 2.5), synthetic::camera(512, 512)),
        "1M" => (random(1_000_000, 1.0), synthetic::camera(1920, 1080)),
        "guitar" => guitar([5.5, -2.1, 0.2], [0.1, -2.1, 0.1])?,
        "close-up" => guitar([2.2, -1.2, 0.5], [0.1, -1.2, 0.1])?,
        _ => {
            let scene = load(Path::new("deep-stack"), &LoadOptions::default())?;
            let camera = scene.default_camera(512, 512);
            (scene, camera)
        }
    })
}
