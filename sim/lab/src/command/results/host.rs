//! How fast the host draws: the kernel against two single-precision rasterizers, in one run.
//!
//! Ratios are medians over rounds in which every engine draws once, one after the other: what else the machine does meets all of them.
//! Instructions are counted by valgrind where it is installed; it has no AVX-512, so that the AVX2 path is what it counts.

use super::COMMAND;
use super::hardware::{Subject, guitar, lion};
use anyhow::{Context, Result};
use splatline::format::Traversal;
use splatline_lab::baseline::scene::Reach;
use splatline_lab::baseline::{FloatScene, boxes, spans};
use splatline_sim::cli::Failure;
use splatline_sim::design::DesignChoice;
use splatline_sim::fast::lanes::{self, Choice};
use splatline_sim::fixed::{Engine, Options, QuantisedScene, Times, draw_quantised};
use splatline_sim::metrics::{self, ChannelError};
use splatline_sim::picture::Picture;
use splatline_sim::plan::draw::on_threads;
use splatline_sim::progress::Progress;
use splatline_sim::reference::float;
use splatline_sim::rules::{Compositing, Rules};
use splatline_sim::scene::{self, LoadOptions, synthetic};
use std::fmt::Write;
use std::path::Path;
use std::process::Command;

/// Rounds; medians are taken over them.
const ROUNDS: usize = 9;

/// Columns and rows of every picture.
const SIZE: usize = 512;

/// Scenes whose instructions are counted: as the commands name them.
const COUNTED: [&str; 2] = ["random:10000", "random:100000"];

/// One column of the comparison.
enum Contender {
    /// Baseline (a).
    Boxes(Reach),
    /// Baseline (b).
    Spans,
    /// The kernel.
    Kernel(DesignChoice),
}

/// What one engine did in all rounds.
struct Runs {
    name: &'static str,
    one: Vec<Times>,
    two: Vec<Times>,
    error: ChannelError,
}

/// A scene's table.
struct Measured {
    name: &'static str,
    splats: usize,
    covered: u64,
    finished: u64,
    runs: Vec<Runs>,
}

fn contenders() -> Vec<(&'static str, Contender)> {
    let kernel = |name| DesignChoice::named(name).map(|design| (name, Contender::Kernel(design)));
    let mut all = vec![
        ("(a) boxes", Contender::Boxes(Reach::Sigmas)),
        ("(a) tight boxes", Contender::Boxes(Reach::Cutoff)),
        ("(b) spans", Contender::Spans),
    ];
    all.extend(
        ["lean18", "standard24", "deep32"]
            .into_iter()
            .filter_map(kernel),
    );
    all
}

/// Measures every scene that is there.
pub fn run(data: &Path) -> Result<String, Failure> {
    let subjects = subjects(data)?;
    let progress = Progress::new(subjects.len());
    let mut text = opening();
    let mut tables = Vec::new();
    for subject in &subjects {
        progress.doing(subject.name.to_owned());
        tables.push(measure(subject)?);
        progress.advance();
    }
    drop(progress);
    text.push_str(&summary(&tables));
    text.push_str(&instructions());
    for table in &tables {
        text.push_str(&details(table));
    }
    Ok(text)
}

fn opening() -> String {
    format!(
        "# Speed on the host\n\nPrinted by `{COMMAND} --only host`; do not edit. {SIZE} x {SIZE} pixels, vectors of {}; medians of {ROUNDS} \
         rounds in which all engines draw one after the other, ratios within the round. Time is setup + sort + raster of a scene that has been \
         loaded and quantised.\n\n(a) is what open CPU rasterizers do: conic, square of three sigmas, 16 x 16 tiles, sorted duplicates, early \
         termination, library `exp`; \"tight\" is the same with the box of the cut-off. (b) has the kernel's spans, tiles, order and vectors, and a \
         polynomial `exp`. docs/host-speed.md says how the kernel is drawn and which ways lost.\n",
        lanes::name(Choice::Best)
    )
}

