//! The benches of the co-simulation guide, built with Verilator and run. Without Verilator they are ignored.

use std::path::{Path, PathBuf};
use std::process::Command;

fn here(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// Cargo leaves the static library beside this test.
fn static_library() -> PathBuf {
    std::env::current_exe()
        .unwrap()
        .with_file_name("libsplatline_capi.a")
}

fn run(command: &mut Command) -> String {
    let output = command.output().unwrap();
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{command:?}\n{text}{errors}");
    text
}

/// Where our own headers lie, as options of a compiler.
fn includes() -> [String; 3] {
    ["include", "examples", "cosim"].map(|path| format!("-I{}", here(path).display()))
}

/// Where Verilator keeps its headers.
fn verilator_include() -> PathBuf {
    let root = run(Command::new("verilator").args(["--getenv", "VERILATOR_ROOT"]));
    Path::new(root.trim()).join("include")
}

/// The primitive of a design: its package, then the units in their order.
fn primitive(design: &str) -> Vec<PathBuf> {
    let rtl = here("../rtl");
    let units = std::fs::read_to_string(rtl.join("files.txt")).unwrap();
    let package = rtl.join(design).join("splatline_pkg.sv");
    std::iter::once(package)
        .chain(units.lines().map(|unit| rtl.join(unit)))
        .collect()
}

/// Compiles C sources into objects in `folder`.
fn objects(folder: &Path, sources: &[&str]) -> Vec<PathBuf> {
    std::fs::create_dir_all(folder).unwrap();
    let svdpi = verilator_include().join("vltstd");
    let compile = |source: &&str| {
        let object = folder
            .join(Path::new(source).file_stem().unwrap())
            .with_extension("o");
        run(Command::new("cc")
            .args(["-std=c99", "-O1", "-Wall", "-Werror", "-c"])
            .args(includes())
            .arg(format!("-I{}", svdpi.display()))
            .args([here(source), "-o".into(), object.clone()]));
        object
    };
    sources.iter().map(compile).collect()
}

/// Verilates the primitive of standard24 and `arguments` with the objects and the library, runs the result.
fn verilated(folder: &Path, objects: &[PathBuf], arguments: &[&str], top: &str) -> String {
    let flags = format!("-O1 {}", includes().join(" "));
    run(Command::new("verilator")
        .args(["--build", "-O3", "--Mdir"])
        .arg(folder)
        .args([
            "-CFLAGS",
            &flags,
            "-LDFLAGS",
            "-lpthread -ldl -lm",
            "--top-module",
            top,
        ])
        .args(primitive("standard24"))
        .args(arguments)
        .args(objects)
        .arg(static_library()));
    run(&mut Command::new(folder.join(format!("V{top}"))))
}

#[test]
#[cfg_attr(
    not(has_verilator),
    ignore = "Verilator is missing: apt-get install verilator"
)]
fn the_c_plus_plus_bench_finds_no_mismatch() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("cosim_cpp");
    let objects = objects(&folder, &["examples/picture.c", "cosim/tiles.c"]);
    let bench = here("cosim/bench.cpp").display().to_string();
    let top = here("../rtl/cosim/flat_primitive.sv").display().to_string();
    let arguments = ["-GLANES=4", "--cc", "--exe", &top, &bench];
    let said = verilated(&folder, &objects, &arguments, "flat_primitive");
    assert!(said.contains("pixels, 0 mismatches"), "{said}");
    println!("{said}");
}

#[test]
#[cfg_attr(
    not(has_verilator),
    ignore = "Verilator is missing: apt-get install verilator"
)]
fn the_dpi_bench_finds_no_mismatch() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("cosim_dpi");
    let sources = ["examples/picture.c", "cosim/tiles.c", "cosim/dpi_model.c"];
    let objects = objects(&folder, &sources);
    let bench = here("cosim/dpi_bench.sv").display().to_string();
    let said = verilated(&folder, &objects, &["--binary", &bench], "dpi_bench");
    assert!(said.contains("pixels, 0 mismatches"), "{said}");
    println!("{said}");
}
