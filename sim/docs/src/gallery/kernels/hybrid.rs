//! Points and splats: one volume at three distances, and a zoom through the choice.

use super::{errors, number, standard24, without};
use crate::gallery::Exhibit;
use splatline_sim::camera::Camera;
use splatline_sim::fixed::{self, HybridDrawing};
use splatline_sim::hybrid::{Hybrid, Points, rules_for_points, spacing};
use splatline_sim::picture::Picture;
use splatline_sim::reference;
use splatline_sim::rules::{Compositing, Rules};
use splatline_sim::scene::Scene;
use std::path::PathBuf;

const EQUATION: &str = "[HYBRID] 2, 4; [SWAN] 4.3";

/// Vertical field of view, degrees.
const FIELD: f64 = 30.0;

/// Points within this many sample spacings are summed.
const DEPTH_RANGE: f64 = 0.5;

/// Distances of the eye from the volume's centre, in k.
const DISTANCES: [(&str, f64); 3] = [("near", 0.7), ("middle", 1.0), ("far", 1.937)];

/// How everything is drawn, and its name.
const MODES: [(&str, Points); 3] = [
    ("all splats", Points::None),
    ("mixed", Points::Auto),
    ("all points", Points::All),
];

/// Frames of the zoom and the part of the distance that each moves.
const FRAMES: i32 = 90;
const STEP: f64 = 0.01;

pub fn distances(scene: Result<&Scene, &PathBuf>) -> Exhibit {
    let scene = match scene {
        Ok(scene) => scene,
        Err(missing) => return without("hybrid", EQUATION, missing),
    };
    let mut exhibit = Exhibit {
        name: "hybrid".to_owned(),
        equation: EQUATION,
        caption: format!(
            "Aneurism ({} samples, 256x256 pixels) from 0.7, 1 and 1.94 times the distance k, where samples lie a pixel apart: \
             share of points, pixels visited and time. All points leave holes before k, all splats and mixed are one picture.",
            scene.splats.len()
        ),
        pictures: Vec::new(),
        numbers: Vec::new(),
    };
    let rules = rules_for_points(scene, &scene.natural_rules);
    for (place, distance) in DISTANCES {
        let camera = camera(scene, distance, 256);
        for (mode, points) in MODES {
            let title = format!("{place}, {mode}");
            let hybrid = mode_of(scene, points);
            let drawn = match draw(scene, &camera, &rules, &hybrid) {
                Ok(drawn) => drawn,
                Err(problem) => return failed(exhibit, problem),
            };
            let float = reference::hybrid::draw(scene, &camera, &rules, &hybrid).picture;
            let picture = &drawn.drawing.picture;
            exhibit.numbers.extend(facts(&title, &drawn));
            exhibit.numbers.extend(errors(&title, picture, &float));
            exhibit.pictures.push((title, picture.clone()));
        }
    }
    exhibit
}

pub fn zoom(scene: Result<&Scene, &PathBuf>) -> Exhibit {
    let scene = match scene {
        Ok(scene) => scene,
        Err(missing) => return without("hybrid-zoom", EQUATION, missing),
    };
    let mut exhibit = Exhibit {
        name: "hybrid-zoom".to_owned(),
        equation: EQUATION,
        caption: format!(
            "A zoom in {FRAMES} steps of 1 % from 1.57 to 0.64 k, while all samples turn from points into splats. The \
             largest change of a pixel from frame to frame is the motion's, not the choice's: all splats change as much."
        ),
        pictures: Vec::new(),
        numbers: Vec::new(),
    };
    let rules = rules_for_points(scene, &scene.natural_rules);
    let mut changes = [0.0f64; 2];
    let mut popping = 0.0f64;
    let mut apart = 0.0f64;
    let mut before: Option<[Picture; 2]> = None;
    let mut shares = Vec::new();
    for frame in 0..=FRAMES {
        let distance = (1.0 - STEP).powi(frame - FRAMES / 2);
        let camera = camera(scene, distance, 192);
        let pair = [Points::None, Points::Auto]
            .map(|points| draw(scene, &camera, &rules, &mode_of(scene, points)));
        let [Ok(splats), Ok(mixed)] = pair else {
            return failed(exhibit, "the scene has no points".to_owned());
        };
        shares.push(share(&mixed));
        let now = [splats.drawing.picture, mixed.drawing.picture];
        apart = apart.max(largest(&now[0], &now[1]));
        if let Some(before) = &before {
            for ((change, now), before) in changes.iter_mut().zip(&now).zip(before) {
                *change = change.max(largest(now, before));
            }
            popping = popping.max(largest_extra(&now, before));
        }
        before = Some(now);
    }
    exhibit.numbers = vec![
        number("share of points in the first frame", shares[0], ""),
        number(
            "share of points in the last frame",
            shares[FRAMES as usize],
            "",
        ),
        number(
            "all splats: largest change of a pixel between frames",
            changes[0],
            "",
        ),
        number(
            "mixed: largest change of a pixel between frames",
            changes[1],
            "",
        ),
        number(
            "mixed: largest change beyond that of all splats at the same pixel",
            popping,
            "",
        ),
        number(
            "largest difference of mixed and all splats in any frame",
            apart,
            "",
        ),
    ];
    exhibit
}

