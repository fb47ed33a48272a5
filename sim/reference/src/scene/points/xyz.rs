//! Lines of numbers: `x y z`, `x y z nx ny nz` or `x y z nx ny nz red green blue`, separated by blanks, commas or
//! semicolons.
//!
//! Empty lines and lines that begin with `#` or `//` are passed over, and so is a first line that is a single number
//! (the count of a `.pts` file). Three numbers after the place are a normal if they have about unit length in the first
//! line, otherwise a colour. Colours are 0 to 255, or 0 to 1 if none in the file exceeds 1.

use super::{Record, full_scale, room_for_lines};
use crate::scene::bytes;
use crate::scene::error::Problem;
use crate::vector;
use anyhow::ensure;

/// Squared lengths that are taken for a unit normal's.
const UNIT_LENGTHS: std::ops::Range<f64> = 0.9..1.1;

/// Does a text begin like one of points: is its first line that says something one of numbers?
pub(super) fn begins(bytes: &[u8]) -> bool {
    let start = String::from_utf8_lossy(&bytes[..bytes.len().min(4096)]);
    let mut lines = start
        .lines()
        .map(str::trim)
        .filter(|line| says_something(line));
    lines.next().is_some_and(|line| numbers(line, 1).is_ok())
}

fn says_something(line: &str) -> bool {
    !(line.is_empty() || line.starts_with('#') || line.starts_with("//"))
}

/// Every line's numbers as a record.
pub(super) fn records(bytes: &[u8]) -> Result<Vec<Record>, Problem> {
    room_for_lines(bytes, size_of::<[f64; 9]>() + size_of::<Vec<f64>>())?;
    let text = String::from_utf8_lossy(bytes);
    let mut rows: Vec<Vec<f64>> = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let line = line.trim();
        if !says_something(line) {
            continue;
        }
        let row = numbers(line, index + 1)?;
        if rows.is_empty() && row.len() == 1 {
            continue;
        }
        let expected = rows.first().map_or(row.len(), Vec::len);
        ensure!(
            [3, 6, 9].contains(&row.len()) && row.len() == expected,
            "line {}: it has {} numbers; \
             write 3 (place), 6 (with a normal) or 9 (with a colour) numbers in every line",
            index + 1,
            row.len()
        );
        rows.push(row);
    }
    let normals = rows
        .first()
        .is_some_and(|row| row.len() == 9 || is_unit(row));
    let mut records: Vec<Record> = rows.iter().map(|row| record(row, normals)).collect();
    full_scale(&mut records, &[1.0, 255.0]);
    Ok(records)
}

fn numbers(line: &str, number: usize) -> Result<Vec<f64>, Problem> {
    let words = line.split(|c: char| c.is_whitespace() || c == ',' || c == ';');
    let words = (1..).zip(words.filter(|word| !word.is_empty()));
    words
        .map(|(place, word)| bytes::number(word, || format!("line {number}, number {place}")))
        .collect()
}

fn is_unit(row: &[f64]) -> bool {
    three(row, 3).is_some_and(|normal| UNIT_LENGTHS.contains(&vector::dot(normal, normal)))
}

fn three(row: &[f64], first: usize) -> Option<[f64; 3]> {
    row.get(first..first + 3)?.try_into().ok()
}

fn record(row: &[f64], normals: bool) -> Record {
    let colour = if normals { 6 } else { 3 };
    Record {
        centre: three(row, 0).unwrap_or([f64::NAN; 3]),
        normal: three(row, 3).filter(|_| normals),
        colour: three(row, colour),
        ..Record::default()
    }
}
