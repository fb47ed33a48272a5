//! One question, one answer: the cheapest machine with a design that holds all limits, or the limit that cannot be held.
//!
//! ```text
//! limits, frames -> space of designs and machines -> search (`descent`) over what points reach (`evaluate`) -> answer
//! ```
//!
//! With many frames the search runs on those that are heaviest; what it finds is evaluated on all of them, and a frame that misses a limit joins the
//! search, which begins again. So the answer holds for every frame, and most frames are looked at once.

mod descent;
mod evaluate;
pub mod limits;
#[cfg(test)]
mod tests;
mod text;

pub use evaluate::{Choice, Question, Reached};

use super::space::{Space, SpaceAxis, SpaceError, SpacePart};
use crate::design::{DesignChoice, ResolvedDesign};
use crate::explore::fit::Fitness;
use crate::machine::config::{Config, setting};
use crate::machine::summary::Spread;
use anyhow::{Context, Result};
use descent::{Score, compare};
use evaluate::Evaluator;
use limits::{Limit, Quantity};
use serde::Serialize;
use splatline::format::WIDTH_RANGES;
use std::fmt::Write;
use toml::Value;

/// The machines that are searched unless a space is given.
const USUAL: &str = include_str!("usual.toml");

/// Frames that the search begins with.
const FEW_FRAMES: usize = 3;

/// Points that an answer holds: the cheapest and the next three.
const MOST_ANSWERS: usize = 4;

/// By which part of its cost a point is dearer at least than the one before it in an answer.
const APART: f64 = 0.01;

/// A point of an answer.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Found {
    /// The design, by its widths.
    pub design: ResolvedDesign,
    /// The machine.
    pub machine: Config,
    /// What it reaches over all frames.
    pub reached: Reached,
}

/// How a limit stands at the answer's first point.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Standing {
    /// The limit.
    pub limit: Limit,
    /// What is reached.
    pub value: f64,
    /// Which part of the bound is left; below 0 it is missed.
    pub slack: f64,
    /// The cheapest point looked at that holds all other limits, in look-up tables: what the limit costs at least is the difference to it.
    pub cost_without: Option<f64>,
    /// Where not all limits can be held together: by which part of its bound this one is missed at least while all others hold.
    pub missed_alone: Option<f64>,
}

/// The answer.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Answer {
    /// Does the first point hold all limits?
    pub holds: bool,
    /// The cheapest point and the next ones; or the one that misses least.
    pub found: Vec<Found>,
    /// All limits at the first point.
    pub standings: Vec<Standing>,
    /// Points looked at.
    pub points: usize,
    /// Designs drawn.
    pub designs: usize,
    /// Frames that the search ran on, and all of them.
    pub frames: [usize; 2],
    /// Were widths searched, or was the design kept because no limit was on the error?
    pub searched_designs: bool,
}

/// The space that is searched where none is given: every width where errors are limited, and the usual machines, with what the search starts from.
pub fn usual_space(
    design: &DesignChoice,
    machine: &Config,
    designs: bool,
) -> Result<Space, SpaceError> {
    let mut text = USUAL.to_owned();
    if designs {
        text += "[design]\n";
        for (name, low, high) in WIDTH_RANGES {
            // Writing to a String cannot fail.
            let _ = writeln!(text, "{name} = {{ from = {low}, to = {high} }}");
        }
    }
    let mut space = Space::without_points("the usual space", &text)?;
    for axis in &mut space.axes {
        let Some(value) = value_of(axis, design, machine) else {
            continue;
        };
        if !axis.values.contains(&value) {
            let number = value.as_integer();
            let after = |other: &Value| other.as_integer() < number;
            let place = axis.values.partition_point(after);
            axis.values.insert(place, value);
        }
    }
    Ok(space)
}

/// What a design or a machine has on an axis.
fn value_of(axis: &SpaceAxis, design: &DesignChoice, machine: &Config) -> Option<Value> {
    if axis.part != SpacePart::Design {
        return Some(setting(&axis.key)?.value(machine));
    }
    let widths = WIDTH_RANGES.iter().zip(design.widths.numbers());
    let bits = widths.into_iter().find(|((name, ..), _)| *name == axis.key);
    bits.map(|(_, bits)| Value::Integer(bits.into()))
}

