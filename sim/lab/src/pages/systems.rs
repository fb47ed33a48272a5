//! The page of systems: where each lives, and its error in fixed point against float as the gallery measures it.

use super::Page;
use crate::gallery::Exhibit;
use crate::gallery::surface::GalleryError;
use crate::gallery::{deep, kernels, surface, texture};
use splatline_sim::systems::{SYSTEMS, System};
use std::fmt::Write;
use std::path::Path;

/// The bars: decibels and absolute bias.
const BARS: (f64, f64) = (60.0, 5e-4);

/// Makes all exhibits and reads every system's worst comparison from them.
pub fn page(data: &Path) -> Result<Page, GalleryError> {
    let mut exhibits = surface::surface(data)?;
    exhibits.extend(kernels::kernels(data));
    for name in deep::NAMES {
        exhibits.extend(deep::some(data, name).exhibits);
    }
    for name in texture::NAMES {
        exhibits.extend(texture::some(data, name)?);
    }
    let mut page = Page::new("systems", "The systems of the papers");
    page.add(text(&exhibits));
    Ok(page)
}

/// PSNR, largest error and bias: the worst of each over a system's comparisons.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Worst {
    psnr_db: f64,
    max_abs: f64,
    bias: f64,
}

fn text(exhibits: &[Exhibit]) -> String {
    let mut text = format!(
        "Errors are fixed point in `standard24` against the float counterpart, the worst \
         of the system's comparisons in its exhibits; the bar is at least {} dB and at most {:.0e} of bias. Files are those of `src` unless they begin with \
         `sim`, references are in `sim/reference/src/engines`.\n\n\
         | # | system | source | files | reference | exhibits | PSNR dB | largest error | bias | bar |\n|---|---|---|---|---|---|---|---|---|---|\n",
        BARS.0, BARS.1
    );
    for system in &SYSTEMS {
        let measured = match worst(system, exhibits) {
            Some(Worst {
                psnr_db,
                max_abs,
                bias,
            }) => {
                let met = psnr_db >= BARS.0 && bias.abs() <= BARS.1;
                let met = if met { "met" } else { "missed" };
                format!("{psnr_db:.1} | {max_abs:.1e} | {bias:+.1e} | {met}")
            }
            None => "see the exhibit | | | ".to_owned(),
        };
        let collection = system.exhibits.0;
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {} | [{collection}](../gallery/{collection}/README.md) | {measured} |",
            system.number, system.name, system.source, system.modules, system.reference
        );
    }
    text
}

/// None if no exhibit holds a comparison of the system.
fn worst(system: &System, exhibits: &[Exhibit]) -> Option<Worst> {
    let comparisons = system.exhibits.1.iter().filter_map(|(exhibit, what)| {
        let numbers = &exhibits.iter().find(|e| e.name == *exhibit)?.numbers;
        let value = |suffixes: &[&str]| {
            let named = |name: &str| suffixes.iter().any(|s| name == format!("{what}: {s}"));
            numbers
                .iter()
                .find(|(name, _, _)| named(name))
                .map(|(_, value, _)| *value)
        };
        Some(Worst {
            psnr_db: value(&["PSNR"])?,
            max_abs: value(&["largest error", "largest difference"])?,
            bias: value(&["bias"])?,
        })
    });
    comparisons.reduce(|a, b| Worst {
        psnr_db: a.psnr_db.min(b.psnr_db),
        max_abs: a.max_abs.max(b.max_abs),
        bias: if a.bias.abs() > b.bias.abs() {
            a.bias
        } else {
            b.bias
        },
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_worst_comparison_of_a_system_counts() {
        let mut exhibit = Exhibit {
            name: "antialias".to_owned(),
            equation: "",
            caption: String::new(),
            pictures: Vec::new(),
            numbers: Vec::new(),
        };
        for (what, psnr) in [
            ("ewa fixed against float", 70.0),
            ("none fixed against float", 50.0),
        ] {
            exhibit.number(format!("{what}: PSNR"), psnr, "dB");
            exhibit.number(format!("{what}: largest difference"), 0.1, "");
            exhibit.number(format!("{what}: bias"), -1e-5, "");
        }
        let exhibits = [exhibit];
        assert_eq!(worst(&SYSTEMS[0], &exhibits).unwrap().psnr_db, 70.0);
        assert_eq!(worst(&SYSTEMS[3], &exhibits).unwrap().psnr_db, 50.0);
        assert_eq!(worst(&SYSTEMS[1], &exhibits), None);
        let page = text(&exhibits);
        assert!(page.contains("| 50.0 | 1.0e-1 | -1.0e-5 | missed |") && page.contains("| 70.0 |"));
    }
}
