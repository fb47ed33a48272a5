//! The benches of the co-simulation guide, built with Verilator and run. Without Verilator they say so and pass.

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

fn verilator_is_missing() -> bool {
    let missing = Command::new("verilator").arg("--version").output().is_err();
    if missing {
        eprintln!("skipped: Verilator is missing (apt-get install verilator)");
    }
    missing
}

fn run(command: &mut Command) -> String {
    let output = command.output().unwrap();
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{command:?}\n{text}{errors}");
    text
}

/// Compiles C sources into objects in `folder`.
fn objects(folder: &Path, sources: &[&str]) -> Vec<PathBuf> {
    std::fs::create_dir_all(folder).unwrap();
    let compile = |source: &&str| {
        let object = folder
            .join(Path::new(source).file_stem().unwrap())
            .with_extension("o");
        run(Command::new("cc")
            .args(["-std=c99", "-O1", "-Wall", "-Werror", "-c", "-I"])
            .arg(here("include"))
            .arg("-I")
            .arg(here("examples"))
            .arg(here(source))
            .arg("-o")
            .arg(&object));
        object
    };
    sources.iter().map(compile).collect()
}

/// Verilates `arguments` with the objects and the library, runs the result.
fn verilated(folder: &Path, objects: &[PathBuf], arguments: &[&str], top: &str) -> String {
    let include = |path: &str| format!("-I{}", here(path).display());
    let flags = format!("-O1 {} {}", include("include"), include("examples"));
    run(Command::new("verilator")
        .args(["--build", "-Wall", "-Wno-fatal", "-O3", "--Mdir"])
        .arg(folder)
        .args([
            "-CFLAGS",
            &flags,
            "-LDFLAGS",
            "-lpthread -ldl -lm",
            "--top-module",
            top,
        ])
        .args(arguments)
        .arg(here("cosim/run_lane.sv"))
        .args(objects)
        .arg(static_library()));
    run(&mut Command::new(folder.join(format!("V{top}"))))
}

#[test]
fn the_c_plus_plus_bench_finds_no_mismatch() {
    if verilator_is_missing() {
        return;
    }
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("cosim_cpp");
    let objects = objects(&folder, &["examples/picture.c"]);
    let bench = here("cosim/bench.cpp").display().to_string();
    let said = verilated(&folder, &objects, &["--cc", "--exe", &bench], "run_lane");
    assert!(said.contains("pixels, 0 mismatches"), "{said}");
    println!("{said}");
}

#[test]
fn the_dpi_bench_finds_no_mismatch() {
    if verilator_is_missing() {
        return;
    }
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("cosim_dpi");
    let objects = objects(&folder, &["examples/picture.c", "cosim/dpi_model.c"]);
    let bench = here("cosim/dpi_bench.sv").display().to_string();
    let said = verilated(&folder, &objects, &["--binary", &bench], "dpi_bench");
    assert!(said.contains("pixels, 0 mismatches"), "{said}");
    println!("{said}");
}
