//! The cheapest machine with a design that holds all limits, or the limit that cannot be held.
//!
//! ```text
//! limits, frames -> space of designs and machines -> search over what points reach -> answer
//! ```
//!
//! With many frames the search runs on those that are heaviest; what it finds is evaluated on all of them, and a frame
//! that misses a limit joins the search, which begins again. So the answer holds for every frame, and most frames are
//! looked at once.

use super::evaluator::{Evaluator, Reached};
use super::formats::{self, FormatRow};
use super::limits::{Limit, are_held, missed};
use super::refusal::{RuledOut, failing, ruled_out};
use super::search::{Score, Search, compare};
use super::space::{Point, Space, SpaceAxis, SpacePart};
use super::subject::{Choice, Subject};
use crate::design::{DesignChoice, ResolvedDesign};
use crate::input::Refused;
use crate::machine::config::{Config, setting};
use anyhow::{Context, Result};
use serde::Serialize;
use splatline::format::WIDTH_RANGES;
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
    /// Its place on every axis of the space.
    #[serde(skip)]
    pub point: Point,
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
    /// The cheapest point looked at that holds all other limits, in look-up tables: what the limit costs at least is
    /// the difference to it.
    pub cost_without: Option<f64>,
    /// Where not all limits can be held together: by which part of its bound this one is missed at least while all
    /// others hold.
    pub missed_alone: Option<f64>,
}

/// The answer.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
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
    /// What no machine of the space can hold, by bounds alone; then nothing was searched.
    pub ruled_out: Vec<RuledOut>,
    /// What every machine reached that was simulated.
    #[serde(skip)]
    pub looked_at: Vec<Reached>,
    /// Were widths searched, or was the design kept because no limit was on the error?
    pub searched_designs: bool,
    /// Floating-point formats beside the first point, if they were asked for.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub formats: Vec<FormatRow>,
    /// PSNR and transistors a lane of every fixed design that was drawn.
    #[serde(skip)]
    pub fixed_lanes: Vec<[f64; 2]>,
}

