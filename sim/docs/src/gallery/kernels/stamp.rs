//! The sub-pixel-centred blit: error against the number of phases, time against `spans`.

use super::plane::{KernelPlane, plane};
use super::{errors, hybrid, number, standard24, without};
use crate::gallery::Exhibit;
use splatline_sim::camera::Camera;
use splatline_sim::fixed;
use splatline_sim::hybrid::{Hybrid, Points, rules_for_points};
use splatline_sim::metrics::compare;
use splatline_sim::picture::Picture;
use splatline_sim::reference;
use splatline_sim::rules::{Compositing, Rules};
use splatline_sim::scene::Scene;
use std::path::PathBuf;

const EQUATION: &str = "[SWAN] 4.3, 6";

/// Phase bits per axis that are measured.
const PHASE_BITS: [u8; 6] = [0, 1, 2, 3, 4, 5];

/// Drawings of which the median time counts.
const RUNS: usize = 5;

pub fn phases(scene: Result<&Scene, &PathBuf>) -> Exhibit {
    let scene = match scene {
        Ok(scene) => scene,
        Err(missing) => return without("stamp", EQUATION, missing),
    };
    let camera = hybrid::camera(scene, 1.937, 256);
    let caption = "Aneurism from 1.94 k, where every footprint is the same circle: drawn by stamps at 2^n x 2^n phases, against \
                   continuous centres in float, and against spans of the same footprints in time.";
    let mut exhibit = measured("stamp", caption, scene, &camera, Points::All);
    exhibit.insets([96, 64], [64, 64]);
    exhibit
}

pub fn on_the_plane() -> Exhibit {
    let scene = plane(&KernelPlane::SHORT);
    let caption = "The checkerboard plane to the horizon: stamps beyond k, spans before it.";
    let camera = KernelPlane::SHORT.camera();
    let mut exhibit = measured("stamp-plane", caption, &scene, &camera, Points::Auto);
    exhibit.insets([72, 128], [48, 48]);
    exhibit
}

fn measured(name: &str, caption: &str, scene: &Scene, camera: &Camera, points: Points) -> Exhibit {
    let rules = rules_for_points(scene, &scene.natural_rules);
    let stamped = |phase_bits| Hybrid {
        points,
        depth_range: None,
        phase_bits,
    };
    let mut exhibit = Exhibit {
        name: name.to_owned(),
        equation: EQUATION,
        caption: caption.to_owned(),
        pictures: Vec::new(),
        numbers: Vec::new(),
    };
    let float = reference::hybrid::draw(scene, camera, &rules, &stamped(None)).picture;
    let Some((by_spans, spans_ms)) = timed(scene, camera, &rules, &stamped(None)) else {
        return exhibit;
    };
    let numbers = &mut exhibit.numbers;
    let coverage = by_spans.drawing.coverage;
    numbers.push(number(
        "share of stamped footprints",
        by_spans.points as f64 / by_spans.drawn.max(1) as f64,
        "",
    ));
    numbers.push(number("spans: raster", spans_ms, "ms"));
    numbers.push(number(
        "spans: pixels visited",
        coverage.visited as f64 / 1e6,
        "million",
    ));
    numbers.extend(errors("spans", &by_spans.drawing.picture, &float));
    for bits in PHASE_BITS {
        let hybrid = stamped(Some(bits));
        let Some((drawn, milliseconds)) = timed(scene, camera, &rules, &hybrid) else {
            continue;
        };
        let own = reference::hybrid::draw(scene, camera, &rules, &hybrid).picture;
        let picture = &drawn.drawing.picture;
        let title = format!("{0}x{0} phases", 1 << bits);
        let numbers = &mut exhibit.numbers;
        numbers.push(number(
            format!("{title}: PSNR against continuous centres"),
            psnr(picture, &float),
            "dB",
        ));
        numbers.extend(errors(
            &format!("{title}, against the same phases in float"),
            picture,
            &own,
        ));
        numbers.push(number(
            format!("{title}: memory"),
            drawn.stamp_words as f64,
            "words",
        ));
        numbers.push(number(
            format!("{title}: raster relative to spans"),
            milliseconds / spans_ms,
            "",
        ));
        numbers.push(number(
            format!("{title}: pixels visited"),
            drawn.drawing.coverage.visited as f64 / 1e6,
            "million",
        ));
        if bits == 0 || bits == 3 {
            exhibit.pictures.push((title, picture.clone()));
        }
    }
    exhibit
        .pictures
        .push(("spans".to_owned(), by_spans.drawing.picture));
    exhibit
}

fn psnr(a: &Picture, b: &Picture) -> f64 {
    compare(a, b).map_or(f64::NAN, |errors| {
        errors.colour.psnr_db.min(errors.alpha.psnr_db)
    })
}

/// The drawing and the median raster time in milliseconds.
fn timed(
    scene: &Scene,
    camera: &Camera,
    rules: &Rules,
    hybrid: &Hybrid,
) -> Option<(fixed::HybridDrawing, f64)> {
    let design = standard24();
    let options = fixed::Options {
        rules,
        compositing: Compositing::FrontToBack,
        design: &design,
        traversal: design.traversal,
    };
    let mut times = Vec::new();
    let mut last = None;
    for _ in 0..RUNS {
        let drawn = fixed::draw_hybrid(scene, camera, &options, hybrid).ok()?;
        times.push(drawn.drawing.times.raster * 1e3);
        last = Some(drawn);
    }
    times.sort_by(f64::total_cmp);
    last.map(|drawn| (drawn, times[RUNS / 2]))
}
