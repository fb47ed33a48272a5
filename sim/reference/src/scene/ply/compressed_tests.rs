//! Tests of the compressed PLY reader, on files packed here from the layout's description.

use super::super::super::damage_tests::{assert_refused, assert_refused_with, survives};
use super::super::load;
use super::*;

const CHUNK_FIELDS: [&str; 6] = ["min", "max", "min_scale", "max_scale", "min", "max"];

fn header(chunks: usize, vertices: usize, harmonics: usize) -> String {
    let mut text = format!("ply\nformat binary_little_endian 1.0\nelement chunk {chunks}\n");
    for (index, prefix) in CHUNK_FIELDS.iter().enumerate() {
        let axes = if index < 4 {
            ["x", "y", "z"]
        } else {
            ["r", "g", "b"]
        };
        for axis in axes {
            text += &format!("property float {prefix}_{axis}\n");
        }
    }
    text += &format!("element vertex {vertices}\n");
    for name in PACKED {
        text += &format!("property uint {name}\n");
    }
    if harmonics > 0 {
        text += &format!("element sh {vertices}\n");
        for k in 0..harmonics {
            text += &format!("property uchar f_rest_{k}\n");
        }
    }
    text + "end_header\n"
}

/// Places 0 to 8, logarithms of scales -4 to 0, colours 0 to 2.
fn chunk() -> Vec<u8> {
    let ranges = [
        [0.0f32; 3],
        [8.0; 3],
        [-4.0; 3],
        [0.0; 3],
        [0.0; 3],
        [2.0; 3],
    ];
    ranges
        .concat()
        .into_iter()
        .flat_map(f32::to_le_bytes)
        .collect()
}

fn words(words: [u32; 4]) -> Vec<u8> {
    words.into_iter().flat_map(u32::to_le_bytes).collect()
}

/// At (8, 0, 4.0...), scales e^-4, e^0, e^-4, half a turn around x, colour (2, 0, 2 x 51/255), opacity 102/255.
const ONE: [u32; 4] = [
    2047 << 21 | 1024,
    1 << 30 | 512 << 20 | 512 << 10 | 512,
    1023 << 11,
    0xff_00_33_66,
];

fn one(harmonics: usize) -> Vec<u8> {
    let bytes = (0..harmonics).map(|k| [0, 255, 128, 127][k % 4]);
    [
        header(1, 1, harmonics).into_bytes(),
        chunk(),
        words(ONE),
        bytes.collect(),
    ]
    .concat()
}

#[test]
fn fields_are_decoded() {
    let scene = load(&one(9), "x").unwrap();
    let splat = scene.splats[0];
    assert_eq!(splat.centre[..2], [8.0, 0.0]);
    assert!((splat.centre[2] - 8.0 * 1024.0 / 2047.0).abs() < 1e-12);
    for (axis, log) in splat.axes.iter().zip([-4.0f64, 0.0, -4.0]) {
        assert!((crate::vector::length(*axis) - log.exp()).abs() < 1e-12);
    }
    // Around x by (almost) 180 degrees: y stays on its line.
    assert!(splat.axes[1][1].abs() > 0.9999, "{:?}", splat.axes[1]);
    let expected = [2.0, 0.0, 0.4];
    assert!(
        splat
            .colour
            .iter()
            .zip(expected)
            .all(|(a, b)| (a - b).abs() < 1e-12)
    );
    assert_eq!(splat.weight, 0.4);
    let harmonics = scene.harmonics.unwrap();
    assert_eq!(harmonics.degree, 1);
    // All of red, then green, then blue: bytes 0, 255, 128 | 127, 0, 255 | 128, 127, 0.
    let middle = 8.0 * 0.5 / 256.0;
    assert_eq!(
        harmonics.coefficients,
        [
            [-4.0, -middle, middle],
            [4.0, -4.0, -middle],
            [middle, 4.0, -4.0]
        ]
    );
}

#[test]
fn every_chunk_rules_its_own_256() {
    let mut second = chunk();
    second[0..4].copy_from_slice(&100f32.to_le_bytes());
    second[12..16].copy_from_slice(&100f32.to_le_bytes());
    let body = (0..257).flat_map(|_| words(ONE));
    let file = [
        header(2, 257, 0).into_bytes(),
        chunk(),
        second,
        body.collect(),
    ]
    .concat();
    let scene = load(&file, "x").unwrap();
    let columns: Vec<f64> = scene.splats[254..]
        .iter()
        .map(|splat| splat.centre[0])
        .collect();
    assert_eq!(columns, [8.0, 8.0, 100.0]);
}

#[test]
fn damaged_files_are_refused() {
    survives(&one(9), &|bytes| load(bytes, "x"));
}

#[test]
fn each_message_names_the_field_and_the_fix() {
    let load = |bytes: &[u8]| load(bytes, "x");
    let table = r"
        chunk 1\n => chunk 2\n => element chunk: there are 2 for 1 vertices; 1 of 256 vertices each are needed
        vertex 1\n => vertex 257\n => element chunk: there are 1 for 257 vertices; 2 of 256
        uint packed_scale => int packed_scale => element vertex, property packed_scale: a compressed PLY needs it as U32
        max_scale_z => max_scale_w => element chunk, property max_scale_z: a compressed PLY needs it as F32
        element chunk => element chunks => no element 'chunk'
        element sh 1 => element sh 3 => element sh: there are 3 for 1 vertices; one per vertex is needed
    ";
    assert_refused_with(&one(9), table, load);
    let cases = [
        (one(5), "properties f_rest_*: there are 5"),
        (
            header(3_906_250, 1_000_000_000, 0).into_bytes(),
            "element chunk, 3906250 records: 281250000 bytes are needed but",
        ),
    ];
    assert_refused(&cases, load);
}
