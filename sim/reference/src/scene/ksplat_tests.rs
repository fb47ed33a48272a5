//! Tests of the ksplat reader, on files built here from the format's description.

use super::*;
use crate::scene::damage_tests::{assert_refused, assert_refused_at, survives_at};

fn put(bytes: &mut [u8], at: usize, value: &[u8]) {
    bytes[at..at + value.len()].copy_from_slice(value);
}

/// One section of three Gaussians: one full bucket of two around (10, 0, 0) and a partial one around (0, 20, 0).
fn file(level: u16, degree: u16) -> Vec<u8> {
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
    [header, section, data].concat()
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
        let scene = load(&file(level, 1), "x").unwrap();
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
        let whole = file(level, 1);
        let data = HEADER_BYTES + SECTION_BYTES;
        let places = (0..48)
            .chain(HEADER_BYTES - 2..HEADER_BYTES + 48)
            .chain(data - 2..whole.len());
        survives_at(&whole, places, &|bytes| load(bytes, "x"));
    }
}

#[test]
fn each_message_names_the_field_and_the_fix() {
    let load = |bytes: &[u8]| load(bytes, "x");
    // The section's header begins at 4096.
    let plain = r"
        0 => 01 => ksplat version: it is 1.1; version 0.1 is read
        20 => 03 => ksplat compression level: it is 3; 0 to 2
        16 => 04 => the header says 4, the sections 3
        4136 => 04 => ksplat section 0, harmonics degree: it is 4
        4100 => 02 => ksplat section 0, splat count: 3 where 2 have room
        4100 => ff ff ff ff => ksplat section 0, splats: 188978560980 bytes are needed
    ";
    let whole = file(0, 0);
    assert_refused_at(&whole, plain, load);
    let longer = [whole, vec![0]].concat();
    let left_over = "1 bytes are left over after the last section";
    assert_refused(&[(longer, left_over)], load);
    let packed = r"
        4128 => 07 => ksplat section 0, buckets: 2 of 12 bytes for 7 full and 1 partial
        4104 => 00 => ksplat section 0, buckets: splat 1 lies in none
    ";
    assert_refused_at(&file(1, 0), packed, load);
}
