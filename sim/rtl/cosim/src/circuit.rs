//! Circuits: which unit, of which design, with which parameters. Every tool reads the sources that a circuit names
//! here; for simulation they are verilated and compiled into a shared library.
//!
//! Libraries are kept in the build folder under a hash of all that they are made of, so that an unchanged circuit is
//! built once.

use crate::mutation::{Mutation, MutationNumber, with_choices};
use crate::package;
use crate::setup::program::{self, ProgramKind, SetupProgram};
use crate::setup::text;
use crate::tools::{rtl, run, tool};
use crate::unit::Extent;
use anyhow::{Context, Result};
use splatline_sim::design::DesignChoice;
use splatline_sim::machine::area::synthesis::subjects;
use std::collections::hash_map::DefaultHasher;
use std::ffi::OsStr;
use std::fmt;
use std::fs::{self, File};
use std::hash::{Hash, Hasher};
use std::path::{Path, PathBuf};
use std::process::Command;

/// The designs that packages are committed of.
pub const DESIGNS: [&str; 2] = ["lean18", "standard24"];

/// A unit of `sim/rtl`.
#[derive(Debug, PartialEq, Eq)]
pub struct RtlUnit {
    /// The module at its top.
    pub top: &'static str,
    /// The list of its files.
    list: &'static str,
    /// The parameter that tells its circuits apart.
    parameter: &'static str,
    /// How many packages it is read with: that of the widths, and that of setup's program.
    packages: usize,
}

/// The splat primitive.
pub const PRIMITIVE: RtlUnit = unit("splat_primitive", "files.txt", "LANES", 1);

/// The setup unit.
pub const SETUP: RtlUnit = unit("setup_unit", "setup_files.txt", "CORES", 2);

/// Sorter and binning.
pub const ORDER: RtlUnit = unit("splat_order", "order_files.txt", "DIGIT", 0);

/// The harmonics unit.
pub const HARMONICS: RtlUnit = unit("harmonics_unit", "harmonics_files.txt", "MULTIPLIERS", 0);

/// The whole machine.
pub const MACHINE: RtlUnit = unit("splat_machine", "machine_files.txt", "LANES", 2);

const fn unit(
    top: &'static str,
    list: &'static str,
    parameter: &'static str,
    packages: usize,
) -> RtlUnit {
    RtlUnit {
        top,
        list,
        parameter,
        packages,
    }
}

/// A circuit.
#[derive(Clone)]
pub struct Circuit {
    /// Of this unit.
    pub unit: &'static RtlUnit,
    /// Its design.
    pub design: DesignChoice,
    /// What its cores of setup compute, if it has any.
    pub(crate) program: SetupProgram,
    /// Parameters of the module at the top.
    pub parameters: Vec<Parameter>,
    /// A mistake in one of its files.
    mutation: Option<Mutation>,
}

/// A file's name and text.
pub type Source = (String, String);

