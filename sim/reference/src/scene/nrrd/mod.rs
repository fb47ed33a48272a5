//! NRRD volumes: `.nrrd` with the data attached, `.nhdr` with the data in a file beside it.
//!
//! Three dimensions; 8- and 16-bit integers and f32 in both byte orders; raw or gzip. Voxel spacings come from
//! `spacings` or from the lengths of axis-aligned `space directions`, and are 1 where the header is silent. The grid's
//! axes are kept as stored (see [`super::volume`]).

#[cfg(test)]
mod tests;

use super::bytes::{Endian, Scalar};
use super::error::Problem;
use super::volume::header::{HeaderField, LineHeader};
use super::volume::{Grid, Packing, Volume, data_file, is_spacing};
use anyhow::bail;
use std::path::Path;

/// Loads a volume; `folder` is where a detached header's data file is looked for.
pub(super) fn load(bytes: &[u8], folder: Option<&Path>) -> Result<Volume, Problem> {
    let (header, attached) = read(bytes)?;
    let grid = grid(&header)?;
    let packing = parse_encoding(header.required("encoding")?)?;
    let values = match (header.get("data file"), attached) {
        (Some(field), _) => {
            let data = data_file(field.data_file()?, folder)?;
            grid.unpack(&data, packing, "sizes")?
        }
        (None, Some(data)) => grid.unpack(data, packing, "sizes")?,
        (None, None) => bail!(
            "NRRD header: it ends without the blank line before the data, and names no data file; \
             add the data, or a 'data file: NAME' line"
        ),
    };
    Ok(grid.volume(values, Vec::new()))
}

/// The header, and what follows its blank line if there is one.
fn read(bytes: &[u8]) -> Result<(LineHeader, Option<&[u8]>), Problem> {
    let mut header = LineHeader::new("NRRD");
    let mut rest = bytes;
    while !rest.is_empty() {
        let line = header.next_line(&mut rest)?;
        match header.lines {
            1 => check_magic(&header, &line)?,
            _ if line.is_empty() => return Ok((header, Some(rest))),
            _ => read_line(&mut header, &line)?,
        }
    }
    Ok((header, None))
}

fn check_magic(header: &LineHeader, text: &str) -> Result<(), Problem> {
    match text.strip_prefix("NRRD000") {
        Some("1" | "2" | "3" | "4" | "5") => Ok(()),
        _ => {
            let found = "it is not NRRD0001 to NRRD0005";
            Err(header.malformed("magic", found, "check that this is an NRRD file"))
        }
    }
}

fn read_line(header: &mut LineHeader, text: &str) -> Result<(), Problem> {
    // Comments and key/value pairs describe; they do not change the data.
    if text.starts_with('#') || text.contains(":=") {
        return Ok(());
    }
    let Some((name, value)) = text.split_once(": ") else {
        return Err(header.no_field(text, "field: value"));
    };
    match name.to_ascii_lowercase().as_str() {
        "datafile" => header.add("data file", name, value),
        key @ ("type" | "dimension" | "sizes" | "spacings" | "space directions" | "encoding"
        | "endian" | "data file") => header.add(key, name, value),
        // These describe the data without changing how they are read.
        "content" | "number" | "min" | "max" | "old min" | "oldmin" | "old max" | "oldmax"
        | "kinds" | "centers" | "centerings" | "labels" | "units" | "thicknesses"
        | "sample units" | "sampleunits" | "space" | "space dimension" | "space units"
        | "space origin" => Ok(()),
        _ => Err(header.unsupported(name)),
    }
}

fn grid(header: &LineHeader) -> Result<Grid, Problem> {
    let dimension = header.required("dimension")?;
    if dimension.value != "3" {
        return Err(dimension.is("give a 3D volume"));
    }
    let kind = parse_kind(header.required("type")?)?;
    let endian = match header.get("endian").map(|field| field.value.as_str()) {
        None if kind.size() == 1 => Endian::Little,
        Some("little") => Endian::Little,
        Some("big") => Endian::Big,
        _ => return Err(header.required("endian")?.is("write 'little' or 'big'")),
    };
    Ok(Grid {
        sizes: header.required("sizes")?.sizes()?,
        spacings: parse_spacings(header)?,
        kind,
        endian,
    })
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
        _ => Err(field.is_not("supported", "convert to uchar, short, ushort or float")),
    }
}

fn parse_encoding(field: &HeaderField) -> Result<Packing, Problem> {
    match field.value.as_str() {
        "raw" => Ok(Packing::None),
        "gzip" | "gz" => Ok(Packing::Gzip),
        _ => Err(field.is_not("supported", "convert to raw or gzip")),
    }
}

fn parse_spacings(header: &LineHeader) -> Result<[f64; 3], Problem> {
    match (header.get("spacings"), header.get("space directions")) {
        (None, None) => Ok([1.0; 3]),
        (Some(field), None) => field.spacings(three(field.value.split_whitespace(), length)),
        (None, Some(field)) => {
            let fix = "resample the volume to its axes, or give spacings instead";
            three(field.value.split_inclusive(')'), axis_length)
                .ok_or_else(|| field.is_not("three axis-aligned vectors", fix))
        }
        (Some(_), Some(field)) => {
            Err(field.malformed("spacings are given as well", "give one of the two"))
        }
    }
}

fn three<'a>(
    words: impl Iterator<Item = &'a str>,
    length: fn(&str) -> Option<f64>,
) -> Option<[f64; 3]> {
    let lengths: Option<Vec<f64>> = words.map(length).collect();
    lengths?.try_into().ok()
}

fn length(word: &str) -> Option<f64> {
    match word.parse::<f64>() {
        // NRRD's word for "unknown".
        Ok(unknown) if unknown.is_nan() => Some(1.0),
        Ok(length) if is_spacing(length) => Some(length),
        _ => None,
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
