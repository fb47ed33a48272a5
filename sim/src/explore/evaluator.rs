//! What a design and a machine reach on the frames of a question: errors, cycles, bytes, area and energy. Sweep, optimisation and fit all ask here.
//!
//! Nothing is estimated on the way: every picture is drawn at its full size, every machine runs on the rows of its own design. Work that choices
//! share is done once: a design's errors, its rows for a tile size, their grouping for a shape of lanes. A search comes back to old rows, so it keeps
//! some; a sweep does not, so it keeps none and holds the rows of one frame alone in memory.

use super::bounds::FrameCounts;
use super::space::{Space, SpacePart};
use crate::design::{DesignChoice, traversal_name};
use crate::fast::TILE;
use crate::fixed::{Canvas, QuantisedScene};
use crate::machine::area::{Area, Calibration, estimate};
use crate::machine::clock::{Clock, Throughput};
use crate::machine::config::Config;
use crate::machine::energy::{self, EnergyTable};
use crate::machine::lanes::{LaneShape, LaneWork};
use crate::machine::summary::Spread;
use crate::machine::workload::{Workload, extract_if_room};
use crate::machine::{Timing, simulate};
use crate::metrics::{self, Percentiles, stored};
use crate::picture::Picture;
use crate::plan::{self, DesignVariant, Engine, Prepared};
use anyhow::{Context, Result, bail};
use rayon::prelude::*;
use serde::Serialize;
use splatline::format::{Rounding, Traversal};
use splatline::raster::Window;
use std::collections::{BTreeMap, HashMap};
use std::hash::Hash;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Rows kept at most, in frames of designs and tiles.
const MOST_WORKLOADS: usize = 48;

/// Groupings kept at most: each is as large as a frame's rows.
const MOST_GROUPINGS: usize = 144;

/// Canvases kept at most.
const MOST_CANVASES: usize = 4;

/// Tiles of a frame that are drawn alone at most before all of it is.
const MOST_PROBED: usize = 3;

/// What is explored: frames, and the design and the machine that everything starts from.
pub struct Subject<'a> {
    /// The frames, of one scene or many.
    pub frames: Vec<&'a Prepared>,
    /// Their pictures in double precision; none leaves errors out.
    pub references: Vec<Picture>,
    /// The design to start from.
    pub design: DesignChoice,
    /// The traversal, unless the space or the design says otherwise.
    pub traversal: Option<Traversal>,
    /// The machine to start from.
    pub machine: Config,
    /// Prices of area.
    pub calibration: Calibration,
    /// Energies of actions.
    pub energy: EnergyTable,
}

impl<'a> Subject<'a> {
    /// Frames with the design and the machine that the first one's plan has, and no references yet.
    pub fn new(frames: Vec<&'a Prepared>) -> Result<Subject<'a>> {
        let plan = &frames.first().context("there is no frame")?.plan;
        // Of several scenes, the one with most harmonics.
        let harmonics = frames
            .iter()
            .map(|frame| frame.plan.machine.harmonics_bytes);
        let machine = Config {
            harmonics_bytes: harmonics.max().unwrap_or(0),
            ..plan.machine
        };
        Ok(Subject {
            references: Vec::new(),
            design: plan.entry.design.clone(),
            traversal: None,
            machine,
            calibration: Calibration::default(),
            energy: EnergyTable::default(),
            frames,
        })
    }

    /// Draws the references, once for all that follows.
    pub fn draw_references(&mut self) -> Result<()> {
        for frame in &self.frames {
            let drawing = frame.draw_reference(Engine::Float, &|_, _| ())?;
            self.references.push(drawing.picture);
        }
        Ok(())
    }
}

/// A design by one traversal on a machine.
#[derive(Clone, Debug)]
pub struct Choice {
    /// The design and its traversal.
    pub variant: DesignVariant,
    /// The machine.
    pub machine: Config,
}

/// Errors of one design over all frames. Colours only, units of 1.0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct DesignError {
    /// Largest absolute error.
    pub max_abs: f64,
    /// Root mean square error.
    pub rms: f64,
    /// Mean of fixed minus float.
    pub bias: f64,
    /// What takes thirty times as long as drawing, where it is asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub detail: Option<ErrorDetail>,
}

/// What [`metrics::compare_and_look`] finds beside that.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct ErrorDetail {
    /// Mean structural similarity.
    pub ssim: f64,
    /// 95 % and 99 % of the samples differ by no more.
    #[serde(flatten)]
    pub percentiles: Percentiles,
    /// Mean FLIP.
    pub flip: f64,
}

