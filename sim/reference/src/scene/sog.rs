//! SOG, version 2: every attribute as a lossless WebP picture, one pixel per Gaussian, row by row; in a folder or a `.sog` zip.
//!
//! | `meta.json` | pictures | decoding |
//! |---|---|---|
//! | `means` | `means_l`, `means_u`: low and high bytes of x, y, z | `v = mins + (maxs - mins) word / 65535`, place = `sign(v) (e^abs(v) - 1)` |
//! | `quats` | `quats`: three parts, alpha 252 + the place of the largest of w, x, y, z | part = `(2 byte / 255 - 1) sqrt(1/2)` |
//! | `scales` | `scales` | `codebook[byte]`, a logarithm |
//! | `sh0` | `sh0`: colour and, in alpha, opacity / 255 | `f_dc = codebook[byte]` |
//! | `shN` | `shN_labels`: 16-bit number of a palette entry; `shN_centroids`: 64 entries a row, a pixel per coefficient | `codebook[byte]` |
//!
//! A picture of one colour packs to nothing whatever its size, so the count is bounded by the size of all files together, and no
//! picture may have many more pixels than there are Gaussians.

use super::Scene;
use super::archive::Archive;
use super::error::Problem;
use super::gaussian::{
    Gaussian, GaussianScene, base_from_coefficient, coefficient_count, scale_from_log,
};
use super::load::read_file;
use super::quaternion::smallest_three;
use image_webp::WebPDecoder;
use serde::Deserialize;
use std::io::Cursor;
use std::path::Path;

/// The file that names the others.
pub(super) const META: &str = "meta.json";
/// Bytes of all pictures of a Gaussian without harmonics.
const RECORD_BYTES: u64 = 20;
/// Largest size of the pictures' pixels, in sizes of the files.
const MAX_RATIO: u64 = 1040;
/// Largest meta.json: three codebooks of 256 numbers take 20 kB.
const MAX_META_BYTES: u64 = 1 << 20;
/// Palette entries per row of `shN_centroids`.
const ENTRIES_PER_ROW: usize = 64;
/// Entries of a codebook: one per byte.
const CODES: usize = 256;

