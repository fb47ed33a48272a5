//! SOG, versions 1 and 2: every attribute as a lossless WebP picture, one pixel per Gaussian, row by row; in a folder or a `.sog` zip.
//!
//! | `meta.json` | pictures | decoding |
//! |---|---|---|
//! | `means` | `means_l`, `means_u`: low and high bytes of x, y, z | `v = mins + (maxs - mins) word / 65535`, place = `sign(v) (e^abs(v) - 1)` |
//! | `quats` | `quats`: three parts, alpha 252 + the place of the largest of w, x, y, z | part = `(2 byte / 255 - 1) sqrt(1/2)` |
//! | `scales` | `scales` | `codebook[byte]`, a logarithm |
//! | `sh0` | `sh0`: colour and, in alpha, opacity / 255 | `f_dc = codebook[byte]` |
//! | `shN` | `shN_labels`: 16-bit number of a palette entry; `shN_centroids`: 64 entries a row, a pixel per coefficient | `codebook[byte]` |
//!
//! Version 1 says no version; a range per channel stands in the place of each codebook (byte / 255 of the way), opacity is a logit, and the
//! palette is as large as its picture.
//!
//! A picture of one colour packs to nothing whatever its size, so the count is bounded by the size of all files together, and no
//! picture may have many more pixels than there are Gaussians.

use super::Scene;
use super::archive::Archive;
use super::error::Problem;
use super::gaussian::{
    Gaussian, GaussianScene, base_from_coefficient, coefficient_count, opacity_from_logit,
    scale_from_log,
};
use super::load::read_file;
use super::quaternion::smallest_three;
use image_webp::WebPDecoder;
use serde::Deserialize;
use std::io::Cursor;
use std::ops::RangeInclusive;
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
/// Entries of a palette: one per 16-bit label.
const MAX_ENTRIES: usize = 1 << 16;
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

/// What both versions come to.
struct Meta {
    count: u64,
    means: Means,
    scales: Coded,
    quats: Plain,
    /// Opacity of each byte.
    opacity: Vec<f64>,
    sh0: Coded,
    rest: Option<HarmonicsPalette>,
}

/// A codebook for each of three channels.
struct Coded {
    books: [Vec<f64>; 3],
    files: [String; 1],
}