impl DesignError {
    /// That of the reference itself, by every measure.
    pub fn none() -> DesignError {
        DesignError {
            detail: Some(ErrorDetail {
                ssim: 1.0,
                ..ErrorDetail::default()
            }),
            ..DesignError::default()
        }
    }

    /// How far the colours of a picture are from the reference's: what [`metrics::compare`] says of them, without detail.
    pub fn of(picture: &Picture, reference: &Picture) -> Result<DesignError> {
        let size = |picture: &Picture| (picture.width, picture.height, picture.pixels.len());
        if size(picture) != size(reference) || picture.pixels.is_empty() {
            bail!("the pictures cannot be compared: their sizes differ or are 0");
        }
        let width = picture.width;
        let rows = picture.pixels.par_chunks(width);
        let sums: Vec<[f64; 3]> = rows
            .zip(reference.pixels.par_chunks(width))
            .map(|(fixed, float)| differences(fixed, float))
            .collect();
        // Row by row in their order, so that the sums do not depend on the threads.
        let [max_abs, squares, signed] = sums.iter().fold([0.0; 3], |all, row| {
            [f64::max(all[0], row[0]), all[1] + row[1], all[2] + row[2]]
        });
        let samples = 3.0 * picture.pixels.len() as f64;
        Ok(DesignError {
            max_abs,
            rms: (squares / samples).sqrt(),
            bias: signed / samples,
            detail: None,
        })
    }

    fn with_detail(picture: &Picture, reference: &Picture) -> Result<DesignError> {
        let found = metrics::compare_and_look(picture, reference);
        let (errors, flip) = found.context("the pictures cannot be compared")?;
        let colour = errors.colour;
        Ok(DesignError {
            max_abs: colour.max_abs,
            rms: colour.rms(),
            bias: colour.bias,
            detail: Some(ErrorDetail {
                ssim: colour.ssim,
                percentiles: colour.percentiles,
                flip,
            }),
        })
    }

    /// Over several pictures: the largest error, percentile and FLIP of any, the root of the mean square, and the means of bias and similarity.
    pub fn over(all: &[DesignError]) -> DesignError {
        let [one] = all else {
            let count = all.len().max(1) as f64;
            let mean = |of: fn(&DesignError) -> f64| all.iter().map(of).sum::<f64>() / count;
            let details: Option<Vec<ErrorDetail>> = all.iter().map(|one| one.detail).collect();
            let over = |details: Vec<ErrorDetail>| {
                let most = |of: fn(&ErrorDetail) -> f64| details.iter().map(of).fold(0.0, f64::max);
                ErrorDetail {
                    ssim: details.iter().map(|one| one.ssim).sum::<f64>() / count,
                    percentiles: Percentiles {
                        p95: most(|one| one.percentiles.p95),
                        p99: most(|one| one.percentiles.p99),
                    },
                    flip: most(|one| one.flip),
                }
            };
            return DesignError {
                max_abs: all.iter().map(|one| one.max_abs).fold(0.0, f64::max),
                rms: mean(|one| one.rms * one.rms).sqrt(),
                bias: mean(|one| one.bias),
                detail: details.map(over),
            };
        };
        *one
    }

    /// Peak signal-to-noise ratio, decibels; infinite for equal pictures.
    pub fn psnr_db(&self) -> f64 {
        -20.0 * self.rms.log10()
    }
}

/// The tile in which the largest difference of two pictures of one size lies.
fn worst(picture: &Picture, reference: &Picture) -> Window {
    let pixels = picture.pixels.iter().zip(&reference.pixels);
    let size = |(a, b): (&[f64; 4], &[f64; 4])| {
        let of = |channel: usize| (stored(a[channel]) - stored(b[channel])).abs();
        (0..3).map(of).fold(0.0, f64::max)
    };
    let most = pixels
        .map(size)
        .enumerate()
        .max_by(|a, b| a.1.total_cmp(&b.1));
    let (place, width) = (most.map_or(0, |most| most.0), picture.width.max(1));
    let at = [place % width, place / width].map(|at| at as u16);
    let first = [0, 1].map(|axis| at[axis] - at[axis] % TILE[axis]);
    let size = [picture.width, picture.height];
    let end = [0, 1].map(|axis| {
        first[axis]
            .saturating_add(TILE[axis])
            .min(size[axis] as u16)
    });
    Window { first, end }
}

