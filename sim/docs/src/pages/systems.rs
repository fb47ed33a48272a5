//! The page of systems: where each lives, and the golden table's errors of its plans.

use super::Page;
use splatline_sim::plan::golden::{self, BARS, GoldenLine};
use splatline_sim::systems::SYSTEMS;
use std::path::Path;

/// Where the plans are, from the repository's root.
pub const PLANS: &str = "sim/plans";

/// Draws all plans. Nothing is read but the repository's own files.
pub fn page() -> anyhow::Result<Page> {
    let mut page = Page::new("systems", "The systems of the papers");
    page.add(text(&golden::lines(Path::new(PLANS))?));
    Ok(page)
}

fn text(lines: &[GoldenLine]) -> String {
    let mut text = format!(
        "Each system is drawn by small [plans](../../{PLANS}), as `splatline compare --plan FILE` does. Errors are fixed point in `standard24` against the float \
         counterpart, the worse of colour and alpha; the bar is at least {} dB and at most {:.0e} of bias. [golden.csv](../../{PLANS}/golden.csv) has counts and \
         checksums. Files are those of `src` unless they begin with `sim`, references are in `sim/reference/src/engines`.\n\n\
         | # | system | source | files | reference | plan | PSNR dB | largest error | bias | bar |\n|---|---|---|---|---|---|--:|--:|--:|---|\n",
        BARS.0, BARS.1
    );
    for system in SYSTEMS.iter() {
        let mut shown = format!(
            "| {} | {} | {} | {} | {} |",
            system.number, system.name, system.source, system.modules, system.reference
        );
        for line in lines
            .iter()
            .filter(|line| line.system() == Some(system.number))
        {
            let plan = &line.plan;
            let met = if line.meets_bars() { "met" } else { "missed" };
            text += &format!(
                "{shown} [{plan}](../../{PLANS}/{plan}.toml) | {:.1} | {:.1e} | {:+.1e} | {met} |\n",
                line.psnr_db, line.max_abs, line.bias
            );
            shown = "| | | | | |".to_owned();
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_system_shows_every_plan_of_its_own_and_whether_it_meets_the_bar() {
        let line = |plan: &str, psnr_db| GoldenLine {
            plan: plan.to_owned(),
            psnr_db,
            max_abs: 0.1,
            bias: -1e-5,
            items: 1,
            culled: 0,
            pixels: None,
            crc32: 0,
        };
        let page = text(&[line("01-a", 70.0), line("05-b", 50.0), line("05-c", 61.0)]);
        assert!(
            page.contains("[01-a](../../sim/plans/01-a.toml) | 70.0 | 1.0e-1 | -1.0e-5 | met |")
        );
        assert!(page.contains("| 50.0 | 1.0e-1 | -1.0e-5 | missed |"));
        assert!(page.contains("| | | | | | [05-c]"));
    }
}
