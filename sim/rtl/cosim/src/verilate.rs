//! From SystemVerilog to a shared library, while the program runs: sources with at most one mistake in a folder, Verilator, the C++ compiler.

use crate::area::rtl;
use crate::mutants::{Mutant, run};
use crate::verilator::OPTIONS;
use anyhow::Result;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

/// What becomes of the sources.
pub struct VerilatorTarget<'a> {
    /// The unit at the top.
    pub top: &'a str,
    /// Its parameters, as `NAME=value`.
    pub parameters: &'a [String],
    /// Verilator's prefix, under which the shim knows the model.
    pub prefix: &'a str,
    /// C++ files of `sim/rtl/cosim` between model and program.
    pub shims: &'a [&'a str],
    /// Definitions for them beside `MODEL`.
    pub definitions: &'a [&'a str],
    /// The C++ compiler's effort: little where building takes longer than running.
    pub effort: &'a str,
}

/// The units that a list in `sim/rtl` names, with their texts.
pub fn units(list: &str) -> Result<Vec<(String, String)>> {
    fs::read_to_string(rtl().join(list))?
        .lines()
        .map(|unit| Ok((unit.to_owned(), fs::read_to_string(rtl().join(unit))?)))
        .collect()
}

/// Writes the files into a folder, with the mistake in its place.
pub fn write(
    folder: &Path,
    files: Vec<(String, String)>,
    mistake: Option<&Mutant>,
) -> Result<Vec<PathBuf>> {
    let mut paths = Vec::new();
    for (name, mut text) in files {
        if let Some(mistake) = mistake.filter(|mistake| mistake.file == name) {
            text = mistake.applied(&text)?;
        }
        let path = folder.join(name);
        fs::write(&path, text)?;
        paths.push(path);
    }
    Ok(paths)
}

/// Builds a shared library in a folder.
pub fn library(folder: &Path, sources: &[PathBuf], target: &VerilatorTarget) -> Result<PathBuf> {
    let verilator = env::var("VERILATOR").unwrap_or_else(|_| "verilator".to_owned());
    let root = run(Command::new(&verilator).args(["--getenv", "VERILATOR_ROOT"]))?;
    let include = Path::new(root.trim()).join("include");
    let model = folder.join("model");
    run(Command::new(&verilator)
        .args(OPTIONS)
        .args(["--prefix", target.prefix, "--top-module", target.top])
        .args(target.parameters.iter().map(|given| format!("-G{given}")))
        .args([OsStr::new("--Mdir"), model.as_os_str()])
        .args(sources))?;
    compile(folder, &model, &include, target)
}

fn compile(
    folder: &Path,
    model: &Path,
    include: &Path,
    target: &VerilatorTarget,
) -> Result<PathBuf> {
    let library = folder.join(format!("{}.so", target.prefix));
    let generated = fs::read_dir(model)?.flatten().map(|file| file.path());
    let generated = generated.filter(|path| path.extension().is_some_and(|kind| kind == "cpp"));
    let compiler = env::var("CXX").unwrap_or_else(|_| "c++".to_owned());
    run(Command::new(compiler)
        .args(["-std=c++17", target.effort, "-w", "-shared", "-fPIC"])
        .arg(format!("-DMODEL={}", target.prefix))
        .args(target.definitions.iter().map(|given| format!("-D{given}")))
        .args([OsStr::new("-I"), model.as_os_str()])
        .args([OsStr::new("-I"), include.as_os_str()])
        .args([OsStr::new("-I"), include.join("vltstd").as_os_str()])
        .args(generated)
        .args([
            include.join("verilated.cpp"),
            include.join("verilated_threads.cpp"),
        ])
        .args(
            target
                .shims
                .iter()
                .map(|shim| rtl().join("cosim").join(shim)),
        )
        .args([OsStr::new("-o"), library.as_os_str()]))?;
    Ok(library)
}
