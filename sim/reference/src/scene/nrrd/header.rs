//! The header of an NRRD file: `field: value` lines up to a blank line or the end of the file.

use super::super::bytes::{Endian, Scalar};
use super::super::error::{Problem, shorten};
use super::super::volume::{Grid, is_spacing, three_sizes};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Raw,
    Gzip,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) struct NrrdHeader {
    pub(super) grid: Grid,
    pub(super) encoding: Encoding,
    pub(super) data_file: Option<String>,
}

/// Fields that describe the data without changing how they are read.
const DESCRIPTIVE: [&str; 20] = [
    "content",
    "number",
    "min",
    "max",
    "old min",
    "oldmin",
    "old max",
    "oldmax",
    "kinds",
    "centers",
    "centerings",
    "labels",
    "units",
    "thicknesses",
    "sample units",
    "sampleunits",
    "space",
    "space dimension",
    "space units",
    "space origin",
];

/// A field's value and the line on which it stands.
struct HeaderField {
    line: usize,
    value: String,
}

/// The fields that matter, as found.
#[derive(Default)]
struct NrrdFields {
    kind: Option<HeaderField>,
    dimension: Option<HeaderField>,
    sizes: Option<HeaderField>,
    spacings: Option<HeaderField>,
    directions: Option<HeaderField>,
    encoding: Option<HeaderField>,
    endian: Option<HeaderField>,
    data_file: Option<HeaderField>,
    lines: usize,
}

/// The header, and what follows its blank line if there is one.
pub(super) fn parse(bytes: &[u8]) -> Result<(NrrdHeader, Option<&[u8]>), Problem> {
    let mut fields = NrrdFields::default();
    let mut rest = bytes;
    while !rest.is_empty() {
        let (line, after, finished) = next_line(rest);
        rest = after;
        fields.lines += 1;
        if line.is_empty() && fields.lines > 1 {
            return Ok((interpret(fields)?, Some(rest)));
        }
        let text = String::from_utf8_lossy(line);
        if !finished {
            return Err(malformed(
                fields.lines,
                "header",
                "it ends in the middle of a line",
                "fetch the file again",
            ));
        }
        match fields.lines {
            1 => check_magic(&text)?,
            number => fields.read_line(&text, number)?,
        }
    }
    Ok((interpret(fields)?, None))
}

/// The next line without its end, what follows, and whether a newline ended it.
fn next_line(bytes: &[u8]) -> (&[u8], &[u8], bool) {
    let mut parts = bytes.splitn(2, |&byte| byte == b'\n');
    let line = parts.next().unwrap_or_default();
    let rest = parts.next();
    (
        line.strip_suffix(b"\r").unwrap_or(line),
        rest.unwrap_or_default(),
        rest.is_some(),
    )
}

fn malformed(line: usize, field: &str, found: impl std::fmt::Display, fix: &str) -> Problem {
    Problem::malformed(format!("NRRD header line {line}, {field}"), found, fix)
}

fn check_magic(text: &str) -> Result<(), Problem> {
    match text.strip_prefix("NRRD000") {
        Some("1" | "2" | "3" | "4" | "5") => Ok(()),
        _ => Err(malformed(
            1,
            "magic",
            "it is not NRRD0001 to NRRD0005",
            "check that this is an NRRD file",
        )),
    }
}

impl NrrdFields {
    fn read_line(&mut self, text: &str, line: usize) -> Result<(), Problem> {
        // Comments and key/value pairs describe; they do not change the data.
        if text.starts_with('#') || text.contains(":=") {
            return Ok(());
        }
        let (name, value) = text.split_once(": ").ok_or_else(|| {
            malformed(
                line,
                "header",
                format!("'{}' is no field", shorten(text)),
                "write 'field: value'",
            )
        })?;
        let slot = match name.to_ascii_lowercase().as_str() {
            "type" => &mut self.kind,
            "dimension" => &mut self.dimension,
            "sizes" => &mut self.sizes,
            "spacings" => &mut self.spacings,
            "space directions" => &mut self.directions,
            "encoding" => &mut self.encoding,
            "endian" => &mut self.endian,
            "data file" | "datafile" => &mut self.data_file,
            other if DESCRIPTIVE.contains(&other) => return Ok(()),
            _ => {
                return Err(malformed(
                    line,
                    &shorten(name),
                    "this field is not supported",
                    "remove it if the data can be read without it, or convert the volume",
                ));
            }
        };
        if slot.is_some() {
            return Err(malformed(line, name, "it is given twice", "give it once"));
        }
        *slot = Some(HeaderField {
            line,
            value: value.trim().to_string(),
        });
        Ok(())
    }
}

fn interpret(fields: NrrdFields) -> Result<NrrdHeader, Problem> {
    let NrrdFields {
        kind,
        dimension,
        sizes,
        spacings,
        directions,
        encoding,
        endian,
        data_file,
        lines,
    } = fields;
    let required = |field: Option<HeaderField>, name: &str| {
        field.ok_or_else(|| malformed(lines, name, "the header lacks it", "add it before the data"))
    };
    check_dimension(&required(dimension, "dimension")?)?;
    let kind = parse_kind(&required(kind, "type")?)?;
    let endian = match endian {
        Some(field) => parse_endian(&field)?,
        None if kind.size() == 1 => Endian::Little,
        None => required(None, "endian").and(Ok(Endian::Little))?,
    };
    let grid = Grid {
        sizes: parse_sizes(&required(sizes, "sizes")?)?,
        spacings: parse_spacings(spacings, directions)?,
        kind,
        endian,
    };
    Ok(NrrdHeader {
        grid,
        encoding: parse_encoding(&required(encoding, "encoding")?)?,
        data_file: data_file.map(|field| check_data_file(&field)).transpose()?,
    })
}

