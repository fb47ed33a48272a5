//! Circuits that are built while the program runs: of any design, with any number of lanes, or with one mistake in them. Those that every test
//! draws with are linked in (`build.rs`).

use crate::area::rtl;
use crate::mutants::Mutant;
use crate::package;
use crate::switch::with_choices;
use crate::verilate::{VerilatorTarget, library, units, write};
use anyhow::Result;
use splatline::format::Widths;
use splatline_sim::machine::primitive::SETUP_INTERVAL;
use std::path::{Path, PathBuf};

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
    /// Mistakes of which a number picks one when it is simulated.
    pub choices: &'a [Mutant],
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
            choices: &[],
            effort: "-O0",
        }
    }

    /// Builds it as a shared library in a folder.
    pub fn library(&self, folder: &Path) -> Result<PathBuf> {
        let mut files = units("files.txt")?;
        files.insert(
            0,
            (
                "splatline_pkg.sv".to_owned(),
                package::text(self.design, self.widths)?,
            ),
        );
        let files = with_choices(files, self.choices)?;
        let mut sources = write(folder, files, self.mistake)?;
        sources.push(rtl().join("cosim/flat_primitive.sv"));
        let target = VerilatorTarget {
            top: "flat_primitive",
            parameters: &[
                format!("LANES={}", self.lanes),
                format!("SETUP_INTERVAL={}", self.setup_interval),
            ],
            prefix: "Vbuilt",
            shims: &["shim.cpp", "runtime.cpp"],
            definitions: &["NAME=built"],
            effort: self.effort,
        };
        library(folder, &sources, &target)
    }
}
