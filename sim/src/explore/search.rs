//! The search: points that are known by what they reach, and [`moves`] from one to the next.
//!
//! A point is better if it misses its limits by less, and among points that hold them if it costs less.

use super::cache::Cache;
use super::evaluator::{DesignError, Evaluator, Reached, work_key};
use super::limits::{Limit, are_held};
use super::space::{Point, Space, SpacePart};
use super::subject::Choice;
use crate::machine::area::lane::fixed_lane;
use crate::plan::DesignVariant;
use anyhow::Result;
use std::cmp::Ordering;
use std::collections::BTreeMap;

mod moves;

pub use moves::EXCHANGED;

/// What a point is judged by, the first number first; less is better.
pub type Score = [f64; 3];

/// Judges what a point reaches.
pub type Judge<'a> = &'a dyn Fn(&Reached) -> Score;

/// Points evaluated at a time: each may hold rows of its own.
const BATCH: usize = 24;

/// Points of a move that are evaluated before it is asked again which others could still be better.
const AT_ONCE: usize = 4;

/// Lexicographic.
pub fn compare(a: &Score, b: &Score) -> Ordering {
    let mut orders = a.iter().zip(b).map(|(a, b)| a.total_cmp(b));
    orders
        .find(|order| order.is_ne())
        .unwrap_or(Ordering::Equal)
}

/// A search over the points of a space.
pub struct Search<'a> {
    /// Evaluates points.
    pub evaluator: &'a Evaluator,
    /// Where points come from.
    pub space: &'a Space,
    /// What is to be held.
    pub limits: &'a [Limit],
    /// What has been evaluated; nothing for what makes no design or no machine.
    pub known: BTreeMap<Point, Option<Reached>>,
    /// Is a point judged by what it could reach at best, without a drawing and a simulation?
    by_bounds: bool,
    /// Every design that was drawn, with its errors.
    drawn: Vec<(Choice, DesignError)>,
    /// Those that a few tiles were enough to refuse.
    refused: Vec<Choice>,
    /// Designs by their places on the axes.
    designs: Cache<Vec<usize>, DesignVariant>,
    frames: Vec<usize>,
    simulated: usize,
    progress: &'a (dyn Fn(&str) + Sync),
}

