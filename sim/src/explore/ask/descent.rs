//! The search: coordinate descent from several machines, and moves of two fields at once where one alone gains nothing.
//!
//! A point is better if it misses its limits by less, and among points that hold them if it costs less. A field of the machine is tried at every
//! value. A width is lowered by bisection to the least that holds the limits on errors, as `fit` does, because each trial draws pictures. Where no
//! single field gains anything, one is moved up a step and another down: a lane less for a row more at once is a gain that neither shows alone.

use super::evaluate::{Evaluator, Reached};
use crate::explore::space::{Axis, Part};
use anyhow::Result;
use splatline::format::WIDTH_RANGES;
use std::cmp::Ordering;

/// What a point is judged by, the first number first; less is better.
pub type Score = [f64; 3];

/// Judges what a point reaches.
pub type Judge<'a> = &'a dyn Fn(&Reached) -> Score;

/// Machines drawn at random beside the ones that are known, from which the best are followed.
const RANDOM: usize = 40;

/// Of all machines to begin with, so many are followed.
const FOLLOWED: usize = 3;

/// The order in which widths are lowered: those whose bits are dear first.
const ORDER: [&str; 13] = [
    "mantissa",
    "view",
    "position",
    "peak",
    "weight",
    "transmittance",
    "alpha",
    "accumulator",
    "interpolation",
    "table",
    "radial",
    "colour",
    "subpixel",
];

/// Lexicographic.
pub fn compare(a: &Score, b: &Score) -> Ordering {
    let pairs = a.iter().zip(b);
    pairs
        .map(|(a, b)| a.total_cmp(b))
        .find(|order| order.is_ne())
        .unwrap_or(Ordering::Equal)
}

