//! The sweep's table: one CSV line per finished point, written as soon as it is known.
//!
//! A line is appended in one write ([`super::folder`]), so an interrupted sweep leaves at most one broken last line,
//! which reading drops and going on cuts off. What is read is checked against the space and against each row's digest:
//! a point that is not there, an axis with another value and fields that were edited were not written by this sweep,
//! and would be drawn as if they were.
//!
//! Fields are quoted as RFC 4180 has it, since an axis may name a file; one that a spreadsheet would take for a formula
//! has a `'` before it.

use super::evaluator::{DesignError, ErrorDetail, Reached};
use super::space::Space;
use crate::digest::Digest;
use std::collections::BTreeMap;

/// The last column: tells whether its row is as it was written.
pub const ROW_DIGEST: &str = "row_digest";

/// Hexadecimal digits of a row's digest.
const DIGEST_DIGITS: usize = 16;

/// A result's column: its name, and its field of a point.
pub type ResultColumn = (&'static str, fn(&Reached) -> String);

/// Columns behind the axes. Of several frames cycles, pace and bytes are those of the slowest, energy is that of the
/// dearest, errors are over all. Area is that of the raster units, of what is around them, and all of it in look-up
/// tables; energy is that of a picture. `clock_assumed` is 1 where nobody gave the clock (`crate::machine::clock`).
/// Fields about errors are empty without references.
#[rustfmt::skip]
pub const RESULTS: [ResultColumn; 36] = [
    ("psnr_db", |p| error(p, |e| finite(e.psnr_db()))),
    ("rms", |p| error(p, |e| exponent(e.rms))),
    ("max_abs", |p| error(p, |e| exponent(e.max_abs))),
    ("bias", |p| error(p, |e| exponent(e.bias))),
    ("ssim", |p| detail(p, |d| format!("{:.6}", d.ssim))),
    ("p95", |p| detail(p, |d| exponent(d.percentiles.p95))),
    ("p99", |p| detail(p, |d| exponent(d.percentiles.p99))),
    ("flip", |p| detail(p, |d| exponent(d.flip))),
    ("cycles", |p| p.slowest.cycles[3].to_string()),
    ("geometry", |p| p.slowest.cycles[0].to_string()),
    ("sort", |p| p.slowest.cycles[1].to_string()),
    ("raster", |p| p.slowest.cycles[2].to_string()),
    ("lanes_busy", |p| places(p.slowest.lanes[0])),
    ("covered_per_cycle_and_lane", |p| places(p.slowest.lanes[1])),
    ("live_per_cycle_and_lane", |p| places(p.slowest.lanes[2])),
    ("clock_mhz", |p| p.pace.clock.mhz.to_string()),
    ("clock_assumed", |p| u8::from(p.pace.clock.assumed).to_string()),
    ("frames_per_s", |p| format!("{:.3}", p.pace.frames_per_s)),
    ("ms_per_frame", |p| places(p.pace.ms_per_frame)),
    ("ms_per_frame_95", |p| places(p.ms_per_frame.percentile_95)),
    ("ms_per_frame_mean", |p| places(p.ms_per_frame.mean)),
    ("frames", |p| p.frames.to_string()),
    ("bytes_per_frame", |p| p.pace.bytes_per_frame.to_string()),
    ("bytes_per_s", |p| format!("{:.0}", p.pace.bytes_per_s)),
    ("packet_hit_rate", |p| places(p.slowest.packet_hit_rate)),
    ("raster_luts", |p| p.area.raster.luts.to_string()),
    ("raster_flip_flops", |p| p.area.raster.flip_flops.to_string()),
    ("raster_dsps", |p| p.area.raster.dsps.to_string()),
    ("raster_memory_kbit", |p| p.area.raster.memory_kbit.to_string()),
    ("around_luts", |p| p.area.around.luts.to_string()),
    ("around_flip_flops", |p| p.area.around.flip_flops.to_string()),
    ("around_dsps", |p| p.area.around.dsps.to_string()),
    ("around_memory_kbit", |p| p.area.around.memory_kbit.to_string()),
    ("area", |p| format!("{:.0}", p.area.weight)),
    ("energy_mj", |p| format!("{:.5}", p.millijoules)),
    ("left_out", |_| String::new()),
];

/// A field about errors.
fn error(point: &Reached, show: fn(&DesignError) -> String) -> String {
    point.error.as_ref().map_or_else(String::new, show)
}

fn detail(point: &Reached, show: fn(&ErrorDetail) -> String) -> String {
    let detail = point.error.map(|error| error.detail.unwrap_or_default());
    detail.as_ref().map_or_else(String::new, show)
}

/// Equal pictures have no PSNR.
fn finite(psnr_db: f64) -> String {
    if psnr_db.is_finite() {
        format!("{psnr_db:.3}")
    } else {
        String::new()
    }
}

fn exponent(value: f64) -> String {
    format!("{value:.4e}")
}

fn places(value: f64) -> String {
    format!("{value:.4}")
}

/// The heading for a space.
pub fn heading(space: &Space) -> Vec<String> {
    let axes = space.axes.iter().map(|axis| axis.key.as_str());
    let results = RESULTS.map(|(name, _)| name);
    let names = std::iter::once("point").chain(axes).chain(results);
    names.chain([ROW_DIGEST]).map(str::to_owned).collect()
}

/// Fields as a line of a table, with its end.
pub fn to_line(fields: &[String]) -> String {
    let quoted = |field: &String| {
        let mark = if is_formula(field) { "'" } else { "" };
        if field.contains([',', '"', '\n', '\r']) {
            format!("\"{mark}{}\"", field.replace('"', "\"\""))
        } else {
            format!("{mark}{field}")
        }
    };
    let fields: Vec<String> = fields.iter().map(quoted).collect();
    fields.join(",") + "\n"
}

/// Would a spreadsheet calculate this? What begins with the mark itself counts too, so that reading takes off no other
/// one.
fn is_formula(field: &str) -> bool {
    field.starts_with(['=', '+', '-', '@', '\'', '\t']) && field.parse::<f64>().is_err()
}

/// The digest of a row's fields.
pub fn row_digest(fields: &[String]) -> String {
    let mut digest = Digest::default();
    fields
        .iter()
        .for_each(|field| digest.piece(field.as_bytes()));
    let mut text = digest.finish();
    text.truncate(DIGEST_DIGITS);
    text
}

/// Up to where a table's text has whole lines: an interruption may have cut the last one, in a quoted field as well.
pub fn whole_lines(text: &str) -> usize {
    let (mut quoted, mut end) = (false, 0);
    for (place, byte) in text.bytes().enumerate() {
        match byte {
            b'"' => quoted = !quoted,
            b'\n' if !quoted => end = place + 1,
            _ => {}
        }
    }
    end
}

/// Rows by the number of their point.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ResultTable {
    /// Names of the columns.
    pub heading: Vec<String>,
    /// A point's fields, the first of them its number.
    pub rows: BTreeMap<usize, Vec<String>>,
}

