//! The sweep's table: one CSV line per finished point, written as soon as it is known.
//!
//! A line is appended in one write ([`super::folder`]), so an interrupted sweep leaves at most one broken last line, which reading drops and
//! going on cuts off. What is read is checked against the space: a point that is not there, an axis with another value, a result that is no
//! number were not written by this sweep, and would be drawn as if they were.

use super::space::Space;
use std::collections::BTreeMap;

/// Columns behind the axes. Of several frames cycles, pace and bytes are those of the slowest, energy is that of the dearest, errors are over all. Area is that of the raster units, of what is around them, and all of it in look-up tables; energy is that of a picture.
/// `clock_assumed` is 1 where nobody gave the clock (`crate::machine::clock`).
pub const RESULTS: [&str; 33] = [
    "psnr_db",
    "rms",
    "max_abs",
    "bias",
    "ssim",
    "cycles",
    "geometry",
    "sort",
    "raster",
    "lanes_busy",
    "covered_per_cycle_and_lane",
    "live_per_cycle_and_lane",
    "clock_mhz",
    "clock_assumed",
    "frames_per_s",
    "ms_per_frame",
    "ms_per_frame_95",
    "ms_per_frame_mean",
    "frames",
    "bytes_per_frame",
    "bytes_per_s",
    "packet_hit_rate",
    "raster_luts",
    "raster_flip_flops",
    "raster_dsps",
    "raster_memory_kbit",
    "around_luts",
    "around_flip_flops",
    "around_dsps",
    "around_memory_kbit",
    "area",
    "energy_mj",
    "left_out",
];

/// The heading for a space.
pub fn heading(space: &Space) -> String {
    let axes = space.axes.iter().map(|axis| axis.key.as_str());
    std::iter::once("point")
        .chain(axes)
        .chain(RESULTS)
        .collect::<Vec<_>>()
        .join(",")
}

/// Lines by the number of their point.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ResultTable {
    /// The heading.
    pub heading: String,
    /// Whole lines, each beginning with its point's number.
    pub lines: BTreeMap<usize, String>,
}

impl ResultTable {
    /// Reads the text of a table; a last line without its end is dropped. Without a whole line it is the table of a sweep that was
    /// interrupted before it began, which has no heading and no points.
    pub fn from_csv(text: &str) -> Result<ResultTable, String> {
        let Some(whole) = text.rfind('\n').map(|end| &text[..end]) else {
            return Ok(ResultTable::default());
        };
        let mut lines = whole.lines();
        let heading = lines.next().unwrap_or("").to_owned();
        if !heading.starts_with("point,") {
            return Err(
                "line 1: not a table of a sweep: its first column must be 'point'".to_owned(),
            );
        }
        let columns = heading.split(',').count();
        let mut table = ResultTable {
            heading,
            lines: BTreeMap::new(),
        };
        for (number, line) in lines.enumerate() {
            let point = line.split(',').next().and_then(|point| point.parse().ok());
            match point {
                Some(point) if line.split(',').count() == columns => {
                    if table.lines.insert(point, line.to_owned()).is_some() {
                        let line = number + 2;
                        return Err(format!(
                            "line {line}: point {point} a second time: remove one of its lines"
                        ));
                    }
                }
                _ => {
                    return Err(format!(
                        "line {}: expected {columns} fields, the first of them a point's number",
                        number + 2
                    ));
                }
            }
        }
        Ok(table)
    }

    /// The same as text, sorted by point.
    pub fn to_csv(&self) -> String {
        let mut text = format!("{}\n", self.heading);
        for line in self.lines.values() {
            text.push_str(line);
            text.push('\n');
        }
        text
    }