impl<'a> Search<'a> {
    /// A search on some frames; `progress` is given what is being done.
    pub fn new(
        evaluator: &'a Evaluator,
        space: &'a Space,
        limits: &'a [Limit],
        frames: Vec<usize>,
        progress: &'a (dyn Fn(&str) + Sync),
    ) -> Search<'a> {
        Search {
            evaluator,
            space,
            limits,
            known: BTreeMap::new(),
            by_bounds: false,
            drawn: Vec::new(),
            refused: Vec::new(),
            designs: Cache::of_all(),
            frames,
            simulated: 0,
            progress,
        }
    }

    /// The same search over what points could reach at best: it draws and simulates nothing, and ends where no point of
    /// the space can be better.
    pub fn of_bounds<'b>(&self, limits: &'b [Limit]) -> Search<'b>
    where
        'a: 'b,
    {
        let frames = self.frames.clone();
        Search {
            by_bounds: true,
            ..Search::new(self.evaluator, self.space, limits, frames, self.progress)
        }
    }

    /// The design and the machine of a point.
    pub fn choice(&self, point: &[usize]) -> Result<Choice> {
        let (space, subject) = (self.space, &self.evaluator.subject);
        let axes = space.axes.iter().zip(point);
        let of_design = axes.filter(|(axis, _)| axis.part == SpacePart::Design);
        let places = of_design.map(|(_, index)| *index).collect();
        let variant = self.designs.get(places, || subject.variant(space, point))?;
        let machine = subject.machine(space, point)?;
        Ok(Choice { variant, machine })
    }

    /// What a choice could reach at best on the frames that are searched.
    pub fn at_best(&self, choice: &Choice) -> Result<Reached> {
        self.evaluator.at_best(choice, &self.frames)
    }

    /// Designs drawn, or so much of them as refused them.
    pub fn designs(&self) -> usize {
        self.drawn.len() + self.refused.len()
    }

    /// PSNR and transistors a lane of the designs that were drawn whole.
    pub fn drawn_lanes(&self) -> Vec<[f64; 2]> {
        let prices = &self.evaluator.subject.calibration;
        let lane = |(choice, error): &(Choice, DesignError)| {
            let units = fixed_lane(&choice.variant.design.widths, prices);
            [error.psnr_db(), units.transistors as f64]
        };
        self.drawn.iter().map(lane).collect()
    }

    /// Says what is being done, after how much, and what the best so far costs.
    fn tell(&self, what: &str, left: usize) {
        let holds = |reached: &&Reached| are_held(self.limits, reached);
        let held = self.known.values().flatten().filter(holds);
        let best = held.map(Reached::cost).min_by(f64::total_cmp);
        let best = best.map_or("none holds all limits yet".to_owned(), |cost| {
            format!("best so far {cost:.0} LUT in all")
        });
        let left = if left > 0 {
            format!(", {left} left in this step")
        } else {
            String::new()
        };
        (self.progress)(&format!(
            "{what}: {} designs drawn, {} machines simulated{left}; {best}",
            self.designs(),
            self.simulated
        ));
    }

    /// The errors of a design; nothing without references.
    fn design_error(&mut self, choice: &Choice) -> Result<Option<DesignError>> {
        if self.by_bounds {
            return Ok(Some(DesignError::none()));
        }
        let mut drawn = self.drawn.iter();
        if let Some((_, error)) = drawn.find(|(other, _)| other.draws_as(choice)) {
            return Ok(Some(*error));
        }
        let error = self.evaluator.error(&choice.variant, &self.frames)?;
        if let Some(error) = error {
            self.drawn.push((choice.clone(), error));
            self.tell("drawing", 0);
        }
        Ok(error)
    }

    /// The errors of a point's design.
    pub fn error(&mut self, point: &[usize]) -> Result<Option<DesignError>> {
        let choice = self.choice(point)?;
        self.design_error(&choice)
    }

    /// Are the limits on errors held? Where a few tiles miss them, the rest is not drawn.
    fn holds_errors(&mut self, point: &[usize]) -> Result<bool> {
        let Some(choice) = Choice::designed(self.choice(point))? else {
            return Ok(false);
        };
        if self.refused.iter().any(|other| other.draws_as(&choice)) {
            return Ok(false);
        }
        if !self.drawn.iter().any(|(other, _)| other.draws_as(&choice)) {
            let least = self.evaluator.least_error(&choice.variant, &self.frames)?;
            if least.is_some() && self.excess_of(least) > 0.0 {
                self.refused.push(choice);
                self.tell("drawing", 0);
                return Ok(false);
            }
        }
        Ok(self.error_excess(point)? <= 0.0)
    }

    /// By how much the limits on errors are missed, in sum.
    pub fn error_excess(&mut self, point: &[usize]) -> Result<f64> {
        let error = self.error(point)?;
        Ok(self.excess_of(error))
    }

    fn excess_of(&self, error: Option<DesignError>) -> f64 {
        let errors = self.limits.iter().filter(|limit| limit.quantity.is_error());
        errors.map(|limit| limit.excess_of_error(error)).sum()
    }

    /// The least cost of a design that was drawn, on this machine, if one of the limits on errors did not hold: such
    /// designs are drawn and not simulated.
    pub fn cost_without_error(&self, machine: &crate::machine::Config, but: usize) -> Option<f64> {
        let all = self.limits.iter().enumerate();
        let errors = all.filter(|(_, limit)| limit.quantity.is_error());
        let holds = |error: DesignError| {
            let mut others = errors.clone().filter(|(place, _)| *place != but);
            others.all(|(_, limit)| limit.excess_of_error(Some(error)) <= 0.0)
        };
        let held = self.drawn.iter().filter(|(_, error)| holds(*error));
        // What was refused misses this limit if it is the only one on errors; else nobody knows.
        let only = errors.clone().count() == 1;
        let refused = self.refused.iter().filter(|_| only);
        let cost = |choice: &Choice| {
            let machine = *machine;
            let variant = choice.variant.clone();
            self.evaluator.area(&Choice { variant, machine }).weight
        };
        let all = held.map(|(choice, _)| choice).chain(refused);
        all.map(cost).min_by(f64::total_cmp)
    }

    /// Evaluates points, side by side.
    pub fn evaluate(&mut self, points: &[Point]) -> Result<()> {
        let mut open: Vec<(Point, Choice)> = Vec::new();
        for point in points {
            let listed = open.iter().any(|(other, _)| other == point);
            if self.known.contains_key(point) || listed {
                continue;
            }
            let Some(choice) = Choice::possible(self.choice(point))? else {
                self.known.insert(point.clone(), None);
                continue;
            };
            if self.by_bounds {
                let reached = self.at_best(&choice)?;
                self.known.insert(point.clone(), Some(reached));
            } else {
                open.push((point.clone(), choice));
            }
        }
        // By rows, so that what is thrown out is not needed again at once.
        open.sort_by_cached_key(|(_, choice)| work_key(choice));
        let all = open.len();
        for (number, batch) in open.chunks(BATCH).enumerate() {
            self.tell("simulating", all - number * BATCH);
            self.evaluate_batch(batch)?;
        }
        Ok(())
    }

    fn evaluate_batch(&mut self, batch: &[(Point, Choice)]) -> Result<()> {
        let mut errors = Vec::with_capacity(batch.len());
        for (_, choice) in batch {
            errors.push(self.design_error(choice)?);
        }
        let (points, choices): (Vec<_>, Vec<_>) = batch.iter().cloned().unzip();
        let costs = self.evaluator.costs(&choices, &self.frames, true)?;
        for (place, (point, costs)) in points.into_iter().zip(costs).enumerate() {
            let (choice, error) = (&choices[place], errors[place]);
            let reached = self.evaluator.reached(choice, error, &costs);
            self.known.insert(point, Some(reached));
        }
        self.simulated += batch.len();
        Ok(())
    }

    /// The score of a point; infinite for what makes no design or no machine.
    fn score(&mut self, point: &[usize], judge: Judge) -> Result<Score> {
        self.evaluate(&[point.to_vec()])?;
        Ok(self.scored(point, judge))
    }

    /// The same of a point that has been evaluated.
    fn scored(&self, point: &[usize], judge: Judge) -> Score {
        let reached = self.known.get(point).and_then(Option::as_ref);
        reached.map_or([f64::INFINITY; 3], judge)
    }

    /// The best of these points and of the one at hand, which stays if none is better.
    ///
    /// Points are looked at in the order of what they could be at best, and those that cannot be better than what was
    /// found meanwhile are left out: of machines that hold the limits, all that are dearer than the first one.
    fn best(&mut self, at: &[usize], points: &[Point], judge: Judge) -> Result<Point> {
        let mut score = self.score(at, judge)?;
        let mut best = at.to_vec();
        let mut hopeful = Vec::new();
        for point in points {
            if let Some(choice) = Choice::possible(self.choice(point))? {
                let reached = self.at_best(&choice)?;
                hopeful.push((judge(&reached), point));
            }
        }
        hopeful.sort_by(|a, b| compare(&a.0, &b.0));
        for few in hopeful.chunks(AT_ONCE) {
            let better = few
                .iter()
                .filter(|(at_best, _)| compare(at_best, &score).is_lt());
            let better: Vec<Point> = better.map(|(_, point)| (*point).clone()).collect();
            self.evaluate(&better)?;
            for point in better {
                let found = self.scored(&point, judge);
                if compare(&found, &score).is_lt() {
                    (best, score) = (point, found);
                }
            }
        }
        Ok(best)
    }

    /// What a point costs, which needs no simulation; infinite for what makes no design.
    fn cost(&self, point: &[usize]) -> Result<f64> {
        let choice = Choice::designed(self.choice(point))?;
        Ok(choice.map_or(f64::INFINITY, |choice| self.evaluator.area(&choice).weight))
    }

    /// The better of two points; the second only if it is better.
    fn better(&mut self, a: Point, b: Point, judge: Judge) -> Result<Point> {
        let (score, other) = (self.score(&a, judge)?, self.score(&b, judge)?);
        Ok(if compare(&other, &score).is_lt() {
            b
        } else {
            a
        })
    }

    pub fn has_error_limit(&self) -> bool {
        self.limits.iter().any(|limit| limit.quantity.is_error())
    }
}
