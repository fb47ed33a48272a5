//! How fast the model itself is: comparing, sweeping, simulating. Medians of several runs.
//!
//! Wall-clock seconds say little on a machine with other work; the seconds of processor time, which all threads together
//! took, stand beside them where the system tells them.

use super::layouts::sweep_of;
use super::throughput::workload;
use super::{COMMAND, HardwareScene};
use splatline::format::Traversal;
use splatline_sim::cli::Failure;
use splatline_sim::design::{DesignChoice, traversal_name};
use splatline_sim::explore::space::Space;
use splatline_sim::machine::lanes::{LaneShape, LaneWork};
use splatline_sim::machine::{Config, simulate};
use splatline_sim::metrics::median;
use splatline_sim::picture::{Backdrop, Depth};
use splatline_sim::plan::{Effort, Prepared, all_entries, compare_all};
use splatline_sim::reference::float;
use splatline_sim::rules::Compositing;
use std::fmt::Write;
use std::path::Path;
use std::time::Instant;

/// Runs of everything that takes seconds, and of a simulation.
const RUNS: usize = 3;
const SIMULATIONS: usize = 9;

/// 1,000 machines: 8 lane shapes of 125 machines each.
const SPACE: &str = "\
[machine]
lanes = [1, 2, 4, 8]
layout = [\"run\", \"rows\"]
row_fifo = [4, 8, 16, 32, 64]
blend_latency = [1, 2, 4, 8, 16]
read_bandwidth = [4, 8, 16, 32, 64]
";

/// Seconds of one run, or the medians of several.
#[derive(Clone, Copy)]
struct Seconds {
    wall: f64,
    /// Of all threads together.
    processor: Option<f64>,
}

/// Measures everything on the guitar; nothing is written if its file is missing.
pub fn run(guitar: &dyn Fn() -> anyhow::Result<Option<HardwareScene>>) -> Result<String, Failure> {
    let mut text = format!(
        "# Speed of the model\n\nPrinted by `{COMMAND} --only speed`. Guitar, 512 x 512, {} threads; medians of {RUNS} runs, of \
         {SIMULATIONS} for a simulation. Processor seconds are those of all threads together: on cores that other programs use as well, \
         they are the measure to compare, and divided by the threads the least that an idle machine can take.\n",
        Effort::new(None, 1).threads
    );
    let Some(subject) = guitar()? else {
        text.push_str("\nNot measured, because the data folder has no guitar.\n");
        return Ok(text);
    };
    let space = Space::from_toml("speed", SPACE)?;
    let compare = median_of(RUNS, || compare_guitar(guitar))?;
    let explore = median_of(RUNS, || explore_all(&subject, &space))?;
    text.push_str("\n| what | seconds | processor seconds | bar |\n|---|--:|--:|--:|\n");
    let mut line = |what: &str, seconds: Seconds, bar: &str| {
        let processor = seconds
            .processor
            .map_or("-".to_owned(), |seconds| format!("{seconds:.2}"));
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "| {what} | {:.2} | {processor} | {bar} |",
            seconds.wall
        );
    };
    line(
        "`compare`: load, reference, 8 pictures with errors and cycles, files",
        compare,
        "5 s",
    );
    let points = format!(
        "`explore`: reference, errors and {} machines",
        space.points.len()
    );
    line(&points, explore, "60 s on two cores");
    text.push_str(&simulations(&subject)?);
    Ok(text)
}

