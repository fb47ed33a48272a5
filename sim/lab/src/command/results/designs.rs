//! Speed against error three ways: host time, simulated cycles and error of every named design by both traversals.

use super::{COMMAND, HardwareScene};
use splatline_sim::cli::{Failure, print_result, write};
use splatline_sim::design::DesignChoice;
use splatline_sim::plan::{Effort, Prepared, all_entries, compare_all};
use splatline_sim::report::plot::{Across, svg_across};
use splatline_sim::report::table::markdown;
use std::fmt::Write;
use std::path::Path;

/// Width and height of the plots.
const PLOT: (u32, u32) = (760, 420);

pub fn write_all(subjects: Vec<HardwareScene>, folder: &Path) -> Result<(), Failure> {
    let mut text = format!(
        "# Speed against error, three ways\n\nPrinted by `{COMMAND}`. Errors are those of red, green and blue against the f64 EWA reference in units of \
         1.0; bias is the mean of fixed minus float. Times are of one run on a shared machine with {} threads: compare them within one table only. \
         Mcycles are those of the default machine: one raster unit of one lane.\n",
        Effort::new(None, 1).threads
    );
    for subject in subjects {
        let HardwareScene {
            name,
            scene,
            camera,
            rules,
        } = subject;
        let design = DesignChoice::all().remove(2);
        let others = all_entries(&design);
        let prepared = Prepared::of_splats(scene, camera, rules, design);
        let report = compare_all(&prepared, &Effort::new(None, 1), &others)?.report;
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
    print_result(&text)?;
    Ok(())
}
