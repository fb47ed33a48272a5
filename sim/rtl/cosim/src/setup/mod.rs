//! The setup unit (`sim/rtl/setup_unit.sv`): its program, its constants, and its co-simulation with the kernel's
//! `setup`.

mod assemble;
pub(crate) mod constants;
mod exact;
mod loads;
pub mod program;
pub(crate) mod record;
mod tables;
pub mod text;
pub mod unit;

pub use loads::{SetupLoad, enlarged};
