//! The body of a PLY file: walks all elements in file order and shows the records of one of them.
//!
//! Numbers come out as f64 whatever their stored type, in the order of the header's properties. A list property
//! takes its column, holding NaN. Bytes left over after the last record are an error: they mean that the header
//! describes another file, and the picture would be silently wrong.

use super::super::bytes::{self, Endian, Reader, Scalar, checked_bytes, nothing_left, truncated};
use super::super::error::{Problem, shorten};
use super::header::{Element, PlyEncoding, PlyHeader, Property, PropertyKind, split_line};
use anyhow::{Context, anyhow, bail};

/// Calls `visit` with each vertex.
pub(super) fn for_each_vertex(
    header: &PlyHeader,
    body: &[u8],
    visit: &mut dyn FnMut(&[f64]),
) -> Result<(), Problem> {
    walk(header, body, &mut |element, record| {
        if element.name == "vertex" {
            visit(record);
        }
    })
}

/// Calls `visit` with each record of every element that has properties.
pub(super) fn walk(
    header: &PlyHeader,
    body: &[u8],
    visit: &mut dyn FnMut(&Element, &[f64]),
) -> Result<(), Problem> {
    let mut source = PlySource::new(header, body);
    let mut values = Vec::new();
    for element in header
        .elements
        .iter()
        .filter(|element| !element.properties.is_empty())
    {
        source.refuse_absurd_count(element)?;
        for index in 0..element.count {
            values.clear();
            source.read_record(element, index, &mut values)?;
            visit(element, &values);
        }
    }
    source.finish()
}

/// Where the next record comes from.
pub(super) enum PlySource<'a> {
    Ascii { rest: &'a [u8], line: usize },
    Binary { reader: Reader<'a>, endian: Endian },
}

impl<'a> PlySource<'a> {
    pub(super) fn new(header: &PlyHeader, body: &'a [u8]) -> PlySource<'a> {
        match header.format {
            PlyEncoding::Ascii => PlySource::Ascii {
                rest: body,
                line: header.lines,
            },
            PlyEncoding::Binary(endian) => PlySource::Binary {
                reader: Reader::new(body),
                endian,
            },
        }
    }

    /// The records must fit what is left of the file before any of them is read, or room is kept for them.
    pub(super) fn refuse_absurd_count(&self, element: &Element) -> Result<(), Problem> {
        let field = format!(
            "element {}, {} records",
            shorten(&element.name),
            element.count
        );
        let (least, left) = match self {
            // A digit and a separator per property.
            PlySource::Ascii { rest, .. } => (2 * element.properties.len() as u64, rest.len()),
            PlySource::Binary { reader, .. } => (element.least_bytes(), reader.remaining()),
        };
        let needed = checked_bytes(element.count, least, &field)?;
        if needed > left as u64 {
            return Err(truncated(&field, needed, left));
        }
        Ok(())
    }

    fn read_record(
        &mut self,
        element: &Element,
        index: u64,
        values: &mut Vec<f64>,
    ) -> Result<(), Problem> {
        match self {
            PlySource::Ascii { rest, line } => read_ascii(rest, line, element, values),
            PlySource::Binary { reader, endian } => {
                for property in &element.properties {
                    values.push(read_binary(reader, *endian, property, element, index)?);
                }
                Ok(())
            }
        }
    }

    fn finish(self) -> Result<(), Problem> {
        let left = match self {
            PlySource::Ascii { rest, .. } => rest.trim_ascii().len(),
            PlySource::Binary { reader, .. } => reader.remaining(),
        };
        let fix = "correct the counts or types in the header";
        nothing_left(left, "PLY body", "record", fix)
    }
}

fn read_binary(
    reader: &mut Reader,
    endian: Endian,
    property: &Property,
    element: &Element,
    index: u64,
) -> Result<f64, Problem> {
    let field = || {
        format!(
            "element {} record {index}, property {}",
            shorten(&element.name),
            shorten(&property.name)
        )
    };
    // The field's name is built only for an error: it would cost more than the reading.
    let mut number = |scalar: Scalar| match reader.take(scalar.size(), "") {
        Ok(stored) => Ok(scalar.decode(stored, endian)),
        Err(_) => Err(truncated(
            &field(),
            scalar.size() as u64,
            reader.remaining(),
        )),
    };
    match property.kind {
        PropertyKind::Number(scalar) => number(scalar),
        PropertyKind::List { count, item } => {
            let length = number(count)?;
            let length = list_length(length).ok_or_else(|| bad_list(&field(), length))?;
            reader.records(length, item.size(), &field())?;
            Ok(f64::NAN)
        }
    }
}

fn read_ascii(
    rest: &mut &[u8],
    line: &mut usize,
    element: &Element,
    values: &mut Vec<f64>,
) -> Result<(), Problem> {
    let text = loop {
        let (text, after) =
            split_line(rest).ok_or_else(|| unfinished_line(*line + 1, rest.len()))?;
        *rest = after;
        *line += 1;
        if !text.trim_ascii().is_empty() {
            break String::from_utf8_lossy(text);
        }
    };
    let mut words = text.split_ascii_whitespace();
    for property in &element.properties {
        let field = || format!("line {}, property {}", *line, shorten(&property.name));
        let cut = || format!("{}: the line ends before it; complete the line", field());
        let mut number = || bytes::number(words.next().with_context(cut)?, field);
        let value = number()?;
        match property.kind {
            PropertyKind::Number(_) => values.push(value),
            PropertyKind::List { .. } => {
                let length = list_length(value).ok_or_else(|| bad_list(&field(), value))?;
                for _ in 0..length {
                    number()?;
                }
                values.push(f64::NAN);
            }
        }
    }
    match words.next() {
        None => Ok(()),
        Some(extra) => bail!(
            "line {line}: '{}' stands after the last property; write one record per line",
            shorten(extra)
        ),
    }
}

/// A line cut in the middle of a number still parses, so only the newline proves that a record is whole.
fn unfinished_line(line: usize, left: usize) -> Problem {
    match left {
        0 => anyhow!("line {line}: the file ends before the last record; fetch it again"),
        _ => anyhow!(
            "line {line}: the file ends without a newline, so the last number may be cut off; \
             fetch the file again, or end it with a newline if it is complete"
        ),
    }
}

fn list_length(value: f64) -> Option<u64> {
    (value >= 0.0 && value.fract() == 0.0 && value <= f64::from(u32::MAX)).then_some(value as u64)
}

fn bad_list(field: &str, value: f64) -> Problem {
    anyhow!("{field}: the list length {value} is no count; correct the list")
}
