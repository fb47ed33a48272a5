//! Tells the tests which compilers there are: without one its tests are ignored, never passed.

#[path = "../build_tools.rs"]
mod build_tools;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-env-changed=CC");
    let compiler = std::env::var("CC").unwrap_or_else(|_| "cc".to_owned());
    build_tools::cfg("has_cc", build_tools::has_tool(&compiler));
    build_tools::cfg("has_verilator", build_tools::has_tool("verilator"));
}
