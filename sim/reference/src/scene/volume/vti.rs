//! VTK's XML image data (`.vti`), as VTK, ParaView and pyevtk write them: one piece, the numbers of one array as text, in base64 or appended.
//!
//! The XML is read by `roxmltree`, which allows no entities, so that a short file cannot unfold. Appended raw bytes are no XML, so they
//! are cut out first. Binary data are a count of bytes and the bytes, or with a compressor: number of blocks, size of a block, size of the last
//! (0: as the others), packed sizes, and each block in a zlib stream; counts have 32 or 64 bits as `header_type` says.

use super::super::bytes::{Endian, Reader, Scalar, unzlib_exact};
use super::super::error::{Problem, shorten};
use super::{Grid, Noted, TURNED, UNTURNED, exact, three_spacings};
use crate::memory;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use roxmltree::{Document, Node, ParsingOptions};

const APPENDED: &[u8] = b"<AppendedData";
const APPENDED_END: &[u8] = b"</AppendedData>";
/// Most elements and attributes of a file: arrays and their descriptions.
const MOST_NODES: u32 = 1 << 16;
/// Largest block of a compressed array.
const MOST_BLOCK: u64 = 1 << 32;

fn malformed(field: &str, found: impl std::fmt::Display, fix: &str) -> Problem {
    Problem::malformed(format!("VTI, {field}"), found, fix)
}

/// Loads a volume.
pub(in super::super) fn load(bytes: &[u8]) -> Result<Noted, Problem> {
    let (text, appended) = split(bytes)?;
    let options = ParsingOptions {
        nodes_limit: MOST_NODES,
        ..ParsingOptions::default()
    };
    let document = Document::parse_with_options(&text, options).map_err(|error| {
        malformed(
            "XML",
            format!("it is not understood: {error}"),
            "fetch it again",
        )
    })?;
    let file = VtiFile::read(document.root_element(), appended)?;
    file.volume()
}

/// The XML without what is appended, and that.
fn split(bytes: &[u8]) -> Result<(String, Option<&[u8]>), Problem> {
    let in_utf8 = |bytes: &[u8]| {
        let text = std::str::from_utf8(bytes).map(str::to_owned);
        text.map_err(|_| malformed("XML", "it is not in UTF-8", "write it again with VTK"))
    };
    let Some(start) = find(bytes, APPENDED) else {
        return Ok((in_utf8(bytes)?, None));
    };
    let damaged = || malformed("AppendedData", "its end is missing", "fetch the file again");
    let open = find(&bytes[start..], b">").ok_or_else(damaged)? + start + 1;
    let end = rfind(bytes, APPENDED_END).filter(|end| *end >= open);
    let end = end.ok_or_else(damaged)?;
    let text = in_utf8(&bytes[..open])? + &in_utf8(&bytes[end..])?;
    let blank = |byte: &u8| byte.is_ascii_whitespace();
    let data = &bytes[open..end];
    let first = data.iter().position(|byte| !blank(byte));
    match first.map(|first| &data[first..]) {
        Some([b'_', data @ ..]) => Ok((text, Some(data))),
        _ => Err(malformed(
            "AppendedData",
            "it does not begin with _",
            "write it again with VTK",
        )),
    }
}

fn find(bytes: &[u8], what: &[u8]) -> Option<usize> {
    bytes.windows(what.len()).position(|window| window == what)
}

fn rfind(bytes: &[u8], what: &[u8]) -> Option<usize> {
    bytes.windows(what.len()).rposition(|window| window == what)
}

/// What the elements say.
struct VtiFile<'a> {
    grid: Grid,
    array: Node<'a, 'a>,
    appended: Option<(&'a [u8], bool)>,
    wide: bool,
    packed: bool,
    notes: Vec<String>,
}

/// A child element that must be there.
fn child<'a>(parent: Node<'a, 'a>, name: &str) -> Result<Node<'a, 'a>, Problem> {
    parent
        .children()
        .find(|node| node.has_tag_name(name))
        .ok_or_else(|| {
            malformed(
                name,
                "it is missing",
                "write image data with VTK's XML writer",
            )
        })
}

