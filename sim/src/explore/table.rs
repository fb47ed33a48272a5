//! The sweep's table: one CSV line per finished point, written as soon as it is known.
//!
//! A line is appended in one write and flushed, so an interrupted sweep leaves at most one broken last line, which reading drops and
//! going on cuts off.

use super::space::Space;
use crate::atomic;
use std::collections::BTreeMap;
use std::fs::{File, OpenOptions};
use std::io::{self, Write};
use std::path::Path;
use std::sync::Mutex;

/// Columns behind the axes. Area is that of the raster units, of what is around them, and all of it in look-up tables.
pub const RESULTS: [&str; 22] = [
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
    "raster_luts",
    "raster_flip_flops",
    "raster_dsps",
    "raster_memory_kbit",
    "around_luts",
    "around_flip_flops",
    "around_dsps",
    "around_memory_kbit",
    "area",
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
pub struct Table {
    /// The heading.
    pub heading: String,
    /// Whole lines, each beginning with its point's number.
    pub lines: BTreeMap<usize, String>,
}

impl Table {
    /// Reads the text of a table; a last line without its end is dropped.
    pub fn from_csv(text: &str) -> Result<Table, String> {
        let whole = text.rfind('\n').map_or("", |end| &text[..end]);
        let mut lines = whole.lines();
        let heading = lines.next().unwrap_or("").to_owned();
        if !heading.starts_with("point,") {
            return Err(
                "line 1: not a table of a sweep: its first column must be 'point'".to_owned(),
            );
        }
        let columns = heading.split(',').count();
        let mut table = Table {
            heading,
            lines: BTreeMap::new(),
        };
        for (number, line) in lines.enumerate() {
            let point = line.split(',').next().and_then(|point| point.parse().ok());
            match point {
                Some(point) if line.split(',').count() == columns => {
                    table.lines.insert(point, line.to_owned());
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

    /// Adds the lines of another shard. The same point may come twice only with the same result.
    pub fn merge(&mut self, other: Table) -> Result<(), String> {
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

/// Appends lines from any thread.
pub struct Appender(Mutex<File>);

impl Appender {
    /// Opens the file, which is made with its heading if need be; cuts off a broken last line.
    pub fn open(path: &Path, heading: &str) -> io::Result<Appender> {
        let text = if path.exists() {
            std::fs::read_to_string(path)?
        } else {
            String::new()
        };
        let whole = text.rfind('\n').map_or(0, |end| end as u64 + 1);
        if whole == 0 {
            // A table that exists has its heading, whenever the sweep is interrupted.
            atomic::write(path, format!("{heading}\n").as_bytes())?;
        }
        let file = OpenOptions::new().append(true).open(path)?;
        if whole > 0 {
            file.set_len(whole)?;
        }
        Ok(Appender(Mutex::new(file)))
    }

    /// Appends one line.
    pub fn append(&self, line: &str) -> io::Result<()> {
        let mut file = self
            .0
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner);
        file.write_all(format!("{line}\n").as_bytes())?;
        file.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_broken_last_line_is_dropped_and_overwritten() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("points.csv");
        std::fs::write(&path, "point,a\n0,5\n1,").unwrap();
        let table = Table::from_csv(&std::fs::read_to_string(&path).unwrap()).unwrap();
        assert_eq!(table.lines.keys().collect::<Vec<_>>(), [&0]);
        Appender::open(&path, "point,a")
            .unwrap()
            .append("1,6")
            .unwrap();
        assert_eq!(
            std::fs::read_to_string(&path).unwrap(),
            "point,a\n0,5\n1,6\n"
        );
    }

    /// Whatever byte an interruption cuts the table at, the sweep goes on with the whole lines, and ends with the same table.
    #[test]
    fn a_table_cut_anywhere_is_continued() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("points.csv");
        let (heading, lines) = ("point,a", ["0,5", "1,16", "2,270"]);
        let whole = format!("{heading}\n{}\n", lines.join("\n"));
        for length in heading.len() + 1..=whole.len() {
            std::fs::write(&path, &whole[..length]).unwrap();
            let done = Table::from_csv(&std::fs::read_to_string(&path).unwrap()).unwrap();
            let out = Appender::open(&path, heading).unwrap();
            for (point, line) in lines.iter().enumerate() {
                match done.lines.get(&point) {
                    Some(kept) => assert_eq!(kept, line, "cut at {length}"),
                    None => out.append(line).unwrap(),
                }
            }
            assert_eq!(std::fs::read_to_string(&path).unwrap(), whole, "{length}");
        }
    }

    #[test]
    fn a_new_table_has_its_heading() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("points.csv");
        Appender::open(&path, "point,a").unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "point,a\n");
    }

    #[test]
    fn shards_merge_and_foreign_tables_do_not() {
        let mut first = Table::from_csv("point,a\n2,x\n0,y\n").unwrap();
        first
            .merge(Table::from_csv("point,a\n1,z\n2,x\n").unwrap())
            .unwrap();
        assert_eq!(first.to_csv(), "point,a\n0,y\n1,z\n2,x\n");
        assert!(first.merge(Table::from_csv("point,b\n").unwrap()).is_err());
        assert!(
            first
                .merge(Table::from_csv("point,a\n1,q\n").unwrap())
                .unwrap_err()
                .contains("point 1")
        );
        assert!(
            Table::from_csv("a,b\n1,2\n").is_err()
                && Table::from_csv("point,a\n1\n")
                    .unwrap_err()
                    .contains("line 2")
        );
    }
}
