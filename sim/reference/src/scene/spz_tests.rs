//! Tests of the spz reader, on files built here from the format's description.

use crate::scene::damage_tests::{assert_refused, assert_refused_at, gzip as pack, rows, survives};

use super::*;

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
    for (axis, expected) in splat.axes.iter().zip([0.0f64, -1.0, -2.0]) {
        assert!((crate::vector::length(*axis) - expected.exp()).abs() < 1e-12);
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
            -1., -1., 1., -1., 1., 1., -1., 1., -1., 1., -1., -1., 1., -1., 1., -1., 1., -1., 1.,
            1., -1., 1., -1., 1.
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
fn damaged_files_are_refused() {
    let unpacked = one(3, 1, &[0; 4]);
    survives(&pack(&unpacked), &|bytes| load(bytes, "x"));
    survives(&unpacked, &|bytes| load(&pack(bytes), "x"));
    survives(&streams(1, |_| ()), &|bytes| load(bytes, "x"));
}

#[test]
fn each_message_names_the_field_and_the_fix() {
    let load = |bytes: &[u8]| load(bytes, "x");
    // Version, count, degree, fractional bits and flags of a file that is a header and nothing else.
    let headers = r"
        5 1 0 12 0 => spz version: it is 5; versions 1 to 4 are read; convert to one of these
        4 1 0 12 0 => spz version: it is 4 in gzip; versions 1 to 4 are read
        3 0 0 12 0 => spz count: it is 0; export a scene with splats in it
        3 1 5 12 0 => spz harmonics degree: it is 5; degrees 0 to 4 are read
        3 1 0 24 0 => spz fractional bits: there are 24 in a 24-bit position; at most 23
        3 1 0 12 2 => spz flags: the file carries extensions
        3 1 0 12 0 => spz data: 36 bytes are needed but 16 are left; the file is truncated
        3 4294967295 3 12 0 => spz data: the header claims 279172874191 bytes, but
    ";
    for [fields, expected] in rows(headers) {
        let fields: Vec<u32> = fields.split(' ').map(|n| n.parse().unwrap()).collect();
        let [degree, bits, flags] = [2, 3, 4].map(|k| fields[k] as u8);
        let file = pack(&header(fields[0], fields[1], degree, bits, flags));
        assert_refused(&[(file, &*expected)], load);
    }
    let cases = [
        (
            b"NGSP\x03\0\0\0\x01\0\0\0\0\0\0\0".to_vec(),
            "spz version: it is 3 without gzip; versions 1 to 4 are read",
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
            pack(&[one(3, 0, &[0; 4]), vec![0]].concat()),
            "spz data: more than the 36 bytes that the header justifies",
        ),
    ];
    assert_refused(&cases, load);
}

/// The same Gaussian as [`one`], in version 4: a plain header, a table and a zstd stream per array.
fn streams(degree: u8, change: impl Fn(&mut Vec<Vec<u8>>)) -> Vec<u8> {
    let whole = one(3, degree, &[0x12, 0x34, 0x56, 0x78]);
    let mut rest = &whole[HEADER_BYTES..];
    let sizes = [9, 1, 3, 3, 4, 3 * coefficient_count(degree)];
    let mut arrays: Vec<Vec<u8>> = sizes
        .iter()
        .map(|size| {
            let (array, after) = rest.split_at(*size);
            rest = after;
            array.to_vec()
        })
        .collect();
    change(&mut arrays);
    let pack = |array: &Vec<u8>| {
        ruzstd::encoding::compress_to_vec(&array[..], ruzstd::encoding::CompressionLevel::Fastest)
    };
    let packed: Vec<Vec<u8>> = arrays.iter().map(pack).collect();
    let mut file = header(4, 1, degree, 12, 0);
    file[15] = arrays.len() as u8;
    file.extend(32u32.to_le_bytes());
    file.extend([0; 12]);
    for (packed, plain) in packed.iter().zip(&arrays) {
        file.extend((packed.len() as u64).to_le_bytes());
        file.extend((plain.len() as u64).to_le_bytes());
    }
    [file, packed.concat()].concat()
}

#[test]
fn streams_hold_what_one_stream_holds() {
    for degree in 0..=4 {
        let expected = load_one(3, degree, &[0x12, 0x34, 0x56, 0x78]);
        assert_eq!(load(&streams(degree, |_| ()), "x").unwrap(), expected);
    }
    let five = streams(0, |arrays| arrays.truncate(5));
    assert!(load(&five, "x").is_ok(), "no stream without harmonics");
}

#[test]
fn version_1_has_half_floats_for_places() {
    let mut bytes = header(1, 1, 0, 0, 0);
    bytes.extend([0x3c00u16, 0x4000, 0xb800].map(u16::to_le_bytes).concat());
    bytes.extend([51, 255, 0, 127, 160, 144, 128, 128, 128, 128]);
    let scene = load(&pack(&bytes), "x").unwrap();
    assert_eq!(scene.splats[0].centre, [1.0, -2.0, 0.5]);
}

#[test]
fn messages_about_streams_name_the_array() {
    let sound = streams(1, |_| ());
    let load = |bytes: &[u8]| load(bytes, "x");
    let table = r"
        8 => ff ff ff ff => Gaussians of 124554051571 bytes cannot be in a file of
        15 => 04 => spz streams: there are 4; 6 to 6 are read
        40 => 07 => spz positions: the table says 7 bytes; 1 Gaussians need 9
        48 => ff ff ff ff ff ff ff ff => spz opacities: 18446744073709551615 bytes are needed
        128 => 00 00 00 00 => spz positions: the zstd stream is damaged or truncated
    ";
    assert_refused_at(&sound, table, load);
    let longer = streams(1, |arrays| arrays[1].push(0));
    assert_refused(&[(longer, "spz opacities: the table says 2 bytes")], load);
    let followed = [sound, vec![0]].concat();
    let left_over = "1 bytes are left over after the last one";
    assert_refused(&[(followed, left_over)], load);
}

/// A kilobyte that unpacks to megabytes stops where the header does.
#[test]
fn a_zstd_bomb_stops_at_the_size_the_header_justifies() {
    let bomb = ruzstd::encoding::compress_to_vec(
        &vec![0u8; 4_000_000][..],
        ruzstd::encoding::CompressionLevel::Fastest,
    );
    let message = unzstd_exact(&bomb, 1000, "data").unwrap_err().to_string();
    assert!(message.contains("data: "), "{message}");
}
