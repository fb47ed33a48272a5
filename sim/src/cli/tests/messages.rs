//! What commands tell while they work and about how long it took.

use super::*;
use crate::design::DesignChoice;
use crate::plan::Prepared;
use crate::plan::draw::on_threads;
use crate::progress::heard;
use crate::scene::synthetic;
use std::sync::Mutex;

/// What the progress bar said during a command, and how far it came.
fn said(folder: &Folder, line: &str) -> Vec<String> {
    heard::take();
    folder.run(line);
    heard::take()
}

/// Nothing that takes long is silent: each command says what it is at, and its bar arrives.
#[test]
fn long_work_is_told() {
    let folder = Folder::new();
    folder.write("h.csv", HEIGHTS);
    let small = "random:60 --size 16x16";
    let photo = "--texture ./photo.png";
    for (line, expected) in [
        (
            format!("render {small} -o ./photo.png"),
            &[
                "loading random:60",
                "drawing random:60",
                "writing ",
                "2000 of 2000",
            ][..],
        ),
        (
            format!("render {small} --engine exact --repeat 3 -o ./photo.png"),
            &["drawing random:60", "2000 of 2000"],
        ),
        (
            format!("compare {small} --only -o ./c"),
            &["float reference", "standard24 by spans", "2000 of 2000"],
        ),
        (
            format!("needs {small}"),
            &[
                "setting up every splat",
                "walking the rows of every tile",
                "trying the depths of every FIFO",
            ],
        ),
        (
            format!("render ./h.csv --as surface {photo} --size 16x16 -o ./s.png"),
            &["colours from ", "drawing h.csv"],
        ),
        (
            format!("model {small}"),
            &["walking the rows of every tile"],
        ),
        (
            "stability --only cases --quick".to_owned(),
            &["measuring hard cases against exact arithmetic"],
        ),
    ] {
        let said = said(&folder, &line);
        for words in expected {
            let printed = said.iter().any(|line| line.contains(words));
            assert!(printed, "{line}: {words} is not in {said:?}");
        }
    }
}

/// The bar moves within a picture, not only after it.
#[test]
fn a_single_picture_moves_the_bar() {
    let design = DesignChoice::named("lean18").unwrap();
    let scene = synthetic::random_gaussians(500, 1, 2.0);
    let (camera, rules) = (synthetic::camera(200, 150), scene.natural_rules);
    let prepared = Prepared::of_splats(scene, camera, rules, design);
    let steps = Mutex::new(Vec::new());
    let record = |done, of| steps.lock().unwrap().push((done, of));
    let kernel = || {
        let mut kernel = prepared.kernel(None, &prepared.plan.entry, None, true)?;
        kernel.draw(&record)
    };
    on_threads(2, kernel).unwrap().unwrap();
    let of_kernel = std::mem::take(&mut *steps.lock().unwrap());
    assert!(of_kernel.len() > 5, "{of_kernel:?}");
    let reference = || prepared.draw_reference(Engine::Float, &record);
    on_threads(2, reference).unwrap().unwrap();
    let mut of_reference = steps.into_inner().unwrap();
    of_reference.sort();
    assert!(of_reference.len() > 5, "{of_reference:?}");
    assert_eq!(of_reference.last(), Some(&(150, 150)));
}

/// `convert` is whatever the total has beyond the other stages; of one run they add up but for the rounding of a sum, a
/// nanosecond.
#[test]
fn every_phase_of_the_total_has_a_name() {
    let folder = Folder::new();
    for engine in ["fixed", "float"] {
        let line = format!("render random:300 --size 80x60 --engine {engine}");
        folder.run(&format!("{line} -o ./x.png --json ./r.json"));
        let report = folder.report("r.json");
        let host = report.host;
        let named = host.setup_s + host.sort_s + host.raster_s + host.convert_s;
        assert!((host.total_s - named).abs() < 1e-9, "{host:?}");
        assert!(host.prepare_s > 0.0, "{host:?}");
        let line = summary::of_drawing(&report);
        assert!(line.contains("of loading and preparing"), "{line}");
        if engine == "fixed" {
            for stage in ["setup ", "sort ", "raster ", "convert "] {
                assert!(line.contains(stage), "{stage}: {line}");
            }
        }
    }
}
