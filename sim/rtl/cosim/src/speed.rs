//! How many times as fast as the verilated circuit the model is: the same tiles of the same picture, one after the other in one run.
//!
//! Both sides begin with packets (footprints) in the order of every tile's list and end with the words of every tile's pixels and the cycles
//! that every tile takes; these must be the same, or there is no figure. The circuit is driven without a call for every cycle and without
//! looking into it. The model is the host's drawing, in tiles of its own size, whose tables and constants of footprints count, and the clock of
//! whole pictures. Lists of tiles are made beforehand for both. One thread is measured by its processor time, all cores by the clock on the
//! wall: for the circuit that is one simulation for each core.

use crate::bench::Bench;
use crate::model::{Packet, ReadOut};
use crate::suite::{DESIGNS, LANES};
use crate::workload::{BenchTile, BenchWorkload, GuitarView, from_scene, guitar_scene, tiles};
use anyhow::{Context, Result, anyhow, ensure};
use rayon::prelude::*;
use rustix::time::{ClockId, clock_gettime};
use splatline::blend::{FINISHED, Pixel};
use splatline::footprint::Footprint;
use splatline::format::{Design, Traversal};
use splatline::rules::{Compositing, Rules as KernelRules};
use splatline::setup::Cull;
use splatline_sim::design::{DesignChoice, DesignJob};
use splatline_sim::fast::lanes::VectorLevel;
use splatline_sim::fast::{PaintScratch, TILE, tile_painter};
use splatline_sim::fixed::kernel_rules;
use splatline_sim::machine::primitive::picture_cycles;
use splatline_sim::rules::Rules;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

/// Columns and rows of the picture.
const SIZE: usize = 512;

/// Rounds; medians are taken over them, of ratios too.
const ROUNDS: usize = 5;

/// The model draws the picture so many times in a round; its seconds are the mean.
const REPEATS: u32 = 8;

/// Seconds of the circuits.
#[derive(Clone, Copy, Debug)]
struct CircuitSeconds {
    /// One simulation, processor time.
    one: f64,
    /// A simulation for each core, by the clock on the wall.
    all: f64,
}

/// Processor seconds of the model's parts on one thread.
#[derive(Clone, Copy, Debug)]
struct ModelSeconds {
    drawing: f64,
    cycles: f64,
}

impl ModelSeconds {
    fn sum(&self) -> f64 {
        self.drawing + self.cycles
    }
}

/// What both sides must agree on: pixels and cycles of every tile.
#[derive(Clone, Debug, PartialEq)]
struct TimedDrawing {
    pixels: Vec<Vec<Pixel>>,
    cycles: Vec<u64>,
}

/// Prints the table, line by line as it comes.
pub fn report(print: &mut dyn FnMut(&str)) -> Result<()> {
    let (scene, camera) =
        guitar_scene(GuitarView::Close, SIZE)?.context("guitar.ply is not at hand")?;
    print(
        "| design | lanes | circuit, one thread, s | circuits, one per core, s | drawing, s | cycles, s | model, one thread, s | ratio, one thread each | model, all cores, s | ratio, all cores each | ratio, all cores to one circuit |",
    );
    print("|---|---|---|---|---|---|---|---|---|---|---|");
    for design in DESIGNS {
        let choice = DesignChoice::named(design).context("a named design")?;
        let workload = from_scene("guitar", &scene, &camera, &choice, &Rules::GAUSSIAN_3D);
        for lanes in LANES {
            print(&measure(design, &choice, lanes, &workload)?);
        }
    }
    Ok(())
}

/// One line of the table.
fn measure(
    design: &'static str,
    choice: &DesignChoice,
    lanes: usize,
    workload: &BenchWorkload,
) -> Result<String> {
    let rules = kernel_rules(&Rules::GAUSSIAN_3D);
    let circuit = TimedCircuit {
        design,
        choice,
        lanes,
        rules: &rules,
        workload,
    };
    let results: Vec<_> = workload.footprints.iter().copied().map(Ok).collect();
    let viewport = workload.viewport.context("the tiles make a picture")?;
    let model = TimedModel {
        rules: &rules,
        workload,
        viewport,
        tiles: &tiles(&workload.footprints, viewport, TILE),
        results: &results,
        lanes,
    };
    let rounds: Vec<Round> = (0..ROUNDS)
        .map(|_| round(&circuit, choice, model))
        .collect::<Result<_>>()?;
    let median = |of: fn(&Round) -> f64| {
        let mut values: Vec<f64> = rounds.iter().map(of).collect();
        splatline_sim::metrics::median(&mut values).unwrap_or(0.0)
    };
    Ok(format!(
        "| {design} | {lanes} | {:.2} | {:.2} | {:.4} | {:.4} | {:.4} | {:.0} | {:.4} | {:.0} | {:.0} |",
        median(|round| round.circuit.one),
        median(|round| round.circuit.all),
        median(|round| round.one.drawing),
        median(|round| round.one.cycles),
        median(|round| round.one.sum()),
        median(|round| round.circuit.one / round.one.sum()),
        median(|round| round.all),
        median(|round| round.circuit.all / round.all),
        median(|round| round.circuit.one / round.all),
    ))
}

