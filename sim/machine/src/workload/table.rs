//! A workload from a table of footprints: other people's rasterizers timed on this machine.
//!
//! CSV with a heading. Columns are found by name: `u,v,depth,conic_a,conic_b,conic_c,x0,y0,x1,y1` as
//! `splatline footprints` writes them, with `cutoff` (radial index at which the footprint ends; where it is missing or
//! empty the option's), and optionally `tiles` (numbers of the tiles, row by row, separated by spaces, that list the
//! footprint; else those that its box meets). A line with empty fields is a culled splat. Rows are computed in double
//! precision from r = a dx^2 + 2 b dx dy + c dy^2 < cutoff.
//!
//! With a column `opacity` pixels finish: a footprint takes opacity exp(-r/2), at most 0.999, of a pixel's light, and
//! one that has a ten-thousandth left is finished, as in 3D Gaussian splatting and EWA. Footprints without an opacity
//! take no light, so that nothing finishes.

use super::{Bins, Pair, TilePart, Workload, WorkloadRow, assemble, mask};
use crate::input::Refused;
use splatline::format::Traversal;
use splatline::raster::Window;

/// What a table does not say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TableOptions {
    /// Columns and rows of the screen; 0 takes the largest x1 and y1.
    pub viewport: [u16; 2],
    /// Columns (at most 64) and rows of a tile.
    pub tile: [u16; 2],
    /// Which pixels are visited.
    pub traversal: Traversal,
    /// Radial index at which a footprint without a cut-off of its own ends; none makes such a footprint an error.
    pub cutoff: Option<f64>,
    /// Bytes of a packet.
    pub packet_bytes: u32,
}

/// Rows of splat-tile pairs at most (24 bytes each), and tiles at most. Real pictures have a hundredth of it, while one
/// short line can ask for a billion: without a limit a small file would take all memory.
const LARGEST_WORK: u64 = 1 << 25;

/// Relative error of a coefficient with a mantissa of 8 bits.
const ROUNDED: f64 = 1.0 / 128.0;

/// Of a pixel's light a footprint takes at most this.
const MOST_TAKEN: f64 = 0.999;

/// A pixel with as much light left has finished.
const FINISHED: f64 = 1e-4;

/// One footprint of the table.
struct WorkTableEntry {
    splat: u32,
    centre: [f64; 2],
    depth: f64,
    conic: [f64; 3],
    cutoff: f64,
    opacity: Option<f64>,
    bounds: Window,
    tiles: Option<Vec<u32>>,
}

const COLUMNS: [&str; 10] = [
    "u", "v", "depth", "conic_a", "conic_b", "conic_c", "x0", "y0", "x1", "y1",
];

/// Reads the text of a table. Splats are drawn nearest first, ties by line.
pub fn read_table(text: &str, options: &TableOptions) -> Result<Workload, Refused> {
    let mut lines = text.lines();
    let heading = lines.next().unwrap_or("").split(',');
    let heading: Vec<&str> = heading.map(str::trim).collect();
    if let Some(name) = COLUMNS.iter().find(|name| !heading.contains(name)) {
        let expected = COLUMNS.join(",");
        return Err(Refused(format!(
            "line 1: no column '{name}': expected at least {expected}"
        )));
    }
    let mut entries = Vec::new();
    let mut splats = 0;
    let mut work = Work::default();
    for (line, text) in (2..).zip(lines).filter(|(_, text)| !text.trim().is_empty()) {
        let fields: Vec<&str> = text.split(',').map(str::trim).collect();
        let reader = TableReader {
            line,
            heading: &heading,
            fields: &fields,
        };
        if let Some(entry) = reader.entry(splats, options)? {
            work.add(&entry.bounds, options, line)?;
            entries.push(entry);
        }
        splats += 1;
    }
    entries.sort_by(|a, b| a.depth.total_cmp(&b.depth));
    Ok(workload(&entries, splats as usize, options))
}

