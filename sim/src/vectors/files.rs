//! A folder of vectors: written by [`export`], checked by [`verify`].

use super::builtin::soft;
use super::compute::splats_stage;
use super::manifest::{Manifest, StageRecord};
use super::stage::digest;
use super::work::room_for;
use super::{VectorStage, VectorSubject, compute};
use crate::atomic;
use crate::difference::differences;
use crate::input::{self, Refused};
use fixed::types::U4F28;
use splatline::splat::{Axis, VolumeSplat};
use std::fmt::Display;
use std::fs;
use std::path::Path;

/// Largest viewport side that vectors are computed for: a manifest from a stranger cannot ask for gigabytes.
const LARGEST_SIDE: u16 = 4096;
/// Pixels of a viewport that are computed even if the folder has no picture of that many (72 bytes each).
const FREE_PIXELS: u64 = 1 << 20;
/// A manifest has some thirty kilobytes.
const MANIFEST_BYTES: u64 = 1 << 22;

/// What was checked.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Verified {
    /// Name and number of records of each stage that agrees.
    pub stages: Vec<(String, usize)>,
    /// Stages of which the folder has no file.
    pub missing: Vec<String>,
}

/// Writes the manifest and one file per stage into `folder`, which is made if need be.
pub fn export(folder: &Path, subject: &VectorSubject) -> Result<Manifest, Refused> {
    fs::create_dir_all(folder).map_err(|error| refused(folder, error))?;
    room_for(subject).map_err(|error| refused(folder, error))?;
    let stages = compute(subject);
    let manifest = Manifest::new(subject, &stages);
    // Before any is written: the scene may be one of them.
    for record in &manifest.stages {
        let file = folder.join(&record.file);
        atomic::refuse_input(&file).map_err(|error| refused(&file, error))?;
    }
    for (stage, record) in stages.iter().zip(&manifest.stages) {
        write(&folder.join(&record.file), &stage.to_text())?;
    }
    let file = folder.join("manifest.json");
    let text = serde_json::to_string_pretty(&manifest).map_err(|error| refused(&file, error))?;
    write(&file, &text)?;
    Ok(manifest)
}

/// Computes all stages anew from the manifest and the splats in `folder` and compares every file that is there, in the
/// order of the data flow. The first difference is the error.
pub fn verify(folder: &Path) -> Result<Verified, Refused> {
    let file = folder.join("manifest.json");
    let text = input::text(&file, MANIFEST_BYTES).map_err(|error| refused(&file, error))?;
    let manifest: Manifest = serde_json::from_str(&text).map_err(|error| refused(&file, error))?;
    let mut subject = manifest
        .subject()
        .map_err(|problem| refused(&file, problem))?;
    let sides = subject.view.viewport;
    if sides.iter().any(|side| *side > LARGEST_SIDE) {
        let message = format!("view.viewport is {sides:?}, at most {LARGEST_SIDE} a side");
        return Err(refused(&file, message));
    }
    refuse_absurd_picture(folder, &file, sides)?;
    subject.splats = read_splats(folder, &manifest, &splats_stage())?;
    room_for(&subject).map_err(|error| refused(folder, error))?;
    let expected = compute(&subject);
    let mut verified = Verified::default();
    for stage in &expected {
        let file = folder.join(format!("{}.hex", stage.name));
        if !file.exists() {
            verified.missing.push(stage.name.to_owned());
            continue;
        }
        let got = stage
            .parse(&read(&file)?)
            .map_err(|problem| refused(&file, problem))?;
        compare(&expected, stage, &got).map_err(|difference| refused(&file, difference))?;
        verified.stages.push((stage.name.to_owned(), got.len()));
    }
    check_manifest(&text, &Manifest::new(&subject, &expected))
        .map_err(|problem| refused(&file, problem))?;
    Ok(verified)
}

/// Every field of the manifest must be what this kernel would write: a bench takes widths and places from it.
///
/// After the stages, whose first different record says more than a digest.
fn check_manifest(text: &str, expected: &Manifest) -> Result<(), String> {
    let value = |text: &str| serde_json::from_str::<serde_json::Value>(text);
    let expected = serde_json::to_string(expected).and_then(|text| value(&text));
    let (found, expected) = match (value(text), expected) {
        (Ok(found), Ok(expected)) => (found, expected),
        (Err(error), _) | (_, Err(error)) => return Err(error.to_string()),
    };
    match differences(&found, &expected).first() {
        None => Ok(()),
        Some(d) => Err(format!(
            "{} is {}, this kernel's is {}: export the vectors again",
            d.place, d.first, d.second
        )),
    }
}

