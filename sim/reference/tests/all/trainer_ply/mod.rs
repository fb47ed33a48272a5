//! A minimal reader of trainer-style Gaussian PLY files (binary little-endian floats, harmonics of degree 0), kept
//! apart from the scene loader so that the golden test does not lean on it.

use std::path::Path;

use splatline_reference::engines::golden::rotated_axes;
use splatline_reference::rules::Rules;
use splatline_reference::scene::{Scene, Splat};

/// The harmonic of degree 0: 1 / (2 sqrt(pi)).
const HARMONIC_0: f64 = 0.28209479177387814;

/// Reads a scene; panics on anything unexpected, which is what a test wants.
pub fn load(path: &Path) -> Scene {
    let bytes = std::fs::read(path).unwrap();
    let marker = b"end_header\n";
    let end = bytes
        .windows(marker.len())
        .position(|window| window == marker)
        .unwrap()
        + marker.len();
    let header = String::from_utf8(bytes[..end].to_vec()).unwrap();
    let names: Vec<&str> = header
        .lines()
        .filter_map(|line| line.strip_prefix("property float "))
        .collect();
    let splats = bytes[end..]
        .chunks_exact(4 * names.len())
        .map(|record| splat(&names, record))
        .collect();
    Scene::of_splats("tiny.ply", Rules::GAUSSIAN_3D, splats)
}

fn splat(names: &[&str], record: &[u8]) -> Splat {
    let field = |name: &str| -> f64 {
        let at = 4 * names.iter().position(|&n| n == name).unwrap();
        f64::from(f32::from_le_bytes(record[at..at + 4].try_into().unwrap()))
    };
    let quaternion = ["rot_0", "rot_1", "rot_2", "rot_3"].map(field);
    let scales = ["scale_0", "scale_1", "scale_2"].map(|name| field(name).exp());
    Splat {
        centre: ["x", "y", "z"].map(field),
        axes: rotated_axes(quaternion, scales),
        weight: 1.0 / (1.0 + (-field("opacity")).exp()),
        colour: ["f_dc_0", "f_dc_1", "f_dc_2"]
            .map(|name| (0.5 + HARMONIC_0 * field(name)).max(0.0)),
    }
}
