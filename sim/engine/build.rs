//! Tells the tests whether the data are there that some of them need: without them these tests are ignored and say so.

use std::path::Path;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    // No trigger for data that come later: Cargo would rebuild everything each time while they are missing.
    println!("cargo::rerun-if-env-changed=SPLATLINE_LOOK_AGAIN");
    println!("cargo::rustc-check-cfg=cfg(has_data)");
    if Path::new("../../../shared/data").is_dir() {
        println!("cargo::rustc-cfg=has_data");
    }
}