struct HarmonicsPalette {
    /// Entries and bands; version 1 leaves both to the picture of the entries.
    size: Option<(usize, u8)>,
    codebook: Vec<f64>,
    files: [String; 2],
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
struct Meta2 {
    count: u64,
    means: Means,
    scales: Coded2,
    quats: Plain,
    sh0: Coded2,
    #[serde(rename = "shN")]
    rest: Option<Palette2>,
}

#[derive(Deserialize)]
struct Coded2 {
    codebook: Vec<f64>,
    files: [String; 1],
}

#[derive(Deserialize)]
struct Palette2 {
    count: usize,
    bands: u8,
    codebook: Vec<f64>,
    files: [String; 2],
}

impl From<Coded2> for Coded {
    /// One codebook for all channels.
    fn from(coded: Coded2) -> Coded {
        let book = coded.codebook;
        Coded {
            books: [book.clone(), book.clone(), book],
            files: coded.files,
        }
    }
}

impl From<Meta2> for Meta {
    fn from(meta: Meta2) -> Meta {
        Meta {
            count: meta.count,
            means: meta.means,
            scales: meta.scales.into(),
            quats: meta.quats,
            opacity: steps(0.0, 1.0),
            sh0: meta.sh0.into(),
            rest: meta.rest.map(|rest| HarmonicsPalette {
                size: Some((rest.count, rest.bands)),
                codebook: rest.codebook,
                files: rest.files,
            }),
        }
    }
}

/// What tells the versions apart before the rest is looked at.
#[derive(Deserialize)]
struct Version {
    version: Option<u32>,
}

/// Version 1, which says no version: ranges in the place of codebooks, and the count in the shape of the means.
#[derive(Deserialize)]
struct Meta1 {
    means: Means1,
    scales: Ranged<[f64; 3]>,
    quats: Plain,
    sh0: Ranged<[f64; 4]>,
    #[serde(rename = "shN")]
    rest: Option<Ranged2>,
}

#[derive(Deserialize)]
struct Means1 {
    shape: Vec<u64>,
    mins: [f64; 3],
    maxs: [f64; 3],
    files: [String; 2],
}

#[derive(Deserialize)]
struct Ranged<N> {
    mins: N,
    maxs: N,
    files: [String; 1],
}

/// One range for all coefficients, and two files.
#[derive(Deserialize)]
struct Ranged2 {
    mins: f64,
    maxs: f64,
    files: [String; 2],
}

/// A codebook of equal steps, which is what a range is.
fn steps(least: f64, greatest: f64) -> Vec<f64> {
    let step = |code: usize| least + (greatest - least) * code as f64 / (CODES - 1) as f64;
    (0..CODES).map(step).collect()
}

impl From<Meta1> for Meta {
    fn from(meta: Meta1) -> Meta {
        let Meta1 {
            means,
            scales,
            quats,
            sh0,
            rest,
        } = meta;
        let opacity = steps(sh0.mins[3], sh0.maxs[3])
            .into_iter()
            .map(opacity_from_logit);
        Meta {
            count: means.shape.first().copied().unwrap_or(0),
            means: Means {
                mins: means.mins,
                maxs: means.maxs,
                files: means.files,
            },
            scales: Coded {
                books: [0, 1, 2].map(|k| steps(scales.mins[k], scales.maxs[k])),
                files: scales.files,
            },
            quats,
            opacity: opacity.collect(),
            sh0: Coded {
                books: [0, 1, 2].map(|k| steps(sh0.mins[k], sh0.maxs[k])),
                files: sh0.files,
            },
            rest: rest.map(|rest| HarmonicsPalette {
                size: None,
                codebook: steps(rest.mins, rest.maxs),
                files: rest.files,
            }),
        }
    }
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
        let meta: Meta = match version {
            None | Some(1) => serde_json::from_slice::<Meta1>(text).map_err(wrong)?.into(),
            Some(2) => serde_json::from_slice::<Meta2>(text).map_err(wrong)?.into(),
            Some(other) => {
                return Err(Problem::malformed(
                    format!("{META}, version"),
                    format!("it is {other}"),
                    "versions 1 and 2 are read; convert the scene with a current tool",
                ));
            }
        };
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
            ("scales", &self.scales.books[0]),
            ("sh0", &self.sh0.books[0]),
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
        match self.rest.as_ref().and_then(|rest| rest.size) {
            Some((_, bands)) if !(1..=3).contains(&bands) => Err(Problem::malformed(
                format!("{META}, shN.bands"),
                format!("it is {bands}"),
                "1 to 3 are read; export the scene again",
            )),
            Some((entries, _)) if entries == 0 || entries > MAX_ENTRIES => Err(Problem::malformed(
                format!("{META}, shN.count"),
                format!("the palette has {entries} entries"),
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
        pixels: RangeInclusive<usize>,
        size: u64,
    ) -> Result<SogImage, Problem> {
        let bytes = source.read(file, size)?;
        let mut decoder = WebPDecoder::new(Cursor::new(&bytes))
            .map_err(|error| damaged(file, &error.to_string()))?;
        let (width, height) = decoder.dimensions();
        let count = u64::from(width) * u64::from(height);
        if !(*pixels.start() as u64..=*pixels.end() as u64).contains(&count) {
            return Err(Problem::malformed(
                file,
                format!("it has {width} x {height} pixels"),
                format!("{} are needed; export the scene again", pixels.start()),
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

/// Pixels of a picture for so many entries: writers pad the last row, and squares to a multiple of four.
fn padded(at_least: usize) -> RangeInclusive<usize> {
    at_least..=2 * at_least + (1 << 16)
}

/// Harmonics of all Gaussians: a palette, and each one's place in it.
struct Rest {
    centroids: SogImage,
    labels: SogImage,
    entries: usize,
    bands: u8,
}

/// All pictures of a scene.
struct Pictures {
    means: [SogImage; 2],
    quats: SogImage,
    scales: SogImage,
    sh0: SogImage,
    rest: Option<Rest>,
}

/// Pixels of a row of a palette's picture.
fn palette_width(bands: u8) -> usize {
    ENTRIES_PER_ROW * coefficient_count(bands)
}

impl Rest {
    fn read(
        palette: &HarmonicsPalette,
        count: usize,
        read: &impl Fn(&String, RangeInclusive<usize>) -> Result<SogImage, Problem>,
    ) -> Result<Rest, Problem> {
        let [file, labels] = &palette.files;
        let Some((entries, bands)) = palette.size else {
            // As many as the picture has: at most those of the largest palette.
            let largest = MAX_ENTRIES / ENTRIES_PER_ROW * palette_width(3);
            let centroids = read(file, palette_width(1)..=largest)?;
            let bands = (1..=3).find(|bands| palette_width(*bands) == centroids.width);
            let bands = bands.ok_or_else(|| {
                Problem::malformed(
                    file,
                    format!("it is {} pixels wide", centroids.width),
                    "192, 512 and 960 are those of 1 to 3 bands; export the scene again",
                )
            })?;
            let rows = centroids.rgba.len() / centroids.width;
            return Ok(Rest {
                centroids,
                labels: read(labels, padded(count))?,
                entries: (rows * ENTRIES_PER_ROW).min(MAX_ENTRIES),
                bands,
            });
        };
        let width = palette_width(bands);
        let centroids = read(file, padded(entries.div_ceil(ENTRIES_PER_ROW) * width))?;
        if centroids.width != width {
            return Err(Problem::malformed(
                file,
                format!("it is {} pixels wide", centroids.width),
                format!("{width} are needed for {bands} bands; export the scene again"),
            ));
        }
        Ok(Rest {
            centroids,
            labels: read(labels, padded(count))?,
            entries,
            bands,
        })
    }
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
    let read = |file: &String, pixels| SogImage::read(source, file, pixels, size);
    let each = |file: &String| read(file, padded(count));
    let rest = meta.rest.as_ref();
    let rest = rest.map(|palette| Rest::read(palette, count, &read));
    let pictures = Pictures {
        means: [each(&meta.means.files[0])?, each(&meta.means.files[1])?],
        quats: each(&meta.quats.files[0])?,
        scales: each(&meta.scales.files[0])?,
        sh0: each(&meta.sh0.files[0])?,
        rest: rest.transpose()?,
    };
    let degree = pictures.rest.as_ref().map_or(0, |rest| rest.bands);
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
        let colour = self.sh0.rgba[index];
        let scale = self.scales.rgba[index];
        let code = |coded: &Coded, k: usize, byte: u8| coded.books[k][usize::from(byte)];
        Gaussian {
            centre: [0, 1, 2].map(place),
            scales: [0, 1, 2].map(|k| scale_from_log(code(&meta.scales, k, scale[k]))),
            rotation: rotation(self.quats.rgba[index]),
            opacity: meta.opacity[usize::from(colour[3])],
            base: [0, 1, 2].map(|k| base_from_coefficient(code(&meta.sh0, k, colour[k]))),
            harmonics,
        }
    }

    fn read_harmonics(
        &self,
        meta: &Meta,
        index: usize,
        harmonics: &mut [[f32; 3]],
    ) -> Result<(), Problem> {
        let (Some(palette), Some(rest)) = (&meta.rest, &self.rest) else {
            return Ok(());
        };
        let [low, high, ..] = rest.labels.rgba[index];
        let label = usize::from(u16::from_le_bytes([low, high]));
        if label >= rest.entries {
            return Err(Problem::malformed(
                &palette.files[1],
                format!("Gaussian {index} has the label {label}"),
                format!(
                    "the palette has {} entries; export the scene again",
                    rest.entries
                ),
            ));
        }
        let (row, column) = (label / ENTRIES_PER_ROW, label % ENTRIES_PER_ROW);
        let first = row * rest.centroids.width + column * harmonics.len();
        let entry = &rest.centroids.rgba[first..first + harmonics.len()];
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
