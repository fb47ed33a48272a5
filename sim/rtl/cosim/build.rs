//! Verilates the splat primitive for both designs and both numbers of lanes and links it in.
//!
//! Without Verilator (`$VERILATOR`, or `verilator` on the path) the crate builds all the same; its co-simulation tests are then
//! ignored and its commands say why they cannot run.

#[path = "../../build_tools.rs"]
mod build_tools;
#[path = "src/verilator.rs"]
mod verilator;

use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};
use verilator::OPTIONS;

const DESIGNS: [&str; 2] = ["lean18", "standard24"];
const LANES: [u32; 2] = [1, 4];

fn main() {
    println!("cargo:rustc-check-cfg=cfg(has_rtl)");
    for variable in ["VERILATOR", "VERILATOR_ROOT", "PATH"] {
        println!("cargo:rerun-if-env-changed={variable}");
    }
    let here = PathBuf::from(env::var("CARGO_MANIFEST_DIR").expect("cargo sets it"));
    let rtl = here.parent().expect("the crate lies in sim/rtl").to_owned();
    for file in [
        "build.rs",
        "src/verilator.rs",
        "model.h",
        "shim.cpp",
        "runtime.cpp",
        "flat_primitive.sv",
        "../files.txt",
    ] {
        println!("cargo:rerun-if-changed={file}");
    }
    for file in sources(&rtl, "lean18")
        .iter()
        .chain(&sources(&rtl, "standard24"))
    {
        println!("cargo:rerun-if-changed={}", file.display());
    }
    let verilator = env::var("VERILATOR").unwrap_or_else(|_| "verilator".to_owned());
    build_tools::has_tool(&verilator);
    let Some(root) = root(&verilator) else {
        println!(
            "cargo:warning=verilator was not found: the RTL co-simulation tests will be ignored"
        );
        return;
    };
    let include = Path::new(&root).join("include");
    if compiler(&include).try_get_compiler().is_err() {
        build_tools::has_tool("c++");
        println!(
            "cargo:warning=there is no C++ compiler: the RTL co-simulation tests will be ignored"
        );
        return;
    }
    for design in DESIGNS {
        for lanes in LANES {
            build_model(&verilator, &include, &here, &rtl, design, lanes);
        }
    }
    compiler(&include)
        .file(include.join("verilated.cpp"))
        .file(include.join("verilated_threads.cpp"))
        .file(here.join("runtime.cpp"))
        .compile("verilated_runtime");
    println!("cargo:rustc-cfg=has_rtl");
}

/// Where Verilator keeps its run time; nothing if there is no Verilator.
fn root(verilator: &str) -> Option<String> {
    let output = Command::new(verilator)
        .args(["--getenv", "VERILATOR_ROOT"])
        .output()
        .ok()?;
    let root = String::from_utf8(output.stdout).ok()?.trim().to_owned();
    (output.status.success() && !root.is_empty()).then_some(root)
}

/// The design's package and the units, in the order of `files.txt`.
fn sources(rtl: &Path, design: &str) -> Vec<PathBuf> {
    let list =
        fs::read_to_string(rtl.join("files.txt")).expect("sim/rtl/files.txt lists the units");
    let units = list.lines().map(|line| rtl.join(line));
    [rtl.join(design).join("splatline_pkg.sv")]
        .into_iter()
        .chain(units)
        .collect()
}

fn build_model(verilator: &str, include: &Path, here: &Path, rtl: &Path, design: &str, lanes: u32) {
    let name = format!("{design}_{lanes}");
    let out = PathBuf::from(env::var("OUT_DIR").expect("cargo sets it"));
    let folder = out.join(&name);
    let _ = fs::remove_dir_all(&folder);
    let output = Command::new(verilator)
        .args(OPTIONS)
        .args(["-Wall", "-Wno-UNUSED"])
        .args([
            "--prefix",
            &format!("V{name}"),
            "--top-module",
            "flat_primitive",
            "--Mdir",
        ])
        .arg(&folder)
        .arg(format!("-GLANES={lanes}"))
        .args(sources(rtl, design))
        .arg(here.join("flat_primitive.sv"))
        .output()
        .expect("verilator has just answered");
    let complaint = String::from_utf8_lossy(&output.stderr);
    assert!(
        output.status.success(),
        "verilator rejects {name}:\n{complaint}"
    );
    // One translation unit: the generated files and the shim.
    let mut unity = String::new();
    for file in fs::read_dir(&folder)
        .expect("verilator has written it")
        .flatten()
    {
        let path = file.path();
        if path.extension().is_some_and(|extension| extension == "cpp") {
            unity += &format!("#include \"{}\"\n", path.display());
        }
    }
    unity += &format!("#include \"{}\"\n", here.join("shim.cpp").display());
    let file = out.join(format!("{name}.cpp"));
    fs::write(&file, unity).expect("OUT_DIR is writable");
    compiler(include)
        .include(&folder)
        .define("MODEL", format!("V{name}").as_str())
        .define("NAME", name.as_str())
        .file(file)
        .compile(&format!("splatline_{name}"));
}

fn compiler(include: &Path) -> cc::Build {
    let mut build = cc::Build::new();
    build
        .cpp(true)
        .std("c++17")
        // What simulates fastest: docs/rtl.md, "Speed".
        .opt_level(3)
        .flag_if_supported("-march=native")
        .debug(false)
        .warnings(false);
    build.include(include).include(include.join("vltstd"));
    build
}
