//! The linker scripts of this folder: boards with 256 KiB of RAM.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rustc-link-search={}", env!("CARGO_MANIFEST_DIR"));
    println!("cargo::rustc-link-search={}/..", env!("CARGO_MANIFEST_DIR"));
}
