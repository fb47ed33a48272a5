//! From a glTF file's bytes to the numbers of an accessor. Nothing is copied and nothing allocated on a count's word:
//! an accessor is refused unless its buffer holds all of it.

use super::super::bytes::{Endian, Reader, Scalar};
use super::super::error::{Problem, shorten};
use super::super::file::read_file;
use super::{Document, at};
use anyhow::{Context, anyhow, bail, ensure};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::Deserialize;
use std::borrow::Cow;
use std::path::Path;

const MAGIC: &[u8; 4] = b"glTF";
const JSON_CHUNK: &[u8; 4] = b"JSON";
const BINARY_CHUNK: &[u8; 4] = b"BIN\0";

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Accessor {
    buffer_view: Option<usize>,
    #[serde(default)]
    byte_offset: usize,
    component_type: u32,
    #[serde(default)]
    normalized: bool,
    count: usize,
    #[serde(rename = "type")]
    kind: String,
    sparse: Option<serde::de::IgnoredAny>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct GltfView {
    buffer: usize,
    #[serde(default)]
    byte_offset: usize,
    byte_length: usize,
    byte_stride: Option<usize>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct GltfBuffer {
    uri: Option<String>,
    byte_length: usize,
}

/// The JSON and the binary part of a `.glb`; a `.gltf` is JSON alone.
pub(super) fn split(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), Problem> {
    if !bytes.starts_with(MAGIC) {
        return Ok((bytes, None));
    }
    let mut reader = Reader::new(bytes);
    reader.take(4, "glb magic")?;
    let version: u32 = reader.little("glb version")?;
    let length: u32 = reader.little("glb length")?;
    ensure!(
        version == 2,
        "glb version: it is {version}; version 2 is read; export the scene again"
    );
    ensure!(
        length as usize == bytes.len(),
        "glb length: the header says {length} bytes, the file has {}; \
         fetch the file again: it is truncated",
        bytes.len()
    );
    let json = chunk(&mut reader, JSON_CHUNK, "glb JSON chunk")?;
    let binary = match reader.remaining() {
        0 => None,
        _ => Some(chunk(&mut reader, BINARY_CHUNK, "glb binary chunk")?),
    };
    Ok((json, binary))
}

fn chunk<'a>(reader: &mut Reader<'a>, kind: &[u8; 4], field: &str) -> Result<&'a [u8], Problem> {
    let length: u32 = reader.little(field)?;
    let found: [u8; 4] = reader.array(field)?;
    ensure!(
        found == *kind,
        "{field}: a chunk of another type is in its place; export the scene again"
    );
    reader.take(length as usize, field)
}

/// The bytes of all buffers.
pub(super) struct Buffers<'a>(Vec<Cow<'a, [u8]>>);

/// The values of one accessor.
pub(super) struct Numbers<'a> {
    bytes: &'a [u8],
    stride: usize,
    pub(super) count: usize,
    scalar: Scalar,
    /// What a stored integer is divided by.
    unit: f64,
}

