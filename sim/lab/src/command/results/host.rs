//! How fast the host draws: the kernel against single-precision rasterizers, in one run, on each kind of vectors.
//!
//! Ratios are medians over rounds in which every engine draws once, one after the other: what else the machine does meets all of them. A
//! frame is everything from a scene that has been loaded to single-precision pixels in memory, by the wall clock.
//! Instructions are counted by valgrind where it is installed; it has no AVX-512, so that the AVX2 path is what it counts.

use super::COMMAND;
use super::hardware::{HardwareScene, guitar, lion};
use crate::command::options::DrawOnceOptions;
use anyhow::{Context, Result, ensure};
use splatline_lab::baseline::scene::BoxExtent;
use splatline_lab::baseline::{FloatScene, boxes, spans, textbook};
use splatline_sim::cli::{Failure, print_result};
use splatline_sim::design::DesignChoice;
use splatline_sim::fast::lanes::{self, VectorLevel};
use splatline_sim::fixed::{PaintEngine, Times};
use splatline_sim::metrics::{self, ChannelError};
use splatline_sim::picture::Picture;
use splatline_sim::plan::draw::on_threads;
use splatline_sim::progress::ProgressMeter;
use splatline_sim::reference::float;
use splatline_sim::renderer::{Renderer, Settings};
use splatline_sim::rules::{Compositing, Rules};
use splatline_sim::scene::{self, LoadOptions, Scene, synthetic};
use std::fmt::Write;
use std::path::Path;
use std::process::Command;
use std::time::Instant;

/// Rounds; medians are taken over them.
const ROUNDS: usize = 5;

/// Columns and rows of every picture.
const SIZE: usize = 512;

/// Splats of the random scenes whose instructions are counted.
const COUNTED: [&str; 2] = ["10000", "100000"];

/// Largest share of a frame outside setup, sort and raster.
const REST_BAR: f64 = 0.05;

/// One column of the comparison.
enum Contender<'a> {
    /// Baseline (a).
    Boxes(BoxExtent),
    /// What (a) would be without what makes it fast.
    Textbook,
    /// Baseline (b).
    Spans,
    /// The kernel, with its memory.
    Kernel(Box<Renderer<&'a Scene>>),
}

/// One frame's seconds.
#[derive(Clone, Copy)]
struct HostFrame {
    times: Times,
    total: f64,
}

/// What one engine did in all rounds.
struct RunLengths {
    name: &'static str,
    one: Vec<HostFrame>,
    two: Vec<HostFrame>,
    error: ChannelError,
}

/// A scene's table.
struct PhaseTimes {
    name: &'static str,
    /// Least ratios of standard24 and of lean18 to (a).
    bars: [f64; 2],
    splats: usize,
    covered: u64,
    finished: u64,
    runs: Vec<RunLengths>,
}

/// The engines by name, (a) first; the kernel's designs last.
fn contenders<'a>(
    subject: &'a HardwareScene,
    choice: VectorLevel,
) -> Vec<(&'static str, Contender<'a>)> {
    let mut all = vec![
        ("(a) boxes", Contender::Boxes(BoxExtent::Sigmas)),
        ("(a) tight boxes", Contender::Boxes(BoxExtent::Cutoff)),
        ("textbook", Contender::Textbook),
        ("(b) spans", Contender::Spans),
    ];
    for name in ["lean18", "standard24", "deep32"] {
        let Some(design) = DesignChoice::named(name) else {
            continue;
        };
        let settings = Settings {
            design,
            engine: PaintEngine::Vectors(choice),
            ..Settings::new(subject.rules)
        };
        let renderer = Renderer::new(&subject.scene, &subject.camera, settings);
        all.push((name, Contender::Kernel(Box::new(renderer))));
    }
    all
}

/// Measures every scene that is there, on the kinds of vectors asked for.
pub fn run(data: &Path, asked: &[VectorLevel]) -> Result<String, Failure> {
    let levels: Vec<VectorLevel> = match asked {
        [] => usual_levels(),
        asked => asked.to_vec(),
    };
    let subjects = subjects(data)?;
    let progress = ProgressMeter::new(subjects.len() * levels.len());
    let (mut text, mut tables) = (opening(&levels), String::new());
    for choice in levels {
        let name = lanes::name(choice);
        let mut measured = Vec::new();
        for subject in &subjects {
            progress.doing(format!("{} on {name}", subject.name));
            measured.push(measure(subject, choice)?);
            progress.advance();
        }
        text.push_str(&summary(name, &measured));
        for table in &measured {
            tables.push_str(&details(name, table));
        }
    }
    drop(progress);
    text.push_str(&instructions());
    text.push_str(&tables);
    Ok(text)
}

