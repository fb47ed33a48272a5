//! What measures and prints splatline's own documentation. Nobody needs it to use the simulator, so it is a crate of its own, outside the
//! workspace's default members: `cargo run --release -p splatline-lab -- results` and `... gallery all` print `docs/results` and `docs/gallery`.
//!
//! [`results`] computes the pages of figures, [`gallery`] draws an exhibit of every system, [`study`] answers single questions for the
//! decision pages, [`plot`] draws curves for them, and [`rasterizer`] is the single-precision rasterizer that speed is compared with.

pub mod gallery;
pub mod plot;
pub mod rasterizer;
pub mod results;
pub mod study;
