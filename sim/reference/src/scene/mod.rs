//! Scenes: what the loaders make of a file and both engines draw.
//!
//! | file | loader |
//! |---|---|
//! | `.ply` (plain and compressed), `.splat`, `.spz`, `.sog`, `.ksplat`, `.glb`, `.gltf` | 3D Gaussians, through one builder that checks and counts |
//! | `.nrrd`, `.nhdr` | volumes, classified by a [`transfer`] function and shaded per voxel by [`shade`] |
//! | `demo`, `random:COUNT[:SEED]`, `deep-stack` | no file: the embedded volume and [`synthetic`] scenes |

mod archive;
pub(crate) mod bytes;
mod error;
mod file;
mod gaussian;
mod gltf;
mod ksplat;
mod load;
mod nrrd;
mod order;
mod ply;
pub mod points;
mod quaternion;
pub mod shade;
mod sog;
mod splat_file;
mod spz;
pub mod synthetic;
pub mod transfer;
mod view;
mod volume;
mod weights;

#[cfg(test)]
mod damage_tests;
#[cfg(test)]
mod format_tests;
#[cfg(test)]
pub(crate) mod tests;

pub use error::{LoadError, Problem};
pub use load::{LoadOptions, demo, load};
pub use order::SortOrder;
pub use transfer::Transfer;
pub use view::Bounds;
pub(crate) use view::across;

use crate::camera::Camera;
use crate::rules::Rules;
use crate::vector;
pub(crate) use file::read_file;
use gaussian::CAPTURE_UP;
pub use gaussian::{Gaussian, HARMONIC_0, rotation_matrix};
use rayon::prelude::*;

/// What a splat's weight means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Weight {
    /// Peak opacity, 0 to 1 (captured Gaussians).
    Opacity,
    /// Extinction times volume, in square scene units (voxels; \[EWA\] 4.1: `g_k` times the voxel's volume).
    Mass,
}

/// One volume splat as the reference sees it: a 3D Gaussian of variance `sum_k a_k a_k^T`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Splat {
    /// Centre, scene units.
    pub centre: [f64; 3],
    /// Three axes, each one standard deviation long, scene units.
    pub axes: [[f64; 3]; 3],
    /// Peak opacity or mass, as [`Scene::weight`] says.
    pub weight: f64,
    /// Linear RGB without view-dependent harmonics, clamped at 0 from below.
    pub colour: [f64; 3],
}

impl Splat {
    /// An opaque sphere of this standard deviation.
    pub(crate) fn sphere(centre: [f64; 3], deviation: f64, colour: [f64; 3]) -> Splat {
        Splat {
            centre,
            axes: vector::diagonal([deviation; 3]),
            weight: 1.0,
            colour,
        }
    }
}

/// View-dependent colour: coefficients of degree 1 and up, per splat.
#[derive(Clone, Debug, PartialEq)]
pub struct Harmonics {
    /// 1 to 4.
    pub degree: u8,
    /// Per splat `(degree + 1)^2 - 1` RGB coefficients in the trainers' order.
    pub coefficients: Vec<[f32; 3]>,
    /// Colour of degree 0 before clamping, per splat.
    pub base: Vec<[f32; 3]>,
}

/// Records that a loader left out, by reason; shown in every report.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct Skipped {
    /// A field was NaN or infinite (an opacity logit of +inf is opacity 1 and is not skipped).
    pub non_finite: usize,
    /// The rotation quaternion was zero.
    pub zero_rotation: usize,
}

/// A set of splats with what is needed to draw them.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// File name without folders.
    pub name: String,
    /// The rules this kind of scene is meant for.
    pub natural_rules: Rules,
    /// Meaning of [`Splat::weight`].
    pub weight: Weight,
    /// The splats.
    pub splats: Vec<Splat>,
    /// View-dependent colour, if the file has any.
    pub harmonics: Option<Harmonics>,
    /// What the loader left out.
    pub skipped: Skipped,
    /// Default camera's up direction.
    pub up: [f64; 3],
    /// What its splats are sorted by.
    pub order: SortOrder,
    /// What its file says that is drawn otherwise here.
    pub notes: Vec<String>,
}

impl Scene {
    /// Splats whose colours do not depend on the view, of the weight that the rules work with; y points down.
    pub fn of_splats(name: impl Into<String>, natural_rules: Rules, splats: Vec<Splat>) -> Scene {
        Scene {
            name: name.into(),
            natural_rules,
            weight: if natural_rules.normalised {
                Weight::Mass
            } else {
                Weight::Opacity
            },
            splats,
            harmonics: None,
            skipped: Skipped::default(),
            up: CAPTURE_UP,
            order: SortOrder::Depth,
            notes: Vec::new(),
        }
    }

    /// Colours as seen by `camera`, clamped at 0 from below; on all cores.
    ///
    /// Harmonics are evaluated once per splat, for the direction from the eye to its centre, or for the direction of
    /// view if the projection is parallel.
    pub fn colours(&self, camera: &Camera) -> Vec<[f64; 3]> {
        let indices = (0..self.splats.len()).into_par_iter();
        indices.map(|index| self.colour(index, camera)).collect()
    }

    /// Leaves out harmonics of higher degrees than this.
    pub fn limit_harmonics(&mut self, degree: u8) {
        let Some(harmonics) = self.harmonics.as_mut().filter(|h| h.degree > degree) else {
            return;
        };
        let [before, after] = [harmonics.degree, degree].map(gaussian::coefficient_count);
        let splats = harmonics.coefficients.chunks(before);
        harmonics.coefficients = splats.flat_map(|all| &all[..after]).copied().collect();
        harmonics.degree = degree;
        if degree == 0 {
            self.harmonics = None;
        }
    }

    /// The colour of one splat; black if there is none of this number.
    pub fn colour(&self, index: usize, camera: &Camera) -> [f64; 3] {
        let Some(splat) = self.splats.get(index) else {
            return [0.0; 3];
        };
        let Some(harmonics) = &self.harmonics else {
            return splat.colour;
        };
        let count = gaussian::coefficient_count(harmonics.degree);
        let coefficients = harmonics
            .coefficients
            .get(index * count..(index + 1) * count)
            .unwrap_or_default();
        let base = harmonics.base.get(index).copied().unwrap_or_default();
        gaussian::colour(base, coefficients, direction_of_view(camera, splat.centre))
    }
}

/// Unit vector from the eye, `-R^T d`, to a place; zero at the eye itself, where only the constant colour is left.
fn direction_of_view(camera: &Camera, place: [f64; 3]) -> [f64; 3] {
    let Camera {
        rotation,
        translation,
        ..
    } = camera;
    if camera.orthographic {
        return rotation[2];
    }
    let from_eye: [f64; 3] = std::array::from_fn(|axis| {
        place[axis]
            + (0..3)
                .map(|row| rotation[row][axis] * translation[row])
                .sum::<f64>()
    });
    vector::unit(from_eye).unwrap_or([0.0; 3])
}
