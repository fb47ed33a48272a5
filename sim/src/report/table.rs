//! The sweep's table: one set of cells for the terminal, for Markdown and for the page.

use super::{Report, ReportRow};

/// Number of columns.
pub const COLUMNS: usize = 18;

/// Headings, in the order of [`cells`].
pub const HEADINGS: [&str; COLUMNS] = [
    "design",
    "traversal",
    "PSNR dB",
    "max error",
    "p99",
    "bias",
    "SSIM",
    "FLIP",
    "PSNR cov",
    "bias cov",
    "SSIM cov",
    "visited",
    "vis/cov",
    "setup ms",
    "sort ms",
    "raster ms",
    "total ms",
    "Mcycles",
];

/// How many columns at the left are words; the others are numbers and align to the right.
pub const WORD_COLUMNS: usize = 2;

/// One line as text; `cov` is over covered pixels alone.
pub fn cells(row: &ReportRow) -> [String; COLUMNS] {
    [
        row.design.clone(),
        row.traversal.clone(),
        decibels(row.error.psnr_db),
        scientific(row.error.max_abs),
        scientific(row.error.percentiles.p99),
        signed(row.error.bias),
        format!("{:.5}", row.error.ssim),
        flip_text(row.flip),
        decibels(row.error.covered.psnr_db),
        signed(row.error.covered.bias),
        format!("{:.5}", row.error.covered.ssim),
        count(row.visited),
        row.visited_per_covered
            .map_or_else(|| "-".to_owned(), |ratio| format!("{ratio:.2}")),
        milliseconds(row.host.setup_s),
        milliseconds(row.host.sort_s),
        milliseconds(row.host.raster_s),
        milliseconds(row.host.total_s),
        row.cycles.map_or_else(
            || "-".to_owned(),
            |cycles| format!("{:.3}", cycles as f64 / 1e6),
        ),
    ]
}

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

/// Aligned plain text for a terminal.
pub fn plain(rows: &[ReportRow]) -> String {
    let lines: Vec<[String; COLUMNS]> = rows.iter().map(cells).collect();
    let widths = widths(&lines);
    let mut text = plain_line(&HEADINGS, &widths);
    let rule: Vec<String> = widths.iter().map(|&width| "-".repeat(width)).collect();
    text.push_str(&plain_line(&rule, &widths));
    for line in &lines {
        text.push_str(&plain_line(line, &widths));
    }
    text
}

/// A Markdown table, aligned in the source as well.
pub fn markdown(rows: &[ReportRow]) -> String {
    let lines: Vec<[String; COLUMNS]> = rows.iter().map(cells).collect();
    let widths = widths(&lines);
    let mut text = markdown_line(&HEADINGS, &widths);
    let rule: Vec<String> = widths
        .iter()
        .enumerate()
        .map(|(column, &width)| {
            if column < WORD_COLUMNS {
                "-".repeat(width)
            } else {
                "-".repeat(width - 1) + ":"
            }
        })
        .collect();
    text.push_str(&markdown_line(&rule, &widths));
    for line in &lines {
        text.push_str(&markdown_line(line, &widths));
    }
    text
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

/// Mean FLIP; `-` where it was not measured.
pub fn flip_text(flip: Option<f64>) -> String {
    flip.map_or_else(|| "-".to_owned(), scientific)
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
    let digits = number.to_string();
    let mut text = String::with_capacity(digits.len() + digits.len() / 3);
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            text.push(' ');
        }
        text.push(digit);
    }
    text
}

fn milliseconds(seconds: f64) -> String {
    format!("{:.1}", seconds * 1e3)
}

fn widths(lines: &[[String; COLUMNS]]) -> Vec<usize> {
    let widest = |column: usize| {
        lines
            .iter()
            .map(|line| line[column].chars().count())
            .max()
            .unwrap_or(0)
    };
    HEADINGS
        .iter()
        .enumerate()
        .map(|(column, heading)| widest(column).max(heading.len()))
        .collect()
}

/// Cells padded to their column's width: words to the left, numbers to the right.
fn padded<'a>(
    cells: &'a [impl AsRef<str>],
    widths: &'a [usize],
) -> impl Iterator<Item = String> + 'a {
    cells
        .iter()
        .zip(widths)
        .enumerate()
        .map(|(column, (cell, &width))| {
            if column < WORD_COLUMNS {
                format!("{:<width$}", cell.as_ref())
            } else {
                format!("{:>width$}", cell.as_ref())
            }
        })
}

fn plain_line(cells: &[impl AsRef<str>], widths: &[usize]) -> String {
    let line: Vec<String> = padded(cells, widths).collect();
    line.join("  ").trim_end().to_owned() + "\n"
}

fn markdown_line(cells: &[impl AsRef<str>], widths: &[usize]) -> String {
    let line: Vec<String> = padded(cells, widths).collect();
    format!("| {} |\n", line.join(" | "))
}
