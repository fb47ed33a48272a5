//! The simulator around splatline's fixed-point kernel: scenes are drawn bit for bit as the hardware would, its cycles
//! are counted, and both are held against a float reference.
//!
//! Data flows down this list and never back: what comes in is read by the reference's crate (a [`scene`] of splats is
//! seen by a [`camera`] under [`rules`]); the engine's crate draws it through the kernel ([`fixed`], a [`Renderer`]
//! many frames of it), and [`reference`](mod@reference) in double precision, both into a [`picture`]; [`metrics`]
//! compares two pictures; the crate of the [`machine`] counts cycles, [`explore`] searches designs and machines,
//! `trace` and [`vectors`] write what other tools read, and [`report`] and the live `page` tell people about it.
//! [`cli`] is the command line over all of them.

pub use splatline_engine::{Renderer, design, fast, fixed, renderer, threads};
pub use splatline_machine as machine;
pub use splatline_reference::engines as reference;
pub use splatline_reference::{
    atomic, camera, cameras, flip, framing, hybrid, input, memory, metrics, picture, rules, scene,
    sheets, surface, texture, vector,
};

pub mod bake;
pub mod cli;
mod difference;
mod digest;
pub mod explore;
mod page;
pub mod plan;
pub mod progress;
pub mod report;
pub mod stability;
pub mod systems;
mod trace;
pub mod vectors;
