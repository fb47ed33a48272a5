//! Volumes to splats: classification and shading per voxel, before any projection (\[EWA\] 7.1, \[SWAN\] 5).
//!
//! A voxel at grid place (i, j, k) lies at `(i + 0.5) * spacing` along each axis, with the origin at the volume's
//! corner. Its extinction is the transfer function's; voxels without any give no splat. Its mass is extinction times
//! voxel volume and its kernel a Gaussian of [`SIGMA`] voxels along each grid axis, so that a uniform volume is
//! reconstructed as (nearly) the same uniform extinction. Colours are shaded by Phong's model with the
//! central-difference gradient as the normal, for one distant light and a viewer looking along +z.

use super::error::Problem;
use super::transfer::{Shading, Transfer};
use super::volume::Volume;
use super::{Scene, Skipped, Splat};
use crate::memory;
use crate::rules::Rules;
use crate::vector::{diagonal, dot, length, unit};
use anyhow::{Context, ensure};

/// Standard deviation of a voxel's kernel, in voxels.
///
/// Overlapping kernels must sum to nearly a constant. For a sheet of equal voxels seen face on and magnified, whole
/// Gaussians of 0.7 ripple by 0.02 % already; but the rules cut footprints off at two deviations, and then the ripple
/// (root mean square, relative) is 6.8 % at 0.5, 4.8 % at 0.7 and 2.4 % at 0.82, where it has a minimum that only
/// kernels beyond one voxel beat, at twice the pixels. A test measures this. The cut-off also takes away
/// `e^-2 = 13.5 %` of every kernel's mass, whatever its width.
pub const SIGMA: f64 = 0.82;

/// Direction towards the default light: over the viewer's left shoulder (x right, y down, z away).
pub const DEFAULT_LIGHT: [f64; 3] = [-0.45, -0.65, -0.8];

/// Direction towards the viewer for whom the highlights are placed.
const TOWARDS_VIEWER: [f64; 3] = [0.0, 0.0, -1.0];

/// Mean of the clamped cosine over all directions of a hemisphere: diffuse light without a normal.
const MEAN_COSINE: f64 = 0.5;

/// Splats of a volume; `light` points towards the light.
pub(super) fn shade(
    volume: &Volume,
    transfer: &Transfer,
    light: [f64; 3],
    name: &str,
) -> Result<Scene, Problem> {
    let lamp = Lamp::new(light)?;
    let mut splats = Vec::new();
    let mut skipped = Skipped::default();
    for (index, &value) in volume.values.iter().enumerate() {
        if !value.is_finite() {
            skipped.non_finite += 1;
            continue;
        }
        let (colour, plain_extinction) = transfer.at_value(value.into());
        if plain_extinction <= 0.0 {
            continue;
        }
        let place = volume.place(index);
        let gradient = volume.gradient(place, index);
        let extinction = plain_extinction * transfer.at_gradient(length(gradient));
        if extinction > 0.0 {
            let colour = lamp.phong(colour, gradient, &transfer.shading);
            let splat = splat(volume, place, extinction, colour);
            memory::push(&mut splats, splat, "the splats of visible voxels")?;
        }
    }
    ensure!(
        !splats.is_empty(),
        "transfer function: it leaves no voxel visible ({} were not finite); \
         give a transfer function with extinction within the data's range",
        skipped.non_finite
    );
    Ok(Scene {
        skipped,
        notes: volume.notes.clone(),
        ..Scene::of_splats(name, Rules::EWA, splats)
    })
}

fn splat(volume: &Volume, place: [usize; 3], extinction: f64, colour: [f64; 3]) -> Splat {
    let [x, y, z] = volume.spacings;
    Splat {
        centre: [0, 1, 2].map(|axis| (place[axis] as f64 + 0.5) * volume.spacings[axis]),
        axes: diagonal(volume.spacings.map(|spacing| SIGMA * spacing)),
        weight: extinction * x * y * z,
        colour,
    }
}

impl Volume {
    /// Smallest and greatest finite value, if there is one.
    pub(super) fn range(&self) -> Option<(f64, f64)> {
        let finite = self
            .values
            .iter()
            .copied()
            .filter(|value| value.is_finite());
        finite.fold(None, |range, value| {
            let value = f64::from(value);
            let (least, greatest) = range.unwrap_or((value, value));
            Some((value.min(least), value.max(greatest)))
        })
    }

    /// Grid place of a value.
    fn place(&self, index: usize) -> [usize; 3] {
        let [columns, rows, _] = self.sizes;
        [
            index % columns,
            index / columns % rows,
            index / columns / rows,
        ]
    }

    /// Central differences in data units per scene unit; one-sided at the border and beside values that are not finite.
    fn gradient(&self, place: [usize; 3], index: usize) -> [f64; 3] {
        let strides = [1, self.sizes[0], self.sizes[0] * self.sizes[1]];
        [0, 1, 2].map(|axis| {
            let before = (place[axis] > 0).then(|| self.values[index - strides[axis]]);
            let after =
                (place[axis] + 1 < self.sizes[axis]).then(|| self.values[index + strides[axis]]);
            let before = before.filter(|value| value.is_finite());
            let after = after.filter(|value| value.is_finite());
            let steps = u8::from(before.is_some()) + u8::from(after.is_some());
            if steps == 0 {
                return 0.0;
            }
            let here = self.values[index];
            let rise = f64::from(after.unwrap_or(here)) - f64::from(before.unwrap_or(here));
            rise / (f64::from(steps) * self.spacings[axis])
        })
    }
}

/// A distant light and the half-way direction to the viewer.
struct Lamp {
    towards: [f64; 3],
    half_way: [f64; 3],
}

impl Lamp {
    fn new(light: [f64; 3]) -> Result<Lamp, Problem> {
        let towards = unit(light).with_context(|| {
            format!("light: {light:?} is no direction; give three finite numbers, not all zero")
        })?;
        let sum = [0, 1, 2].map(|axis| towards[axis] + TOWARDS_VIEWER[axis]);
        // A light straight behind the volume has no half-way direction and gives no highlight.
        Ok(Lamp {
            towards,
            half_way: unit(sum).unwrap_or([0.0; 3]),
        })
    }

    /// Phong's model. The normal runs against the gradient, out of the denser material.
    fn phong(&self, colour: [f64; 3], gradient: [f64; 3], shading: &Shading) -> [f64; 3] {
        let normal = unit(gradient).map(|direction| direction.map(|part| -part));
        let surface = match normal {
            Some(_) if shading.surface > 0.0 => (length(gradient) / shading.surface).min(1.0),
            Some(_) => 1.0,
            None => 0.0,
        };
        let normal = normal.unwrap_or([0.0; 3]);
        let cosine = surface * dot(normal, self.towards).max(0.0) + (1.0 - surface) * MEAN_COSINE;
        let highlight =
            surface * shading.specular * dot(normal, self.half_way).max(0.0).powf(shading.exponent);
        let highlight = if dot(normal, self.towards) > 0.0 {
            highlight
        } else {
            0.0
        };
        colour.map(|channel| {
            (channel * (shading.ambient + shading.diffuse * cosine) + highlight).min(1.0)
        })
    }
}

#[cfg(test)]
#[path = "shade_tests.rs"]
mod tests;
