//! Tests of the PLY reader: layouts, byte orders, damage.

use super::super::Skipped;
use super::*;
use crate::scene::damage_tests::{assert_refused, assert_refused_with, replaced, rows, survives};

const FIELDS: [&str; 14] = [
    "x", "y", "z", "f_dc_0", "f_dc_1", "f_dc_2", "opacity", "scale_0", "scale_1", "scale_2",
    "rot_0", "rot_1", "rot_2", "rot_3",
];

/// Values of two records, in the order of [`FIELDS`].
const RECORDS: [[f32; 14]; 2] = [
    [
        1.0, 2.0, 3.0, 0.5, -0.5, 0.25, 2.0, -3.0, -4.0, -5.0, 0.5, 0.5, -0.5, 0.5,
    ],
    [
        -1.0,
        0.5,
        9.0,
        1.5,
        0.0,
        -4.0,
        f32::INFINITY,
        -2.0,
        -2.5,
        -1.0,
        1.0,
        0.0,
        0.0,
        0.25,
    ],
];

fn header(format: &str, count: &str, properties: &[String]) -> String {
    format!(
        "ply\nformat {format} 1.0\nelement vertex {count}\n{}end_header\n",
        properties.concat()
    )
}

fn properties(names: &[&str]) -> Vec<String> {
    names
        .iter()
        .map(|name| format!("property float {name}\n"))
        .collect()
}

fn binary(records: &[&[f32]], big: bool) -> Vec<u8> {
    let bytes = |value: &f32| {
        if big {
            value.to_be_bytes()
        } else {
            value.to_le_bytes()
        }
    };
    records
        .iter()
        .flat_map(|record| record.iter().flat_map(bytes))
        .collect()
}

fn file(format: &str) -> Vec<u8> {
    let mut bytes = header(format, "2", &properties(&FIELDS)).into_bytes();
    match format {
        "ascii" => {
            for record in RECORDS {
                let words: Vec<String> = record.iter().map(f32::to_string).collect();
                bytes.extend(format!("{}\n", words.join(" ")).into_bytes());
            }
        }
        _ => bytes.extend(binary(
            &[&RECORDS[0], &RECORDS[1]],
            format == "binary_big_endian",
        )),
    }
    bytes
}

fn message(bytes: &[u8]) -> String {
    load(bytes, "x").unwrap_err().to_string()
}

#[test]
fn the_three_formats_agree() {
    let little = load(&file("binary_little_endian"), "x").unwrap();
    assert_eq!(little, load(&file("binary_big_endian"), "x").unwrap());
    assert_eq!(little, load(&file("ascii"), "x").unwrap());
    assert_eq!(little.splats[0].centre, [1.0, 2.0, 3.0]);
    assert_eq!(little.splats[1].weight, 1.0);
    assert_eq!(little.splats[1].colour[2], 0.0);
    assert!((little.splats[0].colour[0] - (0.5 + 0.5 * 0.282_094_79)).abs() < 1e-8);
}

#[test]
fn order_and_extra_properties_do_not_matter() {
    let mut names = FIELDS.to_vec();
    names.reverse();
    names.insert(3, "nx");
    let mut bytes = header("binary_little_endian", "2", &properties(&names)).into_bytes();
    for record in RECORDS {
        let mut values = record.to_vec();
        values.reverse();
        values.insert(3, 77.0);
        bytes.extend(binary(&[&values], false));
    }
    assert_eq!(
        load(&bytes, "x").unwrap(),
        load(&file("binary_little_endian"), "x").unwrap()
    );
}

#[test]
fn other_elements_and_lists_are_walked_over() {
    let plain = String::from_utf8(file("ascii")).unwrap();
    let (head, body) = plain.split_once("end_header\n").unwrap();
    let head = head.replace(
        "element vertex",
        "element camera 1\nproperty list uchar float pose\nproperty int id\nelement vertex",
    );
    let text = format!(
        "{head}element face 1\nproperty list uchar int vertices\nend_header\n2 0.5 0.5 7\n{body}3 0 1 2\n"
    );
    assert_eq!(
        load(text.as_bytes(), "x").unwrap(),
        load(plain.as_bytes(), "x").unwrap()
    );

    let plain = file("binary_little_endian");
    let at = plain
        .windows(11)
        .position(|window| window == b"end_header\n")
        .unwrap();
    let mut bytes = plain[..at].to_vec();
    bytes.extend(b"element face 1\nproperty list uchar short vertices\nend_header\n");
    bytes.extend(&plain[at + 11..]);
    bytes.extend([2, 0, 0, 1, 0]);
    assert_eq!(load(&bytes, "x").unwrap(), load(&plain, "x").unwrap());
}