/// What the command `compare` does, files included.
fn compare_guitar(
    guitar: &dyn Fn() -> anyhow::Result<Option<HardwareScene>>,
) -> Result<(), Failure> {
    let Some(subject) = guitar()? else {
        return Ok(());
    };
    let design = DesignChoice::all().remove(2);
    let others = all_entries(&design);
    let prepared = Prepared::of_splats(subject.scene, subject.camera, subject.rules, design);
    let comparison = compare_all(&prepared, &Effort::new(None, 1), &others)?;
    let folder = std::env::temp_dir().join(format!("splatline-speed-{}", std::process::id()));
    std::fs::create_dir_all(&folder)
        .map_err(|error| anyhow::anyhow!("cannot create '{}': {error}", folder.display()))?;
    let written = comparison.write(&folder, Depth::Eight, Backdrop::default());
    std::fs::remove_dir_all(&folder)
        .map_err(|error| anyhow::anyhow!("cannot remove '{}': {error}", folder.display()))?;
    Ok(written?)
}

fn explore_all(subject: &HardwareScene, space: &Space) -> Result<(), Failure> {
    let HardwareScene {
        scene,
        camera,
        rules,
        ..
    } = subject;
    let float = float::draw(scene, camera, rules, Compositing::FrontToBack).picture;
    sweep_of(subject, space, Some(&float)).map(|_| ())
}

/// Simulated cycles per second of one core, lane work already made.
fn simulations(subject: &HardwareScene) -> Result<String, Failure> {
    let mut text = String::from(
        "\n| `model`, footprints already made | traversal | Mcycles | milliseconds | Mcycles per second and core | bar |\n|---|---|--:|--:|--:|--:|\n",
    );
    let machines: [(&str, &[&str]); 5] = [
        ("1 lane", &[]),
        ("4 lanes, run", &["lanes=4"]),
        ("4 lanes, rows", &["lanes=4", "layout=rows"]),
        (
            "4 lanes, rows, 4 rows at once",
            &["lanes=4", "layout=rows", "rows_at_once=4"],
        ),
        (
            "8 lanes, rows, 8 rows at once",
            &["lanes=8", "layout=rows", "rows_at_once=8"],
        ),
    ];
    for traversal in [Traversal::Box, Traversal::Spans] {
        let workload = workload(subject, traversal);
        for (name, words) in machines {
            let words: Vec<String> = words.iter().map(|word| (*word).to_owned()).collect();
            let mut config = Config::default();
            config.set_words(&words).map_err(anyhow::Error::from)?;
            let work = LaneWork::new(&workload, LaneShape::from(&config));
            let mut cycles = 0;
            let seconds = median_of(SIMULATIONS, || {
                cycles = simulate(&workload, &work, &config).total;
                Ok(())
            })?;
            let millions = cycles as f64 / 1e6;
            let _ = writeln!(
                text,
                "| {name} | {} | {millions:.3} | {:.1} | {:.0} | 50 |",
                traversal_name(traversal),
                1e3 * seconds.wall,
                millions / seconds.wall
            );
        }
    }
    Ok(text)
}

fn median_of(
    runs: usize,
    mut work: impl FnMut() -> Result<(), Failure>,
) -> Result<Seconds, Failure> {
    let (mut wall, mut processor) = (Vec::new(), Vec::new());
    for _ in 0..runs {
        let (started, before) = (Instant::now(), processor_seconds());
        work()?;
        wall.push(started.elapsed().as_secs_f64());
        let after = processor_seconds();
        processor.extend(before.zip(after).map(|(before, after)| after - before));
    }
    Ok(Seconds {
        wall: median(&mut wall).unwrap_or(0.0),
        processor: median(&mut processor),
    })
}

/// Seconds that this process has spent in user code and in the system; nothing where there is no /proc.
fn processor_seconds() -> Option<f64> {
    /// Linux counts in hundredths of a second for programs, whatever its own clock.
    const TICKS: f64 = 100.0;
    let text = std::fs::read_to_string(Path::new("/proc/self/stat")).ok()?;
    // The name may hold spaces and ends at the last parenthesis; user and system time are fields 14 and 15 of the line.
    let mut fields = text.rsplit_once(')')?.1.split_ascii_whitespace().skip(11);
    let mut ticks = || fields.next()?.parse::<f64>().ok();
    Some((ticks()? + ticks()?) / TICKS)
}