fn check_dimension(field: &HeaderField) -> Result<(), Problem> {
    match field.value.as_str() {
        "3" => Ok(()),
        other => Err(malformed(
            field.line,
            "dimension",
            format!("it is '{}'", shorten(other)),
            "give a 3D volume",
        )),
    }
}

fn parse_kind(field: &HeaderField) -> Result<Scalar, Problem> {
    match field.value.as_str() {
        "signed char" | "int8" | "int8_t" => Ok(Scalar::I8),
        "uchar" | "unsigned char" | "uint8" | "uint8_t" => Ok(Scalar::U8),
        "short" | "short int" | "signed short" | "signed short int" | "int16" | "int16_t" => {
            Ok(Scalar::I16)
        }
        "ushort" | "unsigned short" | "unsigned short int" | "uint16" | "uint16_t" => {
            Ok(Scalar::U16)
        }
        "float" => Ok(Scalar::F32),
        other => Err(malformed(
            field.line,
            "type",
            format!("'{}' is not supported", shorten(other)),
            "convert to uchar, short, ushort or float",
        )),
    }
}

fn parse_endian(field: &HeaderField) -> Result<Endian, Problem> {
    match field.value.as_str() {
        "little" => Ok(Endian::Little),
        "big" => Ok(Endian::Big),
        other => Err(malformed(
            field.line,
            "endian",
            format!("it is '{}'", shorten(other)),
            "write 'little' or 'big'",
        )),
    }
}

fn parse_encoding(field: &HeaderField) -> Result<Encoding, Problem> {
    match field.value.as_str() {
        "raw" => Ok(Encoding::Raw),
        "gzip" | "gz" => Ok(Encoding::Gzip),
        other => Err(malformed(
            field.line,
            "encoding",
            format!("'{}' is not supported", shorten(other)),
            "convert to raw or gzip",
        )),
    }
}

fn parse_sizes(field: &HeaderField) -> Result<[usize; 3], Problem> {
    three_sizes(&field.value).ok_or_else(|| {
        malformed(
            field.line,
            "sizes",
            format!(
                "'{}' is not three positive whole numbers",
                shorten(&field.value)
            ),
            "write the number of voxels along x, y and z",
        )
    })
}

fn parse_spacings(
    spacings: Option<HeaderField>,
    directions: Option<HeaderField>,
) -> Result<[f64; 3], Problem> {
    match (spacings, directions) {
        (None, None) => Ok([1.0; 3]),
        (Some(field), None) => parse_lengths(&field),
        (None, Some(field)) => parse_directions(&field),
        (Some(_), Some(field)) => Err(malformed(
            field.line,
            "space directions",
            "spacings are given as well",
            "give one of the two",
        )),
    }
}

fn parse_lengths(field: &HeaderField) -> Result<[f64; 3], Problem> {
    let length = |word: &str| match word.parse::<f64>() {
        // NRRD's word for "unknown".
        Ok(unknown) if unknown.is_nan() => Some(1.0),
        Ok(length) if is_spacing(length) => Some(length),
        _ => None,
    };
    let lengths: Option<Vec<f64>> = field.value.split_whitespace().map(length).collect();
    match lengths.as_deref() {
        Some(&[x, y, z]) => Ok([x, y, z]),
        _ => Err(malformed(
            field.line,
            "spacings",
            format!("'{}' is not three positive lengths", shorten(&field.value)),
            "write the distances between voxels along x, y and z",
        )),
    }
}

fn parse_directions(field: &HeaderField) -> Result<[f64; 3], Problem> {
    let lengths: Option<Vec<f64>> = field.value.split_inclusive(')').map(axis_length).collect();
    match lengths.as_deref() {
        Some(&[x, y, z]) => Ok([x, y, z]),
        _ => Err(malformed(
            field.line,
            "space directions",
            format!(
                "'{}' is not three axis-aligned vectors",
                shorten(&field.value)
            ),
            "resample the volume to its axes, or give spacings instead",
        )),
    }
}

/// Length of a vector such as `(0,2.5,0)` if exactly one component differs from zero.
fn axis_length(text: &str) -> Option<f64> {
    let inside = text.trim().strip_prefix('(')?.strip_suffix(')')?;
    let parts: Vec<f64> = inside
        .split(',')
        .map(|part| part.trim().parse().ok())
        .collect::<Option<_>>()?;
    let longest = parts
        .iter()
        .fold(0.0, |longest: f64, part| longest.max(part.abs()));
    let aligned = parts
        .iter()
        .filter(|part| part.abs() > 1e-6 * longest || part.is_nan())
        .count()
        == 1;
    (parts.len() == 3 && aligned && is_spacing(longest)).then_some(longest)
}

fn check_data_file(field: &HeaderField) -> Result<String, Problem> {
    if field.value.is_empty() || field.value.contains('%') || field.value.starts_with("LIST") {
        return Err(malformed(
            field.line,
            "data file",
            format!("'{}' is not one file", shorten(&field.value)),
            "join the slices into one data file",
        ));
    }
    Ok(field.value.clone())
}