/// The trainers write all red coefficients, then all green, then all blue.
#[test]
fn harmonics_are_stored_by_channel() {
    for (degree, per_channel) in [(1u8, 3usize), (2, 8), (3, 15)] {
        let mut names: Vec<String> = FIELDS.map(String::from).to_vec();
        names.extend((0..3 * per_channel).map(|k| format!("f_rest_{k}")));
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let mut record = RECORDS[0].to_vec();
        record.extend((0..3 * per_channel).map(|k| k as f32));
        let mut bytes = header("binary_little_endian", "1", &properties(&names)).into_bytes();
        bytes.extend(binary(&[&record], false));
        let harmonics = load(&bytes, "x").unwrap().harmonics.unwrap();
        assert_eq!(harmonics.degree, degree);
        let expected: Vec<[f32; 3]> = (0..per_channel)
            .map(|k| [0, 1, 2].map(|channel| (channel * per_channel + k) as f32))
            .collect();
        assert_eq!(harmonics.coefficients, expected);
    }
}

#[test]
fn unusable_records_are_skipped_and_counted() {
    let mut records = [RECORDS[0]; 6];
    records[1][0] = f32::NAN;
    records[2][7] = 500.0;
    records[3][10..14].fill(0.0);
    records[4][6] = f32::NEG_INFINITY;
    records[5][6] = f32::NAN;
    let mut bytes = header("binary_little_endian", "6", &properties(&FIELDS)).into_bytes();
    records
        .iter()
        .for_each(|record| bytes.extend(binary(&[record], false)));
    let scene = load(&bytes, "x").unwrap();
    assert_eq!(
        scene.skipped,
        Skipped {
            non_finite: 3,
            zero_rotation: 1
        }
    );
    assert_eq!(scene.splats.len(), 2);
    assert_eq!(scene.splats[1].weight, 0.0);
}

#[test]
fn damaged_files_are_refused() {
    for format in ["ascii", "binary_little_endian", "binary_big_endian"] {
        survives(&file(format), &|bytes| load(bytes, "x"));
    }
}

#[test]
fn absurd_counts_are_refused_at_once() {
    for format in ["ascii", "binary_little_endian"] {
        for count in ["1000000000000", "18446744073709551615"] {
            let found = message(header(format, count, &properties(&FIELDS)).as_bytes());
            assert!(
                found.starts_with(&format!("element vertex, {count} records: ")),
                "{found}"
            );
        }
    }
    let list =
        "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty list uint double a\n";
    let text = format!("{list}{}end_header\n", properties(&FIELDS).concat());
    let mut bytes = text.into_bytes();
    bytes.extend([0xff; 80]);
    assert!(
        message(&bytes)
            .starts_with("element vertex record 0, property a: 34359738360 bytes are needed")
    );
}

#[test]
#[cfg_attr(not(has_data), ignore = "needs the shared data")]
fn a_point_cloud_is_told_that_surface_splats_come_later() {
    let bytes = header(
        "ascii",
        "1",
        &properties(&["x", "y", "z", "nx", "ny", "nz"]),
    );
    assert_eq!(
        message(bytes.as_bytes()),
        "element vertex: it has none of scale_0, rot_0, opacity and f_dc_0, so this is a point cloud; \
         give --as surface to draw its points, or a 3D Gaussian PLY"
    );
    let path = super::super::tests::shared_data("points/lion_takanawa.ply");
    let error = super::super::load(&path, &super::super::LoadOptions::default())
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("lion_takanawa.ply: element vertex: it has none of"),
        "{error}"
    );
}