/// Where the search starts: at the design and the machine given, and otherwise at the widest value of a width and the first of all else.
fn start(question: &Question, space: &Space) -> Vec<usize> {
    let index = |axis: &SpaceAxis| {
        let value = value_of(axis, &question.design, &question.machine);
        let place = value.and_then(|value| axis.values.iter().position(|other| *other == value));
        let is_width = WIDTH_RANGES.iter().any(|(name, ..)| *name == axis.key);
        place.unwrap_or(if is_width { axis.values.len() - 1 } else { 0 })
    };
    space.axes.iter().map(index).collect()
}

impl<'a> Question<'a> {
    /// The same about some of the frames.
    fn about(&self, frames: &[usize]) -> Question<'a> {
        let some = |of: usize| self.references.get(of).cloned();
        Question {
            frames: frames.iter().map(|frame| self.frames[*frame]).collect(),
            references: frames.iter().filter_map(|frame| some(*frame)).collect(),
            design: self.design.clone(),
            traversal: self.traversal,
            machine: self.machine,
            calibration: self.calibration.clone(),
            limits: self.limits.clone(),
            energy: self.energy.clone(),
        }
    }

    /// By how much all limits are missed, in sum.
    fn missed(&self, reached: &Reached) -> f64 {
        self.limits.iter().map(|limit| reached.excess(limit)).sum()
    }

    /// The same without one of them.
    fn missed_but(&self, reached: &Reached, but: usize) -> f64 {
        let others = self
            .limits
            .iter()
            .enumerate()
            .filter(|(place, _)| *place != but);
        others.map(|(_, limit)| reached.excess(limit)).sum()
    }

    fn score(&self, reached: &Reached) -> Score {
        let cycles = reached.pace.cycles_per_frame as f64;
        [self.missed(reached), reached.cost(), cycles]
    }
}

/// Searches the space and answers. `progress` is told what is being done.
pub fn ask(question: &Question, space: &Space, progress: &(dyn Fn(&str) + Sync)) -> Result<Answer> {
    let all: Vec<usize> = (0..question.frames.len()).collect();
    let mut searched = if all.len() > FEW_FRAMES {
        heaviest(question, space, progress)?
    } else {
        all.clone()
    };
    loop {
        let some = question.about(&searched);
        let mut evaluator = Evaluator::new(&some, space, progress);
        let found = search(&mut evaluator)?;
        let others: Vec<usize> = all
            .iter()
            .copied()
            .filter(|f| !searched.contains(f))
            .collect();
        match answered(question, &evaluator, &found, &others, progress)? {
            // The search believed that this frame was lighter.
            Attempt::MissedBy(frame) => searched.push(frame),
            Attempt::Met(mut answer) => {
                answer.frames = [searched.len(), all.len()];
                return Ok(*answer);
            }
        }
    }
}

/// The frames that take the most cycles where the search starts.
fn heaviest(
    question: &Question,
    space: &Space,
    progress: &(dyn Fn(&str) + Sync),
) -> Result<Vec<usize>> {
    let at = start(question, space);
    let mut cycles = Vec::with_capacity(question.frames.len());
    for frame in 0..question.frames.len() {
        let reached = on_frame(question, space, &at, frame, progress)?;
        cycles.push(reached.map_or(0, |reached| reached.pace.cycles_per_frame));
    }
    let mut order: Vec<usize> = (0..cycles.len()).collect();
    order.sort_by_key(|frame| std::cmp::Reverse(cycles[*frame]));
    order.truncate(FEW_FRAMES);
    Ok(order)
}

/// What a point reaches on one frame.
fn on_frame(
    question: &Question,
    space: &Space,
    point: &[usize],
    frame: usize,
    progress: &(dyn Fn(&str) + Sync),
) -> Result<Option<Reached>> {
    let one = question.about(&[frame]);
    let mut evaluator = Evaluator::new(&one, space, progress);
    evaluator.evaluate(&[point.to_vec()])?;
    Ok(evaluator.known.remove(point).flatten())
}