/// What the entries read so far will take, counted before anything is made of them.
#[derive(Default)]
struct Work {
    rows: u64,
    last: [u16; 2],
}

impl Work {
    fn add(&mut self, bounds: &Window, options: &TableOptions, line: usize) -> Result<(), Refused> {
        let columns = (bounds.end[0] - 1) / options.tile[0] - bounds.first[0] / options.tile[0] + 1;
        self.rows += u64::from(columns) * u64::from(bounds.rows());
        let mut tiles = 1;
        for axis in [0, 1] {
            self.last[axis] = self.last[axis].max(bounds.end[axis]);
            tiles *= u64::from(self.last[axis].div_ceil(options.tile[axis]));
        }
        let rows = self.rows;
        if rows.max(tiles) <= LARGEST_WORK {
            return Ok(());
        }
        Err(Refused(format!(
            "line {line}: the boxes up to here have {rows} rows in tiles and {tiles} tiles, at most {LARGEST_WORK} each are modelled: \
             correct x0,y0,x1,y1, or give the screen's size"
        )))
    }
}

/// A line of the table.
struct TableReader<'a> {
    line: usize,
    heading: &'a [&'a str],
    fields: &'a [&'a str],
}

impl TableReader<'_> {
    /// What stands in a column; nothing where the table or the line has none.
    fn text(&self, column: &str) -> &str {
        let place = self.heading.iter().position(|name| *name == column);
        let field = place.and_then(|place| self.fields.get(place));
        field.copied().unwrap_or("")
    }

    fn wrong(&self, column: &str, value: &str, expected: &str) -> Refused {
        let line = self.line;
        Refused(format!("line {line}: {column} = '{value}': {expected}"))
    }

    fn number(&self, column: &str) -> Result<f64, Refused> {
        let text = self.text(column);
        match text.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(value),
            _ => Err(self.wrong(column, text, "expected a finite number")),
        }
    }

    fn pixel(&self, column: &str) -> Result<u16, Refused> {
        let text = self.text(column);
        let expected = "expected a whole number of pixels from 0 to 32768";
        let pixel = text.parse().ok().filter(|pixel| *pixel <= 32_768);
        pixel.ok_or_else(|| self.wrong(column, text, expected))
    }

    /// A number for which `holds`, from a column that may lack or be empty.
    fn optional(
        &self,
        [column, expected]: [&str; 2],
        holds: fn(f64) -> bool,
    ) -> Result<Option<f64>, Refused> {
        let text = self.text(column);
        match text.parse::<f64>() {
            _ if text.is_empty() => Ok(None),
            Ok(value) if value.is_finite() && holds(value) => Ok(Some(value)),
            _ => Err(self.wrong(column, text, expected)),
        }
    }

    fn entry(&self, splat: u32, options: &TableOptions) -> Result<Option<WorkTableEntry>, Refused> {
        if COLUMNS.iter().all(|column| self.text(column).is_empty()) {
            return Ok(None);
        }
        let mut bounds = Window {
            first: [self.pixel("x0")?, self.pixel("y0")?],
            end: [self.pixel("x1")?, self.pixel("y1")?],
        };
        for (end, limit) in bounds.end.iter_mut().zip(options.viewport) {
            if limit > 0 {
                *end = limit.min(*end);
            }
        }
        let entry = WorkTableEntry {
            splat,
            centre: [self.number("u")?, self.number("v")?],
            depth: self.number("depth")?,
            conic: self.conic()?,
            cutoff: self.cutoff(options)?,
            opacity: self.opacity()?,
            bounds,
            tiles: self.tiles()?,
        };
        Ok((!bounds.is_empty()).then_some(entry))
    }

    fn cutoff(&self, options: &TableOptions) -> Result<f64, Refused> {
        let column = ["cutoff", "expected a finite number above 0, or nothing"];
        let own = self.optional(column, |value| value > 0.0)?;
        // Any guess would give cycles of another picture.
        own.or(options.cutoff).ok_or_else(|| {
            Refused(format!(
                "line {}: no cut-off: the table has no column 'cutoff' (or an empty field in it); add it as `splatline footprints` \
                 writes it, or give --cutoff r (4 in ewa; 11.1 at most in 3dgs)",
                self.line
            ))
        })
    }

    fn opacity(&self) -> Result<Option<f64>, Refused> {
        let expected = "expected a finite number of 0 or more, or nothing";
        self.optional(["opacity", expected], |value| value >= 0.0)
    }

    /// The coefficients of an ellipse: with an indefinite form the footprint would grow towards the far corners.
    fn conic(&self) -> Result<[f64; 3], Refused> {
        let (a, b) = (self.number("conic_a")?, self.number("conic_b")?);
        let c = self.number("conic_c")?;
        // A needle's form has almost no determinant, and rounding to the narrowest mantissas (8 bits) may turn its
        // sign.
        let definite = a >= 0.0 && c >= 0.0 && b.abs() <= (a.sqrt() * c.sqrt()) * (1.0 + ROUNDED);
        let expected =
            "expected conic_a >= 0, conic_c >= 0 and conic_b^2 <= conic_a conic_c, an ellipse";
        let refused = || self.wrong("conic_b", self.text("conic_b"), expected);
        definite.then_some([a, b, c]).ok_or_else(refused)
    }

    fn tiles(&self) -> Result<Option<Vec<u32>>, Refused> {
        if !self.heading.contains(&"tiles") {
            return Ok(None);
        }
        let text = self.text("tiles");
        let numbers: Result<Vec<u32>, _> = text.split_whitespace().map(str::parse).collect();
        numbers
            .map(Some)
            .map_err(|_| self.wrong("tiles", text, "expected tile numbers separated by spaces"))
    }
}