fn subjects(data: &Path) -> Result<Vec<Subject>> {
    let mut subjects = Vec::new();
    subjects.extend(guitar(data)?);
    subjects.extend(lion(data)?);
    let brain = data.join("volumes/brainsmall.nhdr");
    if brain.exists() {
        let scene = scene::load(&brain, &LoadOptions::default())?;
        subjects.push(Subject {
            name: "brainsmall",
            camera: scene.default_camera(SIZE, SIZE),
            rules: scene.natural_rules,
            scene,
        });
    }
    let random = [
        ("random 10k", 10_000, 1.0),
        ("random 10k x 2.5", 10_000, 2.5),
        ("random 100k", 100_000, 1.0),
        ("random 100k x 2.5", 100_000, 2.5),
    ];
    subjects.extend(random.map(|(name, count, multiplier)| Subject {
        name,
        scene: synthetic::random_gaussians(count, 1, multiplier),
        camera: synthetic::camera(SIZE, SIZE),
        rules: Rules::GAUSSIAN_3D,
    }));
    Ok(subjects)
}

fn measure(subject: &Subject) -> Result<Measured> {
    let Subject {
        name,
        scene,
        camera,
        rules,
    } = subject;
    let floats = FloatScene::new(scene, camera, rules);
    let quantised = QuantisedScene::new(scene, camera, rules);
    let reference = float::draw(scene, camera, rules, Compositing::FrontToBack).picture;
    let (mut covered, mut finished) = (0, 0);
    let mut draw = |contender: &Contender| -> (Times, Picture) {
        match contender {
            Contender::Boxes(reach) => {
                let drawing = boxes::draw(&floats, *reach);
                (drawing.times, drawing.picture(floats.viewport))
            }
            Contender::Spans => {
                let drawing = spans::draw(&floats, Choice::Best);
                (drawing.times, drawing.picture(floats.viewport))
            }
            Contender::Kernel(design) => {
                let options = Options {
                    rules,
                    compositing: Compositing::FrontToBack,
                    design,
                    traversal: Traversal::Spans,
                };
                let engine = Engine::Vectors(Choice::Best);
                let (drawing, _) = draw_quantised(&quantised, camera, &options, engine);
                (covered, finished) = (drawing.coverage.covered, drawing.coverage.finished);
                (drawing.times, drawing.picture)
            }
        }
    };
    let contenders = contenders();
    let mut runs = Vec::new();
    for (name, contender) in &contenders {
        let (_, picture) = draw(contender);
        runs.push(Runs {
            name,
            one: Vec::new(),
            two: Vec::new(),
            error: metrics::compare(&picture, &reference)?.colour,
        });
    }
    for threads in [1, 2] {
        on_threads(threads, || {
            for _ in 0..ROUNDS {
                for ((_, contender), runs) in contenders.iter().zip(&mut runs) {
                    let times = draw(contender).0;
                    let list = if threads == 1 {
                        &mut runs.one
                    } else {
                        &mut runs.two
                    };
                    list.push(times);
                }
            }
        })?;
    }
    Ok(Measured {
        name,
        splats: scene.splats.len(),
        covered,
        finished,
        runs,
    })
}

fn total(times: &Times) -> f64 {
    times.setup + times.sort + times.raster
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    metrics::median(&mut values.collect::<Vec<_>>()).unwrap_or(f64::NAN)
}

/// How many times as fast the second is, by rounds.
fn ratio(slow: &[Times], fast: &[Times]) -> f64 {
    median(
        slow.iter()
            .zip(fast)
            .map(|(slow, fast)| total(slow) / total(fast)),
    )
}

/// Bars against what was measured.
fn summary(tables: &[Measured]) -> String {
    let mut text = String::from(
        "\n| scene | standard24 to (a) | bar 5 | to (b) | bar 1 | lean18 to (a) | bar 8 | to (b) | bar 1.5 | standard24, two threads | bar 1.8 |\n\
         |---|--:|---|--:|---|--:|---|--:|---|--:|---|\n",
    );
    for Measured { name, runs, .. } in tables {
        let [a, _, b, lean, standard, ..] = runs.as_slice() else {
            continue;
        };
        let bars = [
            (ratio(&a.one, &standard.one), 5.0),
            (ratio(&b.one, &standard.one), 1.0),
            (ratio(&a.one, &lean.one), 8.0),
            (ratio(&b.one, &lean.one), 1.5),
            (ratio(&standard.one, &standard.two), 1.8),
        ];
        let _ = write!(text, "| {name} |");
        for (measured, bar) in bars {
            let verdict = if measured >= bar { "met" } else { "MISSED" };
            let _ = write!(text, " {measured:.2} | {verdict} |");
        }
        text.push('\n');
    }
    text
}

