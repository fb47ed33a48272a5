//! `splatline-lab results`: the pages of docs/results, measured afresh.

mod designs;
mod hardware;
mod machines;
mod throughput;

use super::options::{ResultsOptions, ResultsPage};
use clap::ValueEnum;
use hardware::HardwareScene;
use splatline_lab::results::check::differences;
use splatline_lab::results::{
    COMMAND, ResultPage, accuracy, colour, formats, golden, packet, picture, systems, views, widths,
};
use splatline_sim::cli::create_folder;
use splatline_sim::cli::write;
use splatline_sim::cli::{Failure, print_result};
use splatline_sim::progress::ProgressMeter;
use std::path::Path;

pub fn run(options: &ResultsOptions) -> Result<(), Failure> {
    if options.check {
        return check(options);
    }
    create_folder(&options.output)?;
    if options.only.is_empty() {
        let panels = picture::panels(300)?.to_png()?;
        write(&options.output.join(picture::FILE), &panels)?;
    }
    let asked = |page: &&ResultsPage| options.only.is_empty() || options.only.contains(page);
    for page in ResultsPage::value_variants().iter().filter(asked) {
        if let Some(ResultPage { file, text }) = measure(*page, options)? {
            write(&options.output.join(file), text.as_bytes())?;
            print_result(&format!("{text}\n"))?;
        }
    }
    Ok(())
}

/// Prints the pages again, beside the committed ones, and compares what is no timing.
fn check(options: &ResultsOptions) -> Result<(), Failure> {
    let again = options.output.with_file_name("results-printed-again");
    let pages = ResultsPage::value_variants()
        .iter()
        .filter(|page| options.only.is_empty() || options.only.contains(page));
    for page in pages {
        run(&ResultsOptions {
            data: options.data.clone(),
            output: again.clone(),
            only: vec![*page],
            check: false,
        })?;
    }
    let found = compare_folders(&options.output, &again);
    std::fs::remove_dir_all(&again)?;
    let found = found?;
    print_result(&format!("{} differences\n", found.len()))?;
    if found.is_empty() {
        Ok(())
    } else {
        Err(anyhow::anyhow!("pages that are no longer true:\n{}", found.join("\n")).into())
    }
}

/// The differences of every Markdown page of `again`.
fn compare_folders(committed: &Path, again: &Path) -> anyhow::Result<Vec<String>> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(again)? {
        let path = entry?.path();
        if path.extension().is_none_or(|extension| extension != "md") {
            continue;
        }
        let name = path.file_name().unwrap_or_default();
        let old = std::fs::read_to_string(committed.join(name)).unwrap_or_default();
        let new = std::fs::read_to_string(&path)?;
        found.extend(
            differences(&old, &new)
                .into_iter()
                .take(5)
                .map(|line| format!("{}: {line}", name.to_string_lossy())),
        );
    }
    Ok(found)
}

/// The page's text, unless it writes its files itself.
fn measure(page: ResultsPage, options: &ResultsOptions) -> Result<Option<ResultPage>, Failure> {
    match page {
        ResultsPage::Accuracy => Ok(Some(measure_accuracy(options)?)),
        ResultsPage::Colour => Ok(Some(colour::page(&options.data)?)),
        ResultsPage::Packet => Ok(Some(packet::page())),
        ResultsPage::Formats => Ok(Some(formats::page(&options.data)?)),
        ResultsPage::Golden => Ok(Some(golden::page(&options.data.join("golden"))?)),
        ResultsPage::Systems => Ok(Some(systems::page()?)),
        ResultsPage::Hardware => {
            hardware::run(&options.data, &options.output)?;
            Ok(None)
        }
        ResultsPage::Widths => {
            let views = views::load_all(&options.data, widths::SIZE)?;
            Ok(Some(widths::page(&views)?))
        }
        ResultsPage::Machines => {
            let (text, files) = machines::page(&hardware::subjects(&options.data)?.0)?;
            for (file, plot) in files {
                write(&options.output.join(file), plot.as_bytes())?;
            }
            Ok(Some(ResultPage {
                file: "machines.md",
                text,
            }))
        }
    }
}

fn measure_accuracy(options: &ResultsOptions) -> Result<ResultPage, Failure> {
    let views = views::load_all(&options.data, 512)?;
    let progress = ProgressMeter::new(views.len());
    let mut measurements = Vec::new();
    for view in &views {
        progress.doing(view.name.to_owned());
        measurements.extend(accuracy::measure(view)?);
        progress.advance();
    }
    Ok(accuracy::page(&measurements))
}