/// What most people's processors have, and then what this one has beyond it; arrays only where there is nothing else.
fn usual_levels() -> Vec<VectorLevel> {
    let mut levels: Vec<VectorLevel> = VectorLevel::levels()
        .into_iter()
        .map(|level| level.1)
        .collect();
    if levels.len() > 1 {
        levels.pop();
    }
    levels
}

fn opening(levels: &[VectorLevel]) -> String {
    let names: Vec<&str> = levels.iter().map(|choice| lanes::name(*choice)).collect();
    format!(
        "# Speed on the host\n\nPrinted by `{COMMAND} --only host`; do not edit. {SIZE} x {SIZE} pixels, vectors of {}; medians of {ROUNDS} \
         rounds in which all engines draw one after the other, ratios within the round. A frame is everything from a scene that has been loaded and quantised \
         to single-precision pixels in memory; rest is what it has beside setup, sort and raster.\n\n(a) is the best that open CPU rasterizers do: square of three \
         sigmas, 16 x 16 tiles, order by radix sort of integer keys, a row's pixels in vectors with its constant terms computed once, an approximate exponential, \
         tiles left when they have finished; \"tight\" is the same with the box of the cut-off. \"textbook\" goes pixel by pixel with the library's `exp`. \
         (b) has the kernel's spans, tiles, order and vectors, and a polynomial `exp`. docs/speed.md says how the kernel is drawn and which ways lost.\n",
        names.join(" and ")
    )
}

