//! Scenes through the fixed-point kernel on a host: every system as the kernel defines it, and the same bits fast.
//!
//! A crate of its own, so that a program that draws compiles neither the machine model nor the command line. Data flows
//! down this list:
//!
//! ```text
//! design     widths and rounding by name and from files
//! fast       setup, order, rows and pixels on vectors: AVX2, AVX-512 or arrays
//! fixed      all systems in fixed point: scenes brought into the kernel's formats and drawn, by `fast` where that is
//!            bit for bit the same
//! threads    pools with the stacks that drawing needs
//! renderer   frame after frame of one scene in the same memory
//! ```

pub use splatline_reference::{
    camera, hybrid, input, memory, metrics, picture, rules, scene, sheets, surface, texture, vector,
};

pub mod design;
pub mod fast;
pub mod fixed;
pub mod renderer;
pub mod threads;

pub use renderer::Renderer;