impl ResultTable {
    /// Why points were left out, in their order.
    pub fn left_out(&self) -> impl Iterator<Item = &str> {
        let column = self.column("left_out");
        let reasons = self.rows.values().filter_map(move |row| row.get(column?));
        reasons
            .map(String::as_str)
            .filter(|reason| !reason.is_empty())
    }

    /// Reads the text of a table; a last line without its end is dropped. Without a whole line it is the table of a
    /// sweep that was interrupted before it began, which has no heading and no points.
    pub fn from_csv(text: &str) -> Result<ResultTable, String> {
        let whole = &text[..whole_lines(text)];
        let mut reader = csv::ReaderBuilder::new();
        let reader = reader.has_headers(false).flexible(true);
        let mut table = ResultTable::default();
        for record in reader.from_reader(whole.as_bytes()).records() {
            let record = record.map_err(|error| error.to_string())?;
            let line = record.position().map_or(1, csv::Position::line);
            let unmarked = |field: &str| field.strip_prefix('\'').unwrap_or(field).to_owned();
            let fields: Vec<String> = record.iter().map(unmarked).collect();
            if table.heading.is_empty() {
                if fields.len() < 2 || fields[0] != "point" {
                    return Err(format!(
                        "line {line}: not a table of a sweep: its first column must be 'point'"
                    ));
                }
                table.heading = fields;
                continue;
            }
            let columns = table.heading.len();
            let point = fields[0].parse().ok();
            let Some(point) = point.filter(|_| fields.len() == columns) else {
                return Err(format!(
                    "line {line}: expected {columns} fields, the first of them a point's number"
                ));
            };
            if table.rows.insert(point, fields).is_some() {
                return Err(format!(
                    "line {line}: point {point} a second time: remove one of its lines"
                ));
            }
        }
        Ok(table)
    }

    /// The same as text, sorted by point.
    pub fn to_csv(&self) -> String {
        let lines = std::iter::once(&self.heading).chain(self.rows.values());
        lines.map(|fields| to_line(fields)).collect()
    }

    /// Is this a table over that space, with rows as they were written? The message names point and column.
    pub fn check(&self, space: &Space) -> Result<(), String> {
        if self.heading.is_empty() {
            return Ok(());
        }
        let expected = heading(space);
        if self.heading != expected {
            return Err(format!(
                "line 1: the columns are not those of this sweep, which are {}",
                expected.join(",")
            ));
        }
        for (point, fields) in &self.rows {
            let problem = |problem: String| {
                format!(
                    "point {point}: {problem}: remove its line, and the sweep computes it again"
                )
            };
            let Some(indices) = space.points.get(*point) else {
                let last = space.points.len().saturating_sub(1);
                return Err(problem(format!("the space has points 0 to {last} only")));
            };
            let (row, digest) = fields.split_at(fields.len() - 1);
            let axes = space.axes.iter().zip(&row[1..]);
            for ((axis, found), expected) in axes.zip(space.texts(indices)) {
                if *found != expected {
                    let key = &axis.key;
                    return Err(problem(format!(
                        "{key} is '{found}', in the space it is '{expected}'"
                    )));
                }
            }
            if digest[0] != row_digest(row) {
                return Err(problem(format!(
                    "{ROW_DIGEST} is not that of its fields, which were edited"
                )));
            }
        }
        Ok(())
    }

