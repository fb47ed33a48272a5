//! The engine `fixed`: a scene quantised once, then drawn by the kernel, tile by tile.
//!
//! ```text
//! quantise -> setup (kernel) -> order -> tiles (kernel's painter) -> picture
//! ```

mod bands;
pub mod deep;
mod quantise;
mod render;
pub mod sheets;

pub use quantise::{QuantisedScene, kernel_compositing, kernel_rules, scaled};
pub use render::{Drawing, Options, Times, draw, footprints};
