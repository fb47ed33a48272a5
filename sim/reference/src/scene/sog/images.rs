//! The pictures of a scene: each is checked before it is unpacked, and gives one attribute of every Gaussian.

use super::super::error::Problem;
use super::super::gaussian::{Gaussian, base_from_coefficient, coefficient_count, scale_from_log};
use super::super::quaternion::smallest_three;
use super::meta::{Coded, HarmonicsPalette, MAX_ENTRIES, Meta};
use super::{SogSource, damaged};
use crate::memory;
use anyhow::{bail, ensure};
use image_webp::WebPDecoder;
use std::io::Cursor;
use std::ops::RangeInclusive;

/// Palette entries per row of `shN_centroids`.
const ENTRIES_PER_ROW: usize = 64;

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
        ensure!(
            (*pixels.start() as u64..=*pixels.end() as u64).contains(&count),
            "{file}: it has {width} x {height} pixels; {} are needed; export the scene again",
            pixels.start()
        );
        let channels = if decoder.has_alpha() { 4 } else { 3 };
        // The decoder keeps a picture of its own, of four bytes a pixel.
        let what = format!("{width} x {height} pixels of {file}");
        memory::room_for_records(count, channels + 4 + 4, &what)?;
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
pub(super) struct Pictures {
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
        // As many as the picture has, where nothing says how many: at most those of the largest palette.
        let largest = MAX_ENTRIES / ENTRIES_PER_ROW * palette_width(3);
        let pixels = palette
            .size
            .map_or(palette_width(1)..=largest, |(entries, bands)| {
                padded(entries.div_ceil(ENTRIES_PER_ROW) * palette_width(bands))
            });
        let centroids = read(file, pixels)?;
        let width = centroids.width;
        let Some(bands) = (1..=3).find(|bands| palette_width(*bands) == width) else {
            bail!(
                "{file}: it is {width} pixels wide; 192, 512 and 960 are those of 1 to 3 bands; \
                 export the scene again"
            );
        };
        let rows = centroids.rgba.len() / width;
        let usual = ((rows * ENTRIES_PER_ROW).min(MAX_ENTRIES), bands);
        let (entries, stated) = palette.size.unwrap_or(usual);
        ensure!(
            stated == bands,
            "{file}: it is {width} pixels wide; {} are needed for {stated} bands; \
             export the scene again",
            palette_width(stated)
        );
        Ok(Rest {
            centroids,
            labels: read(labels, padded(count))?,
            entries,
            bands,
        })
    }
}

impl Pictures {
    /// Reads them all; none has more than `size` bytes.
    pub(super) fn read(meta: &Meta, source: &SogSource, size: u64) -> Result<Pictures, Problem> {
        let count = meta.count as usize;
        let read = |file: &String, pixels| SogImage::read(source, file, pixels, size);
        let each = |file: &String| read(file, padded(count));
        let rest = meta.rest.as_ref();
        let rest = rest.map(|palette| Rest::read(palette, count, &read));
        Ok(Pictures {
            means: [each(&meta.means.files[0])?, each(&meta.means.files[1])?],
            quats: each(&meta.quats.files[0])?,
            scales: each(&meta.scales.files[0])?,
            sh0: each(&meta.sh0.files[0])?,
            rest: rest.transpose()?,
        })
    }

    /// Of the harmonics.
    pub(super) fn degree(&self) -> u8 {
        self.rest.as_ref().map_or(0, |rest| rest.bands)
    }

    pub(super) fn gaussian(&self, meta: &Meta, index: usize) -> Gaussian {
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
        }
    }

    pub(super) fn read_harmonics(
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
        ensure!(
            label < rest.entries,
            "{}: Gaussian {index} has the label {label}; the palette has {} entries; \
             export the scene again",
            &palette.files[1],
            rest.entries
        );
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
