//! Looks whether circuits can be simulated here. They are built when something asks for them (src/circuit.rs).
//!
//! Without Verilator (`$VERILATOR`, or `verilator` on the path) or a C++ compiler the co-simulation tests are ignored.

#[path = "../../build_tools.rs"]
mod build_tools;

use build_tools::{cfg, has_tool};

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    for variable in ["VERILATOR", "CXX"] {
        println!("cargo:rerun-if-env-changed={variable}");
    }
    let tool = |variable, usual: &str| {
        has_tool(&std::env::var(variable).unwrap_or_else(|_| usual.to_owned()))
    };
    let (verilator, compiler) = (tool("VERILATOR", "verilator"), tool("CXX", "c++"));
    if !(verilator && compiler) {
        println!("cargo:warning=verilator or c++ was not found: co-simulation tests are ignored");
    }
    cfg("has_rtl", verilator && compiler);
}
