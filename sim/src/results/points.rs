//! The scanned lion as round splats: enough of a scene to count pixels and cycles.
//!
//! Each point becomes an opaque sphere of half the scan's spacing as standard deviation, drawn with the cut-off and the low-pass
//! filter of the rules `ewa`. Normals and tangent planes do not matter to how many pixels a footprint of two pixels' radius has,
//! and the machine models the volume splats' datapath: surface splats (`--as surface`) blend in their own unit, which it does not have.

use crate::rules::Rules;
use crate::scene::{Scene, Skipped, Splat, Weight};
use anyhow::{Context, Result, ensure};
use std::path::Path;

/// The scan, from the folder of shared data.
pub const FILE: &str = "points/lion_takanawa.ply";

/// Distance between neighbouring points, scene units.
const SPACING: f64 = 0.007;

/// The cut-off and low-pass filter of `ewa`, with the points' own opacity.
pub const RULES: Rules = Rules {
    normalised: false,
    ..Rules::EWA
};

/// The header's properties; a vertex is six floats and three bytes.
const PROPERTIES: [&str; 9] = [
    "float x",
    "float y",
    "float z",
    "float nx",
    "float ny",
    "float nz",
    "uchar red",
    "uchar green",
    "uchar blue",
];
const VERTEX: usize = 27;

/// Reads the scan; each vertex becomes a splat.
pub fn load(path: &Path) -> Result<Scene> {
    let bytes = std::fs::read(path).with_context(|| format!("cannot read '{}'", path.display()))?;
    let end = b"end_header\n";
    let header = bytes
        .windows(end.len())
        .position(|window| window == end)
        .context("no PLY header")?
        + end.len();
    let text = String::from_utf8_lossy(&bytes[..header]);
    let properties: Vec<&str> = text
        .lines()
        .filter_map(|line| line.strip_prefix("property "))
        .collect();
    ensure!(
        text.contains("binary_little_endian") && properties == PROPERTIES,
        "'{}' is not the scan that is expected",
        path.display()
    );
    let splats = bytes[header..].chunks_exact(VERTEX).map(|vertex| {
        let coordinate = |axis: usize| {
            let mut number = [0; 4];
            number.copy_from_slice(&vertex[4 * axis..4 * axis + 4]);
            f64::from(f32::from_le_bytes(number))
        };
        let radius = SPACING / 2.0;
        Splat {
            centre: [0, 1, 2].map(coordinate),
            axes: [[radius, 0.0, 0.0], [0.0, radius, 0.0], [0.0, 0.0, radius]],
            weight: 1.0,
            colour: [24, 25, 26].map(|place| f64::from(vertex[place]) / 255.0),
        }
    });
    Ok(Scene {
        name: "lion_takanawa.ply".to_owned(),
        natural_rules: RULES,
        weight: Weight::Opacity,
        splats: splats.collect(),
        harmonics: None,
        skipped: Skipped::default(),
        up: [0.0, 0.0, 1.0],
    })
}
