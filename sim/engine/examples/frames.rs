//! Frames of deep scenes on one thread: time by stage, memory, splats left out, and a digest by which two builds can be
//! compared.
//!
//! ```text
//! cargo run --release -p splatline-engine --example frames [avx2|avx512|portable]
//! ```

use splatline::blend::Pixel;
use splatline_engine::design::DesignChoice;
use splatline_engine::fast::lanes::VectorLevel;
use splatline_engine::fixed::PaintEngine;
use splatline_engine::renderer::{Renderer, Settings};
use splatline_engine::rules::Rules;
use splatline_engine::scene::synthetic;
use std::error::Error;
use std::time::Instant;

const ROUNDS: usize = 7;

fn main() -> Result<(), Box<dyn Error>> {
    let level = std::env::args().nth(1).unwrap_or("avx2".into());
    let vectors: VectorLevel = level.parse()?;
    println!(
        "{level}, the fastest of {ROUNDS} frames\n\n| splats | pixels | design | setup, ms | order, ms | pixels, ms | frame, ms | left out | MB | digest |"
    );
    println!("|---|---|---|--:|--:|--:|--:|--:|--:|---|");
    for (count, scale, columns, rows) in [
        (100_000, 1.0, 512, 512),
        (100_000, 2.5, 512, 512),
        (1_000_000, 1.0, 1920, 1080),
        (4_000_000, 1.0, 1920, 1080),
    ] {
        let scene = synthetic::random_gaussians(count, 1, scale);
        let camera = synthetic::camera(columns, rows);
        for name in ["standard24", "lean18"] {
            let settings = Settings {
                design: DesignChoice::named(name).ok_or("a named design")?,
                engine: PaintEngine::Vectors(vectors),
                ..Settings::new(Rules::GAUSSIAN_3D)
            };
            let mut renderer = Renderer::new(&scene, &camera, settings).with_threads(1)?;
            let mut frame = vec![Pixel::default(); columns * rows];
            let (mut fastest, mut facts) = (f64::MAX, Default::default());
            for _ in 0..ROUNDS {
                let started = Instant::now();
                let drawn = renderer.draw(&mut frame, &|_, _| true)?;
                let whole = started.elapsed().as_secs_f64();
                if whole < fastest {
                    (fastest, facts) = (whole, drawn.facts);
                }
            }
            let [setup, order, pixels, whole] = [
                facts.times.setup,
                facts.times.sort,
                facts.times.raster,
                fastest,
            ]
            .map(|seconds| seconds * 1e3);
            println!(
                "| {count} x {scale} | {columns} x {rows} | {name} | {setup:.1} | {order:.1} | {pixels:.1} | {whole:.1} | {} | {:.0} | {:016x} |",
                facts.left_out,
                renderer.bytes() as f64 / 1e6,
                digest(&frame)
            );
        }
    }
    Ok(())
}

/// FNV-1a over the pixels' words.
fn digest(frame: &[Pixel]) -> u64 {
    let words = frame
        .iter()
        .flat_map(|pixel| pixel.colour.into_iter().chain([pixel.transmittance]));
    words.fold(0xcbf2_9ce4_8422_2325, |hash, word| {
        (hash ^ u64::from(word)).wrapping_mul(0x0100_0000_01b3)
    })
}