/// Where the files are.
enum SogSource<'a> {
    Folder(&'a Path),
    Bundle(Archive<'a>, u64),
}

/// Loads a `.sog` bundle.
pub(super) fn load_bundle(bytes: &[u8], name: &str) -> Result<Scene, Problem> {
    let archive = Archive::open(bytes).map_err(|error| damaged("sog bundle", &error))?;
    let size = bytes.len() as u64;
    load(&SogSource::Bundle(archive, size), name)
}

/// Loads a folder with its `meta.json`.
pub(super) fn load_folder(folder: &Path, name: &str) -> Result<Scene, Problem> {
    load(&SogSource::Folder(folder), name)
}

fn damaged(field: &str, reason: &str) -> Problem {
    Problem::malformed(
        field,
        format!("damaged or truncated ({reason})"),
        "fetch it again",
    )
}

impl SogSource<'_> {
    /// The bytes of one file, of `limit` bytes at most.
    fn read(&self, file: &str, limit: u64) -> Result<Vec<u8>, Problem> {
        let plain = !file.is_empty() && !file.contains(['/', '\\']) && file != "..";
        if !plain {
            return Err(Problem::malformed(
                format!("{META}, files"),
                format!("'{}' is no plain name", shorten(file)),
                "the pictures must lie beside meta.json",
            ));
        }
        let bytes = match self {
            SogSource::Folder(folder) => read_file(&folder.join(file))
                .map_err(|problem| damaged(file, &problem.to_string()))?,
            SogSource::Bundle(archive, _) => archive
                .read(file, limit)
                .map_err(|error| damaged(file, &error))?,
        };
        if bytes.len() as u64 > limit {
            return Err(Problem::malformed(
                file,
                format!("it has more than {limit} bytes"),
                "such a file cannot belong to this scene; export it again",
            ));
        }
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

#[derive(Deserialize)]
struct Meta {
    version: Option<u32>,
    count: u64,
    means: Means,
    scales: Coded,
    quats: Plain,
    sh0: Coded,
    #[serde(rename = "shN")]
    rest: Option<HarmonicsPalette>,
}

#[derive(Deserialize)]
struct Means {
    mins: [f64; 3],
    maxs: [f64; 3],
    files: [String; 2],
}

#[derive(Deserialize)]
struct Plain {
    files: [String; 1],
}

#[derive(Deserialize)]
struct Coded {
    codebook: Vec<f64>,
    files: [String; 1],
}

#[derive(Deserialize)]
struct HarmonicsPalette {
    count: usize,
    bands: u8,
    codebook: Vec<f64>,
    files: [String; 2],
}

/// What tells the versions apart before the rest is looked at.
#[derive(Deserialize)]
struct Version {
    version: Option<u32>,
}

impl Meta {
    fn parse(text: &[u8]) -> Result<Meta, Problem> {
        let wrong = |error: serde_json::Error| {
            Problem::malformed(
                META,
                format!("it is not understood: {error}"),
                "export the scene again as SOG version 2",
            )
        };
        let Version { version } = serde_json::from_slice(text).map_err(wrong)?;
        if version != Some(2) {
            let found = version.map_or("missing (1)".to_owned(), |version| version.to_string());
            return Err(Problem::malformed(
                format!("{META}, version"),
                format!("it is {found}"),
                "version 2 is read; convert the scene with a current tool",
            ));
        }
        let meta: Meta = serde_json::from_slice(text).map_err(wrong)?;
        debug_assert_eq!(meta.version, Some(2));
        meta.check()?;
        Ok(meta)
    }

    fn check(&self) -> Result<(), Problem> {
        if self.count == 0 {
            return Err(Problem::malformed(
                format!("{META}, count"),
                "it is 0",
                "export a scene with splats in it",
            ));
        }
        let rest = self.rest.as_ref().map(|rest| ("shN", &rest.codebook));
        let books = [
            ("scales", &self.scales.codebook),
            ("sh0", &self.sh0.codebook),
        ];
        for (name, book) in books.into_iter().chain(rest) {
            if book.len() != CODES {
                return Err(Problem::malformed(
                    format!("{META}, {name}.codebook"),
                    format!("it has {} entries", book.len()),
                    format!("{CODES} are needed, one per byte; export the scene again"),
                ));
            }
        }
        match &self.rest {
            Some(rest) if !(1..=3).contains(&rest.bands) => Err(Problem::malformed(
                format!("{META}, shN.bands"),
                format!("it is {}", rest.bands),
                "1 to 3 are read; export the scene again",
            )),
            Some(rest) if rest.count == 0 || rest.count > 1 << 16 => Err(Problem::malformed(
                format!("{META}, shN.count"),
                format!("the palette has {} entries", rest.count),
                "1 to 65536 have a label; export the scene again",
            )),
            _ => Ok(()),
        }
    }

    fn files(&self) -> impl Iterator<Item = &String> {
        let rest = self.rest.iter().flat_map(|rest| &rest.files);
        let single = [&self.scales.files, &self.sh0.files, &self.quats.files];
        let single = single.into_iter().flatten();
        self.means.files.iter().chain(single).chain(rest)
    }
}

/// A picture's pixels, RGBA.
struct SogImage {
    width: usize,
    rgba: Vec<[u8; 4]>,
}

impl SogImage {
    fn read(
        source: &SogSource,
        file: &str,
        at_least: usize,
        size: u64,
    ) -> Result<SogImage, Problem> {
        let bytes = source.read(file, size)?;
        let mut decoder = WebPDecoder::new(Cursor::new(&bytes))
            .map_err(|error| damaged(file, &error.to_string()))?;
        let (width, height) = decoder.dimensions();
        let count = u64::from(width) * u64::from(height);
        // Writers pad the last row, and squares to a multiple of four.
        let at_most = 2 * at_least as u64 + (1 << 16);
        if count < at_least as u64 || count > at_most {
            return Err(Problem::malformed(
                file,
                format!("it has {width} x {height} pixels"),
                format!("{at_least} are needed; export the scene again"),
            ));
        }
        let channels = if decoder.has_alpha() { 4 } else { 3 };
        let mut pixels = vec![0; count as usize * channels];
        decoder
            .read_image(&mut pixels)
            .map_err(|error| damaged(file, &error.to_string()))?;
        let rgba = |pixel: &[u8]| [pixel[0], pixel[1], pixel[2], *pixel.get(3).unwrap_or(&255)];
        Ok(SogImage {
            width: width as usize,
            rgba: pixels.chunks_exact(channels).map(rgba).collect(),
        })
    }
}

/// All pictures of a scene.
struct Pictures {
    means: [SogImage; 2],
    quats: SogImage,
    scales: SogImage,
    sh0: SogImage,
    rest: Option<[SogImage; 2]>,
}

fn load(source: &SogSource, name: &str) -> Result<Scene, Problem> {
    let meta = Meta::parse(&source.read(META, MAX_META_BYTES)?)?;
    let size = source.size(&meta);
    let possible = size.saturating_mul(MAX_RATIO) / RECORD_BYTES;
    if meta.count > possible {
        return Err(Problem::malformed(
            format!("{META}, count"),
            format!("{} Gaussians cannot be in {size} bytes", meta.count),
            "correct the count or fetch the files again",
        ));
    }
    let count = meta.count as usize;
    let read = |file: &String, at_least: usize| SogImage::read(source, file, at_least, size);
    let rest = match &meta.rest {
        None => None,
        Some(palette) => {
            let rows = palette.count.div_ceil(ENTRIES_PER_ROW);
            let width = ENTRIES_PER_ROW * coefficient_count(palette.bands);
            let centroids = read(&palette.files[0], rows * width)?;
            if centroids.width != width {
                return Err(Problem::malformed(
                    &palette.files[0],
                    format!("it is {} pixels wide", centroids.width),
                    format!(
                        "{width} are needed for {} bands; export the scene again",
                        palette.bands
                    ),
                ));
            }
            Some([centroids, read(&palette.files[1], count)?])
        }
    };
    let pictures = Pictures {
        means: [
            read(&meta.means.files[0], count)?,
            read(&meta.means.files[1], count)?,
        ],
        quats: read(&meta.quats.files[0], count)?,
        scales: read(&meta.scales.files[0], count)?,
        sh0: read(&meta.sh0.files[0], count)?,
        rest,
    };
    let degree = meta.rest.as_ref().map_or(0, |rest| rest.bands);
    let mut scene = GaussianScene::new(degree);
    let mut harmonics = vec![[0.0f32; 3]; coefficient_count(degree)];
    for index in 0..count {
        pictures.read_harmonics(&meta, index, &mut harmonics)?;
        scene.push(&pictures.gaussian(&meta, index, &harmonics));
    }
    scene.finish(name)
}

impl Pictures {
    fn gaussian<'a>(&self, meta: &Meta, index: usize, harmonics: &'a [[f32; 3]]) -> Gaussian<'a> {
        let [low, high] = [0, 1].map(|picture| self.means[picture].rgba[index]);
        let place = |axis: usize| {
            let word = u16::from_le_bytes([low[axis], high[axis]]);
            let (least, greatest) = (meta.means.mins[axis], meta.means.maxs[axis]);
            let value = least + (greatest - least) * f64::from(word) / 65535.0;
            value.abs().exp_m1().copysign(value)
        };
        let [r, g, b, opacity] = self.sh0.rgba[index];
        let scale = self.scales.rgba[index];
        let code = |book: &[f64], byte: u8| book[usize::from(byte)];
        Gaussian {
            centre: [0, 1, 2].map(place),
            scales: [0, 1, 2].map(|k| scale_from_log(code(&meta.scales.codebook, scale[k]))),
            rotation: rotation(self.quats.rgba[index]),
            opacity: f64::from(opacity) / 255.0,
            base: [r, g, b].map(|byte| base_from_coefficient(code(&meta.sh0.codebook, byte))),
            harmonics,
        }
    }

    fn read_harmonics(
        &self,
        meta: &Meta,
        index: usize,
        harmonics: &mut [[f32; 3]],
    ) -> Result<(), Problem> {
        let (Some(palette), Some([centroids, labels])) = (&meta.rest, &self.rest) else {
            return Ok(());
        };
        let [low, high, ..] = labels.rgba[index];
        let label = usize::from(u16::from_le_bytes([low, high]));
        if label >= palette.count {
            return Err(Problem::malformed(
                &palette.files[1],
                format!("Gaussian {index} has the label {label}"),
                format!(
                    "the palette has {} entries; export the scene again",
                    palette.count
                ),
            ));
        }
        let (row, column) = (label / ENTRIES_PER_ROW, label % ENTRIES_PER_ROW);
        let first = row * centroids.width + column * harmonics.len();
        let entry = &centroids.rgba[first..first + harmonics.len()];
        for (coefficient, [r, g, b, _]) in harmonics.iter_mut().zip(entry) {
            *coefficient = [r, g, b].map(|byte| palette.codebook[usize::from(*byte)] as f32);
        }
        Ok(())
    }
}

/// w, x, y, z; zero, which is counted as such, where alpha names no part.
fn rotation([a, b, c, tag]: [u8; 4]) -> [f64; 4] {
    match tag.checked_sub(252) {
        Some(largest) => smallest_three(
            usize::from(largest),
            [a, b, c].map(|byte| 2.0 * f64::from(byte) / 255.0 - 1.0),
        ),
        None => [0.0; 4],
    }
}

fn shorten(text: &str) -> String {
    text.chars().filter(|c| !c.is_control()).take(60).collect()
}

#[cfg(test)]
#[path = "sog_tests.rs"]
mod tests;
