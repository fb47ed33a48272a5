//! View-dependent colour in fixed point: spherical harmonics by the kernel's unit against double precision, splat by
//! splat and in pictures.

use super::Page;
use crate::table::Table;
use crate::views::View;
use anyhow::Result;
use splatline_sim::design::DesignChoice;
use splatline_sim::fixed::{self, harmonic_colours};
use splatline_sim::metrics::compare;
use splatline_sim::scene::synthetic;
use std::path::Path;

/// Columns and rows of every picture.
const SIZE: usize = 512;

/// The captured scene that has harmonics.
const CAPTURED: &str = "playbot";

/// Adds the section about random harmonics of every degree and a captured scene.
pub fn add(page: &mut Page, data: &Path) -> Result<()> {
    let mut table = Table::new(
        "scene | degree | design | largest error of a colour | RMS | bias | picture PSNR dB | \
         largest error | picture bias | bytes a splat",
    );
    let random = |degree| {
        View::new(
            "random 5k",
            synthetic::random_harmonics(5000, 1, degree),
            synthetic::camera(SIZE, SIZE),
        )
    };
    let captured = View::load(CAPTURED, data, SIZE)?;
    for view in (1..=4).map(random).chain([captured]) {
        for row in measure(&view)? {
            table.push(row);
        }
    }
    page.add("## View-dependent colour");
    page.add(
        "Spherical harmonics by the kernel's optional unit (`src/setup/harmonics.rs`): coefficients in Q3.28, the direction from mantissas of the design's width. \
         Errors of colours are over all channels of all splats, before the design rounds them; pictures are drawn with those colours by the same design and compared with the \
         double-precision reference. A splat's coefficients take 4 bytes a channel here; trained files keep them in single precision. \
         [colour.csv](colour.csv) has random harmonics of degree 1 to 4 beside this captured scene.",
    );
    page.add(table.only(0, CAPTURED).markdown());
    page.beside("colour.csv", table.csv());
    Ok(())
}

/// A row for every design; none for a scene without harmonics.
fn measure(view: &View) -> Result<Vec<Vec<String>>> {
    let Some(harmonics) = &view.scene.harmonics else {
        return Ok(Vec::new());
    };
    let exact = view.scene.colours(&view.camera);
    let truth = view.reference();
    let coefficients = (usize::from(harmonics.degree) + 1).pow(2);
    let mut rows = Vec::new();
    for design in DesignChoice::all() {
        let Some(colours) = harmonic_colours(&view.scene, &view.camera, &design.widths) else {
            continue;
        };
        let mut seen = view.scene.clone();
        seen.harmonics = None;
        for (splat, colour) in seen.splats.iter_mut().zip(&colours) {
            splat.colour = colour.map(|channel| channel.to_num());
        }
        let channels = seen.splats.iter().flat_map(|splat| splat.colour);
        let errors: Vec<f64> = channels
            .zip(exact.iter().flatten())
            .map(|(fixed, exact)| fixed - exact)
            .collect();
        let mean =
            |of: fn(&f64) -> f64| errors.iter().map(of).sum::<f64>() / errors.len().max(1) as f64;
        let picture = fixed::draw(&seen, &view.camera, &view.options(&design)).picture;
        let picture = compare(&picture, &truth)?.colour;
        rows.push(vec![
            view.name.to_owned(),
            harmonics.degree.to_string(),
            design.name.clone(),
            format!(
                "{:.1e}",
                errors.iter().fold(0.0f64, |most, e| most.max(e.abs()))
            ),
            format!("{:.1e}", mean(|e| e * e).sqrt()),
            format!("{:+.1e}", mean(|e| *e)),
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
        let rows =
            |scene, size| measure(&View::new("x", scene, synthetic::camera(size, size))).unwrap();
        let found = rows(synthetic::random_harmonics(300, 1, 2), 64);
        let errors: Vec<f64> = found.iter().map(|row| row[3].parse().unwrap()).collect();
        // By mantissas: micro16 has 15 bits, classic8 16. From 28 bits on the coefficients' own step decides.
        let [classic8, micro16, lean18, standard24, deep32] = errors[..] else {
            panic!("five designs: {errors:?}");
        };
        let decreasing = micro16 > classic8 && classic8 > lean18 && lean18 > standard24;
        assert!(decreasing && deep32 < 1e-8, "{errors:?}");
        assert!(rows(synthetic::random_gaussians(9, 1, 1.0), 8).is_empty());
    }
}
