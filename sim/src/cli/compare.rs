//! `splatline compare`: fixed point against the reference, with pictures and a report.

use super::args::CompareOptions;
use super::frames;
use super::output::{Outputs, write_json_if};
use super::photos;
use super::resolve::{COMPARED, PlanRequest, room_for_picture};
use super::say::{print_error, print_result, usage, warn};
use super::summary::{if_layers_were_merged, if_nothing_is_seen, of_comparison};
use crate::plan::measure::FILES;
use crate::plan::{Engine, Prepared, all_entries, compare_all};
use anyhow::Result;

pub fn run(options: &CompareOptions) -> Result<()> {
    let drawing = &options.drawing;
    let json = drawing.json.as_ref();
    if let Some(folder) = &options.photographs.photos {
        return photos::run(options, folder, Outputs::default().json(json)?);
    }
    if options.path.is_path() {
        return frames::compare(options, Outputs::default().json(json)?);
    }
    let outputs = Outputs::default()
        .folder(Some(&options.output), &FILES)?
        .json(json)?;
    let request = PlanRequest::drawing(&options.view, drawing).on(&options.machine);
    let mut prepared = request.prepare()?;
    outputs.spare_inputs()?;
    against_reference(&mut prepared)?;
    let others = if options.only || !prepared.has_traversals() {
        Vec::new()
    } else {
        all_entries(&prepared.plan.entry.design)
    };
    let mut comparison = compare_all(&prepared, &drawing.effort(), &others)?;
    if options.formats {
        comparison.add_formats(&prepared)?;
    }
    comparison.write(&options.output, drawing.depth, drawing.backdrop())?;
    let report = &comparison.report;
    write_json_if(json, report)?;
    warn(&report.warnings);
    print_error(&if_layers_were_merged(comparison.merged));
    print_error(&if_nothing_is_seen(
        &comparison.fixed,
        report,
        Some(drawing.depth.steps()),
        drawing.backdrop(),
    ));
    print_result(&of_comparison(report, &options.output))
}

/// The fixed picture is always drawn; the engine asked for can only say what it is compared with. Refuses pictures that
/// memory does not hold.
pub fn against_reference(prepared: &mut Prepared) -> Result<()> {
    let plan = &mut prepared.plan;
    let reference = match plan.reference.unwrap_or(plan.engine) {
        Engine::Exact => Engine::Exact,
        Engine::Float | Engine::Fixed => Engine::Float,
        format => {
            let message = format!(
                "--engine {} is compared and not compared with: --formats adds it to the report; the reference is float or exact",
                format.name()
            );
            return Err(usage(message));
        }
    };
    (plan.engine, plan.reference) = (Engine::Fixed, Some(reference));
    room_for_picture(&plan.camera, COMPARED)
}
