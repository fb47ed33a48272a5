//! SOG, versions 1 and 2: every attribute as a lossless WebP picture, one pixel per Gaussian, row by row; in a folder
//! or a `.sog` zip.
//!
//! | `meta.json` | pictures | decoding |
//! |---|---|---|
//! | `means` | `means_l`, `means_u`: low and high bytes of x, y, z | `v = mins + (maxs - mins) word / 65535`, place = `sign(v) (e^abs(v) - 1)` |
//! | `quats` | `quats`: three parts, alpha 252 + the place of the largest of w, x, y, z | part = `(2 byte / 255 - 1) sqrt(1/2)` |
//! | `scales` | `scales` | `codebook[byte]`, a logarithm |
//! | `sh0` | `sh0`: colour and, in alpha, opacity / 255 | `f_dc = codebook[byte]` |
//! | `shN` | `shN_labels`: 16-bit number of a palette entry; `shN_centroids`: 64 entries a row, a pixel per coefficient | `codebook[byte]` |
//!
//! Version 1 says no version; a range per channel stands in the place of each codebook (byte / 255 of the way), opacity
//! is a logit, and the palette is as large as its picture.
//!
//! A picture of one colour packs to nothing whatever its size, so the count is bounded by the size of all files
//! together, and no picture may have many more pixels than there are Gaussians.

mod images;
mod meta;

use self::images::Pictures;
use self::meta::Meta;
use super::Scene;
use super::archive::{FileReader, unpacked};
use super::error::{Problem, shorten};
use super::file::read_file;
use super::gaussian::{GaussianScene, TRAINED_ANTIALIASED, room_for};
use anyhow::{anyhow, ensure};
use std::path::Path;

/// The file that names the others.
pub(super) const META: &str = "meta.json";
/// Bytes of all pictures of a Gaussian without harmonics.
const RECORD_BYTES: u64 = 20;
/// Largest size of the pictures' pixels, in sizes of the files.
const MAX_RATIO: u64 = 1040;
/// Largest meta.json: three codebooks of 256 numbers take 20 kB.
const MAX_META_BYTES: u64 = 1 << 20;

/// Where the files are.
enum SogSource<'a> {
    Folder(&'a Path),
    Bundle(FileReader<'a>, u64),
}

/// Loads a `.sog` bundle.
pub(super) fn load_bundle(bytes: &[u8], name: &str) -> Result<Scene, Problem> {
    let read = unpacked(bytes).map_err(|error| damaged("sog bundle", &error))?;
    let size = bytes.len() as u64;
    load(&SogSource::Bundle(read, size), name)
}

/// Loads a folder with its `meta.json`.
pub(super) fn load_folder(folder: &Path, name: &str) -> Result<Scene, Problem> {
    load(&SogSource::Folder(folder), name)
}

fn damaged(field: &str, reason: &str) -> Problem {
    anyhow!("{field}: damaged or truncated ({reason}); fetch it again")
}

impl SogSource<'_> {
    /// The bytes of one file, of `limit` bytes at most.
    fn read(&self, file: &str, limit: u64) -> Result<Vec<u8>, Problem> {
        let plain = !file.is_empty() && !file.contains(['/', '\\']) && file != "..";
        ensure!(
            plain,
            "{META}, files: '{}' is no plain name; the pictures must lie beside meta.json",
            shorten(file)
        );
        let bytes = match self {
            SogSource::Folder(folder) => read_file(&folder.join(file))
                .map_err(|problem| damaged(file, &problem.to_string()))?,
            SogSource::Bundle(read, _) => {
                read(file, limit).map_err(|error| damaged(file, &error))?
            }
        };
        ensure!(
            bytes.len() as u64 <= limit,
            "{file}: it has more than {limit} bytes; such a file cannot belong to this scene; \
             export it again"
        );
        Ok(bytes)
    }

    /// Bytes that the pictures of a scene are bounded by.
    fn size(&self, meta: &Meta) -> u64 {
        match self {
            SogSource::Bundle(_, size) => *size,
            SogSource::Folder(folder) => meta
                .files()
                .filter_map(|file| std::fs::metadata(folder.join(file)).ok())
                .map(|found| found.len())
                .fold(0, u64::saturating_add),
        }
    }
}

fn load(source: &SogSource, name: &str) -> Result<Scene, Problem> {
    let meta = Meta::parse(&source.read(META, MAX_META_BYTES)?)?;
    let size = source.size(&meta);
    let possible = size.saturating_mul(MAX_RATIO) / RECORD_BYTES;
    ensure!(
        meta.count <= possible,
        "{META}, count: {} Gaussians cannot be in {size} bytes; \
         correct the count or fetch the files again",
        meta.count
    );
    room_for(0, meta.count, meta.count.saturating_mul(RECORD_BYTES))?;
    let count = meta.count as usize;
    let pictures = Pictures::read(&meta, source, size)?;
    let degree = pictures.degree();
    let mut scene = GaussianScene::new(degree, meta.count)?;
    if meta.model.as_deref() == Some("antialiased") {
        scene.rules = TRAINED_ANTIALIASED;
    }
    for index in 0..count {
        pictures.read_harmonics(&meta, index, &mut scene.harmonics)?;
        scene.push(&pictures.gaussian(&meta, index));
    }
    scene.finish(name)
}

#[cfg(test)]
mod tests;
