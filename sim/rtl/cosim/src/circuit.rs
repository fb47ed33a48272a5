//! Circuits that are built while the program runs: of any design, with any number of lanes, or with one mistake in them. Those that every test
//! draws with are linked in (`build.rs`).

use crate::area::rtl;
use crate::mutants::{Mutant, run};
use crate::package;
use anyhow::{Result, ensure};
use splatline::format::Widths;
use splatline_sim::machine::primitive::SETUP_INTERVAL;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

/// The name under which the library offers the circuit's functions.
pub const NAME: &str = "built";

/// What is built.
#[derive(Clone, Copy, Debug)]
pub struct Spec<'a> {
    /// Name of the design, for its package.
    pub design: &'a str,
    /// Its widths.
    pub widths: &'a Widths,
    /// Lanes.
    pub lanes: usize,
    /// Cycles between two packets.
    pub setup_interval: u32,
    /// A mistake.
    pub mistake: Option<&'a Mutant>,
    /// The C++ compiler's effort: little where building takes longer than running.
    pub effort: &'a str,
}

impl<'a> Spec<'a> {
    /// The circuit as it usually is.
    pub fn new(design: &'a str, widths: &'a Widths, lanes: usize) -> Spec<'a> {
        Spec {
            design,
            widths,
            lanes,
            setup_interval: SETUP_INTERVAL,
            mistake: None,
            effort: "-O0",
        }
    }

    /// Builds it as a shared library in a folder.
    pub fn library(&self, folder: &Path) -> Result<PathBuf> {
        let sources = self.sources(folder)?;
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
            .args(["--prefix", "Vbuilt", "--top-module", "flat_primitive"])
            .arg(format!("-GLANES={}", self.lanes))
            .arg(format!("-GSETUP_INTERVAL={}", self.setup_interval))
            .args([OsStr::new("--Mdir"), model.as_os_str()])
            .args(sources))?;
        self.compile(folder, &model, &include)
    }

    /// The package and the units, with the mistake in its place.
    fn sources(&self, folder: &Path) -> Result<Vec<PathBuf>> {
        let package = folder.join("splatline_pkg.sv");
        fs::write(&package, package::text(self.design, self.widths)?)?;
        let mut sources = vec![package];
        for unit in fs::read_to_string(rtl().join("files.txt"))?.lines() {
            let mut text = fs::read_to_string(rtl().join(unit))?;
            if let Some(mistake) = self.mistake.filter(|mistake| mistake.file == unit) {
                let places = text.matches(mistake.from).count();
                ensure!(
                    places == 1,
                    "{unit}: '{}' occurs {places} times, not once; adapt the mutant",
                    mistake.from
                );
                text = text.replace(mistake.from, mistake.to);
            }
            let path = folder.join(unit);
            fs::write(&path, text)?;
            sources.push(path);
        }
        sources.push(rtl().join("cosim/flat_primitive.sv"));
        Ok(sources)
    }

    fn compile(&self, folder: &Path, model: &Path, include: &Path) -> Result<PathBuf> {
        let cosim = rtl().join("cosim");
        let library = folder.join("built.so");
        let generated = fs::read_dir(model)?.flatten().map(|file| file.path());
        let generated = generated.filter(|path| path.extension().is_some_and(|kind| kind == "cpp"));
        let compiler = env::var("CXX").unwrap_or_else(|_| "c++".to_owned());
        let vltstd = include.join("vltstd");
        run(Command::new(compiler)
            .args(["-std=c++17", self.effort, "-w", "-shared", "-fPIC"])
            .args(["-DMODEL=Vbuilt", "-DNAME=built"])
            .args(["-I".as_ref(), model.as_os_str()])
            .args(["-I".as_ref(), include.as_os_str()])
            .args(["-I".as_ref(), vltstd.as_os_str()])
            .args(generated)
            .args([
                include.join("verilated.cpp"),
                include.join("verilated_threads.cpp"),
            ])
            .args([cosim.join("shim.cpp"), cosim.join("runtime.cpp")])
            .args([OsStr::new("-o"), library.as_os_str()]))?;
        Ok(library)
    }
}
