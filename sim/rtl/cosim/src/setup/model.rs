//! The verilated setup unit behind a safe handle.
#![allow(unsafe_code)]

use crate::switch::MistakeNumber;
use anyhow::{Context, Result};
use libloading::Library;
use splatline::footprint::packet::Packet;
use std::ffi::c_void;
use std::path::Path;

/// Words of a record.
pub const RECORD: usize = 19;

/// The circuit's inputs in one cycle; `SetupInputs` of setup_shim.cpp.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct SetupInputs {
    /// Reset.
    pub rst: u8,
    /// A constant is written.
    pub constant_valid: u8,
    /// Its address.
    pub constant_index: u8,
    /// A record is offered.
    pub record_valid: u8,
    /// A packet is taken.
    pub packet_ready: u8,
    /// Padding.
    pub spare: [u8; 3],
    /// The constant.
    pub constant_value: u64,
    /// Its exponent.
    pub constant_exponent: u32,
    /// The record.
    pub record: [u32; RECORD],
}

/// The circuit's outputs in one cycle, before its edge; `SetupOutputs` of setup_shim.cpp.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct SetupOutputs {
    /// The record is taken.
    pub record_ready: u8,
    /// A packet is offered.
    pub packet_valid: u8,
    /// Why it is none.
    pub cull: u8,
    /// Padding.
    pub spare: u8,
    /// The packet.
    pub packet: Packet,
}

/// A circuit being simulated.
pub struct SetupModel {
    simulation: *mut c_void,
    tick: unsafe extern "C" fn(*mut c_void, *const SetupInputs, *mut SetupOutputs),
    destroy: unsafe extern "C" fn(*mut c_void),
    /// Keeps the code loaded.
    _library: Library,
}

impl SetupModel {
    /// The circuit in a shared library, after reset. The seed chooses what its registers held before.
    pub fn new(path: &Path, seed: u32) -> Result<SetupModel> {
        SetupModel::with_mistake(path, seed, 0)
    }

    /// The same with one of the mistakes that the circuit was built with ([`crate::switch`]); 0 is none.
    pub fn with_mistake(path: &Path, seed: u32, mistake: MistakeNumber) -> Result<SetupModel> {
        // SAFETY: the library is the shim and a verilated model, whose loading runs no code of its own; the symbols have the
        // shim's types, and the simulation is freed by the same library before it is unloaded.
        let mut model = unsafe {
            let library = Library::new(path).context("the setup unit's library")?;
            let make: unsafe extern "C" fn(u32, u32) -> *mut c_void =
                *library.get(b"setup_make")?;
            SetupModel {
                simulation: make(seed, mistake as u32),
                tick: *library.get(b"setup_tick")?,
                destroy: *library.get(b"setup_destroy")?,
                _library: library,
            }
        };
        for _ in 0..4 {
            model.tick(&SetupInputs {
                rst: 1,
                ..SetupInputs::default()
            });
        }
        Ok(model)
    }

    /// One cycle: the outputs belong to these inputs, before the clock's edge.
    pub fn tick(&mut self, inputs: &SetupInputs) -> SetupOutputs {
        let mut outputs = SetupOutputs::default();
        // SAFETY: the simulation came from the same library's `setup_make`; both structs mirror the shim's and outlive the call.
        unsafe { (self.tick)(self.simulation, inputs, &mut outputs) };
        outputs
    }
}

impl Drop for SetupModel {
    fn drop(&mut self) {
        // SAFETY: made by the same library's `setup_make`, not used afterwards; the library is dropped after this.
        unsafe { (self.destroy)(self.simulation) }
    }
}