/// Errors of some pixels as if all others had none: those of the whole picture are no smaller, whatever the bias.
fn errors_inside(picture: &Picture, reference: &Picture, windows: &[Window]) -> DesignError {
    let (mut max_abs, mut squares) = (0.0, 0.0);
    for window in windows {
        for row in window.first[1]..window.end[1] {
            let columns = [window.first[0], window.end[0]];
            let [from, to] = columns.map(|x| usize::from(row) * picture.width + usize::from(x));
            let row = differences(&picture.pixels[from..to], &reference.pixels[from..to]);
            max_abs = f64::max(max_abs, row[0]);
            squares += row[1];
        }
    }
    DesignError {
        max_abs,
        rms: (squares / (3.0 * picture.pixels.len() as f64)).sqrt(),
        ..DesignError::default()
    }
}

/// Largest, sum of squares and signed sum of the differences of red, green and blue; not a number counts as an infinite error.
fn differences(fixed: &[[f64; 4]], float: &[[f64; 4]]) -> [f64; 3] {
    let mut sums = [0.0; 3];
    for (fixed, float) in fixed.iter().zip(float) {
        for channel in 0..3 {
            let difference = stored(fixed[channel]) - stored(float[channel]);
            let size = if difference.is_nan() {
                f64::INFINITY
            } else {
                difference.abs()
            };
            sums[0] = f64::max(sums[0], size);
            sums[1] += size * size;
            sums[2] += difference;
        }
    }
    sums
}

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
}

impl Reached {
    /// One number for what it costs: all resources, in look-up tables.
    pub fn cost(&self) -> f64 {
        self.area.weight
    }
}

/// What a design's pictures depend on: widths in their order, rounding to nearest, traversal.
type DesignKey = ([u8; 13], bool, &'static str);

/// What rows depend on: the design and the tile.
type WorkKey = (DesignKey, [u16; 2]);

fn design_key(variant: &DesignVariant) -> DesignKey {
    let widths = &variant.design.widths;
    let nearest = widths.rounding == Rounding::Nearest;
    (widths.numbers(), nearest, traversal_name(variant.traversal))
}

/// What a choice's rows depend on, in an order in which equal ones are neighbours.
pub fn work_key(choice: &Choice) -> WorkKey {
    let machine = &choice.machine;
    let tile = [machine.tile_width, machine.tile_height];
    (design_key(&choice.variant), tile)
}

/// Results by what they depend on. Where it is full it is emptied: what a search needs again is mostly what it needed last.
struct Cache<K, V> {
    most: usize,
    known: Mutex<HashMap<K, V>>,
}

impl<K: Hash + Eq, V: Clone> Cache<K, V> {
    fn new(most: usize) -> Cache<K, V> {
        let known = Mutex::default();
        Cache { most, known }
    }

    fn map(&self) -> MutexGuard<'_, HashMap<K, V>> {
        self.known.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// What is known, or else made and kept.
    fn get(&self, key: K, make: impl FnOnce() -> Result<V>) -> Result<V> {
        if let Some(known) = self.map().get(&key) {
            return Ok(known.clone());
        }
        // Not under the lock: others may look meanwhile.
        let made = make()?;
        let mut map = self.map();
        if map.len() >= self.most {
            map.clear();
        }
        map.insert(key, made.clone());
        Ok(made)
    }
}

/// Is given what a choice of a list takes on each frame, as soon as that is known.
pub type Sink<'a> = &'a (dyn Fn(usize, Vec<FrameCost>) -> Result<()> + Sync);

/// Evaluates choices on the frames of a subject.
pub struct Evaluator<'a> {
    /// What is explored.
    pub subject: &'a Subject<'a>,
    detail: bool,
    scenes: Vec<Option<QuantisedScene>>,
    errors: Cache<(DesignKey, usize), DesignError>,
    workloads: Cache<(WorkKey, usize), Arc<Workload>>,
    groupings: Cache<(WorkKey, usize, LaneShape), Arc<LaneWork>>,
    counts: Cache<usize, FrameCounts>,
    /// Where each frame is drawn, one after the other; who finds it taken draws on another.
    canvases: Mutex<Vec<(usize, Canvas)>>,
    /// Tiles in which designs erred most, by frame, the latest first.
    worst: Mutex<HashMap<usize, Vec<Window>>>,
}

