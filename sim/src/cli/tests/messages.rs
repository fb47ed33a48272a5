//! What commands tell while they work.

use super::*;
use crate::design::DesignChoice;
use crate::plan::Prepared;
use crate::plan::draw::on_threads;
use crate::progress::heard;
use crate::scene::synthetic;
use std::path::Path;
use std::sync::Mutex;

/// What the progress bar said during a command, and how far it came; `./` is a folder of the test's own.
fn said(folder: &Path, line: &str) -> Vec<String> {
    heard::take();
    let line = line.replace("./", &format!("{}/", folder.display()));
    dispatch(parse(&line).unwrap().command).unwrap();
    heard::take()
}

/// Nothing that takes long is silent: each command says what it is at, and its bar arrives.
#[test]
fn long_work_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let heights = "0,0.1,0.3\n0,0.2,0.2\n0.1,0.1,0\n";
    std::fs::write(folder.path().join("h.csv"), heights).unwrap();
    let table = "
        render random:60 --size 16x16 -o ./p.png: loading random:60; drawing random:60; writing ; 2000 of 2000
        render random:60 --size 16x16 --engine exact --repeat 3 -o ./p.png: drawing random:60; 2000 of 2000
        compare random:60 --size 16x16 --only -o ./c: float reference; standard24 by spans; 2000 of 2000
        needs random:60 --size 16x16: setting up every splat; the rows of every tile; the depths of every FIFO
        render ./h.csv --as surface --texture ./p.png --size 16x16 -o ./s.png: colours from ; drawing h.csv
        model random:60 --size 16x16: walking the rows of every tile
        stability --only cases --quick: measuring hard cases against exact arithmetic";
    for case in table.trim().lines() {
        let (line, expected) = case.split_once(": ").unwrap();
        let said = said(folder.path(), line);
        for words in expected.split("; ") {
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

#[test]
fn the_demo_writes_its_report() {
    let folder = tempfile::tempdir().unwrap();
    demo::run_into(folder.path(), [32, 32], 1).unwrap();
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
    let report: crate::report::Report = serde_json::from_str(&read("report.json")).unwrap();
    assert_eq!(report.table.len(), 10);
    let page = read("page.html");
    assert!(page.contains("brainsmall") && page.contains("id=\"scene\""));
}
