//! Hybrid image warping and texture mapping (\[HYBRID\] 3): depth images and textures as samples that another view
//! draws as points or splats.
//!
//! A pixel of a depth image, and a texel on a plane, is a sample in space as a voxel is: a sphere of standard deviation
//! 0.82 spacings with the pixel's colour. The spacing of neighbouring samples is what one pixel spans at the sample's
//! depth, z / f. Seen from elsewhere the samples go through the choice of [`crate::hybrid`]: closer together than
//! pixels they become points, otherwise they stay splats.
//!
//! Samples are opaque at their centres, and points within a depth range are summed before they are composited, so that
//! a surface is averaged and not hidden by its own nearest samples.

use super::Texture;
use crate::camera::Camera;
use crate::engines::surface::{FloatFragment, FloatSurfaceDrawing};
use crate::hybrid::DEVIATION_PER_SPACING;
use crate::scene::points::spheres;
use crate::scene::{Scene, Splat};
use crate::vector::{self, Vector};

/// Samples of one surface lie within so many spacings of depth in a pixel.
pub const DEPTH_RANGE: f64 = 8.0;

/// A pixel of a rendered surface belongs to the depth image from this weight sum on: tau of \[SURF\] 7.
const COVERED: f64 = crate::surface::USUAL_EDGE;

/// Colours with the depths at which they were seen.
#[derive(Clone, Debug, PartialEq)]
pub struct DepthImage {
    /// Who saw them.
    pub camera: Camera,
    /// Per pixel, row-major: linear RGB and camera-space z; none where there was nothing.
    pub pixels: Vec<Option<([f64; 3], f64)>>,
}

impl DepthImage {
    /// The nearest surface of a drawing, unlit, where it covers the pixel.
    pub fn of_drawing(drawing: &FloatSurfaceDrawing, camera: &Camera) -> DepthImage {
        let seen = |fragment: &FloatFragment| {
            let [near, far] = fragment.range;
            let colour = fragment.colour.map(|sum| sum / fragment.weight);
            (fragment.weight >= COVERED).then_some((colour, 0.5 * (near + far)))
        };
        DepthImage {
            camera: camera.clone(),
            pixels: drawing
                .fragments
                .iter()
                .map(|pixel| pixel.first().and_then(seen))
                .collect(),
        }
    }

    /// The samples in space.
    pub fn samples(&self, name: &str) -> Scene {
        let camera = &self.camera;
        let seen = self.pixels.iter().enumerate();
        let splats = seen.filter_map(|(index, pixel)| {
            let (colour, depth) = (*pixel)?;
            let place = [index % camera.width, index / camera.width].map(|c| c as f64 + 0.5);
            let scale = if camera.orthographic { 1.0 } else { depth };
            let spacing = scale / (camera.fx * camera.fy).sqrt();
            Some(sample(in_space(camera, place, depth), spacing, colour))
        });
        scene(name, splats.collect())
    }
}

/// The texels of a texture on the parallelogram of `corner`, `across` its columns and `down` its rows.
pub fn textured_plane(
    name: &str,
    texture: &Texture,
    corner: Vector,
    [across, down]: [Vector; 2],
) -> Scene {
    let step = |axis: Vector, count: usize| vector::scale(1.0 / count as f64, axis);
    let (right, below) = (step(across, texture.width), step(down, texture.height));
    let spacing = (vector::length(right) * vector::length(below)).sqrt();
    let texels = texture.texels.iter().enumerate();
    let splats = texels.map(|(index, colour)| {
        let [x, y] = [index % texture.width, index / texture.width].map(|c| c as f64 + 0.5);
        let offset = vector::add(vector::scale(x, right), vector::scale(y, below));
        sample(vector::add(corner, offset), spacing, *colour)
    });
    scene(name, splats.collect())
}

/// Where a place of the picture lies in space at a depth: W^-1 (t - d).
fn in_space(camera: &Camera, place: [f64; 2], depth: f64) -> Vector {
    let [x, y] = camera.slopes(place);
    let seen = if camera.orthographic {
        [x, y, depth]
    } else {
        [x * depth, y * depth, depth]
    };
    let offset = vector::subtract(seen, camera.translation);
    // The rotation's inverse is its transpose.
    let column = |axis: usize| camera.rotation.map(|row| row[axis]);
    [0, 1, 2].map(|axis| vector::dot(column(axis), offset))
}

/// Its surface is opaque: less would leave the surface transparent (docs/systems.md).
fn sample(centre: Vector, spacing: f64, colour: [f64; 3]) -> Splat {
    Splat::sphere(centre, DEVIATION_PER_SPACING * spacing, colour)
}

fn scene(name: &str, splats: Vec<Splat>) -> Scene {
    Scene {
        up: [0.0, 0.0, 1.0],
        ..Scene::of_splats(name, spheres::RULES, splats)
    }
}
