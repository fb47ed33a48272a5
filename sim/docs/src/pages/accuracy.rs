//! The page of accuracy: every design against the float reference on scenes, both engines against data of independent
//! origin, view-dependent colours against double precision, and one scene in several formats.

use super::{Page, colour, formats, golden};
use crate::bars::{BARS, Measurement, verdict};
use crate::table::Table;
use crate::views::{BRAIN, DEEP_STACK, View};
use anyhow::Result;
use splatline::format::Traversal;
use splatline_sim::design::{DesignChoice, traversal_name};
use splatline_sim::fixed;
use splatline_sim::metrics::compare;
use std::path::Path;

/// Pixels a side.
const SIZE: usize = 512;

const VIEWS: [&str; 5] = ["guitar close-up", "playbot", BRAIN, "aneurism", DEEP_STACK];

/// Measures all designs by both traversals on one view.
pub fn measure(view: &View) -> Result<Vec<Measurement>> {
    let exact = view.reference();
    let mut measurements = Vec::new();
    for design in DesignChoice::all() {
        for traversal in [Traversal::Box, Traversal::Spans] {
            let options = fixed::Options {
                traversal,
                ..view.options(&design)
            };
            let drawing = fixed::draw(&view.scene, &view.camera, &options);
            measurements.push(Measurement {
                view: view.name,
                design: design.name.clone(),
                traversal,
                errors: compare(&drawing.picture, &exact)?,
                visited: drawing.facts.coverage.visited,
                covered: drawing.facts.coverage.covered,
            });
        }
    }
    Ok(measurements)
}

/// The page over the scenes of a folder.
pub fn page(data: &Path) -> Result<Page> {
    let mut page = Page::new("accuracy", "Accuracy");
    page.add(
        "Both engines draw the same scene by the same rules, 512x512, front to back. PSNR, largest error and bias (fixed minus float) are the \
         worse of the colour channels and of alpha, on pictures in units of 1.0 that are not quantised. A pixel is *visited* if its \
         radial index is computed and *covered* if it lies inside the footprint; spans may visit 1.15 pixels for one they cover. `classic8` \
         has no bar: it shows what the others are for.",
    );
    page.add(bars().markdown());
    let mut measurements = Vec::new();
    for name in VIEWS {
        measurements.extend(measure(&View::load(name, data, SIZE)?)?);
    }
    page.add("## Designs against the float reference");
    page.add("PSNR in dB by spans; [accuracy.csv](accuracy.csv) has both traversals, largest errors, bias, SSIM and pixels.");
    page.add(summary(&measurements).markdown());
    page.beside("accuracy.csv", all(&measurements).csv());
    golden::add(&mut page, &data.join("golden"))?;
    colour::add(&mut page, data)?;
    formats::add(&mut page, data)?;
    Ok(page)
}

fn bars() -> Table {
    let mut table = Table::new("bar | PSNR at least | largest error | bias | deep stack");
    for bar in BARS {
        table.push([
            bar.design.to_owned(),
            format!("{:.0} dB", bar.psnr_db),
            format!("{:.1}/255", bar.max_abs * 255.0),
            format!("{:.0e}", bar.bias),
            format!("{:.0} dB", bar.deep_stack_db),
        ]);
    }
    table
}

/// A view a row, a design a column.
fn summary(measurements: &[Measurement]) -> Table {
    let designs = DesignChoice::all();
    let names: Vec<&str> = designs.iter().map(|design| design.name.as_str()).collect();
    let names = names.join(" | ");
    let mut table = Table::new(&format!("scene | {names} | bars, both traversals"));
    for view in VIEWS {
        let of_view: Vec<_> = measurements
            .iter()
            .filter(|found| found.view == view)
            .collect();
        let spans = of_view
            .iter()
            .filter(|found| found.traversal == Traversal::Spans);
        let psnr = spans.map(|found| format!("{:.1}", found.worst().0));
        let met = of_view
            .iter()
            .all(|found| found.meets_bars() != Some(false));
        table.push_behind(&[view], psnr.chain([verdict(Some(met))]));
    }
    table
}

fn all(measurements: &[Measurement]) -> Table {
    let mut table = Table::new(
        "scene | design | traversal | psnr_db | largest_x255 | bias | ssim | visited | \
         visited_per_covered | bars",
    );
    for found in measurements {
        let (psnr_db, max_abs, bias) = found.worst();
        let ssim = found.errors.colour.ssim.min(found.errors.alpha.ssim);
        let words = [found.view, &found.design, traversal_name(found.traversal)];
        let cells = [
            format!("{psnr_db:.1}"),
            format!("{:.3}", max_abs * 255.0),
            format!("{bias:+.1e}"),
            format!("{ssim:.6}"),
            found.visited.to_string(),
            format!("{:.3}", found.overhead()),
            verdict(found.meets_bars()),
        ];
        table.push_behind(&words, cells);
    }
    table
}
