//! VTK's XML image data (`.vti`), as VTK, ParaView and pyevtk write them: one piece, the numbers of one array as text,
//! in base64 or appended.
//!
//! The XML is read by `roxmltree`, which allows no entities, so that a short file cannot unfold. Appended raw bytes are
//! no XML, so they are cut out first. Binary data are a count of bytes and the bytes, or with a compressor: number of
//! blocks, size of a block, size of the last (0: as the others), packed sizes, and each block in a zlib stream; counts
//! have 32 or 64 bits as `header_type` says.

use super::super::bytes::{Endian, Reader, Scalar, unzlib_exact};
use super::super::error::{Problem, shorten};
use super::{Grid, UNTURNED, Volume, exact, three_spacings, turned};
use crate::memory;
use anyhow::{Context, anyhow, bail, ensure};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use roxmltree::{Document, Node, ParsingOptions};

const APPENDED: &[u8] = b"<AppendedData";
const APPENDED_END: &[u8] = b"</AppendedData>";
/// Most elements and attributes of a file: arrays and their descriptions.
const MOST_NODES: u32 = 1 << 16;
/// Largest block of a compressed array.
const MOST_BLOCK: u64 = 1 << 32;

/// Loads a volume.
pub(in super::super) fn load(bytes: &[u8]) -> Result<Volume, Problem> {
    let (text, appended) = split(bytes)?;
    let options = ParsingOptions {
        nodes_limit: MOST_NODES,
        ..ParsingOptions::default()
    };
    let document = Document::parse_with_options(&text, options)
        .map_err(|error| anyhow!("VTI, XML: it is not understood: {error}; fetch it again"))?;
    volume(document.root_element(), appended)
}

/// The XML without what is appended, and that.
fn split(bytes: &[u8]) -> Result<(String, Option<&[u8]>), Problem> {
    let in_utf8 = |bytes: &[u8]| {
        let text = std::str::from_utf8(bytes).map(str::to_owned);
        text.map_err(|_| anyhow!("VTI, XML: it is not in UTF-8; write it again with VTK"))
    };
    let Some(start) = find(bytes, APPENDED) else {
        return Ok((in_utf8(bytes)?, None));
    };
    let damaged = || anyhow!("VTI, AppendedData: its end is missing; fetch the file again");
    let open = find(&bytes[start..], b">").ok_or_else(damaged)? + start + 1;
    let end = rfind(bytes, APPENDED_END).filter(|end| *end >= open);
    let end = end.ok_or_else(damaged)?;
    let text = in_utf8(&bytes[..open])? + &in_utf8(&bytes[end..])?;
    let blank = |byte: &u8| byte.is_ascii_whitespace();
    let data = &bytes[open..end];
    let first = data.iter().position(|byte| !blank(byte));
    match first.map(|first| &data[first..]) {
        Some([b'_', data @ ..]) => Ok((text, Some(data))),
        _ => bail!("VTI, AppendedData: it does not begin with _; write it again with VTK"),
    }
}

fn find(bytes: &[u8], what: &[u8]) -> Option<usize> {
    bytes.windows(what.len()).position(|window| window == what)
}

fn rfind(bytes: &[u8], what: &[u8]) -> Option<usize> {
    bytes.windows(what.len()).rposition(|window| window == what)
}

/// A child element that must be there.
fn child<'a>(parent: Node<'a, 'a>, name: &str) -> Result<Node<'a, 'a>, Problem> {
    parent
        .children()
        .find(|node| node.has_tag_name(name))
        .with_context(|| {
            format!("VTI, {name}: it is missing; write image data with VTK's XML writer")
        })
}

/// An attribute that must have one of some values where it is there; the first is what stands for none.
fn one_of<'a>(node: Node<'a, 'a>, name: &str, values: &[&'a str]) -> Result<&'a str, Problem> {
    match node.attribute(name) {
        None => Ok(values.first().copied().unwrap_or_default()),
        Some(value) if values.contains(&value) => Ok(value),
        Some(other) => bail!(
            "VTI, {name}: '{}' is not read; {} are read; write it again",
            shorten(other),
            values.join(" and ")
        ),
    }
}

