//! `splatline fit`: the smallest design within an error budget.

use super::output::{Outputs, write};
use super::resolve::{NamedFrame, PlanRequest};
use super::say::{print_result, warn};
use super::search_args::{FitOptions, draw_references, limits_given, subject};
use crate::design::DesignChoice;
use crate::explore::evaluator::{DesignError, Evaluator};
use crate::explore::fit::{Fit, fit, refusal};
use crate::explore::formats;
use crate::explore::limits::Limit;
use crate::plan::Engine;
use crate::progress::ProgressMeter;
use anyhow::{Result, anyhow};
use splatline::format::WIDTH_RANGES;

pub fn run(options: &FitOptions) -> Result<()> {
    let outputs = Outputs::default().file(options.output.as_deref(), &["toml"])?;
    let frames = PlanRequest::of_frames(&options.frames).frames()?;
    outputs.spare_inputs()?;
    for frame in &frames {
        warn(&frame.prepared.setup_warnings()?);
    }
    let limits = limits_given(options.errors.asked(options.metric));
    let (count, design) = (frames.len(), frames[0].prepared.plan.entry.design.clone());
    let fitted = fitted(frames, &limits, &options.formats.formats)?;
    let mut told = text(&design, &fitted) + &formats::text(&fitted.formats);
    if count > 1 {
        told += &format!("over {count} frames\n");
    }
    print_result(&told)?;
    if let Some(path) = &options.output {
        write(path, fitted.design.to_toml())?;
    }
    Ok(())
}

/// Fits what is planned for all frames, starting from their design.
pub fn fitted(frames: Vec<NamedFrame>, limits: &[Limit], formats: &[Engine]) -> Result<Fit> {
    let mut subject = subject(frames)?;
    draw_references(&mut subject)?;
    subject.traversal = Some(subject.frames[0].plan.entry.traversal);
    subject.formats = formats.to_vec();
    let progress = ProgressMeter::spinner("searching");
    let mut evaluator = Evaluator::within(subject, limits);
    let (fitted, error) = fit(&mut evaluator, limits, &|what| progress.doing(what))?;
    fitted.ok_or_else(|| anyhow!(refusal(&evaluator.subject.design.name, limits, &error)))
}

/// Widths, errors, and what each last bit is worth.
pub fn text(start: &DesignChoice, fit: &Fit) -> String {
    let error = &fit.error;
    let seen = error.detail.map_or_else(String::new, |detail| {
        let (p99, flip) = (detail.percentiles.p99, detail.flip);
        format!(", 99 % within {p99:.3e}, FLIP {flip:.3e}")
    });
    let (drawings, binding) = (fit.drawings, fit.binding.as_deref().unwrap_or("none"));
    let mut text = format!(
        "largest error {:.3e}, rms {:.3e}, bias {:+.2e}{seen} after {drawings} drawings; binding width: {binding}\n\
         width          start   fit   with one bit less: largest, rms, bias\n",
        error.max_abs, error.rms, error.bias
    );
    let worse = |e: &DesignError| format!("{:.3e}, {:.3e}, {:+.2e}", e.max_abs, e.rms, e.bias);
    for ((name, ..), before) in WIDTH_RANGES.iter().zip(start.widths.numbers()) {
        let less = fit.one_bit_less.get(*name).map(worse);
        let (bits, less) = (fit.widths[name], less.unwrap_or("at its limit".to_owned()));
        text += &format!("{name:<14} {before:>5} {bits:>5}   {less}\n");
    }
    text
}