fn subjects(data: &Path) -> Result<Vec<HardwareScene>> {
    let mut subjects = Vec::new();
    subjects.extend(guitar(data)?);
    subjects.extend(lion(data)?);
    let brain = data.join("volumes/brainsmall.nhdr");
    if brain.exists() {
        let scene = scene::load(&brain, &LoadOptions::default())?;
        subjects.push(HardwareScene {
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
    subjects.extend(random.map(|(name, count, multiplier)| HardwareScene {
        name,
        scene: synthetic::random_gaussians(count, 1, multiplier),
        camera: synthetic::camera(SIZE, SIZE),
        rules: Rules::GAUSSIAN_3D,
    }));
    Ok(subjects)
}

/// What a frame took, and its picture if asked for.
struct HostDrawn {
    frame: HostFrame,
    picture: Option<Picture>,
}

/// One frame by one engine.
fn draw(
    contender: &mut Contender,
    floats: &FloatScene,
    choice: VectorLevel,
    pixels: &mut [[f32; 4]],
    keep: bool,
) -> Result<HostDrawn> {
    let started = Instant::now();
    let drawing = match contender {
        Contender::Boxes(extent) => boxes::draw(floats, *extent, choice),
        Contender::Textbook => textbook::draw(floats, BoxExtent::Sigmas),
        Contender::Spans => spans::draw(floats, choice),
        Contender::Kernel(renderer) => {
            let drawn = renderer.draw_floats(pixels, &|_, _| true)?;
            let total = started.elapsed().as_secs_f64();
            let mut picture = keep.then(|| Picture::new(0, 0));
            if let Some(picture) = &mut picture {
                renderer.draw_picture(picture, &|_, _| true)?;
            }
            return Ok(HostDrawn {
                frame: HostFrame {
                    times: drawn.facts.times,
                    total,
                },
                picture,
            });
        }
    };
    let total = started.elapsed().as_secs_f64();
    Ok(HostDrawn {
        frame: HostFrame {
            times: drawing.times,
            total,
        },
        picture: keep.then(|| drawing.picture(floats.viewport)),
    })
}

/// Pixels that the scene covers, and those of them that had finished: what is timed need not count them.
fn count_pixels(
    subject: &HardwareScene,
    choice: VectorLevel,
    pixels: &mut [[f32; 4]],
) -> Result<[u64; 2]> {
    let settings = Settings {
        engine: PaintEngine::Vectors(choice),
        counts: true,
        ..Settings::new(subject.rules)
    };
    let mut renderer = Renderer::new(&subject.scene, &subject.camera, settings);
    let coverage = renderer.draw_floats(pixels, &|_, _| true)?.facts.coverage;
    Ok([coverage.covered, coverage.finished])
}

fn measure(subject: &HardwareScene, choice: VectorLevel) -> Result<PhaseTimes> {
    let HardwareScene {
        name,
        scene,
        camera,
        rules,
    } = subject;
    let floats = FloatScene::new(scene, camera, rules);
    let reference = float::draw(scene, camera, rules, Compositing::FrontToBack).picture;
    let mut contenders = contenders(subject, choice);
    let mut pixels = vec![[0.0; 4]; SIZE * SIZE];
    let mut runs = Vec::new();
    for (name, contender) in &mut contenders {
        let drawn = draw(contender, &floats, choice, &mut pixels, true)?;
        let picture = drawn.picture.context("no picture was kept")?;
        runs.push(RunLengths {
            name,
            one: Vec::new(),
            two: Vec::new(),
            error: metrics::compare(&picture, &reference)?.colour,
        });
    }
    for threads in [1, 2] {
        on_threads(threads, || -> Result<()> {
            for _ in 0..ROUNDS {
                for ((_, contender), runs) in contenders.iter_mut().zip(&mut runs) {
                    let frame = draw(contender, &floats, choice, &mut pixels, false)?.frame;
                    let list = if threads == 1 {
                        &mut runs.one
                    } else {
                        &mut runs.two
                    };
                    list.push(frame);
                }
            }
            Ok(())
        })??;
    }
    let [covered, finished] = count_pixels(subject, choice, &mut pixels)?;
    Ok(PhaseTimes {
        name,
        // A tenth of the splats leaves half of the frame to what does not depend on them.
        bars: if *name == "random 10k" {
            [2.5, 3.0]
        } else {
            [5.0, 6.0]
        },
        splats: scene.splats.len(),
        covered,
        finished,
        runs,
    })
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    metrics::median(&mut values.collect::<Vec<_>>()).unwrap_or(f64::NAN)
}

/// How many times as fast the second is, by rounds.
fn ratio(slow: &[HostFrame], fast: &[HostFrame]) -> f64 {
    let rounds = slow.iter().zip(fast);
    median(rounds.map(|(slow, fast)| slow.total / fast.total))
}

/// The share of frames outside setup, sort and raster.
fn rest(frames: &[HostFrame]) -> f64 {
    let stages = |times: &Times| times.setup + times.sort + times.raster;
    median(
        frames
            .iter()
            .map(|frame| 1.0 - stages(&frame.times) / frame.total),
    )
}

/// Seconds of the raster of one over those of the other, by rounds.
fn raster_ratio(one: &[HostFrame], other: &[HostFrame]) -> f64 {
    let rounds = one.iter().zip(other);
    median(rounds.map(|(one, other)| one.times.raster / other.times.raster))
}

/// Bars against what was measured.
fn summary(vectors: &str, tables: &[PhaseTimes]) -> String {
    let mut text = format!(
        "\n## {vectors}\n\n| scene | standard24 to (a) | bar | lean18 to (a) | bar | standard24 to (b) | rest | bar | standard24, two threads | bar | deep32's raster to standard24's | bar |\n\
         |---|--:|---|--:|---|--:|--:|---|--:|---|--:|---|\n"
    );
    let verdict = |met: bool| if met { "met" } else { "MISSED" };
    for table in tables {
        let [a, _, _, b, lean, standard, deep] = table.runs.as_slice() else {
            continue;
        };
        let [to_a, lean_to_a] = [standard, lean].map(|runs| ratio(&a.one, &runs.one));
        let (rest, threads) = (rest(&standard.one), ratio(&standard.one, &standard.two));
        let deep = raster_ratio(&deep.one, &standard.one);
        let [bar, lean_bar] = table.bars;
        let _ = writeln!(
            text,
            "| {} | {to_a:.2} | {bar}: {} | {lean_to_a:.2} | {lean_bar}: {} | {:.2} | {:.1} % | 5 %: {} | {threads:.2} | 1.8: {} | {deep:.2} | 1.5: {} |",
            table.name,
            verdict(to_a >= bar),
            verdict(lean_to_a >= lean_bar),
            ratio(&b.one, &standard.one),
            100.0 * rest,
            verdict(rest <= REST_BAR),
            verdict(threads >= 1.8),
            verdict(deep <= 1.5),
        );
    }
    text
}

/// Milliseconds and errors of one scene.
fn details(vectors: &str, table: &PhaseTimes) -> String {
    let mut text = format!(
        "\n## {}, {vectors}\n\n{} splats; {:.2} million covered pixels, of them {:.2} million already finished.\n\n\
         | engine | setup ms | sort ms | raster ms | frame ms | ns per covered pixel | to (a) | to (b) | two threads | PSNR dB | largest error | bias |\n\
         |---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n",
        table.name,
        table.splats,
        table.covered as f64 / 1e6,
        table.finished as f64 / 1e6,
    );
    let [a, _, _, b, ..] = table.runs.as_slice() else {
        return text;
    };
    for runs in &table.runs {
        let part = |part: fn(&HostFrame) -> f64| median(runs.one.iter().map(part));
        let frame = part(|frame| frame.total);
        let error = &runs.error;
        let _ = writeln!(
            text,
            "| {} | {:.2} | {:.2} | {:.2} | {:.2} | {:.2} | {:.2} | {:.2} | {:.2} | {:.1} | {:.1e} | {:+.1e} |",
            runs.name,
            1e3 * part(|frame| frame.times.setup),
            1e3 * part(|frame| frame.times.sort),
            1e3 * part(|frame| frame.times.raster),
            1e3 * frame,
            1e9 * frame / table.covered as f64,
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
        "\nInstructions of the raster loop (tiles opened, painted and written out) on one thread by `valgrind --tool=callgrind`, AVX2, where the program has symbols (`--profile profiling` in place of `--release`).\n\n| scene | design | million instructions | per covered pixel |\n|---|---|--:|--:|\n",
    );
    for scene in COUNTED {
        for design in ["lean18", "standard24", "deep32"] {
            let counted = count(scene, design);
            let line = match counted {
                Ok((instructions, covered)) => format!(
                    "| random {scene} | {design} | {:.1} | {:.2} |",
                    instructions as f64 / 2e6,
                    instructions as f64 / covered as f64
                ),
                Err(error) => format!("| random {scene} | {design} | not counted: {error} | |"),
            };
            text.push_str(&line);
            text.push('\n');
        }
    }
    text
}

/// Draws a random scene twice, so that a counter of instructions that looks at the raster loop finds warm memory, and prints the pixels covered by both.
pub fn draw_once(options: &DrawOnceOptions) -> Result<(), Failure> {
    let scene = synthetic::random_gaussians(options.splats, 1, 1.0);
    let settings = Settings {
        design: DesignChoice::load(&options.design)?,
        counts: true,
        ..Settings::new(Rules::GAUSSIAN_3D)
    };
    let camera = synthetic::camera(SIZE, SIZE);
    let mut pixels = vec![[0.0; 4]; SIZE * SIZE];
    let mut renderer = Renderer::new(&scene, &camera, settings)
        .with_threads(1)
        .context("cannot start a thread")?;
    let mut covered = 0;
    for _ in 0..2 {
        let drawn = renderer.draw_floats(&mut pixels, &|_, _| true);
        covered += drawn.map_err(anyhow::Error::from)?.facts.coverage.covered;
    }
    print_result(&format!("{covered}\n"))?;
    Ok(())
}

/// The name of the raster loop, as a profiler knows it.
const RASTER_LOOP: &str = "*FrameMemory*paint*";

/// Instructions within the raster loop, and covered pixels, of pictures drawn by this program under valgrind.
fn count(splats: &str, design: &str) -> Result<(u64, u64)> {
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .arg(format!("--toggle-collect={RASTER_LOOP}"))
        .arg(std::env::current_exe()?)
        .args(["draw-once", splats, design])
        .output()
        .context("valgrind does not start")?;
    let log = String::from_utf8_lossy(&output.stderr);
    let collected = log
        .lines()
        .find_map(|line| line.split_once("Collected : "))
        .context("valgrind counted nothing")?;
    let instructions: u64 = collected.1.trim().parse()?;
    ensure!(
        instructions > 0,
        "valgrind found no raster loop: it needs the symbols of --profile profiling"
    );
    let covered = String::from_utf8_lossy(&output.stdout).trim().parse()?;
    Ok((instructions, covered))
}
