//! The whole machine (`sim/rtl/splat_machine.sv`) from a memory image to a frame.

pub mod area;
mod image;
mod loads;
pub mod shell;
pub mod unit;

pub use loads::MachineLoad;
