//! The page of times: how fast the kernel draws on this machine, held against the single-precision
//! [`rasterizer`](crate::rasterizer).
//!
//! Ratios are medians over rounds in which every engine draws once, one after the other: what else the machine does
//! meets all of them. A frame is everything from a scene that has been loaded to single-precision pixels in memory, by
//! the wall clock.

use super::Page;
use crate::rasterizer::FloatScene;
use crate::table::Table;
use crate::views::{BRAIN, GUITAR, LION, View};
use anyhow::{Context, Result};
use splatline_sim::design::DesignChoice;
use splatline_sim::fast::lanes::{self, VectorLevel};
use splatline_sim::fixed::{PaintEngine, Times};
use splatline_sim::metrics::{self, compare};
use splatline_sim::picture::Picture;
use splatline_sim::plan::draw::on_threads;
use splatline_sim::renderer::{Renderer, Settings};
use splatline_sim::scene::{Scene, synthetic};
use std::path::Path;
use std::time::Instant;

/// Rounds; medians are taken over them.
const ROUNDS: usize = 5;

/// Columns and rows of every picture.
const SIZE: usize = 512;

/// Random scenes: name, splats, factor of their scales.
const RANDOM: [(&str, usize, f64); 4] = [
    ("random 10k", 10_000, 1.0),
    ("random 100k", 100_000, 1.0),
    ("random 100k x 2.5", 100_000, 2.5),
    ("random 1M", 1_000_000, 1.0),
];

/// The kernel's designs that are measured, after the rasterizer.
const DESIGNS: [&str; 2] = ["lean18", "standard24"];

/// What draws.
enum Contender<'a> {
    Floats(FloatScene, VectorLevel),
    Kernel(Box<Renderer<&'a Scene>>),
}

/// One frame's seconds.
#[derive(Clone, Copy)]
struct FrameTimes {
    stages: Times,
    total: f64,
}

/// What one contender took in all rounds, with one thread and with two, and its PSNR.
struct Runs {
    name: &'static str,
    frames: [Vec<FrameTimes>; 2],
    psnr_db: f64,
}

impl Contender<'_> {
    fn draw(&mut self, pixels: &mut [[f32; 4]]) -> Result<FrameTimes> {
        let started = Instant::now();
        let stages = match self {
            Contender::Floats(scene, level) => scene.draw(*level).times,
            Contender::Kernel(renderer) => renderer.draw_floats(pixels, &|_, _| true)?.facts.times,
        };
        Ok(FrameTimes {
            stages,
            total: started.elapsed().as_secs_f64(),
        })
    }

    fn picture(&mut self) -> Result<Picture> {
        match self {
            Contender::Floats(scene, level) => Ok(scene.picture(&scene.draw(*level))),
            Contender::Kernel(renderer) => {
                let mut picture = Picture::new(0, 0);
                renderer.draw_picture(&mut picture, &|_, _| true)?;
                Ok(picture)
            }
        }
    }
}

/// The page over the scenes of a folder, on each level of vectors.
pub fn page(data: &Path, levels: &[VectorLevel]) -> Result<Page> {
    let mut page = Page::new("speed", "Speed");
    page.add(format!(
        "{SIZE} x {SIZE} pixels; medians of {ROUNDS} rounds in which all engines draw one after the other, ratios within the round. A frame is everything from a scene that has \
         been loaded and quantised to single-precision pixels in memory. \"Floats\" is the best that open CPU rasterizers do (`sim/docs/src/rasterizer.rs`). \
         [speed.csv](speed.csv) has setup, sort and raster of each."
    ));
    let mut all = Table::new(
        "scene | vectors | engine | setup_ms | sort_ms | raster_ms | frame_ms | two_threads_ms | \
         floats_to_it | psnr_db",
    );
    for level in levels {
        let mut table = Table::new(
            "scene | floats ms | lean18 ms | standard24 ms | floats to lean18 | floats to standard24 | \
             two threads",
        );
        for (name, count, factor) in RANDOM {
            let scene = synthetic::random_gaussians(count, 1, factor);
            let view = View::new(name, scene, synthetic::camera(SIZE, SIZE));
            add(&mut table, &mut all, &view, *level)?;
        }
        for name in [GUITAR, BRAIN, LION] {
            add(&mut table, &mut all, &View::load(name, data, SIZE)?, *level)?;
        }
        page.add(format!("## {}", lanes::name(*level)));
        page.add(table.markdown());
    }
    page.beside("speed.csv", all.csv());
    Ok(page)
}