impl Evaluator<'_> {
    /// The score of a point; infinite for what makes no machine.
    fn score(&mut self, point: &[usize], judge: Judge) -> Result<Score> {
        self.evaluate(&[point.to_vec()])?;
        Ok(self.scored(point, judge))
    }

    /// The same of a point that has been evaluated.
    fn scored(&self, point: &[usize], judge: Judge) -> Score {
        let reached = self.known.get(point).and_then(Option::as_ref);
        reached.map_or([f64::INFINITY; 3], judge)
    }

    /// The best of these points, which may be the first.
    fn best(&mut self, points: &[Vec<usize>], judge: Judge) -> Result<Vec<usize>> {
        self.evaluate(points)?;
        let first_best = (0..points.len()).min_by(|a, b| {
            let score = |place: &usize| self.scored(&points[*place], judge);
            compare(&score(a), &score(b))
        });
        Ok(points[first_best.unwrap_or(0)].clone())
    }

    /// Is `a` better than `b`?
    fn is_better(&mut self, a: &[usize], b: &[usize], judge: Judge) -> Result<bool> {
        let (a, b) = (self.score(a, judge)?, self.score(b, judge)?);
        Ok(compare(&a, &b).is_lt())
    }

    /// The least index of a width up to the point's that holds the limits on errors.
    fn lowest_width(&mut self, point: &[usize], axis: usize) -> Result<Vec<usize>> {
        let at = |index: usize| {
            let mut moved = point.to_vec();
            moved[axis] = index;
            moved
        };
        let (mut bad, mut good) = (0, point[axis]);
        while bad < good {
            let middle = bad + (good - bad) / 2;
            match self.error_excess(&at(middle))? <= 0.0 {
                true => good = middle,
                false => bad = middle + 1,
            }
        }
        Ok(at(good))
    }

    /// Moves one field at a time until none gains anything.
    pub fn descend(
        &mut self,
        start: Vec<usize>,
        axes: &[usize],
        judge: Judge,
    ) -> Result<Vec<usize>> {
        let mut point = start;
        loop {
            let before = point.clone();
            for axis in axes {
                let candidate = match is_width(&self.space.axes[*axis]) && self.has_error_limit() {
                    true => self.lowest_width(&point, *axis)?,
                    false => {
                        let all = values_of(self, &point, *axis);
                        self.best(&all, judge)?
                    }
                };
                if candidate != point && self.is_better(&candidate, &point, judge)? {
                    point = candidate;
                }
            }
            if point == before {
                return Ok(point);
            }
        }
    }

    /// One field up a step and another down, over all pairs: the best of what that gives.
    fn exchange(&mut self, point: &[usize], axes: &[usize], judge: Judge) -> Result<Vec<usize>> {
        let mut moved = vec![point.to_vec()];
        for up in axes {
            for down in axes.iter().filter(|down| *down != up) {
                for steps in [[1, -1], [1, 1], [-1, -1]] {
                    // Two fields the same way are one move, whichever is named first.
                    if steps[0] == steps[1] && up > down {
                        continue;
                    }
                    let first = step(self, point, *up, steps[0]);
                    let both = first.and_then(|first| step(self, &first, *down, steps[1]));
                    moved.extend(both);
                }
            }
        }
        self.best(&moved, judge)
    }

    /// Exchanges between widths: a bit more of one for as many less of another as the errors allow, if that is cheaper.
    fn exchange_widths(&mut self, point: &[usize], widths: &[usize], judge: Judge) -> Result<Vec<usize>> {
        for up in widths {
            let Some(raised) = step(self, point, *up, 1) else {
                continue;
            };
            for down in widths.iter().filter(|down| *down != up) {
                // One bit less at least: what does not hold the limits then is not bisected.
                let Some(lowered) = step(self, &raised, *down, -1) else {
                    continue;
                };
                if self.error_excess(&lowered)? > 0.0 {
                    continue;
                }
                let lowest = self.lowest_width(&lowered, *down)?;
                if self.is_better(&lowest, point, judge)? {
                    return Ok(lowest);
                }
            }
        }
        Ok(point.to_vec())
    }

    /// The whole search from a point whose design holds the limits on errors, if there are any.
    pub fn search(&mut self, start: Vec<usize>, judge: Judge) -> Result<Vec<usize>> {
        let (widths, others) = self.split_axes();
        let mut point = self.descend(start, &widths, judge)?;
        let machines: Vec<usize> = others.clone();
        let mut beginnings = self.beginnings(&point, &machines);
        self.evaluate(&beginnings)?;
        beginnings.sort_by(|a, b| compare(&self.scored(a, judge), &self.scored(b, judge)));
        beginnings.truncate(FOLLOWED);
        let mut ends = vec![point.clone()];
        for beginning in beginnings {
            ends.push(self.descend(beginning, &machines, judge)?);
        }
        point = self.best(&ends, judge)?;
        let all: Vec<usize> = widths.iter().chain(&others).copied().collect();
        loop {
            let before = point.clone();
            point = self.descend(point, &all, judge)?;
            point = self.exchange(&point, &machines, judge)?;
            if self.has_error_limit() {
                point = self.exchange_widths(&point, &widths, judge)?;
            }
            if point == before {
                return Ok(point);
            }
        }
    }

    /// Widths, the dearest bits first; and all other axes.
    pub fn split_axes(&self) -> (Vec<usize>, Vec<usize>) {
        let axes = &self.space.axes;
        let width = |name: &str| {
            let place = axes.iter().position(|axis| axis.part == Part::Design && axis.key == name);
            place.filter(|place| is_width(&axes[*place]))
        };
        let widths: Vec<usize> = ORDER.iter().filter_map(|name| width(name)).collect();
        let others = (0..axes.len()).filter(|axis| !widths.contains(axis));
        (widths.clone(), others.collect())
    }

    /// The point's own machine, and others of which each field is drawn by chance, always the same ones.
    fn beginnings(&self, point: &[usize], machines: &[usize]) -> Vec<Vec<usize>> {
        let mut state = 0x9e37_79b9_7f4a_7c15u64;
        let mut below = |count: usize| {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 33) as usize % count.max(1)
        };
        let mut all = vec![point.to_vec()];
        for _ in 0..RANDOM {
            let mut other = point.to_vec();
            for axis in machines {
                other[*axis] = below(self.space.axes[*axis].values.len());
            }
            all.push(other);
        }
        all
    }

    pub fn has_error_limit(&self) -> bool {
        let limits = &self.question.limits;
        limits.iter().any(|limit| limit.quantity.is_error())
    }
}

/// Is it a width, from narrow to wide?
fn is_width(axis: &Axis) -> bool {
    let named = WIDTH_RANGES.iter().any(|(name, ..)| *name == axis.key);
    let bits: Vec<i64> = axis.values.iter().filter_map(toml::Value::as_integer).collect();
    axis.part == Part::Design && named && bits.is_sorted()
}

fn values_of(evaluator: &Evaluator, point: &[usize], axis: usize) -> Vec<Vec<usize>> {
    let all = 0..evaluator.space.axes[axis].values.len();
    // The point itself comes first, so that equals change nothing.
    let others = all.filter(|index| *index != point[axis]);
    std::iter::once(point[axis])
        .chain(others)
        .map(|index| {
            let mut moved = point.to_vec();
            moved[axis] = index;
            moved
        })
        .collect()
}

/// A field one step up or down its axis.
fn step(evaluator: &Evaluator, point: &[usize], axis: usize, by: isize) -> Option<Vec<usize>> {
    let index = point[axis].checked_add_signed(by)?;
    (index < evaluator.space.axes[axis].values.len()).then(|| {
        let mut moved = point.to_vec();
        moved[axis] = index;
        moved
    })
}
