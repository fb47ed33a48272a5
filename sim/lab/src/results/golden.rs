//! Both engines against data of independent origin: golden_a's 60-digit conics and pictures, and golden/tiny.

use super::{ResultPage, opening, table, verdict};
use anyhow::{Context, Result};
use splatline_sim::camera::Camera;
use splatline_sim::design::DesignChoice;
use splatline_sim::fixed::{self, Options, conics};
use splatline_sim::metrics::compare;
use splatline_sim::picture::Picture;
use splatline_sim::reference::float;
use splatline_sim::reference::golden::{GoldenA, archive, conic_difference};
use splatline_sim::rules::{Compositing, Rules};
use splatline_sim::scene::{LoadOptions, load};
use std::path::Path;

/// Largest relative difference of a conic from the 60-digit one that a design may have.
const CONIC_BARS: [(&str, f64); 2] = [("standard24", 1e-4), ("deep32", 2e-6)];
/// The float engine's bars: conics relative, pictures in units of 1.0.
const FLOAT_CONIC: f64 = 1e-9;
const FLOAT_PICTURE: f64 = 2e-5;
/// The picture of another renderer must agree to this.
const TINY_DB: f64 = 40.0;

/// Largest relative difference of a fixed-point conic in one category.
#[derive(Clone, Debug, PartialEq)]
pub struct FixedConics {
    /// Name of the design.
    pub design: String,
    /// Category of golden_a.
    pub category: String,
    /// Splats compared: all but those before the near plane.
    pub splats: usize,
    /// Largest difference of an entry over the largest entry.
    pub worst: f64,
}

impl FixedConics {
    /// Is the design's bar met? `None` if it has none.
    pub fn meets_bar(&self) -> Option<bool> {
        let (_, bar) = CONIC_BARS
            .iter()
            .find(|(design, _)| *design == self.design)?;
        Some(self.worst <= *bar)
    }
}

/// Compares the conics of all named designs with golden_a, category by category.
pub fn fixed_conics(golden: &GoldenA) -> Vec<FixedConics> {
    let mut found = Vec::new();
    for design in DesignChoice::all() {
        for category in &golden.categories {
            let computed = conics(
                &golden.scene(category),
                &golden.camera,
                &golden.rules,
                &design,
            );
            let pairs = computed.iter().zip(golden.members(category));
            let differences: Vec<f64> = pairs
                .filter_map(|(conic, member)| Some(conic_difference((*conic)?, member.exact_conic)))
                .collect();
            found.push(FixedConics {
                design: design.name.clone(),
                category: category.clone(),
                splats: differences.len(),
                worst: differences.into_iter().fold(0.0, f64::max),
            });
        }
    }
    found
}

/// PSNR of each engine against the picture of another renderer, by name.
pub fn tiny(folder: &Path) -> Result<Vec<(String, f64)>> {
    let scene = load(&folder.join("tiny.ply"), &LoadOptions::default())?;
    let expected = Picture::read_png(&folder.join("tiny.png"))?;
    let camera = Camera::look_at(
        [0.0, -5.0, -8.0],
        [0.0; 3],
        [0.0, -1.0, 0.0],
        60.0,
        320,
        240,
    )?;
    let rules = Rules::GAUSSIAN_3D;
    let psnr =
        |picture: &Picture| -> Result<f64> { Ok(compare(picture, &expected)?.colour.psnr_db) };
    let exact = float::draw(&scene, &camera, &rules, Compositing::FrontToBack);
    let mut found = vec![("float".to_owned(), psnr(&exact.picture)?)];
    for design in DesignChoice::all() {
        let options = Options {
            rules: &rules,
            compositing: Compositing::FrontToBack,
            design: &design,
            traversal: design.traversal,
        };
        found.push((
            design.name.clone(),
            psnr(&fixed::draw(&scene, &camera, &options).picture)?,
        ));
    }
    Ok(found)
}

/// The page; `folder` holds tiny.
pub fn page(folder: &Path) -> Result<ResultPage> {
    let golden = GoldenA::load(&archive()).context("golden_a")?;
    let mut text = opening("Agreement with data of independent origin");
    text.push_str("golden_a: 256 hard Gaussians, projected by other code, with conics in 60-digit arithmetic and 64x64 pictures in double precision.\n\n## Engine `float`\n\n");
    text.push_str(&format!(
        "Bars: conics {FLOAT_CONIC:.0e} (largest difference of an entry over the largest entry), pictures {FLOAT_PICTURE:.0e}.\n\n"
    ));
    let rows: Vec<_> = golden
        .measure()?
        .iter()
        .map(|d| {
            let met = d.conic <= FLOAT_CONIC && d.picture <= FLOAT_PICTURE;
            let numbers = [d.conic, d.centre, d.depth, d.picture].map(|n| format!("{n:.1e}"));
            [
                vec![d.category.clone(), d.splats.to_string()],
                numbers.to_vec(),
                vec![verdict(met)],
            ]
            .concat()
        })
        .collect();
    text.push_str(&table(
        &[
            "category", "splats", "conic", "centre", "depth", "picture", "bars",
        ],
        &rows,
    ));
    text.push_str("\n## Engine `fixed`: conics\n\nBars: standard24 1e-4, deep32 2e-6. Arithmetic in f32 by the usual formulas is off by 1.6e-3 on needles. \
         The row `all` draws the ten categories as one scene, positions from 0.01 to 67 units.\n\n");
    let rows: Vec<_> = fixed_conics(&golden)
        .iter()
        .map(|f| {
            let bar = f.meets_bar().map_or("none".to_owned(), verdict);
            vec![
                f.design.clone(),
                f.category.clone(),
                f.splats.to_string(),
                format!("{:.1e}", f.worst),
                bar,
            ]
        })
        .collect();
    text.push_str(&table(
        &["design", "category", "splats", "conic", "bar"],
        &rows,
    ));
    text.push_str(
        "\n## tiny: a picture by another renderer\n\nThat renderer lowers each Gaussian to reach 0 at three standard deviations, which the rules `3dgs` do not; the bar is 40 dB.\n\n",
    );
    let rows: Vec<_> = tiny(folder)?
        .iter()
        .map(|(name, db)| vec![name.clone(), format!("{db:.2}"), verdict(*db >= TINY_DB)])
        .collect();
    text.push_str(&table(&["engine or design", "PSNR dB", "bar"], &rows));
    Ok(ResultPage {
        file: "golden.md",
        text,
    })
}
