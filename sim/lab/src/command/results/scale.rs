//! How cost grows: from ten thousand splats to ten million, from 512 x 512 pixels to 3840 x 2160, with one thread and with two.
//!
//! Every row is a process of its own ([`draw_scaled`]), so that its peak of memory is its own. The times of one thread are fitted by
//! `a splats + b covered pixels`; the last column says how far each row is from that.

use super::COMMAND;
use crate::command::options::DrawScaledOptions;
use anyhow::{Context, Result};
use plotters::prelude::SeriesLabelPosition;
use serde::{Deserialize, Serialize};
use splatline_lab::plot::{self, Curve, Marker, PlotPanel};
use splatline_lab::results::table;
use splatline_sim::cli::{Failure, print_result};
use splatline_sim::fast::lanes::{self, VectorLevel};
use splatline_sim::fixed::PaintEngine;
use splatline_sim::memory;
use splatline_sim::progress::ProgressMeter;
use splatline_sim::renderer::{Renderer, Settings};
use splatline_sim::report::plot::{DESIGNS, Tone};
use splatline_sim::rules::Rules;
use splatline_sim::scene::synthetic;
use std::process::Command;
use std::time::Instant;

/// Splats, in pictures of the first size.
const SPLATS: [usize; 4] = [10_000, 100_000, 1_000_000, 10_000_000];
/// Pictures, of a million splats.
const SIZES: [[usize; 2]; 4] = [[512, 512], [1024, 1024], [1920, 1080], [3840, 2160]];
/// Splats of the rows about pictures.
const OF_SIZES: usize = 1_000_000;
/// Frames of which the median counts; one more is drawn before.
const FRAMES: usize = 3;

/// What a process measured.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct ScaleRow {
    splats: usize,
    size: [usize; 2],
    threads: usize,
    /// Seconds.
    setup: f64,
    sort: f64,
    raster: f64,
    frame: f64,
    covered: u64,
    /// Bytes that the renderer holds, and the process at most.
    held: u64,
    peak: Option<u64>,
}

/// The page, and its plot.
pub fn run(choice: VectorLevel) -> Result<(String, String), Failure> {
    let mut asked: Vec<(usize, [usize; 2])> = SPLATS.map(|splats| (splats, SIZES[0])).into();
    asked.extend(SIZES[1..].iter().map(|size| (OF_SIZES, *size)));
    let progress = ProgressMeter::new(2 * asked.len());
    let mut measured = Vec::new();
    for threads in [1, 2] {
        for (splats, size) in &asked {
            progress.doing(format!(
                "{splats} splats, {}x{}, {threads} threads",
                size[0], size[1]
            ));
            measured.push(in_a_process(*splats, *size, threads, choice)?);
            progress.advance();
        }
    }
    drop(progress);
    let plot = svg(&measured).map_err(anyhow::Error::msg)?;
    Ok((text(&measured, choice), plot))
}

fn in_a_process(
    splats: usize,
    [width, height]: [usize; 2],
    threads: usize,
    choice: VectorLevel,
) -> Result<ScaleRow> {
    let program = std::env::current_exe()?;
    let words = [splats, width, height, threads].map(|number| number.to_string());
    let output = Command::new(program)
        .arg("draw-scaled")
        .args(words)
        .arg(level_name(choice))
        .output()?;
    let said = String::from_utf8_lossy(&output.stdout);
    serde_json::from_str(&said).with_context(|| {
        format!(
            "{splats} splats in {width}x{height}: {}",
            String::from_utf8_lossy(&output.stderr)
        )
    })
}

/// The level's name on the command line.
fn level_name(choice: VectorLevel) -> &'static str {
    let levels = VectorLevel::levels();
    let found = levels.iter().find(|(_, level)| *level == choice);
    found.map_or("portable", |(name, _)| name)
}

/// Draws random splats and prints what it took, for [`run`].
pub fn draw_scaled(options: &DrawScaledOptions) -> Result<(), Failure> {
    let measurement = measure(options)?;
    let text = serde_json::to_string(&measurement).map_err(anyhow::Error::from)?;
    print_result(&format!("{text}\n"))?;
    Ok(())
}

fn measure(options: &DrawScaledOptions) -> Result<ScaleRow> {
    let DrawScaledOptions {
        splats,
        width,
        height,
        threads,
        vectors,
    } = *options;
    let scene = synthetic::random_gaussians(splats, 1, 1.0);
    let camera = synthetic::camera(width, height);
    let renderer = |counts| {
        let settings = Settings {
            engine: PaintEngine::Vectors(vectors),
            counts,
            ..Settings::new(Rules::GAUSSIAN_3D)
        };
        let renderer = Renderer::new(&scene, &camera, settings).with_threads(threads);
        renderer.context("cannot start the threads")
    };
    let mut pixels = vec![[0.0; 4]; width * height];
    let mut frames = Vec::new();
    let mut drawing = renderer(false)?;
    for _ in 0..=FRAMES {
        let started = Instant::now();
        let drawn = drawing.draw_floats(&mut pixels, &|_, _| true)?;
        frames.push((started.elapsed().as_secs_f64(), drawn.facts.times));
    }
    let (held, peak) = (drawing.bytes() as u64, memory::peak());
    drop(drawing);
    let counted = renderer(true)?.draw_floats(&mut pixels, &|_, _| true)?;
    // The first frame takes memory for the first time.
    frames.remove(0);
    frames.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (frame, times) = frames[FRAMES / 2];
    Ok(ScaleRow {
        splats,
        size: [width, height],
        threads,
        setup: times.setup,
        sort: times.sort,
        raster: times.raster,
        frame,
        covered: counted.facts.coverage.covered,
        held,
        peak,
    })
}