/// Seconds of one round, in which everything is done once.
struct Round {
    circuit: CircuitSeconds,
    one: ModelSeconds,
    all: f64,
}

fn round(circuit: &TimedCircuit, choice: &DesignChoice, model: TimedModel) -> Result<Round> {
    let (circuit, expected) = circuit.seconds()?;
    let (one, drawn) = one_thread(|| choice.dispatch(OneThread(model)));
    ensure!(drawn == expected, "model and circuit differ on one thread");
    let (all, drawn) = choice.dispatch(AllCores(model));
    ensure!(drawn == expected, "model and circuit differ on all cores");
    Ok(Round { circuit, one, all })
}

/// Processor time of this thread, so that other processes do not count.
fn processor_seconds() -> f64 {
    let time = clock_gettime(ClockId::ThreadCPUTime);
    time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
}

/// Runs on a pool of one thread, so that what uses all cores elsewhere uses one.
fn one_thread<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    match rayon::ThreadPoolBuilder::new().num_threads(1).build() {
        Ok(pool) => pool.install(work),
        Err(_) => work(),
    }
}

/// The circuit and all that it draws.
struct TimedCircuit<'a> {
    design: &'static str,
    choice: &'a DesignChoice,
    lanes: usize,
    rules: &'a KernelRules,
    workload: &'a BenchWorkload,
}

/// A tile's packets, and where its pixels are read out to.
type Job<'a> = (&'a BenchTile, Vec<Packet>, Vec<ReadOut>);

impl TimedCircuit<'_> {
    fn bench(&self) -> Result<Bench> {
        let widths = &self.choice.widths;
        Ok(Bench::new(self.design, widths, self.lanes, self.rules, 1)?)
    }

    /// Seconds, and what one simulation drew.
    fn seconds(&self) -> Result<(CircuitSeconds, TimedDrawing)> {
        let mut bench = self.bench()?;
        let mut jobs: Vec<Job> = self
            .workload
            .tiles
            .iter()
            .map(|tile| job(&bench, tile, self.workload))
            .collect();
        let mut cycles = Vec::with_capacity(jobs.len());
        let started = processor_seconds();
        for (tile, packets, pixels) in &mut jobs {
            let drawn = bench.draw_at_once(tile, packets, pixels);
            cycles.push(drawn.map_err(|message| anyhow!(message))?);
        }
        let one = processor_seconds() - started;
        let pixels = jobs
            .iter()
            .map(|(_, _, pixels)| pixels.iter().map(pixel).collect())
            .collect();
        let all = self.on_all_cores(jobs)?;
        Ok((CircuitSeconds { one, all }, TimedDrawing { pixels, cycles }))
    }

    /// Seconds on the wall with a simulation for each core, which take the tiles as they come.
    fn on_all_cores(&self, jobs: Vec<Job>) -> Result<f64> {
        let next = AtomicUsize::new(0);
        let jobs: Vec<Mutex<Job>> = jobs.into_iter().map(Mutex::new).collect();
        let work = || -> Result<()> {
            let mut bench = self.bench()?;
            while let Some(job) = jobs.get(next.fetch_add(1, Ordering::Relaxed)) {
                let mut job = job.lock().map_err(|_| anyhow!("a simulation failed"))?;
                let (tile, packets, pixels) = &mut *job;
                let drawn = bench.draw_at_once(tile, packets, pixels);
                drawn.map_err(|message| anyhow!(message))?;
            }
            Ok(())
        };
        let started = Instant::now();
        std::thread::scope(|scope| {
            let threads: Vec<_> = (0..rayon::current_num_threads())
                .map(|_| scope.spawn(work))
                .collect();
            for thread in threads {
                thread
                    .join()
                    .map_err(|_| anyhow!("a simulation failed"))??;
            }
            Ok::<_, anyhow::Error>(())
        })?;
        Ok(started.elapsed().as_secs_f64())
    }
}

fn job<'a>(bench: &Bench, tile: &'a BenchTile, workload: &BenchWorkload) -> Job<'a> {
    let packets = bench.encoded(tile, &workload.footprints);
    let pixels = tile.size().iter().product();
    (tile, packets, vec![ReadOut::default(); pixels])
}

/// A pixel of the read-out in the kernel's words.
fn pixel(out: &ReadOut) -> Pixel {
    let flag = if out.finished == 1 { FINISHED } else { 0 };
    Pixel {
        colour: [out.red, out.green, out.blue],
        transmittance: out.transmittance | flag,
    }
}

