//! A depth image drawn from two other views.

use super::super::Exhibit;
use super::super::surface::{GalleryError, exhibit, on_paper};
use super::{draw_samples, terrain, without};
use splatline_sim::camera::Camera;
use splatline_sim::hybrid::Points;
use splatline_sim::picture::Picture;
use splatline_sim::reference;
use splatline_sim::scene::points::height_field::USUAL_SPACING;
use splatline_sim::surface::Style;
use splatline_sim::texture::coefficients::Method;
use splatline_sim::texture::drape::drape;
use splatline_sim::texture::warp::{DepthImage, hybrid};
use std::path::Path;

const NAME: &str = "A depth image warped to two other views";
const EQUATION: &str = "[HYBRID] section 3 (system 17)";

const TARGET: [f64; 3] = [0.0, -2.0, 1.0];
/// Where the depth image is taken.
const SOURCE: [f64; 3] = [0.0, -16.0, 26.0];
/// Where it is seen from.
const VIEWS: [(&str, [f64; 3]); 2] = [("near", [5.0, -15.0, 9.0]), ("far", [-14.0, -36.0, 34.0])];

/// The height field photographed from high up, its depth image seen from near and from far.
pub fn depth_image(data: &Path) -> Result<Exhibit, GalleryError> {
    let Some((field, photograph)) = terrain::load(data)? else {
        return Ok(without(NAME, EQUATION, &data.join("terrain/vtkjs_dem.csv")));
    };
    let mut exhibit = exhibit(
        NAME,
        EQUATION,
        "The first picture is the depth image, the height field drawn by the reference with its depths kept. Its pixels are samples in \
         space, seen from nearer and from farther away: where they are minified they become points, where they are magnified they stay \
         splats. Truth is the height field itself drawn from there; what the depth image did not see stays open (white).",
    );
    let style = Style::opaque(3.0 * USUAL_SPACING);
    let scene = drape(
        &field,
        "vtkjs_dem",
        &photograph,
        Method::Plain,
        style.cutoff,
    )?
    .scene;
    let look = |eye, width, height| Camera::look_at(eye, TARGET, scene.up, 45.0, width, height);
    let source = look(SOURCE, 480, 360)?;
    let seen = reference::surface::draw(&scene, &source, &style);
    let samples = DepthImage::of_drawing(&seen, &source).samples("depth image");
    exhibit
        .pictures
        .push(("depth image".to_owned(), on_paper(&seen.picture)));
    for (name, eye) in VIEWS {
        let camera = look(eye, 480, 360)?;
        let truth = reference::surface::draw(&scene, &camera, &style).picture;
        for (mode, points) in [("mixed", Points::Auto), ("all points", Points::All)] {
            let what = format!("{name}, {mode}");
            let [fixed, _] = draw_samples(
                &mut exhibit,
                &what,
                &samples,
                &camera,
                &hybrid(&samples, points),
            )?;
            against_truth(&mut exhibit, &what, &fixed, &truth);
            if points == Points::Auto {
                exhibit.pictures.push((what, on_paper(&fixed)));
            }
        }
        exhibit
            .pictures
            .push((format!("{name}, truth"), on_paper(&truth)));
    }
    Ok(exhibit)
}

/// Colour where both are covered, and what is open though the truth is covered.
fn against_truth(exhibit: &mut Exhibit, what: &str, picture: &Picture, truth: &Picture) {
    let covered = truth.pixels.iter().zip(&picture.pixels);
    let covered: Vec<_> = covered.filter(|(truth, _)| truth[3] > 0.9).collect();
    let both: Vec<_> = covered.iter().filter(|(_, found)| found[3] > 0.5).collect();
    let differences = || {
        both.iter()
            .flat_map(|(truth, found)| (0..3).map(|c: usize| found[c] - truth[c]))
    };
    let count = differences().count().max(1) as f64;
    let squares = differences().map(|d| d * d).sum::<f64>() / count;
    let largest = differences().fold(0.0, |largest: f64, d| largest.max(d.abs()));
    exhibit.number(
        format!("{what}, against truth: PSNR"),
        -10.0 * squares.log10(),
        "dB",
    );
    exhibit.number(format!("{what}, against truth: largest error"), largest, "");
    exhibit.number(
        format!("{what}, against truth: bias"),
        differences().sum::<f64>() / count,
        "",
    );
    let open = (covered.len() - both.len()) as f64 / covered.len().max(1) as f64;
    exhibit.number(format!("{what}, open pixels"), 100.0 * open, "%");
}