/// Where the search ends, and what each limit is missed by at least where they cannot be held together.
struct Searched {
    point: Vec<usize>,
    missed_alone: Vec<Option<f64>>,
}

fn search(evaluator: &mut Evaluator) -> Result<Searched> {
    let (question, space) = (evaluator.question, evaluator.space);
    let mut at = start(question, space);
    let nothing = vec![None; question.limits.len()];
    if evaluator.has_error_limit() && evaluator.error_excess(&at)? > 0.0 {
        let (widths, _) = evaluator.split_axes();
        for axis in widths {
            at[axis] = space.axes[axis].values.len() - 1;
        }
    }
    let point = evaluator.search(at, &|reached| question.score(reached))?;
    let missed = |evaluator: &Evaluator, point: &[usize]| {
        let reached = evaluator.known.get(point).and_then(Option::as_ref);
        reached.map_or(f64::INFINITY, |reached| question.missed(reached))
    };
    if missed(evaluator, &point) <= 0.0 {
        let missed_alone = nothing;
        return Ok(Searched {
            point,
            missed_alone,
        });
    }
    let (_, machines) = evaluator.split_axes();
    let mut missed_alone = nothing;
    for (place, limit) in question.limits.iter().enumerate() {
        // What the point holds need not give way. Errors are kept: what a wider one would allow is another question.
        let excess = |reached: &Option<Reached>| reached.as_ref().map_or(0.0, |r| r.excess(limit));
        let is_missed = evaluator
            .known
            .get(&point)
            .is_some_and(|reached| excess(reached) > 0.0);
        if is_missed && !limit.quantity.is_error() {
            evaluator.settle(point.clone(), &machines, &|reached| {
                [
                    question.missed_but(reached, place),
                    reached.excess(limit),
                    reached.cost(),
                ]
            })?;
        }
        let all = evaluator.known.values().flatten();
        let alone = all.filter(|reached| question.missed_but(reached, place) <= 0.0);
        let least = alone
            .map(|reached| reached.excess(limit))
            .min_by(f64::total_cmp);
        missed_alone[place] = least.filter(|least| least.is_finite());
    }
    Ok(Searched {
        point,
        missed_alone,
    })
}

/// What evaluating on all frames says.
enum Attempt {
    /// The answer holds for them.
    Met(Box<Answer>),
    /// Of the frames that were not searched, one at which the first point misses a limit.
    MissedBy(usize),
}

