//! The verilated machine and its memory behind a safe function.
#![allow(unsafe_code)]

use crate::switch::MistakeNumber;
use anyhow::{Context, Result, ensure};
use libloading::Library;
use std::path::Path;

/// A constant of camera or rules at its address.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct ConstantWords {
    /// The number.
    pub value: u64,
    /// Its exponent.
    pub exponent: u32,
    /// Its address.
    pub index: u32,
}

/// An entry of the footprint table and the step down to the next.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct TableWords {
    /// The entry.
    pub low: u32,
    /// The step.
    pub step: u32,
}

/// Rules of blending, where everything lies in the memory, and how the memory behaves; `MachineFrame` of machine_shim.cpp.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct MachineFrame {
    /// Products of opacity and weight below it are skipped.
    pub least: u64,
    /// Largest opacity.
    pub alpha_max: u32,
    /// Transmittance at which a pixel has finished.
    pub minimum_transmittance: u32,
    /// Is the splat left out that would finish it?
    pub omit_finishing: u32,
    /// Does the table end at r = 16?
    pub wide_table: u32,
    /// Records.
    pub records: u32,
    /// Words at which records, packets, both regions of the sort, lists and pixels begin.
    pub base_records: u32,
    /// Packets.
    pub base_packets: u32,
    /// Splats to be sorted.
    pub bases: [u32; 2],
    /// Lists.
    pub base_lists: u32,
    /// Pixels.
    pub base_frame: u32,
    /// Entries for which the lists have room.
    pub most: u32,
    /// Columns of the frame.
    pub columns: u32,
    /// Its rows.
    pub rows: u32,
    /// Cycles from a request to its word.
    pub latency: u32,
    /// How many of 8 cycles the memory holds a request back.
    pub pauses: u32,
    /// Bytes that it moves in a cycle in each direction: 4, 8 or 16.
    pub bytes: u32,
}

/// What came of a frame; `MachineOutcome` of machine_shim.cpp.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct MachineOutcome {
    /// Had the lists no room?
    pub full: u32,
    /// Splats that were not culled.
    pub visible: u32,
    /// List entries.
    pub entries: u32,
    /// Did it never end?
    pub hangs: u32,
    /// Cycles of geometry.
    pub geometry: u64,
    /// Cycles of the sort.
    pub sort: u64,
    /// Cycles in which lists were filled.
    pub fill: u64,
    /// Cycles until the last pixel was written.
    pub raster: u64,
    /// Words read.
    pub read: u64,
    /// Words written.
    pub written: u64,
    /// Accesses beyond the memory.
    pub beyond: u64,
}

impl MachineOutcome {
    /// All cycles.
    pub fn cycles(&self) -> u64 {
        self.geometry + self.sort + self.fill + self.raster
    }

    /// How far it came.
    fn last_phase(&self) -> &'static str {
        match self {
            Self { raster: 1.., .. } => "raster",
            Self { fill: 1.., .. } => "its lists",
            Self { sort: 1.., .. } => "the sort",
            _ => "geometry",
        }
    }
}

type MachineRun = unsafe extern "C" fn(
    u32,
    u32,
    *const MachineFrame,
    *const ConstantWords,
    u64,
    *const TableWords,
    u64,
    *mut [u32; 4],
    u64,
    u32,
    *mut MachineOutcome,
);

/// A machine in a shared library.
pub struct MachineModel {
    run: MachineRun,
    mistake: u32,
    /// Keeps the code loaded.
    _library: Library,
}

impl MachineModel {
    /// Loads it.
    pub fn new(path: &Path) -> Result<MachineModel> {
        MachineModel::with_mistake(path, 0)
    }

    /// The same with one of the mistakes that the machine was built with ([`crate::switch`]); 0 is none.
    pub fn with_mistake(path: &Path, mistake: MistakeNumber) -> Result<MachineModel> {
        // SAFETY: the library is the shim and a verilated model, whose loading runs no code of its own; the symbol has the shim's type.
        unsafe {
            let library = Library::new(path).context("the machine's library")?;
            Ok(MachineModel {
                run: *library.get(b"machine_run")?,
                mistake: mistake as u32,
                _library: library,
            })
        }
    }

    /// Draws a frame `rounds` times in `memory`; the last one counts.
    pub fn run(
        &self,
        frame: &MachineFrame,
        constants: &[ConstantWords],
        table: &[TableWords],
        memory: &mut [[u32; 4]],
        rounds: u32,
    ) -> Result<MachineOutcome> {
        let mut outcome = MachineOutcome::default();
        // SAFETY: the structs mirror the shim's, every slice is passed with its length, and the shim keeps the circuit's accesses within the memory.
        unsafe {
            (self.run)(
                1,
                self.mistake,
                frame,
                constants.as_ptr(),
                constants.len() as u64,
                table.as_ptr(),
                table.len() as u64,
                memory.as_mut_ptr(),
                memory.len() as u64,
                rounds,
                &mut outcome,
            );
        }
        ensure!(
            outcome.hangs == 0,
            "the machine hangs in {}, after {} words read and {} written",
            outcome.last_phase(),
            outcome.read,
            outcome.written
        );
        Ok(outcome)
    }
}
