//! `splatline stability`: the hard-case suite and the classes of scenes, with the verdict on each bar.

use super::output::{Outputs, write, write_json_if};
use super::say::print_result;
use super::verification_args::{StabilityOptions, StabilitySection};
use crate::design::DesignChoice;
use crate::progress::ProgressMeter;
use crate::stability::scenes::classes::Size;
use crate::stability::scenes::{self, SceneLine};
use crate::stability::{StabilityLine, measure, steps, table};
use anyhow::Result;

/// Heads the page that `--markdown` writes.
const HEADING: &str = include_str!("../stability/page/heading.md");
const CASES: &str = include_str!("../stability/page/cases.md");
const SCENES: &str = include_str!("../stability/page/scenes.md");

/// Everything measured, as JSON.
#[derive(Default, serde::Serialize)]
struct MeasuredLine {
    cases: Vec<StabilityLine>,
    scenes: Vec<SceneLine>,
}

pub fn run(options: &StabilityOptions) -> Result<()> {
    Outputs::default()
        .json(options.json.as_ref())?
        .file(options.markdown.as_deref(), &["md"])?
        .spare_inputs()?;
    let wants = |section| options.only.is_empty() || options.only.contains(&section);
    let mut measured = MeasuredLine::default();
    let size = if options.quick {
        Size::QUICK
    } else {
        Size::FULL
    };
    let progress = ProgressMeter::spinner("stability");
    let (mut page, mut summary) = (String::new(), String::new());
    if wants(StabilitySection::Scenes) {
        progress.doing("drawing scenes as people have them");
        measured.scenes = scenes::measure(size, options.seed);
        let table = scenes::table::markdown(&measured.scenes);
        page += &format!("{SCENES}{table}\n");
        summary += &format!("{table}\n");
    }
    if wants(StabilitySection::Cases) {
        progress.doing("measuring hard cases against exact arithmetic");
        measured.cases = measure(&DesignChoice::all(), options.quick);
        let lines = &measured.cases;
        let bars = table::summary(lines);
        let studies = format!(
            "{}\n{}",
            table::bounds(lines),
            steps::markdown(options.quick)
        );
        page += &format!("{CASES}{bars}\n{studies}");
        summary += &format!("{bars}\n{studies}");
    }
    drop(progress);
    write_json_if(options.json.as_ref(), &measured)?;
    if let Some(path) = &options.markdown {
        write(path, HEADING.to_owned() + &page)?;
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        let beside = |name: &str| path.with_file_name(format!("{stem}-{name}.csv"));
        write(&beside("scenes"), scenes::table::csv(&measured.scenes))?;
        write(&beside("cases"), table::csv(&measured.cases))?;
    }
    print_result(&summary)
}
