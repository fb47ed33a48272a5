//! The kernel's tests, one program: each module is a check of docs/CONTRIBUTING.md.

mod arbitrary;
mod checks;
mod common;

#[cfg(feature = "float")]
mod front;
mod scenes;
mod independence;
mod independence_pixels;
mod kernels;
mod narrow;
mod setup_against_double;
mod single;
mod snapshots;
mod surface_layers;
mod surface_setup;
mod surface_tiles;
mod totality;
mod traversals;
mod widths;
