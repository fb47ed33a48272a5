//! Tests of the spz reader, on files built here from the format's description.

use std::io::Write;

use super::*;

fn pack(unpacked: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    encoder.write_all(unpacked).unwrap();
    encoder.finish().unwrap()
}

fn header(version: u32, count: u32, degree: u8, fraction_bits: u8, flags: u8) -> Vec<u8> {
    let numbers = [0x5053_474e_u32, version, count]
        .map(u32::to_le_bytes)
        .concat();
    [numbers, vec![degree, fraction_bits, flags, 0]].concat()
}

/// One Gaussian at (1, -2, 0.5) (stored right, up, back), turned by `rotation`.
fn one(version: u32, degree: u8, rotation: &[u8]) -> Vec<u8> {
    let mut bytes = header(version, 1, degree, 12, 0);
    for place in [4096i32, -8192, 2048] {
        bytes.extend(&place.to_le_bytes()[..3]);
    }
    bytes.extend([51, 255, 0, 127, 160, 144, 128]);
    bytes.extend(rotation);
    bytes.extend((0..3 * coefficient_count(degree)).map(|k| 128 + k as u8));
    bytes
}

fn load_one(version: u32, degree: u8, rotation: &[u8]) -> Scene {
    load(&pack(&one(version, degree, rotation)), "x").unwrap()
}

#[test]
fn fields_are_decoded() {
    let scene = load_one(2, 0, &[128, 128, 128]);
    let splat = scene.splats[0];
    assert_eq!(splat.centre, [1.0, 2.0, -0.5]);
    assert_eq!(splat.weight, 0.2);
    assert!((splat.colour[0] - (0.5 + 0.282_094_79 / 0.3)).abs() < 1e-7);
    assert_eq!(splat.colour[1], 0.0);
    assert!((splat.colour[2] - 0.496_31).abs() < 1e-5);
    let length = |axis: [f64; 3]| axis.iter().map(|part| part * part).sum::<f64>().sqrt();
    for (axis, expected) in splat.axes.iter().zip([0.0f64, -1.0, -2.0]) {
        assert!((length(*axis) - expected.exp()).abs() < 1e-12);
    }
}

/// The same turn in both packings; y and z of the quaternion change sign with the axes.
#[test]
fn both_rotation_packings_agree() {
    let turn = [0.3, -0.5, 0.1];
    let w = f64::sqrt(1.0 - 0.09 - 0.25 - 0.01);
    let three = turn.map(|part: f64| (part * 127.5 + 127.5).round() as u8);
    let mut four = 3u32;
    for part in turn {
        let magnitude = (part.abs() / std::f64::consts::FRAC_1_SQRT_2 * 511.0).round() as u32;
        four = four << 10 | u32::from(part < 0.0) << 9 | magnitude;
    }
    let expected =
        super::super::gaussian::rotation_matrix([w, turn[0], -turn[1], -turn[2]]).unwrap();
    for scene in [load_one(2, 0, &three), load_one(3, 0, &four.to_le_bytes())] {
        for (k, scale) in [0.0f64, -1.0, -2.0].map(f64::exp).into_iter().enumerate() {
            for (row, expected) in expected.iter().enumerate() {
                let found = scene.splats[0].axes[k][row] / scale;
                assert!(
                    (found - expected[k]).abs() < 0.02,
                    "axis {k} row {row}: {found} {expected:?}"
                );
            }
        }
    }
}

#[test]
fn smallest_three_names_the_largest_part_in_its_top_bits() {
    for largest in 0..4u32 {
        let mut expected = [0.0; 4];
        expected[largest as usize] = 1.0;
        assert_eq!(rotation_smallest_three(largest << 30), expected);
    }
    // Parts too large for a unit quaternion give no NaN.
    assert_eq!(rotation_smallest_three(u32::MAX)[3], 0.0);
}

#[test]
fn harmonics_change_sign_with_the_axes() {
    assert_eq!(
        harmonic_parities(),
        [
            -1., -1., 1., -1., 1., 1., -1., 1., -1., 1., -1., -1., 1., -1., 1.
        ],
        "odd powers of y and z together"
    );
    let harmonics = load_one(3, 1, &[0; 4]).harmonics.unwrap();
    let steps = |k: f32| [k, k + 1.0, k + 2.0].map(|step| step / 128.0);
    assert_eq!(
        harmonics.coefficients,
        [steps(0.0).map(|s| -s), steps(3.0).map(|s| -s), steps(6.0)]
    );
    assert_eq!(
        load_one(2, 3, &[128; 3])
            .harmonics
            .unwrap()
            .coefficients
            .len(),
        15
    );
}

#[test]
fn every_truncation_is_an_error() {
    let unpacked = one(3, 1, &[0; 4]);
    let packed = pack(&unpacked);
    for length in 0..packed.len() {
        assert!(
            load(&packed[..length], "x").is_err(),
            "packed, cut at {length}"
        );
    }
    for length in 0..unpacked.len() {
        assert!(
            load(&pack(&unpacked[..length]), "x").is_err(),
            "unpacked, cut at {length}"
        );
    }
}

#[test]
fn no_flipped_byte_panics() {
    let unpacked = one(3, 1, &[0; 4]);
    for place in 0..unpacked.len() {
        for flip in [0x01, 0x10, 0x80, 0xff] {
            let mut bytes = unpacked.clone();
            bytes[place] ^= flip;
            let _ = load(&pack(&bytes), "x");
        }
    }
}

#[test]
fn each_message_names_the_field_and_the_fix() {
    let cases = [
        (
            b"NGSP....".to_vec(),
            "spz version: it is 4 or later (not gzip-packed); versions 2 and 3 are read",
        ),
        (
            b"plain".to_vec(),
            "spz header: the gzip stream is damaged or truncated",
        ),
        (pack(b"NGS"), "spz magic: 4 bytes are needed but 3 are left"),
        (
            pack(&[0; 16]),
            "spz magic: it is not 'NGSP'; check that this is a .spz file",
        ),
        (
            pack(&header(1, 1, 0, 12, 0)),
            "spz version: it is 1; versions 2 and 3 are read; convert to one of these",
        ),
        (
            pack(&header(3, 0, 0, 12, 0)),
            "spz count: it is 0; export a scene with splats in it",
        ),
        (
            pack(&header(3, 1, 4, 12, 0)),
            "spz harmonics degree: it is 4; degrees 0 to 3 are read",
        ),
        (
            pack(&header(3, 1, 0, 24, 0)),
            "spz fractional bits: there are 24 in a 24-bit position; at most 23",
        ),
        (
            pack(&header(3, 1, 0, 12, 2)),
            "spz flags: the file carries extensions",
        ),
        (
            pack(&header(3, 1, 0, 12, 0)),
            "spz data: 36 bytes are needed but 16 are left; the file is truncated",
        ),
        (
            pack(&header(3, u32::MAX, 3, 12, 0)),
            "spz data: the header claims 279172874191 bytes, but ",
        ),
        (
            pack(&[one(3, 0, &[0; 4]), vec![0]].concat()),
            "spz data: more than the 36 bytes that the header justifies",
        ),
    ];
    for (bytes, expected) in cases {
        let found = load(&bytes, "x").unwrap_err().to_string();
        assert!(
            found.contains(expected),
            "found    {found}\nexpected {expected}"
        );
    }
}
