//! What a design and a machine reach on the frames of a question: errors, cycles, bytes, area and energy. Sweep,
//! optimisation and fit all ask here.
//!
//! Nothing is estimated on the way: every picture is drawn at its full size, every machine runs on the rows of its own
//! design. Work that choices share is done once: a design's errors, its rows for a tile size, their grouping for a
//! shape of lanes. A search comes back to old rows, so it keeps some; a sweep does not, so it keeps none and holds the
//! rows of one frame alone in memory.

use super::bounds::FrameCounts;
use super::cache::{Cache, locked};
pub use super::errors::{DesignError, ErrorDetail};
use super::errors::{errors_inside, worst};
use super::limits::Limit;
use super::subject::{Choice, Subject};
use crate::design::traversal_name;
use crate::fixed::{Canvas, QuantisedScene};
use crate::machine::area::lane::{FloatLane, in_format};
use crate::machine::area::{Area, estimate};
use crate::machine::clock::{Clock, Throughput};
use crate::machine::energy::{self, Energy};
use crate::machine::lanes::{LaneShape, LaneWork};
use crate::machine::summary::Spread;
use crate::machine::workload::Workload;
use crate::machine::{Timing, simulate};
use crate::picture::Picture;
use crate::plan::{DesignVariant, Engine};
use anyhow::Result;
use rayon::prelude::*;
use serde::Serialize;
use splatline::raster::Window;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

/// Bytes of rows kept at most, and of their groupings.
const MOST_BYTES: usize = 1_000_000_000;

/// Canvases kept at most.
const MOST_CANVASES: usize = 4;

/// Tiles of a frame that are drawn alone at most before all of it is.
const MOST_PROBED: usize = 3;

/// What a choice takes on one frame.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameCost {
    /// Cycles and bytes a frame by the clock.
    pub pace: Throughput,
    /// Cycles of geometry, sort and raster, and of all phases.
    pub cycles: [u64; 4],
    /// Which part of the time the lanes work, and covered and unfinished pixels a cycle and lane.
    pub lanes: [f64; 3],
    /// Packets found in a cache, of all that were looked up.
    pub packet_hit_rate: f64,
    /// Energy.
    pub millijoules: f64,
}

/// What a choice reaches over all frames.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Reached {
    /// Errors over all frames.
    pub error: Option<DesignError>,
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
    /// The slowest frame in full.
    #[serde(skip)]
    pub slowest: FrameCost,
    /// How many frames these are.
    #[serde(skip)]
    pub frames: usize,
}

impl Reached {
    /// One number for what it costs: all resources, in look-up tables.
    pub fn cost(&self) -> f64 {
        self.area.weight
    }
}