impl<'a> Evaluator<'a> {
    /// Nothing evaluated yet; the detail of errors is measured only if it is asked for.
    pub fn new(subject: &'a Subject<'a>, detail: bool) -> Evaluator<'a> {
        let with_references = subject.frames.iter().zip(&subject.references);
        let quantised = |(frame, _): (&&Prepared, &Picture)| match frame.subject() {
            Ok(plan::Subject::Splats(s)) if s.are_composited() => {
                Some(QuantisedScene::new(s.scene, s.camera, s.rules))
            }
            _ => None,
        };
        Evaluator {
            subject,
            detail,
            scenes: with_references.map(quantised).collect(),
            errors: Cache::new(usize::MAX),
            workloads: Cache::new(MOST_WORKLOADS),
            groupings: Cache::new(MOST_GROUPINGS),
            counts: Cache::new(usize::MAX),
            canvases: Mutex::default(),
            worst: Mutex::default(),
        }
    }

    /// The design and the machine of a point.
    pub fn choice(&self, space: &Space, point: &[usize]) -> Result<Choice> {
        let variant = self.variant(space, point)?;
        let machine = self.machine(space, point)?;
        Ok(Choice { variant, machine })
    }

    /// The design of a point.
    pub fn variant(&self, space: &Space, point: &[usize]) -> Result<DesignVariant> {
        let settings = space.settings(point, |part| part == SpacePart::Design);
        let design = changed(&self.subject.design, &settings)?;
        let swept = settings.iter().any(|(key, _)| *key == "traversal");
        let traversal = if swept { None } else { self.subject.traversal };
        Ok(DesignVariant::new(design, traversal))
    }

    /// The machine of a point.
    pub fn machine(&self, space: &Space, point: &[usize]) -> Result<Config> {
        let mut machine = self.subject.machine;
        let settings = space.settings(point, |part| part != SpacePart::Design);
        machine.set_all("space", &settings)?;
        Ok(machine)
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
                let Some(Some(scene)) = self.scenes.get(*frame) else {
                    let prepared = self.subject.frames[*frame];
                    return self.compared(&prepared.draw_fixed(variant)?.picture, reference);
                };
                let found = self.on_canvas(scene, variant, *frame, None, |picture| {
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

    /// What a design errs at least on these frames, from the few tiles in which others erred most; nothing if the detail of errors counts.
    pub fn least_error(
        &self,
        variant: &DesignVariant,
        frames: &[usize],
    ) -> Result<Option<DesignError>> {
        let mut all = Vec::with_capacity(frames.len());
        for frame in frames {
            let known = self
                .errors
                .map()
                .get(&(design_key(variant), *frame))
                .copied();
            let windows = self.worst.lock().unwrap_or_else(PoisonError::into_inner);
            let windows = windows.get(frame).cloned().unwrap_or_default();
            all.push(match (known, self.scenes.get(*frame)) {
                (Some(known), _) => known,
                (None, Some(Some(scene))) if !windows.is_empty() => {
                    let reference = &self.subject.references[*frame];
                    let of = |picture: &Picture| errors_inside(picture, reference, &windows);
                    self.on_canvas(scene, variant, *frame, Some(&windows), of)?
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
        let free = || self.canvases.lock().unwrap_or_else(PoisonError::into_inner);
        let mut canvases = free();
        let place = canvases.iter().position(|(of, _)| *of == frame);
        let canvas = place.map(|place| canvases.swap_remove(place).1);
        drop(canvases);
        let mut canvas = canvas.unwrap_or_else(|| Canvas::new(splats.camera));
        canvas.draw(scene, &splats.options(variant), only);
        let seen = look(&canvas.picture);
        let mut canvases = free();
        canvases.truncate(MOST_CANVASES - 1);
        canvases.push((frame, canvas));
        Ok(seen)
    }

    /// Notes where a design erred most, unless that is known.
    fn remember(&self, frame: usize, at: Window) {
        let mut worst = self.worst.lock().unwrap_or_else(PoisonError::into_inner);
        let known = worst.entry(frame).or_default();
        if !known.contains(&at) {
            known.insert(0, at);
            known.truncate(MOST_PROBED);
        }
    }

    /// Runs choices that share rows, one frame after the other. Who comes back to these rows keeps them; who does not has those of one frame alone in
    /// memory.
    pub fn run(&self, choices: &[Choice], frames: &[usize], keep: bool, sink: Sink) -> Result<()> {
        let Some(first) = choices.first() else {
            return Ok(());
        };
        let key = work_key(first);
        let mut shapes: BTreeMap<usize, (LaneShape, Vec<usize>)> = BTreeMap::new();
        for (place, choice) in choices.iter().enumerate() {
            let shape = LaneShape::from(&choice.machine);
            let known = shapes.values_mut().find(|(other, _)| *other == shape);
            match known {
                Some((_, places)) => places.push(place),
                None => drop(shapes.insert(place, (shape, vec![place]))),
            }
        }
        let earlier: Vec<Mutex<Vec<FrameCost>>> =
            choices.iter().map(|_| Mutex::default()).collect();
        for (nth, frame) in frames.iter().enumerate() {
            let extract = || self.workload(&first.variant, key.1, *frame);
            let workload = if keep {
                self.workloads.get((key, *frame), extract)?
            } else {
                extract()?
            };
            shapes.par_iter().try_for_each(|(_, (shape, places))| {
                let group = || Ok(Arc::new(LaneWork::new(&workload, *shape)));
                let work = if keep {
                    self.groupings.get((key, *frame, *shape), group)?
                } else {
                    group()?
                };
                places.par_iter().try_for_each(|place| {
                    let cost = self.frame_cost(&choices[*place], &workload, &work);
                    let mut costs = earlier[*place]
                        .lock()
                        .unwrap_or_else(PoisonError::into_inner);
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

    /// The rows of a frame by a design, in tiles of a size.
    pub fn workload(
        &self,
        variant: &DesignVariant,
        tile: [u16; 2],
        frame: usize,
    ) -> Result<Arc<Workload>> {
        let splats = self.subject.frames[frame].splats()?;
        let options = splats.options(variant);
        let workload = extract_if_room(splats.scene, splats.camera, &options, tile)?;
        Ok(Arc::new(workload))
    }

    fn frame_cost(&self, choice: &Choice, workload: &Workload, work: &LaneWork) -> FrameCost {
        self.cost(choice, &simulate(workload, work, &choice.machine))
    }

    fn cost(&self, choice: &Choice, timing: &Timing) -> FrameCost {
        let Choice { variant, machine } = choice;
        let (widths, table) = (&variant.design.widths, &self.subject.energy);
        let energy = energy::estimate(widths, variant.traversal, machine, timing, table);
        let lanes = timing.units.get("lanes");
        FrameCost {
            pace: self.throughput(choice, timing),
            cycles: [timing.geometry, timing.sort, timing.raster, timing.total],
            lanes: [
                lanes.map_or(0.0, |unit| unit.utilisation),
                timing.pixels.covered_per_cycle_and_lane,
                timing.pixels.live_per_cycle_and_lane,
            ],
            packet_hit_rate: timing.pixels.packet_hit_rate(),
            millijoules: energy.mj_per_frame,
        }
    }

    fn throughput(&self, choice: &Choice, timing: &Timing) -> Throughput {
        let Choice { variant, machine } = choice;
        let clock = Clock::of(
            machine,
            &variant.design.widths,
            self.subject.calibration.family,
        );
        Throughput::new(timing, machine, clock)
    }

    /// The area of a choice, which needs no simulation.
    pub fn area(&self, choice: &Choice) -> Area {
        let Choice { variant, machine } = choice;
        let (widths, prices) = (&variant.design.widths, &self.subject.calibration);
        estimate(widths, variant.traversal, machine, prices)
    }

    /// What a choice reaches that takes this on each frame.
    pub fn reached(
        &self,
        choice: &Choice,
        error: Option<DesignError>,
        costs: &[FrameCost],
    ) -> Reached {
        let slowest = costs.iter().max_by_key(|cost| cost.pace.cycles_per_frame);
        let slowest = slowest.cloned().unwrap_or_else(|| self.no_cost(choice));
        let [geometry, sort, raster, _] = slowest.cycles;
        Reached {
            error,
            pace: slowest.pace.clone(),
            ms_per_frame: Spread::of(costs.iter().map(|cost| cost.pace.ms_per_frame)),
            phases: [geometry, sort, raster],
            area: self.area(choice),
            millijoules: costs
                .iter()
                .map(|cost| cost.millijoules)
                .fold(0.0, f64::max),
            slowest,
        }
    }

    /// What a choice could reach at best on these frames: its area, no error, and the cycles and bytes that no machine goes below. It scores no worse
    /// than the choice does.
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
        let Subject {
            design,
            traversal,
            machine,
            ..
        } = self.subject;
        let variant = DesignVariant::new(design.clone(), *traversal);
        let tile = [machine.tile_width, machine.tile_height];
        let key = ((design_key(&variant), tile), frame);
        let extract = || self.workload(&variant, tile, frame);
        let workload = self.workloads.get(key, extract)?;
        Ok(FrameCounts::of(&workload))
    }

    fn no_cost(&self, choice: &Choice) -> FrameCost {
        self.cost(choice, &Timing::default())
    }
}

/// A design with some of its keys set otherwise; `base` names another one to begin with, or its file.
fn changed(start: &DesignChoice, settings: &[(&str, &toml::Value)]) -> Result<DesignChoice> {
    if settings.is_empty() {
        return Ok(start.clone());
    }
    let base = settings.iter().find(|(key, _)| *key == "base");
    let start = match base.and_then(|(_, value)| value.as_str()) {
        Some(name) => DesignChoice::load(name)?,
        None => start.clone(),
    };
    let mut table: toml::Table = start.resolved().to_toml().parse()?;
    for (key, value) in settings.iter().filter(|(key, _)| *key != "base") {
        table.insert((*key).to_owned(), (*value).clone());
    }
    Ok(DesignChoice::from_toml("space.toml", &table.to_string())?)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Beside the whole comparison, on a picture with large and with tiny errors and one beyond 0 to 1.
    #[test]
    fn quick_errors_are_those_of_the_whole_comparison() {
        let mut float = Picture::new(40, 30);
        let mut fixed = Picture::new(40, 30);
        for (place, (a, b)) in float.pixels.iter_mut().zip(&mut fixed.pixels).enumerate() {
            let value = (place * 37 % 101) as f64 / 90.0;
            *a = [value, value / 2.0, 1.0 - value, 1.0];
            *b = a.map(|value| value + (place % 7) as f64 * 1e-4 - 2e-4);
        }
        fixed.pixels[77] = [0.9; 4];
        let quick = DesignError::of(&fixed, &float).unwrap();
        let whole = metrics::compare(&fixed, &float).unwrap().colour;
        assert_eq!(quick.max_abs, whole.max_abs);
        assert!((quick.rms / whole.rms() - 1.0).abs() < 1e-12);
        assert!((quick.bias - whole.bias).abs() < 1e-15);
        assert!((quick.psnr_db() - whole.psnr_db).abs() < 1e-9);
        assert_eq!(
            DesignError::of(&float, &float).unwrap(),
            DesignError::default()
        );
        assert!(DesignError::of(&float, &Picture::new(30, 40)).is_err());
        fixed.pixels[3][0] = f64::NAN;
        assert_eq!(
            DesignError::of(&fixed, &float).unwrap().max_abs,
            f64::INFINITY
        );
    }

    /// Tile by tile they grow to those of the whole, and never beyond.
    #[test]
    fn errors_of_tiles_are_no_larger_than_the_pictures() {
        let mut float = Picture::new(150, 70);
        let mut fixed = Picture::new(150, 70);
        for (place, (a, b)) in float.pixels.iter_mut().zip(&mut fixed.pixels).enumerate() {
            *a = [0.5; 4];
            *b = [0.5 + (place * 37 % 101) as f64 * 1e-3; 4];
        }
        fixed.pixels[66 * 150 + 140] = [0.9; 4];
        let tile = worst(&fixed, &float);
        assert_eq!((tile.first, tile.end), ([128, 64], [150, 70]));
        let whole = DesignError::of(&fixed, &float).unwrap();
        let part = errors_inside(&fixed, &float, &[tile]);
        assert!(part.max_abs == whole.max_abs && part.rms < whole.rms);
        let all = errors_inside(
            &fixed,
            &float,
            &[Window {
                first: [0; 2],
                end: [150, 70],
            }],
        );
        assert!((all.rms / whole.rms - 1.0).abs() < 1e-12);
    }

    #[test]
    fn errors_over_pictures_are_the_largest_and_the_mean() {
        let one = |max_abs, rms, bias| DesignError {
            max_abs,
            rms,
            bias,
            detail: None,
        };
        let over = DesignError::over(&[one(0.1, 3.0, 0.5), one(0.4, 4.0, -0.1)]);
        assert_eq!(over.max_abs, 0.4);
        assert!((over.rms - 12.5f64.sqrt()).abs() < 1e-12 && (over.bias - 0.2).abs() < 1e-12);
    }
}