/// An attribute that must have one of some values where it is there; the first is what stands for none.
fn one_of<'a>(node: Node<'a, 'a>, name: &str, values: &[&'a str]) -> Result<&'a str, Problem> {
    match node.attribute(name) {
        None => Ok(values.first().copied().unwrap_or_default()),
        Some(value) if values.contains(&value) => Ok(value),
        Some(other) => Err(malformed(
            name,
            format!("'{}' is not read", shorten(other)),
            &format!("{} are read; write it again", values.join(" and ")),
        )),
    }
}

impl<'a> VtiFile<'a> {
    fn read(root: Node<'a, 'a>, appended: Option<&'a [u8]>) -> Result<VtiFile<'a>, Problem> {
        if !root.has_tag_name("VTKFile") || root.attribute("type") != Some("ImageData") {
            let found = "it is no VTKFile of type ImageData";
            return Err(malformed("VTKFile", found, "write a regular grid as .vti"));
        }
        let endian = match one_of(root, "byte_order", &["LittleEndian", "BigEndian"])? {
            "BigEndian" => Endian::Big,
            _ => Endian::Little,
        };
        let wide = one_of(root, "header_type", &["UInt32", "UInt64"])? == "UInt64";
        let packed = !one_of(root, "compressor", &["", "vtkZLibDataCompressor"])?.is_empty();
        let image = child(root, "ImageData")?;
        let piece = child(image, "Piece")?;
        let whole = extent(image, "WholeExtent")?;
        if extent(piece, "Extent")? != whole {
            let found = "it is not the whole extent";
            return Err(malformed("Piece", found, "write the volume in one piece"));
        }
        let mut notes = Vec::new();
        let (array, corners) = chosen(piece, &mut notes)?;
        let direction = image.attribute("Direction");
        if direction.is_some_and(|axes| super::numbers(axes) != Some(UNTURNED)) {
            notes.push(TURNED.to_owned());
        }
        let appended = match appended {
            None => None,
            Some(data) => {
                let element = child(root, "AppendedData")?;
                let raw = one_of(element, "encoding", &["base64", "raw"])? == "raw";
                Some((data, raw))
            }
        };
        let grid = Grid {
            sizes: sizes(whole, corners)?,
            spacings: spacings(image)?,
            kind: kind(array)?,
            endian,
        };
        Ok(VtiFile {
            grid,
            array,
            appended,
            wide,
            packed,
            notes,
        })
    }

    fn volume(self) -> Result<Noted, Problem> {
        let needed = self.grid.bytes("WholeExtent")?;
        let format = one_of(self.array, "format", &["ascii", "binary", "appended"])?;
        let text = || self.array.text().unwrap_or_default();
        let values = match (format, self.appended) {
            ("binary", _) => self
                .grid
                .decode(&self.encoded(text().trim().as_bytes(), needed)?)?,
            ("appended", Some((data, raw))) => {
                let data = self.appended_at(data)?;
                let stored = if raw {
                    self.unpacked(data, needed, "appended data")?
                } else {
                    self.encoded(data, needed)?
                };
                self.grid.decode(&stored)?
            }
            ("appended", None) => {
                return Err(malformed(
                    "AppendedData",
                    "it is missing",
                    "fetch the file again",
                ));
            }
            _ => numbers(text(), self.grid.count("WholeExtent")?)?,
        };
        Ok((self.grid.volume(values), self.notes))
    }

    fn appended_at(&self, data: &'a [u8]) -> Result<&'a [u8], Problem> {
        let offset = self.array.attribute("offset").unwrap_or_default();
        let place = offset.parse::<usize>().ok();
        place.and_then(|place| data.get(place..)).ok_or_else(|| {
            let found = format!("'{}' beside {} bytes", shorten(offset), data.len());
            malformed("DataArray offset", found, "fetch the file again")
        })
    }

    fn count_bytes(&self) -> usize {
        if self.wide { 8 } else { 4 }
    }

    fn count(&self, reader: &mut Reader, field: &str) -> Result<u64, Problem> {
        let stored = reader.take(self.count_bytes(), field)?;
        let mut word = [0u8; 8];
        for (place, byte) in stored.iter().enumerate() {
            word[place] = *byte;
        }
        match self.grid.endian {
            Endian::Little => Ok(u64::from_le_bytes(word)),
            // The four bytes of a short one stand at the word's begin.
            Endian::Big => Ok(u64::from_be_bytes(word) >> (64 - 8 * stored.len() as u32)),
        }
    }

    /// Bytes in base64: counts and data in one run, or with a compressor in two. What follows belongs to other arrays.
    fn encoded(&self, text: &[u8], needed: u64) -> Result<Vec<u8>, Problem> {
        let width = self.count_bytes() as u64;
        let field = "base64 data";
        if !self.packed {
            let whole = decoded(text, width.saturating_add(needed), field)?;
            return self.unpacked(&whole, needed, field);
        }
        let first = decoded(text, 3 * width, field)?;
        let blocks = self.count(&mut Reader::new(&first), field)?;
        // Every block has at least a byte.
        let counts = blocks.min(text.len() as u64).saturating_add(3) * width;
        let mut header = decoded(text, counts, field)?;
        let behind = text
            .get(encoded_length(counts) as usize..)
            .unwrap_or_default();
        let mut reader = Reader::new(&header);
        reader.take(3 * width as usize, field)?;
        let mut packed: u64 = 0;
        for _ in 0..blocks {
            packed = packed.saturating_add(self.count(&mut reader, field)?);
        }
        header.extend(decoded(behind, packed, field)?);
        self.unpacked(&header, needed, field)
    }

    /// The array's bytes behind their counts.
    fn unpacked(&self, data: &[u8], needed: u64, field: &str) -> Result<Vec<u8>, Problem> {
        let mut reader = Reader::new(data);
        if !self.packed {
            let count = self.count(&mut reader, field)?;
            if count != needed {
                let found = format!("it has {count} bytes where extent and type need {needed}");
                return Err(malformed(field, found, "correct extent or type"));
            }
            let data = reader.records(count, 1, field)?;
            return exact(data, needed).map(<[u8]>::to_vec);
        }
        let [blocks, size, last] = [
            self.count(&mut reader, field)?,
            self.count(&mut reader, field)?,
            self.count(&mut reader, field)?,
        ];
        let absurd = || {
            let found = format!(
                "{blocks} blocks of {size} bytes, the last of {last}, are not {needed} bytes"
            );
            malformed(
                field,
                found,
                "correct extent or type, or fetch the file again",
            )
        };
        let whole = if last > 0 {
            blocks.saturating_sub(1)
        } else {
            blocks
        };
        let total = whole
            .checked_mul(size)
            .and_then(|bytes| bytes.checked_add(last));
        if total != Some(needed) || size > MOST_BLOCK || last > size || blocks == 0 {
            return Err(absurd());
        }
        let sizes = reader.records(blocks, self.count_bytes(), field)?;
        let mut sizes = Reader::new(sizes);
        let mut unpacked = memory::list(needed, field)?;
        for block in 0..blocks {
            let packed = self.count(&mut sizes, field)?;
            let packed = reader.records(packed, 1, field)?;
            let expected = if block < whole { size } else { last };
            unpacked.extend(unzlib_exact(packed, expected, 0, field)?);
        }
        Ok(unpacked)
    }
}

/// Characters of base64 for so many bytes.
fn encoded_length(bytes: u64) -> u64 {
    bytes.div_ceil(3).saturating_mul(4)
}

/// The first `bytes` bytes of a run in base64.
fn decoded(text: &[u8], bytes: u64, field: &str) -> Result<Vec<u8>, Problem> {
    let length = encoded_length(bytes);
    if length > text.len() as u64 {
        return Err(super::super::bytes::truncated(field, length, text.len()));
    }
    let mut found = STANDARD.decode(&text[..length as usize]).map_err(|error| {
        malformed(
            field,
            format!("it is no base64 ({error})"),
            "fetch the file again",
        )
    })?;
    found.truncate(bytes as usize);
    Ok(found)
}

/// Numbers as text.
fn numbers(text: &str, count: u64) -> Result<Vec<f32>, Problem> {
    let values: Option<Vec<f32>> = text
        .split_ascii_whitespace()
        .map(|word| word.parse::<f64>().ok().map(|value| value as f32))
        .collect();
    let values = values
        .ok_or_else(|| malformed("DataArray", "a word in it is no number", "write it again"))?;
    if values.len() as u64 != count {
        let found = format!(
            "it has {} numbers where the extent needs {count}",
            values.len()
        );
        return Err(malformed("DataArray", found, "correct the extent"));
    }
    Ok(values)
}

/// The array that is drawn: the active one, or the first of one component. True for numbers at the grid's corners, false for those of cells.
fn chosen<'a>(
    piece: Node<'a, 'a>,
    notes: &mut Vec<String>,
) -> Result<(Node<'a, 'a>, bool), Problem> {
    for (name, corners) in [("PointData", true), ("CellData", false)] {
        let Some(data) = piece.children().find(|node| node.has_tag_name(name)) else {
            continue;
        };
        let single = |node: &Node| {
            let components = node.attribute("NumberOfComponents").unwrap_or("1");
            node.has_tag_name("DataArray") && components == "1"
        };
        let arrays: Vec<Node> = data.children().filter(single).collect();
        let active = data.attribute("Scalars");
        let is_active = |node: &&Node| active.is_some() && node.attribute("Name") == active;
        let Some(array) = arrays.iter().find(is_active).or(arrays.first()) else {
            continue;
        };
        if arrays.len() > 1 {
            let shown = shorten(array.attribute("Name").unwrap_or_default());
            notes.push(format!("of {} arrays '{shown}' is drawn", arrays.len()));
        }
        return Ok((*array, corners));
    }
    let found = "no array of one number per point or cell";
    Err(malformed(
        "PointData",
        found,
        "write the volume with a scalar array",
    ))
}

fn extent(node: Node, name: &str) -> Result<[i64; 6], Problem> {
    let text = node.attribute(name).unwrap_or_default();
    super::numbers(text).ok_or_else(|| {
        let found = format!("'{}' is not six whole numbers", shorten(text));
        let fix = "write the first and last index along x, y and z";
        malformed(name, found, fix)
    })
}

/// Points are one more than cells along each axis.
fn sizes(extent: [i64; 6], corners: bool) -> Result<[usize; 3], Problem> {
    let size = |axis: usize| {
        let steps = extent[2 * axis + 1].checked_sub(extent[2 * axis])?;
        let size = steps.checked_add(i64::from(corners))?;
        usize::try_from(size).ok().filter(|size| *size > 0)
    };
    match [0, 1, 2].map(size) {
        [Some(x), Some(y), Some(z)] => Ok([x, y, z]),
        _ => {
            let found = format!("{extent:?} holds nothing");
            Err(malformed(
                "WholeExtent",
                found,
                "write a grid of three axes",
            ))
        }
    }
}

fn spacings(image: Node) -> Result<[f64; 3], Problem> {
    let Some(text) = image.attribute("Spacing") else {
        return Ok([1.0; 3]);
    };
    three_spacings(text).ok_or_else(|| {
        let found = format!("'{}' is not three positive lengths", shorten(text));
        malformed(
            "Spacing",
            found,
            "write the distances between points along x, y and z",
        )
    })
}

fn kind(array: Node) -> Result<Scalar, Problem> {
    let name = array.attribute("type").unwrap_or_default();
    Ok(match name {
        "Int8" => Scalar::I8,
        "UInt8" => Scalar::U8,
        "Int16" => Scalar::I16,
        "UInt16" => Scalar::U16,
        "Int32" => Scalar::I32,
        "UInt32" => Scalar::U32,
        "Float32" => Scalar::F32,
        "Float64" => Scalar::F64,
        other => {
            let found = format!("'{}' is not read", shorten(other));
            let fix = "write integers of 8 to 32 bits or floats";
            return Err(malformed("DataArray type", found, fix));
        }
    })
}
