//! The front door: a scene in, pixels out, in memory that the caller lends.
//!
//! What an embedder needs and no more. Every step here calls the units of the other modules and adds no arithmetic of
//! its own, so that a picture drawn through it has the bits of one drawn stage by stage (`tests/all/front.rs`).
//!
//! ```text
//! Camera, Gaussian, Point   ordinary numbers (module float)
//!   Renderer::set_up        cull, set up, sort by depth  -> a display list
//!   Renderer::draw          a frame, or a strip of it    -> Frame: pixels as RGB8 or RGB565
//! Scene, CompactScene       splats converted once, in lent memory or in flash
//!   Renderer::set_up_scene  sort by depth, set up        -> a packed list, a third of the memory
//! Surfel                    points of surfaces
//!   SurfaceRenderer::draw   set up, gather, resolve      -> Frame
//! ```

mod counts;
mod frame;
mod list;
mod order;
mod packed;
mod primitive;
mod renderer;
mod scene;
mod surfaces;

pub use counts::Counts;
pub use frame::{Frame, PixelReader};
pub use list::{BoundedList, DisplayList, Footprints, LentList, ListFull};
pub use order::sort_by_key;
pub use packed::{PackedList, packed_words};
pub use primitive::{Primitive, Rejected};
pub use renderer::{NoTable, RenderError, Renderer};
pub use scene::{
    COMPACT_BYTES, COMPACT_HEADER, COMPACT_MAGIC, CompactScene, CompactSplat, Scene, SceneFull,
    Splats,
};
pub use surfaces::SurfaceRenderer;