/// Memory is bounded by the folder's size: a large viewport must come with a picture that has a line for each of its
/// pixels.
fn refuse_absurd_picture(
    folder: &Path,
    manifest: &Path,
    viewport: [u16; 2],
) -> Result<(), Refused> {
    let pixels: u64 = viewport.iter().map(|side| u64::from(*side)).product();
    let stored = fs::metadata(folder.join("tile.hex")).map_or(0, |metadata| metadata.len());
    if pixels <= stored.max(FREE_PIXELS) {
        Ok(())
    } else {
        Err(refused(
            manifest,
            format!(
                "view.viewport has {pixels} pixels, but tile.hex has {stored} bytes: correct the viewport or export the vectors again"
            ),
        ))
    }
}

/// The inputs must be those of the manifest: otherwise two different things would be compared.
fn read_splats(
    folder: &Path,
    manifest: &Manifest,
    stage: &VectorStage,
) -> Result<Vec<VolumeSplat>, Refused> {
    let file = folder.join("splats.hex");
    let text = read(&file)?;
    let listed: Option<&StageRecord> = manifest.stages.iter().find(|s| s.name == stage.name);
    let (found, expected) = (digest(text.as_bytes()), listed.map_or("", |s| &s.digest));
    if found != expected {
        let message = format!(
            "digest is {found}, the manifest says '{expected}': these are not the splats of these vectors"
        );
        return Err(refused(&file, message));
    }
    let records = stage
        .parse(&text)
        .map_err(|problem| refused(&file, problem))?;
    Ok(records.iter().map(|record| splat(record)).collect())
}

fn splat(record: &[i64]) -> VolumeSplat {
    let mut values = record.iter().copied();
    let mut next = || values.next().unwrap_or_default();
    VolumeSplat {
        centre: [(); 3].map(|()| soft(next() as i32, next() as i32)),
        axes: [(); 3].map(|()| Axis {
            mantissa: [(); 3].map(|()| next() as i32),
            exponent: next() as i32,
        }),
        weight: soft(next() as i32, next() as i32),
        colour: [(); 3].map(|()| U4F28::from_bits(next() as u32)),
    }
}

/// Which splat a record of a stage belongs to, in words; runs and pixels name their packet, whose last field is its
/// splat.
fn owner(stages: &[VectorStage], stage: &VectorStage, index: usize) -> String {
    let record = |index: usize| stage.records.get(index);
    let splat = match stage.name {
        "table" | "tile" | "samples" | "deep" | "gathers" | "sheets" | "perspective"
        | "indices" => None,
        "packets" => record(index).and_then(|packet| packet.last().copied()),
        "runs" | "pixels" => {
            let mut packets = stages.iter().filter(|stage| stage.name == "packets");
            let packet = record(index).and_then(|record| record.first());
            let packet = packet.zip(packets.next());
            packet.and_then(|(number, all)| all.records.get(*number as usize)?.last().copied())
        }
        _ => Some(index as i64),
    };
    splat.map_or(String::new(), |splat| format!(" (splat {splat})"))
}

/// Both are equal, or where they first differ; `stages` are all that were computed.
fn compare(stages: &[VectorStage], stage: &VectorStage, got: &[Vec<i64>]) -> Result<(), String> {
    for (index, (expected, got)) in stage.records.iter().zip(got).enumerate() {
        let mut values = stage.fields.iter().zip(expected.iter().zip(got));
        if let Some((field, (expected, got))) = values.find(|(_, (expected, got))| expected != got)
        {
            let whose = owner(stages, stage, index);
            let (stage, name) = (stage.name, &field.name);
            let mask = u64::MAX >> (64 - field.bits);
            let hex = |value: i64| format!("{value} (0x{:x})", value as u64 & mask);
            return Err(format!(
                "stage {stage}, record {index}{whose}, field {name}: expected {}, got {}",
                hex(*expected),
                hex(*got)
            ));
        }
    }
    if stage.records.len() != got.len() {
        let last = stage.records.len().saturating_sub(1);
        let whose = owner(stages, stage, got.len().min(last));
        return Err(format!(
            "stage {}: expected {} records, got {}; the first that is missing or too many is {}{whose}",
            stage.name,
            stage.records.len(),
            got.len(),
            stage.records.len().min(got.len())
        ));
    }
    Ok(())
}

fn read(file: &Path) -> Result<String, Refused> {
    input::text(file, input::TABLE).map_err(|error| refused(file, error))
}

fn write(file: &Path, text: &str) -> Result<(), Refused> {
    atomic::write(file, text.as_bytes()).map_err(|error| refused(file, error))
}

/// A file and what is wrong with it.
pub(super) fn refused(file: &Path, problem: impl Display) -> Refused {
    Refused(format!("{}: {problem}", file.display()))
}
