//! Tests of the SOG reader, on bundles and folders written here.

use super::super::damage_tests::{assert_refused, assert_refused_with, survives};
use super::*;
use crate::vector;
use image_webp::{ColorType, WebPEncoder};
use std::io::{Cursor, Write};

type SogFile = (String, Vec<u8>);

fn webp(width: u32, pixels: &[[u8; 4]]) -> Vec<u8> {
    let mut file = Vec::new();
    let height = pixels.len() as u32 / width;
    WebPEncoder::new(&mut file)
        .encode(&pixels.concat(), width, height, ColorType::Rgba8)
        .unwrap();
    file
}

fn meta(count: usize) -> String {
    let book = |first: f64| (0..256).map(move |k| format!("{}", first + f64::from(k) / 64.0));
    let list = |first: f64| book(first).collect::<Vec<_>>().join(",");
    format!(
        r#"{{"version":2,"count":{count},
        "means":{{"mins":[-2,-2,-2],"maxs":[2,2,2],"files":["ml.webp","mu.webp"]}},
        "scales":{{"codebook":[{}],"files":["s.webp"]}},
        "quats":{{"files":["q.webp"]}},
        "sh0":{{"codebook":[{}],"files":["c.webp"]}},
        "shN":{{"count":2,"bands":1,"codebook":[{}],"files":["centroids.webp","labels.webp"]}}}}"#,
        list(-4.0),
        list(-2.0),
        list(-1.0)
    )
}

/// Two Gaussians in pictures of 2 x 1.
fn files() -> Vec<SogFile> {
    let mut centroids = vec![[0; 4]; 192];
    centroids[3] = [64, 128, 192, 255];
    let opaque = |r, g, b| [r, g, b, 255];
    let pictures = [
        ("ml.webp", webp(2, &[opaque(255, 0, 255), opaque(0, 0, 0)])),
        ("mu.webp", webp(2, &[opaque(255, 0, 127), opaque(0, 0, 0)])),
        ("s.webp", webp(2, &[opaque(0, 64, 128), opaque(0, 0, 0)])),
        (
            "q.webp",
            webp(2, &[[255, 0, 128, 252], [128, 128, 128, 255]]),
        ),
        ("c.webp", webp(2, &[[128, 192, 0, 51], [0, 0, 0, 255]])),
        ("centroids.webp", webp(192, &centroids)),
        ("labels.webp", webp(2, &[opaque(1, 0, 0), opaque(0, 0, 0)])),
    ];
    let pictures = pictures.map(|(name, bytes)| (name.to_string(), bytes));
    [
        vec![(META.to_string(), meta(2).into_bytes())],
        pictures.to_vec(),
    ]
    .concat()
}

fn bundle(files: &[SogFile]) -> Vec<u8> {
    let mut archive = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for (index, (name, bytes)) in files.iter().enumerate() {
        let method = match index % 2 {
            0 => zip::CompressionMethod::Deflated,
            _ => zip::CompressionMethod::Stored,
        };
        let options = zip::write::SimpleFileOptions::default().compression_method(method);
        archive.start_file(name.as_str(), options).unwrap();
        archive.write_all(bytes).unwrap();
    }
    archive.finish().unwrap().into_inner()
}

fn with(name: &str, bytes: Vec<u8>) -> Vec<SogFile> {
    let change = |file: SogFile| {
        if file.0 == name {
            (file.0, bytes.clone())
        } else {
            file
        }
    };
    files().into_iter().map(change).collect()
}

#[test]
fn fields_are_decoded() {
    let scene = load_bundle(&bundle(&files()), "x").unwrap();
    let splat = scene.splats[0];
    let e = 2f64.exp_m1();
    assert!((splat.centre[0] - e).abs() < 1e-12 && (splat.centre[1] + e).abs() < 1e-12);
    let word = f64::from(0x7fff) / 65535.0;
    let v: f64 = -2.0 + 4.0 * word;
    assert!((splat.centre[2] - v.abs().exp_m1().copysign(v)).abs() < 1e-15);
    for (axis, log) in splat.axes.iter().zip([-4.0f64, -3.0, -2.0]) {
        assert!((vector::length(*axis) - log.exp()).abs() < 1e-12);
    }
    assert_eq!(splat.weight, 0.2);
    assert!((splat.colour[0] - 0.5).abs() < 1e-12);
    assert!((splat.colour[1] - 0.5 - 0.282_094_791_773_878_14).abs() < 1e-12);
    let harmonics = scene.harmonics.unwrap();
    assert_eq!(harmonics.coefficients[0], [0.0, 1.0, 2.0]);
    assert_eq!(harmonics.coefficients[3], [-1.0; 3]);
}

#[test]
fn a_folder_is_the_bundle_unpacked() {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in files() {
        std::fs::write(folder.path().join(name), bytes).unwrap();
    }
    let bundled = load_bundle(&bundle(&files()), "x").unwrap();
    assert_eq!(load_folder(folder.path(), "x").unwrap(), bundled);
    let by_path = |path: &Path| super::super::load(path, &super::super::LoadOptions::default());
    assert_eq!(by_path(folder.path()).unwrap().splats, bundled.splats);
    assert_eq!(
        by_path(&folder.path().join(META)).unwrap().splats,
        bundled.splats
    );
    std::fs::remove_file(folder.path().join("q.webp")).unwrap();
    let message = load_folder(folder.path(), "x").unwrap_err().to_string();
    assert!(
        message.starts_with("q.webp: damaged or truncated (cannot be read"),
        "{message}"
    );
}

