//! A checkerboard texture on a plane to the horizon, its texels drawn as points or splats.

use super::super::Exhibit;
use super::super::surface::{GalleryError, exhibit};
use super::draw_samples;
use splatline_sim::camera::Camera;
use splatline_sim::hybrid::{Hybrid, Points};
use splatline_sim::picture::Picture;
use splatline_sim::texture::Texture;
use splatline_sim::texture::warp::{DEPTH_RANGE, textured_plane};

/// Texels along each side; one is a scene unit.
const TEXELS: usize = 512;
/// Texels of a field.
const FIELD: f64 = 16.0;
/// Height of the eye over the plane, and focal length: the distance k of a spacing of 1.
const HEIGHT: f64 = 40.0;
const FOCAL: f64 = 130.0;
const SIZE: [usize; 2] = [240, 160];
/// Row of the horizon.
const HORIZON: f64 = -4.0;
/// The plane begins here; the texture's far border lies at this plus [`TEXELS`].
const BEGIN: f64 = 30.0;
/// Samples per pixel and axis of the truth.
const SUPERSAMPLING: usize = 8;
/// Columns of the picture whose pixels see the plane only.
const COLUMNS: [usize; 2] = [20, 220];
/// Rows that see the plane beyond k, where texels are minified, and nearer.
const ROWS: [(&str, [usize; 2]); 2] = [("beyond k", [12, 35]), ("nearer", [37, 156])];

/// Name, choice, and depth range within which points are summed, in spacings.
const MODES: [(&str, Points, f64); 4] = [
    ("all splats", Points::None, DEPTH_RANGE),
    ("all points, range 64", Points::All, 64.0),
    ("mixed, range 8", Points::Auto, DEPTH_RANGE),
    ("mixed, range 64", Points::Auto, 64.0),
];

/// The choices side by side.
pub fn textured() -> Result<Exhibit, GalleryError> {
    let mut exhibit = exhibit(
        "A texture on a plane to the horizon",
        "[HYBRID] section 3 (system 17)",
        "512 x 512 texels with fields of 16, one unit apart, seen from a height of 40 by a focal length of 130 pixels: nearer than 130 units texels \
         are magnified. Truth is the texture under a Gaussian pixel filter of unit variance, 64 samples per pixel; unfiltered is its value at the pixels' centres. Where a pixel sees many texels \
         in depth, the range within which points are summed must reach over them, or the nearest hide the others.",
    );
    let texture = Texture::from_pattern(TEXELS, TEXELS, |u, v| [shade(u, v); 3]);
    // x to the right, y down, z into the picture, as in camera space.
    let side = TEXELS as f64;
    let corner = [-0.5 * side, HEIGHT, BEGIN];
    let plane = textured_plane(
        "plane",
        &texture,
        corner,
        [[side, 0.0, 0.0], [0.0, 0.0, side]],
    );
    let camera = camera();
    let truth = filtered(&camera);
    for (mode, points, range) in MODES {
        let hybrid = Hybrid {
            points,
            depth_range: Some(range),
            phase_bits: None,
        };
        let [fixed, _] = draw_samples(&mut exhibit, mode, &plane, &camera, &hybrid)?;
        against(&mut exhibit, mode, &fixed, &truth);
        exhibit.pictures.push((mode.to_owned(), fixed));
    }
    let unfiltered = sampled(&camera);
    against(&mut exhibit, "unfiltered", &unfiltered, &truth);
    exhibit.pictures.push(("unfiltered".to_owned(), unfiltered));
    exhibit.pictures.push(("truth".to_owned(), truth));
    Ok(exhibit)
}

fn camera() -> Camera {
    Camera {
        width: SIZE[0],
        height: SIZE[1],
        fx: FOCAL,
        fy: FOCAL,
        cx: 0.5 * SIZE[0] as f64 + 0.137,
        cy: HORIZON,
        rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        translation: [0.0; 3],
        near: 0.01,
        far: 1e10,
        orthographic: false,
    }
}

fn shade(u: f64, v: f64) -> f64 {
    let number = (u / FIELD).floor() + (v / FIELD).floor();
    if number.rem_euclid(2.0) == 0.0 {
        0.1
    } else {
        0.9
    }
}

/// What a ray through a place of the screen sees of the texture.
fn seen(camera: &Camera, x: f64, y: f64) -> f64 {
    let depth = HEIGHT * camera.fy / (y - camera.cy);
    let u = (x - camera.cx) / camera.fx * depth + 0.5 * TEXELS as f64;
    shade(u, depth - BEGIN)
}

fn sampled(camera: &Camera) -> Picture {
    picture(camera, |x, y| seen(camera, x, y))
}

/// Under the Gaussian of unit variance, to three deviations.
fn filtered(camera: &Camera) -> Picture {
    let steps = 3 * SUPERSAMPLING as i32;
    let offset = |k: i32| (f64::from(k) + 0.5) / SUPERSAMPLING as f64;
    picture(camera, |x, y| {
        let (mut sum, mut value) = (0.0, 0.0);
        for dy in (-steps..steps).map(offset) {
            for dx in (-steps..steps).map(offset) {
                let weight = (-0.5 * (dx * dx + dy * dy)).exp();
                sum += weight;
                value += weight * seen(camera, x + dx, y + dy);
            }
        }
        value / sum
    })
}

fn picture(camera: &Camera, value: impl Fn(f64, f64) -> f64) -> Picture {
    let mut picture = Picture::new(camera.width, camera.height);
    for (index, pixel) in picture.pixels.iter_mut().enumerate() {
        let place = [index % camera.width, index / camera.width].map(|c| c as f64 + 0.5);
        let value = value(place[0], place[1]);
        *pixel = [value, value, value, 1.0];
    }
    picture
}

/// Distance from the truth in the pixels that see the plane, beyond k and nearer.
fn against(exhibit: &mut Exhibit, what: &str, found: &Picture, truth: &Picture) {
    for (part, [first, last]) in ROWS {
        let columns = COLUMNS[0]..COLUMNS[1];
        let indices = (first..last).flat_map(|y| columns.clone().map(move |x| y * truth.width + x));
        let indices: Vec<usize> = indices.collect();
        let differences = || {
            let both = |&index: &usize| found.pixels[index][0] - truth.pixels[index][0];
            indices.iter().map(both)
        };
        let count = indices.len() as f64;
        let squares = differences().map(|d| d * d).sum::<f64>() / count;
        let largest = differences().fold(0.0, |largest: f64, d| largest.max(d.abs()));
        let bias = differences().sum::<f64>() / count;
        let what = format!("{what}, {part}, against truth");
        exhibit.number(format!("{what}: PSNR"), -10.0 * squares.log10(), "dB");
        exhibit.number(format!("{what}: largest error"), largest, "");
        exhibit.number(format!("{what}: bias"), bias, "");
    }
}
