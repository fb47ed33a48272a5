//! Circuits: which unit, of which design, with which parameters. Every tool reads the sources that a circuit names here; for simulation they are verilated and
//! compiled into a shared library.
//!
//! Libraries are kept in the build folder under a hash of all that they are made of, so that an unchanged circuit is built once.

use crate::mutation::{Mutation, with_choices};
use crate::package;
use crate::setup::program::{ProgramKind, SetupProgram};
use crate::setup::text;
use crate::tools::{rtl, run};
use anyhow::{Context, Result};
use splatline::format::{Lean18, Standard24, Widths};
use splatline_sim::machine::area::synthesis::subjects;
use std::collections::hash_map::DefaultHasher;
use std::ffi::OsStr;
use std::fmt;
use std::fs::{self, File};
use std::hash::{Hash, Hasher};
use std::path::{Path, PathBuf};
use std::process::Command;

/// The designs that packages are committed of.
pub const DESIGNS: [(&str, Widths); 2] = [
    ("lean18", Lean18::WIDTHS),
    ("standard24", Standard24::WIDTHS),
];

/// A unit of `sim/rtl`.
#[derive(Debug, PartialEq, Eq)]
pub struct RtlUnit {
    /// The module at its top.
    pub top: &'static str,
    /// The list of its files.
    pub list: &'static str,
    /// What is simulated instead: the unit with a C integer for each port.
    flat: Option<&'static str>,
    packages: Packages,
    /// The parameter that tells its circuits apart.
    pub parameter: &'static str,
}

/// The packages that a unit is read with.
#[derive(Debug, PartialEq, Eq)]
enum Packages {
    None,
    Widths,
    WidthsAndProgram,
}

/// The splat primitive.
pub const PRIMITIVE: RtlUnit = RtlUnit {
    top: "splat_primitive",
    list: "files.txt",
    flat: Some("flat_primitive"),
    packages: Packages::Widths,
    parameter: "LANES",
};

/// The setup unit.
pub const SETUP: RtlUnit = RtlUnit {
    top: "setup_unit",
    list: "setup_files.txt",
    flat: None,
    packages: Packages::WidthsAndProgram,
    parameter: "CORES",
};

/// Sorter and binning.
pub const ORDER: RtlUnit = RtlUnit {
    top: "splat_order",
    list: "order_files.txt",
    flat: None,
    packages: Packages::None,
    parameter: "DIGIT",
};

/// The harmonics unit.
pub const HARMONICS: RtlUnit = RtlUnit {
    top: "harmonics_unit",
    list: "harmonics_files.txt",
    flat: None,
    packages: Packages::None,
    parameter: "MULTIPLIERS",
};

/// The whole machine.
pub const MACHINE: RtlUnit = RtlUnit {
    top: "splat_machine",
    list: "machine_files.txt",
    flat: Some("flat_machine"),
    packages: Packages::WidthsAndProgram,
    parameter: "LANES",
};

/// A circuit.
#[derive(Clone)]
pub struct Circuit {
    /// Of this unit.
    pub unit: &'static RtlUnit,
    /// Name of its design, for its packages.
    pub design: String,
    /// The design's widths.
    pub widths: Widths,
    /// What its cores of setup compute, if it has any.
    pub program: SetupProgram,
    /// Parameters of the module at the top.
    pub parameters: Vec<(&'static str, u32)>,
}

/// A file's name and text.
pub type Source = (String, String);

impl Circuit {
    /// The unit of a design of `rtl -- area`, with its parameter.
    pub fn new(unit: &'static RtlUnit, design: &str, value: u32) -> Result<Circuit> {
        let mut subjects = subjects().into_iter();
        let subject = subjects.find(|subject| subject.name == design);
        let subject = subject.with_context(|| format!("no such design: {design}"))?;
        Ok(Circuit {
            unit,
            design: design.to_owned(),
            widths: subject.widths,
            program: SetupProgram::new(ProgramKind::Filter),
            parameters: vec![(unit.parameter, value)],
        })
    }

