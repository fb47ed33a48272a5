//! The setup unit (`sim/rtl/setup_unit.sv`): its program, its constants, and its co-simulation with the kernel's `setup`.

pub mod assemble;
mod builder;
pub mod constants;
mod distance;
pub mod distant;
pub mod exact;
pub mod loads;
pub mod program;
pub mod program_mutations;
pub mod record;
pub mod tables;
pub mod text;
pub mod unit;
