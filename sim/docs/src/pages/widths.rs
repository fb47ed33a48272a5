//! Error against width, stage by stage and all together: the kernel's integers, and the floating-point formats that
//! others use.
//!
//! One stage at a time is as narrow as the row says while all others keep deep32's widths (or single precision), so
//! that a column tells what its stage alone costs; the last column has all of them narrow at once.

use super::Page;
use crate::table::Table;
use crate::views::{DEEP_STACK, View};
use anyhow::Result;
use splatline::format::{Traversal, WIDTH_RANGES};
use splatline_sim::design::DesignChoice;
use splatline_sim::fixed;
use splatline_sim::machine::Config;
use splatline_sim::machine::area::{Calibration, estimate};
use splatline_sim::metrics::compare;
use splatline_sim::picture::Picture;
use splatline_sim::reference::formats::{self, BFLOAT16, FP16, FP32, RoundedStages};
use std::path::Path;

/// Pixels a side.
const SIZE: usize = 256;

/// Views that are measured; the page shows the first.
const VIEWS: [&str; 3] = ["guitar close-up", "playbot", DEEP_STACK];

/// Bits of the rows.
const WIDTHS: [u8; 7] = [8, 10, 12, 16, 18, 20, 24];

/// The kernel's stages and their widths.
const STAGES: [(&str, &[&str]); 5] = [
    ("setup", &["position", "view", "mantissa", "subpixel"]),
    ("radial index", &["radial"]),
    ("kernel", &["table", "interpolation", "weight"]),
    ("opacity", &["peak", "alpha"]),
    ("blend", &["transmittance", "colour", "accumulator"]),
];

/// lean18's widths when its transmittance had 26 bits and ties went up, in the order of [`WIDTH_RANGES`].
const FORMER: [u8; WIDTH_RANGES.len()] = [30, 26, 18, 12, 22, 10, 16, 18, 24, 18, 26, 14, 20];

/// The design whose words are taken a bit one by one.
const LEAN: &str = "lean18";

/// lean18 with one width changed.
fn changed(key: &str, bits: u8) -> Result<DesignChoice> {
    let text = format!("base = \"{LEAN}\"\n{key} = {bits}\n");
    Ok(DesignChoice::from_toml("changed.toml", &text)?)
}

/// What one bit less of every word costs in decibels.
fn bit_by_bit(views: &[(View, Picture)]) -> Result<Table> {
    let names: Vec<&str> = views.iter().map(|(view, _)| view.name).collect();
    let mut table = Table::new(&format!("word | before | now | {}", names.join(" | ")));
    let own = DesignChoice::named(LEAN).map_or([0; WIDTH_RANGES.len()], |d| d.widths.numbers());
    for (((key, low, _), former), bits) in WIDTH_RANGES.iter().zip(FORMER).zip(own) {
        let mut row = vec![(*key).to_owned(), former.to_string(), bits.to_string()];
        for (view, reference) in views {
            let decibels = |bits| colour_psnr(view, &changed(key, bits)?, reference);
            let cost = decibels(bits)? - decibels((bits - 1).max(*low))?;
            row.push(format!("{cost:.2}"));
        }
        table.push(row);
    }
    Ok(table)
}

/// deep32 with these widths, each at most so many bits and within its range. A table has no more intervals than there
/// are radial indices.
fn narrowed(keys: &[&str], bits: u8) -> Result<DesignChoice> {
    let mut text = String::from("base = \"deep32\"\n");
    let deep = splatline::format::Deep32::WIDTHS.numbers();
    for ((key, low, _), own) in WIDTH_RANGES.iter().zip(deep) {
        let most = if *key == "table" && keys.contains(&"radial") {
            own.min(bits + 2)
        } else {
            own
        };
        if keys.contains(key) {
            text += &format!("{key} = {}\n", bits.max(*low).min(most));
        } else if most < own {
            text += &format!("{key} = {most}\n");
        }
    }
    Ok(DesignChoice::from_toml("narrowed.toml", &text)?)
}

/// PSNR of a design's colours, dB.
fn colour_psnr(view: &View, design: &DesignChoice, reference: &Picture) -> Result<f64> {
    let options = fixed::Options {
        traversal: Traversal::Spans,
        ..view.options(design)
    };
    let drawing = fixed::draw(&view.scene, &view.camera, &options);
    Ok(compare(&drawing.picture, reference)?.colour.psnr_db)
}