/// The host's drawing of all tiles, and the cycles of the circuit's.
#[derive(Clone, Copy)]
struct TimedModel<'a> {
    rules: &'a KernelRules,
    workload: &'a BenchWorkload,
    viewport: [u16; 2],
    /// The host's tiles.
    tiles: &'a [BenchTile],
    results: &'a [Result<Footprint, Cull>],
    lanes: usize,
}

/// Seconds of both parts, one after the other.
struct OneThread<'a>(TimedModel<'a>);

impl DesignJob for OneThread<'_> {
    type Output = (ModelSeconds, TimedDrawing);

    fn run<D: Design + Send + Sync + 'static>(self, design: D) -> Self::Output {
        let OneThread(model) = self;
        let mut seconds = ModelSeconds {
            drawing: 0.0,
            cycles: 0.0,
        };
        let mut drawn = None;
        for _ in 0..REPEATS {
            let started = processor_seconds();
            let pixels = model.draw(design);
            let drawn_at = processor_seconds();
            let cycles = model.cycles(design);
            seconds.drawing += (drawn_at - started) / f64::from(REPEATS);
            seconds.cycles += (processor_seconds() - drawn_at) / f64::from(REPEATS);
            drawn = Some((pixels, cycles));
        }
        (seconds, model.drawn(drawn))
    }
}

/// Seconds on the wall of both parts at the same time, so that no core waits for the other's last tile.
struct AllCores<'a>(TimedModel<'a>);

impl DesignJob for AllCores<'_> {
    type Output = (f64, TimedDrawing);

    fn run<D: Design + Send + Sync + 'static>(self, design: D) -> Self::Output {
        let AllCores(model) = self;
        let started = Instant::now();
        let mut drawn = None;
        for _ in 0..REPEATS {
            drawn = Some(rayon::join(|| model.draw(design), || model.cycles(design)));
        }
        let seconds = started.elapsed().as_secs_f64() / f64::from(REPEATS);
        (seconds, model.drawn(drawn))
    }
}

impl TimedModel<'_> {
    /// The pixels of every one of the host's tiles, row by row.
    fn draw<D: Design + Send + Sync + 'static>(&self, design: D) -> Vec<Vec<Pixel>> {
        let (order, traversal) = (Compositing::FrontToBack, Traversal::Spans);
        let painter = tile_painter(
            design,
            self.rules,
            order,
            traversal,
            Some(VectorLevel::Best),
            false,
        );
        let tiles = self.tiles.par_iter();
        let paint = |scratch: &mut PaintScratch, tile: &BenchTile| {
            let [columns, rows] = tile.size();
            let mut pixels = vec![Pixel::default(); columns * rows];
            painter.paint(scratch, tile.window, self.results, &tile.list, &mut pixels);
            pixels
        };
        tiles.map_init(PaintScratch::default, paint).collect()
    }

    /// What the last turn drew and counted.
    fn drawn(&self, last: Option<(Vec<Vec<Pixel>>, Vec<u64>)>) -> TimedDrawing {
        let (pixels, cycles) = last.expect("there is at least one turn");
        let pixels = self.in_tiles_of_the_circuit(&pixels);
        TimedDrawing { pixels, cycles }
    }

    /// The same pixels as the circuit's tiles have them.
    fn in_tiles_of_the_circuit(&self, pixels: &[Vec<Pixel>]) -> Vec<Vec<Pixel>> {
        let columns = usize::from(self.viewport[0]);
        let mut frame = vec![Pixel::default(); columns * usize::from(self.viewport[1])];
        let row = |tile: &BenchTile, y: usize| {
            let [x, top] = tile.window.first.map(usize::from);
            let first = (top + y) * columns + x;
            first..first + tile.size()[0]
        };
        for (tile, pixels) in self.tiles.iter().zip(pixels) {
            for (y, pixels) in pixels.chunks_exact(tile.size()[0]).enumerate() {
                frame[row(tile, y)].copy_from_slice(pixels);
            }
        }
        let cut = |tile: &BenchTile| {
            let rows = (0..tile.size()[1]).flat_map(|y| frame[row(tile, y)].iter().copied());
            rows.collect()
        };
        self.workload.tiles.iter().map(cut).collect()
    }

    /// The cycles of every one of the circuit's tiles.
    fn cycles<D: Design + Sync>(&self, design: D) -> Vec<u64> {
        let TimedModel {
            workload,
            viewport,
            lanes,
            ..
        } = *self;
        picture_cycles(
            design,
            &workload.footprints,
            viewport,
            lanes,
            VectorLevel::Best,
        )
        .expect("the clock has as many lanes as the circuit")
    }
}