impl<'a> Buffers<'a> {
    pub(super) fn load(
        document: &Document,
        binary: Option<&'a [u8]>,
        folder: Option<&Path>,
    ) -> Result<Buffers<'a>, Problem> {
        let mut buffers = Vec::new();
        for (index, buffer) in document.buffers.iter().enumerate() {
            let field = format!("buffer {index}");
            let bytes = match (&buffer.uri, binary) {
                (Some(uri), _) => Cow::Owned(fetch(uri, folder, &field)?),
                (None, Some(binary)) if index == 0 => Cow::Borrowed(binary),
                (None, _) => bail!(
                    "{field}: it has neither a uri nor a binary chunk; \
                     export the scene again, or keep the .bin file beside it"
                ),
            };
            if bytes.len() < buffer.byte_length {
                return Err(super::super::bytes::truncated(
                    &field,
                    buffer.byte_length as u64,
                    bytes.len(),
                ));
            }
            buffers.push(bytes);
        }
        Ok(Buffers(buffers))
    }

    /// An accessor's numbers, `width` per element.
    pub(super) fn numbers(
        &self,
        document: &Document,
        index: usize,
        width: usize,
        name: &str,
    ) -> Result<Numbers<'_>, Problem> {
        let accessor = at(&document.accessors, "accessor", index)?;
        let field = format!("accessor {index} ({name})");
        let kind = ["", "SCALAR", "VEC2", "VEC3", "VEC4"][width];
        ensure!(
            accessor.kind == kind,
            "{field}: its type is '{}'; {kind} is needed; export the scene again",
            shorten(&accessor.kind)
        );
        ensure!(
            accessor.sparse.is_none(),
            "{field}: it is sparse; export the scene without sparse accessors"
        );
        let (scalar, greatest) = match (accessor.component_type, accessor.normalized) {
            (5126, _) => (Scalar::F32, 1.0),
            (5120, true) => (Scalar::I8, 127.0),
            (5121, true) => (Scalar::U8, 255.0),
            (5122, true) => (Scalar::I16, 32_767.0),
            (5123, true) => (Scalar::U16, 65_535.0),
            (other, _) => bail!(
                "{field}: its component type is {other}; \
                 floats (5126) or normalised integers are read"
            ),
        };
        let view_index = accessor
            .buffer_view
            .with_context(|| format!("{field}: it has no buffer view; export the scene again"))?;
        let view = at(&document.buffer_views, "buffer view", view_index)?;
        let buffer = at(&self.0, "buffer", view.buffer)?;
        let whole = view
            .byte_offset
            .checked_add(view.byte_length)
            .and_then(|end| buffer.get(view.byte_offset..end));
        let whole = whole.and_then(|whole| whole.get(accessor.byte_offset..));
        let element = width * scalar.size();
        let stride = view.byte_stride.unwrap_or(element);
        let needed = match accessor.count {
            0 => bail!("{field}: its count is 0; export a scene with splats in it"),
            count => (count - 1)
                .checked_mul(stride)
                .and_then(|bytes| bytes.checked_add(element)),
        };
        match (whole, needed) {
            (Some(bytes), Some(needed)) if stride >= element && needed <= bytes.len() => {
                Ok(Numbers {
                    bytes,
                    stride,
                    count: accessor.count,
                    scalar,
                    unit: greatest,
                })
            }
            _ => bail!(
                "{field}: {} elements of {stride} bytes do not fit its buffer view; \
                 the file is truncated or its counts are wrong; export the scene again",
                accessor.count
            ),
        }
    }
}

/// A data URI's bytes, or those of a file beside the scene.
fn fetch(uri: &str, folder: Option<&Path>, field: &str) -> Result<Vec<u8>, Problem> {
    if let Some(data) = uri.strip_prefix("data:") {
        let packed = data.split_once(";base64,").map(|(_, packed)| packed);
        let bytes = packed.and_then(|packed| STANDARD.decode(packed).ok());
        return bytes.with_context(|| {
            format!("{field}: its data URI is no base64; export the scene again")
        });
    }
    let plain = !uri.contains(['/', '\\', ':', '%']) && uri != "..";
    let path = folder.filter(|_| plain).map(|folder| folder.join(uri));
    let path = path.with_context(|| {
        format!(
            "{field}: its uri '{}' names no file beside the scene; \
             put the .bin file beside the .gltf file, or export a .glb",
            shorten(uri)
        )
    })?;
    read_file(&path).map_err(|problem| {
        anyhow!(
            "{field}: its file '{}' {problem}; \
             put the .bin file beside the .gltf file, or export a .glb",
            shorten(uri)
        )
    })
}

impl Numbers<'_> {
    /// Component `k` of element `index`.
    pub(super) fn at(&self, index: usize, k: usize) -> f64 {
        let first = index * self.stride + k * self.scalar.size();
        let stored = self.bytes.get(first..).unwrap_or_default();
        // Normalised integers: the most negative one is -1 as well.
        (self.scalar.decode(stored, Endian::Little) / self.unit).max(match self.scalar {
            Scalar::F32 => f64::NEG_INFINITY,
            _ => -1.0,
        })
    }

    pub(super) fn three(&self, index: usize) -> [f64; 3] {
        [0, 1, 2].map(|k| self.at(index, k))
    }
}