fn of_design(view: &View, design: &DesignChoice, reference: &Picture) -> Result<String> {
    Ok(format!("{:.1}", colour_psnr(view, design, reference)?))
}

/// Look-up tables and multipliers of the primitive with four lanes.
fn area(design: &DesignChoice) -> [String; 2] {
    let area = estimate(
        &design.widths,
        Traversal::Spans,
        &Config::primitive(4),
        &Calibration::default(),
    );
    [area.raster.luts, area.raster.dsps].map(|count| count.to_string())
}

fn add_fixed(table: &mut Table, view: &View, reference: &Picture) -> Result<()> {
    let all: Vec<&str> = STAGES
        .iter()
        .flat_map(|(_, keys)| keys.iter().copied())
        .collect();
    for bits in WIDTHS {
        let mut row = vec![view.name.to_owned(), bits.to_string()];
        for (_, keys) in STAGES {
            row.push(of_design(view, &narrowed(keys, bits)?, reference)?);
        }
        let together = narrowed(&all, bits)?;
        row.push(of_design(view, &together, reference)?);
        table.push(row.into_iter().chain(area(&together)));
    }
    for design in DesignChoice::all() {
        let mut row = vec![view.name.to_owned(), design.name.clone()];
        row.extend(STAGES.iter().map(|_| String::new()));
        row.push(of_design(view, &design, reference)?);
        table.push(row.into_iter().chain(area(&design)));
    }
    Ok(())
}

fn add_floats(table: &mut Table, view: &View, reference: &Picture) -> Result<()> {
    let single = RoundedStages::all(FP32);
    for (name, format) in [("fp32", FP32), ("fp16", FP16), ("bfloat16", BFLOAT16)] {
        let mut narrow = [single; 4];
        narrow[0].setup = format;
        narrow[1].raster = format;
        narrow[2].kernel = format;
        narrow[3].blend = format;
        let several = [RoundedStages::pixels(format), RoundedStages::all(format)];
        let mut row = vec![view.name.to_owned(), name.to_owned()];
        for stages in narrow.into_iter().chain(several) {
            let drawing = formats::draw(&view.scene, &view.camera, &view.rules, &stages);
            let error = compare(&drawing.picture, reference)?.colour;
            row.push(format!("{:.1}", error.psnr_db));
        }
        table.push(row);
    }
    Ok(())
}

/// The page over the scenes of a folder.
pub fn page(data: &Path) -> Result<Page> {
    let stages = STAGES.map(|(name, _)| name).join(" | ");
    let mut fixed = Table::new(&format!("scene | bits | {stages} | all | LUT | DSP"));
    let mut floats = Table::new(
        "scene | format | setup | radial index | kernel and opacity | blend | all but setup | all",
    );
    let mut views = Vec::new();
    for name in VIEWS {
        let view = View::load(name, data, SIZE)?;
        let reference = view.reference();
        add_fixed(&mut fixed, &view, &reference)?;
        add_floats(&mut floats, &view, &reference)?;
        views.push((view, reference));
    }
    let mut page = Page::new("widths", "Error against width");
    page.add(format!(
        "PSNR of colours in dB against the float reference, {SIZE}x{SIZE} pixels, spans, {}; [widths.csv](widths.csv) and [formats.csv](formats.csv) have \
         playbot and the deep stack too. A column has its stage as narrow as the row says and everything else at \
         deep32's widths; `all` has every stage narrow. A width stays within its own range, so that a row of few bits may hold wider ones. LUT and DSP are those of \
         the primitive with four lanes and all stages so narrow, estimated for Xilinx 7 ([hardware](../hardware.md)).",
        VIEWS[0],
    ));
    page.add(fixed.only(0, VIEWS[0]).markdown());
    page.beside("widths.csv", fixed.csv());
    let bits = bit_by_bit(&views)?;
    page.add(format!(
        "Words of `{LEAN}`: bits before its products were one fused multiply-add each, bits now, and what one bit less of that word alone costs, dB. \
         A bit that an end of its range forbids costs 0."
    ));
    page.add(bits.markdown());
    page.beside("words.csv", bits.csv());
    page.add(
        "Floating-point formats: the usual formulas (determinant as a difference, conic by division), every operation rounded; other stages in single precision. \
         A centre is relative to its tile of 16 x 16 pixels.",
    );
    page.add(floats.only(0, VIEWS[0]).markdown());
    page.beside("formats.csv", floats.csv());
    Ok(page)
}
