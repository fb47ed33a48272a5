//! The whole machine (`sim/rtl/splat_machine.sv`) from a memory image to a frame.

pub mod area;
pub mod harmonics;
pub mod image;
pub mod loads;
pub mod shell;
pub mod unit;