/// Milliseconds and errors of one scene.
fn details(table: &Measured) -> String {
    let mut text = format!(
        "\n## {}\n\n{} splats; {:.2} million covered pixels, of them {:.2} million already finished.\n\n\
         | engine | setup ms | sort ms | raster ms | total ms | ns per covered pixel | to (a) | to (b) | two threads | PSNR dB | largest error | bias |\n\
         |---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n",
        table.name,
        table.splats,
        table.covered as f64 / 1e6,
        table.finished as f64 / 1e6,
    );
    let [a, _, b, ..] = table.runs.as_slice() else {
        return text;
    };
    for runs in &table.runs {
        let part = |part: fn(&Times) -> f64| median(runs.one.iter().map(part));
        let error = &runs.error;
        let _ = writeln!(
            text,
            "| {} | {:.2} | {:.2} | {:.2} | {:.2} | {:.2} | {:.2} | {:.2} | {:.2} | {:.1} | {:.1e} | {:+.1e} |",
            runs.name,
            1e3 * part(|times| times.setup),
            1e3 * part(|times| times.sort),
            1e3 * part(|times| times.raster),
            1e3 * part(total),
            1e9 * part(total) / table.covered as f64,
            ratio(&a.one, &runs.one),
            ratio(&b.one, &runs.one),
            ratio(&runs.one, &runs.two),
            error.psnr_db,
            error.max_abs,
            error.bias,
        );
    }
    text
}

/// Instructions of the raster loop by callgrind, of one thread.
fn instructions() -> String {
    let mut text = String::from(
        "\nInstructions of the raster loop (tiles opened, painted and written out) on one thread by `valgrind --tool=callgrind`, AVX2; the bar is 8 per \
         covered pixel.\n\n| scene | design | million instructions | per covered pixel |\n|---|---|--:|--:|\n",
    );
    for scene in COUNTED {
        for design in ["lean18", "standard24"] {
            let counted = count(scene, design);
            let line = match counted {
                Ok((instructions, covered)) => format!(
                    "| {scene} | {design} | {:.1} | {:.2} |",
                    instructions as f64 / 1e6,
                    instructions as f64 / covered as f64
                ),
                Err(error) => format!("| {scene} | {design} | not counted: {error} | |"),
            };
            text.push_str(&line);
            text.push('\n');
        }
    }
    text
}

/// Instructions within the raster loop, and covered pixels, of one picture drawn by this program under valgrind.
fn count(scene: &str, design: &str) -> Result<(u64, u64)> {
    let folder = std::env::temp_dir().join(format!("splatline-count-{}", std::process::id()));
    std::fs::create_dir_all(&folder)?;
    let counted = count_in(scene, design, &folder);
    std::fs::remove_dir_all(&folder)?;
    counted
}

fn count_in(scene: &str, design: &str, folder: &Path) -> Result<(u64, u64)> {
    let (picture, report) = (folder.join("picture.png"), folder.join("report.json"));
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--toggle-collect=*paint_frame*"])
        .arg(format!(
            "--callgrind-out-file={}",
            folder.join("out").display()
        ))
        .arg(std::env::current_exe()?)
        .args(["render", scene, "--design", design, "--threads", "1", "-o"])
        .args([&picture, Path::new("--json"), &report])
        .output()
        .context("valgrind does not start")?;
    let log = String::from_utf8_lossy(&output.stderr);
    let collected = log
        .lines()
        .find_map(|line| line.split_once("Collected : "))
        .with_context(|| "valgrind collected nothing".to_owned())?;
    let instructions = collected.1.trim().parse()?;
    let report: serde_json::Value = serde_json::from_slice(&std::fs::read(report)?)?;
    let covered = report["pixels"]["covered"]
        .as_u64()
        .context("no covered pixels in the report")?;
    Ok((instructions, covered))
}
