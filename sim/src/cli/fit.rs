//! `splatline fit`: the smallest design within an error budget.

use super::engines;
use super::explore::reference;
use super::machine_args::{FitOptions, MetricChoice, WorkOptions};
use super::output::{self, write};
use super::progress::Progress;
use super::setup::{COMPARED, View, room_for_picture};
use super::{Failure, say, warn};
use crate::design::{DesignChoice, traversal_name};
use crate::explore::fit::{Fit, Metric, Task, design_toml, fit};
use anyhow::anyhow;
use splatline::format::{Traversal, WIDTH_RANGES};
use std::fmt::Write;

pub fn run(options: &FitOptions) -> Result<(), Failure> {
    if let Some(path) = &options.output {
        let mut inputs = options.view.inputs();
        inputs.extend(output::design_file(&options.work.design));
        output::check(path, &["toml"], &inputs)?;
    }
    let view = View::from_options(&options.view)?;
    let metric = match options.metric {
        MetricChoice::Largest => Metric::Largest,
        MetricChoice::Rms => Metric::Rms,
    };
    let start = DesignChoice::load(&options.work.design.0)?;
    warn(&engines::warnings(&view, &start));
    let fitted = fitted(&view, &options.work, metric, options.max_error)?;
    say(&text(&start, &fitted))?;
    if let Some(path) = &options.output {
        let traversal = options
            .work
            .traversal
            .map_or(start.traversal, Traversal::from);
        let design = design_toml(
            &fitted.widths,
            start.resolved().rounding,
            traversal_name(traversal),
        );
        write(path, design.as_bytes())?;
    }
    Ok(())
}

/// Fits a view, starting from the design of the options.
pub fn fitted(
    view: &View,
    work: &WorkOptions,
    metric: Metric,
    budget: f64,
) -> Result<Fit, Failure> {
    let start = DesignChoice::load(&work.design.0)?;
    let traversal = work.traversal.map_or(start.traversal, Traversal::from);
    room_for_picture(&view.camera, COMPARED)?;
    let reference = reference(view, work);
    let task = Task {
        scene: &view.scene,
        camera: &view.camera,
        rules: &view.rules,
        compositing: work.compositing.into(),
        traversal,
        reference: &reference,
        metric,
        budget,
    };
    let progress = Progress::new(60);
    let (fitted, error) = fit(&task, &start, &|width| {
        progress.doing(width);
        progress.advance();
    })?;
    Ok(fitted.ok_or_else(|| {
        let found = metric.of(&error);
        anyhow!("design {} itself has an error of {found:.3e}, above the budget of {budget:.3e}: start from a wider --design or allow more", start.name)
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
