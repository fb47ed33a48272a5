//! Is there a browser? Without one the tests are ignored, with its name as the reason.

#[path = "../build_tools.rs"]
mod build_tools;

fn main() {
    for file in ["build.rs", "../build_tools.rs"] {
        println!("cargo::rerun-if-changed={file}");
    }
    build_tools::cfg("has_chromium", build_tools::has_tool("chromium"));
}
