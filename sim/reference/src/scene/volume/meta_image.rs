//! MetaImage volumes, as ITK and 3D Slicer write them: `.mha` with the data behind the header, `.mhd` with the data in
//! a file beside it.
//!
//! `Key = value` lines up to `ElementDataFile`, which is the last and says `LOCAL` or a file's name. Three dimensions,
//! one channel, integers of 8 to 32 bits and floats in both byte orders; raw or packed by zlib. A header of its own
//! dozen keys needs no library.

use super::super::bytes::{Endian, Scalar};
use super::super::error::{Problem, shorten};
use super::header::LineHeader;
use super::{Grid, Packing, UNTURNED, Volume, data_file, numbers, three_spacings, turned};
use std::path::Path;

/// Those of the turn of the grid, which differ from version to version.
const TURNS: [&str; 3] = ["orientation", "rotation", "transformmatrix"];

const LAST: &str = "elementdatafile";

/// Loads a volume; `folder` is where a data file is looked for.
pub(in super::super) fn load(bytes: &[u8], folder: Option<&Path>) -> Result<Volume, Problem> {
    let (header, rest) = read(bytes)?;
    let grid = grid(&header)?;
    let packing = match flag(&header, "compresseddata")? {
        Some(true) => Packing::Zlib,
        _ => Packing::None,
    };
    let file = header.required(LAST)?;
    let values = match file.value.as_str() {
        "LOCAL" | "Local" | "local" => {
            grid.unpack(attached(&header, rest, packing)?, packing, "DimSize")?
        }
        _ => grid.unpack(&data_file(file.data_file()?, folder)?, packing, "DimSize")?,
    };
    Ok(grid.volume(values, turned(is_turned(&header)?)))
}

/// The header's fields, and what follows it.
fn read(bytes: &[u8]) -> Result<(LineHeader, &[u8]), Problem> {
    let mut header = LineHeader::new("MetaImage");
    let mut rest = bytes;
    while header.get(LAST).is_none() {
        if rest.is_empty() {
            header.required(LAST)?;
        }
        let line = header.next_line(&mut rest)?;
        add(&mut header, line.trim())?;
    }
    Ok((header, rest))
}

fn add(header: &mut LineHeader, line: &str) -> Result<(), Problem> {
    if line.is_empty() {
        return Ok(());
    }
    let Some((name, value)) = line.split_once('=') else {
        return Err(header.no_field(line, "Key = value"));
    };
    let (name, value) = (name.trim(), value.trim());
    let key = name.to_ascii_lowercase();
    if key == "objecttype" && !value.eq_ignore_ascii_case("image") {
        let found = format!("it is '{}'", shorten(value));
        return Err(header.malformed(name, found, "give a file of an Image"));
    }
    match key.as_str() {
        // These describe the data without changing how they are read.
        "comment"
        | "objecttype"
        | "objectsubtype"
        | "transformtype"
        | "name"
        | "id"
        | "parentid"
        | "color"
        | "centerofrotation"
        | "offset"
        | "origin"
        | "position"
        | "distanceunits"
        | "modality"
        | "elementmin"
        | "elementmax"
        | "elementnbits"
        | "sequenceid"
        | "imageposition"
        | "creationdate"
        | "acquisitiondate"
        | "anatomicalorientation" => Ok(()),
        "ndims"
        | "dimsize"
        | "elementtype"
        | "elementspacing"
        | "elementsize"
        | "elementnumberofchannels"
        | "binarydata"
        | "binarydatabyteordermsb"
        | "elementbyteordermsb"
        | "compresseddata"
        | "compresseddatasize"
        | "headersize"
        | LAST
        | "orientation"
        | "rotation"
        | "transformmatrix" => header.add(&key, name, value),
        _ => Err(header.unsupported(name)),
    }
}

fn flag(header: &LineHeader, key: &str) -> Result<Option<bool>, Problem> {
    let Some(field) = header.get(key) else {
        return Ok(None);
    };
    match field.value.to_ascii_lowercase().as_str() {
        "true" | "1" => Ok(Some(true)),
        "false" | "0" => Ok(Some(false)),
        _ => Err(field.is("write True or False")),
    }
}

/// Refuses a field whose value is not one that is read.
fn only(header: &LineHeader, key: &str, values: &[&str], fix: &str) -> Result<(), Problem> {
    match header.get(key) {
        Some(field) if !values.contains(&field.value.as_str()) => Err(field.is(fix)),
        _ => Ok(()),
    }
}

fn grid(header: &LineHeader) -> Result<Grid, Problem> {
    header.required("ndims")?;
    only(header, "ndims", &["3"], "give a 3D volume")?;
    let one = "give a volume of one number per voxel";
    only(header, "elementnumberofchannels", &["1"], one)?;
    let skip = "write the data without a header of their own, and HeaderSize = 0";
    only(header, "headersize", &["0", "-1"], skip)?;
    if flag(header, "binarydata")? == Some(false) {
        let fix = "write the volume with binary data";
        return Err(header.required("binarydata")?.is(fix));
    }
    let kind = header.required("elementtype")?;
    let convert = "convert to MET_UCHAR, MET_SHORT, MET_USHORT or MET_FLOAT";
    let own = flag(header, "binarydatabyteordermsb")?;
    let big = own.or(flag(header, "elementbyteordermsb")?);
    Ok(Grid {
        sizes: header.required("dimsize")?.sizes()?,
        spacings: spacings(header)?,
        kind: scalar(&kind.value).ok_or_else(|| kind.is_not("supported", convert))?,
        endian: match big {
            Some(true) => Endian::Big,
            _ => Endian::Little,
        },
    })
}

/// The distances of voxels; without them their sizes, and 1 where the header is silent.
fn spacings(header: &LineHeader) -> Result<[f64; 3], Problem> {
    let size = || header.get("elementsize");
    match header.get("elementspacing").or_else(size) {
        Some(field) => field.spacings(three_spacings(&field.value)),
        None => Ok([1.0; 3]),
    }
}

/// The data behind the header, as many as are packed.
fn attached<'a>(
    header: &LineHeader,
    rest: &'a [u8],
    packing: Packing,
) -> Result<&'a [u8], Problem> {
    match header.get("compresseddatasize") {
        Some(field) if packing != Packing::None && field.value.parse() != Ok(rest.len()) => {
            let found = format!("'{}' beside {} bytes", shorten(&field.value), rest.len());
            Err(field.malformed(found, "fetch the file again: it is truncated"))
        }
        _ => Ok(rest),
    }
}

fn is_turned(header: &LineHeader) -> Result<bool, Problem> {
    let Some(field) = TURNS.iter().find_map(|key| header.get(key)) else {
        return Ok(false);
    };
    let fix = "write the three axes of the grid, or leave it out";
    let axes: [f64; 9] = numbers(&field.value).ok_or_else(|| field.is_not("nine numbers", fix))?;
    Ok(axes != UNTURNED)
}

fn scalar(name: &str) -> Option<Scalar> {
    Some(match name {
        "MET_CHAR" => Scalar::I8,
        "MET_UCHAR" => Scalar::U8,
        "MET_SHORT" => Scalar::I16,
        "MET_USHORT" => Scalar::U16,
        "MET_INT" => Scalar::I32,
        "MET_UINT" => Scalar::U32,
        "MET_FLOAT" => Scalar::F32,
        "MET_DOUBLE" => Scalar::F64,
        _ => return None,
    })
}
