//! The linker script of a board lies beside its Cargo.toml.

fn main() {
    println!("cargo::rerun-if-changed=memory.x");
    let board = std::env::var("CARGO_MANIFEST_DIR").unwrap_or_default();
    println!("cargo::rustc-link-search={board}");
}
