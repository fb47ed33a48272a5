//! The space of a sweep: which fields take which values, and how points are drawn from it.
//!
//! ```toml
//! sample = "grid"            # or "latin": a Latin hypercube of `count` points
//! count = 200
//! seed = 1
//!
//! [design]                   # any key of a design file
//! base = ["lean18", "standard24"]
//! mantissa = { from = 14, to = 24, step = 2 }
//!
//! [machine]                  # any key of a machine file
//! lanes = [1, 2, 4]
//! layout = ["run", "rows"]
//! ```

use crate::input::{Refused, line_of};
use crate::machine::config::{known, setting};
use crate::scene::synthetic::Random;
use serde::Deserialize;
use splatline::format::WIDTH_RANGES;
use std::fmt::Display;
use std::num::NonZero;
use toml::Value;

/// Most points of a sweep, so that a slip of the finger does not ask for years.
pub const MOST_POINTS: usize = 1_000_000;

/// Most values of a range.
const MOST_VALUES: usize = 10_000;

/// What an axis changes. The order is that of cost: points are sorted so that dear work is shared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum SpacePart {
    /// A key of the design file: another picture.
    Design,
    /// The machine's tile: another workload.
    Tile,
    /// The lanes' shape: another grouping.
    Lanes,
    /// Anything else of the machine.
    Machine,
}

/// One field and its values.
#[derive(Clone, Debug, PartialEq)]
pub struct SpaceAxis {
    /// What it changes.
    pub part: SpacePart,
    /// The field's key.
    pub key: String,
    /// Its values.
    pub values: Vec<Value>,
}

/// An index into each axis's values.
pub type Point = Vec<usize>;

/// Axes and points.
#[derive(Clone, Debug, PartialEq)]
pub struct Space {
    /// The axes, dearest first.
    pub axes: Vec<SpaceAxis>,
    /// The points in their order.
    pub points: Vec<Point>,
}

struct TableSource<'a> {
    file: &'a str,
    text: &'a str,
}

impl TableSource<'_> {
    fn wrong(&self, section: &str, key: &str, problem: impl Display) -> Refused {
        let line = match section {
            "" => line_of(self.text, &[key]),
            _ => line_of(self.text, &[section, key]),
        };
        Refused(format!("{}:{line}: {key}: {problem}", self.file))
    }
}

impl Space {
    /// Reads a space from the text of its file.
    pub fn from_toml(file: &str, text: &str) -> Result<Space, Refused> {
        let (axes, table) = Space::read(file, text)?;
        let points = points(&TableSource { file, text }, &table, &axes)?;
        Ok(Space { axes, points })
    }

    /// The same without points: what is searched and not swept may have any number of combinations.
    pub fn without_points(file: &str, text: &str) -> Result<Space, Refused> {
        let (axes, _) = Space::read(file, text)?;
        let points = Vec::new();
        Ok(Space { axes, points })
    }

    fn read(file: &str, text: &str) -> Result<(Vec<SpaceAxis>, toml::Table), Refused> {
        let source = TableSource { file, text };
        let table: toml::Table = text
            .parse()
            .map_err(|error: toml::de::Error| source.wrong("", "TOML", error.to_string()))?;
        let mut axes = Vec::new();
        for (key, value) in &table {
            match (key.as_str(), value) {
                ("sample" | "count" | "seed", _) => {}
                ("design" | "machine", Value::Table(fields)) => {
                    for (name, values) in fields {
                        axes.push(axis(&source, key, name, values)?);
                    }
                }
                _ => {
                    return Err(source.wrong(
                        "",
                        key,
                        "unknown: allowed are sample, count, seed, [design] and [machine]",
                    ));
                }
            }
        }
        axes.sort_by_key(|axis| axis.part);
        Ok((axes, table))
    }

    /// A point's keys and values on the axes of some parts.
    pub fn settings(
        &self,
        point: &[usize],
        parts: impl Fn(SpacePart) -> bool,
    ) -> Vec<(&str, &Value)> {
        let axes = self.axes.iter().zip(point);
        let chosen = axes.filter(|(axis, _)| parts(axis.part));
        let settings = chosen.map(|(axis, index)| (axis.key.as_str(), &axis.values[*index]));
        settings.collect()
    }

    /// A point's values as its table's line has them.
    pub fn texts<'a>(&'a self, point: &'a [usize]) -> impl Iterator<Item = String> + 'a {
        let values = self.axes.iter().zip(point);
        values.map(|(axis, index)| match &axis.values[*index] {
            Value::String(text) => text.clone(),
            value => value.to_string(),
        })
    }
}

