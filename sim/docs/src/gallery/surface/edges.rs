//! A silhouette with and without edge antialiasing, against the sphere that the points sample.

use super::{GalleryError, draw_both, exhibit, on_paper};
use crate::gallery::Exhibit;
use splatline_sim::camera::Camera;
use splatline_sim::picture::Picture;
use splatline_sim::scene::points::synthetic::{Paint, scene, sphere};
use splatline_sim::surface::Style;

/// Samples per pixel and direction of the true coverage.
const SAMPLES: usize = 16;
const RADIUS: f64 = 1.0;
const DISTANCE: f64 = 6.0;

/// A sphere in front of nothing.
pub fn edges() -> Result<Exhibit, GalleryError> {
    let ball = scene(
        "sphere",
        sphere([0.0; 3], RADIUS, 24_000, Paint::opaque([0.9, 0.75, 0.5])),
    );
    let camera = Camera::look_at([0.0, -DISTANCE, 0.0], [0.0; 3], ball.up, 22.0, 160, 160)?;
    let mut exhibit = exhibit(
        "Edge antialiasing",
        "[SURF] section 7, tau = 0.4 (system 12)",
        "The silhouette of a sphere of 24,000 points without and with coverage from the weight sum. Truth is the analytic sphere with 256 samples \
         per pixel. A step is a pixel pair across the silhouette whose alpha jumps by more than 0.9.",
    );
    let truth = true_coverage(&camera);
    let plain = Style::opaque(3.0 * ball.radius);
    for (name, style) in [
        ("without", plain),
        (
            "with",
            Style {
                edge: Some(0.4),
                ..plain
            },
        ),
    ] {
        let (drawing, _) = draw_both(&mut exhibit, name, &ball, &camera, &style)?;
        let alpha: Vec<f64> = drawing
            .picture
            .pixels
            .iter()
            .map(|pixel| pixel[3])
            .collect();
        let edge: Vec<f64> = alpha
            .iter()
            .zip(&truth)
            .filter(|(a, t)| **a != **t)
            .map(|(a, t)| a - t)
            .collect();
        let square = edge.iter().map(|e| e * e).sum::<f64>();
        exhibit.number(
            format!("{name}: sum of squared coverage errors"),
            square,
            "pixels",
        );
        exhibit.number(
            format!("{name}: area error"),
            edge.iter().sum::<f64>(),
            "pixels",
        );
        exhibit.number(
            format!("{name}: steps"),
            steps(&alpha, camera.width) as f64,
            "",
        );
        exhibit.pictures.push((
            format!("edge_{name}"),
            enlarged(&on_paper(&drawing.picture), 4),
        ));
    }
    exhibit.number("truth: steps", steps(&truth, camera.width) as f64, "");
    Ok(exhibit)
}

/// Part of each pixel inside the sphere's outline: a ray hits it if its angle to the axis is below asin(R / D).
fn true_coverage(camera: &Camera) -> Vec<f64> {
    let sine = RADIUS / DISTANCE;
    let limit = sine * sine / (1.0 - sine * sine);
    let inside = |u: f64, v: f64| {
        let (x, y) = ((u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy);
        x * x + y * y < limit
    };
    let pixel = |index: usize| {
        let (x, y) = ((index % camera.width) as f64, (index / camera.width) as f64);
        let at = |k: usize| (k as f64 + 0.5) / SAMPLES as f64;
        let all = (0..SAMPLES * SAMPLES).map(|k| (x + at(k % SAMPLES), y + at(k / SAMPLES)));
        all.filter(|(u, v)| inside(*u, *v)).count() as f64 / (SAMPLES * SAMPLES) as f64
    };
    (0..camera.width * camera.height).map(pixel).collect()
}

/// Horizontal neighbours whose values differ by more than 0.9.
fn steps(alpha: &[f64], width: usize) -> usize {
    let rows = alpha.chunks(width);
    rows.map(|row| {
        row.windows(2)
            .filter(|pair| (pair[0] - pair[1]).abs() > 0.9)
            .count()
    })
    .sum()
}

/// The picture's upper left part, each pixel as a block.
fn enlarged(picture: &Picture, factor: usize) -> Picture {
    let (width, height) = (picture.width / 2, picture.height / 2);
    let mut large = Picture::new(width * factor, height * factor);
    for (index, pixel) in large.pixels.iter_mut().enumerate() {
        let (x, y) = (
            index % (width * factor) / factor,
            index / (width * factor) / factor,
        );
        *pixel = picture.pixels[y * picture.width + x];
    }
    large
}
