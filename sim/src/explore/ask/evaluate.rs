//! What a point of the space reaches: its design's error, its machine's pace, and the area of both.
//!
//! Nothing is estimated on the way: every picture is drawn at its full size, every machine runs on the rows of its own design. Work that points
//! share is kept: a design's errors, its rows for a tile size, their grouping for a shape of lanes.

use super::limits::{Limit, Quantity};
use crate::design::DesignChoice;
use crate::explore::fit::Fitness;
use crate::explore::space::{Space, SpacePart};
use crate::explore::sweep::changed;
use crate::fixed::{self, Options, QuantisedScene, best_engine};
use crate::machine::area::{Area, Calibration, estimate};
use crate::machine::clock::{Clock, Throughput};
use crate::machine::config::Config;
use crate::machine::energy::{self, EnergyTable};
use crate::machine::lanes::{LaneShape, LaneWork};
use crate::machine::summary::Spread;
use crate::machine::workload::{Workload, extract_if_room};
use crate::machine::{Timing, simulate};
use crate::picture::Picture;
use crate::plan::Splats;
use anyhow::Result;
use rayon::prelude::*;
use serde::Serialize;
use splatline::format::Traversal;
use std::collections::HashMap;
use std::sync::Arc;

/// What is asked.
pub struct Question<'a> {
    /// The frames, all of which the answer holds for.
    pub frames: Vec<Splats<'a>>,
    /// Their pictures in double precision.
    pub references: Vec<Picture>,
    /// The design that the search starts from.
    pub design: DesignChoice,
    /// The traversal, unless the space or the design says otherwise.
    pub traversal: Option<Traversal>,
    /// The machine that the search starts from.
    pub machine: Config,
    /// Prices of area.
    pub calibration: Calibration,
    /// The limits.
    pub limits: Vec<Limit>,
    /// Energies of actions.
    pub energy: EnergyTable,
}

/// A design by one traversal on a machine.
#[derive(Clone, Debug)]
pub struct Choice {
    /// The design.
    pub design: DesignChoice,
    /// Its traversal.
    pub traversal: Traversal,
    /// The machine.
    pub machine: Config,
}

/// What a choice reaches.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Reached {
    /// Errors over all frames.
    pub error: Option<Fitness>,
    /// The pace of the slowest frame.
    pub pace: Throughput,
    /// Milliseconds over the frames.
    pub ms_per_frame: Spread,
    /// Cycles of the slowest frame by phase: geometry, sort, raster.
    pub phases: [u64; 3],
    /// Area.
    pub area: Area,
    /// Millijoules of the most expensive frame.
    pub millijoules: f64,
}

impl Reached {
    /// The value of a quantity; nothing if it was not measured.
    pub fn value(&self, quantity: Quantity) -> Option<f64> {
        let all = self.area.raster + self.area.around;
        Some(match quantity {
            Quantity::FramesPerSecond => self.pace.frames_per_s,
            Quantity::Luts => all.luts as f64,
            Quantity::FlipFlops => all.flip_flops as f64,
            Quantity::Dsps => all.dsps as f64,
            Quantity::MemoryKbit => all.memory_kbit as f64,
            Quantity::BytesPerSecond => self.pace.channel_bytes_per_s,
            Quantity::PsnrDb => self.error?.psnr_db(),
            Quantity::LargestError => self.error?.max_abs,
            Quantity::MillijoulesPerFrame => self.millijoules,
        })
    }

    /// By how much a limit is missed.
    pub fn excess(&self, limit: &Limit) -> f64 {
        limit.excess(self.value(limit.quantity).unwrap_or(f64::NAN))
    }

    /// One number for what it costs: all resources, in look-up tables.
    pub fn cost(&self) -> f64 {
        self.area.weight
    }
}

/// Rows of all frames for a design and a tile.
type WorkKey = (String, [u16; 2]);

/// Rows and groups of all frames, shared by the machines that run on them.
type FrameWork = (Arc<Vec<Workload>>, Arc<Vec<LaneWork>>);

/// Groupings kept at most: each is as large as a picture's rows.
const MOST_GROUPINGS: usize = 48;

/// Workloads kept at most.
const MOST_WORKLOADS: usize = 16;

/// Evaluates points and remembers them.
pub struct Evaluator<'a> {
    pub question: &'a Question<'a>,
    pub space: &'a Space,
    scenes: Vec<QuantisedScene>,
    errors: HashMap<String, Fitness>,
    /// Every design that was drawn, with its errors.
    pub drawn: Vec<(Choice, Fitness)>,
    workloads: HashMap<WorkKey, Arc<Vec<Workload>>>,
    groupings: HashMap<(WorkKey, LaneShape), Arc<Vec<LaneWork>>>,
    /// What has been evaluated; nothing for what makes no machine.
    pub known: HashMap<Vec<usize>, Option<Reached>>,
    progress: &'a (dyn Fn(&str) + Sync),
}