fn workload(entries: &[WorkTableEntry], splats: usize, options: &TableOptions) -> Workload {
    let mut viewport = options.viewport;
    for (axis, size) in viewport.iter_mut().enumerate() {
        if *size == 0 {
            let ends = entries.iter().map(|entry| entry.bounds.end[axis]);
            *size = ends.max().unwrap_or(1);
        }
    }
    let boxes = entries.iter().map(|entry| entry.bounds);
    let bins = Bins::new((0..).zip(boxes), viewport, options.tile);
    let parts = (0..bins.lists.len()).map(|tile| {
        let listed = |entry: &&WorkTableEntry| {
            let tiles = entry.tiles.as_ref();
            tiles.is_none_or(|tiles| tiles.contains(&(tile as u32)))
        };
        let list = bins.lists[tile].iter();
        let list = list.map(|number| &entries[*number as usize]).filter(listed);
        tile_part(list, bins.grid.window(tile), options.traversal)
    });
    assemble(parts.collect(), &bins, splats, options.packet_bytes)
}

fn tile_part<'a>(
    list: impl Iterator<Item = &'a WorkTableEntry>,
    window: Window,
    traversal: Traversal,
) -> TilePart {
    let mut part = TilePart::default();
    let mut light = TileLight::new(&window);
    for entry in list {
        let visible = entry.bounds.intersect(&window);
        let (columns, [left, top]) = ([visible.first[0], visible.end[0]], window.first);
        let (start, rows) = (part.rows.len(), visible.first[1]..visible.end[1]);
        let row = |y| entry.row(y, columns, left, traversal);
        part.rows.extend(rows.clone().map(row));
        for (y, row) in rows.zip(&mut part.rows[start..]) {
            light.dim(entry, y, row);
        }
        part.pairs.push(Pair {
            splat: entry.splat,
            rows_end: part.rows.len() as u32,
            first_row: (visible.first[1] - top) as u8,
            visits: part.rows[start..].iter().any(|row| row.length > 0),
        });
        if part.finished_after.is_none() && light.is_finished() {
            part.finished_after = Some(part.pairs.len() as u32);
        }
    }
    part
}

