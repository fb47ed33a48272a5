//! The linker scripts are those of the images next door.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rustc-link-search={}/..", env!("CARGO_MANIFEST_DIR"));
}
