//! Single-precision rasterizers to compare the kernel's speed with.
//!
//! | baseline | what it is |
//! |---|---|
//! | (a) [`boxes`] | the best that open CPU rasterizers do: boxes of three sigmas, 16 x 16 tiles, rows in vectors, an approximate `exp` |
//! | (b) [`spans`] | the kernel's own traversal, tiles, order and vectors with floating-point pixels and a polynomial `exp` |
//! | [`textbook`] | many of them: conic, bounding box, 16 x 16 tiles, sorted duplicates, library `exp`, pixel by pixel |
//!
//! Between (a) and the kernel lies the gain of the algorithm and of the arithmetic together; between (b) and the kernel that of the
//! arithmetic alone. All share [`scene`], the usual single-precision setup, and draw by the same [`Rules`](splatline_sim::rules::Rules): the same footprints end where
//! the same cut-off says, opacities are clamped, skipped and finished alike. They draw front to back only.

mod binned;
pub mod boxes;
pub mod scene;
pub mod spans;
pub mod textbook;

pub use scene::FloatScene;

use splatline_sim::fixed::Times;
use splatline_sim::picture::Picture;

/// What a baseline draws.
#[derive(Clone, Debug)]
pub struct BaselineDrawing {
    /// Premultiplied red, green, blue and transmittance, row-major.
    pub frame: Vec<[f32; 4]>,
    /// Time taken.
    pub times: Times,
}

impl BaselineDrawing {
    /// The picture in double precision.
    pub fn picture(&self, [width, height]: [u16; 2]) -> Picture {
        let mut picture = Picture::new(width.into(), height.into());
        for (out, [r, g, b, t]) in picture.pixels.iter_mut().zip(&self.frame) {
            *out = [r, g, b, &(1.0 - t)].map(|value| f64::from(*value));
        }
        picture
    }
}
