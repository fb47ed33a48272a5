//! `.ksplat`, version 0.1: a header of 4096 bytes, sections with headers of 1024 bytes each, then the sections' data.
//!
//! Level 0 stores floats; levels 1 and 2 store places as three 16-bit integers around the centre of a bucket of
//! Gaussians, scales and rotations as half floats, and harmonics as half floats (1) or bytes (2). Colours are bytes
//! throughout. A section begins with the sizes of its partly filled buckets, then come the buckets' centres, then the
//! Gaussians, full buckets first.

use super::Scene;
use super::bytes::{Reader, little_at, nothing_left};
use super::error::Problem;
use super::gaussian::{Gaussian, GaussianScene, coefficient_count};
use anyhow::{Context, ensure};
use half::f16;
use std::iter::repeat_n;

const HEADER_BYTES: usize = 4096;
const SECTION_BYTES: usize = 1024;
/// Steps on either side of a bucket's centre where the section does not say.
const USUAL_RANGE: u32 = 32_767;
/// Range of harmonics stored as bytes where the header does not say.
const USUAL_HARMONIC: f64 = 1.5;

/// Loads a `.ksplat` file.
pub(super) fn load(bytes: &[u8], name: &str) -> Result<Scene, Problem> {
    let mut reader = Reader::new(bytes);
    let header = KsplatHeader::parse(reader.take(HEADER_BYTES, "ksplat header")?)?;
    let headers = reader.records(
        header.sections.into(),
        SECTION_BYTES,
        "ksplat section headers",
    )?;
    let headers = headers.chunks_exact(SECTION_BYTES).enumerate();
    let sections: Vec<Section> = headers
        .map(|(number, bytes)| Section::parse(bytes, number, &header))
        .collect::<Result<_, _>>()?;
    let total: u64 = sections.iter().map(|s| u64::from(s.count)).sum();
    ensure!(
        total == u64::from(header.count) && total != 0,
        "ksplat splat count: the header says {}, the sections {total}; export the scene again",
        header.count
    );
    // Sections may differ in degree; coefficients that one lacks are 0.
    let used = sections.iter().filter(|section| section.count > 0);
    let degree = used.map(|section| section.degree).max().unwrap_or(0);
    let mut scene = GaussianScene::new(degree, total)?;
    for section in &sections {
        section.read(&mut reader, &header, &mut scene)?;
    }
    let fix = "correct the counts in the headers or export the scene again";
    nothing_left(reader.remaining(), "ksplat data", "section", fix)?;
    scene.finish(name)
}

struct KsplatHeader {
    sections: u32,
    count: u32,
    level: u16,
    /// Least and greatest harmonic stored as a byte.
    range: [f64; 2],
}

impl KsplatHeader {
    fn parse(bytes: &[u8]) -> Result<KsplatHeader, Problem> {
        let [major, minor] = [bytes[0], bytes[1]];
        ensure!(
            major == 0 && minor >= 1,
            "ksplat version: it is {major}.{minor}; version 0.1 is read; \
             check that this is a .ksplat file"
        );
        let level: u16 = little_at(bytes, 20);
        ensure!(
            level <= 2,
            "ksplat compression level: it is {level}; 0 to 2 are read; \
             export the scene with one of these"
        );
        let bound = |at: usize, usual: f64| match f32_at(bytes, at) {
            0.0 => usual,
            stored => stored,
        };
        Ok(KsplatHeader {
            sections: little_at(bytes, 4),
            count: little_at(bytes, 16),
            level,
            range: [bound(36, -USUAL_HARMONIC), bound(40, USUAL_HARMONIC)],
        })
    }
}

struct Section {
    number: usize,
    count: u32,
    /// Gaussians that room is kept for.
    capacity: u32,
    bucket_size: u32,
    buckets: u32,
    /// Bytes of a bucket's centre, three floats.
    bucket_bytes: u16,
    full: u32,
    partial: u32,
    /// Scene units per step of a place.
    step: f64,
    /// Steps on either side of a bucket's centre.
    steps: f64,
    degree: u8,
}

impl Section {
    fn parse(bytes: &[u8], number: usize, header: &KsplatHeader) -> Result<Section, Problem> {
        let steps = match little_at(bytes, 24) {
            0 if header.level == 0 => 1,
            0 => USUAL_RANGE,
            stored => stored,
        };
        let degree: u16 = little_at(bytes, 40);
        ensure!(
            degree <= 3,
            "ksplat section {number}, harmonics degree: it is {degree}; degrees 0 to 3 are read; \
             export the scene with one of these"
        );
        let section = Section {
            number,
            count: little_at(bytes, 0),
            capacity: little_at(bytes, 4),
            bucket_size: little_at(bytes, 8),
            buckets: little_at(bytes, 12),
            bucket_bytes: little_at(bytes, 20),
            full: little_at(bytes, 32),
            partial: little_at(bytes, 36),
            step: f32_at(bytes, 16) / 2.0 / f64::from(steps),
            steps: f64::from(steps),
            degree: degree as u8,
        };
        ensure!(
            section.count <= section.capacity,
            "ksplat section {number}, splat count: {} where {} have room; export the scene again",
            section.count,
            section.capacity
        );
        let centres = section.buckets == 0 || section.bucket_bytes >= 12;
        let listed = u64::from(section.full) + u64::from(section.partial);
        ensure!(
            header.level == 0 || centres && listed <= u64::from(section.buckets),
            "ksplat section {number}, buckets: {} of {} bytes for {} full and {} partial ones; \
             export the scene again",
            section.buckets,
            section.bucket_bytes,
            section.full,
            section.partial
        );
        Ok(section)
    }