/// What is left of the light of a tile's pixels.
struct TileLight {
    first: [u16; 2],
    left: Vec<[f64; 64]>,
    /// Pixels of each row that have finished, and all of a row.
    finished: Vec<u64>,
    whole: u64,
}

impl TileLight {
    fn new(window: &Window) -> TileLight {
        let rows = usize::from(window.rows());
        TileLight {
            first: window.first,
            left: vec![[1.0; 64]; rows],
            finished: vec![0; rows],
            whole: mask(0, window.columns().into()),
        }
    }

    /// A footprint's row takes light of open pixels; those that have finished before are not open to it.
    fn dim(&mut self, entry: &WorkTableEntry, y: u16, row: &mut WorkloadRow) {
        let place = usize::from(y - self.first[1]);
        row.open &= !self.finished[place];
        let Some(opacity) = entry.opacity else {
            return;
        };
        let mut open = row.covered & row.open;
        while open != 0 {
            let x = open.trailing_zeros();
            let radial = entry.radial(self.first[0] + x as u16, y);
            let left = &mut self.left[place][x as usize];
            *left *= 1.0 - (opacity * (-radial / 2.0).exp()).min(MOST_TAKEN);
            self.finished[place] |= u64::from(*left <= FINISHED) << x;
            open &= open - 1;
        }
    }

    fn is_finished(&self) -> bool {
        self.finished.iter().all(|row| *row == self.whole)
    }
}

impl WorkTableEntry {
    fn radial(&self, x: u16, y: u16) -> f64 {
        let [a, b, c] = self.conic;
        let dy = f64::from(y) + 0.5 - self.centre[1];
        let dx = f64::from(x) + 0.5 - self.centre[0];
        a * dx * dx + 2.0 * b * dx * dy + c * dy * dy
    }

