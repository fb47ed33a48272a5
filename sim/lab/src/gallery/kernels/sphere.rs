//! A large spherical splat near the eye: affine against exact ellipse and corrected index.

use super::{errors, number, standard24};
use crate::gallery::Exhibit;
use splatline::setup as kernel;
use splatline_sim::camera::Camera;
use splatline_sim::fixed;
use splatline_sim::metrics::compare;
use splatline_sim::reference::exact;
use splatline_sim::reference::sphere::{self, Index, Shape};
use splatline_sim::rules::{Antialias, Compositing, Rules};
use splatline_sim::scene::{Scene, Skipped, SortOrder, Splat, Weight, synthetic};

/// The four combinations of systems 15 and 16, and the index of each pixel's own ray.
const SHAPES: [(&str, bool, Index); 5] = [
    ("affine", false, Index::Affine),
    ("exact ellipse", true, Index::Affine),
    ("corrected index", false, Index::Perspective),
    ("exact ellipse, corrected index", true, Index::Perspective),
    ("index of the ray", true, Index::Ray),
];

/// Where the sphere is, in units of its distance along the view: in the middle, and aside.
const PLACES: [(&str, f64); 2] = [("in the middle", 0.0), ("aside", 0.55)];

pub fn exhibit() -> Exhibit {
    let mut exhibit = Exhibit {
        name: "spheres".to_owned(),
        equation: "[HYBRID] 4.2, appendix A",
        caption: "A spherical splat whose end is seen under a half-angle of 30 degrees, in the middle of the picture and 29 \
                  degrees aside: float drawings against the ray integral (model error), fixed against float (arithmetic)."
            .to_owned(),
        pictures: Vec::new(),
        numbers: Vec::new(),
    };
    let rules = Rules::EWA.with_antialias(Antialias::None);
    let design = standard24();
    let options = fixed::Options {
        rules: &rules,
        compositing: Compositing::FrontToBack,
        design: &design,
        traversal: design.traversal,
    };
    for (place, aside) in PLACES {
        let (scene, camera) = ball(aside);
        let truth = exact::draw(&scene, &camera, &rules, Compositing::FrontToBack).picture;
        exhibit
            .pictures
            .push((format!("ray integral {place}"), truth.clone()));
        for (name, exact_ellipse, index) in SHAPES {
            let shape = Shape {
                exact_ellipse,
                index,
            };
            let float =
                sphere::draw(&scene, &camera, &rules, Compositing::FrontToBack, shape).picture;
            let drawing = fixed::draw_spheres(&scene, &camera, &options, in_kernel(shape)).picture;
            if let Ok(model) = compare(&float, &truth) {
                let numbers = &mut exhibit.numbers;
                numbers.push(number(
                    format!("{name} {place}: PSNR against the ray integral"),
                    model.alpha.psnr_db,
                    "dB",
                ));
                numbers.push(number(
                    format!("{name} {place}: largest difference"),
                    model.alpha.max_abs,
                    "",
                ));
            }
            exhibit.numbers.extend(errors(
                &format!("{name} {place}, fixed against float"),
                &drawing,
                &float,
            ));
            exhibit.pictures.push((format!("{name} {place}"), drawing));
        }
    }
    exhibit
}

/// The kernel's names for a shape.
fn in_kernel(shape: Shape) -> (kernel::Ellipse, kernel::Index) {
    let ellipse = if shape.exact_ellipse {
        kernel::Ellipse::Exact
    } else {
        kernel::Ellipse::Approximate
    };
    let index = match shape.index {
        Index::Affine => kernel::Index::Affine,
        Index::Perspective => kernel::Index::Perspective,
        Index::Ray => kernel::Index::Ray,
    };
    (ellipse, index)
}

/// A ball of deviation 0.25 (end 0.5) at distance 1 along the view, seen with a field of 113 degrees.
fn ball(aside: f64) -> (Scene, Camera) {
    let scene = Scene {
        name: "ball".to_owned(),
        natural_rules: Rules::EWA,
        weight: Weight::Mass,
        splats: vec![Splat {
            centre: [aside, 0.3 * aside, 1.0],
            axes: [[0.25, 0.0, 0.0], [0.0, 0.25, 0.0], [0.0, 0.0, 0.25]],
            weight: 0.3,
            colour: [0.6, 0.85, 1.0],
        }],
        harmonics: None,
        skipped: Skipped::default(),
        order: SortOrder::Depth,
        up: [0.0, -1.0, 0.0],
    };
    let mut camera = synthetic::camera(192, 192);
    camera.translation = [0.0; 3];
    camera.rotation = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    (camera.fx, camera.fy) = (64.0, 64.0);
    (scene, camera)
}
