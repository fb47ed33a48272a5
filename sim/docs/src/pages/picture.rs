//! The pages' pictures: panels side by side.

use crate::views::{BRAIN, View};
use anyhow::{Context, Result};
use splatline_sim::camera::Camera;
use splatline_sim::cameras::lens::{Distortion, Lens, Projection};
use splatline_sim::cli::{Map, in_colours};
use splatline_sim::design::DesignChoice;
use splatline_sim::fixed;
use splatline_sim::reference::{exact, maps};
use splatline_sim::report::error_map::ErrorMap;
use splatline_sim::report::png::Rgb;
use splatline_sim::rules::Compositing;
use splatline_sim::texture::image::distorted;
use std::path::Path;

/// The README's: the demo scene by `standard24`, by the reference, and their difference.
pub fn demo(size: usize) -> Result<Rgb> {
    let view = View::load(BRAIN, Path::new(""), size)?;
    let design = DesignChoice::named("standard24").context("standard24 is a named design")?;
    let fixed = fixed::draw(&view.scene, &view.camera, &view.options(&design)).picture;
    let float = view.reference();
    let map = ErrorMap::new(&fixed, &float).to_rgb();
    Ok(beside(&[Rgb::on_black(&fixed), Rgb::on_black(&float), map]))
}

/// A trained scene: `exact` as the photograph, `lean18`, their difference, a fisheye lens; below, maps.
pub fn trained(data: &Path, size: usize) -> Result<Rgb> {
    let view = View::load("playbot", data, size)?;
    let (eye, target) = ([0.0, -0.75, -2.7], [0.0, -0.55, 0.0]);
    let camera = &Camera::look_at(eye, target, [0.0, -1.0, 0.0], 45.0, size, size)?;
    let scene = &view.scene;
    let design = DesignChoice::named("lean18").context("lean18 is a named design")?;
    let fixed = fixed::draw(scene, camera, &view.options(&design)).picture;
    let photograph = exact::draw(scene, camera, &view.rules, Compositing::FrontToBack).picture;
    let lens = Lens {
        size: [size as u64; 2],
        focal: [0.85 * camera.fx, 0.85 * camera.fy],
        principal: [camera.cx, camera.cy],
        distortion: Distortion {
            projection: Projection::Fisheye,
            ..Distortion::default()
        },
    };
    let pinhole = lens.pinhole(camera).context("a pinhole sees as much")?;
    let wide = fixed::draw(scene, &pinhole, &view.options(&design)).picture;
    let first = beside(&[
        Rgb::on_black(&photograph),
        Rgb::on_black(&fixed),
        ErrorMap::new(&fixed, &photograph).to_rgb(),
        Rgb::on_black(&distorted(&wide, &pinhole, &lens)),
    ]);
    let pixels = maps::draw(scene, camera, &view.rules);
    let shown = [Map::Depth, Map::Normal, Map::Count, Map::Id];
    let second = beside(&shown.map(|map| in_colours(map, &pixels, [size; 2]).0));
    Ok(Rgb {
        height: first.height + second.height,
        bytes: [first.bytes, second.bytes].concat(),
        ..first
    })
}

/// Panels of one size in a row.
pub fn beside(panels: &[Rgb]) -> Rgb {
    let width = panels.iter().map(|panel| panel.width).sum();
    let height = panels.first().map_or(0, |panel| panel.height);
    let row = |y: usize| {
        let part = move |panel: &Rgb| {
            let line = 3 * panel.width;
            panel.bytes[y * line..(y + 1) * line].to_vec()
        };
        panels.iter().flat_map(part).collect::<Vec<u8>>()
    };
    Rgb {
        width,
        height,
        bytes: (0..height).flat_map(row).collect(),
    }
}
