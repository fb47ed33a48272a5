//! Fixed-point splatting kernel.
#![no_std]
#![forbid(unsafe_code)]

pub mod format;
pub mod math;
pub mod view;
pub mod splat;
pub mod rules;
pub mod setup;
pub mod footprint;
pub mod raster;
pub mod kernel;
pub mod blend;
pub mod target;
pub mod draw;
