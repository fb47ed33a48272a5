//! Compressed PLY, as the PlayCanvas tools write it: chunks of 256 Gaussians, each with the ranges of its values.
//!
//! | element | properties |
//! |---|---|
//! | `chunk` | `min_x` .. `max_z`, `min_scale_x` .. `max_scale_z` (logarithms), optionally `min_r` .. `max_b`, as `float` |
//! | `vertex` | `packed_position` and `packed_scale` (11, 10 and 11 bits), `packed_rotation` (2 bits: the largest part of w, x, y, z; 3 x 10 bits: the others), `packed_color` (8 bits each: red, green, blue, opacity), as `uint` |
//! | `sh` | optionally `f_rest_*` as `uchar`: all of red, then green, then blue, -4 to 4 |

use super::super::Scene;
use super::super::bytes::Scalar;
use super::super::error::Problem;
use super::super::gaussian::{
    Gaussian, GaussianScene, TRAINED_ANTIALIASED, coefficient_count, degree_of, scale_from_log,
};
use super::super::quaternion::smallest_three;
use super::body;
use super::header::{Element, PlyHeader, PropertyKind};
use super::{all, bad_harmonics, number};
use anyhow::{Context, bail, ensure};

/// Gaussians per chunk.
const CHUNK: u64 = 256;
/// The ranges of a chunk: least and greatest place, scale and, if stored, colour.
const RANGES: [[&str; 3]; 6] = [
    ["min_x", "min_y", "min_z"],
    ["max_x", "max_y", "max_z"],
    ["min_scale_x", "min_scale_y", "min_scale_z"],
    ["max_scale_x", "max_scale_y", "max_scale_z"],
    ["min_r", "min_g", "min_b"],
    ["max_r", "max_g", "max_b"],
];
const PACKED: [&str; 4] = [
    "packed_position",
    "packed_rotation",
    "packed_scale",
    "packed_color",
];

/// Loads the Gaussians of a compressed PLY file.
pub(super) fn load(header: &PlyHeader, body: &[u8], name: &str) -> Result<Scene, Problem> {
    let layout = ChunkLayout::find(header)?;
    let mut chunks: Vec<[[f64; 3]; 6]> = Vec::new();
    let mut packed: Vec<[u32; 4]> = Vec::new();
    let mut harmonics: Vec<u8> = Vec::new();
    body::walk(
        header,
        body,
        &mut |element, record| match element.name.as_str() {
            "chunk" => chunks.push(
                layout
                    .ranges
                    .map(|three| three.map(|at| number(record, at))),
            ),
            "vertex" => packed.push(layout.packed.map(|column| number(record, column) as u32)),
            "sh" => harmonics.extend(layout.rest.iter().map(|at| number(record, *at) as u8)),
            _ => {}
        },
    )?;
    let degree = layout.degree;
    let mut scene = GaussianScene::new(degree, packed.len() as u64)?;
    if header.antialiased {
        scene.rules = TRAINED_ANTIALIASED;
    }
    let count = coefficient_count(degree);
    for (index, packed) in packed.iter().enumerate() {
        let stored = harmonics.get(index * 3 * count..).unwrap_or_default();
        for (k, coefficient) in scene.harmonics.iter_mut().enumerate() {
            let byte = |channel: usize| stored.get(channel * count + k).copied().unwrap_or(128);
            *coefficient = [0, 1, 2].map(|channel| harmonic(byte(channel)));
        }
        // The counts were compared, so every Gaussian has its chunk.
        if let Some(ranges) = chunks.get(index / CHUNK as usize) {
            scene.push(&decode(packed, ranges, layout.coloured));
        }
    }
    scene.finish(name)
}

struct ChunkLayout {
    /// Those that the file leaves out are never used.
    ranges: [[usize; 3]; 6],
    packed: [usize; 4],
    rest: Vec<usize>,
    degree: u8,
    coloured: bool,
}