    /// Place of a column.
    pub fn column(&self, name: &str) -> Option<usize> {
        self.heading.iter().position(|column| column == name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_table_is_refused() {
        for (text, expected) in [
            ("a,b\n1,2\n", "line 1: not a table of a sweep"),
            ("point,a\n1\n", "line 2"),
            ("point,a\n1,x\n1,x\n", "line 3: point 1 a second time"),
        ] {
            let message = ResultTable::from_csv(text).unwrap_err();
            assert!(message.contains(expected), "{message}");
        }
        let no_heading = ResultTable::from_csv("poi").unwrap();
        assert_eq!(no_heading, ResultTable::default(), "no points");
    }

    #[test]
    fn no_field_is_a_formula_to_a_spreadsheet() {
        let fields = [
            "0",
            "=cmd.toml",
            "+a",
            "-b,c",
            "@d",
            "'e",
            "-1.5",
            "+2e3",
            "-inf",
        ];
        let fields = fields.map(str::to_owned);
        let line = to_line(&fields);
        assert_eq!(line, "0,'=cmd.toml,'+a,\"'-b,c\",'@d,''e,-1.5,+2e3,-inf\n");
        let heading = ["point", "a", "b", "c", "d", "e", "f", "g", "h"].map(str::to_owned);
        let table = ResultTable::from_csv(&(to_line(&heading) + &line)).unwrap();
        assert_eq!(table.rows[&0], fields, "read as it was");
    }

    const SPACE: &str = "[machine]\nlanes = [1, 2]\nlayout = [\"run\", \"rows\"]\n";
    const SOUND: &str = "20.5,1e-3,2e-2,-1e-5,0.99,1e-3,1e-2,1e-4,1,2,3,4,0.5,0.5,0.5,81.7,1,60.5,16.5,16.4,16.3,2,1000,2e6,0.5,1,2,3,4,5,6,7,8,900,0.25,";

    fn space() -> Space {
        Space::from_toml("s.toml", SPACE).unwrap()
    }

    /// A row's fields and their digest.
    fn row(line: &str) -> Vec<String> {
        let mut fields: Vec<String> = line.split(',').map(str::to_owned).collect();
        fields.push(row_digest(&fields));
        fields
    }

    /// A table of the space with one row.
    fn table(row: &[String]) -> ResultTable {
        ResultTable::from_csv(&(to_line(&heading(&space())) + &to_line(row))).unwrap()
    }

    /// What lies at another place of the space, or was edited: a better result would change the front.
    #[test]
    fn rows_that_this_sweep_did_not_write_are_refused() {
        let sound = row(&format!("1,1,rows,{SOUND}"));
        let checked = |row: &[String]| table(row).check(&space());
        checked(&sound).unwrap();
        checked(&row(&format!("1,1,rows,{}quads", ",".repeat(35)))).unwrap();
        let mut edited = sound.clone();
        edited[table(&sound).column("cycles").unwrap()] = "0".to_owned();
        for (row, expected) in [
            (
                row(&format!("1,2,rows,{SOUND}")),
                "lanes is '2', in the space it is '1'",
            ),
            (row(&format!("4,1,rows,{SOUND}")), "points 0 to 3 only"),
            (edited, "point 1: row_digest"),
        ] {
            let message = checked(&row).unwrap_err();
            assert!(message.contains(expected), "{message}");
        }
    }

    /// A design's file may have any name, and an interruption may cut it anywhere.
    #[test]
    fn names_with_commas_quotes_and_line_breaks_are_read_back() {
        let text = "[design]\nbase = [\"a,b.toml\", \"say \\\"x\\\"\\n.toml\"]\n";
        let space = Space::from_toml("s.toml", text).unwrap();
        let mut csv = to_line(&heading(&space));
        for (number, point) in space.points.iter().enumerate() {
            let mut fields = vec![number.to_string()];
            fields.extend(space.texts(point));
            fields.extend(SOUND.split(',').map(str::to_owned));
            fields.push(row_digest(&fields));
            csv += &to_line(&fields);
        }
        let table = ResultTable::from_csv(&csv).unwrap();
        table.check(&space).unwrap();
        assert_eq!((table.rows.len(), table.to_csv()), (2, csv.clone()));
        for end in 0..csv.len() {
            let cut = ResultTable::from_csv(&csv[..end]).unwrap();
            assert!(cut.rows.len() < 2, "{end}");
            cut.check(&space).unwrap();
        }
    }
}