    /// Is this a table over that space, with errors or without? The message names point and column.
    pub fn check(&self, space: &Space, errors: bool) -> Result<(), String> {
        if self.heading.is_empty() {
            return Ok(());
        }
        let expected = heading(space);
        if self.heading != expected {
            return Err(format!(
                "line 1: the columns are not those of this sweep, which are {expected}"
            ));
        }
        for (point, line) in &self.lines {
            let fields: Vec<&str> = line.split(',').collect();
            let problem = |problem: String| {
                format!(
                    "point {point}: {problem}: remove its line, and the sweep computes it again"
                )
            };
            let Some(indices) = space.points.get(*point) else {
                let last = space.points.len().saturating_sub(1);
                return Err(problem(format!("the space has points 0 to {last} only")));
            };
            let (axes, results) = fields[1..].split_at(space.axes.len());
            for ((axis, found), expected) in space.axes.iter().zip(axes).zip(space.texts(indices)) {
                if *found != expected {
                    let key = &axis.key;
                    return Err(problem(format!(
                        "{key} is '{found}', in the space it is '{expected}'"
                    )));
                }
            }
            check_results(results, errors).map_err(problem)?;
        }
        Ok(())
    }

    /// Points of the space that it has no line for.
    pub fn missing(&self, space: &Space) -> usize {
        space.points.len() - self.lines.len().min(space.points.len())
    }

    /// Adds the lines of another shard. The same point may come twice only with the same result.
    pub fn merge(&mut self, other: ResultTable) -> Result<(), String> {
        if other.heading.is_empty() {
            return Ok(());
        }
        if self.heading.is_empty() {
            self.heading.clone_from(&other.heading);
        }
        if self.heading != other.heading {
            return Err(
                "the tables have different columns: they belong to different sweeps".to_owned(),
            );
        }
        for (point, line) in other.lines {
            if self
                .lines
                .get(&point)
                .is_some_and(|present| *present != line)
            {
                return Err(format!(
                    "point {point} has different results in two tables: they belong to different sweeps"
                ));
            }
            self.lines.insert(point, line);
        }
        Ok(())
    }

    /// Place of a column.
    pub fn column(&self, name: &str) -> Option<usize> {
        self.heading.split(',').position(|column| column == name)
    }
}

/// Are these the results of a point, in the order of [`RESULTS`]?
fn check_results(results: &[&str], errors: bool) -> Result<(), String> {
    let (reason, numbers) = results.split_last().unwrap_or((&"", &[]));
    for (name, text) in RESULTS.iter().zip(numbers) {
        let kind = match name {
            _ if !reason.is_empty() => ColumnKind::Nothing,
            // Equal pictures have none.
            &"psnr_db" if errors => ColumnKind::NumberOrNothing,
            &"psnr_db" | &"rms" | &"max_abs" | &"bias" | &"ssim" if !errors => ColumnKind::Nothing,
            &"bias" | &"ssim" => ColumnKind::Number,
            &"rms" | &"max_abs" | &"lanes_busy" | &"area" | &"energy_mj" => ColumnKind::Positive,
            &"clock_mhz" | &"frames_per_s" | &"bytes_per_s" | &"packet_hit_rate" => {
                ColumnKind::Positive
            }
            name if name.starts_with("ms_per_frame") => ColumnKind::Positive,
            name if name.ends_with("per_cycle_and_lane") => ColumnKind::Positive,
            _ => ColumnKind::Count,
        };
        if !kind.allows(text) {
            return Err(format!("{name} is '{text}', expected {}", kind.name()));
        }
    }
    Ok(())
}

/// What a field may hold.
#[derive(Clone, Copy)]
enum ColumnKind {
    Nothing,
    Number,
    NumberOrNothing,
    Positive,
    Count,
}

impl ColumnKind {
    fn allows(self, text: &str) -> bool {
        let number = text.parse::<f64>().ok().filter(|value| value.is_finite());
        match self {
            ColumnKind::Nothing => text.is_empty(),
            ColumnKind::Number => number.is_some(),
            ColumnKind::NumberOrNothing => text.is_empty() || number.is_some(),
            ColumnKind::Positive => number.is_some_and(|value| value >= 0.0),
            ColumnKind::Count => text.parse::<u64>().is_ok(),
        }
    }

