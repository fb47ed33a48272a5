//! MetaImage volumes, as ITK and 3D Slicer write them: `.mha` with the data behind the header, `.mhd` with the data in a file beside it.
//!
//! `Key = value` lines up to `ElementDataFile`, which is the last and says `LOCAL` or a file's name. Three dimensions, one channel,
//! integers of 8 to 32 bits and floats in both byte orders; raw or packed by zlib. A header of its own dozen keys needs no library.

use super::super::bytes::{Endian, Scalar, unzlib_exact};
use super::super::error::{Problem, shorten};
use super::super::file::read_file;
use super::{Grid, Noted, TURNED, exact, three_sizes, three_spacings, unreadable};
use std::collections::BTreeMap;
use std::path::Path;

/// Keys that describe the data without changing how they are read.
const DESCRIPTIVE: [&str; 22] = [
    "comment",
    "objecttype",
    "objectsubtype",
    "transformtype",
    "name",
    "id",
    "parentid",
    "color",
    "centerofrotation",
    "offset",
    "origin",
    "position",
    "anatomicalorientation",
    "distanceunits",
    "modality",
    "elementmin",
    "elementmax",
    "elementnbits",
    "sequenceid",
    "imageposition",
    "creationdate",
    "acquisitiondate",
];

/// The keys that matter.
const KEYS: [&str; 14] = [
    "ndims",
    "dimsize",
    "elementtype",
    "elementspacing",
    "elementsize",
    "elementnumberofchannels",
    "binarydata",
    "binarydatabyteordermsb",
    "elementbyteordermsb",
    "compresseddata",
    "compresseddatasize",
    "headersize",
    "transformmatrix",
    "elementdatafile",
];
/// Names of [`KEYS`]' turn of the grid, which other versions use.
const TURNS: [&str; 3] = ["orientation", "rotation", "transformmatrix"];

const LAST: &str = "elementdatafile";

/// A value and the line on which it stands.
struct MetaImageField {
    line: usize,
    value: String,
}

struct MetaImageFields {
    found: BTreeMap<String, MetaImageField>,
    lines: usize,
}

/// Loads a volume; `folder` is where a data file is looked for.
pub(in super::super) fn load(bytes: &[u8], folder: Option<&Path>) -> Result<Noted, Problem> {
    let (fields, rest) = MetaImageFields::read(bytes)?;
    let grid = fields.grid()?;
    let needed = grid.bytes("DimSize")?;
    let packed = fields.flag("compresseddata")?.unwrap_or(false);
    let decode = |data: &[u8]| {
        if packed {
            grid.decode(&unzlib_exact(
                data,
                needed,
                grid.value_bytes(),
                "volume data",
            )?)
        } else {
            grid.decode(exact(data, needed)?)
        }
    };
    let file = fields.required(LAST)?;
    let values = match file.value.as_str() {
        "LOCAL" | "Local" | "local" => decode(fields.attached(rest, packed)?)?,
        name if name.is_empty() || name.contains('%') || name.starts_with("LIST") => {
            let found = format!("'{}' is not one file", shorten(name));
            let fix = "join the slices into one data file";
            return Err(malformed(file.line, "ElementDataFile", found, fix));
        }
        name => {
            let path = folder.unwrap_or(Path::new("")).join(name);
            decode(
                &read_file(&path).map_err(|problem| unreadable(&shorten(name), &path, &problem))?,
            )?
        }
    };
    let notes = if fields.is_turned()? {
        vec![TURNED.to_owned()]
    } else {
        Vec::new()
    };
    Ok((grid.volume(values), notes))
}

fn malformed(line: usize, field: &str, found: impl std::fmt::Display, fix: &str) -> Problem {
    Problem::malformed(format!("MetaImage header line {line}, {field}"), found, fix)
}

impl MetaImageFields {
    /// The header's fields, and what follows it.
    fn read(bytes: &[u8]) -> Result<(MetaImageFields, &[u8]), Problem> {
        let mut fields = MetaImageFields {
            found: BTreeMap::new(),
            lines: 0,
        };
        let mut rest = bytes;
        while !rest.is_empty() {
            let end = rest.iter().position(|byte| *byte == b'\n');
            let text = String::from_utf8_lossy(&rest[..end.unwrap_or(rest.len())]);
            fields.lines += 1;
            let Some(end) = end else {
                let found = "it ends in the middle of a line";
                return Err(malformed(
                    fields.lines,
                    "header",
                    found,
                    "fetch the file again",
                ));
            };
            rest = &rest[end + 1..];
            if fields.add(text.trim())? {
                return Ok((fields, rest));
            }
        }
        fields.required(LAST).map(|_| ())?;
        Ok((fields, rest))
    }

    /// Takes one line; true for the header's last.
    fn add(&mut self, line: &str) -> Result<bool, Problem> {
        if line.is_empty() {
            return Ok(false);
        }
        let Some((name, value)) = line.split_once('=') else {
            let found = format!("'{}' is no field", shorten(line));
            return Err(malformed(
                self.lines,
                "header",
                found,
                "write 'Key = value'",
            ));
        };
        let (shown, value) = (name.trim(), value.trim());
        let name = shown.to_ascii_lowercase();
        if name == "objecttype" && !value.eq_ignore_ascii_case("image") {
            let found = format!("it is '{}'", shorten(value));
            return Err(malformed(
                self.lines,
                shown,
                found,
                "give a file of an Image",
            ));
        }
        if DESCRIPTIVE.contains(&name.as_str()) {
            return Ok(false);
        }
        if !is_key(&name) {
            let fix = "remove it if the data can be read without it, or convert the volume";
            return Err(malformed(
                self.lines,
                &shorten(shown),
                "this field is not supported",
                fix,
            ));
        }
        let field = MetaImageField {
            line: self.lines,
            value: value.to_owned(),
        };
        let last = name == LAST;
        match self.found.insert(name, field) {
            Some(_) => Err(malformed(
                self.lines,
                shown,
                "it is given twice",
                "give it once",
            )),
            None => Ok(last),
        }
    }

