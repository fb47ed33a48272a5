//! The setup unit (`sim/rtl/setup_unit.sv`): its program, its constants, and its co-simulation with the kernel's `setup`.

pub mod assemble;
pub mod constants;
pub mod distant;
pub mod exact;
pub mod loads;
pub mod program;
pub mod record;
pub mod schedule;
pub mod tables;
pub mod text;
pub mod unit;
