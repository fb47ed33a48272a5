//! The setup unit (`sim/rtl/setup_unit.sv`): its program, its constants, and its co-simulation with the kernel's `setup`.

pub mod area;
pub mod assemble;
pub mod bench;
mod builder;
pub mod circuit;
pub mod constants;
pub use splatline_sim::machine::area::setup as counts;
mod distance;
pub mod distant;
pub mod exact;
pub mod loads;
pub mod mistakes;
pub mod model;
pub mod program;
pub mod program_mistakes;
pub mod report;
pub mod text;
pub mod vectors;