    /// Adds every Gaussian of the section to the scene.
    fn read(
        &self,
        reader: &mut Reader,
        header: &KsplatHeader,
        scene: &mut GaussianScene,
    ) -> Result<(), Problem> {
        let field = |what: &str| format!("ksplat section {}, {what}", self.number);
        let sizes = reader.records(u64::from(self.partial), 4, &field("bucket sizes"))?;
        let centres = reader.records(
            u64::from(self.buckets),
            self.bucket_bytes.into(),
            &field("bucket centres"),
        )?;
        let coefficients = coefficient_count(self.degree);
        let layout = KsplatLayout::new(header.level, coefficients);
        let splats = reader.records(u64::from(self.capacity), layout.bytes, &field("splats"))?;
        scene.harmonics.fill([0.0; 3]);
        // The bucket of every Gaussian: full ones first.
        let full = (0..self.full).map(|bucket| (bucket, self.bucket_size));
        let sizes = sizes.as_chunks().0.iter();
        let sizes = sizes.map(|size| u32::from_le_bytes(*size));
        let buckets = full.chain((self.full..).zip(sizes));
        let mut buckets =
            buckets.flat_map(|(bucket, size)| repeat_n(bucket as usize, size as usize));
        for index in 0..self.count {
            let at = index as usize * layout.bytes;
            let record = &splats[at..at + layout.bytes];
            let centre = if header.level == 0 {
                [0, 1, 2].map(|axis| f32_at(record, 4 * axis))
            } else {
                let first = buckets
                    .next()
                    .map(|bucket| bucket * usize::from(self.bucket_bytes));
                let centre = first.and_then(|first| centres.get(first..first + 12));
                let field = || field(&format!("buckets: splat {index} lies in none"));
                let centre =
                    centre.with_context(|| format!("{}; export the scene again", field()))?;
                [0, 1, 2].map(|axis| {
                    let steps = f64::from(little_at::<u16, _>(record, 2 * axis)) - self.steps;
                    f32_at(centre, 4 * axis) + steps * self.step
                })
            };
            layout.read_harmonics(record, header, &mut scene.harmonics[..coefficients]);
            scene.push(&layout.gaussian(record, centre));
        }
        Ok(())
    }
}

/// How a record holds its fields: centre, scales, rotation, colour, harmonics.
struct KsplatLayout {
    level: u16,
    colour: usize,
    harmonics: usize,
    bytes: usize,
}

impl KsplatLayout {
    fn new(level: u16, coefficients: usize) -> KsplatLayout {
        let part = if level == 0 { 4 } else { 2 };
        let harmonics = 10 * part + 4;
        let harmonic_bytes = [4, 2, 1][usize::from(level.min(2))];
        KsplatLayout {
            level,
            colour: 10 * part,
            harmonics,
            bytes: harmonics + 3 * coefficients * harmonic_bytes,
        }
    }

    /// A float, or a half in the compressed levels.
    fn part(&self, record: &[u8], first: usize, index: usize) -> f64 {
        match self.level {
            0 => f32_at(record, first + 4 * index),
            _ => f16::from_bits(little_at(record, first + 2 * index)).to_f64(),
        }
    }

    fn gaussian(&self, record: &[u8], centre: [f64; 3]) -> Gaussian {
        let byte = |index: usize| f64::from(record[self.colour + index]) / 255.0;
        Gaussian {
            centre,
            scales: [3, 4, 5].map(|k| self.part(record, 0, k)),
            rotation: [6, 7, 8, 9].map(|k| self.part(record, 0, k)),
            base: [byte(0), byte(1), byte(2)],
            opacity: byte(3),
        }
    }

    /// Degree by degree, and within each all of red, then green, then blue.
    fn read_harmonics(&self, record: &[u8], header: &KsplatHeader, harmonics: &mut [[f32; 3]]) {
        let [least, greatest] = header.range;
        let value = |index: usize| match self.level {
            0 | 1 => self.part(record, self.harmonics, index),
            _ => {
                let part = f64::from(record[self.harmonics + index]) / 255.0;
                least + (greatest - least) * part
            }
        };
        let mut first = 0;
        for degree in 1.. {
            let width = 2 * degree + 1;
            if first + width > harmonics.len() {
                return;
            }
            for k in 0..width {
                harmonics[first + k] =
                    [0, 1, 2].map(|channel| value(3 * first + channel * width + k) as f32);
            }
            first += width;
        }
    }
}

fn f32_at(bytes: &[u8], at: usize) -> f64 {
    f64::from(little_at::<f32, _>(bytes, at))
}

#[cfg(test)]
#[path = "ksplat_tests.rs"]
mod tests;
