//! The verilated harmonics unit behind a safe handle.
#![allow(unsafe_code)]

use crate::switch::MistakeNumber;
use anyhow::{Context, Result};
use libloading::Library;
use std::ffi::c_void;
use std::path::Path;

/// The circuit's inputs in one cycle; `Inputs` of harmonics_shim.cpp.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct HarmonicsInputs {
    /// Reset.
    pub rst: u8,
    /// A splat is offered.
    pub splat_valid: u8,
    /// Its degree.
    pub degree: u8,
    /// A word is offered.
    pub word_valid: u8,
    /// A colour is taken.
    pub colour_ready: u8,
    /// Padding.
    pub spare: [u8; 3],
    /// The splat's direction.
    pub direction: [i32; 3],
    /// Base or coefficient.
    pub word: [i32; 3],
}

/// The circuit's outputs in one cycle, before its edge; `Outputs` of harmonics_shim.cpp.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct HarmonicsOutputs {
    /// The splat is taken.
    pub splat_ready: u8,
    /// The word is taken.
    pub word_ready: u8,
    /// A colour is offered.
    pub colour_valid: u8,
    /// Padding.
    pub spare: u8,
    /// The colour.
    pub colour: [u32; 3],
}

/// A circuit being simulated.
pub struct HarmonicsModel {
    simulation: *mut c_void,
    tick: unsafe extern "C" fn(*mut c_void, *const HarmonicsInputs, *mut HarmonicsOutputs),
    destroy: unsafe extern "C" fn(*mut c_void),
    /// Keeps the code loaded.
    _library: Library,
}

impl HarmonicsModel {
    /// The circuit in a shared library, after reset. The seed chooses what its registers held before.
    pub fn new(path: &Path, seed: u32) -> Result<HarmonicsModel> {
        HarmonicsModel::with_mistake(path, seed, 0)
    }

    /// The same with one of the mistakes that the circuit was built with ([`crate::switch`]); 0 is none.
    pub fn with_mistake(path: &Path, seed: u32, mistake: MistakeNumber) -> Result<HarmonicsModel> {
        // SAFETY: the library is the shim and a verilated model, whose loading runs no code of its own; the symbols have the
        // shim's types, and the simulation is freed by the same library before it is unloaded.
        let mut model = unsafe {
            let library = Library::new(path).context("the harmonics unit's library")?;
            let make: unsafe extern "C" fn(u32, u32) -> *mut c_void =
                *library.get(b"harmonics_make")?;
            HarmonicsModel {
                simulation: make(seed, mistake as u32),
                tick: *library.get(b"harmonics_tick")?,
                destroy: *library.get(b"harmonics_destroy")?,
                _library: library,
            }
        };
        for _ in 0..4 {
            model.tick(&HarmonicsInputs {
                rst: 1,
                ..HarmonicsInputs::default()
            });
        }
        Ok(model)
    }

    /// One cycle: the outputs belong to these inputs, before the clock's edge.
    pub fn tick(&mut self, inputs: &HarmonicsInputs) -> HarmonicsOutputs {
        let mut outputs = HarmonicsOutputs::default();
        // SAFETY: the simulation came from the same library's `harmonics_make`; both structs mirror the shim's and outlive the call.
        unsafe { (self.tick)(self.simulation, inputs, &mut outputs) };
        outputs
    }
}

impl Drop for HarmonicsModel {
    fn drop(&mut self) {
        // SAFETY: made by the same library's `harmonics_make`, not used afterwards; the library is dropped after this.
        unsafe { (self.destroy)(self.simulation) }
    }
}
