//! The loaders read files, so the bytes become one.

use splatline_sim::scene::{self, points};
use std::path::PathBuf;

fn file(bytes: &[u8], extension: &str) -> PathBuf {
    let name = format!("splatline-fuzz-{}.{extension}", std::process::id());
    let path = std::env::temp_dir().join(name);
    std::fs::write(&path, bytes).expect("the folder for temporary files is writable");
    path
}

/// Loads `bytes` as a scene file of the given extension; the outcome does not matter.
#[allow(dead_code)] // Each target uses one of the three.
pub fn load(bytes: &[u8], extension: &str) {
    let _ = scene::load(&file(bytes, extension), &scene::LoadOptions::default());
}

/// Loads `bytes` as a point cloud.
#[allow(dead_code)]
pub fn load_points(bytes: &[u8], extension: &str) {
    let _ = points::load(&file(bytes, extension));
}

/// Loads `bytes` as a height field.
#[allow(dead_code)]
pub fn load_height_field(bytes: &[u8]) {
    let _ = points::height_field::HeightField::load(
        &file(bytes, "csv"),
        points::height_field::USUAL_SPACING,
    );
}