/// Seconds a splat and a covered pixel that fit the rows of one thread best, each row weighted by its own time.
fn fit(rows: &[ScaleRow]) -> [f64; 2] {
    let mut sums = [[0.0; 3]; 2];
    for row in rows.iter().filter(|row| row.threads == 1) {
        let terms = [
            row.splats as f64 / row.frame,
            row.covered as f64 / row.frame,
        ];
        for (sums, by) in sums.iter_mut().zip(terms) {
            sums[0] += by * terms[0];
            sums[1] += by * terms[1];
            sums[2] += by;
        }
    }
    let [[aa, ab, ay], [_, bb, by]] = sums;
    let determinant = aa * bb - ab * ab;
    [
        (ay * bb - by * ab) / determinant,
        (aa * by - ab * ay) / determinant,
    ]
}

fn text(measured: &[ScaleRow], choice: VectorLevel) -> String {
    let [per_splat, per_pixel] = fit(measured);
    let (one, two): (Vec<_>, Vec<_>) = measured.iter().partition(|row| row.threads == 1);
    let rows = one.iter().zip(two).map(|(row, two)| {
        let fitted = per_splat * row.splats as f64 + per_pixel * row.covered as f64;
        let milliseconds = |seconds: f64| format!("{:.1}", 1e3 * seconds);
        let megabytes = |bytes: u64| format!("{:.0}", bytes as f64 / 1e6);
        vec![
            row.splats.to_string(),
            format!("{}x{}", row.size[0], row.size[1]),
            milliseconds(row.setup),
            milliseconds(row.sort),
            milliseconds(row.raster),
            milliseconds(row.frame),
            milliseconds(two.frame),
            format!("{:.2}", row.frame / two.frame),
            format!("{:.2}", row.covered as f64 / 1e6),
            megabytes(row.held),
            row.peak.map(megabytes).unwrap_or_default(),
            format!("{:+.0} %", 100.0 * (row.frame / fitted - 1.0)),
        ]
    });
    format!(
        "# How the cost of drawing grows\n\nPrinted by `{COMMAND} --only scale`; do not edit. Random Gaussians, standard24, vectors of {}, medians of {FRAMES} frames after \
         one; each row is a process of its own. \"held\" is what the renderer keeps for splats and frames, \"peak\" the most that the process had, its scene in double \
         precision included. The last column is a frame's distance from {:.0} ns a splat and {:.2} ns a covered pixel, which fit all rows best; the bar is 20 %.\n\n\
         ![time and memory against splats](scale.svg)\n\n{}",
        lanes::name(choice),
        1e9 * per_splat,
        1e9 * per_pixel,
        table(
            &[
                "splats",
                "picture",
                "setup ms",
                "sort ms",
                "raster ms",
                "frame ms",
                "two threads ms",
                "gain",
                "million covered pixels",
                "held MB",
                "peak MB",
                "off the line"
            ],
            &rows.collect::<Vec<_>>()
        )
    )
}

/// Frame time and peak memory against splats, all axes logarithmic to base 10.
fn svg(measured: &[ScaleRow]) -> Result<String, String> {
    let of_splats = |threads: usize| {
        let rows = measured.iter().filter(move |row| row.size == SIZES[0]);
        rows.filter(move |row| row.threads == threads)
    };
    let times = [1, 2].map(|threads| {
        let points = of_splats(threads).map(|row| (row.splats as f64, 1e3 * row.frame));
        (["one thread", "two threads"][threads - 1], points.collect())
    });
    let bytes = |bytes: fn(&ScaleRow) -> f64| {
        let points = of_splats(1).map(|row| (row.splats as f64, bytes(row) / 1e6));
        points.collect()
    };
    let memory = [
        ("renderer", bytes(|row| row.held as f64)),
        ("process", bytes(|row| row.peak.unwrap_or_default() as f64)),
    ];
    let panels = [
        panel("ms a frame, 512x512", times),
        panel("MB of memory", memory),
    ];
    plot::svg((1040, 420), &panels)
}

/// A curve's name and its points.
type NamedPoints<'a> = (&'a str, Vec<(f64, f64)>);

fn panel(title: &'static str, curves: [NamedPoints; 2]) -> PlotPanel<'static> {
    let curve = |((name, points), tone): (NamedPoints, Tone)| Curve {
        name: name.to_owned(),
        tone,
        beneath: false,
        marker: Marker::Circle,
        points: points
            .into_iter()
            .map(|(x, y)| (x.log10(), y.log10()))
            .collect(),
    };
    let tones = [DESIGNS[0], DESIGNS[2]];
    PlotPanel {
        title,
        across: "splats",
        columns: 3.7..7.3,
        rows: 0.0..5.0,
        bases: ["10^"; 2],
        numbers: [4, 6],
        legend: SeriesLabelPosition::UpperLeft,
        curves: curves.into_iter().zip(tones).map(curve).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows that lie on a plane give its slopes back, whatever their sizes.
    #[test]
    fn the_fit_finds_the_slopes() {
        let row = |splats: usize, covered: u64| ScaleRow {
            splats,
            size: SIZES[0],
            threads: 1,
            setup: 0.0,
            sort: 0.0,
            raster: 0.0,
            frame: 3e-7 * splats as f64 + 2e-9 * covered as f64,
            covered,
            held: 0,
            peak: None,
        };
        let rows = [
            row(10_000, 900_000),
            row(1_000_000, 30_000_000),
            row(1_000_000, 400_000_000),
        ];
        let [per_splat, per_pixel] = fit(&rows);
        assert!((per_splat - 3e-7).abs() < 1e-12 && (per_pixel - 2e-9).abs() < 1e-14);
    }
}