/// The answer over all frames, the `others` beside those that were searched.
fn answered(
    question: &Question,
    evaluator: &Evaluator,
    searched: &Searched,
    others: &[usize],
    progress: &(dyn Fn(&str) + Sync),
) -> Result<Attempt> {
    let known = |point: &[usize]| evaluator.known.get(point).and_then(Option::as_ref);
    let first =
        known(&searched.point).context("the search ends at a point that makes no machine")?;
    let holds = question.missed(first) <= 0.0;
    let mut points: Vec<(&Vec<usize>, &Reached)> = evaluator
        .known
        .iter()
        .filter_map(|(point, reached)| Some((point, reached.as_ref()?)))
        .filter(|(_, reached)| holds && question.missed(reached) <= 0.0)
        .collect();
    points.sort_by(|a, b| compare(&question.score(a.1), &question.score(b.1)).then(a.0.cmp(b.0)));
    // Points of nearly the same cost differ in what hardly matters, a place of a queue: one of them says all.
    points.dedup_by(|later, kept| later.1.cost() < (1.0 + APART) * kept.1.cost());
    let mut found = Vec::new();
    if !holds {
        points = vec![(&searched.point, first)];
    }
    for (point, reached) in points.into_iter().take(MOST_ANSWERS) {
        let mut all = vec![reached.clone()];
        for frame in others {
            let one = on_frame(question, evaluator.space, point, *frame, progress)?;
            let one = one.context("a machine for some frames is one for all")?;
            if holds && found.is_empty() && question.missed(&one) > 0.0 {
                return Ok(Attempt::MissedBy(*frame));
            }
            all.push(one);
        }
        let reached = combined(all, evaluator.question.frames.len());
        if holds && question.missed(&reached) > 0.0 {
            continue;
        }
        let choice = evaluator.choice(point)?;
        found.push(Found {
            design: choice.design.resolved(),
            machine: choice.machine,
            reached,
        });
    }
    let reached = &found.first().context("the first point was found")?.reached;
    let standing = |(place, limit): (usize, &Limit)| {
        let value = reached.value(limit.quantity).unwrap_or(f64::NAN);
        let all = evaluator.known.values().flatten();
        let without = all.filter(|other| question.missed_but(other, place) <= 0.0);
        let simulated = without.map(Reached::cost).min_by(f64::total_cmp);
        let drawn = match (limit.quantity.is_error(), found.first()) {
            (true, Some(first)) => evaluator.cost_without_error(&first.machine, place),
            _ => None,
        };
        Standing {
            limit: limit.clone(),
            value,
            slack: limit.slack(value),
            cost_without: simulated.into_iter().chain(drawn).min_by(f64::total_cmp),
            missed_alone: searched.missed_alone[place],
        }
    };
    let answer = Answer {
        holds,
        standings: question.limits.iter().enumerate().map(standing).collect(),
        found,
        points: evaluator.known.values().flatten().count(),
        designs: evaluator.designs(),
        frames: [0, 0],
        searched_designs: !evaluator.split_axes().0.is_empty(),
    };
    Ok(Attempt::Met(Box::new(answer)))
}

/// What is reached over parts of the frames, of which the first holds `first` frames and each other part one.
fn combined(parts: Vec<Reached>, first: usize) -> Reached {
    let weights = |place: usize| if place == 0 { first } else { 1 };
    let frames: usize = (0..parts.len()).map(weights).sum();
    let slowest = parts
        .iter()
        .max_by_key(|part| part.pace.cycles_per_frame)
        .unwrap_or(&parts[0])
        .clone();
    if parts.len() == 1 {
        return slowest;
    }
    // The searched frames are the heaviest, few among many: each stands for its mean.
    let each = |part: usize| std::iter::repeat_n(&parts[part], weights(part));
    let ms = (0..parts.len())
        .flat_map(each)
        .map(|part| part.ms_per_frame.mean);
    let spread = Spread::of(ms);
    let errors: Vec<Fitness> = (0..parts.len())
        .flat_map(each)
        .filter_map(|part| part.error)
        .collect();
    Reached {
        error: (errors.len() == frames).then(|| Fitness::over(&errors)),
        ms_per_frame: Spread {
            worst: slowest.ms_per_frame.worst,
            ..spread
        },
        millijoules: parts
            .iter()
            .map(|part| part.millijoules)
            .fold(0.0, f64::max),
        ..slowest
    }
}

/// Limits from a bandwidth, a part and so on are upper ones of the same quantity: the tighter holds.
pub fn tightest(limits: Vec<Limit>) -> Vec<Limit> {
    let mut kept: Vec<Limit> = Vec::new();
    for limit in limits {
        match kept
            .iter_mut()
            .find(|other| other.quantity == limit.quantity)
        {
            Some(other) => {
                let tighter = if limit.quantity.is_at_least() {
                    limit.bound > other.bound
                } else {
                    limit.bound < other.bound
                };
                if tighter {
                    *other = limit;
                }
            }
            None => kept.push(limit),
        }
    }
    kept
}

/// The limits that a part sets.
pub fn limits_of_part(name: &str, part: &crate::machine::parts::Part) -> Vec<Limit> {
    let limit = |quantity, bound: u64| Limit::new(quantity, bound as f64, name);
    vec![
        limit(Quantity::Luts, part.luts),
        limit(Quantity::FlipFlops, part.flip_flops),
        limit(Quantity::Dsps, part.dsps),
        limit(Quantity::MemoryKbit, part.memory_kbit),
        limit(Quantity::BytesPerSecond, part.megabytes_per_s * 1_000_000),
    ]
}
