//! `splatline fit`: the smallest design within an error budget.

use super::output::{Outputs, write};
use super::resolve::{COMPARED, HELD_PIXEL_BYTES, NamedFrame, PlanRequest, room_for_picture};
use super::say::{Failure, print_result, warn};
use super::search_args::FitOptions;
use crate::design::DesignChoice;
use crate::explore::fit::{Fit, Fitness, Metric, Task, design_toml, fit};
use crate::plan::{DesignVariant, Engine};
use crate::progress::ProgressMeter;
use anyhow::anyhow;
use splatline::format::WIDTH_RANGES;
use std::fmt::Write;

pub fn run(options: &FitOptions) -> Result<(), Failure> {
    let mut outputs = Outputs::default();
    if let Some(path) = &options.output {
        outputs = outputs.file(path, &["toml"])?;
    }
    let asked = PlanRequest::work(&options.view, &options.work);
    let frames = asked.frames(&options.path, &options.more)?;
    outputs.spare_inputs()?;
    for frame in &frames {
        warn(&frame.prepared.setup_warnings()?);
    }
    let DesignVariant { design, traversal } = &frames[0].prepared.plan.entry;
    let fitted = fitted(&frames, options.metric, options.max_error)?;
    print_result(&text(design, &fitted))?;
    if frames.len() > 1 {
        print_result(&format!("over {} frames\n", frames.len()))?;
    }
    if let Some(path) = &options.output {
        let rounding = &design.resolved().rounding;
        let design = design_toml(&fitted.widths, rounding, *traversal);
        write(path, design.as_bytes())?;
    }
    Ok(())
}

/// Fits what is planned for all frames, starting from their design.
pub fn fitted(frames: &[NamedFrame], metric: Metric, budget: f64) -> Result<Fit, Failure> {
    let DesignVariant { design, traversal } = &frames[0].prepared.plan.entry;
    let mut references = Vec::with_capacity(frames.len());
    for NamedFrame { prepared, .. } in frames {
        room_for_picture(
            &prepared.plan.camera,
            COMPARED + HELD_PIXEL_BYTES * frames.len() as u64,
        )?;
        references.push(prepared.draw_reference(Engine::Float, &|_, _| ())?.picture);
    }
    let measure = |design: &DesignChoice| {
        let entry = DesignVariant {
            design: design.clone(),
            traversal: *traversal,
        };
        let mut errors = Vec::with_capacity(frames.len());
        for (frame, reference) in frames.iter().zip(&references) {
            let picture = frame.prepared.draw_fixed(&entry)?.picture;
            errors.push(Fitness::of(&picture, reference)?);
        }
        Ok(Fitness::over(&errors))
    };
    let task = Task {
        measure: &measure,
        metric,
        budget,
    };
    let progress = ProgressMeter::new(60);
    let (fitted, error) = fit(&task, design, &|width| {
        progress.doing(width);
        progress.advance();
    })?;
    Ok(fitted.ok_or_else(|| {
        let found = metric.of(&error);
        anyhow!("design {} itself has an error of {found:.3e}, above the budget of {budget:.3e}: start from a wider --design or allow more", design.name)
    })?)
}

/// Widths, errors, and what each last bit is worth.
pub fn text(start: &DesignChoice, fit: &Fit) -> String {
    let error = &fit.error;
    let mut text = format!(
        "largest error {:.3e}, rms {:.3e}, bias {:+.2e} after {} drawings; binding width: {}\n",
        error.max_abs,
        error.rms,
        error.bias,
        fit.drawings,
        fit.binding.unwrap_or("none")
    );
    // Writing to a String cannot fail.
    let _ = writeln!(
        text,
        "{:<14} {:>5} {:>5}   with one bit less: largest, rms, bias",
        "width", "start", "fit"
    );
    for ((name, ..), before) in WIDTH_RANGES.iter().zip(start.widths.numbers()) {
        let less = fit.one_bit_less.get(name).map_or_else(
            || "at its limit".to_owned(),
            |error| {
                format!(
                    "{:.3e}, {:.3e}, {:+.2e}",
                    error.max_abs, error.rms, error.bias
                )
            },
        );
        let _ = writeln!(
            text,
            "{name:<14} {before:>5} {:>5}   {less}",
            fit.widths[name]
        );
    }
    text
}