    fn name(self) -> &'static str {
        match self {
            ColumnKind::Nothing => "nothing",
            ColumnKind::Number => "a finite number",
            ColumnKind::NumberOrNothing => "a finite number or nothing",
            ColumnKind::Positive => "a finite number, 0 or more",
            ColumnKind::Count => "a whole number, 0 or more",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_merge_and_foreign_tables_do_not() {
        let mut first = ResultTable::from_csv("point,a\n2,x\n0,y\n").unwrap();
        first
            .merge(ResultTable::from_csv("point,a\n1,z\n2,x\n").unwrap())
            .unwrap();
        assert_eq!(first.to_csv(), "point,a\n0,y\n1,z\n2,x\n");
        assert!(
            first
                .merge(ResultTable::from_csv("point,b\n").unwrap())
                .is_err()
        );
        assert!(
            first
                .merge(ResultTable::from_csv("point,a\n1,q\n").unwrap())
                .unwrap_err()
                .contains("point 1")
        );
        assert!(
            ResultTable::from_csv("a,b\n1,2\n").is_err()
                && ResultTable::from_csv("point,a\n1\n")
                    .unwrap_err()
                    .contains("line 2")
        );
    }

    #[test]
    fn a_point_twice_is_refused_and_no_heading_is_no_points() {
        let message = ResultTable::from_csv("point,a\n1,x\n1,x\n").unwrap_err();
        assert!(
            message.contains("line 3: point 1 a second time"),
            "{message}"
        );
        assert_eq!(
            ResultTable::from_csv("poi").unwrap(),
            ResultTable::default()
        );
    }

    const SPACE: &str = "[machine]\nlanes = [1, 2]\nlayout = [\"run\", \"rows\"]\n";
    const SOUND: &str = "20.5,1e-3,2e-2,-1e-5,0.99,1,2,3,4,0.5,0.5,0.5,81.7,1,60.5,16.5,16.4,16.3,2,1000,2e6,0.5,1,2,3,4,5,6,7,8,900,0.25,";

    fn checked(line: &str, errors: bool) -> Result<(), String> {
        let space = Space::from_toml("s.toml", SPACE).unwrap();
        ResultTable::from_csv(&format!("{}\n{line}\n", heading(&space)))?.check(&space, errors)
    }

    /// Whatever result is replaced by what no sweep writes, the point and the column are named.
    #[test]
    fn values_that_no_sweep_writes_are_refused() {
        checked(&format!("1,1,rows,{SOUND}"), true).unwrap();
        checked(&format!("1,1,rows,{}{}quads", ",".repeat(31), ","), true).unwrap();
        let columns = RESULTS.len() - 1;
        for (column, name) in RESULTS.iter().enumerate().take(columns) {
            for wrong in ["NaN", "inf", "text", "1e999", "--1", " "] {
                let mut fields: Vec<&str> = SOUND.split(',').collect();
                fields[column] = wrong;
                let message = checked(&format!("1,1,rows,{}", fields.join(",")), true).unwrap_err();
                assert!(
                    message.contains("point 1:") && message.contains(name),
                    "{message}"
                );
            }
        }
        let without_errors = checked(&format!("1,1,rows,{SOUND}"), false).unwrap_err();
        assert!(without_errors.contains("psnr_db is '20.5', expected nothing"));
        let message = |line: &str| checked(line, true).unwrap_err();
        assert!(
            message(&format!("1,2,rows,{SOUND}")).contains("lanes is '2', in the space it is '1'")
        );
        assert!(message(&format!("4,1,rows,{SOUND}")).contains("points 0 to 3 only"));
        assert!(message(&format!("1,1,rows,{SOUND}why")).contains("expected nothing"));
    }
}
