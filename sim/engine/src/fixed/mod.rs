//! The engine `fixed`: a scene quantised once, then drawn by the kernel, tile by tile.
//!
//! ```text
//! quantise -> setup (kernel) -> order -> tiles (kernel's painter) -> picture
//! ```

pub mod deep;
mod frame;
mod harmonics;
mod hybrid;
mod maps;
mod quantise;
pub(crate) mod render;
pub mod sheets;
mod sphere;
pub mod surface;

pub use crate::fast::{TableMemory, whole};
pub use frame::converter;
pub use harmonics::harmonic_colours;
pub use hybrid::{HybridFacts, HybridRenderer};
pub use maps::draw_maps;
pub use quantise::{QuantisedScene, kernel_compositing, kernel_rules, scaled};
pub use render::{
    Canvas, FixedDrawing, Options, PaintEngine, Times, best_engine, conics, culls, draw,
    draw_quantised, draw_with_footprints, footprints, painter, variances,
};
pub use sphere::draw_spheres;
