//! `splatline` alone: an embedded real volume by all designs against float, with a report in `out/`.

use super::args::{Engine, Size};
use super::compare::{all_entries, create_folder};
use super::setup::{View, threads};
use super::sweep::{self, Entry, Manner};
use super::{Failure, say, warn};
use crate::design::DesignChoice;
use crate::machine::Config;
use crate::picture::{Backdrop, Depth};
use crate::report::table;
use crate::rules::Compositing;
use crate::scene;
use anyhow::Context;
use std::path::Path;

const SIZE: Size = Size {
    width: 512,
    height: 512,
};
const DESIGN: &str = "standard24";
/// Times are medians over this many runs: the first one also pays for cold caches.
const REPEAT: usize = 3;

pub fn run() -> Result<(), Failure> {
    run_into(Path::new("out"), SIZE, REPEAT)
}

/// The demo with another folder, size and number of runs, for tests.
pub fn run_into(folder: &Path, size: Size, repeat: usize) -> Result<(), Failure> {
    create_folder(folder)?;
    let scene = scene::demo()?;
    let camera = scene.default_camera(size.width, size.height);
    let rules = scene.natural_rules;
    let view = View {
        scene,
        camera,
        rules,
        warnings: Vec::new(),
        prepare_s: 0.0,
    };
    let manner = Manner {
        compositing: Compositing::FrontToBack,
        threads: threads(None),
        repeat,
        hybrid: None,
        machine: Config::default(),
    };
    let design = DesignChoice::named(DESIGN).context("the demo's design has no name")?;
    let chosen = Entry {
        traversal: design.traversal,
        design,
    };
    let comparison = sweep::run(
        &view,
        &manner,
        Engine::Float,
        &chosen,
        &all_entries(&chosen.design),
    )?;
    comparison.write_as(folder, Depth::Eight, Backdrop::default())?;
    let live = folder.join("page.html");
    super::page::write_page(&view, &chosen, None, &live)?;
    let report = &comparison.report;
    warn(&report.warnings);
    say(&format!(
        "{}: {} splats at {}x{}, fixed point against float\n\n{}\nThe pictures and how to read them: {}\nThe same scene to turn, with the widths on sliders: {}\n",
        report.scene.name,
        report.scene.splats,
        size.width,
        size.height,
        table::plain(&report.table),
        folder.join("report.html").display(),
        live.display(),
    ))?;
    Ok(())
}