    fn required(&self, name: &str) -> Result<&MetaImageField, Problem> {
        self.found.get(name).ok_or_else(|| {
            let fix = "add it before the data";
            malformed(self.lines, name, "the header lacks it", fix)
        })
    }

    fn flag(&self, name: &str) -> Result<Option<bool>, Problem> {
        let Some(field) = self.found.get(name) else {
            return Ok(None);
        };
        match field.value.to_ascii_lowercase().as_str() {
            "true" | "1" => Ok(Some(true)),
            "false" | "0" => Ok(Some(false)),
            other => {
                let found = format!("it is '{}'", shorten(other));
                Err(malformed(field.line, name, found, "write True or False"))
            }
        }
    }

    /// Refuses a field whose value is not the one that is read.
    fn only(&self, name: &str, values: &[&str], fix: &str) -> Result<(), Problem> {
        match self.found.get(name) {
            Some(field) if !values.contains(&field.value.as_str()) => {
                let found = format!("it is '{}'", shorten(&field.value));
                Err(malformed(field.line, name, found, fix))
            }
            _ => Ok(()),
        }
    }

    fn grid(&self) -> Result<Grid, Problem> {
        self.required("ndims")?;
        self.only("ndims", &["3"], "give a 3D volume")?;
        let one = "give a volume of one number per voxel";
        self.only("elementnumberofchannels", &["1"], one)?;
        let skip = "write the data without a header of their own, and HeaderSize = 0";
        self.only("headersize", &["0", "-1"], skip)?;
        if self.flag("binarydata")? == Some(false) {
            let line = self.required("binarydata")?.line;
            let fix = "write the volume with binary data";
            return Err(malformed(line, "BinaryData", "it is False", fix));
        }
        let kind = self.required("elementtype")?;
        let sizes = self.required("dimsize")?;
        Ok(Grid {
            sizes: three_sizes(&sizes.value).ok_or_else(|| {
                let found = format!(
                    "'{}' is not three positive whole numbers",
                    shorten(&sizes.value)
                );
                let fix = "write the number of voxels along x, y and z";
                malformed(sizes.line, "DimSize", found, fix)
            })?,
            spacings: self.spacings()?,
            kind: scalar(&kind.value).ok_or_else(|| {
                let found = format!("'{}' is not supported", shorten(&kind.value));
                let fix = "convert to MET_UCHAR, MET_SHORT, MET_USHORT or MET_FLOAT";
                malformed(kind.line, "ElementType", found, fix)
            })?,
            endian: self.endian()?,
        })
    }

    fn endian(&self) -> Result<Endian, Problem> {
        let own = self.flag("binarydatabyteordermsb")?;
        let big = own.or(self.flag("elementbyteordermsb")?);
        Ok(match big {
            Some(true) => Endian::Big,
            _ => Endian::Little,
        })
    }

    /// The distances of voxels; without them their sizes, and 1 where the header is silent.
    fn spacings(&self) -> Result<[f64; 3], Problem> {
        let size = || self.found.get("elementsize");
        let Some(field) = self.found.get("elementspacing").or_else(size) else {
            return Ok([1.0; 3]);
        };
        three_spacings(&field.value).ok_or_else(|| {
            let found = format!("'{}' is not three positive lengths", shorten(&field.value));
            let fix = "write the distances between voxels along x, y and z";
            malformed(field.line, "ElementSpacing", found, fix)
        })
    }

    /// The data behind the header, as many as are packed.
    fn attached<'a>(&self, rest: &'a [u8], packed: bool) -> Result<&'a [u8], Problem> {
        match self.found.get("compresseddatasize") {
            Some(field) if packed => {
                let size = field.value.parse::<usize>().ok();
                let size = size.filter(|size| *size == rest.len());
                size.map(|_| rest).ok_or_else(|| {
                    let found = format!("'{}' beside {} bytes", shorten(&field.value), rest.len());
                    let fix = "fetch the file again: it is truncated";
                    malformed(field.line, "CompressedDataSize", found, fix)
                })
            }
            _ => Ok(rest),
        }
    }

    fn is_turned(&self) -> Result<bool, Problem> {
        let Some(field) = TURNS.iter().find_map(|name| self.found.get(*name)) else {
            return Ok(false);
        };
        let numbers: Option<Vec<f64>> = field
            .value
            .split_whitespace()
            .map(|word| word.parse().ok())
            .collect();
        match numbers.as_deref() {
            Some(matrix) if matrix.len() == 9 => {
                Ok(*matrix != [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0])
            }
            _ => {
                let found = format!("'{}' is not nine numbers", shorten(&field.value));
                let fix = "write the three axes of the grid, or leave it out";
                Err(malformed(field.line, "TransformMatrix", found, fix))
            }
        }
    }
}

fn is_key(name: &str) -> bool {
    KEYS.contains(&name) || TURNS.contains(&name)
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
