//! View-dependent colours by the kernel's unit, for whoever asks how far it is from double precision.
//!
//! Drawing takes its colours from the reference, in double precision: a frame's colours are part of its scene there.
//! This is the way of a machine that evaluates them itself ([`splatline::setup::harmonics`]).

use super::quantise::{position, view};
use crate::camera::Camera;
use crate::scene::Scene;
use fixed::types::U4F28;
use rayon::prelude::*;
use splatline::float::coefficient;
use splatline::format::Widths;
use splatline::setup::harmonics::{Harmonics, direction};

/// The splats' colours as `camera` sees them, in the scene's order; none for a scene without harmonics.
pub fn harmonic_colours(
    scene: &Scene,
    camera: &Camera,
    widths: &Widths,
) -> Option<Vec<[U4F28; 3]>> {
    let harmonics = scene.harmonics.as_ref()?;
    let count = (usize::from(harmonics.degree) + 1).pow(2) - 1;
    let view = view(camera, 0);
    let fixed = |colour: &[f32; 3]| colour.map(|channel| coefficient(channel.into()));
    let parts = harmonics.coefficients.par_chunks_exact(count);
    let splats = scene
        .splats
        .par_iter()
        .zip(harmonics.base.par_iter())
        .zip(parts);
    let colours = splats.map(|((splat, base), part)| {
        let coefficients: Vec<_> = part.iter().map(fixed).collect();
        let harmonics = Harmonics {
            base: fixed(base),
            coefficients: &coefficients,
        };
        harmonics.colour(direction(widths, &view, &position(splat.centre, 0)))
    });
    Some(colours.collect())
}
