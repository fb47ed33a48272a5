//! The fast engine: the kernel's pictures, bit for bit, on vectors and all cores.
//!
//! ```text
//! depth_first (what is hidden) -> setup -> order (radix sort, tile lists) -> rows -> pixels of runs -> tile -> frame
//! ```
//!
//! The scalar painter ([`Painter`](splatline::draw::Painter)) stays the definition. What is fast here is tested against
//! it word for word, pixels and counts, and what the vectors cannot do is left to it: other traversals, and footprints
//! whose words lie outside their formats.

pub mod depth_first;
pub mod frame;
pub mod lanes;
pub mod order;
mod painter;
mod row_group;
mod row_reals;
mod row_words;
pub mod rows;
pub mod setup;
pub mod surface;
pub mod tile;
mod words;

pub use painter::{
    CHECK_INTERVAL, PaintScratch, Results, Start, TableMemory, TilePainter, TileWork, tile_painter,
    whole,
};
pub use tile::TILE;
pub(crate) use words::numbers::PathNumbers;
pub(crate) use words::visit::{TakeOpacities, VisitTask};

#[cfg(test)]
mod tests;
