//! Damaged files of every format. The answer is a message or, where the format cannot tell (a text cut between two
//! lines), a shorter content; never a panic and never memory beyond the file's size.
//!
//! The readers' own tests cut scenes and volumes at every byte; here is what is read elsewhere.

#[cfg(target_os = "linux")]
mod bombs;
mod mutations;
pub mod readers;
pub mod seeds;

use super::shell::{files_below, holds};
use seeds::{few_vectors, seed};
use splatline_sim::camera::Camera;
use splatline_sim::scene::points;
use splatline_sim::vectors::{export, verify};
use std::path::{Path, PathBuf};

/// Calls `read` with a file of each proper prefix of the seed; its answer is "did that succeed?". Lengths that
/// succeeded.
fn lengths_read(name: &str, read: fn(&Path) -> bool) -> Vec<usize> {
    let folder = tempfile::tempdir().unwrap();
    let (path, whole) = (folder.path().join(name), seed(name));
    std::fs::write(&path, &whole).unwrap();
    assert!(read(&path), "{name} is sound as a whole");
    let succeeds = |length: &usize| {
        std::fs::write(&path, &whole[..*length]).unwrap();
        read(&path)
    };
    (0..whole.len()).filter(succeeds).collect()
}

/// Lines of numbers have no count before them, so a cut after the third of four leaves a smaller cloud, and the last
/// line's end may be missing.
#[test]
fn clouds_and_cameras_cut_anywhere_are_refused() {
    let is_cloud = |path: &Path| points::load(path).is_ok();
    assert_eq!(lengths_read("cloud.ply", is_cloud), [0; 0]);
    let four = seed("cloud.xyz").len();
    let three = 3 * four / 4;
    let sound = lengths_read("cloud.xyz", is_cloud);
    assert_eq!(sound, [three - 1, three, four - 1]);
    let is_camera = |path: &Path| Camera::corrected_from_json_file(path).is_ok();
    assert_eq!(lengths_read("camera.json", is_camera), [0; 0]);
}

#[test]
fn vectors_cut_anywhere_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    export(folder.path(), &few_vectors([4, 4])).unwrap();
    for name in ["manifest.json", "splats.hex", "tile.hex"] {
        let path = folder.path().join(name);
        let whole = std::fs::read(&path).unwrap();
        // Every byte of the small files, a sample of the long manifest; the last byte is the end of a line.
        let end = whole.trim_ascii_end().len();
        for length in (0..end).step_by(1 + end / 400) {
            std::fs::write(&path, &whole[..length]).unwrap();
            assert!(verify(folder.path()).is_err(), "{name} cut at {length}");
        }
        std::fs::write(&path, &whole).unwrap();
    }
    assert!(verify(folder.path()).is_ok());
}

/// Few vectors in a folder, their manifest's file and its contents.
fn exported(size: [u16; 2]) -> (tempfile::TempDir, PathBuf, serde_json::Value) {
    let folder = tempfile::tempdir().unwrap();
    export(folder.path(), &few_vectors(size)).unwrap();
    let path = folder.path().join("manifest.json");
    let manifest = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
    (folder, path, manifest)
}

/// The places of all values of a JSON text that are neither a list nor an object.
fn leaves(value: &serde_json::Value, place: &str, found: &mut Vec<String>) {
    match value {
        serde_json::Value::Object(map) => map
            .iter()
            .for_each(|(key, value)| leaves(value, &format!("{place}/{key}"), found)),
        serde_json::Value::Array(list) => list
            .iter()
            .enumerate()
            .for_each(|(index, value)| leaves(value, &format!("{place}/{index}"), found)),
        _ => found.push(place.to_owned()),
    }
}

fn other(value: &serde_json::Value) -> serde_json::Value {
    match value {
        serde_json::Value::Bool(value) => (!value).into(),
        serde_json::Value::String(text) => format!("{text}0").into(),
        // One less, since many fields are at their largest.
        number => (number.as_i64().unwrap_or_default() - 1).into(),
    }
}

/// No field of a manifest is there for show: whichever says something else, verifying fails.
#[test]
fn every_field_of_a_manifest_is_checked() {
    let (folder, path, sound) = exported([4, 4]);
    let mut places = Vec::new();
    leaves(&sound, "", &mut places);
    assert!(places.len() > 500, "{}", places.len());
    // No field changes the tables, and reading them anew for each field is most of the time. Their digests are compared
    // all the same.
    for table in ["reciprocals", "roots", "logarithms", "functions"] {
        std::fs::remove_file(folder.path().join(table).with_extension("hex")).unwrap();
    }
    for place in &places {
        let mut altered = sound.clone();
        let value = altered.pointer_mut(place).unwrap();
        *value = other(value);
        std::fs::write(&path, altered.to_string()).unwrap();
        assert!(verify(folder.path()).is_err(), "{place}");
    }
    let mut more = sound.clone();
    more["rating"] = "five stars".into();
    std::fs::write(&path, more.to_string()).unwrap();
    let printed = verify(folder.path()).unwrap_err().to_string();
    holds(
        &printed,
        &["rating is \"five stars\", this kernel's is nothing"],
    );
    std::fs::write(&path, sound.to_string()).unwrap();
    verify(folder.path()).unwrap();
}

/// A manifest of two kilobytes that asks for 16 million pixels.
#[test]
fn a_manifest_without_its_picture_cannot_ask_for_memory() {
    let (folder, path, mut manifest) = exported([4, 5]);
    manifest["view"]["viewport"] = serde_json::json!([4096, 4096]);
    std::fs::write(&path, manifest.to_string()).unwrap();
    let message = verify(folder.path()).unwrap_err().to_string();
    holds(
        &message,
        &["view.viewport has 16777216 pixels, but tile.hex has"],
    );
}

/// A .pts file's first line is a count that nobody needs.
#[test]
fn a_claimed_count_of_points_is_not_believed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cloud.pts");
    std::fs::write(&path, b"1000000000000\n0 0 0\n").unwrap();
    let printed = points::load(&path).unwrap_err().to_string();
    assert!(printed.contains("only 1 of 1 are usable"), "{printed}");
}

/// Whatever is written goes through `atomic`, or is a file of a sweep: its table is cut back to its last
/// whole line when it is opened, and an identity without its end is written again.
#[test]
fn nothing_is_written_past_the_atomic_writer() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let exempt = ["atomic.rs", "explore/folder.rs"].map(|name| root.join(name));
    let mut sources = files_below(&root);
    sources.retain(|path| {
        let name = path.to_string_lossy();
        let is_test =
            name.ends_with("tests.rs") || path.components().any(|part| part.as_os_str() == "tests");
        name.ends_with(".rs") && !is_test && !exempt.contains(path)
    });
    assert!(sources.len() > 50, "{} files", sources.len());
    for path in sources {
        let text = std::fs::read_to_string(&path).unwrap();
        let code = text.split("#[cfg(test)]").next().unwrap_or_default();
        for writer in ["fs::write(", "File::create", "OpenOptions"] {
            assert!(!code.contains(writer), "{}: {writer}", path.display());
        }
    }
}
