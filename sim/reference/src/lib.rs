//! What a picture is and what it should look like, in double precision: scenes and cameras of all formats, the rules of
//! blending, pictures and their differences, and the float reference.
//!
//! A crate of its own, so that the reference cannot share a line with the fixed-point kernel that is measured against
//! it: it does not depend on that kernel. Data flows down this list:
//!
//! ```text
//! vector, memory, input, atomic     small tools: vectors, room in memory, files read within limits or written whole
//! rules, camera, cameras, framing   how splats blend; one camera, other people's, one for a scene without any
//! scene, texture                    what is drawn: readers of every format, colours of textured points
//! surface, sheets, hybrid           settings of those systems
//! picture, metrics                  pictures, their files, and how two of them differ
//! engines                           the float reference and the exact integral; exact rationals and single precision
//!                                   for comparison
//! hard                              scenes and splats that break arithmetic
//! ```

pub mod atomic;
pub mod camera;
pub mod cameras;
pub mod engines;
pub mod flip;
pub mod framing;
// Its quaternions come from golden, which reads an archive; a page needs neither.
#[cfg(not(target_family = "wasm"))]
pub mod hard;
pub mod hybrid;
pub mod input;
pub mod memory;
pub mod metrics;
pub mod picture;
pub mod rules;
pub mod scene;
pub mod sheets;
pub mod surface;
pub mod texture;
pub mod vector;