impl<'a> Evaluator<'a> {
    /// Nothing evaluated yet; `progress` is told what is being done.
    pub fn new(
        question: &'a Question<'a>,
        space: &'a Space,
        progress: &'a (dyn Fn(&str) + Sync),
    ) -> Evaluator<'a> {
        let quantise = |frame: &Splats| QuantisedScene::new(frame.scene, frame.camera, frame.rules);
        let scenes = if question.references.is_empty() {
            Vec::new()
        } else {
            question.frames.iter().map(quantise).collect()
        };
        Evaluator {
            question,
            space,
            scenes,
            errors: HashMap::new(),
            drawn: Vec::new(),
            workloads: HashMap::new(),
            groupings: HashMap::new(),
            known: HashMap::new(),
            progress,
        }
    }

    /// The design and the machine of a point.
    pub fn choice(&self, point: &[usize]) -> Result<Choice> {
        let question = self.question;
        let settings = self.space.settings(point, |part| part == SpacePart::Design);
        let design = changed(&question.design, &settings)?;
        let swept = settings.iter().any(|(key, _)| *key == "traversal");
        let traversal = if swept {
            design.traversal
        } else {
            question.traversal.unwrap_or(design.traversal)
        };
        let mut machine = question.machine;
        for (key, value) in self.space.settings(point, |part| part != SpacePart::Design) {
            machine.set("space", key, value)?;
        }
        Ok(Choice {
            design,
            traversal,
            machine,
        })
    }

    /// Designs drawn.
    pub fn designs(&self) -> usize {
        self.errors.len()
    }

    /// The errors of a design over all frames; nothing without references.
    pub fn error(&mut self, choice: &Choice) -> Result<Option<Fitness>> {
        if self.scenes.is_empty() {
            return Ok(None);
        }
        let key = design_key(choice);
        if let Some(known) = self.errors.get(&key) {
            return Ok(Some(*known));
        }
        let mut all = Vec::with_capacity(self.scenes.len());
        let frames = self.question.frames.iter().zip(&self.scenes);
        for ((frame, scene), reference) in frames.zip(&self.question.references) {
            let options = options(frame, choice);
            let (drawing, _) = fixed::draw_quantised(scene, frame.camera, &options, best_engine());
            all.push(Fitness::of(&drawing.picture, reference)?);
        }
        let error = Fitness::over(&all);
        self.errors.insert(key, error);
        self.drawn.push((choice.clone(), error));
        (self.progress)("drawing by other widths");
        Ok(Some(error))
    }

    /// By how much the limits on errors are missed, in sum.
    pub fn error_excess(&mut self, point: &[usize]) -> Result<f64> {
        let choice = self.choice(point)?;
        let error = self.error(&choice)?;
        let limits = self.question.limits.iter();
        let errors = limits.filter(|limit| limit.quantity.is_error());
        Ok(errors.map(|limit| error_excess(limit, error)).sum())
    }

    /// The least cost of a design that was drawn, on this machine, if one of the limits on errors did not hold: such designs are drawn and not simulated.
    pub fn cost_without_error(&self, machine: &Config, but: usize) -> Option<f64> {
        let question = self.question;
        let holds = |error: Fitness| {
            let others = question.limits.iter().enumerate();
            let mut errors = others.filter(|(place, l)| *place != but && l.quantity.is_error());
            errors.all(|(_, limit)| error_excess(limit, Some(error)) <= 0.0)
        };
        let costs = self.drawn.iter().filter(|(_, error)| holds(*error));
        costs
            .map(|(choice, _)| {
                let widths = &choice.design.widths;
                let prices = &question.calibration;
                estimate(widths, choice.traversal, machine, prices).weight
            })
            .min_by(f64::total_cmp)
    }

    /// What a point could reach at best: its area and its channels, with no error and no cycle. It scores no worse than the point does.
    pub fn at_best(&self, choice: &Choice) -> Reached {
        let Choice {
            design,
            traversal,
            machine,
        } = choice;
        let clock = Clock::of(machine, &design.widths, self.question.calibration.family);
        let nothing = Timing::default();
        let prices = &self.question.calibration;
        Reached {
            error: Some(Fitness::default()),
            pace: Throughput::new(&nothing, machine, clock),
            ms_per_frame: Spread::default(),
            phases: [0; 3],
            area: estimate(&design.widths, *traversal, machine, prices),
            millijoules: 0.0,
        }
    }

    /// Evaluates points, side by side where they share rows.
    pub fn evaluate(&mut self, points: &[Vec<usize>]) -> Result<()> {
        let mut open: Vec<(Vec<usize>, Choice)> = Vec::new();
        for point in points {
            let listed = open.iter().any(|(other, _)| other == point);
            if self.known.contains_key(point) || listed {
                continue;
            }
            let choice = self.choice(point)?;
            match choice.machine.check_together() {
                Ok(()) => open.push((point.clone(), choice)),
                Err(_) => {
                    self.known.insert(point.clone(), None);
                }
            }
        }
        // By rows and shape, so that what is thrown out is not needed again at once.
        open.sort_by_cached_key(|(_, choice)| format!("{:?}", work_key(choice)));
        for batch in open.chunks(MOST_GROUPINGS / 2) {
            self.evaluate_batch(batch)?;
        }
        Ok(())
    }

    fn evaluate_batch(&mut self, batch: &[(Vec<usize>, Choice)]) -> Result<()> {
        if self.groupings.len() + batch.len() > MOST_GROUPINGS {
            self.groupings.clear();
        }
        let mut jobs = Vec::with_capacity(batch.len());
        for (point, choice) in batch {
            let error = self.error(choice)?;
            let (workloads, work) = self.work(choice)?;
            jobs.push((point, choice, error, workloads, work));
        }
        (self.progress)("simulating machines");
        let question = self.question;
        let done: Vec<(Vec<usize>, Reached)> = jobs
            .par_iter()
            .map(|(point, choice, error, workloads, work)| {
                let reached = reached(question, choice, *error, workloads, work);
                ((*point).clone(), reached)
            })
            .collect();
        let some = done.into_iter().map(|(point, one)| (point, Some(one)));
        self.known.extend(some);
        Ok(())
    }

    /// Rows and groups of all frames.
    fn work(&mut self, choice: &Choice) -> Result<FrameWork> {
        let key = work_key(choice);
        let shape = LaneShape::from(&choice.machine);
        let workloads = match self.workloads.get(&key) {
            Some(known) => Arc::clone(known),
            None => {
                (self.progress)("walking the rows of every tile");
                let mut all = Vec::with_capacity(self.question.frames.len());
                for frame in &self.question.frames {
                    let options = options(frame, choice);
                    all.push(extract_if_room(frame.scene, frame.camera, &options, key.1)?);
                }
                if self.workloads.len() >= MOST_WORKLOADS {
                    self.workloads.clear();
                }
                let all = Arc::new(all);
                self.workloads.insert(key.clone(), Arc::clone(&all));
                all
            }
        };
        let group = || workloads.iter().map(|one| LaneWork::new(one, shape));
        let work = self
            .groupings
            .entry((key, shape))
            .or_insert_with(|| Arc::new(group().collect()));
        let work = Arc::clone(work);
        Ok((workloads, work))
    }
}

