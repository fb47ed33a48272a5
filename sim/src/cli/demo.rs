//! `splatline` alone: an embedded real volume by all designs against float, with a report in `out/`.

use super::args::{DesignChoice, Engine, Size};
use super::compare::{all_entries, create_folder};
use super::setup::{View, threads};
use super::sweep::{self, Entry, Manner};
use super::{Failure, engines, say};
use splatline_sim::report::table;
use splatline_sim::rules::Compositing;
use std::path::Path;

const SIZE: Size = Size { width: 512, height: 512 };
const DESIGN: DesignChoice = DesignChoice::Named("standard24");

pub fn run() -> Result<(), Failure> {
    run_into(Path::new("out"), SIZE)
}

/// The demo with another folder and size, for tests.
pub fn run_into(folder: &Path, size: Size) -> Result<(), Failure> {
    create_folder(folder)?;
    let scene = engines::demo_scene()?;
    let camera = engines::default_camera(&scene, size)?;
    let rules = scene.natural_rules;
    let view = View { scene, camera, rules };
    let manner = Manner { compositing: Compositing::FrontToBack, threads: threads(None), repeat: 1 };
    let design = engines::design(&DESIGN)?;
    let chosen = Entry { traversal: design.own_traversal, design };
    let comparison = sweep::run(&view, &manner, Engine::Float, &chosen, &all_entries(&chosen)?)?;
    comparison.write(folder, 8)?;
    let report = &comparison.report;
    say(&format!(
        "{}: {} splats at {}x{}, fixed point against float\n\n{}\nThe pictures and how to read them: {}\n",
        report.scene.name,
        report.scene.splats,
        size.width,
        size.height,
        table::plain(&report.table),
        folder.join("report.html").display(),
    ));
    Ok(())
}
