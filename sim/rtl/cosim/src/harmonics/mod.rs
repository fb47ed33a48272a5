//! Spherical harmonics in hardware (`sim/rtl/harmonics_unit.sv`): their program, the co-simulation with the kernel, and mistakes
//! (`docs/harmonics-unit.md`).

pub mod bench;
pub mod circuit;
pub mod loads;
pub mod mistakes;
pub mod model;
pub mod program;
pub mod report;
pub mod schedule;
pub mod text;