fn axis(
    source: &TableSource,
    section: &str,
    key: &str,
    values: &Value,
) -> Result<SpaceAxis, Refused> {
    let wrong = |problem: String| source.wrong(section, key, problem);
    let values = match values {
        Value::Array(list) if !list.is_empty() => list.clone(),
        Value::Array(_) => return Err(wrong("the list is empty".to_owned())),
        Value::Table(range) => numbers(range).map_err(wrong)?,
        single => vec![single.clone()],
    };
    let part = if section == "design" {
        check_design(key, &values).map_err(wrong)?;
        SpacePart::Design
    } else {
        let none = || wrong(format!("no such field of a machine: {}", known("")));
        let setting = setting(key).ok_or_else(none)?;
        if setting.key == "sort_every" {
            let problem = "no point of a space keeps an order: `simulate` with a --camera-path and --set sort_every=N does";
            return Err(wrong(problem.to_owned()));
        }
        check_all(&values, |value| setting.accepts(value), &setting.allowed()).map_err(wrong)?;
        match setting.key.as_str() {
            "tile_width" | "tile_height" => SpacePart::Tile,
            "lanes" | "layout" | "pixel_termination" | "binning" => SpacePart::Lanes,
            _ => SpacePart::Machine,
        }
    };
    Ok(SpaceAxis {
        part,
        key: key.to_owned(),
        values,
    })
}

/// Refuses the first value that is not accepted.
fn check_all(
    values: &[Value],
    accepts: impl Fn(&Value) -> bool,
    allowed: &str,
) -> Result<(), String> {
    match values.iter().find(|value| !accepts(value)) {
        Some(value) => Err(format!("{value} is not allowed: {allowed}")),
        None => Ok(()),
    }
}

fn check_design(key: &str, values: &[Value]) -> Result<(), String> {
    if let Some((_, low, high)) = WIDTH_RANGES.iter().find(|(name, ..)| *name == key) {
        let range = i64::from(*low)..=i64::from(*high);
        let accepts = |value: &Value| value.as_integer().is_some_and(|n| range.contains(&n));
        return check_all(values, accepts, &format!("allowed are {low} to {high}"));
    }
    let names: &[&str] = match key {
        "base" => &crate::design::NAMES,
        "rounding" => &["nearest", "nearest-even", "truncate"],
        "traversal" => &["box", "spans"],
        _ => {
            let widths = WIDTH_RANGES.map(|(name, ..)| name).join(", ");
            return Err(format!(
                "no such field of a design: there are base, rounding, traversal, {widths}"
            ));
        }
    };
    // A design's file is as good as a name: what `fit` found is one.
    let known = |name: &str| names.contains(&name) || (key == "base" && name.ends_with(".toml"));
    let accepts = |value: &Value| value.as_str().is_some_and(known);
    let mut allowed = format!("allowed are {}", names.join(", "));
    if key == "base" {
        allowed += " and files that end in .toml";
    }
    check_all(values, accepts, &allowed)
}

/// `{ from, to, step }`, both ends included.
fn numbers(range: &toml::Table) -> Result<Vec<Value>, String> {
    const FORM: &str = "a range is { from = a, to = b, step = s } with whole numbers, a <= b and s > 0 (1 if left out)";
    #[derive(Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Range {
        from: i32,
        to: i32,
        step: Option<NonZero<u32>>,
    }
    let (from, to, step) = match range.clone().try_into() {
        Ok(Range { from, to, step }) if from <= to => (i64::from(from), i64::from(to), step),
        _ => return Err(FORM.to_owned()),
    };
    let values = (from..=to).step_by(step.map_or(1, |step| step.get() as usize));
    match values.size_hint() {
        (count, _) if count > MOST_VALUES => Err(format!(
            "the range has {count} values, allowed are {MOST_VALUES}"
        )),
        _ => Ok(values.map(Value::Integer).collect()),
    }
}

fn points(
    source: &TableSource,
    table: &toml::Table,
    axes: &[SpaceAxis],
) -> Result<Vec<Point>, Refused> {
    let integer = |key: &str, usual: i64| match table.get(key) {
        None => Ok(usual),
        Some(value) => value
            .as_integer()
            .filter(|n| *n >= 0)
            .ok_or_else(|| source.wrong("", key, "must be a whole number, 0 or more")),
    };
    let (count, seed) = (integer("count", 100)? as usize, integer("seed", 1)? as u64);
    let mut all = axes.iter().map(|axis| axis.values.len());
    let all = all.try_fold(1usize, |all, values| all.checked_mul(values));
    let sample = table.get("sample").map_or(Some("grid"), Value::as_str);
    let mut points = match (sample, all.filter(|all| *all <= MOST_POINTS)) {
        (Some("grid"), Some(all)) => grid(axes, all),
        (Some("grid"), None) => {
            let problem = format!("the grid has more than {MOST_POINTS} points: use \"latin\"");
            return Err(source.wrong("", "sample", problem));
        }
        (Some("latin"), _) if (1..=MOST_POINTS).contains(&count) => latin(axes, count, seed),
        (Some("latin"), _) => {
            return Err(source.wrong("", "count", format!("allowed are 1 to {MOST_POINTS}")));
        }
        _ => return Err(source.wrong("", "sample", "allowed are \"grid\" and \"latin\"")),
    };
    points.sort();
    Ok(points)
}

