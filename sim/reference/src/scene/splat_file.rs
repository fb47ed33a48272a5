//! `.splat`: 32 bytes per Gaussian and no header.
//!
//! Little-endian f32 centre and (linear) scales, then bytes: RGB and opacity over 255, and the quaternion w, x, y, z
//! as `(byte - 128) / 128`. Writers order the records freely (often by size), so indices differ from the PLY's.
//! Without a header a file cut between two records cannot be told from a shorter scene; any other cut is an error.

use super::Scene;
use super::bytes::{little_at, truncated};
use super::error::Problem;
use super::gaussian::{Gaussian, GaussianScene};
use anyhow::ensure;

const RECORD_BYTES: usize = 32;

/// Loads a `.splat` file.
pub(super) fn load(bytes: &[u8], name: &str) -> Result<Scene, Problem> {
    ensure!(
        !bytes.is_empty(),
        "records: the file is empty; give a file with at least one splat"
    );
    let (records, partial) = bytes.as_chunks::<RECORD_BYTES>();
    if !partial.is_empty() {
        return Err(truncated(
            &format!("record {}", records.len()),
            RECORD_BYTES as u64,
            partial.len(),
        ));
    }
    let mut scene = GaussianScene::new(0, records.len() as u64)?;
    for record in records {
        scene.push(&decode(record));
    }
    scene.finish(name)
}

fn decode(record: &[u8; RECORD_BYTES]) -> Gaussian {
    let float = |place: usize| f64::from(little_at::<f32, _>(record, place));
    let unit = |place: usize| f64::from(record[place]) / 255.0;
    let signed = |place: usize| (f64::from(record[place]) - 128.0) / 128.0;
    Gaussian {
        centre: [float(0), float(4), float(8)],
        scales: [float(12), float(16), float(20)],
        base: [unit(24), unit(25), unit(26)],
        opacity: unit(27),
        rotation: [signed(28), signed(29), signed(30), signed(31)],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record() -> Vec<u8> {
        let floats = [1.0f32, -2.0, 3.0, 0.1, 0.2, 0.4]
            .map(f32::to_le_bytes)
            .concat();
        [floats, vec![255, 51, 0, 102, 255, 128, 128, 128]].concat()
    }

    #[test]
    fn fields_are_decoded() {
        let splat = load(&record(), "x").unwrap().splats[0];
        assert_eq!(splat.centre, [1.0, -2.0, 3.0]);
        assert_eq!(splat.colour, [1.0, 0.2, 0.0]);
        assert_eq!(splat.weight, 0.4);
        let [a, b, c] = [0.1f32, 0.2, 0.4].map(f64::from);
        assert_eq!(splat.axes, [[a, 0.0, 0.0], [0.0, b, 0.0], [0.0, 0.0, c]]);
    }

    #[test]
    fn unusable_records_are_skipped_and_counted() {
        let mut bytes = [record(), record(), record()].concat();
        bytes[0..4].copy_from_slice(&f32::NAN.to_le_bytes());
        bytes[32 + 28..64].fill(128);
        let scene = load(&bytes, "x").unwrap();
        assert_eq!(
            (
                scene.splats.len(),
                scene.skipped.non_finite,
                scene.skipped.zero_rotation
            ),
            (1, 1, 1)
        );
    }

    #[test]
    fn every_cut_within_a_record_is_an_error() {
        let whole = [record(), record()].concat();
        for length in (0..whole.len()).filter(|length| *length != RECORD_BYTES) {
            assert!(load(&whole[..length], "x").is_err(), "cut at {length}");
        }
        let message = load(&whole[..40], "x").unwrap_err().to_string();
        assert!(
            message.starts_with("record 1: 32 bytes are needed but 8 are left"),
            "{message}"
        );
        let message = load(&[], "x").unwrap_err().to_string();
        assert_eq!(
            message,
            "records: the file is empty; give a file with at least one splat"
        );
    }
}
