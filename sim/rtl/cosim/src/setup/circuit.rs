//! Setup units that are built while the program runs: of any design, with any number of cores, or with one mistake in them.

use super::assemble::Program;
use super::program::program;
use super::text::with_program;
use crate::area::rtl;
use crate::mutants::{Mutant, run};
use crate::package;
use anyhow::{Result, ensure};
use splatline::format::Widths;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

/// What is built.
#[derive(Clone, Copy)]
pub struct Spec<'a> {
    /// Name of the design, for its packages.
    pub design: &'a str,
    /// Its widths.
    pub widths: &'a Widths,
    /// What the cores compute.
    pub program: fn(&Widths) -> Result<Program>,
    /// Cores.
    pub cores: usize,
    /// A mistake.
    pub mistake: Option<&'a Mutant>,
    /// The C++ compiler's effort: little where building takes longer than running.
    pub effort: &'a str,
}

impl<'a> Spec<'a> {
    /// The unit as it is.
    pub fn new(design: &'a str, widths: &'a Widths, cores: usize) -> Spec<'a> {
        Spec {
            design,
            widths,
            program,
            cores,
            mistake: None,
            effort: "-O1",
        }
    }
}

/// Builds the unit as a shared library in a folder.
pub fn library(folder: &Path, spec: &Spec) -> Result<PathBuf> {
    let sources = sources(folder, spec)?;
    let verilator = env::var("VERILATOR").unwrap_or_else(|_| "verilator".to_owned());
    let root = run(Command::new(&verilator).args(["--getenv", "VERILATOR_ROOT"]))?;
    let include = Path::new(root.trim()).join("include");
    let model = folder.join("model");
    run(Command::new(&verilator)
        .args([
            "--cc",
            "-O3",
            "--x-assign",
            "unique",
            "--x-initial",
            "unique",
        ])
        .args(["--prefix", "Vsetup", "--top-module", "setup_unit"])
        .arg(format!("-GCORES={}", spec.cores))
        .args([OsStr::new("--Mdir"), model.as_os_str()])
        .args(sources))?;
    compile(folder, &model, &include, spec.effort)
}

/// Packages and units in a folder, with the mistake in its place.
fn sources(folder: &Path, spec: &Spec) -> Result<Vec<PathBuf>> {
    let Spec { design, widths, .. } = *spec;
    let setup = with_program(design, widths, spec.program)?;
    let mut files = vec![
        (
            "splatline_pkg.sv".to_owned(),
            package::text(design, widths)?,
        ),
        ("splatline_setup_pkg.sv".to_owned(), setup),
    ];
    for unit in fs::read_to_string(rtl().join("setup_files.txt"))?.lines() {
        files.push((unit.to_owned(), fs::read_to_string(rtl().join(unit))?));
    }
    let mut paths = Vec::new();
    for (name, mut text) in files {
        if let Some(mistake) = spec.mistake.filter(|mistake| mistake.file == name) {
            let places = text.matches(mistake.from).count();
            ensure!(
                places == 1,
                "{name}: '{}' occurs {places} times, not once; adapt the mutant",
                mistake.from
            );
            text = text.replace(mistake.from, mistake.to);
        }
        let path = folder.join(name);
        fs::write(&path, text)?;
        paths.push(path);
    }
    Ok(paths)
}

fn compile(folder: &Path, model: &Path, include: &Path, effort: &str) -> Result<PathBuf> {
    let library = folder.join("setup.so");
    let generated = fs::read_dir(model)?.flatten().map(|file| file.path());
    let generated = generated.filter(|path| path.extension().is_some_and(|kind| kind == "cpp"));
    let compiler = env::var("CXX").unwrap_or_else(|_| "c++".to_owned());
    run(Command::new(compiler)
        .args([
            "-std=c++17",
            effort,
            "-w",
            "-shared",
            "-fPIC",
            "-DMODEL=Vsetup",
        ])
        .args([OsStr::new("-I"), model.as_os_str()])
        .args([OsStr::new("-I"), include.as_os_str()])
        .args([OsStr::new("-I"), include.join("vltstd").as_os_str()])
        .args(generated)
        .args([
            include.join("verilated.cpp"),
            include.join("verilated_threads.cpp"),
        ])
        .args([rtl().join("cosim/setup_shim.cpp")])
        .args([OsStr::new("-o"), library.as_os_str()]))?;
    Ok(library)
}