/// What a design's pictures depend on: widths in their order, the number of its rounding, traversal.
type DesignKey = ([u8; 13], u8, &'static str);

/// What rows depend on: the design and the tile.
type WorkKey = (DesignKey, [u16; 2]);

fn design_key(variant: &DesignVariant) -> DesignKey {
    let (widths, traversal) = (&variant.design.widths, traversal_name(variant.traversal));
    (widths.numbers(), widths.rounding as u8, traversal)
}

/// What a choice's rows depend on, in an order in which equal ones are neighbours.
pub fn work_key(choice: &Choice) -> WorkKey {
    let machine = &choice.machine;
    let tile = [machine.tile_width, machine.tile_height];
    (design_key(&choice.variant), tile)
}

/// Is given what a choice of a list takes on each frame, as soon as that is known.
pub type Sink<'a> = &'a (dyn Fn(usize, Vec<FrameCost>) -> Result<()> + Sync);

/// Evaluates choices on the frames of a subject.
pub struct Evaluator {
    /// What is explored.
    pub subject: Subject,
    /// What lanes compute in, if not in fixed point.
    pub format: Option<Engine>,
    detail: bool,
    scenes: Cache<usize, Option<Arc<QuantisedScene>>>,
    errors: Cache<(DesignKey, usize), DesignError>,
    workloads: Cache<(WorkKey, usize), Arc<Workload>>,
    groupings: Cache<(WorkKey, usize, LaneShape), Arc<LaneWork>>,
    counts: Cache<usize, FrameCounts>,
    /// Where each frame is drawn, one after the other; who finds it taken draws on another.
    canvases: Mutex<Vec<(usize, Canvas)>>,
    /// Tiles in which designs erred most, by frame, the latest first.
    worst: Mutex<HashMap<usize, Vec<Window>>>,
}

impl Evaluator {
    /// Nothing evaluated yet; the detail of errors is measured only if it is asked for.
    pub fn new(subject: Subject, detail: bool) -> Evaluator {
        Evaluator {
            subject,
            format: None,
            detail,
            scenes: Cache::of_all(),
            errors: Cache::of_all(),
            workloads: Cache::new(MOST_BYTES, |work| work.bytes()),
            groupings: Cache::new(MOST_BYTES, |work| work.bytes()),
            counts: Cache::of_all(),
            canvases: Mutex::default(),
            worst: Mutex::default(),
        }
    }

    /// The same, with the detail that these limits ask for.
    pub fn within(subject: Subject, limits: &[Limit]) -> Evaluator {
        let detail = limits.iter().any(|limit| limit.quantity.is_detail());
        Evaluator::new(subject, detail)
    }

    /// From here on lanes compute in a floating-point format. Rows stay those of the fixed design.
    pub fn draw_in(&mut self, format: Option<Engine>) {
        self.format = format;
        self.errors = Cache::of_all();
    }

    /// The lane of the format.
    pub fn lane(&self) -> Option<FloatLane> {
        self.format.and_then(Engine::lane)
    }

    /// A frame's scene in the kernel's formats, if its footprints are composited one by one.
    fn scene(&self, frame: usize) -> Result<Option<Arc<QuantisedScene>>> {
        self.scenes.get(frame, || {
            let splats = self.subject.frames[frame].splats().ok();
            let scene = splats.map(|s| QuantisedScene::new(s.scene, s.camera, s.rules));
            Ok(scene.map(Arc::new))
        })
    }

    /// The errors of a design over some frames; nothing without references.
    pub fn error(&self, variant: &DesignVariant, frames: &[usize]) -> Result<Option<DesignError>> {
        let mut all = Vec::with_capacity(frames.len());
        for frame in frames {
            let Some(reference) = self.subject.references.get(*frame) else {
                return Ok(None);
            };
            let key = (design_key(variant), *frame);
            all.push(self.errors.get(key, || {
                if let Some(format) = self.format {
                    let drawing = self.subject.frames[*frame].draw_reference(format, &|_, _| ())?;
                    return self.compared(&drawing.picture, reference);
                }
                let Some(scene) = self.scene(*frame)? else {
                    let prepared = &self.subject.frames[*frame];
                    return self.compared(&prepared.picture_of(variant)?, reference);
                };
                let found = self.on_canvas(&scene, variant, *frame, None, |picture| {
                    (self.compared(picture, reference), worst(picture, reference))
                })?;
                self.remember(*frame, found.1);
                found.0
            })?);
        }
        Ok(Some(DesignError::over(&all)))
    }

    fn compared(&self, picture: &Picture, reference: &Picture) -> Result<DesignError> {
        if self.detail {
            DesignError::with_detail(picture, reference)
        } else {
            DesignError::of(picture, reference)
        }
    }

    /// What a design errs at least on these frames, from the few tiles in which others erred most; nothing if the
    /// detail of errors counts.
    pub fn least_error(
        &self,
        variant: &DesignVariant,
        frames: &[usize],
    ) -> Result<Option<DesignError>> {
        let mut all = Vec::with_capacity(frames.len());
        for frame in frames {
            let known = self.errors.known(&(design_key(variant), *frame));
            let windows = locked(&self.worst);
            let windows = windows.get(frame).cloned().unwrap_or_default();
            all.push(match (known, self.scene(*frame)?) {
                (Some(known), _) => known,
                (None, Some(scene)) if !windows.is_empty() => {
                    let reference = &self.subject.references[*frame];
                    let of = |picture: &Picture| errors_inside(picture, reference, &windows);
                    self.on_canvas(&scene, variant, *frame, Some(&windows), of)?
                }
                _ => DesignError::default(),
            });
        }
        Ok((!self.detail && !all.is_empty()).then(|| DesignError::over(&all)))
    }

    /// Draws a design, or of its picture these windows, and looks at it.
    fn on_canvas<T>(
        &self,
        scene: &QuantisedScene,
        variant: &DesignVariant,
        frame: usize,
        only: Option<&[Window]>,
        look: impl FnOnce(&Picture) -> T,
    ) -> Result<T> {
        let splats = self.subject.frames[frame].splats()?;
        let mut canvases = locked(&self.canvases);
        let place = canvases.iter().position(|(of, _)| *of == frame);
        let canvas = place.map(|place| canvases.swap_remove(place).1);
        drop(canvases);
        let mut canvas = canvas.unwrap_or_else(|| Canvas::new(splats.camera));
        canvas.draw(scene, &splats.options(variant), only);
        let seen = look(&canvas.picture);
        let mut canvases = locked(&self.canvases);
        canvases.truncate(MOST_CANVASES - 1);
        canvases.push((frame, canvas));
        Ok(seen)
    }

    /// Notes where a design erred most, unless that is known.
    fn remember(&self, frame: usize, at: Window) {
        let mut worst = locked(&self.worst);
        let known = worst.entry(frame).or_default();
        if !known.contains(&at) {
            known.insert(0, at);
            known.truncate(MOST_PROBED);
        }
    }

    /// Runs choices that share rows, one frame after the other. Who comes back to these rows keeps them; who does not
    /// has those of one frame alone in memory.
    pub fn run(&self, choices: &[Choice], frames: &[usize], keep: bool, sink: Sink) -> Result<()> {
        let Some(first) = choices.first() else {
            return Ok(());
        };
        let key = work_key(first);
        let mut shapes: HashMap<LaneShape, Vec<usize>> = HashMap::new();
        for (place, choice) in choices.iter().enumerate() {
            let shape = LaneShape::from(&choice.machine);
            shapes.entry(shape).or_default().push(place);
        }
        let earlier: Vec<Mutex<Vec<FrameCost>>> =
            choices.iter().map(|_| Mutex::default()).collect();
        for (nth, frame) in frames.iter().enumerate() {
            let extract = || self.workload(first, *frame);
            let workload = if keep {
                self.workloads.get((key, *frame), extract)?
            } else {
                extract()?
            };
            shapes.par_iter().try_for_each(|(shape, places)| {
                let group = || Ok(Arc::new(LaneWork::new(&workload, *shape)));
                let work = if keep {
                    self.groupings.get((key, *frame, *shape), group)?
                } else {
                    group()?
                };
                places.par_iter().try_for_each(|place| {
                    let choice = &choices[*place];
                    let timing = simulate(&workload, &work, &choice.machine);
                    let cost = self.cost(choice, &timing);
                    let mut costs = locked(&earlier[*place]);
                    costs.push(cost);
                    if nth + 1 < frames.len() {
                        return Ok(());
                    }
                    sink(*place, std::mem::take(&mut *costs))
                })
            })?;
        }
        Ok(())
    }

    /// What choices take on each of these frames; of those that share rows, one makes them.
    pub fn costs(
        &self,
        choices: &[Choice],
        frames: &[usize],
        keep: bool,
    ) -> Result<Vec<Vec<FrameCost>>> {
        let key = |place: &usize| work_key(&choices[*place]);
        let mut order: Vec<usize> = (0..choices.len()).collect();
        order.sort_by_cached_key(key);
        let groups: Vec<&[usize]> = order.chunk_by(|a, b| key(a) == key(b)).collect();
        let all = Mutex::new(vec![Vec::new(); choices.len()]);
        groups.par_iter().try_for_each(|group| {
            let of_group: Vec<Choice> = group.iter().map(|place| choices[*place].clone()).collect();
            self.run(&of_group, frames, keep, &|place, costs| {
                locked(&all)[group[place]] = costs;
                Ok(())
            })
        })?;
        Ok(all.into_inner().unwrap_or_else(PoisonError::into_inner))
    }

    /// What a choice takes on each of all frames.
    pub fn on_all_frames(&self, choice: &Choice) -> Result<Vec<FrameCost>> {
        let all: Vec<usize> = (0..self.subject.frames.len()).collect();
        let mut costs = self.costs(std::slice::from_ref(choice), &all, false)?;
        Ok(costs.swap_remove(0))
    }

    /// The rows of a frame by a choice's design, in its machine's tiles.
    pub fn workload(&self, choice: &Choice, frame: usize) -> Result<Arc<Workload>> {
        let (_, tile) = work_key(choice);
        let frame = &self.subject.frames[frame];
        Ok(Arc::new(frame.workload_of(&choice.variant, tile)?))
    }

    fn cost(&self, choice: &Choice, timing: &Timing) -> FrameCost {
        let lanes = timing.units.get("lanes");
        let (widths, machine) = (&choice.variant.design.widths, &choice.machine);
        let clock = Clock::of(machine, widths, self.subject.calibration.family);
        FrameCost {
            pace: Throughput::new(timing, machine, clock),
            cycles: [timing.geometry, timing.sort, timing.raster, timing.total],
            lanes: [
                lanes.map_or(0.0, |unit| unit.utilisation),
                timing.pixels.covered_per_cycle_and_lane,
                timing.pixels.live_per_cycle_and_lane,
            ],
            packet_hit_rate: timing.pixels.packet_hit_rate(),
            millijoules: self.energy(choice, timing).mj_per_frame,
        }
    }

    /// The energy of a choice by unit.
    pub fn energy(&self, choice: &Choice, timing: &Timing) -> Energy {
        let Choice { variant, machine } = choice;
        let (widths, table) = (&variant.design.widths, &self.subject.energy);
        let (lane, traversal) = (self.lane(), variant.traversal);
        energy::estimate(lane.as_ref(), widths, traversal, machine, timing, table)
    }

    /// The area of a choice, which needs no simulation.
    pub fn area(&self, choice: &Choice) -> Area {
        let Choice { variant, machine } = choice;
        let (widths, prices) = (&variant.design.widths, &self.subject.calibration);
        let area = estimate(widths, variant.traversal, machine, prices);
        match self.lane() {
            Some(lane) => in_format(area, &lane, widths, machine, prices),
            None => area,
        }
    }

    /// What a choice reaches that takes this on each frame.
    pub fn reached(
        &self,
        choice: &Choice,
        error: Option<DesignError>,
        costs: &[FrameCost],
    ) -> Reached {
        let slowest = costs.iter().max_by_key(|cost| cost.pace.cycles_per_frame);
        let slowest = slowest
            .cloned()
            .unwrap_or_else(|| self.cost(choice, &Timing::default()));
        let [geometry, sort, raster, _] = slowest.cycles;
        Reached {
            error,
            pace: slowest.pace.clone(),
            ms_per_frame: Spread::of(costs.iter().map(|cost| cost.pace.ms_per_frame)),
            phases: [geometry, sort, raster],
            area: self.area(choice),
            millijoules: costs
                .iter()
                .fold(0.0, |most, cost| cost.millijoules.max(most)),
            slowest,
            frames: costs.len(),
        }
    }

    /// What a choice could reach at best on these frames: its area, no error, and the cycles and bytes that no machine
    /// goes below. It scores no worse than the choice does.
    pub fn at_best(&self, choice: &Choice, frames: &[usize]) -> Result<Reached> {
        let mut costs = Vec::with_capacity(frames.len());
        for frame in frames {
            let counts = self.counts.get(*frame, || self.counted(*frame))?;
            costs.push(self.cost(choice, &counts.least_timing(&choice.machine)));
        }
        Ok(self.reached(choice, Some(DesignError::none()), &costs))
    }

    /// What a frame has, by the design that all starts from.
    fn counted(&self, frame: usize) -> Result<FrameCounts> {
        let choice = Choice {
            variant: DesignVariant::new(self.subject.design.clone(), self.subject.traversal),
            machine: self.subject.machine,
        };
        let key = (work_key(&choice), frame);
        let workload = self.workloads.get(key, || self.workload(&choice, frame))?;
        Ok(FrameCounts::of(&workload))
    }
}