/// A parameter's name and value.
pub type Parameter = (&'static str, u32);

impl Circuit {
    /// The unit of a design of `rtl -- area`, with its parameter.
    pub fn new(unit: &'static RtlUnit, design: &str, value: u32) -> Result<Circuit> {
        let subjects = subjects();
        let subject = subjects.iter().find(|subject| subject.name == design);
        let subject = subject.with_context(|| format!("no such design: {design}"))?;
        let mut choice = DesignChoice::load("standard24")?.at_run_time();
        choice.name = design.to_owned();
        choice.widths = subject.widths;
        Ok(Circuit {
            unit,
            design: choice,
            program: SetupProgram::new(ProgramKind::Filter),
            parameters: vec![(unit.parameter, value)],
            mutation: None,
        })
    }

    /// The same with another parameter.
    pub fn with(mut self, parameter: &'static str, value: u32) -> Circuit {
        self.parameters.push((parameter, value));
        self
    }

    /// The value of a parameter that it was given.
    pub fn parameter(&self, name: &str) -> Option<u32> {
        let known = self.parameters.iter().find(|known| known.0 == name);
        known.map(|(_, value)| *value)
    }

    /// The same with another program in its cores.
    pub fn with_program(mut self, program: SetupProgram) -> Circuit {
        self.program = program;
        self
    }

    /// The same with a mistake in its program or in one of its files.
    pub fn with_mutation(mut self, mutation: &Mutation) -> Result<Circuit> {
        if mutation.file == program::FILE {
            self.program = self.program.mutated(mutation)?;
        } else {
            self.mutation = Some(mutation.clone());
        }
        Ok(self)
    }

    /// Its packages and files, in the order in which they are read.
    pub fn sources(&self) -> Result<Vec<Source>> {
        let mut sources = packages(&self.design, &self.program, self.unit.packages)?;
        for file in fs::read_to_string(rtl().join(self.unit.list))?.lines() {
            sources.push((file.to_owned(), fs::read_to_string(rtl().join(file))?));
        }
        for (name, text) in &mut sources {
            if let Some(mutation) = self.mutation.as_ref().filter(|own| own.file == *name) {
                *text = mutation.applied(text)?;
            }
        }
        Ok(sources)
    }

    /// Is it the same circuit, and told the same constants?
    pub fn is_same(&self, other: &Circuit) -> Result<bool> {
        let program = |circuit: &Circuit| circuit.program.assembled(&circuit.design.widths);
        Ok(self.sources()? == other.sources()? && program(self)? == program(other)?)
    }

    /// Yosys' words for reading it, with its files in this folder.
    pub fn read_command(&self, folder: &Path) -> Result<String> {
        let paths = write(folder, &self.sources()?)?;
        Ok(format!("read_verilog -sv {}", paths.join(" ")))
    }

    /// The circuit, compiled for so much, as a library for a [`Bench`](crate::bench::Bench).
    pub fn library(&self, extent: Extent) -> Result<PathBuf> {
        self.verilated(self.sources()?, extent)
    }

    /// The circuit with all of these mutations that one circuit can hold, and their numbers.
    pub fn with_choices(&self, mutations: &[Mutation]) -> Result<(PathBuf, Vec<MutationNumber>)> {
        let (sources, chosen) = with_choices(self.sources()?, mutations)?;
        Ok((self.verilated(sources, Extent::Quick)?, chosen))
    }

    /// The library of these sources. A unit with ports that are no integers of C has a module of its own around it,
    /// whose name says flat for splat.
    fn verilated(&self, mut sources: Vec<Source>, extent: Extent) -> Result<PathBuf> {
        let mut top = self.unit.top.replace("splat_", "flat_");
        let file = format!("{top}.sv");
        match fs::read_to_string(rtl().join("cosim").join(&file)) {
            Ok(text) => sources.push((file, text)),
            Err(_) => top = self.unit.top.to_owned(),
        }
        let version = run(verilator().arg("--version"))?;
        let compiled = (OPTIONS, extent.compiled(), SHIM);
        let mut hash = DefaultHasher::new();
        (version, &sources, &self.parameters, compiled).hash(&mut hash);
        let kept = Path::new(env!("OUT_DIR")).join("circuits");
        fs::create_dir_all(&kept)?;
        let library = kept.join(format!("{top}_{:016x}.so", hash.finish()));
        // Another thread or process may be building it.
        let lock = File::create(library.with_extension("lock"))?;
        lock.lock()?;
        if !library.exists() {
            let folder = tempfile::tempdir_in(&kept)?;
            fs::rename(self.build(folder.path(), &top, &sources, extent)?, &library)?;
        }
        Ok(library)
    }

    fn build(
        &self,
        folder: &Path,
        top: &str,
        sources: &[Source],
        extent: Extent,
    ) -> Result<PathBuf> {
        let root = run(verilator().args(["--getenv", "VERILATOR_ROOT"]))?;
        let include = Path::new(root.trim()).join("include");
        let (model, library) = (folder.join("model"), folder.join("circuit.so"));
        let parameters = self.parameters.iter();
        run(verilator()
            .args(OPTIONS.split(' '))
            .args(["--prefix", "Circuit", "--top-module", top])
            .args(parameters.map(|(name, value)| format!("-G{name}={value}")))
            .args([OsStr::new("--Mdir"), model.as_os_str()])
            .args(write(folder, sources)?))?;
        let header = fs::read_to_string(model.join("Circuit.h"))?;
        fs::write(model.join("ports.h"), ports(&header))?;
        let files = fs::read_dir(&model)?.flatten().map(|file| file.path());
        let files = files.filter(|path| path.extension().is_some_and(|end| end == "cpp"));
        let includes = files.map(|path| format!("#include \"{}\"\n", path.display()));
        let unity: String = includes.collect();
        fs::write(folder.join("circuit.cpp"), unity + SHIM)?;
        let headers = [&model, &include, &include.join("vltstd")];
        run(tool("CXX", "c++")
            .args(["-std=c++17", extent.compiled(), "-w", "-shared", "-fPIC"])
            .args(headers.map(|folder| format!("-I{}", folder.display())))
            .arg(folder.join("circuit.cpp"))
            .args(["verilated.cpp", "verilated_threads.cpp"].map(|file| include.join(file)))
            .args([OsStr::new("-o"), library.as_os_str()]))?;
        Ok(library)
    }
}

impl fmt::Display for Circuit {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        if self.unit.packages > 0 {
            write!(formatter, "{} ", self.design.name)?;
        }
        write!(formatter, "{}", self.unit.top)?;
        let mut parameters = self.parameters.iter();
        parameters.try_for_each(|(name, value)| write!(formatter, " {name}={value}"))
    }
}

