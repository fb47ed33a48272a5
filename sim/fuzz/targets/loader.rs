//! The loaders read files, so the bytes become one.

use splatline_sim::scene;

/// Loads `bytes` as a scene file of the given extension; the outcome does not matter.
pub fn load(bytes: &[u8], extension: &str) {
    let path = std::env::temp_dir().join(format!("splatline-fuzz-{}.{extension}", std::process::id()));
    if std::fs::write(&path, bytes).is_ok() {
        let _ = scene::load(&path, &scene::LoadOptions::default());
    }
}