fn failed(mut exhibit: Exhibit, problem: String) -> Exhibit {
    exhibit.caption = format!("Not drawn: {problem}");
    exhibit
}

/// The eye before the volume's centre, at a distance in units of k.
pub fn camera(scene: &Scene, distance_in_k: f64, size: usize) -> Camera {
    let mut camera = scene.default_camera(size, size);
    let focal = 0.5 * size as f64 / (0.5 * FIELD.to_radians()).tan();
    (camera.fx, camera.fy) = (focal, focal);
    let middle = scene.bounds().map_or([0.0; 3], |bounds| bounds.centre());
    let offset = splatline_sim::vector::transform(&camera.rotation, middle);
    let distance = distance_in_k * focal * spacing(scene);
    camera.translation = [-offset[0], -offset[1], distance - offset[2]];
    camera
}

fn mode_of(scene: &Scene, points: Points) -> Hybrid {
    Hybrid {
        points,
        depth_range: Some(DEPTH_RANGE * spacing(scene)),
        phase_bits: None,
    }
}

fn draw(
    scene: &Scene,
    camera: &Camera,
    rules: &Rules,
    hybrid: &Hybrid,
) -> Result<HybridDrawing, String> {
    let design = standard24();
    let options = fixed::Options {
        rules,
        compositing: Compositing::FrontToBack,
        design: &design,
        traversal: design.traversal,
    };
    fixed::draw_hybrid(scene, camera, &options, hybrid)
}

fn share(drawn: &HybridDrawing) -> f64 {
    drawn.points as f64 / drawn.drawn.max(1) as f64
}

fn facts(title: &str, drawn: &HybridDrawing) -> Vec<(String, f64, String)> {
    let times = drawn.drawing.times;
    let coverage = drawn.drawing.coverage;
    vec![
        number(format!("{title}: share of points"), share(drawn), ""),
        number(
            format!("{title}: pixels visited"),
            coverage.visited as f64 / 1e6,
            "million",
        ),
        number(format!("{title}: set-up"), times.setup * 1e3, "ms"),
        number(format!("{title}: raster"), times.raster * 1e3, "ms"),
    ]
}

/// Largest difference of a channel.
fn largest(a: &Picture, b: &Picture) -> f64 {
    let pairs = a.pixels.iter().flatten().zip(b.pixels.iter().flatten());
    pairs.fold(0.0, |largest, (a, b)| largest.max((a - b).abs()))
}

/// Largest amount by which the second picture changed more than the first did.
fn largest_extra(now: &[Picture; 2], before: &[Picture; 2]) -> f64 {
    let channels = |picture: &Picture| {
        picture
            .pixels
            .iter()
            .flatten()
            .copied()
            .collect::<Vec<f64>>()
    };
    let [n0, n1] = now.each_ref().map(channels);
    let [b0, b1] = before.each_ref().map(channels);
    (0..n0.len())
        .map(|i| (n1[i] - b1[i]).abs() - (n0[i] - b0[i]).abs())
        .fold(0.0, f64::max)
}
