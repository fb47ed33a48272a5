//! Digests the sources, so that a sweep knows which program its results are of: the version's number alone stays the
//! same over many changes. Also tells the tests whether the shared data and the tools are there that some of them need.

mod build_tools;
#[path = "src/digest.rs"]
#[allow(dead_code)]
mod digest;

use std::path::{Path, PathBuf};

/// What the program is made of: the kernel, this crate, and the versions of what both depend on.
const PARTS: [&str; 11] = [
    "../src",
    "../Cargo.toml",
    "../Cargo.lock",
    "reference/src",
    "reference/Cargo.toml",
    "engine/src",
    "engine/Cargo.toml",
    "machine/src",
    "machine/Cargo.toml",
    "src",
    "Cargo.toml",
];

fn main() {
    for file in ["build.rs", "build_tools.rs"] {
        println!("cargo::rerun-if-changed={file}");
    }
    // No trigger for data that come later: Cargo would rebuild everything each time while they are missing.
    println!("cargo::rerun-if-env-changed=SPLATLINE_LOOK_AGAIN");
    build_tools::cfg("has_data", Path::new("../../shared/data").is_dir());
    build_tools::cfg(
        "has_formats",
        Path::new("../../shared/data/formats").is_dir(),
    );
    build_tools::cfg("has_iverilog", build_tools::has_tool("iverilog"));
    let root = PathBuf::from(std::env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default());
    let mut digest = digest::Digest::default();
    for part in PARTS {
        println!("cargo::rerun-if-changed={part}");
        let mut files = Vec::new();
        collect(&root.join(part), &mut files);
        files.sort();
        for file in files {
            // The name below the crate's folder: where the sources lie must not matter.
            let name = file.strip_prefix(&root).unwrap_or(&file);
            digest.piece(name.to_string_lossy().as_bytes());
            digest.piece(&std::fs::read(&file).unwrap_or_default());
        }
    }
    println!("cargo::rustc-env=SPLATLINE_SOURCES={}", digest.finish());
}

fn collect(path: &Path, files: &mut Vec<PathBuf>) {
    match std::fs::read_dir(path) {
        Ok(entries) => entries
            .flatten()
            .for_each(|entry| collect(&entry.path(), files)),
        Err(_) => files.push(path.to_owned()),
    }
}
