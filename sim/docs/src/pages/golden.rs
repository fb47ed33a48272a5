//! Both engines against data of independent origin: golden_a's 60-digit conics and pictures, and golden/tiny.

use super::Page;
use crate::bars::{CONIC_BARS, FLOAT_CONIC, FLOAT_PICTURE, TINY_DB, verdict};
use crate::table::Table;
use crate::views::View;
use anyhow::{Context, Result};
use splatline_sim::camera::Camera;
use splatline_sim::design::DesignChoice;
use splatline_sim::fixed::{self, conics};
use splatline_sim::metrics::compare;
use splatline_sim::picture::Picture;
use splatline_sim::reference::golden::{GoldenA, archive, conic_difference};
use splatline_sim::rules::Rules;
use splatline_sim::scene::{LoadOptions, load};
use std::path::Path;

/// The category that holds all others.
const ALL: &str = "all";

/// Largest relative difference of a fixed-point conic in one category.
#[derive(Clone, Debug, PartialEq)]
pub struct FixedConics {
    pub design: String,
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
            let options = fixed::Options::front_to_back(&golden.rules, &design);
            let computed = conics(&golden.scene(category), &golden.camera, &options);
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
    let view = View {
        rules: Rules::GAUSSIAN_3D,
        ..View::new("tiny", scene, camera)
    };
    let psnr =
        |picture: &Picture| -> Result<f64> { Ok(compare(picture, &expected)?.colour.psnr_db) };
    let mut found = vec![("float".to_owned(), psnr(&view.reference())?)];
    for design in DesignChoice::all() {
        let drawing = fixed::draw(&view.scene, &view.camera, &view.options(&design));
        found.push((design.name.clone(), psnr(&drawing.picture)?));
    }
    Ok(found)
}

pub fn add(page: &mut Page, folder: &Path) -> Result<()> {
    let golden = GoldenA::load(&archive()).context("golden_a")?;
    let float = float_table(&golden);
    let fixed = fixed_table(&golden);
    page.add("## Agreement with data of independent origin");
    page.add(format!(
        "golden_a: 256 hard Gaussians in ten categories, projected by other code, with conics in 60-digit arithmetic and 64x64 pictures in double precision. \
         A conic's difference is the largest of its entries over the largest entry. Bars: the float engine {FLOAT_CONIC:.0e} and {FLOAT_PICTURE:.0e} for pictures, \
         standard24 1e-4, deep32 2e-6. Arithmetic in f32 by the usual formulas is off by 1.6e-3 on needles. Below, the ten categories as one scene, \
         positions from 0.01 to 67 units; [golden-float.csv](golden-float.csv) and [golden-conics.csv](golden-conics.csv) have each."
    ));
    page.add(float.only(0, ALL).markdown());
    page.add(fixed.only(1, ALL).markdown());
    page.beside("golden-float.csv", float.csv());
    page.beside("golden-conics.csv", fixed.csv());
    page.add(
        "tiny is a picture by another renderer, which lowers each Gaussian to reach 0 at three standard deviations; the rules `3dgs` do not. The bar is 40 dB.",
    );
    let mut table = Table::new("engine or design | PSNR dB | bar");
    for (name, db) in tiny(folder)? {
        table.push([name, format!("{db:.2}"), verdict(Some(db >= TINY_DB))]);
    }
    page.add(table.markdown());
    Ok(())
}

fn float_table(golden: &GoldenA) -> Table {
    let mut table = Table::new("category | splats | conic | centre | depth | picture | bars");
    for found in golden.measure() {
        let met = found.conic <= FLOAT_CONIC && found.picture <= FLOAT_PICTURE;
        let numbers =
            [found.conic, found.centre, found.depth, found.picture].map(|n| format!("{n:.1e}"));
        let cells = [found.splats.to_string()].into_iter().chain(numbers);
        table.push_behind(&[&found.category], cells.chain([verdict(Some(met))]));
    }
    table
}

fn fixed_table(golden: &GoldenA) -> Table {
    let mut table = Table::new("design | category | splats | conic | bar");
    for found in fixed_conics(golden) {
        let bar = verdict(found.meets_bar());
        table.push([
            found.design,
            found.category,
            found.splats.to_string(),
            format!("{:.1e}", found.worst),
            bar,
        ]);
    }
    table
}
