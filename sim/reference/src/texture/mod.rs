//! Textures on points (\[SURF\] 5) and forward warping of depth images and textures (\[HYBRID\] 3): systems 13 and 17,
//! on the host.
//!
//! ```text
//! texture + points -> coefficients -> surface scene                       (both engines draw it as any other)
//! depth image or textured plane    -> samples as splats -> point or splat  (crate::hybrid)
//! ```

pub mod coefficients;
pub mod drape;
pub mod image;
pub mod solve;
pub mod warp;

pub use image::Texture;