impl ChunkLayout {
    fn find(header: &PlyHeader) -> Result<ChunkLayout, Problem> {
        let element = |name: &str| header.elements.iter().find(|element| element.name == name);
        let (Some(chunk), Some(vertex)) = (element("chunk"), element("vertex")) else {
            bail!(
                "PLY header: there is packed_position but no element 'chunk'; \
                 export the scene again: the ranges of the packed values are missing"
            );
        };
        let wanted = vertex.count.div_ceil(CHUNK);
        ensure!(
            chunk.count == wanted,
            "element chunk: there are {} for {} vertices; \
             {wanted} of {CHUNK} vertices each are needed; export the scene again",
            chunk.count,
            vertex.count
        );
        let coloured = chunk.column("min_r").is_some();
        let needed = if coloured { 6 } else { 4 };
        let mut ranges = [[0; 3]; 6];
        for (three, names) in ranges.iter_mut().zip(RANGES).take(needed) {
            *three = all(names, |name| typed(chunk, name, Scalar::F32))?;
        }
        let rest = match element("sh") {
            Some(sh) => harmonics_of(sh, vertex)?,
            None => Vec::new(),
        };
        let degree = match rest.len() % 3 {
            0 => degree_of(rest.len() / 3),
            _ => None,
        };
        Ok(ChunkLayout {
            ranges,
            packed: all(PACKED, |name| typed(vertex, name, Scalar::U32))?,
            degree: degree.ok_or_else(|| bad_harmonics(rest.len()))?,
            rest,
            coloured,
        })
    }
}

fn harmonics_of(sh: &Element, vertex: &Element) -> Result<Vec<usize>, Problem> {
    ensure!(
        sh.count == vertex.count,
        "element sh: there are {} for {} vertices; one per vertex is needed; \
         export the scene again",
        sh.count,
        vertex.count
    );
    (0..sh.properties.len())
        .map(|k| typed(sh, &format!("f_rest_{k}"), Scalar::U8))
        .collect()
}

/// The column of a property of the one type that it has in this layout.
fn typed(element: &Element, name: &str, scalar: Scalar) -> Result<usize, Problem> {
    let column = element.column(name);
    let right = |column: &usize| element.properties[*column].kind == PropertyKind::Number(scalar);
    column.filter(right).with_context(|| {
        format!(
            "element {}, property {name}: a compressed PLY needs it as {scalar:?}; \
             export the scene again, or as an uncompressed PLY",
            element.name
        )
    })
}

fn decode(
    [position, rotation, scale, colour]: &[u32; 4],
    ranges: &[[f64; 3]; 6],
    coloured: bool,
) -> Gaussian {
    let between = |least: usize, parts: [f64; 3]| -> [f64; 3] {
        [0, 1, 2].map(|i| {
            let (low, high) = (ranges[least][i], ranges[least + 1][i]);
            low * (1.0 - parts[i]) + high * parts[i]
        })
    };
    let bytes = [24, 16, 8, 0].map(|shift| unit(*colour, shift, 8));
    let rgb = [bytes[0], bytes[1], bytes[2]];
    let parts = [20, 10, 0].map(|shift| 2.0 * (unit(*rotation, shift, 10) - 0.5));
    // Stored as (part / sqrt(2) + 1/2).
    let largest = (*rotation >> 30) as usize;
    Gaussian {
        centre: between(0, three(*position)),
        scales: between(2, three(*scale)).map(scale_from_log),
        rotation: smallest_three(largest, parts),
        opacity: bytes[3],
        base: if coloured { between(4, rgb) } else { rgb },
    }
}

/// 11, 10 and 11 bits from the top, each 0 to 1.
fn three(word: u32) -> [f64; 3] {
    [unit(word, 21, 11), unit(word, 11, 10), unit(word, 0, 11)]
}

fn unit(word: u32, shift: u32, bits: u32) -> f64 {
    let most = (1u32 << bits) - 1;
    f64::from((word >> shift) & most) / f64::from(most)
}

/// 256 steps from -4 to 4: the middles of the steps, but exact ends.
fn harmonic(byte: u8) -> f32 {
    let part = match byte {
        0 => 0.0,
        255 => 1.0,
        _ => (f32::from(byte) + 0.5) / 256.0,
    };
    (part - 0.5) * 8.0
}

#[cfg(test)]
#[path = "compressed_tests.rs"]
mod tests;
