//! What prints splatline's documentation: `cargo run --release -p splatline-lab -- results` and `... gallery all` print `docs/results` and
//! `docs/gallery`. Nobody needs it to use the simulator, so it is a crate of its own, outside the workspace's default members.
//!
//! ```text
//! views (scenes and cameras) -> what the commands run -> pages (tables as Markdown and CSV) -> docs/results
//! ```
//!
//! [`bars`] has what must be reached, [`rasterizer`] what speed is compared with, [`gallery`] an exhibit of every system.

pub mod bars;
pub mod gallery;
pub mod pages;
pub mod plot;
pub mod rasterizer;
pub mod study;
pub mod table;
pub mod views;
