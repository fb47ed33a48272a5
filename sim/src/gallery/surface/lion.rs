//! A scanned cloud without holes.

use super::{GalleryError, draw_both, draw_fixed, exhibit};
use crate::camera::Camera;
use crate::gallery::Exhibit;
use crate::gallery::holes::{CLOSING, Mask, holes};
use crate::picture::Picture;
use crate::scene::points::{self, SurfacePoint, SurfaceScene};
use crate::surface::Style;
use crate::vector;
use std::path::Path;

const EYE: [f64; 3] = [4.11, 3.88, -0.16];
const TARGET: [f64; 3] = [-2.89, 3.88, -1.16];
/// Direction towards the light of the shaded picture.
const LIGHT: [f64; 3] = [1.0, -0.5, 1.0];

/// The stone lion at two sizes, with its colours and shaded.
pub fn lion(folder: &Path) -> Result<Exhibit, GalleryError> {
    let scene = points::load(&folder.join("lion_takanawa.ply"))?;
    let mut exhibit = exhibit(
        "A scanned surface without holes",
        "[SURF] eq. 8 and 9, section 4 (systems 2, 9 and 10)",
        &format!(
            "341,989 points of the stone lion of Takanawa (Potree's example cloud), radii from the six nearest neighbours, opaque, drawn in the \
             file's order without sorting: as scanned, and shaded by Phong. A hole is a pixel that no splat touches, not connected with the \
             background, and covered by a closing with a disc of {CLOSING} pixels. A pixel is see-through if a back side is what it shows."
        ),
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
        count_back_sides(&mut exhibit, &scene, &camera, &style);
        exhibit
            .pictures
            .push((format!("lion_{size}"), plain.picture));
        exhibit
            .pictures
            .push((format!("lion_{size}_shaded"), shaded.picture));
    }
    Ok(exhibit)
}

fn count_holes(exhibit: &mut Exhibit, size: usize, weights: &[f64]) {
    let covered = Mask {
        width: size,
        pixels: weights.iter().map(|weight| *weight > 0.0).collect(),
    };
    exhibit.number(
        format!("{size}: covered pixels"),
        covered.count() as f64,
        "",
    );
    exhibit.number(
        format!("{size}: hole pixels"),
        holes(&covered).count() as f64,
        "",
    );
}

/// Draws front sides white and back sides black: a grey below one half shows more back than front.
fn count_back_sides(exhibit: &mut Exhibit, scene: &SurfaceScene, camera: &Camera, style: &Style) {
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
    let back = picture
        .pixels
        .iter()
        .filter(|[r, _, _, a]| *a > 0.0 && *r < 0.5);
    let size = camera.width;
    exhibit.number(
        format!("{size}: see-through pixels"),
        back.count() as f64,
        "",
    );
}
