//! `splatline stability`: the hard-case suite, with the verdict on each bar.

use super::setup::write;
use super::study_args::StabilityOptions;
use super::{Failure, say};
use splatline_sim::design::DesignChoice;
use splatline_sim::stability::{Extent, measure, steps, table};

/// Heads the page that `--markdown` writes.
const HEADING: &str = "# Stability on hard cases\n\nPrinted by `cargo run --release -- stability --markdown docs/stability.md`. \
Truth is exact rational arithmetic; `f32` is the usual formulas in single precision. The last column compares\n\
without any tolerance. Columns are explained in `sim/src/stability/mod.rs`.\n\n";

pub fn run(options: &StabilityOptions) -> Result<(), Failure> {
    let extent = if options.quick {
        Extent::QUICK
    } else {
        Extent::FULL
    };
    let lines = measure(&DesignChoice::all(), extent);
    if let Some(path) = &options.json {
        write(path, serde_json::to_string_pretty(&lines)?.as_bytes())?;
    }
    let studies = format!("{}\n{}", table::bounds(&lines), steps::markdown(extent));
    let page = format!("{}\n{studies}", table::markdown(&lines));
    match &options.markdown {
        Some(path) => {
            write(path, (HEADING.to_owned() + &page).as_bytes())?;
            say(&format!("{}\n{studies}", table::summary(&lines)));
        }
        None => say(&page),
    }
    Ok(())
}
