//! Test vectors: what crosses every stage boundary of the kernel, as files that a hardware bench reads.
//!
//! ```text
//! splats -> camera -> projected -> columns -> covariance -> opacity -> packets -> runs -> pixels -> tile
//! ```
//!
//! A stage is a table: one record a line, its fields side by side without padding, least significant first, printed as
//! one hexadecimal number (`$readmemh` into a memory as wide as the record). The manifest says where every field lies.
//! All of it comes from the kernel; the only arithmetic here is placing bits.
//!
//! [`export`] writes a folder, [`verify`] computes everything anew from the folder's splats and finds the first
//! difference.

mod builtin;
mod compute;
mod constants;
mod explain;
mod files;
mod functions;
mod manifest;
mod record;
mod stage;
mod systems;
mod work;

pub use builtin::{hard_cases, stress_cases, stress_orthographic, stress_view};
pub use compute::compute;
pub use constants::ConstantRecord;
pub use explain::explain;
pub use files::{Verified, export, verify};
pub use manifest::{FORMAT_VERSION, Manifest};
pub use stage::{RecordField, VectorStage};
pub use work::room_for_splats;

use crate::design::DesignChoice;
use crate::rules::{Compositing, Rules};
use splatline::splat::VolumeSplat;
use splatline::view::View;

/// What the vectors are computed from.
#[derive(Clone, Debug)]
pub struct VectorSubject {
    /// Widths and traversal.
    pub design: DesignChoice,
    /// Rules of blending.
    pub rules: Rules,
    /// Order and operator.
    pub compositing: Compositing,
    /// The camera in the kernel's formats.
    pub view: View,
    /// The splats in the kernel's formats.
    pub splats: Vec<VolumeSplat>,
    /// Stages of the other systems instead of those of the picture.
    pub systems: bool,
}
