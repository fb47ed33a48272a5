//! The sweep's table: one CSV line per finished point, written as soon as it is known.
//!
//! A line is appended in one write ([`super::folder`]), so an interrupted sweep leaves at most one broken last line,
//! which reading drops and going on cuts off. What is read is checked against the space and against each row's digest:
//! a point that is not there, an axis with another value, a result that is no number or that was edited were not
//! written by this sweep, and would be drawn as if they were.
//!
//! Fields are quoted as RFC 4180 has it, since an axis may name a file; one that a spreadsheet would take for a formula
//! has a `'` before it.

use super::evaluator::{DesignError, ErrorDetail, Reached};
use super::space::Space;
use crate::digest::Digest;
use ColumnKind::{Count, Nothing, Number, NumberOrNothing, Positive};
use std::collections::BTreeMap;

/// The last column: tells whether its row is as it was written.
pub const ROW_DIGEST: &str = "row_digest";

/// Hexadecimal digits of a row's digest.
const DIGEST_DIGITS: usize = 16;

/// A result's column: its name, what its fields may hold, and its field of a point.
pub type ResultColumn = (&'static str, ColumnKind, fn(&Reached) -> String);

/// Columns behind the axes. Of several frames cycles, pace and bytes are those of the slowest, energy is that of the
/// dearest, errors are over all. Area is that of the raster units, of what is around them, and all of it in look-up
/// tables; energy is that of a picture. `clock_assumed` is 1 where nobody gave the clock (`crate::machine::clock`).
#[rustfmt::skip]
pub const RESULTS: [ResultColumn; 36] = [
    ("psnr_db", NumberOrNothing, |p| error(p, |e| finite(e.psnr_db()))),
    ("rms", Positive, |p| error(p, |e| exponent(e.rms))),
    ("max_abs", Positive, |p| error(p, |e| exponent(e.max_abs))),
    ("bias", Number, |p| error(p, |e| exponent(e.bias))),
    ("ssim", Number, |p| detail(p, |d| format!("{:.6}", d.ssim))),
    ("p95", Positive, |p| detail(p, |d| exponent(d.percentiles.p95))),
    ("p99", Positive, |p| detail(p, |d| exponent(d.percentiles.p99))),
    ("flip", Positive, |p| detail(p, |d| exponent(d.flip))),
    ("cycles", Count, |p| p.slowest.cycles[3].to_string()),
    ("geometry", Count, |p| p.slowest.cycles[0].to_string()),
    ("sort", Count, |p| p.slowest.cycles[1].to_string()),
    ("raster", Count, |p| p.slowest.cycles[2].to_string()),
    ("lanes_busy", Positive, |p| places(p.slowest.lanes[0])),
    ("covered_per_cycle_and_lane", Positive, |p| places(p.slowest.lanes[1])),
    ("live_per_cycle_and_lane", Positive, |p| places(p.slowest.lanes[2])),
    ("clock_mhz", Positive, |p| p.pace.clock.mhz.to_string()),
    ("clock_assumed", Count, |p| u8::from(p.pace.clock.assumed).to_string()),
    ("frames_per_s", Positive, |p| format!("{:.3}", p.pace.frames_per_s)),
    ("ms_per_frame", Positive, |p| places(p.pace.ms_per_frame)),
    ("ms_per_frame_95", Positive, |p| places(p.ms_per_frame.percentile_95)),
    ("ms_per_frame_mean", Positive, |p| places(p.ms_per_frame.mean)),
    ("frames", Count, |p| p.frames.to_string()),
    ("bytes_per_frame", Count, |p| p.pace.bytes_per_frame.to_string()),
    ("bytes_per_s", Positive, |p| format!("{:.0}", p.pace.bytes_per_s)),
    ("packet_hit_rate", Positive, |p| places(p.slowest.packet_hit_rate)),
    ("raster_luts", Count, |p| p.area.raster.luts.to_string()),
    ("raster_flip_flops", Count, |p| p.area.raster.flip_flops.to_string()),
    ("raster_dsps", Count, |p| p.area.raster.dsps.to_string()),
    ("raster_memory_kbit", Count, |p| p.area.raster.memory_kbit.to_string()),
    ("around_luts", Count, |p| p.area.around.luts.to_string()),
    ("around_flip_flops", Count, |p| p.area.around.flip_flops.to_string()),
    ("around_dsps", Count, |p| p.area.around.dsps.to_string()),
    ("around_memory_kbit", Count, |p| p.area.around.memory_kbit.to_string()),
    ("area", Positive, |p| format!("{:.0}", p.area.weight)),
    ("energy_mj", Positive, |p| format!("{:.5}", p.millijoules)),
    ("left_out", Nothing, |_| String::new()),
];

/// The first ones are about errors, and empty without references.
pub const ERRORS: usize = 8;

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
    let results = RESULTS.map(|(name, ..)| name);
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

    /// Is this a table over that space, with errors or without? The message names point and column.
    pub fn check(&self, space: &Space, errors: bool) -> Result<(), String> {
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
            let (axes, results) = row[1..].split_at(space.axes.len());
            for ((axis, found), expected) in space.axes.iter().zip(axes).zip(space.texts(indices)) {
                if *found != expected {
                    let key = &axis.key;
                    return Err(problem(format!(
                        "{key} is '{found}', in the space it is '{expected}'"
                    )));
                }
            }
            check_results(results, errors).map_err(problem)?;
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

/// Are these the results of a point, in the order of [`RESULTS`]?
fn check_results(results: &[String], errors: bool) -> Result<(), String> {
    let Some((reason, numbers)) = results.split_last() else {
        return Ok(());
    };
    for (place, ((name, kind, _), text)) in RESULTS.iter().zip(numbers).enumerate() {
        let empty = !reason.is_empty() || (place < ERRORS && !errors);
        let kind = if empty { Nothing } else { *kind };
        if !kind.allows(text) {
            return Err(format!("{name} is '{text}', expected {}", kind.name()));
        }
    }
    Ok(())
}

/// What a field may hold.
#[derive(Clone, Copy)]
pub enum ColumnKind {
    /// Nothing at all.
    Nothing,
    /// A number.
    Number,
    /// The same, or nothing: equal pictures have no PSNR.
    NumberOrNothing,
    /// A number, 0 or more.
    Positive,
    /// A whole number.
    Count,
}

impl ColumnKind {
    fn allows(self, text: &str) -> bool {
        let number = text.parse::<f64>().ok().filter(|value| value.is_finite());
        match self {
            Nothing => text.is_empty(),
            Number => number.is_some(),
            NumberOrNothing => text.is_empty() || number.is_some(),
            Positive => number.is_some_and(|value| value >= 0.0),
            Count => text.parse::<u64>().is_ok(),
        }
    }

    fn name(self) -> &'static str {
        match self {
            Nothing => "nothing",
            Number => "a finite number",
            NumberOrNothing => "a finite number or nothing",
            Positive => "a finite number, 0 or more",
            Count => "a whole number, 0 or more",
        }
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

    fn checked(line: &str, errors: bool) -> Result<(), String> {
        table(&row(line)).check(&space(), errors)
    }

    /// Whatever result is replaced by what no sweep writes, the point and the column are named.
    #[test]
    fn values_that_no_sweep_writes_are_refused() {
        checked(&format!("1,1,rows,{SOUND}"), true).unwrap();
        checked(&format!("1,1,rows,{}{}quads", ",".repeat(34), ","), true).unwrap();
        let columns = RESULTS.len() - 1;
        for (column, (name, ..)) in RESULTS.iter().enumerate().take(columns) {
            for wrong in ["NaN", "inf", "text", "1e999", "--1", " "] {
                let mut fields: Vec<&str> = SOUND.split(',').collect();
                fields[column] = wrong;
                let message = checked(&format!("1,1,rows,{}", fields.join(",")), true).unwrap_err();
                let named = message.contains("point 1:") && message.contains(name);
                assert!(named, "{message}");
            }
        }
        for (line, errors, expected) in [
            (
                format!("1,1,rows,{SOUND}"),
                false,
                "psnr_db is '20.5', expected nothing",
            ),
            (
                format!("1,2,rows,{SOUND}"),
                true,
                "lanes is '2', in the space it is '1'",
            ),
            (format!("4,1,rows,{SOUND}"), true, "points 0 to 3 only"),
            (format!("1,1,rows,{SOUND}why"), true, "expected nothing"),
        ] {
            let message = checked(&line, errors).unwrap_err();
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
        table.check(&space, true).unwrap();
        assert_eq!((table.rows.len(), table.to_csv()), (2, csv.clone()));
        for end in 0..csv.len() {
            let cut = ResultTable::from_csv(&csv[..end]).unwrap();
            assert!(cut.rows.len() < 2, "{end}");
            cut.check(&space, true).unwrap();
        }
    }

    /// A better result that somebody wrote into a row would change the front.
    #[test]
    fn an_edited_result_is_refused() {
        let mut fields = row(&format!("1,1,rows,{SOUND}"));
        table(&fields).check(&space(), true).unwrap();
        let cycles = table(&fields).column("cycles").unwrap();
        fields[cycles] = "0".to_owned();
        let message = table(&fields).check(&space(), true).unwrap_err();
        assert!(message.contains("point 1: row_digest"), "{message}");
    }
}
