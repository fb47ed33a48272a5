//! Fixed-point splatting kernel.
#![no_std]
#![forbid(unsafe_code)]

pub mod blend;
pub mod draw;
pub mod footprint;
pub mod format;
pub mod kernel;
pub mod math;
pub mod raster;
pub mod rules;
pub mod setup;
pub mod splat;
pub mod target;
pub mod view;