fn grid(axes: &[SpaceAxis], all: usize) -> Vec<Point> {
    let point = |mut number: usize| {
        let digit = |axis: &SpaceAxis| {
            let digit = number % axis.values.len();
            number /= axis.values.len();
            digit
        };
        axes.iter().map(digit).collect()
    };
    (0..all).map(point).collect()
}

/// Every axis is cut into `count` strata, each of which one point falls into.
fn latin(axes: &[SpaceAxis], count: usize, seed: u64) -> Vec<Point> {
    let mut random = Random(seed);
    let mut points = vec![Vec::with_capacity(axes.len()); count];
    for axis in axes {
        let mut strata: Vec<usize> = (0..count).collect();
        for last in (1..count).rev() {
            strata.swap(last, (random.next() % (last as u64 + 1)) as usize);
        }
        for (point, stratum) in points.iter_mut().zip(strata) {
            point.push(stratum * axis.values.len() / count);
        }
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_grid_has_every_combination_once_and_dear_axes_first() {
        let text = "[machine]\nlanes = [1, 2]\nlatency = { from = 0, to = 20, step = 10 }\n[design]\nmantissa = 20\n";
        let space = Space::from_toml("s.toml", text).unwrap();
        let keys: Vec<&str> = space.axes.iter().map(|axis| axis.key.as_str()).collect();
        assert_eq!(keys, ["mantissa", "lanes", "latency"]);
        let expected: Vec<Vec<usize>> = (0..6).map(|n| vec![0, n / 3, n % 3]).collect();
        assert_eq!(space.points, expected);
    }

    #[test]
    fn a_latin_hypercube_meets_every_value_equally_often() {
        let text = "sample = \"latin\"\ncount = 12\n[machine]\nlanes = [1, 2, 4]\nrow_fifo = [2, 4, 8, 16]\n";
        let space = Space::from_toml("s.toml", text).unwrap();
        for (axis, each) in [(0, 4), (1, 3)] {
            for value in 0..space.axes[axis].values.len() {
                let there = space.points.iter().filter(|point| point[axis] == value);
                assert_eq!(there.count(), each);
            }
        }
        let other = Space::from_toml("s.toml", &format!("seed = 2\n{text}")).unwrap();
        assert_ne!(space.points, other.points);
    }

    #[test]
    fn errors_name_key_line_and_range() {
        let message = |text: &str| Space::from_toml("s.toml", text).unwrap_err().to_string();
        assert_eq!(
            message("[machine]\nlanes = [1, 3]\n"),
            "s.toml:2: lanes: 3 is not allowed: allowed are 1, 2, 4, 8, 16, 32, 64"
        );
        assert_eq!(
            message("\n[design]\nmantissa = [40]\n"),
            "s.toml:3: mantissa: 40 is not allowed: allowed are 8 to 31"
        );
        let range = |from: i64, to: i64, step: i64| {
            format!("[machine]\nlatency = {{ from = {from}, to = {to}, step = {step} }}\n")
        };
        let far = [
            (i64::MIN, i64::MAX, 1),
            (i64::MIN, i64::MAX, i64::MAX),
            (-1, i64::MAX, 1),
            (0, i64::MAX, i64::MAX),
        ]
        .map(|(from, to, step)| (range(from, to, step), "s.toml:2: latency: "));
        let texts = [
            ("[design]\nbase = [\"x\"]\n", "classic8"),
            ("[machine]\nlane = 1\n", "s.toml:2: lane: no such field"),
            (
                "[machine]\nsort_every = [1, 4]\n",
                "s.toml:2: sort_every: no point",
            ),
            ("[machine]\nlatency = { from = 9, to = 1 }\n", "a range is"),
            ("samples = 3\n", "allowed are sample"),
            ("sample = \"latin\"\ncount = 0\n", "s.toml:2: count"),
        ];
        let texts = texts.map(|(text, expected)| (text.to_owned(), expected));
        for (text, expected) in texts.into_iter().chain(far) {
            let message = message(&text);
            assert!(message.contains(expected), "{message}");
        }
    }
}
