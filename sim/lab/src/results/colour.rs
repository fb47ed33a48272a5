//! View-dependent colour in fixed point: spherical harmonics by the kernel's unit against double precision, splat by splat and in pictures.

use super::{ResultPage, opening, table};
use anyhow::Result;
use splatline_sim::camera::Camera;
use splatline_sim::design::DesignChoice;
use splatline_sim::fixed::{self, Options, harmonic_colours};
use splatline_sim::metrics::compare;
use splatline_sim::reference::float;
use splatline_sim::rules::Compositing;
use splatline_sim::scene::{LoadOptions, Scene, load, synthetic};
use std::path::Path;

/// Columns and rows of every picture.
const SIZE: usize = 512;

/// Eye, target, vertical field of view in degrees.
type ColourPlace = ([f64; 3], [f64; 3], f64);

/// A captured scene with harmonics, and where it is seen from; -y is up.
const CAPTURED: [(&str, &str, ColourPlace); 1] = [(
    "playbot_lod4",
    "gaussians/playbot_lod4.ply",
    ([2.2, -1.4, 2.2], [0.0, -0.45, 0.0], 45.0),
)];

/// The page about random harmonics of every degree and, if they are at hand, captured scenes.
pub fn page(data: &Path) -> Result<ResultPage> {
    let mut rows = Vec::new();
    for degree in 1..=4 {
        let scene = synthetic::random_harmonics(5000, 1, degree);
        rows.extend(measure(
            "random 5k",
            &scene,
            &synthetic::camera(SIZE, SIZE),
        )?);
    }
    for (name, file, (eye, target, degrees)) in CAPTURED {
        let path = data.join(file);
        if path.exists() {
            let scene = load(&path, &LoadOptions::default())?;
            let camera = Camera::look_at(eye, target, [0.0, -1.0, 0.0], degrees, SIZE, SIZE)?;
            rows.extend(measure(name, &scene, &camera)?);
        }
    }
    let mut text = opening("View-dependent colour in fixed point");
    text.push_str(
        "Spherical harmonics by the kernel's optional unit (`src/setup/harmonics.rs`): coefficients in Q3.28, the direction from mantissas of the design's width. \
         Errors of colours are over all channels of all splats, before the design rounds them; pictures are drawn with those colours by the same design and compared with the \
         double-precision reference. A splat's coefficients take 4 bytes a channel here; trained files keep them in single precision.\n\n",
    );
    text.push_str(&table(
        &[
            "scene",
            "degree",
            "design",
            "largest error of a colour",
            "RMS",
            "bias",
            "picture PSNR dB",
            "largest error",
            "bias",
            "bytes a splat",
        ],
        &rows,
    ));
    Ok(ResultPage {
        file: "colour.md",
        text,
    })
}

/// A row for every design; none for a scene without harmonics.
fn measure(name: &str, scene: &Scene, camera: &Camera) -> Result<Vec<Vec<String>>> {
    let Some(harmonics) = &scene.harmonics else {
        return Ok(Vec::new());
    };
    let rules = scene.natural_rules;
    let exact = scene.colours(camera);
    let truth = float::draw(scene, camera, &rules, Compositing::FrontToBack).picture;
    let coefficients = (usize::from(harmonics.degree) + 1).pow(2);
    let mut rows = Vec::new();
    for design in DesignChoice::all() {
        let Some(colours) = harmonic_colours(scene, camera, &design.widths) else {
            continue;
        };
        let mut seen = scene.clone();
        seen.harmonics = None;
        for (splat, colour) in seen.splats.iter_mut().zip(&colours) {
            splat.colour = colour.map(|channel| channel.to_num());
        }
        let channels = seen.splats.iter().flat_map(|splat| splat.colour);
        let errors = channels
            .zip(exact.iter().flatten())
            .map(|(fixed, exact)| fixed - exact);
        let errors: Vec<f64> = errors.collect();
        let count = errors.len().max(1) as f64;
        let options = Options {
            rules: &rules,
            compositing: Compositing::FrontToBack,
            design: &design,
            traversal: design.traversal,
        };
        let picture = compare(&fixed::draw(&seen, camera, &options).picture, &truth)?.colour;
        rows.push(vec![
            name.to_owned(),
            harmonics.degree.to_string(),
            design.name.clone(),
            format!(
                "{:.1e}",
                errors.iter().fold(0.0f64, |most, e| most.max(e.abs()))
            ),
            format!(
                "{:.1e}",
                (errors.iter().map(|e| e * e).sum::<f64>() / count).sqrt()
            ),
            format!("{:+.1e}", errors.iter().sum::<f64>() / count),
            format!("{:.1}", picture.psnr_db),
            format!("{:.1e}", picture.max_abs),
            format!("{:+.1e}", picture.bias),
            (12 * coefficients).to_string(),
        ]);
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_design_has_a_row_and_wider_ones_smaller_errors() {
        let scene = synthetic::random_harmonics(300, 1, 2);
        let rows = measure("x", &scene, &synthetic::camera(64, 64)).unwrap();
        let errors: Vec<f64> = rows.iter().map(|row| row[3].parse().unwrap()).collect();
        assert_eq!(errors.len(), 4);
        // From 28 bits of mantissa on the coefficients' own step decides.
        let decreasing = errors[..3].windows(2).all(|pair| pair[1] < pair[0]);
        assert!(decreasing && errors[3] < 1e-8, "{errors:?}");
        assert!(
            measure(
                "x",
                &synthetic::random_gaussians(9, 1, 1.0),
                &synthetic::camera(8, 8)
            )
            .unwrap()
            .is_empty()
        );
    }
}
