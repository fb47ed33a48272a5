//! `splatline` alone: an embedded real volume by all designs against float, with a report in `out/`.

use super::output::create_folder;
use super::say::{print_result, warn};
use crate::design::DesignChoice;
use crate::picture::{Backdrop, Depth};
use crate::plan::{Effort, Prepared, Source, all_entries, compare_all};
use crate::report::table;
use crate::scene;
use anyhow::{Context, Result};
use std::path::Path;
use std::time::Duration;

const SIZE: [usize; 2] = [512, 512];
const DESIGN: &str = "standard24";
/// Times are medians over this many runs, since the first one also pays for cold caches, ...
const REPEAT: usize = 3;
/// ... but a newcomer waits for ten drawings: what is slow, for which caches matter less, is drawn once.
const LIMIT: Duration = Duration::from_millis(300);

pub fn run() -> Result<()> {
    run_into(Path::new("out"), SIZE, REPEAT)
}

/// The demo with another folder, size and number of runs, for tests.
pub fn run_into(folder: &Path, [width, height]: [usize; 2], repeat: usize) -> Result<()> {
    create_folder(folder)?;
    let scene = scene::demo()?;
    let camera = scene.default_camera(width, height);
    let rules = scene.natural_rules;
    let design = DesignChoice::named(DESIGN).context("the demo's design has no name")?;
    let others = all_entries(&design);
    let mut prepared = Prepared::of_splats(scene, camera, rules, design);
    prepared.plan.source = Source::splats("demo".into());
    let effort = Effort {
        limit: LIMIT,
        ..Effort::new(None, repeat)
    };
    let comparison = compare_all(&prepared, &effort, &others)?;
    comparison.write(folder, Depth::Eight, Backdrop::default())?;
    let live = folder.join("page.html");
    super::page::write_page(&prepared, None, &live)?;
    let report = &comparison.report;
    warn(&report.warnings);
    print_result(&format!(
        "{}: {} splats at {width}x{height}, fixed point against float\n\n{}\nThe pictures and how to read them: {}\nThe same scene to turn, with the widths on sliders: {}\n",
        report.scene.name,
        report.scene.splats,
        table::plain(&report.table),
        folder.join("report.html").display(),
        live.display(),
    ))
}
