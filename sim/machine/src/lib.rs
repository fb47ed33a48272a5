//! The machine: how many clock cycles a splatting unit takes for the pixels that the kernel draws.
//!
//! ```text
//! kernel or CSV -> workload -> lane work -> raster units  \
//!                     \----> geometry phase --------------- timing (accounts, histograms, bytes)
//! ```
//!
//! The model is cycle-approximate: every unit is a server with a service time, every FIFO has a depth, and departure
//! times follow from the max-plus recurrences of such networks, row by row. A cycle in which nothing begins or ends
//! costs the host nothing. The definitions of all units are in `docs/hardware-model.md`.
//!
//! A [`Workload`](workload::Workload) is extracted once per scene, design, traversal and tile size;
//! [`LaneWork`](lanes::LaneWork) once per lane layout; every further machine configuration reuses both.

use splatline_engine::{
    camera, design, fixed, input, memory as host_memory, picture, rules, scene, surface,
};

pub mod accounts;
pub mod area;
mod cache;
pub mod clock;
pub mod config;
pub mod energy;
mod geometry;
pub mod histogram;
pub mod lanes;
pub mod memory;
pub mod observe;
mod order;
pub mod others;
pub mod parts;
pub mod primitive;
mod raster;
pub mod record;
mod sequencer;
pub mod summary;
mod tile_order;
pub mod timing;
pub mod workload;

pub use config::Config;
pub use timing::{Timing, simulate, simulate_alone, simulate_observed};

#[cfg(test)]
mod tests;
