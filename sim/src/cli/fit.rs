//! `splatline fit`: the smallest design within an error budget.

use super::output::{Outputs, write};
use super::resolve::{NamedFrame, PlanRequest};
use super::say::{Failure, print_result, warn};
use super::search_args::{FitOptions, subject};
use crate::design::DesignChoice;
use crate::explore::fit::{Fit, design_toml, fit};
use crate::explore::limits::{Limit, Quantity};
use crate::plan::DesignVariant;
use crate::progress::ProgressMeter;
use anyhow::anyhow;
use splatline::format::WIDTH_RANGES;
use std::fmt::Write;

pub fn run(options: &FitOptions) -> Result<(), Failure> {
    let mut outputs = Outputs::default();
    if let Some(path) = &options.output {
        outputs = outputs.file(path, &["toml"])?;
    }
    let request = PlanRequest::work(&options.view, &options.work);
    let frames = request.frames(&options.path, &options.more)?;
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
pub fn fitted(frames: &[NamedFrame], metric: Quantity, budget: f64) -> Result<Fit, Failure> {
    let mut subject = subject(frames, true)?;
    subject.traversal = Some(frames[0].prepared.plan.entry.traversal);
    let limit = Limit::new(metric, budget, "--max-error");
    let progress = ProgressMeter::spinner("searching");
    let (fitted, error) = fit(&subject, &limit, &|what| progress.doing(what))?;
    Ok(fitted.ok_or_else(|| {
        let found = metric.of_error(&error).unwrap_or_default();
        let name = &subject.design.name;
        anyhow!("design {name} itself has an error of {found:.3e}, above the budget of {budget:.3e}: start from a wider --design or allow more")
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
