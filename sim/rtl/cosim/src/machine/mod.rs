//! The whole machine (`sim/rtl/splat_machine.sv`) from a memory image to a frame: against the kernel's frame, pixel by pixel, and against the model's cycles.

pub mod bench;
pub mod circuit;
pub mod mistakes;
pub mod model;
pub mod report;