    /// The same with another parameter.
    pub fn with(mut self, parameter: &'static str, value: u32) -> Circuit {
        self.parameters.push((parameter, value));
        self
    }

    /// The same with another program in its cores.
    pub fn with_program(mut self, program: SetupProgram) -> Circuit {
        self.program = program;
        self
    }

    /// Its packages and files, in the order in which they are read.
    pub fn sources(&self) -> Result<Vec<Source>> {
        let mut sources = Vec::new();
        if self.unit.packages != Packages::None {
            let text = package::text(&self.design, &self.widths)?;
            sources.push(("splatline_pkg.sv".to_owned(), text));
        }
        if self.unit.packages == Packages::WidthsAndProgram {
            let text = text::text(&self.design, &self.widths, &self.program)?;
            sources.push(("splatline_setup_pkg.sv".to_owned(), text));
        }
        for file in fs::read_to_string(rtl().join(self.unit.list))?.lines() {
            sources.push((file.to_owned(), fs::read_to_string(rtl().join(file))?));
        }
        Ok(sources)
    }

    /// Yosys' words for reading it, with its files in this folder.
    pub fn read_command(&self, folder: &Path) -> Result<String> {
        let mut command = "read_verilog -sv".to_owned();
        for path in write(folder, &self.sources()?)? {
            command += &format!(" {}", path.display());
        }
        Ok(command)
    }

    /// The circuit without a mutation as a library for [`Simulation`](crate::simulation::Simulation).
    pub fn library(&self, effort: Effort) -> Result<PathBuf> {
        self.verilated(self.sources()?, effort)
    }

    /// The circuit with this mutation.
    pub fn mutated(&self, mutation: &Mutation) -> Result<PathBuf> {
        let mut sources = self.sources()?;
        for (name, text) in &mut sources {
            if *name == mutation.file {
                *text = mutation.applied(text)?;
            }
        }
        self.verilated(sources, Effort::Little)
    }

    /// The circuit with all of these mutations that one circuit can hold.
    pub fn with_choices(&self, mutations: &[Mutation]) -> Result<PathBuf> {
        self.verilated(
            with_choices(self.sources()?, mutations)?.sources,
            Effort::Little,
        )
    }

    fn verilated(&self, mut sources: Vec<Source>, effort: Effort) -> Result<PathBuf> {
        let top = self.unit.flat.unwrap_or(self.unit.top);
        if self.unit.flat.is_some() {
            let file = format!("{top}.sv");
            let text = fs::read_to_string(rtl().join("cosim").join(&file))?;
            sources.push((file, text));
        }
        let verilator = std::env::var("VERILATOR").unwrap_or_else(|_| "verilator".to_owned());
        let version = run(Command::new(&verilator).arg("--version"))?;
        let mut hash = DefaultHasher::new();
        (&version, &sources, &self.parameters, OPTIONS, effort.flag()).hash(&mut hash);
        SHIM.hash(&mut hash);
        let kept = Path::new(env!("OUT_DIR")).join("circuits");
        fs::create_dir_all(&kept)?;
        let library = kept.join(format!("{top}_{:016x}.so", hash.finish()));
        // Another thread or process may be building it.
        let lock = File::create(library.with_extension("lock"))?;
        lock.lock()?;
        if !library.exists() {
            let folder = tempfile::tempdir_in(&kept)?;
            let built = self.build(folder.path(), &verilator, &sources, effort)?;
            fs::rename(built, &library)?;
        }
        Ok(library)
    }

