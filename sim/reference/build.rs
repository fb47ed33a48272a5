//! Tells the tests whether the shared data are there that some of them need; without them these tests are ignored and
//! say so.

use std::path::Path;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    // No trigger for data that come later: Cargo would rebuild everything each time while they are missing.
    println!("cargo::rerun-if-env-changed=SPLATLINE_LOOK_AGAIN");
    let data = Path::new("../../../shared/data");
    for (name, folder) in [("has_data", data), ("has_formats", &data.join("formats"))] {
        println!("cargo::rustc-check-cfg=cfg({name})");
        if folder.is_dir() {
            println!("cargo::rustc-cfg={name}");
        }
    }
}