#[test]
fn each_message_names_the_field_and_the_fix() {
    let load = |bytes: &[u8]| load(bytes, "x");
    let texts = r"
        nonsense\n => PLY header line 1: it is not 'ply'; check that this is a PLY file
        ply\n => PLY header line 2: the file ends before end_header; fetch the file again: it is truncated
        ply\nend_header\n => no format line came before end_header; add 'format binary_little_endian 1.0'
        ply\nformat odd 1.0\n => PLY header line 2, format: 'odd' is unknown; use ascii
        ply\nwhat\n => PLY header line 2: 'what' is not understood; expected format, element
        ply\nproperty float x\n => a property comes before any element; put an element line before it
        ply\nelement vertex -1\n => element vertex: the count '-1' is no whole number; write the number
        ply\nelement vertex 1\nproperty x\n => it is neither 'property TYPE NAME' nor
        ply\nelement vertex 1\nproperty half x\n => line 3, property: the type 'half' is unknown; use one
        ply\nformat ascii 1.0\nend_header\n => there is no element 'vertex'; export the scene as a 3D
    ";
    for [text, expected] in rows(texts) {
        assert_refused(&[(text, &*expected)], load);
    }
    let full = properties(&FIELDS);
    let added = r"
        element vertex 1 => element 'vertex' is declared twice; declare it once
        property float x => element vertex: property 'x' is declared twice; declare it once
        property float f_rest_0 => properties f_rest_*: there are 1; degrees 0 to 4
        property uint packed_position => there is packed_position but no element 'chunk'
    ";
    let with = |extra: &str| [&full[..], &[extra.to_owned() + "\n"]].concat();
    for [line, expected] in rows(added) {
        assert_refused(&[(header("ascii", "1", &with(&line)), &*expected)], load);
    }
    let changed = r"
        vertex 2 => vertex 0 => element vertex: its count is 0; export a scene with splats in it
        property float x\n => => property x: the Gaussians' element vertex lacks it; export the scene with
        1 2 3 => 1 1 2 3 => line 19: '0.5' stands after the last property
        1 2 3 0.5 => 1 2\n => line 19, property z: the line ends before it
        1 2 3 => 1 two 3 => line 19, property y: 'two' is no number; write
        vertex 2 => vertex 3 => line 21: the file ends before the last record; fetch it
    ";
    let whole = file("ascii");
    assert_refused_with(&whole, changed, load);
    let list = header("ascii", "1", &with("property list int int odd"));
    let cases = [
        (
            whole.trim_ascii_end().to_vec(),
            "the file ends without a newline, so the last number may",
        ),
        (
            [&whole[..], b"9\n"].concat(),
            "PLY body: 1 bytes are left over after the last record",
        ),
        (
            (list + &"1 ".repeat(14) + "-1\n").into_bytes(),
            "line 20, property odd: the list length -1 is no count; correct the list",
        ),
    ];
    assert_refused(&cases, load);
}

fn with_comment(line: &str) -> Vec<u8> {
    replaced(
        &file("ascii"),
        "element",
        &format!("comment {line}\nelement"),
    )
}

/// As the tools that write them spell it.
#[test]
fn comments_tell_how_a_scene_was_trained() {
    let compensated = |line| {
        let scene = load(&with_comment(line), "x").unwrap();
        scene.natural_rules.compensated
    };
    assert!(compensated("SplatRenderMode: mip") && compensated("antialiased 1"));
    assert!(!compensated("SplatRenderMode: default") && !compensated("antialiased 0"));
    assert!(!compensated("Exported from Brush"));
}

/// As Mip-Splatting's own `create_fused_ply.py` computes it: scales sqrt(s^2 + f^2), opacity times the root of the
/// determinants' quotient.
#[test]
fn a_3d_filter_widens_and_dims() {
    let mut names = FIELDS.to_vec();
    names.push("filter_3D");
    let mut record = RECORDS[0].to_vec();
    record.push(0.02);
    let mut bytes = header("binary_little_endian", "1", &properties(&names)).into_bytes();
    bytes.extend(binary(&[&record], false));
    let filtered = load(&bytes, "x").unwrap();
    let plain = load(&file("binary_little_endian"), "x").unwrap();
    assert_eq!(filtered.natural_rules.low_pass, 0.1);
    assert!(filtered.natural_rules.compensated);
    let mut kept = 1.0;
    for (axis, log) in filtered.splats[0].axes.iter().zip([-3.0f64, -4.0, -5.0]) {
        let variance: f64 = axis.iter().map(|part| part * part).sum();
        let filter = f64::from(0.02f32).powi(2);
        assert!((variance - (log.exp().powi(2) + filter)).abs() < 1e-12);
        kept *= log.exp().powi(2) / variance;
    }
    let expected = plain.splats[0].weight * kept.sqrt();
    assert!((filtered.splats[0].weight - expected).abs() < 1e-12);
}

/// 2D Gaussians are the flat ones of the same two axes.
#[test]
fn without_a_third_scale_gaussians_are_flat() {
    let names: Vec<&str> = FIELDS
        .iter()
        .copied()
        .filter(|name| *name != "scale_2")
        .collect();
    let mut record = RECORDS[0].to_vec();
    record.remove(9);
    let mut bytes = header("binary_little_endian", "1", &properties(&names)).into_bytes();
    bytes.extend(binary(&[&record], false));
    let flat = load(&bytes, "x").unwrap().splats[0];
    let solid = load(&file("binary_little_endian"), "x").unwrap().splats[0];
    assert_eq!(flat.axes[..2], solid.axes[..2]);
    assert_eq!(flat.axes[2], [0.0; 3]);
    assert_eq!((flat.centre, flat.weight), (solid.centre, solid.weight));
}