    fn build(
        &self,
        folder: &Path,
        verilator: &str,
        sources: &[Source],
        effort: Effort,
    ) -> Result<PathBuf> {
        let root = run(Command::new(verilator).args(["--getenv", "VERILATOR_ROOT"]))?;
        let include = Path::new(root.trim()).join("include");
        let model = folder.join("model");
        let top = self.unit.flat.unwrap_or(self.unit.top);
        let parameters = self.parameters.iter();
        run(Command::new(verilator)
            .args(OPTIONS)
            .args(["--prefix", "Circuit", "--top-module", top])
            .args(parameters.map(|(name, value)| format!("-G{name}={value}")))
            .args([OsStr::new("--Mdir"), model.as_os_str()])
            .args(write(folder, sources)?))?;
        let header = fs::read_to_string(model.join("Circuit.h"))?;
        fs::write(model.join("ports.h"), ports(&header))?;
        let mut unity = String::new();
        for file in fs::read_dir(&model)?.flatten() {
            let path = file.path();
            if path.extension().is_some_and(|extension| extension == "cpp") {
                unity += &format!("#include \"{}\"\n", path.display());
            }
        }
        fs::write(folder.join("circuit.cpp"), unity + SHIM)?;
        let library = folder.join("circuit.so");
        let compiler = std::env::var("CXX").unwrap_or_else(|_| "c++".to_owned());
        run(Command::new(compiler)
            .args(["-std=c++17", effort.flag(), "-w", "-shared", "-fPIC", "-I"])
            .args([model.as_os_str(), OsStr::new("-I"), include.as_os_str()])
            .args([OsStr::new("-I"), include.join("vltstd").as_os_str()])
            .arg(folder.join("circuit.cpp"))
            .args(["verilated.cpp", "verilated_threads.cpp"].map(|file| include.join(file)))
            .args([OsStr::new("-o"), library.as_os_str()]))?;
        Ok(library)
    }
}

impl fmt::Display for Circuit {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        if self.unit.packages != Packages::None {
            write!(formatter, "{} ", self.design)?;
        }
        write!(formatter, "{}", self.unit.top)?;
        for (name, value) in &self.parameters {
            write!(formatter, " {name}={value}")?;
        }
        Ok(())
    }
}

/// The C++ compiler's effort.
#[derive(Clone, Copy, Debug)]
pub enum Effort {
    /// Where building takes longer than running.
    Little,
    /// For millions of splats.
    Much,
}

impl Effort {
    fn flag(self) -> &'static str {
        match self {
            Effort::Little => "-O1",
            Effort::Much => "-O2",
        }
    }
}

/// Verilator's options for every circuit: what a register holds before reset is drawn by lot.
const OPTIONS: [&str; 6] = [
    "--cc",
    "-O3",
    "--x-assign",
    "unique",
    "--x-initial",
    "unique",
];

/// The functions between circuit and program.
const SHIM: &str = include_str!("../shim.cpp");

/// Writes files into a folder.
fn write(folder: &Path, sources: &[Source]) -> Result<Vec<PathBuf>> {
    let mut paths = Vec::new();
    for (name, text) in sources {
        let path = folder.join(name);
        fs::write(&path, text)?;
        paths.push(path);
    }
    Ok(paths)
}

/// The ports of Verilator's class, as the shim lists them. In its header `VL_INW(&record,607,0,19);` is an input of 608 bits.
fn ports(header: &str) -> String {
    let mut text = String::new();
    for line in header.lines() {
        let Some((kind, port)) = line.trim().split_once("(&") else {
            continue;
        };
        let is_input = kind.starts_with("VL_IN");
        let mut words = port.split(',');
        if let (Some(name), Some(high)) = (words.next(), words.next())
            && (is_input || kind.starts_with("VL_OUT"))
        {
            text += &format!("{{\"{name}\", &model.{name}, {high} + 1, {is_input}}},\n");
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ports_are_read_from_the_header() {
        let header = "class Circuit {\n    VL_IN8(&clk,0,0);\n    VL_OUTW(&packet,647,0,21);\n    CData x;\n";
        let expected =
            "{\"clk\", &model.clk, 0 + 1, true},\n{\"packet\", &model.packet, 647 + 1, false},\n";
        assert_eq!(ports(header), expected);
    }
}
