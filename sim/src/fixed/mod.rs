//! The engine `fixed`: a scene quantised once, then drawn by the kernel, tile by tile.
//!
//! ```text
//! quantise -> setup (kernel) -> order -> tiles (kernel's painter) -> picture
//! ```

mod quantise;
mod render;
pub mod surface;

pub use quantise::{QuantisedScene, kernel_compositing, kernel_rules, scaled};
pub use render::{Drawing, Options, Times, conics, draw, footprints};
