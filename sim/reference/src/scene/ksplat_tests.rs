//! Tests of the ksplat reader, on files built here from the format's description.

use super::*;
use crate::scene::damage_tests::{assert_refused, survives_at};

fn put(bytes: &mut [u8], at: usize, value: &[u8]) {
    bytes[at..at + value.len()].copy_from_slice(value);
}

/// One section of three Gaussians: one full bucket of two around (10, 0, 0) and a partial one around (0, 20, 0).
struct KsplatFile {
    header: Vec<u8>,
    section: Vec<u8>,
    data: Vec<u8>,
}

impl KsplatFile {
    fn new(level: u16, degree: u16) -> KsplatFile {
        let mut header = vec![0; HEADER_BYTES];
        put(&mut header, 0, &[0, 1]);
        put(&mut header, 4, &1u32.to_le_bytes());
        put(&mut header, 16, &3u32.to_le_bytes());
        put(&mut header, 20, &level.to_le_bytes());
        put(&mut header, 36, &(-2f32).to_le_bytes());
        put(&mut header, 40, &2f32.to_le_bytes());
        let mut section = vec![0; SECTION_BYTES];
        for (at, value) in [
            (0, 3u32),
            (4, 3),
            (8, 2),
            (12, 2),
            (24, 0),
            (32, 1),
            (36, 1),
        ] {
            put(&mut section, at, &value.to_le_bytes());
        }
        put(&mut section, 16, &4f32.to_le_bytes());
        put(&mut section, 20, &12u16.to_le_bytes());
        put(&mut section, 40, &degree.to_le_bytes());
        let mut data = 1u32.to_le_bytes().to_vec();
        let centres = [10f32, 0.0, 0.0, 0.0, 20.0, 0.0];
        data.extend(centres.into_iter().flat_map(f32::to_le_bytes));
        for _ in 0..3 {
            data.extend(record(level, usize::from(degree)));
        }
        KsplatFile {
            header,
            section,
            data,
        }
    }

    fn bytes(&self) -> Vec<u8> {
        [&self.header[..], &self.section, &self.data].concat()
    }
}

/// 1, 0.5 and 2, and their halves in both precisions.
fn part(level: u16, value: f32) -> Vec<u8> {
    let half = match value {
        1.0 => 0x3c00u16,
        0.5 => 0x3800,
        2.0 => 0x4000,
        _ => 0,
    };
    match level {
        0 => value.to_le_bytes().to_vec(),
        _ => half.to_le_bytes().to_vec(),
    }
}

/// Two block halves to the right of its bucket's centre: x = centre + 2, y = centre, z = centre - 2.
fn record(level: u16, degree: usize) -> Vec<u8> {
    let place = match level {
        0 => [1.0f32, 2.0, 3.0].map(f32::to_le_bytes).concat(),
        _ => [65534u16, 32767, 0].map(u16::to_le_bytes).concat(),
    };
    let floats = [0.5, 1.0, 2.0, 1.0, 0.0, 0.0, 0.0]
        .map(|value| part(level, value))
        .concat();
    let coefficients = 3 * ((degree + 1) * (degree + 1) - 1);
    let rest = (0..coefficients).flat_map(|k| match level {
        2 => vec![[0u8, 255][k % 2]],
        _ => part(level, [0.5, 1.0, 2.0][k % 3]),
    });
    [place, floats, vec![255, 51, 0, 102], rest.collect()].concat()
}

#[test]
fn every_level_is_decoded() {
    for level in 0..3 {
        let scene = load(&KsplatFile::new(level, 1).bytes(), "x").unwrap();
        let centres: Vec<[f64; 3]> = scene.splats.iter().map(|splat| splat.centre).collect();
        let expected = match level {
            0 => [[1.0, 2.0, 3.0]; 3],
            _ => [[12.0, 0.0, -2.0], [12.0, 0.0, -2.0], [2.0, 20.0, -2.0]],
        };
        assert_eq!(centres, expected, "level {level}");
        let splat = scene.splats[2];
        assert_eq!(
            splat.axes,
            [[0.5, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 2.0]]
        );
        assert_eq!((splat.colour, splat.weight), ([1.0, 0.2, 0.0], 0.4));
        let harmonics = scene.harmonics.unwrap();
        let expected = match level {
            2 => [[-2.0, 2.0, -2.0], [2.0, -2.0, 2.0], [-2.0, 2.0, -2.0]],
            // Red of all three coefficients comes first.
            _ => [[0.5; 3], [1.0; 3], [2.0; 3]],
        };
        assert_eq!(harmonics.coefficients[..3], expected, "level {level}");
    }
}

/// The headers are mostly padding, so only their used parts and the data are damaged.
#[test]
fn damaged_files_are_refused() {
    for level in [0, 2] {
        let whole = KsplatFile::new(level, 1).bytes();
        let data = HEADER_BYTES + SECTION_BYTES;
        let places = (0..48)
            .chain(HEADER_BYTES - 2..HEADER_BYTES + 48)
            .chain(data - 2..whole.len());
        survives_at(&whole, places, &|bytes| load(bytes, "x"));
    }
}

#[test]
fn each_message_names_the_field_and_the_fix() {
    let changed = |level: u16, change: &dyn Fn(&mut KsplatFile)| {
        let mut file = KsplatFile::new(level, 0);
        change(&mut file);
        file.bytes()
    };
    let section = |level: u16, at: usize, value: u32| {
        changed(level, &|file| {
            put(&mut file.section, at, &value.to_le_bytes())
        })
    };
    let cases = [
        (
            changed(0, &|file| file.header[0] = 1),
            "ksplat version: it is 1.1; version 0.1 is read",
        ),
        (
            changed(0, &|file| file.header[20] = 3),
            "ksplat compression level: it is 3; 0 to 2",
        ),
        (
            changed(0, &|file| file.header[16] = 4),
            "the header says 4, the sections 3",
        ),
        (
            changed(0, &|file| file.data.push(0)),
            "1 bytes are left over after the last section",
        ),
        (
            section(0, 40, 4),
            "ksplat section 0, harmonics degree: it is 4",
        ),
        (
            section(0, 4, 2),
            "ksplat section 0, splat count: 3 where 2 have room",
        ),
        (
            section(0, 4, u32::MAX),
            "ksplat section 0, splats: 188978560980 bytes are needed",
        ),
        (
            section(1, 32, 7),
            "ksplat section 0, buckets: 2 of 12 bytes for 7 full and 1 partial",
        ),
        (
            section(1, 8, 0),
            "ksplat section 0, buckets: splat 1 lies in none",
        ),
    ];
    assert_refused(&cases, |bytes| load(bytes, "x"));
}