/// The rows of one scene.
fn add(table: &mut Table, all: &mut Table, view: &View, level: VectorLevel) -> Result<()> {
    let runs = measure(view, level)?;
    let Some(floats) = runs.first() else {
        return Ok(());
    };
    for run in &runs {
        let ms = |of: fn(&FrameTimes) -> f64| {
            format!("{:.2}", 1e3 * median(run.frames[0].iter().map(of)))
        };
        let two = median(run.frames[1].iter().map(|frame| frame.total));
        let cells = [
            ms(|frame| frame.stages.setup),
            ms(|frame| frame.stages.sort),
            ms(|frame| frame.stages.raster),
            ms(|frame| frame.total),
            format!("{:.2}", 1e3 * two),
            format!("{:.2}", ratio(&floats.frames[0], &run.frames[0])),
            format!("{:.1}", run.psnr_db),
        ];
        all.push_behind(&[view.name, lanes::name(level), run.name], cells);
    }
    let frames = runs.iter().map(|run| {
        let seconds = median(run.frames[0].iter().map(|frame| frame.total));
        format!("{:.1}", 1e3 * seconds)
    });
    let behind = runs.iter().skip(1);
    let ratios = behind.map(|run| format!("{:.2}", ratio(&floats.frames[0], &run.frames[0])));
    let last = runs.last();
    let gain = last.map(|run| format!("{:.2}", ratio(&run.frames[0], &run.frames[1])));
    table.push_behind(&[view.name], frames.chain(ratios).chain(gain));
    Ok(())
}

fn measure(view: &View, level: VectorLevel) -> Result<Vec<Runs>> {
    let reference = view.reference();
    let floats = FloatScene::new(&view.scene, &view.camera, &view.rules);
    let mut contenders = vec![("floats", Contender::Floats(floats, level))];
    for name in DESIGNS {
        let settings = Settings {
            design: DesignChoice::named(name).context("a design that is not named")?,
            engine: PaintEngine::Vectors(level),
            ..Settings::new(view.rules)
        };
        let renderer = Renderer::new(&view.scene, &view.camera, settings);
        contenders.push((name, Contender::Kernel(Box::new(renderer))));
    }
    let mut runs = Vec::new();
    for (name, contender) in &mut contenders {
        let psnr_db = compare(&contender.picture()?, &reference)?.colour.psnr_db;
        runs.push(Runs {
            name,
            frames: Default::default(),
            psnr_db,
        });
    }
    let mut pixels = vec![[0.0; 4]; SIZE * SIZE];
    for threads in [1, 2] {
        on_threads(threads, || -> Result<()> {
            for _ in 0..ROUNDS {
                for ((_, contender), runs) in contenders.iter_mut().zip(&mut runs) {
                    runs.frames[threads - 1].push(contender.draw(&mut pixels)?);
                }
            }
            Ok(())
        })??;
    }
    Ok(runs)
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    metrics::median(&mut values.collect::<Vec<_>>()).unwrap_or(f64::NAN)
}

/// How many times as fast the second is, by rounds.
fn ratio(slow: &[FrameTimes], fast: &[FrameTimes]) -> f64 {
    median(
        slow.iter()
            .zip(fast)
            .map(|(slow, fast)| slow.total / fast.total),
    )
}
