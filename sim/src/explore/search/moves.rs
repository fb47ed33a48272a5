//! Moves: coordinate descent from several machines, and two fields at once where one alone gains nothing.
//!
//! A field of the machine is tried at every value. A width is lowered by bisection to the least that holds the limits
//! on errors, because each trial draws pictures: widths interact weakly, each one's rounding adds its own part to the
//! error. Dear bits come first, and rounds repeat until none can be lowered. Where no single field gains anything, one
//! is moved up a step and another down: a lane less for a row more at once is a gain that neither shows alone.

use super::{Judge, Search, compare};
use crate::explore::space::{Point, SpaceAxis, SpacePart};
use anyhow::Result;
use splatline::format::WIDTH_RANGES;

/// Machines drawn at random beside the ones that are known, from which the best are followed.
const RANDOM: usize = 32;

/// Of all machines to begin with, so many are followed.
const FOLLOWED: usize = 4;

/// The order in which widths are lowered: dear bits first (multipliers of setup, rows and lanes, then storage).
const LOWERING_ORDER: [&str; 13] = [
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

/// Fields of a machine that are exchanged for each other: those whose steps cost and gain most.
pub const EXCHANGED: [&str; 12] = [
    "tile_width",
    "tile_height",
    "lanes",
    "raster_units",
    "rows_at_once",
    "splat_cycles",
    "row_cycles",
    "setup_interval",
    "read_bandwidth",
    "write_bandwidth",
    "packet_cache",
    "row_fifo",
];

impl Search<'_> {
    /// The least index of a width up to the point's that holds the limits on errors.
    fn lowest_width(&mut self, point: &[usize], axis: usize) -> Result<Point> {
        let at = |index: usize| moved(point, axis, index);
        let (mut bad, mut good) = (0, point[axis]);
        while bad < good {
            let middle = bad + (good - bad) / 2;
            if self.holds_errors(&at(middle))? {
                good = middle
            } else {
                bad = middle + 1
            }
        }
        Ok(at(good))
    }

    /// Moves a point until a round of moves leaves it where it is.
    fn until_it_stays(
        &mut self,
        start: Point,
        mut round: impl FnMut(&mut Self, Point) -> Result<Point>,
    ) -> Result<Point> {
        let mut point = start;
        loop {
            let moved = round(self, point.clone())?;
            if moved == point {
                return Ok(point);
            }
            point = moved;
        }
    }

    /// Moves one field at a time until none gains anything.
    pub fn descend(&mut self, start: Point, axes: &[usize], judge: Judge) -> Result<Point> {
        self.until_it_stays(start, |search, mut point| {
            for axis in axes {
                let all = 0..search.space.axes[*axis].values.len();
                let others = all.filter(|index| *index != point[*axis]);
                let others: Vec<_> = others.map(|index| moved(&point, *axis, index)).collect();
                point = search.best(&point, &others, judge)?;
            }
            Ok(point)
        })
    }

    /// Moves one field at a time, and two where one gains nothing, until neither does.
    pub fn settle(&mut self, start: Point, axes: &[usize], judge: Judge) -> Result<Point> {
        self.until_it_stays(start, |search, point| {
            let point = search.descend(point, axes, judge)?;
            search.exchange(&point, axes, judge)
        })
    }

    /// Lowers one width at a time as far as the limits on errors allow, until none can be lowered; where `cheaper` asks
    /// for it, only if that gains area.
    pub fn lower_widths(&mut self, start: Point, widths: &[usize], cheaper: bool) -> Result<Point> {
        self.until_it_stays(start, |search, mut point| {
            for axis in widths {
                let lowest = search.lowest_width(&point, *axis)?;
                if !cheaper || search.cost(&lowest)? <= search.cost(&point)? {
                    point = lowest;
                }
            }
            Ok(point)
        })
    }

    /// One field up a step and another down, over all pairs: the best of what that gives.
    fn exchange(&mut self, point: &[usize], axes: &[usize], judge: Judge) -> Result<Point> {
        let dear = |axis: &&usize| EXCHANGED.contains(&self.space.axes[**axis].key.as_str());
        let axes: Vec<usize> = axes.iter().filter(dear).copied().collect();
        let mut moved = Vec::new();
        for up in &axes {
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
        self.best(point, &moved, judge)
    }

    /// A bit more of one width for as many less of another as the errors allow, if that is cheaper.
    fn exchange_widths(&mut self, point: &[usize], widths: &[usize]) -> Result<Point> {
        let cost = self.cost(point)?;
        for up in widths {
            let Some(raised) = step(self, point, *up, 1) else {
                continue;
            };
            for down in widths.iter().filter(|down| *down != up) {
                // One bit less at least: what does not hold the limits then is not bisected.
                let Some(lowered) = step(self, &raised, *down, -1) else {
                    continue;
                };
                if self.cost(&lowered)? >= cost || !self.holds_errors(&lowered)? {
                    continue;
                }
                return self.lowest_width(&lowered, *down);
            }
        }
        Ok(point.to_vec())
    }

    /// Widths as small as the limits on errors allow; all of them untouched if there are none.
    fn narrow(&mut self, start: Point, widths: &[usize]) -> Result<Point> {
        self.until_it_stays(start, |search, point| {
            let point = search.lower_widths(point, widths, true)?;
            search.exchange_widths(&point, widths)
        })
    }

    /// The whole search from a point whose design holds the limits on errors, if there are any.
    pub fn search(&mut self, start: Point, judge: Judge) -> Result<Point> {
        let (widths, mut others) = self.split_axes();
        if !self.has_error_limit() && !self.by_bounds {
            // Without a limit widths are fields as all others.
            others.extend(&widths);
        }
        let mut point = if self.has_error_limit() {
            self.lower_widths(start, &widths, true)?
        } else {
            start
        };
        let mut beginnings = self.beginnings(&point, &others);
        self.evaluate(&beginnings)?;
        beginnings.sort_by(|a, b| compare(&self.scored(a, judge), &self.scored(b, judge)));
        beginnings.truncate(FOLLOWED);
        beginnings.push(point.clone());
        let mut ends = Vec::new();
        for beginning in beginnings {
            ends.push(self.settle(beginning, &others, judge)?);
        }
        for end in ends {
            point = self.better(point, end, judge)?;
        }
        self.until_it_stays(point, |search, mut point| {
            if search.has_error_limit() {
                let narrowed = search.narrow(point.clone(), &widths)?;
                let narrowed = search.descend(narrowed, &others, judge)?;
                point = search.better(point, narrowed, judge)?;
            }
            search.settle(point, &others, judge)
        })
    }

    /// Widths, the dearest bits first; and all other axes.
    pub fn split_axes(&self) -> (Vec<usize>, Vec<usize>) {
        let axes = &self.space.axes;
        let width = |name: &str| {
            let place = axes
                .iter()
                .position(|axis| axis.part == SpacePart::Design && axis.key == name);
            place.filter(|place| is_width(&axes[*place]))
        };
        let widths: Vec<usize> = LOWERING_ORDER.into_iter().filter_map(width).collect();
        let others = (0..axes.len()).filter(|axis| !widths.contains(axis));
        (widths.clone(), others.collect())
    }

    /// The point's own machine, and others of which each field is drawn by chance, always the same ones.
    fn beginnings(&self, point: &[usize], machines: &[usize]) -> Vec<Point> {
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
}

/// Is it a width, from narrow to wide?
fn is_width(axis: &SpaceAxis) -> bool {
    let named = WIDTH_RANGES.iter().any(|(name, ..)| *name == axis.key);
    let bits = axis.values.iter().filter_map(toml::Value::as_integer);
    axis.part == SpacePart::Design && named && bits.is_sorted()
}

/// A field one step up or down its axis.
fn step(search: &Search, point: &[usize], axis: usize, by: isize) -> Option<Point> {
    let index = point[axis].checked_add_signed(by)?;
    (index < search.space.axes[axis].values.len()).then(|| moved(point, axis, index))
}

/// The point with another value of a field.
fn moved(point: &[usize], axis: usize, index: usize) -> Point {
    let mut moved = point.to_vec();
    moved[axis] = index;
    moved
}
