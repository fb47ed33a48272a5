//! `splatline stability`: the hard-case suite and the classes of scenes, with the verdict on each bar.

use super::output::write;
use super::say::{Failure, print_result};
use super::verification_args::{StabilityOptions, StabilitySection};
use crate::design::DesignChoice;
use crate::progress::ProgressMeter;
use crate::stability::scenes::classes::Size;
use crate::stability::scenes::{self, SceneLine};
use crate::stability::{StabilityExtent, StabilityLine, measure, steps, table};

/// Heads the page that `--markdown` writes.
const HEADING: &str = "# Stability on hard cases\n\nThis page is for whoever wants to know whether fixed point holds where scenes are hard: far from the \
origin, needle-shaped, nearly transparent, in deep stacks. It says how far each design is from the truth, stage by\nstage, beside \
the usual formulas in single precision (`f32`). [The error analysis](error-analysis.md) derives the bounds.\n\nPrinted by `cargo \
run --release -- stability --markdown docs/results/stability.md`; do not edit.\n\n";

const CASES: &str = "## Sixteen splats a case, stage by stage\n\nThe truth is exact rational arithmetic, and `f32` is the usual formulas in single \
precision. The last column names the stages in which an engine is worse than `f32`, compared without any \
tolerance.\n`sim/src/stability/mod.rs` explains the columns.\n\n";

const SCENES: &str = "## Scenes as people have them\n\nEach scene is drawn at 512x512 under the `3dgs` rules and compared with double precision; \
`--only scenes` prints this part alone. All pixels count, those on a threshold too. Differences are in units of the\npicture's \
largest sample (at least 1), and no sample is clamped.\n\n- \"where nothing flips\" is PSNR over the pixels at which nothing was \
decided otherwise than by the reference.\n- \"added\" and \"removed\" count pairs of a splat and a pixel that were decided \
otherwise at the smallest opacity, 1/255, \"of\" all pairs that the reference blends.\n- \"stopped early\" and \"late\" count \
pixels that another splat than the reference's finished.\n- \"lost\" are splats that were culled although the reference draws \
them.\n\n`sim/src/stability/scenes/mod.rs` explains the engines, `sim/reference/src/hard/classes.rs` the scenes.\n\n";

/// Everything measured, as JSON.
#[derive(serde::Serialize)]
struct MeasuredLine {
    cases: Vec<StabilityLine>,
    scenes: Vec<SceneLine>,
}

pub fn run(options: &StabilityOptions) -> Result<(), Failure> {
    let wants = |section| options.only.is_empty() || options.only.contains(&section);
    let mut measured = MeasuredLine {
        cases: Vec::new(),
        scenes: Vec::new(),
    };
    let progress = ProgressMeter::spinner("stability");
    let (mut page, mut summary) = (String::new(), String::new());
    if wants(StabilitySection::Scenes) {
        let size = if options.quick {
            Size::QUICK
        } else {
            Size::FULL
        };
        progress.doing("drawing scenes as people have them");
        measured.scenes = scenes::measure(size, options.seed);
        page += &format!("{SCENES}{}\n", scenes::table::markdown(&measured.scenes));
        summary += &format!("{}\n", scenes::table::verdicts(&measured.scenes));
    }
    if wants(StabilitySection::Cases) {
        let extent = if options.quick {
            StabilityExtent::QUICK
        } else {
            StabilityExtent::FULL
        };
        progress.doing("measuring hard cases against exact arithmetic");
        measured.cases = measure(&DesignChoice::all(), extent);
        let lines = &measured.cases;
        let studies = format!("{}\n{}", table::bounds(lines), steps::markdown(extent));
        page += &format!("{CASES}{}\n{studies}", table::markdown(lines));
        summary += &format!("{}\n{studies}", table::summary(lines));
    }
    drop(progress);
    if let Some(path) = &options.json {
        write(path, serde_json::to_string_pretty(&measured)?.as_bytes())?;
    }
    match &options.markdown {
        Some(path) => {
            write(path, (HEADING.to_owned() + &page).as_bytes())?;
            print_result(&summary)?;
        }
        None => print_result(&page)?,
    }
    Ok(())
}
