//! The README's picture: the demo scene by the kernel, by the reference, and their difference.

use crate::views::{BRAIN, View};
use anyhow::{Context, Result};
use splatline_sim::design::DesignChoice;
use splatline_sim::fixed;
use splatline_sim::report::error_map::ErrorMap;
use splatline_sim::report::png::Rgb;
use std::path::Path;

/// File name beside the pages.
pub const FILE: &str = "demo.png";

/// Three panels of `size` pixels: `standard24`, float, error map.
pub fn panels(size: usize) -> Result<Rgb> {
    let view = View::load(BRAIN, Path::new(""), size)?;
    let design = DesignChoice::named("standard24").context("standard24 is a named design")?;
    let fixed = fixed::draw(&view.scene, &view.camera, &view.options(&design)).picture;
    let exact = view.reference();
    let map = ErrorMap::new(&fixed, &exact).to_rgb();
    let panels = [Rgb::on_black(&fixed), Rgb::on_black(&exact), map];
    let row = |y: usize| {
        let part =
            move |panel: &Rgb| panel.bytes[y * panel.width * 3..(y + 1) * panel.width * 3].to_vec();
        panels.iter().flat_map(part).collect::<Vec<u8>>()
    };
    Ok(Rgb {
        width: 3 * size,
        height: size,
        bytes: (0..size).flat_map(row).collect(),
    })
}
