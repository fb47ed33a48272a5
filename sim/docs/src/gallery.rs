//! The gallery: every plan of a folder as a picture, its reference and the map of their differences, with the record's
//! figures.
//!
//! What the command line cannot draw is not shown: a plan is drawn by the library functions that
//! `splatline compare --plan` runs. A plan's first line of comment is its heading, the lines after it say what to see.

use crate::pages::picture::beside;
use anyhow::{Context, Result};
use clap::Args;
use splatline_sim::cli::{create_folder, print_result, write};
use splatline_sim::metrics::ChannelError;
use splatline_sim::plan::golden;
use splatline_sim::plan::{Comparison, Effort, Prepared, compare_all};
use splatline_sim::progress::ProgressMeter;
use splatline_sim::report::png::Rgb;
use std::path::{Path, PathBuf};

/// What the help ends with.
pub const GALLERY_EXAMPLES: &str = "\
Examples:
  splatline-docs gallery
  splatline-docs gallery --plans my_plans -o out";

/// Which plans are drawn, and where to.
#[derive(Debug, Args)]
pub struct GalleryOptions {
    /// Folder of plan files
    #[arg(long, value_name = "DIR", default_value = "sim/plans")]
    pub plans: PathBuf,
    /// How many times as large as the plan says pictures are, across and down
    #[arg(long, value_name = "N", default_value = "3", value_parser = clap::value_parser!(u16).range(1..=64))]
    pub enlarge: u16,
    /// Folder to write README.md and the pictures into
    #[arg(short, long, value_name = "DIR", default_value = "docs/gallery")]
    pub output: PathBuf,
}

/// Draws all plans and writes the page.
pub fn run(options: &GalleryOptions) -> Result<()> {
    create_folder(&options.output)?;
    let plans = golden::plans(&options.plans)?;
    let progress = ProgressMeter::new(plans.len());
    let mut page = heading(options);
    for (name, path) in &plans {
        progress.doing(name.clone());
        let text = std::fs::read_to_string(path).context(name.clone())?;
        let comparison = drawn(path, options.enlarge).context(name.clone())?;
        let file = options.output.join(format!("{name}.png"));
        write(&file, &panels(&comparison).to_png()?)?;
        page += &section(name, &caption(name, &text), &comparison);
        progress.advance();
    }
    drop(progress);
    write(&options.output.join("README.md"), page)?;
    print_result(&format!(
        "{} plans in {}\n",
        plans.len(),
        options.output.display()
    ))
}

/// The plan's picture, larger than it says, beside its reference.
fn drawn(path: &Path, enlarge: u16) -> Result<Comparison> {
    let prepared = Prepared::from_file(path, &|_| ())?;
    let camera = &prepared.plan.camera;
    let [width, height] = [camera.width, camera.height].map(|side| side * usize::from(enlarge));
    let larger = prepared.seen_by(camera.resized(width, height)?);
    compare_all(&larger, &Effort::new(None, 1), &[])
}

/// The kernel's picture, the reference's and the error map, side by side.
fn panels(comparison: &Comparison) -> Rgb {
    let [fixed, float] = [&comparison.fixed, &comparison.float].map(Rgb::on_black);
    beside(&[fixed, float, comparison.map.to_rgb()])
}

/// A plan's title and text as a page shows them.
fn caption(name: &str, text: &str) -> (String, String) {
    let mut lines = text
        .lines()
        .map_while(|line| line.strip_prefix('#'))
        .map(str::trim);
    let title = lines.next().unwrap_or(name).to_owned();
    (title, lines.collect::<Vec<_>>().join(" "))
}

fn heading(options: &GalleryOptions) -> String {
    format!(
        "# Gallery\n\nPrinted by `cargo run --release -p splatline-docs -- gallery`; do not edit. Every picture is a plan of `{}`, {} times as large across and down; \
         `splatline compare --plan FILE` draws it. From left to right: the kernel, the reference, and the difference of both, warm where the kernel is brighter.\n",
        options.plans.display(),
        options.enlarge
    )
}

/// A plan's heading, picture and figures.
fn section(name: &str, (title, text): &(String, String), comparison: &Comparison) -> String {
    let mut section = format!("\n## {title}\n\n{text}\n\n![{title}]({name}.png)\n");
    if let Some(error) = &comparison.report.error {
        section += "\n| | PSNR dB | largest error | bias |\n|---|--:|--:|--:|\n";
        for (group, facts) in [("colour", &error.rgb), ("alpha", &error.alpha)] {
            section += &row(group, facts);
        }
    }
    section
}

fn row(group: &str, facts: &ChannelError) -> String {
    let psnr = match facts.psnr_db {
        psnr if psnr.is_finite() => format!("{psnr:.1}"),
        _ => "identical".to_owned(),
    };
    let ChannelError { max_abs, bias, .. } = facts;
    format!("| {group} | {psnr} | {max_abs:.1e} | {bias:+.1e} |\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plans_comment_is_its_heading_and_caption() {
        let plan = "# A sphere\n# Half of it\n# is glossy.\n\n[source]\n# not this\n";
        let (title, text) = caption("x", plan);
        assert_eq!([&*title, &*text], ["A sphere", "Half of it is glossy."]);
        assert_eq!(caption("x", "[source]\n").0, "x");
    }

    #[test]
    fn a_plan_is_shown_with_its_reference_and_their_difference() {
        let plan = Path::new(env!("CARGO_MANIFEST_DIR")).join("../plans/12-edges.toml");
        let comparison = drawn(&plan, 1).unwrap();
        let panels = panels(&comparison);
        assert_eq!((panels.width, panels.height), (192, 64));
        let fixed = Rgb::on_black(&comparison.fixed);
        assert_eq!(panels.bytes[3 * 192..][..192], fixed.bytes[192..384]);
        let shown = section("12-edges", &caption("e", "# Edges\n"), &comparison);
        assert!(
            shown.contains("![Edges](12-edges.png)") && shown.contains("| alpha |"),
            "{shown}"
        );
    }
}