fn verilator() -> Command {
    tool("VERILATOR", "verilator")
}

/// Verilator's options for every circuit: what a register holds before reset is drawn by lot.
const OPTIONS: &str = "--cc -O3 --x-assign unique --x-initial unique";

/// The functions between circuit and program.
const SHIM: &str = include_str!("../shim.cpp");

/// So many packages of a design: that of its widths, and that of setup's program.
pub fn packages(
    design: &DesignChoice,
    program: &SetupProgram,
    count: usize,
) -> Result<Vec<Source>> {
    let DesignChoice { name, widths, .. } = design;
    let mut packages = Vec::new();
    if count > 0 {
        let text = package::text(name, widths)?;
        packages.push(("splatline_pkg.sv".to_owned(), text));
    }
    if count > 1 {
        let text = text::text(name, widths, program)?;
        packages.push(("splatline_setup_pkg.sv".to_owned(), text));
    }
    Ok(packages)
}

/// Yosys' words that give a module parameters.
pub fn set(module: &str, parameters: &[Parameter]) -> String {
    let parameters = parameters.iter();
    let words = parameters.map(|(name, value)| format!("chparam -set {name} {value} {module}; "));
    words.collect()
}

/// Writes files into a folder; gives their paths.
pub fn write(folder: &Path, sources: &[Source]) -> Result<Vec<String>> {
    let written = |(name, text): &Source| {
        let path = folder.join(name);
        fs::write(&path, text)?;
        Ok(path.display().to_string())
    };
    sources.iter().map(written).collect()
}

/// The ports of Verilator's class, as the shim lists them. In its header `VL_INW(&record,607,0,19);` is an input of 608
/// bits.
fn ports(header: &str) -> String {
    let port = |line: &str| {
        let (kind, port) = line.trim().split_once("(&")?;
        let mut words = port.split(',');
        let (name, high) = (words.next()?, words.next()?);
        let is_input = kind.starts_with("VL_IN");
        (is_input || kind.starts_with("VL_OUT"))
            .then(|| format!("{{\"{name}\", &model.{name}, {high} + 1, {is_input}}},\n"))
    };
    header.lines().filter_map(port).collect()
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
