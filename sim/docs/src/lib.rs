//! What prints splatline's documentation: `cargo run --release -p splatline-docs -- results` and `... gallery` print
//! `docs/results` and `docs/gallery`. Nobody needs it to use the simulator, so it is a crate of its own, outside the
//! workspace's default members.
//!
//! ```text
//! views (scenes and cameras) -> what the commands run -> pages (tables as Markdown and CSV) -> docs/results
//! ```
//!
//! [`bars`] has what must be reached, [`rasterizer`] what speed is compared with, [`gallery`] every system's plans as
//! pictures.

pub mod bars;
pub mod gallery;
pub mod pages;
pub mod rasterizer;
pub mod table;
pub mod views;
