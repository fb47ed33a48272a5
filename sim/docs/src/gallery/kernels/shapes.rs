//! The four footprint shapes, circular and elliptical.

use super::{errors, standard24};
use crate::gallery::Exhibit;
use splatline_sim::camera::Camera;
use splatline_sim::fixed;
use splatline_sim::reference::float;
use splatline_sim::rules::{Compositing, Kernel, Rules};
use splatline_sim::scene::{Scene, Skipped, SortOrder, Splat, Weight, synthetic};

/// Name and shape.
pub const ALL: [(&str, Kernel); 4] = [
    ("gaussian", Kernel::Gaussian),
    ("cubic", Kernel::Cubic),
    ("quadratic", Kernel::Quadratic),
    ("disc", Kernel::Disc),
];

pub fn exhibit() -> Exhibit {
    let design = standard24();
    let mut exhibit = Exhibit {
        name: "kernels".to_owned(),
        equation: "[SWAN] 6; [EWA] 7.1.2",
        caption: "One splat per footprint shape, circular (above) and elliptical (below), all of the same variance; \
                  and 2,000 random splats of each shape against the float reference."
            .to_owned(),
        pictures: Vec::new(),
        numbers: Vec::new(),
    };
    for (name, kernel) in ALL {
        let rules = Rules::EWA.with_kernel(kernel);
        let options = fixed::Options {
            rules: &rules,
            compositing: Compositing::FrontToBack,
            design: &design,
            traversal: design.traversal,
        };
        let (scene, camera) = pair();
        let drawing = fixed::draw(&scene, &camera, &options);
        exhibit.pictures.push((name.to_owned(), drawing.picture));
        let scene = synthetic::random_gaussians(2000, 3, 2.0);
        let camera = scene.default_camera(192, 192);
        let drawing = fixed::draw(&scene, &camera, &options);
        let reference = float::draw(&scene, &camera, &rules, Compositing::FrontToBack);
        exhibit
            .numbers
            .extend(errors(name, &drawing.picture, &reference.picture));
    }
    exhibit
}

/// A circular and an elliptical splat.
fn pair() -> (Scene, Camera) {
    let splat = |y: f64, axes: [[f64; 3]; 3]| Splat {
        centre: [0.0, y, 0.0],
        axes,
        weight: 0.5,
        colour: [1.0, 0.75, 0.4],
    };
    let round = [[0.3, 0.0, 0.0], [0.0, 0.3, 0.0], [0.0, 0.0, 0.3]];
    let oval = [[0.5, -0.2, 0.0], [0.07, 0.18, 0.0], [0.0, 0.0, 0.2]];
    let scene = Scene {
        name: "pair".to_owned(),
        natural_rules: Rules::EWA,
        weight: Weight::Mass,
        splats: vec![splat(-1.0, round), splat(1.1, oval)],
        harmonics: None,
        skipped: Skipped::default(),
        order: SortOrder::Depth,
        up: [0.0, -1.0, 0.0],
    };
    let mut camera = synthetic::camera(128, 256);
    (camera.fx, camera.fy) = (260.0, 260.0);
    (scene, camera)
}
