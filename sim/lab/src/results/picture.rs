//! The README's picture: the demo scene by the kernel, by the reference, and their difference.

use anyhow::{Context, Result};
use splatline_sim::design::DesignChoice;
use splatline_sim::fixed::{self, Options};
use splatline_sim::reference::float;
use splatline_sim::report::error_map::ErrorMap;
use splatline_sim::report::png::Rgb;
use splatline_sim::rules::Compositing;
use splatline_sim::scene;

/// File name beside the pages.
pub const FILE: &str = "demo.png";

/// Three panels of `size` pixels: `standard24`, float, error map.
pub fn panels(size: usize) -> Result<Rgb> {
    let scene = scene::demo()?;
    let camera = scene.default_camera(size, size);
    let rules = scene.natural_rules;
    let compositing = Compositing::FrontToBack;
    let design = DesignChoice::named("standard24").context("standard24 is a named design")?;
    let traversal = design.traversal;
    let options = Options {
        rules: &rules,
        compositing,
        design: &design,
        traversal,
    };
    let fixed = fixed::draw(&scene, &camera, &options).picture;
    let exact = float::draw(&scene, &camera, &rules, compositing).picture;
    let map = ErrorMap::new(&fixed, &exact).to_rgb();
    Ok(side_by_side(&[
        Rgb::on_black(&fixed),
        Rgb::on_black(&exact),
        map,
    ]))
}

/// Pictures of one height, left to right.
fn side_by_side(pictures: &[Rgb]) -> Rgb {
    let height = pictures.iter().map(|p| p.height).min().unwrap_or(0);
    let rows = (0..height).flat_map(|y| {
        pictures
            .iter()
            .map(move |p| &p.bytes[y * p.width * 3..(y + 1) * p.width * 3])
    });
    let bytes = rows.flatten().copied().collect();
    Rgb {
        width: pictures.iter().map(|p| p.width).sum(),
        height,
        bytes,
    }
}