/// The space that is searched where none is given: every width where errors are limited, and the usual machines, with
/// what the search starts from.
pub fn usual_space(
    design: &DesignChoice,
    machine: &Config,
    designs: bool,
) -> Result<Space, Refused> {
    let mut text = USUAL.to_owned();
    if machine.surface_layers > 0 {
        text += "resolve_interval = [1, 2, 4, 8, 16, 32]\n";
    }
    if designs {
        text += "[design]\n";
        for (name, low, high) in WIDTH_RANGES {
            text += &format!("{name} = {{ from = {low}, to = {high} }}\n");
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

/// Where on an axis that is; nothing if it is none of its values.
pub(super) fn place_of(axis: &SpaceAxis, design: &DesignChoice, machine: &Config) -> Option<usize> {
    let value = value_of(axis, design, machine)?;
    axis.values.iter().position(|other| *other == value)
}

/// Where the search starts: at the design and the machine given, and otherwise at the widest value of a width and the
/// first of all else.
pub(super) fn start(subject: &Subject, space: &Space) -> Point {
    let index = |axis: &SpaceAxis| {
        let place = place_of(axis, &subject.design, &subject.machine);
        let is_width = WIDTH_RANGES.iter().any(|(name, ..)| *name == axis.key);
        place.unwrap_or(if is_width { axis.values.len() - 1 } else { 0 })
    };
    space.axes.iter().map(index).collect()
}

fn score(limits: &[Limit], reached: &Reached) -> Score {
    let cycles = reached.pace.cycles_per_frame as f64;
    [missed(limits, None, reached), reached.cost(), cycles]
}

/// Refuses what no machine of the space can hold, without a drawing or a simulation; nothing if bounds do not rule it
/// out.
pub fn refusal(
    evaluator: &Evaluator,
    limits: &[Limit],
    space: &Space,
    progress: &(dyn Fn(&str) + Sync),
) -> Result<Option<Answer>> {
    let all = evaluator.subject.frames.len();
    let few = (0..all.min(FEW_FRAMES)).collect();
    let search = Search::new(evaluator, space, limits, few, progress);
    progress("bounds by area and counts alone");
    let ruled_out = ruled_out(&search)?;
    if ruled_out.is_empty() {
        return Ok(None);
    }
    Ok(Some(refused(&search, ruled_out, all)))
}

fn refused(search: &Search, ruled_out: Vec<RuledOut>, frames: usize) -> Answer {
    Answer {
        designs: search.designs(),
        frames: [frames.min(FEW_FRAMES), frames],
        ruled_out,
        searched_designs: !search.split_axes().0.is_empty(),
        ..Answer::default()
    }
}

/// The limits on errors that the widest design misses; nothing if one of them holds or the space has more than widths.
fn out_of_every_width(search: &mut Search, at: &[usize]) -> Result<Vec<RuledOut>> {
    // Only where all axes of the designs are widths is the widest design the most exact one.
    let axes = search.space.axes.iter();
    let of_design = axes.filter(|axis| axis.part == SpacePart::Design).count();
    if of_design > search.split_axes().0.len() {
        return Ok(Vec::new());
    }
    let Some(error) = search.error(at)? else {
        return Ok(Vec::new());
    };
    let limits = search.limits.iter();
    let of = |limit: &Limit| failing(limit, limit.quantity.of_error(&error), 0.0, &[]);
    Ok(limits.filter_map(of).collect())
}

/// Searches the space and answers. `progress` is given what is being done.
pub fn optimize(
    evaluator: &mut Evaluator,
    limits: &[Limit],
    space: &Space,
    progress: &(dyn Fn(&str) + Sync),
) -> Result<Answer> {
    let all: Vec<usize> = (0..evaluator.subject.frames.len()).collect();
    let mut searched = if all.len() > FEW_FRAMES {
        heaviest(evaluator, space)?
    } else {
        all.clone()
    };
    loop {
        let mut search = Search::new(evaluator, space, limits, searched.clone(), progress);
        let at = widest_if_needed(&mut search)?;
        let ruled_out = out_of_every_width(&mut search, &at)?;
        if !ruled_out.is_empty() {
            return Ok(refused(&search, ruled_out, all.len()));
        }
        let found = best_point(&mut search, at)?;
        match answered(&search, &found, &searched)? {
            // The search believed that this frame was lighter.
            Err(frame) => searched.push(frame),
            Ok(mut answer) => {
                answer.frames = [searched.len(), all.len()];
                answer.fixed_lanes = search.drawn_lanes();
                if !evaluator.subject.formats.is_empty() {
                    let first = answer.found.first().context("the first point was found")?;
                    answer.formats = formats::beside_point(
                        evaluator,
                        (space, limits),
                        (&searched, &first.point),
                        &|reached| score(limits, reached),
                        progress,
                    )?;
                }
                return Ok(answer);
            }
        }
    }
}

/// The frames that take the most cycles where the search starts.
fn heaviest(evaluator: &Evaluator, space: &Space) -> Result<Point> {
    let subject = &evaluator.subject;
    let at = Choice::possible(subject.choice(space, &start(subject, space)))?;
    let mut order: Vec<usize> = (0..subject.frames.len()).collect();
    if let Some(at) = at {
        let costs = evaluator.on_all_frames(&at)?;
        order.sort_by_key(|frame| std::cmp::Reverse(costs[*frame].pace.cycles_per_frame));
    }
    order.truncate(FEW_FRAMES);
    Ok(order)
}

/// Where the search ends, and what each limit is missed by at least where they cannot be held together.
type BestPoint = (Point, Vec<Option<f64>>);

/// Where the search starts; with all widths at their widest if the design that is given misses a limit on errors.
fn widest_if_needed(search: &mut Search) -> Result<Point> {
    let space = search.space;
    let mut at = start(&search.evaluator.subject, space);
    if search.has_error_limit() && search.error_excess(&at)? > 0.0 {
        let (widths, _) = search.split_axes();
        for axis in widths {
            at[axis] = space.axes[axis].values.len() - 1;
        }
    }
    Ok(at)
}

fn best_point(search: &mut Search, at: Point) -> Result<BestPoint> {
    let limits = search.limits;
    let point = search.search(at, &|reached| score(limits, reached))?;
    let mut missed_alone = vec![None; limits.len()];
    let first = search.known.get(&point).and_then(Option::as_ref).cloned();
    let first = first.as_ref();
    if first.is_some_and(|first| are_held(limits, first)) {
        return Ok((point, missed_alone));
    }
    let (_, machines) = search.split_axes();
    for (place, limit) in limits.iter().enumerate() {
        // What the point holds need not give way. Errors are kept: what a wider one would allow is another question.
        let is_missed = first.is_some_and(|first| limit.missed_by(first) > 0.0);
        if is_missed && !limit.quantity.is_error() {
            search.settle(point.clone(), &machines, &|reached| {
                let others = missed(limits, Some(place), reached);
                [others, limit.missed_by(reached), reached.cost()]
            })?;
        }
        let all = search.known.values().flatten();
        let alone = all.filter(|reached| missed(limits, Some(place), reached) <= 0.0);
        let missed = alone.map(|reached| limit.missed_by(reached));
        let least = missed.min_by(f64::total_cmp);
        missed_alone[place] = least.filter(|least| least.is_finite());
    }
    Ok((point, missed_alone))
}

/// The answer over all frames; or of those that were not searched one at which the first point misses a limit.
fn answered(
    search: &Search,
    (best, missed_alone): &BestPoint,
    searched: &[usize],
) -> Result<Result<Answer, usize>> {
    let (limits, evaluator) = (search.limits, search.evaluator);
    let known = |point: &[usize]| search.known.get(point).and_then(Option::as_ref);
    let first = known(best).context("the search ends at a point that makes no machine")?;
    let holds = are_held(limits, first);
    let all = search.known.iter();
    let all = all.filter_map(|(point, reached)| Some((point, reached.as_ref()?)));
    let holding = all.filter(|(_, reached)| holds && are_held(limits, reached));
    let mut points: Vec<(&Point, &Reached)> = holding.collect();
    points.sort_by(|a, b| compare(&score(limits, a.1), &score(limits, b.1)).then(a.0.cmp(b.0)));
    // Points of nearly the same cost differ in what hardly matters, a place of a queue: one of them says all.
    points.dedup_by(|later, kept| later.1.cost() < (1.0 + APART) * kept.1.cost());
    if !holds {
        points = vec![(best, first)];
    }
    let frames: Vec<usize> = (0..evaluator.subject.frames.len()).collect();
    let mut found = Vec::new();
    for (point, reached) in points.into_iter().take(MOST_ANSWERS) {
        let choice = search.choice(point)?;
        let mut reached = reached.clone();
        if searched.len() < frames.len() {
            let costs = evaluator.on_all_frames(&choice)?;
            for frame in frames.iter().filter(|frame| !searched.contains(frame)) {
                let error = evaluator.error(&choice.variant, &[*frame])?;
                let one = evaluator.reached(&choice, error, &costs[*frame..=*frame]);
                if holds && found.is_empty() && !are_held(limits, &one) {
                    return Ok(Err(*frame));
                }
            }
            let error = evaluator.error(&choice.variant, &frames)?;
            reached = evaluator.reached(&choice, error, &costs);
        }
        // The cheapest point holds on every frame, and with that over all of them.
        if holds && !found.is_empty() && !are_held(limits, &reached) {
            continue;
        }
        found.push(Found {
            point: point.clone(),
            design: choice.variant.design.resolved(),
            machine: choice.machine,
            reached,
        });
    }
    let first = found.first().context("the first point was found")?;
    let standing = |(place, limit): (usize, &Limit)| {
        let value = limit.quantity.of(&first.reached).unwrap_or(f64::NAN);
        let all = search.known.values().flatten();
        let without = all.filter(|other| missed(limits, Some(place), other) <= 0.0);
        let simulated = without.map(Reached::cost).min_by(f64::total_cmp);
        let drawn = if limit.quantity.is_error() {
            search.cost_without_error(&first.machine, place)
        } else {
            None
        };
        Standing {
            limit: limit.clone(),
            value,
            slack: limit.slack(value),
            cost_without: simulated.into_iter().chain(drawn).min_by(f64::total_cmp),
            missed_alone: missed_alone[place],
        }
    };
    let answer = Answer {
        holds,
        standings: limits.iter().enumerate().map(standing).collect(),
        points: search.known.values().flatten().count(),
        designs: search.designs(),
        looked_at: search.known.values().flatten().cloned().collect(),
        searched_designs: !search.split_axes().0.is_empty(),
        found,
        ..Answer::default()
    };
    Ok(Ok(answer))
}

#[cfg(test)]
#[path = "answer_tests.rs"]
pub(super) mod tests;
