//! Fixed-point splatting kernel: firmware, golden model of a hardware splat primitive, and the thing explored, in one
//! copy of the arithmetic.
//!
//! ```
//! use splatline::{BoundedList, Camera, Gaussian, Pixel, Renderer, Standard24};
//!
//! let camera = Camera::look_at([0.0, -1.0, -4.0], [0.0; 3], [0.0, -1.0, 0.0], 40.0, [64, 64])?;
//! let ball = Gaussian { scales: [0.4; 3], opacity: 0.9, colour: [1.0, 0.5, 0.1], ..Gaussian::UNIT };
//! let needle = Gaussian { mean: [0.5, 0.0, 1.0], scales: [0.1, 0.9, 0.1], ..ball };
//! let (mut list, mut pixels) = (BoundedList::<8>::new(), [Pixel::default(); 64 * 64]);
//! let renderer = Renderer::new(Standard24);
//! let (frame, counts) = renderer.render(&camera.view()?, [ball, needle], &mut list, &mut pixels)?;
//! assert_eq!(counts.drawn, 2);
//! let for_a_display: Vec<u16> = frame.rgb565(0).collect();
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! [`front`] is the way in: a `Camera` and splats in ordinary numbers, a [`Renderer`] that culls, sets up, sorts and
//! draws them, whole frames or strips, in memory that the caller lends. Without the feature `float` (on by default) a
//! scene is in the kernel's own types ([`splat::VolumeSplat`], [`View`]) and nothing of floating point is linked.
//!
//! The modules are the units of the block diagram; data flows down this list and never back.
//!
//! ```text
//! splat, view, rules          what comes in
//!   setup                     project -> jacobian -> covariance -> shape -> bounding box
//!     footprint               the packet between setup and raster
//!       raster                rows, spans, forward differencing
//!         kernel              footprint table on the radial index
//!           blend             deep alpha compositing
//!             target          tiles and frames in lent memory
//! draw                        the units chained
//! front, float                scenes, renderer, ordinary numbers
//! format, math                widths and integer arithmetic that all of them share
//! ```
//!
//! Everything is generic over [`format::Design`], which answers how many bits a quantity has. Nothing allocates, panics
//! or writes outside the memory it was lent, whatever the bits of its inputs.
//!
//! Equations are cited as \[EWA\] (Zwicker et al., EWA Splatting, 2002), \[SURF\] (Zwicker et al., Surface Splatting,
//! 2001), \[SWAN\] (Swan et al., An Anti-Aliasing Technique for Splatting, 1997) and \[HYBRID\] (Yuan et al., Hybrid
//! Forward Resampling and Volume Rendering, 2003).
#![no_std]
#![forbid(unsafe_code)]
#![cfg_attr(docsrs, feature(doc_cfg))]

pub mod format;
pub mod math;
pub mod view;
pub mod splat;
pub mod rules;
pub mod setup;
pub mod footprint;
pub mod raster;
pub mod kernel;
pub mod blend;
pub mod target;
pub mod draw;
pub mod front;
#[cfg(feature = "float")]
pub mod float;

pub use blend::Pixel;
/// The fixed-point numbers that splats and views are made of.
pub use fixed;
#[cfg(feature = "float")]
pub use float::{Camera, CameraError, Gaussian, Point, Surfel};
pub use format::{Classic8, Deep32, Lean18, Micro16, Standard24, Traversal};
pub use front::{
    BoundedList, Counts, DisplayList, Frame, LentList, ListFull, Primitive, Rejected, RenderError,
    Renderer, SurfaceRenderer,
};
pub use raster::Window;
pub use rules::{Compositing, Rules};
pub use view::View;

/// The README's example, compiled and run.
#[cfg(all(doctest, feature = "float"))]
#[doc = include_str!("../README.md")]
struct Readme;

/// FNV-1a of what a test computes, where the words are too many to be read.
#[cfg(test)]
fn digest(words: impl IntoIterator<Item = u64>) -> u64 {
    let words = words.into_iter();
    words.fold(0xcbf2_9ce4_8422_2325, |digest, word| {
        (digest ^ word).wrapping_mul(0x100_0000_01b3)
    })
}

/// Numbers that look random, the same at every call: what a digest is of.
#[cfg(test)]
fn random() -> impl FnMut() -> u64 {
    let mut state = 1u64;
    move || {
        state = state
            .wrapping_mul(0x5851_f42d_4c95_7f2d)
            .wrapping_add(0x1405_7b7e_f767_814f);
        (state ^ state >> 29)
            .wrapping_mul(0xbf58_476d_1ce4_e5b9)
            .rotate_left(32)
    }
}
