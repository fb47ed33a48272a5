//! The fast engine: the kernel's pictures, bit for bit, on vectors and all cores.
//!
//! ```text
//! setup -> order (radix sort, tile lists) -> recurrence -> rows -> pixels of cells, or of runs -> tile -> frame
//! ```
//!
//! The scalar painter ([`Painter`](splatline::draw::Painter)) stays the definition. What is fast here is tested against it word for word,
//! pixels and counts, and what the vectors cannot do is left to it: other traversals and orders, footprints whose words lie outside their
//! formats, and, where there are no fused products, 64-bit lanes.

mod cells;
pub mod lanes;
pub mod order;
mod paint;
mod pixels;
pub(crate) mod recurrence;
pub(crate) mod rows;
pub mod setup;
pub mod tile;

pub use paint::{CHECK_INTERVAL, FastPainter, Results, Scratch, TilePainter, tile_painter};
pub use tile::TILE;

#[cfg(test)]
mod tests;
