//! How many times as fast as the verilated circuit the model is: the same picture, one thread each, one after the other in one run, by processor time.
//!
//! The circuits are what Verilator makes with `-O3`, compiled with `-O2`. Against them stand the kernel's painter, which does all of the
//! circuit's work pixel by pixel; the host's own drawing, which gives the same words but may leave out what cannot change them; each together
//! with the cycles of every tile; and the cycles alone.

use crate::bench::{Bench, Pauses};
use crate::golden::Golden;
use crate::picture;
use crate::suite::{DESIGNS, LANES};
use crate::workload::{GuitarView, Workload, from_scene, guitar_scene};
use anyhow::{Context, Result, anyhow, ensure};
use splatline::format::{Design, Traversal};
use splatline::rules::Rules as KernelRules;
use splatline_sim::camera::Camera;
use splatline_sim::design::{DesignChoice, DesignJob};
use splatline_sim::fixed::{self, kernel_rules};
use splatline_sim::machine::Config;
use splatline_sim::machine::lanes::{LaneShape, LaneWork};
use splatline_sim::machine::primitive::{PrimitiveClock, QUEUE, for_each_slot};
use splatline_sim::machine::workload::extract;
use splatline_sim::rules::{Compositing, Rules};
use splatline_sim::scene::Scene;
use std::fs;
use std::time::Instant;

/// Columns and rows of the picture.
const SIZE: usize = 512;

/// Seconds of each.
#[derive(Clone, Copy, Debug, Default)]
struct Seconds {
    circuit: f64,
    /// The kernel's painter.
    painter: f64,
    /// The host's drawing, without setup and sorting.
    drawing: f64,
    /// Rows of all pairs by the kernel, and their cycles.
    cycles: f64,
    /// Cycles of rows that are known already, as a sweep over machines takes them.
    machine: f64,
}

/// Prints the table, line by line as it comes.
pub fn report(print: &mut dyn FnMut(&str)) -> Result<()> {
    let (scene, camera) =
        guitar_scene(GuitarView::Close, SIZE)?.context("guitar.ply is not at hand")?;
    print(
        "| design | lanes | verilated circuit, s | cycles/s | painter and cycles, s | ratio | fast drawing and cycles, s | ratio | cycles alone, s | ratio | of known rows, s | ratio |",
    );
    print("|---|---|---|---|---|---|---|---|---|---|---|---|");
    for design in DESIGNS {
        for lanes in LANES {
            let (seconds, cycles) = one_thread(|| measure(design, lanes, &scene, &camera))?;
            print(&line(design, lanes, &seconds, cycles));
        }
    }
    Ok(())
}

fn line(design: &str, lanes: usize, seconds: &Seconds, cycles: u64) -> String {
    let column = |time: f64| format!("{time:.3} | {:.0}", seconds.circuit / time);
    format!(
        "| {design} | {lanes} | {:.1} | {:.0} | {} | {} | {} | {} |",
        seconds.circuit,
        cycles as f64 / seconds.circuit,
        column(seconds.painter + seconds.cycles),
        column(seconds.drawing + seconds.cycles),
        column(seconds.cycles),
        column(seconds.machine),
    )
}

/// Processor time of this thread, so that other processes do not count; wall-clock time where the system does not tell.
struct Stopwatch {
    wall: Instant,
    processor: Option<f64>,
}

impl Stopwatch {
    fn start() -> Self {
        Stopwatch {
            wall: Instant::now(),
            processor: processor_seconds(),
        }
    }

    fn seconds(&self) -> f64 {
        match (self.processor, processor_seconds()) {
            (Some(start), Some(end)) => end - start,
            _ => self.wall.elapsed().as_secs_f64(),
        }
    }
}

/// What Linux has counted for this thread: its first number, in nanoseconds.
fn processor_seconds() -> Option<f64> {
    let text = fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    let nanoseconds: u64 = text.split_whitespace().next()?.parse().ok()?;
    Some(nanoseconds as f64 * 1e-9)
}

