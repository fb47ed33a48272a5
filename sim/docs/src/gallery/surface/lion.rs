//! A scanned cloud without holes.

use super::{GalleryError, draw_both, draw_fixed, exhibit, on_paper};
use crate::gallery::Exhibit;
use crate::gallery::holes::{HoleMask, holes};
use splatline_sim::camera::Camera;
use splatline_sim::picture::Picture;
use splatline_sim::scene::points::{self, SurfacePoint, SurfaceScene};
use splatline_sim::surface::Style;
use splatline_sim::vector;
use std::path::Path;

const EYE: [f64; 3] = [4.11, 3.88, -0.16];
const TARGET: [f64; 3] = [-2.89, 3.88, -1.16];
/// Direction towards the light of the shaded picture.
const LIGHT: [f64; 3] = [1.0, -0.5, 1.0];

/// Radius of the closing in picture widths: about one and a half sample spacings of the scan.
const CLOSING: f64 = 1.5 / 512.0;
/// Outline of statue and pedestal in 1024ths of the picture, inside of the foliage, the open mouth and the border of the scan.
const OUTLINE: [[f64; 2]; 22] = [
    [290.0, 115.0],
    [400.0, 95.0],
    [500.0, 105.0],
    [555.0, 140.0],
    [600.0, 290.0],
    [735.0, 370.0],
    [805.0, 450.0],
    [825.0, 560.0],
    [848.0, 650.0],
    [838.0, 740.0],
    [838.0, 960.0],
    [300.0, 960.0],
    [290.0, 740.0],
    [282.0, 660.0],
    [302.0, 600.0],
    [335.0, 570.0],
    [380.0, 545.0],
    [412.0, 450.0],
    [368.0, 340.0],
    [368.0, 270.0],
    [285.0, 245.0],
    [278.0, 170.0],
];
/// The room between the legs, first and last corner, where foliage is seen.
const BETWEEN_LEGS: [[f64; 2]; 2] = [[480.0, 490.0], [640.0, 625.0]];

/// The stone lion at two sizes, with its colours and shaded.
pub fn lion(cloud: &Path) -> Result<Exhibit, GalleryError> {
    let scene = points::load(cloud)?;
    let mut exhibit = exhibit(
        "A scanned surface without holes",
        "[SURF] eq. 8 and 9, section 4 (systems 2, 9 and 10)",
        "341,989 points of the stone lion of Takanawa (Potree's example cloud), radii from the six nearest neighbours, opaque, drawn in the \
         file's order without sorting: as scanned, and shaded by Phong. A hole is a region that no splat touches, apart from the picture's edge, and \
         narrow enough for a closing of one and a half sample spacings. Holes are counted in the whole picture, where the foliage, the \
         open mouth and the ragged border of the scan have gaps of their own, and inside an outline of statue and pedestal. See-through \
         pixels of that outline show a back side.",
    );
    for size in [512, 1024] {
        let camera = Camera::look_at(EYE, TARGET, scene.up, 45.0, size, size)?;
        let style = Style::opaque(scene.usual_threshold());
        let (plain, _) = draw_both(&mut exhibit, &format!("{size}"), &scene, &camera, &style)?;
        let lit = Style {
            light: Some(LIGHT),
            ..style
        };
        let (shaded, _) = draw_both(
            &mut exhibit,
            &format!("{size} shaded"),
            &scene,
            &camera,
            &lit,
        )?;
        count_holes(&mut exhibit, size, &plain.weights);
        let back = back_sides(&scene, &camera, &style);
        exhibit.number(
            format!("{size}: see-through pixels of the statue"),
            statue(&back),
            "",
        );
        let (name, shown) = match size {
            512 => ("lion_512", &plain.picture),
            _ => ("lion_1024_shaded", &shaded.picture),
        };
        exhibit.pictures.push((name.to_owned(), on_paper(shown)));
    }
    Ok(exhibit)
}

fn count_holes(exhibit: &mut Exhibit, size: usize, weights: &[f64]) {
    let covered = HoleMask {
        width: size,
        pixels: weights.iter().map(|weight| *weight > 0.0).collect(),
    };
    let holes = holes(&covered, CLOSING * size as f64);
    exhibit.number(
        format!("{size}: covered pixels"),
        covered.count() as f64,
        "",
    );
    exhibit.number(format!("{size}: median weight sum"), median(weights), "");
    exhibit.number(
        format!("{size}: hole pixels of the picture"),
        holes.count() as f64,
        "",
    );
    exhibit.number(
        format!("{size}: pixels of the statue"),
        statue(&all(size)),
        "",
    );
    exhibit.number(
        format!("{size}: hole pixels of the statue"),
        statue(&holes),
        "",
    );
}

/// The median of the weight sums that are not 0.
fn median(weights: &[f64]) -> f64 {
    let mut covered: Vec<f64> = weights.iter().copied().filter(|w| *w > 0.0).collect();
    splatline_sim::metrics::median(&mut covered).unwrap_or(0.0)
}

fn all(size: usize) -> HoleMask {
    HoleMask {
        width: size,
        pixels: vec![true; size * size],
    }
}

/// Pixels of the mask inside the statue's outline.
fn statue(mask: &HoleMask) -> f64 {
    let scale = 1024.0 / mask.width as f64;
    let inside = |index: usize| {
        let place = [index % mask.width, index / mask.width].map(|c| (c as f64 + 0.5) * scale);
        is_inside(place) && mask.pixels[index]
    };
    (0..mask.pixels.len())
        .filter(|index| inside(*index))
        .count() as f64
}

/// Even-odd rule, without the room between the legs.
fn is_inside([x, y]: [f64; 2]) -> bool {
    let [[x0, y0], [x1, y1]] = BETWEEN_LEGS;
    if (x0..x1).contains(&x) && (y0..y1).contains(&y) {
        return false;
    }
    let next = OUTLINE.iter().cycle().skip(1);
    let crossed = |(a, b): &(&[f64; 2], &[f64; 2])| {
        (a[1] > y) != (b[1] > y) && x < a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
    };
    OUTLINE.iter().zip(next).filter(crossed).count() % 2 == 1
}

/// Draws front sides white and back sides black: a grey below one half shows more back than front.
fn back_sides(scene: &SurfaceScene, camera: &Camera, style: &Style) -> HoleMask {
    let side = |point: &SurfacePoint| {
        let normal = vector::transform(&camera.rotation, point.normal);
        let front = vector::dot(normal, camera.to_camera(point.centre)) < 0.0;
        SurfacePoint {
            colour: [if front { 1.0 } else { 0.0 }; 3],
            ..*point
        }
    };
    let sides = SurfaceScene {
        points: scene.points.iter().map(side).collect(),
        ..scene.clone()
    };
    let picture: Picture = draw_fixed(&sides, camera, style).picture;
    HoleMask {
        width: camera.width,
        pixels: picture
            .pixels
            .iter()
            .map(|[r, _, _, a]| *a > 0.0 && *r < 0.5)
            .collect(),
    }
}