/// By how much a limit on errors is missed; what was not measured misses it without measure.
fn error_excess(limit: &Limit, error: Option<Fitness>) -> f64 {
    limit.excess(match (limit.quantity, error) {
        (_, None) => f64::NAN,
        (Quantity::PsnrDb, Some(error)) => error.psnr_db(),
        (_, Some(error)) => error.max_abs,
    })
}

fn design_key(choice: &Choice) -> String {
    format!("{:?} {:?}", choice.design.widths, choice.traversal)
}

fn work_key(choice: &Choice) -> WorkKey {
    let Config {
        tile_width,
        tile_height,
        ..
    } = choice.machine;
    (design_key(choice), [tile_width, tile_height])
}

fn options<'b>(frame: &Splats<'b>, choice: &'b Choice) -> Options<'b> {
    Options {
        rules: frame.rules,
        compositing: frame.compositing,
        design: &choice.design,
        traversal: choice.traversal,
    }
}

fn reached(
    question: &Question,
    choice: &Choice,
    error: Option<Fitness>,
    workloads: &[Workload],
    work: &[LaneWork],
) -> Reached {
    let Choice {
        design,
        traversal,
        machine,
    } = choice;
    let widths = &design.widths;
    let clock = Clock::of(machine, widths, question.calibration.family);
    let timings: Vec<Timing> = workloads
        .iter()
        .zip(work)
        .map(|(workload, work)| simulate(workload, work, machine))
        .collect();
    let pace = |timing: &Timing| Throughput::new(timing, machine, clock.clone());
    let paces: Vec<Throughput> = timings.iter().map(pace).collect();
    let energy = |timing: &Timing| {
        let table = &question.energy;
        energy::estimate(widths, *traversal, machine, timing, table).mj_per_frame
    };
    let slowest = (0..paces.len())
        .max_by_key(|frame| paces[*frame].cycles_per_frame)
        .unwrap_or(0);
    let nothing = Timing::default();
    let timing = timings.get(slowest).unwrap_or(&nothing);
    Reached {
        error,
        pace: paces
            .get(slowest)
            .cloned()
            .unwrap_or_else(|| pace(&nothing)),
        ms_per_frame: Spread::of(paces.iter().map(|pace| pace.ms_per_frame)),
        phases: [timing.geometry, timing.sort, timing.raster],
        area: estimate(widths, *traversal, machine, &question.calibration),
        millijoules: timings.iter().map(energy).fold(0.0, f64::max),
    }
}
