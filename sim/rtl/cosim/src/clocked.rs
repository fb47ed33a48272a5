//! A verilated unit that is clocked from outside, behind a safe handle: what it is given in a cycle, and what it gives.
#![allow(unsafe_code)]

use crate::switch::MistakeNumber;
use anyhow::{Context, Result};
use libloading::Library;
use std::ffi::c_void;
use std::path::Path;

/// A unit's inputs in one cycle.
///
/// # Safety
///
/// The shim of this name has functions `NAME_make`, `NAME_tick` and `NAME_destroy`, of which the second takes a pointer to these inputs and one to
/// these outputs; both are laid out as the shim's.
pub unsafe trait ClockedInputs: Default {
    /// The outputs in that cycle, before its edge.
    type Outputs: Default;
    /// What the names of the shim's functions begin with.
    const NAME: &'static str;
    /// The inputs of a cycle of reset.
    fn reset() -> Self;
}

/// A circuit being simulated.
pub struct ClockedModel<I: ClockedInputs> {
    simulation: *mut c_void,
    tick: unsafe extern "C" fn(*mut c_void, *const I, *mut I::Outputs),
    destroy: unsafe extern "C" fn(*mut c_void),
    /// Keeps the code loaded.
    _library: Library,
}

impl<I: ClockedInputs> ClockedModel<I> {
    /// The circuit in a shared library, after reset. The seed chooses what its registers held before.
    pub fn new(path: &Path, seed: u32) -> Result<Self> {
        Self::with_mistake(path, seed, 0)
    }

    /// The same with one of the mistakes that the circuit was built with ([`crate::switch`]); 0 is none.
    pub fn with_mistake(path: &Path, seed: u32, mistake: MistakeNumber) -> Result<Self> {
        let symbol = |function: &str| format!("{}_{function}", I::NAME);
        // SAFETY: the library is the shim and a verilated model, whose loading runs no code of its own; the symbols have the
        // shim's types, and the simulation is freed by the same library before it is unloaded.
        let mut model = unsafe {
            let library =
                Library::new(path).with_context(|| format!("the {} unit's library", I::NAME))?;
            let make: unsafe extern "C" fn(u32, u32) -> *mut c_void =
                *library.get(symbol("make").as_bytes())?;
            ClockedModel {
                simulation: make(seed, mistake as u32),
                tick: *library.get(symbol("tick").as_bytes())?,
                destroy: *library.get(symbol("destroy").as_bytes())?,
                _library: library,
            }
        };
        for _ in 0..4 {
            model.tick(&I::reset());
        }
        Ok(model)
    }

    /// One cycle: the outputs belong to these inputs, before the clock's edge.
    pub fn tick(&mut self, inputs: &I) -> I::Outputs {
        let mut outputs = I::Outputs::default();
        // SAFETY: the simulation was made by the same library; both structs are the shim's and outlive the call.
        unsafe { (self.tick)(self.simulation, inputs, &mut outputs) };
        outputs
    }
}

impl<I: ClockedInputs> Drop for ClockedModel<I> {
    fn drop(&mut self) {
        // SAFETY: made by the same library, not used afterwards; the library is dropped after this.
        unsafe { (self.destroy)(self.simulation) }
    }
}
