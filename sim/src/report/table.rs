//! The sweep's table: one set of cells for the terminal and for the page.

use super::{Report, ReportRow};
use indicatif::HumanCount;

/// A heading, and its cell of a row as text.
pub type TextColumn = (&'static str, fn(&ReportRow) -> String);

/// All columns; `cov` is over covered pixels alone.
pub const COLUMNS: [TextColumn; 18] = [
    ("design", |row| row.design.clone()),
    ("traversal", |row| row.traversal.clone()),
    ("PSNR dB", |row| decibels(row.error.psnr_db)),
    ("max error", |row| scientific(row.error.max_abs)),
    ("p99", |row| scientific(row.error.percentiles.p99)),
    ("bias", |row| signed(row.error.bias)),
    ("SSIM", |row| format!("{:.5}", row.error.ssim)),
    ("FLIP", |row| scientific(row.flip)),
    ("PSNR cov", |row| decibels(row.error.covered.psnr_db)),
    ("bias cov", |row| signed(row.error.covered.bias)),
    ("SSIM cov", |row| format!("{:.5}", row.error.covered.ssim)),
    ("visited", |row| count(row.visited)),
    ("vis/cov", |row| {
        let ratio = row.visited_per_covered;
        ratio.map_or("-".to_owned(), |ratio| format!("{ratio:.2}"))
    }),
    ("setup ms", |row| milliseconds(row.host.setup_s)),
    ("sort ms", |row| milliseconds(row.host.sort_s)),
    ("raster ms", |row| milliseconds(row.host.raster_s)),
    ("total ms", |row| milliseconds(row.host.total_s)),
    ("Mcycles", |row| {
        let millions = row.cycles.map(|cycles| cycles as f64 / 1e6);
        millions.map_or("-".to_owned(), |millions| format!("{millions:.3}"))
    }),
];

/// How many columns at the left are words; the others are numbers and align to the right.
pub const WORD_COLUMNS: usize = 2;

/// What the machine's cycles are in time, in one line; nothing where it was not run.
pub fn throughput_text(report: &Report) -> String {
    let Some(pace) = &report.pace else {
        return String::new();
    };
    format!(
        "machine: {:.2} frames a second, {:.3} ms a frame, {:.1} MB a second at {} MHz ({})\n",
        pace.frames_per_s,
        pace.ms_per_frame,
        pace.bytes_per_s / 1e6,
        pace.clock.mhz,
        pace.clock.of,
    )
}

/// Plain text for a terminal: headings, a rule and the rows, cells padded to their column's width, words to the left
/// and numbers to the right.
pub fn plain(rows: &[ReportRow]) -> String {
    let headings = COLUMNS.map(|(heading, _)| heading.to_owned());
    let cells = rows.iter().map(|row| COLUMNS.map(|(_, cell)| cell(row)));
    let mut lines: Vec<_> = std::iter::once(headings).chain(cells).collect();
    let lengths = |column: usize| lines.iter().map(move |line| line[column].chars().count());
    let widths: [usize; COLUMNS.len()] =
        std::array::from_fn(|column| lengths(column).max().unwrap_or(0));
    lines.insert(1, widths.map(|width| "-".repeat(width)));
    let padded = |(column, cell): (usize, &String)| {
        let width = widths[column];
        if column < WORD_COLUMNS {
            format!("{cell:<width$}")
        } else {
            format!("{cell:>width$}")
        }
    };
    let line = |cells: &[String; COLUMNS.len()]| {
        let cells: Vec<String> = cells.iter().enumerate().map(padded).collect();
        cells.join("  ").trim_end().to_owned() + "\n"
    };
    lines.iter().map(line).collect()
}

/// `57.31`, or `identical` where the PSNR would be infinite.
pub fn decibels(psnr_db: f64) -> String {
    if psnr_db.is_finite() {
        format!("{psnr_db:.2}")
    } else {
        "identical".to_owned()
    }
}

/// `57.31 dB`, or `identical`.
pub fn psnr_text(psnr_db: f64) -> String {
    let unit = if psnr_db.is_finite() { " dB" } else { "" };
    decibels(psnr_db) + unit
}

/// The PSNR of a root mean square error, or `equal`.
pub fn psnr_of_rms(rms: f64) -> String {
    if rms > 0.0 {
        format!("{:.2} dB", -20.0 * rms.log10())
    } else {
        "equal".to_owned()
    }
}

/// `3.1e-3`; plain `0` for zero.
pub fn scientific(value: f64) -> String {
    if value == 0.0 {
        "0".to_owned()
    } else {
        format!("{value:.1e}")
    }
}

/// `+3.1e-3`; plain `0` for zero.
pub fn signed(value: f64) -> String {
    if value == 0.0 {
        "0".to_owned()
    } else {
        format!("{value:+.1e}")
    }
}

/// Digits in groups of three, parted by a space.
pub fn count(number: u64) -> String {
    HumanCount(number).to_string().replace(',', " ")
}

fn milliseconds(seconds: f64) -> String {
    format!("{:.1}", seconds * 1e3)
}