#[test]
fn damaged_bundles_are_refused() {
    survives(&bundle(&files()), &|bytes| load_bundle(bytes, "x"));
}

#[test]
fn a_rotation_without_a_largest_part_is_counted() {
    let quats = webp(2, &[[0, 0, 0, 251], [128, 128, 128, 255]]);
    let scene = load_bundle(&bundle(&with("q.webp", quats)), "x").unwrap();
    assert_eq!((scene.splats.len(), scene.skipped.zero_rotation), (1, 1));
}

#[test]
fn each_message_names_the_field_and_the_fix() {
    let load = |files: Vec<SogFile>| load_bundle(&bundle(&files), "x");
    let table = r#"
        "version":2 => "version":3 => meta.json, version: it is 3; versions 1 and 2 are read
        "version":2, => => meta.json: it is not understood: missing field `shape`
        "count":2 => "count":0 => meta.json, count: it is 0
        "count":2 => "count":99999999999 => 99999999999 Gaussians cannot be in
        "count":2 => "count":3 => it has 2 x 1 pixels; 3 are needed
        [-4, => [ => meta.json, scales.codebook: it has 255 entries; 256 are needed
        "bands":1 => "bands":4 => meta.json, shN.bands: it is 4; 1 to 3 are read
        "bands":1 => "bands":2 => centroids.webp: it has 192 x 1 pixels; 512 are needed
        q.webp => ../q.webp => meta.json, files: '../q.webp' is no plain name
        q.webp => r.webp => r.webp: damaged or truncated (specified file not found
    "#;
    assert_refused_with(meta(2).as_bytes(), table, |text| {
        load(with(META, text.to_vec()))
    });
    let huge = webp(1024, &vec![[7, 7, 7, 255]; 1024 * 200]);
    let label = webp(2, &[[2, 0, 0, 255], [0, 0, 0, 255]]);
    let too_many = "c.webp: it has 1024 x 200 pixels; 2 are needed";
    let no_entry = "labels.webp: Gaussian 0 has the label 2; the palette has 2 entries";
    let cut = "q.webp: damaged or truncated";
    for (name, picture, expected) in [
        ("c.webp", huge, too_many),
        ("labels.webp", label, no_entry),
        ("q.webp", b"RIFF".to_vec(), cut),
    ] {
        let load = |picture: &[u8]| load(with(name, picture.to_vec()));
        assert_refused(&[(picture, expected)], load);
    }
}

/// The meta.json of version 1 for the same pictures, and the codes that both versions give them.
fn files_of_version_1() -> Vec<SogFile> {
    let text = r#"{"means":{"shape":[2,3],"dtype":"float32","mins":[-2,-2,-2],"maxs":[2,2,2],"files":["ml.webp","mu.webp"]},
        "scales":{"shape":[2,3],"dtype":"float32","mins":[-4,-5,-6],"maxs":[-0.015625,-1.015625,2],"files":["s.webp"]},
        "quats":{"shape":[2,4],"dtype":"uint8","encoding":"quaternion_packed","files":["q.webp"]},
        "sh0":{"shape":[2,1,4],"dtype":"float32","mins":[-2,-3,0,-6],"maxs":[1.984375,0.984375,1,9.3],"files":["c.webp"]},
        "shN":{"shape":[2,9],"dtype":"float32","mins":-1,"maxs":2.984375,"quantization":8,"files":["centroids.webp","labels.webp"]}}"#;
    with(META, text.as_bytes().to_vec())
}

#[test]
fn version_1_has_ranges_in_the_place_of_codebooks() {
    let scene = load_bundle(&bundle(&files_of_version_1()), "x").unwrap();
    let second = load_bundle(&bundle(&files()), "x").unwrap();
    let (splat, other) = (scene.splats[0], second.splats[0]);
    assert_eq!(splat.centre, other.centre);
    // Scales: steps of 1 / 64 from -4, the same from -5, and 128 of 255 of the way from -6 to 2.
    let logs = [-4.0, -4.0, -6.0 + 8.0 * 128.0 / 255.0];
    for (axis, log) in splat.axes.iter().zip(logs) {
        assert!((vector::length(*axis) - f64::exp(log)).abs() < 1e-12);
    }
    // 51 of 255 of the way from -6 to 9.3 is -2.94.
    assert!((splat.weight - 1.0 / (1.0 + f64::exp(2.94))).abs() < 1e-12);
    assert!((splat.colour[0] - other.colour[0]).abs() < 1e-12);
    assert!((splat.colour[1] - 0.5).abs() < 1e-12);
    assert_eq!(splat.colour[2], 0.5);
    assert_eq!(
        scene.harmonics.unwrap().coefficients,
        second.harmonics.unwrap().coefficients
    );
    survives(&bundle(&files_of_version_1()), &|bytes| {
        load_bundle(bytes, "x")
    });
}

#[test]
fn a_palette_of_version_1_has_the_width_of_its_bands() {
    let change = |file: SogFile| match file.0.as_str() {
        "centroids.webp" => (file.0, webp(256, &[[0; 4]; 256])),
        _ => file,
    };
    let files: Vec<SogFile> = files_of_version_1().into_iter().map(change).collect();
    let message = load_bundle(&bundle(&files), "x").unwrap_err().to_string();
    assert_eq!(
        message,
        "centroids.webp: it is 256 pixels wide; 192, 512 and 960 are those of 1 to 3 bands; export the scene again"
    );
}
