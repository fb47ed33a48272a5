//! Speed against error three ways: host time, simulated cycles and error of every named design by both traversals.

use super::{COMMAND, Subject};
use splatline::format::Traversal;
use splatline_sim::cli::Engine;
use splatline_sim::cli::all_entries;
use splatline_sim::cli::write;
use splatline_sim::cli::{Entry, Manner, draw_all};
use splatline_sim::cli::{Failure, say};
use splatline_sim::cli::{View, threads};
use splatline_sim::design::DesignChoice;
use splatline_sim::machine::Config;
use splatline_sim::report::plot::{Across, svg_across};
use splatline_sim::report::table::markdown;
use splatline_sim::rules::Compositing;
use std::fmt::Write;
use std::path::Path;

/// Width and height of the plots.
const PLOT: (u32, u32) = (760, 420);

pub fn write_all(subjects: Vec<Subject>, folder: &Path) -> Result<(), Failure> {
    let mut text = format!(
        "# Speed against error, three ways\n\nPrinted by `{COMMAND}`. Errors are those of red, green and blue against the f64 EWA reference in units of \
         1.0; bias is the mean of fixed minus float. Times are of one run on a shared machine with {} threads: compare them within one table only. \
         Mcycles are those of the default machine: one raster unit of one lane.\n",
        threads(None)
    );
    for subject in subjects {
        let Subject {
            name,
            scene,
            camera,
            rules,
        } = subject;
        let design = DesignChoice::all().remove(2);
        let chosen = Entry {
            design: design.clone(),
            traversal: Traversal::Spans,
        };
        let manner = Manner {
            hybrid: None,
            compositing: Compositing::FrontToBack,
            threads: threads(None),
            repeat: 1,
            machine: Config::default(),
        };
        let view = View {
            scene,
            camera,
            rules,
            warnings: Vec::new(),
            prepare_s: 0.0,
        };
        let report = draw_all(
            &view,
            &manner,
            Engine::Float,
            &chosen,
            &all_entries(&design),
        )?
        .report;
        let file: String = name
            .chars()
            .filter(char::is_ascii_alphanumeric)
            .collect::<String>()
            .to_lowercase();
        for (across, suffix) in [(Across::HostTime, "time"), (Across::Cycles, "cycles")] {
            let plot = svg_across(&report.table, across, PLOT.0, PLOT.1)?;
            write(
                &folder.join(format!("{file}-{suffix}.svg")),
                plot.as_bytes(),
            )?;
        }
        // Writing to a String cannot fail.
        let _ = writeln!(text, "\n## {name}\n\n{}", markdown(&report.table));
        let _ = writeln!(
            text,
            "![error against host time]({file}-time.svg)\n![error against cycles]({file}-cycles.svg)"
        );
    }
    write(&folder.join("designs.md"), text.as_bytes())?;
    say(&text)?;
    Ok(())
}
