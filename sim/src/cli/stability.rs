//! `splatline stability`: the hard-case suite and the classes of scenes, with the verdict on each bar.

use super::output::{Outputs, write, write_json_if};
use super::say::print_result;
use super::verification_args::{StabilityOptions, StabilitySection};
use crate::design::DesignChoice;
use crate::progress::ProgressMeter;
use crate::stability::scenes::classes::Size;
use crate::stability::scenes::{self, SceneLine};
use crate::stability::{StabilityExtent, StabilityLine, measure, steps, table};
use anyhow::Result;

/// Heads the page that `--markdown` writes.
const HEADING: &str = "\
# Hard cases

Does fixed point hold where scenes are hard: far from the origin, needle-shaped, nearly transparent, in deep stacks? How far each design is from the truth,
beside the usual formulas in single precision (`f32`). [The error analysis](../error-analysis.md) derives the bounds.

Printed by `cargo run --release -- stability --markdown docs/results/stability.md`; do not edit. All figures are in the CSV files beside it.

";

const CASES: &str = "\
## Sixteen splats a case, stage by stage

The truth is exact rational arithmetic, and stages are compared without any tolerance (`sim/src/stability/mod.rs`). All cases: [stability-cases.csv](stability-cases.csv).

";

const SCENES: &str = "\
## Scenes as people have them

Each scene is drawn at 512x512 under the `3dgs` rules and compared with double precision: PSNR in dB, largest error and bias, in units of the picture's largest
sample (at least 1), over all pixels, without clamping. `standard24` must reach 100 dB, or what `f32` reaches less 3 dB. [stability-scenes.csv](stability-scenes.csv)
also has PSNR over the pixels at which nothing was decided otherwise than by the reference, decisions at the smallest opacity (\"added\", \"removed\"), pixels that
another splat finished (\"stopped early\", \"late\"), and splats lost. `sim/reference/src/hard/classes.rs` makes the scenes.

";

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
    let (size, extent) = if options.quick {
        (Size::QUICK, StabilityExtent::QUICK)
    } else {
        (Size::FULL, StabilityExtent::FULL)
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
        measured.cases = measure(&DesignChoice::all(), extent);
        let lines = &measured.cases;
        let bars = table::summary(lines);
        let studies = format!("{}\n{}", table::bounds(lines), steps::markdown(extent));
        page += &format!("{CASES}{bars}\n{studies}");
        summary += &format!("{bars}\n{studies}");
    }
    drop(progress);
    write_json_if(options.json.as_ref(), &measured)?;
    if let Some(path) = &options.markdown {
        write(path, (HEADING.to_owned() + &page).as_bytes())?;
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        let beside = |name: &str| path.with_file_name(format!("{stem}-{name}.csv"));
        let scenes = scenes::table::csv(&measured.scenes);
        write(&beside("scenes"), scenes.as_bytes())?;
        write(&beside("cases"), table::csv(&measured.cases).as_bytes())?;
    }
    print_result(&summary)
}
