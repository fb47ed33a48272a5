//! `.splat`: 32 bytes per Gaussian and no header.
//!
//! Little-endian f32 centre and (linear) scales, then bytes: RGB and opacity over 255, and the quaternion w, x, y, z
//! as `(byte - 128) / 128`. Writers order the records freely (often by size), so indices differ from the PLY's.
//! Without a header a file cut between two records cannot be told from a shorter scene; any other cut is an error.

use super::Scene;
use super::bytes::truncated;
use super::error::Problem;
use super::gaussian::{Gaussian, GaussianScene};

const RECORD_BYTES: usize = 32;

/// Loads a `.splat` file.
pub(super) fn load(bytes: &[u8], name: &str) -> Result<Scene, Problem> {
    if bytes.is_empty() {
        return Err(Problem::malformed(
            "records",
            "the file is empty",
            "give a file with at least one splat",
        ));
    }
    let (records, partial) = bytes.as_chunks::<RECORD_BYTES>();
    if !partial.is_empty() {
        return Err(truncated(
            &format!("record {}", records.len()),
            RECORD_BYTES as u64,
            partial.len(),
        ));
    }
    let mut scene = GaussianScene::new(0);
    for record in records {
        scene.push(&decode(record));
    }
    scene.finish(name)
}

fn decode(record: &[u8; RECORD_BYTES]) -> Gaussian<'static> {
    let float = |place: usize| {
        f64::from(f32::from_le_bytes([
            record[place],
            record[place + 1],
            record[place + 2],
            record[place + 3],
        ]))
    };
    let unit = |place: usize| f64::from(record[place]) / 255.0;
    let signed = |place: usize| (f64::from(record[place]) - 128.0) / 128.0;
    Gaussian {
        centre: [float(0), float(4), float(8)],
        scales: [float(12), float(16), float(20)],
        base: [unit(24), unit(25), unit(26)],
        opacity: unit(27),
        rotation: [signed(28), signed(29), signed(30), signed(31)],
        harmonics: &[],
    }
}
