//! `splatline compare`: fixed point against the reference, with pictures and a report.

use super::args::{CompareOptions, Engine};
use super::model::machine;
use super::output::{self, write};
use super::render::if_nothing_is_seen;
use super::setup::{COMPARED, View, room_for_picture};
use super::sweep::{self, Entry, Manner};
use super::{Failure, complain, say, warn};
use crate::design::DesignChoice;
use crate::report::table::{decibels, scientific, signed};
use crate::report::{ChannelFacts, Report};
use anyhow::Context;
use splatline::format::Traversal;
use std::path::Path;

pub fn run(options: &CompareOptions) -> Result<(), Failure> {
    let drawing = &options.drawing;
    let inputs = [options.view.inputs(), options.surface.inputs()].concat();
    let own = [drawing.inputs(), options.machine.machine.clone()];
    let inputs = [inputs, output::files(own.iter().map(Option::as_ref))].concat();
    output::check_folder(&options.output, &sweep::FILES, &inputs)?;
    if let Some(json) = &drawing.json {
        output::check(json, &["json"], &inputs)?;
    }
    create_folder(&options.output)?;
    if options.surface.kind.is_some() {
        return super::surface::compare_with_float(options);
    }
    let view = View::from_options(&options.view)?;
    room_for_picture(&view.camera, COMPARED)?;
    let manner = Manner {
        machine: machine(&options.machine)?,
        ..Manner::from_options(drawing, &view)?
    };
    // The fixed picture is always drawn; the option can only say what it is compared with.
    let reference = if drawing.engine == Engine::Exact {
        Engine::Exact
    } else {
        Engine::Float
    };
    let chosen = Entry::from_options(drawing)?;
    // Points and stamps have one traversal only.
    let others = if options.only || manner.hybrid.is_some() {
        Vec::new()
    } else {
        all_entries(&chosen.design)
    };
    let comparison = sweep::run(&view, &manner, reference, &chosen, &others)?;
    comparison.write(&options.output, drawing)?;
    if let Some(path) = &drawing.json {
        write(path, comparison.report.to_json()?.as_bytes())?;
    }
    warn(&comparison.report.warnings);
    complain(&if_nothing_is_seen(&comparison.fixed, &comparison.report));
    say(&summary(&comparison.report, &options.output))?;
    Ok(())
}

/// The folder for results, made if need be.
pub fn create_folder(folder: &Path) -> Result<(), Failure> {
    std::fs::create_dir_all(folder)
        .with_context(|| format!("cannot create the folder '{}'", folder.display()))?;
    Ok(())
}

/// Every named design by both traversals, and the chosen design by both if it is none of them.
pub fn all_entries(chosen: &DesignChoice) -> Vec<Entry> {
    let mut designs = DesignChoice::all();
    if !designs.contains(chosen) {
        designs.push(chosen.clone());
    }
    let both = |design: &DesignChoice| {
        [Traversal::Box, Traversal::Spans].map(|traversal| Entry {
            design: design.clone(),
            traversal,
        })
    };
    designs.iter().flat_map(both).collect()
}

/// The chosen design's errors.
pub fn summary(report: &Report, folder: &Path) -> String {
    let line = |name: &str, error: &ChannelFacts| {
        let covered = &error.covered;
        format!(
            "{name:<6} PSNR {} dB, max error {}, bias {}, SSIM {:.6}; over the {} covered pixels PSNR {} dB, bias {}, SSIM {:.6}\n",
            decibels(error.psnr_db),
            scientific(error.max_abs),
            signed(error.bias),
            error.ssim,
            covered.pixels,
            decibels(covered.psnr_db),
            signed(covered.bias),
            covered.ssim,
        )
    };
    let errors = report
        .error
        .iter()
        .map(|error| line("RGB", &error.rgb) + &line("alpha", &error.alpha));
    format!(
        "{}, design {} by {}, against {}\n{}{}\n",
        report.scene.name,
        report.design_name(),
        report.traversal.as_deref().unwrap_or("-"),
        report.reference.as_deref().unwrap_or("-"),
        errors.collect::<String>(),
        folder.join("report.html").display(),
    )
}