fn volume<'a>(root: Node<'a, 'a>, appended: Option<&[u8]>) -> Result<Volume, Problem> {
    ensure!(
        root.has_tag_name("VTKFile") && root.attribute("type") == Some("ImageData"),
        "VTI, VTKFile: it is no VTKFile of type ImageData; write a regular grid as .vti"
    );
    let endian = match one_of(root, "byte_order", &["LittleEndian", "BigEndian"])? {
        "BigEndian" => Endian::Big,
        _ => Endian::Little,
    };
    let counts = match one_of(root, "header_type", &["UInt32", "UInt64"])? {
        "UInt64" => Scalar::U64,
        _ => Scalar::U32,
    };
    let packed = !one_of(root, "compressor", &["", "vtkZLibDataCompressor"])?.is_empty();
    let image = child(root, "ImageData")?;
    let piece = child(image, "Piece")?;
    let whole = extent(image, "WholeExtent")?;
    ensure!(
        extent(piece, "Extent")? == whole,
        "VTI, Piece: it is not the whole extent; write the volume in one piece"
    );
    let mut notes = Vec::new();
    let (array, corners) = chosen(piece, &mut notes)?;
    let direction = image.attribute("Direction");
    let is_turned = direction.is_some_and(|axes| super::numbers(axes) != Some(UNTURNED));
    notes.extend(turned(is_turned));
    let grid = Grid {
        sizes: sizes(whole, corners)?,
        spacings: spacings(image)?,
        kind: kind(array)?,
        endian,
    };
    let needed = grid.bytes("WholeExtent")?;
    let text = array.text().unwrap_or_default();
    let encoding = VtiEncoding {
        counts,
        endian,
        packed,
    };
    let stored = match one_of(array, "format", &["ascii", "binary", "appended"])? {
        "binary" => encoding.encoded(text.trim().as_bytes(), needed)?,
        "appended" => {
            let missing = "VTI, AppendedData: it is missing; fetch the file again";
            let data = appended_at(array, appended.context(missing)?)?;
            match one_of(child(root, "AppendedData")?, "encoding", &["base64", "raw"])? {
                "raw" => encoding.unpacked(data, needed, "appended data")?,
                _ => encoding.encoded(data, needed)?,
            }
        }
        _ => {
            let values = numbers(text, grid.count("WholeExtent")?)?;
            return Ok(grid.volume(values, notes));
        }
    };
    Ok(grid.volume(grid.decode(&stored)?, notes))
}

fn appended_at<'a>(array: Node, data: &'a [u8]) -> Result<&'a [u8], Problem> {
    let offset = array.attribute("offset").unwrap_or_default();
    let place = offset.parse::<usize>().ok();
    place.and_then(|place| data.get(place..)).with_context(|| {
        format!(
            "VTI, DataArray offset: '{}' beside {} bytes; fetch the file again",
            shorten(offset),
            data.len()
        )
    })
}

/// How the bytes of arrays are stored.
struct VtiEncoding {
    /// Of the counts before the data.
    counts: Scalar,
    endian: Endian,
    packed: bool,
}

impl VtiEncoding {
    fn count(&self, reader: &mut Reader, field: &str) -> Result<u64, Problem> {
        let stored = reader.take(self.counts.size(), field)?;
        Ok(self.counts.decode(stored, self.endian) as u64)
    }

    /// Bytes in base64: counts and data in one run, or with a compressor in two. What follows belongs to other arrays.
    fn encoded(&self, text: &[u8], needed: u64) -> Result<Vec<u8>, Problem> {
        let width = self.counts.size() as u64;
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
            ensure!(
                count == needed,
                "VTI, {field}: it has {count} bytes where extent and type need {needed}; \
                 correct extent or type"
            );
            let data = reader.records(count, 1, field)?;
            return exact(data, needed).map(<[u8]>::to_vec);
        }
        let [blocks, size, last] = [
            self.count(&mut reader, field)?,
            self.count(&mut reader, field)?,
            self.count(&mut reader, field)?,
        ];
        let whole = blocks.saturating_sub(u64::from(last > 0));
        let total = whole
            .checked_mul(size)
            .and_then(|bytes| bytes.checked_add(last));
        ensure!(
            total == Some(needed) && size <= MOST_BLOCK && last <= size && blocks != 0,
            "VTI, {field}: {blocks} blocks of {size} bytes, the last of {last}, are not {needed} bytes; \
             correct extent or type, or fetch the file again"
        );
        let sizes = reader.records(blocks, self.counts.size(), field)?;
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
        anyhow!("VTI, {field}: it is no base64 ({error}); fetch the file again")
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
    let values = values.context("VTI, DataArray: a word in it is no number; write it again")?;
    ensure!(
        values.len() as u64 == count,
        "VTI, DataArray: it has {} numbers where the extent needs {count}; correct the extent",
        values.len()
    );
    Ok(values)
}

/// The array that is drawn: the active one, or the first of one component. True for numbers at the grid's corners,
/// false for those of cells.
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
    bail!(
        "VTI, PointData: no array of one number per point or cell; \
         write the volume with a scalar array"
    )
}

fn extent(node: Node, name: &str) -> Result<[i64; 6], Problem> {
    let text = node.attribute(name).unwrap_or_default();
    super::numbers(text).with_context(|| {
        format!(
            "VTI, {name}: '{}' is not six whole numbers; \
             write the first and last index along x, y and z",
            shorten(text)
        )
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
            bail!("VTI, WholeExtent: {extent:?} holds nothing; write a grid of three axes")
        }
    }
}

fn spacings(image: Node) -> Result<[f64; 3], Problem> {
    let Some(text) = image.attribute("Spacing") else {
        return Ok([1.0; 3]);
    };
    three_spacings(text).with_context(|| {
        format!(
            "VTI, Spacing: '{}' is not three positive lengths; \
             write the distances between points along x, y and z",
            shorten(text)
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
        other => bail!(
            "VTI, DataArray type: '{}' is not read; write integers of 8 to 32 bits or floats",
            shorten(other)
        ),
    })
}
