//! Tells the tests whether the shared data are there that some of them need.

#[path = "../build_tools.rs"]
mod build_tools;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-env-changed=SPLATLINE_LOOK_AGAIN");
    build_tools::cfg(
        "has_data",
        std::path::Path::new("../../../shared/data").is_dir(),
    );
}
