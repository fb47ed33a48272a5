//! Error against width, stage by stage and all together: the kernel's integers, and the floating-point formats that others use.
//!
//! One stage at a time is as narrow as the row says while all others keep deep32's widths (or single precision), so that a column tells what its
//! stage alone costs; the last column has all of them narrow at once.

use super::views::{CapturedView, DEEP_STACK};
use super::{ResultPage, opening, table};
use anyhow::Result;
use splatline::format::{Traversal, WIDTH_RANGES};
use splatline_sim::design::DesignChoice;
use splatline_sim::fixed::{self, Options};
use splatline_sim::machine::Config;
use splatline_sim::machine::area::{Calibration, estimate, synthesis};
use splatline_sim::metrics::compare;
use splatline_sim::picture::Picture;
use splatline_sim::reference::float;
use splatline_sim::reference::formats::{self, BFLOAT16, FP16, FP32, FloatFormat, RoundedStages};
use splatline_sim::rules::Compositing;
use std::fmt::Write;

/// Pixels a side.
pub const SIZE: usize = 256;

/// Views that are measured.
const VIEWS: [&str; 3] = ["guitar close-up", "playbot_lod4", DEEP_STACK];

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

/// deep32 with these widths, each at most so many bits and within its range.
fn narrowed(keys: &[&str], bits: u8) -> Result<DesignChoice> {
    let mut text = String::from("base = \"deep32\"\n");
    let deep = DesignChoice::all().remove(3).widths.numbers();
    for ((key, low, _), own) in WIDTH_RANGES.iter().zip(deep) {
        if keys.contains(key) {
            writeln!(text, "{key} = {}", bits.max(*low).min(own))?;
        }
    }
    Ok(DesignChoice::from_toml("narrowed.toml", &text)?)
}

/// PSNR of colours, dB.
fn psnr(picture: &Picture, reference: &Picture) -> Result<String> {
    Ok(format!(
        "{:.1}",
        compare(picture, reference)?.colour.psnr_db
    ))
}

fn of_design(view: &CapturedView, design: &DesignChoice, reference: &Picture) -> Result<String> {
    let rules = view.scene.natural_rules;
    let options = Options {
        rules: &rules,
        compositing: Compositing::FrontToBack,
        design,
        traversal: Traversal::Spans,
    };
    psnr(
        &fixed::draw(&view.scene, &view.camera, &options).picture,
        reference,
    )
}

/// Look-up tables and multipliers of the primitive with four lanes.
fn area(design: &DesignChoice) -> [String; 2] {
    let config = Config::primitive(4);
    let area = estimate(
        &design.widths,
        Traversal::Spans,
        &config,
        &Calibration::default(),
    );
    [area.raster.luts, area.raster.dsps].map(|count| count.to_string())
}

fn fixed_table(view: &CapturedView, reference: &Picture) -> Result<String> {
    let all: Vec<&str> = STAGES
        .iter()
        .flat_map(|(_, keys)| keys.iter().copied())
        .collect();
    let mut rows = Vec::new();
    for bits in WIDTHS {
        let mut row = vec![format!("{bits}")];
        for (_, keys) in STAGES {
            row.push(of_design(view, &narrowed(keys, bits)?, reference)?);
        }
        let together = narrowed(&all, bits)?;
        row.push(of_design(view, &together, reference)?);
        row.extend(area(&together));
        rows.push(row);
    }
    for design in DesignChoice::all() {
        let mut row = vec![design.name.clone()];
        row.extend(STAGES.iter().map(|_| String::new()));
        row.push(of_design(view, &design, reference)?);
        row.extend(area(&design));
        rows.push(row);
    }
    let mut headings = vec!["bits"];
    headings.extend(STAGES.iter().map(|(name, _)| *name));
    headings.extend(["all", "LUT", "DSP"]);
    Ok(table(&headings, &rows))
}

fn formats_table(view: &CapturedView, reference: &Picture) -> Result<String> {
    let rules = view.scene.natural_rules;
    let single = RoundedStages::all(FP32);
    let mut rows = Vec::new();
    for (name, format) in [("fp32", FP32), ("fp16", FP16), ("bfloat16", BFLOAT16)] {
        let stages = |format: FloatFormat| {
            [
                RoundedStages {
                    setup: format,
                    ..single
                },
                RoundedStages {
                    raster: format,
                    ..single
                },
                RoundedStages {
                    kernel: format,
                    ..single
                },
                RoundedStages {
                    blend: format,
                    ..single
                },
                RoundedStages::pixels(format),
                RoundedStages::all(format),
            ]
        };
        let mut row = vec![name.to_owned()];
        for stages in stages(format) {
            let drawing = formats::draw(&view.scene, &view.camera, &rules, &stages);
            row.push(psnr(&drawing.picture, reference)?);
        }
        rows.push(row);
    }
    let headings = [
        "format",
        "setup",
        "radial index",
        "kernel and opacity",
        "blend",
        "all but setup",
        "all",
    ];
    Ok(table(&headings, &rows))
}

/// The page over the views that are measured.
pub fn page(views: &[CapturedView]) -> Result<ResultPage> {
    let mut text = opening("Error against width");
    let _ = writeln!(
        text,
        "PSNR of colours in dB against the float reference, {SIZE}x{SIZE} pixels, spans. A column has its stage as narrow as the row says and everything else at \
         deep32's widths; `all` has every stage narrow. A width stays within its own range, so that a row of few bits may hold wider ones. LUT and DSP are those of \
         the primitive with four lanes and all stages so narrow: {}.\n\nFloating-point formats: the usual formulas (determinant as a difference, conic by division), every \
         operation rounded; other stages in single precision. A centre is relative to its tile of 16 x 16 pixels.",
        synthesis::statement(&Calibration::default())
    );
    for view in views.iter().filter(|view| VIEWS.contains(&view.name)) {
        let rules = view.scene.natural_rules;
        let reference =
            float::draw(&view.scene, &view.camera, &rules, Compositing::FrontToBack).picture;
        let _ = writeln!(
            text,
            "\n## {}\n\n{}\n{}",
            view.name,
            fixed_table(view, &reference)?,
            formats_table(view, &reference)?
        );
    }
    Ok(ResultPage {
        file: "widths.md",
        text,
    })
}
