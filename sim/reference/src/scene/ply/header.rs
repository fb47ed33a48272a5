//! The header of a PLY file: elements and their properties, in file order.

use super::super::bytes::{Endian, Scalar};
use super::super::error::{Problem, shorten};
use anyhow::{Context, anyhow, bail};

/// How the body is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PlyEncoding {
    Ascii,
    Binary(Endian),
}

/// Type of one property.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PropertyKind {
    Number(Scalar),
    /// A count followed by so many items; walked over, never used.
    List {
        count: Scalar,
        item: Scalar,
    },
}

#[derive(Clone, Debug)]
pub(super) struct Property {
    pub(super) name: String,
    pub(super) kind: PropertyKind,
}

#[derive(Clone, Debug)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: u64,
    pub(super) properties: Vec<Property>,
}

impl Element {
    /// Place of the numeric property called `name` within a record.
    pub(super) fn column(&self, name: &str) -> Option<usize> {
        self.properties
            .iter()
            .position(|p| p.name == name && matches!(p.kind, PropertyKind::Number(_)))
    }

    /// Least bytes of one binary record: lists may be empty.
    pub(super) fn least_bytes(&self) -> u64 {
        let least = |property: &Property| match property.kind {
            PropertyKind::Number(scalar) => scalar.size() as u64,
            PropertyKind::List { count, .. } => count.size() as u64,
        };
        self.properties.iter().map(least).sum()
    }
}

#[derive(Clone, Debug)]
pub(super) struct PlyHeader {
    pub(super) format: PlyEncoding,
    pub(super) elements: Vec<Element>,
    /// Do its comments say that it was trained antialiased? `SplatRenderMode: mip` is Brush's spelling, `antialiased 1`
    /// Postshot's.
    pub(super) antialiased: bool,
    /// Lines of the header, so that the body's lines can be numbered.
    pub(super) lines: usize,
}

/// Splits a PLY file into its header and its body.
pub(super) fn parse(bytes: &[u8]) -> Result<(PlyHeader, &[u8]), Problem> {
    let mut rest = bytes;
    let mut format = None;
    let mut antialiased = false;
    let mut elements: Vec<Element> = Vec::new();
    for number in 1.. {
        let (line, after) = split_line(rest).ok_or_else(|| no_end(number))?;
        rest = after;
        let text = String::from_utf8_lossy(line);
        let words: Vec<&str> = text.split_whitespace().collect();
        match words.as_slice() {
            ["ply"] if number == 1 => {}
            _ if number == 1 => {
                bail!("PLY header line 1: it is not 'ply'; check that this is a PLY file")
            }
            ["end_header"] => {
                let format = format.with_context(|| {
                    format!(
                        "PLY header line {number}: no format line came before end_header; \
                         add 'format binary_little_endian 1.0' or what the body is"
                    )
                })?;
                let header = PlyHeader {
                    format,
                    elements,
                    antialiased,
                    lines: number,
                };
                return Ok((header, rest));
            }
            ["comment", name, value] if name.eq_ignore_ascii_case("SplatRenderMode:") => {
                antialiased = value.eq_ignore_ascii_case("mip");
            }
            ["comment", name, value] if name.eq_ignore_ascii_case("antialiased") => {
                antialiased = *value != "0";
            }
            [] | ["comment", ..] | ["obj_info", ..] => {}
            ["format", name, "1.0"] => format = Some(parse_format(name, number)?),
            ["element", name, count] => elements.push(parse_element(name, count, number)?),
            ["property", words @ ..] => {
                let property = parse_property(words, number)?;
                let element = elements.last_mut().with_context(|| {
                    format!(
                        "PLY header line {number}: a property comes before any element; \
                         put an element line before it"
                    )
                })?;
                element.properties.push(property);
            }
            _ => bail!(
                "PLY header line {number}: '{}' is not understood; \
                 expected format, element, property, comment or end_header",
                shorten(&text)
            ),
        }
    }
    Err(no_end(0))
}

/// The bytes before the next newline (without a carriage return) and those after it.
pub(super) fn split_line(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    let end = bytes.iter().position(|&byte| byte == b'\n')?;
    let line = bytes.get(..end)?;
    Some((
        line.strip_suffix(b"\r").unwrap_or(line),
        bytes.get(end + 1..)?,
    ))
}

fn no_end(line: usize) -> Problem {
    anyhow!(
        "PLY header line {line}: the file ends before end_header; \
         fetch the file again: it is truncated"
    )
}

fn parse_format(name: &str, line: usize) -> Result<PlyEncoding, Problem> {
    match name {
        "ascii" => Ok(PlyEncoding::Ascii),
        "binary_little_endian" => Ok(PlyEncoding::Binary(Endian::Little)),
        "binary_big_endian" => Ok(PlyEncoding::Binary(Endian::Big)),
        other => bail!(
            "PLY header line {line}, format: '{}' is unknown; \
             use ascii, binary_little_endian or binary_big_endian",
            shorten(other)
        ),
    }
}

fn parse_element(name: &str, count: &str, line: usize) -> Result<Element, Problem> {
    let count = count.parse().map_err(|_| {
        anyhow!(
            "PLY header line {line}, element {}: the count '{}' is no whole number; \
             write the number of records",
            shorten(name),
            shorten(count)
        )
    })?;
    Ok(Element {
        name: name.to_string(),
        count,
        properties: Vec::new(),
    })
}

fn parse_property(words: &[&str], line: usize) -> Result<Property, Problem> {
    let (kind, name) = match words {
        ["list", count, item, name] => {
            let (count, item) = (parse_scalar(count, line)?, parse_scalar(item, line)?);
            (PropertyKind::List { count, item }, name)
        }
        [scalar, name] => (PropertyKind::Number(parse_scalar(scalar, line)?), name),
        _ => bail!(
            "PLY header line {line}, property: it is neither 'property TYPE NAME' nor \
             'property list TYPE TYPE NAME'; correct the line"
        ),
    };
    Ok(Property {
        name: name.to_string(),
        kind,
    })
}

fn parse_scalar(name: &str, line: usize) -> Result<Scalar, Problem> {
    match name {
        "char" | "int8" => Ok(Scalar::I8),
        "uchar" | "uint8" => Ok(Scalar::U8),
        "short" | "int16" => Ok(Scalar::I16),
        "ushort" | "uint16" => Ok(Scalar::U16),
        "int" | "int32" => Ok(Scalar::I32),
        "uint" | "uint32" => Ok(Scalar::U32),
        "float" | "float32" => Ok(Scalar::F32),
        "double" | "float64" => Ok(Scalar::F64),
        other => bail!(
            "PLY header line {line}, property: the type '{}' is unknown; \
             use one of PLY's eight number types, for instance float or uchar",
            shorten(other)
        ),
    }
}