    fn row(&self, y: u16, [from, to]: [u16; 2], origin: u16, traversal: Traversal) -> WorkloadRow {
        let covered = (from..to)
            .filter(|x| self.radial(*x, y) < self.cutoff)
            .fold(0u64, |all, x| all | 1 << (x - origin));
        let (first, last) = match traversal {
            Traversal::Box => (from - origin, to - origin),
            Traversal::Spans if covered == 0 => return WorkloadRow::default(),
            Traversal::Spans => (
                covered.trailing_zeros() as u16,
                64 - covered.leading_zeros() as u16,
            ),
        };
        let length = last - first;
        WorkloadRow {
            open: mask(first.into(), length.into()),
            covered,
            x: first as u8,
            length: length as u8,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const OPTIONS: TableOptions = TableOptions {
        viewport: [16, 8],
        tile: [8, 8],
        traversal: Traversal::Spans,
        cutoff: Some(4.0),
        packet_bytes: 40,
    };
    const HEADING: &str = "index,u,v,depth,conic_a,conic_b,conic_c,x0,y0,x1,y1";

    /// The rows as a picture: one letter per pair.
    fn picture(workload: &Workload) -> String {
        let mut text = String::new();
        for pair in 0..workload.pairs.len() {
            for row in workload.rows_of(pair) {
                let pixel = |x: u32| match (row.covered >> x & 1, row.visited() >> x & 1) {
                    (1, _) => '#',
                    (_, 1) => '.',
                    _ => ' ',
                };
                text.extend((0..8).map(pixel));
                text.push('|');
            }
            text.push('\n');
        }
        text
    }

    #[test]
    fn a_disc_of_radius_two_over_two_tiles() {
        let table = format!("{HEADING}\n0,8,4,1,1,0,1,6,2,10,6\n1,,,,,,,,,,\n");
        let spans = read_table(&table, &OPTIONS).unwrap();
        assert_eq!(
            picture(&spans),
            "       #|      ##|      ##|       #|\n#       |##      |##      |#       |\n"
        );
        let options = TableOptions {
            traversal: Traversal::Box,
            ..OPTIONS
        };
        let boxes = read_table(&table, &options).unwrap();
        assert_eq!(
            picture(&boxes),
            "      .#|      ##|      ##|      .#|\n#.      |##      |##      |#.      |\n"
        );
        let tiles = spans.splats.iter().map(|splat| splat.tiles);
        assert_eq!(tiles.collect::<Vec<_>>(), [2, 0]);
        let listed = format!("{HEADING},tiles\n0,8,4,1,1,0,1,6,2,10,6,1\n");
        assert_eq!(read_table(&listed, &OPTIONS).unwrap().splats[0].tiles, 1);
    }

    #[test]
    fn a_footprint_without_an_end_is_an_error() {
        let options = TableOptions {
            cutoff: None,
            ..OPTIONS
        };
        let disc = "0,8,4,1,1,0,1,6,2,10,6";
        let message = |text: &str| read_table(text, &options).unwrap_err().to_string();
        assert!(message(&format!("{HEADING}\n{disc}\n")).starts_with("line 2: no cut-off"));
        assert!(message(&format!("{HEADING},cutoff\n{disc},4\n{disc},\n")).starts_with("line 3"));
        let own = read_table(&format!("{HEADING},cutoff\n{disc},4\n"), &options).unwrap();
        let given = read_table(&format!("{HEADING}\n{disc}\n"), &OPTIONS).unwrap();
        assert_eq!(picture(&own), picture(&given));
    }

    #[test]
    fn errors_name_line_and_column() {
        let message = |text: &str| read_table(text, &OPTIONS).unwrap_err().to_string();
        let disc = |conic: &str| format!("{HEADING}\n0,8,4,1,{conic},6,2,10,6\n");
        let cutoff = |value: &str| {
            let text = format!("{HEADING},cutoff\n0,8,4,1,1,0,1,6,2,10,6,{value}\n");
            (text, "cutoff = ")
        };
        let bad = disc("1,0,inf");
        assert_eq!(
            message(&bad),
            "line 2: conic_c = 'inf': expected a finite number"
        );
        let negative = format!("{HEADING}\n0,8,4,1,1,0,1,-6,2,10,6\n");
        let texts = [
            ("index,u,v\n".to_owned(), "no column 'depth'"),
            (negative, "x0 = '-6'"),
            (format!("{HEADING}\n0,8\n"), "x0 = ''"),
        ];
        let indefinite =
            ["-1,0,1", "1,0,-1", "1,2,1", "0,1,0"].map(|conic| (disc(conic), "conic_b"));
        let cutoffs = ["-1", "0", "NaN", "inf"].map(cutoff);
        for (text, expected) in texts.into_iter().chain(indefinite).chain(cutoffs) {
            let message = message(&text);
            assert!(message.contains(expected), "{message}");
        }
        assert!(read_table(&disc("1,1.001,1"), &OPTIONS).is_ok(), "rounded");
    }

    #[test]
    fn one_line_cannot_ask_for_all_memory() {
        let huge = format!("{HEADING}\n0,8,4,1,1,0,1,0,0,32768,32768\n");
        let options = TableOptions {
            viewport: [0, 0],
            ..OPTIONS
        };
        let message = read_table(&huge, &options).unwrap_err().to_string();
        let expected = "line 2: the boxes up to here have 134217728 rows in tiles";
        assert!(message.starts_with(expected), "{message}");
        assert!(read_table(&huge, &OPTIONS).is_ok(), "cut to the screen");
    }

    #[test]
    fn no_truncation_panics() {
        let whole = format!("{HEADING}\n0,8,4,1,1,0,1,6,2,10,6\n1,,,,,,,,,,\n");
        for length in 0..whole.len() {
            let cut = read_table(&whole[..length], &OPTIONS);
            // What is cut inside the heading lacks a column; later cuts may leave a sound shorter table.
            assert!(cut.is_err() || length >= HEADING.len(), "cut at {length}");
        }
    }
}