/// Runs on a pool of one thread, so that what uses all cores elsewhere uses one.
fn one_thread<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    match rayon::ThreadPoolBuilder::new().num_threads(1).build() {
        Ok(pool) => pool.install(work),
        Err(_) => work(),
    }
}

/// Seconds, and cycles of the circuit.
fn measure(
    design: &'static str,
    lanes: usize,
    scene: &Scene,
    camera: &Camera,
) -> Result<(Seconds, u64)> {
    let choice = DesignChoice::named(design).context("a named design")?;
    let rules = Rules::GAUSSIAN_3D;
    let workload = from_scene("guitar", scene, camera, &choice, &rules);
    let kernel = kernel_rules(&rules);
    let mut bench = Bench::new(design, &choice.widths, lanes, &kernel, 1)?;
    let mut seconds = Seconds::default();

    let started = Stopwatch::start();
    let mut circuit_cycles = 0;
    for tile in &workload.tiles {
        let drawn = bench.draw(tile, &workload.footprints, Pauses::default());
        circuit_cycles += drawn
            .map_err(|message| anyhow!(message))?
            .stamps
            .raster_cycles();
    }
    seconds.circuit = started.seconds();

    let model = Model {
        rules: &kernel,
        workload: &workload,
        lanes,
    };
    let (painter, cycles, model_cycles) = choice.dispatch(model);
    ensure!(
        model_cycles == circuit_cycles,
        "the model says {model_cycles} cycles, the circuit took {circuit_cycles}"
    );
    (seconds.painter, seconds.cycles) = (painter, cycles);
    let options = fixed::Options {
        rules: &rules,
        compositing: Compositing::FrontToBack,
        design: &choice,
        traversal: Traversal::Spans,
    };
    seconds.drawing = host_drawing(scene, camera, &options);
    seconds.machine = known_rows(scene, camera, &options, lanes);
    Ok((seconds, bench.cycles()))
}

/// The host's drawing of the whole picture by its own choice of engine: seconds from footprints to pixels.
fn host_drawing(scene: &Scene, camera: &Camera, options: &fixed::Options) -> f64 {
    let started = Stopwatch::start();
    let times = fixed::draw(scene, camera, options).times;
    started.seconds() * times.raster / (times.setup + times.sort + times.raster)
}

fn known_rows(scene: &Scene, camera: &Camera, options: &fixed::Options, lanes: usize) -> f64 {
    let config: Config = picture::machine(lanes, &picture::LIMITS[0]);
    let work = extract(
        scene,
        camera,
        options,
        [config.tile_width, config.tile_height],
    );
    let lane_work = LaneWork::new(&work, LaneShape::from(&config));
    let started = Stopwatch::start();
    let timing = splatline_sim::machine::simulate(&work, &lane_work, &config);
    // The result must be used, or there would be nothing to measure.
    std::hint::black_box(timing);
    started.seconds()
}

/// The kernel's painter on all tiles, and the cycles of all tiles.
struct Model<'a> {
    rules: &'a KernelRules,
    workload: &'a Workload,
    lanes: usize,
}

impl DesignJob for Model<'_> {
    /// Seconds of the painter and of the cycles, and the cycles.
    type Output = (f64, f64, u64);

    fn run<D: Design + Send + Sync>(self, design: D) -> Self::Output {
        let Workload {
            footprints, tiles, ..
        } = self.workload;
        let started = Stopwatch::start();
        let golden = Golden::new(design, self.rules);
        for tile in tiles {
            std::hint::black_box(golden.draw(tile, footprints));
        }
        let painter = started.seconds();
        let started = Stopwatch::start();
        let mut cycles = 0;
        for tile in tiles.iter().filter(|tile| !tile.list.is_empty()) {
            let mut clock = PrimitiveClock::new(self.lanes, QUEUE);
            for index in &tile.list {
                clock.packet(0);
                let footprint = &footprints[*index as usize];
                for_each_slot(design, footprint, &tile.window, self.lanes, |run| {
                    clock.slot(run);
                });
            }
            cycles += clock.idle_at();
        }
        (painter, started.seconds(), cycles)
    }
}
