//! `splatline compare`: fixed point against the reference, with pictures and a report.

use super::args::{CompareOptions, DesignChoice, Engine, NAMED_DESIGNS, TraversalChoice};
use super::drawing::Design;
use super::setup::{View, check_folder_of, threads, write};
use super::sweep::{self, Entry, Manner};
use super::{Failure, engines, say};
use anyhow::{Context, Result};
use splatline_sim::report::table::{decibels, scientific, signed};
use splatline_sim::report::{ChannelFacts, Report};
use std::path::Path;

pub fn run(options: &CompareOptions) -> Result<(), Failure> {
    let drawing = &options.drawing;
    create_folder(&options.output)?;
    drawing.json.as_deref().map_or(Ok(()), check_folder_of)?;
    let view = View::from_options(&options.view)?;
    let manner = Manner {
        compositing: drawing.compositing.into(),
        threads: threads(drawing.threads),
        repeat: drawing.repeat,
    };
    // The fixed picture is always drawn; the option can only say what it is compared with.
    let reference = if drawing.engine == Engine::Exact { Engine::Exact } else { Engine::Float };
    let design = engines::design(&drawing.design)?;
    let chosen = Entry { traversal: drawing.traversal.unwrap_or(design.own_traversal), design };
    let others = if options.only { Vec::new() } else { all_entries(&chosen)? };
    let comparison = sweep::run(&view, &manner, reference, &chosen, &others)?;
    comparison.write(&options.output, drawing.depth)?;
    if let Some(path) = &drawing.json {
        write(path, comparison.report.to_json()?.as_bytes())?;
    }
    say(&summary(&comparison.report, &options.output));
    Ok(())
}

/// The folder for results, made if need be.
pub fn create_folder(folder: &Path) -> Result<(), Failure> {
    std::fs::create_dir_all(folder).with_context(|| format!("cannot create the folder '{}'", folder.display()))?;
    Ok(())
}

/// Every named design by both traversals, and the chosen design by both if it is none of them.
pub fn all_entries(chosen: &Entry) -> Result<Vec<Entry>> {
    let named = NAMED_DESIGNS.into_iter().map(|name| engines::design(&DesignChoice::Named(name)));
    let mut designs = named.collect::<Result<Vec<_>>>()?;
    if !designs.iter().any(|design| design.name == chosen.design.name && design.facts == chosen.design.facts) {
        designs.push(chosen.design.clone());
    }
    let both = |design: &Design| TraversalChoice::ALL.map(|traversal| Entry { design: design.clone(), traversal });
    Ok(designs.iter().flat_map(both).collect())
}

/// The chosen design's errors.
fn summary(report: &Report, folder: &Path) -> String {
    let line = |name: &str, error: &ChannelFacts| {
        format!(
            "{name:<6} PSNR {} dB, max error {}, bias {}, SSIM {:.6}\n",
            decibels(error),
            scientific(error.max_abs),
            signed(error.bias),
            error.ssim
        )
    };
    let errors = report.error.iter().map(|error| line("RGB", &error.rgb) + &line("alpha", &error.alpha));
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
