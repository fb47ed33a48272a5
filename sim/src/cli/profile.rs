//! `splatline profile`: which units, layers, ranges, widths and FIFO depths a scene exercises.

use super::fit;
use super::output::{Outputs, write, write_json_if};
use super::resolve::{NamedFrame, PlanRequest};
use super::say::{print_result, warn};
use super::search_args::ProfileOptions;
use crate::explore::fit::Fit;
use crate::explore::limits::{Limit, Quantity};
use crate::explore::profile::{Needs, SLACK, needs};
use crate::explore::statistics::{self, Statistics};
use crate::fixed;
use crate::machine::workload::Workload;
use crate::plan::{Prepared, Subject};
use crate::progress::ProgressMeter;
use crate::systems::SystemVerdict;
use anyhow::{Result, ensure};
use serde::Serialize;

const FORMAT: &str = "splatline-needs/1";

/// What one frame needs: the file's fields.
#[derive(Default, Serialize)]
struct FrameNeeds {
    fit: Option<Fit>,
    format: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    needs: Option<Needs>,
    scene: String,
    systems: Vec<SystemVerdict>,
    #[serde(skip_serializing_if = "Option::is_none")]
    workload: Option<Statistics>,
}

/// A file about several frames.
#[derive(Serialize)]
struct AllNeeds {
    format: &'static str,
    frames: Vec<FrameNeeds>,
}

pub fn run(options: &ProfileOptions) -> Result<()> {
    let outputs = Outputs::default()
        .json(options.json.as_ref())?
        .file(options.html.as_deref(), &["html"])?;
    let request = PlanRequest::of_frames(&options.frames).on(&options.machine);
    let frames = request.planned_frames()?;
    outputs.spare_inputs()?;
    let mut answers = Vec::with_capacity(frames.len());
    let mut before = None;
    for frame in frames {
        answers.push(one(frame.prepare(), options, &mut before)?);
    }
    if let Some(path) = &options.html {
        let frames = answers.iter();
        let drawn = frames.filter_map(|frame| Some((&*frame.scene, frame.workload.as_ref()?)));
        let drawn: Vec<(&str, &Statistics)> = drawn.collect();
        ensure!(
            !drawn.is_empty(),
            "--html: no frame is drawn by units that the machine has"
        );
        write(path, statistics::page("workload", &drawn))?;
    }
    let path = options.json.as_ref();
    if let [only] = &answers[..] {
        return write_json_if(path, only);
    }
    let (format, frames) = (FORMAT, answers);
    write_json_if(path, &AllNeeds { format, frames })
}

/// What one frame needs, which is also said; `before` is the work of the frame before.
fn one(
    frame: NamedFrame,
    options: &ProfileOptions,
    before: &mut Option<Workload>,
) -> Result<FrameNeeds> {
    let prepared = &frame.prepared;
    warn(&prepared.setup_warnings()?);
    let name = frame.name.as_str();
    let mut answer = FrameNeeds {
        format: FORMAT,
        scene: name.to_owned(),
        systems: prepared.systems(),
        ..FrameNeeds::default()
    };
    // Units and FIFOs are those of the machine, which draws plain splats.
    match prepared.subject()? {
        Subject::Splats(splats) if splats.are_composited() => {
            let (found, statistics, workload) = examined(prepared, before.as_ref())?;
            print_result(&text(name, &found))?;
            (answer.needs, answer.workload) = (Some(found), Some(statistics));
            *before = Some(workload);
        }
        Subject::Splats(splats) => {
            let count = splats.scene.splats.len();
            print_result(&format!(
                "{name}: {count} splats; the machine has no units for the technique that draws them\n"
            ))?;
        }
        Subject::Surface(scene, _) => {
            let count = scene.points.len();
            print_result(&format!("{name}: {count} points of a surface\n"))?;
        }
    }
    print_result(&systems_text(&answer.systems))?;
    let Some(budget) = options.max_error else {
        print_result("widths: give --max-error E to find the smallest ones within an error\n")?;
        return Ok(answer);
    };
    let design = prepared.plan.entry.design.clone();
    let limit = Limit::new(Quantity::LargestError, budget, "--max-error");
    let fitted = fit::fitted(vec![frame], &[limit], &[])?;
    print_result(&fit::text(&design, &fitted))?;
    answer.fit = Some(fitted);
    Ok(answer)
}

/// Units, ranges and FIFO depths of splats.
fn examined(
    prepared: &Prepared,
    before: Option<&Workload>,
) -> Result<(Needs, Statistics, Workload)> {
    let (splats, plan) = (prepared.splats()?, &prepared.plan);
    let progress = ProgressMeter::spinner("setting up every splat");
    let options = splats.options(&plan.entry);
    let footprints: Vec<_> = fixed::footprints(splats.scene, splats.camera, &options)
        .into_iter()
        .filter_map(Result::ok)
        .collect();
    progress.doing("walking the rows of every tile");
    let workload = prepared.workload()?;
    progress.doing("trying the depths of every FIFO");
    let peak_bits = plan.entry.design.widths.peak;
    let alpha_max = splats.rules.alpha_max;
    let statistics = Statistics::new(&workload, &plan.machine, before);
    let work = (&workload, &statistics);
    let needs = needs(work, &footprints, peak_bits, alpha_max, &plan.machine);
    Ok((needs, statistics, workload))
}

fn systems_text(systems: &[SystemVerdict]) -> String {
    let line = |verdict: &SystemVerdict| {
        let used = if verdict.used { "used" } else { "not needed" };
        format!(
            "  {:>2} {:<48} {used}: {}\n",
            verdict.number, verdict.name, verdict.reason
        )
    };
    let lines: String = systems.iter().map(line).collect();
    format!("systems of the papers:\n{lines}")
}

fn text(name: &str, needs: &Needs) -> String {
    let mut text = format!("{name}: {} visible splats\nunits:\n", needs.visible);
    for (unit, verdict) in &needs.units {
        text += &format!("  {unit:<18} {verdict}\n");
    }
    text += &format!(
        "FIFOs (depth within {} % of the cycles of deep ones; fullest when deep):\n",
        SLACK * 100.0
    );
    for ((name, depth), high) in needs.fifo_depths.iter().zip(needs.fifo_high_water.values()) {
        text += &format!("  {name:<18} {depth:>5} {high:>6}\n");
    }
    let [columns, rows] = needs.largest_box;
    text += &format!(
        "layers: at most {} in a pixel; longest tile list {}; largest box {columns} x {rows}; longest run {}\n",
        needs.deepest_pixel, needs.longest_tile_list, needs.longest_run
    );
    if let (Some([low, high]), Some([most, least])) = (needs.curvature_log2, needs.peaks) {
        text += &format!(
            "ranges: curvature 2^{low} to 2^{high} per square pixel; peak opacity {least:.5} to {most:.5}\n"
        );
    }
    text
}
