//! Fixed point against float on real scenes: every design by both traversals, held against the bars.

use super::views::{CapturedView, DEEP_STACK};
use super::{ResultPage, opening, table, verdict};
use anyhow::Result;
use splatline::format::Traversal;
use splatline_sim::design::{DesignChoice, traversal_name};
use splatline_sim::fixed::{self, FixedDrawing, Options};
use splatline_sim::metrics::{ChannelError, Errors, compare};
use splatline_sim::reference::float;
use splatline_sim::rules::Compositing;

/// What a design must reach: PSNR in dB at least, largest error and bias in units of 1.0 at most.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bar {
    /// Name of the design.
    pub design: &'static str,
    /// Decibels.
    pub psnr_db: f64,
    /// Units of 1.0.
    pub max_abs: f64,
    /// Units of 1.0, either sign.
    pub bias: f64,
    /// Decibels on the deep stack, for which nothing else is asked.
    pub deep_stack_db: f64,
}

/// The bars of the three designs that are meant to be accurate; `classic8` has none.
pub const BARS: [Bar; 3] = [
    Bar {
        design: "lean18",
        psnr_db: 57.0,
        max_abs: 4.0 / 255.0,
        bias: 1e-3,
        deep_stack_db: 45.0,
    },
    Bar {
        design: "standard24",
        psnr_db: 70.0,
        max_abs: 1.5 / 255.0,
        bias: 1e-4,
        deep_stack_db: 60.0,
    },
    Bar {
        design: "deep32",
        psnr_db: 90.0,
        max_abs: 1.0 / 255.0,
        bias: 1e-5,
        deep_stack_db: 85.0,
    },
];

/// Spans may visit so many pixels for one that they cover.
pub const VISITED_PER_COVERED: f64 = 1.15;

/// One design by one traversal on one scene.
#[derive(Clone, Debug)]
pub struct Measurement {
    /// Name of the view.
    pub view: &'static str,
    /// Name of the design.
    pub design: String,
    /// Traversal.
    pub traversal: Traversal,
    /// Against the float reference.
    pub errors: Errors,
    /// Pixels visited and covered.
    pub visited: u64,
    /// Pixels covered.
    pub covered: u64,
}

impl Measurement {
    /// The worse of colour and alpha in each respect.
    pub fn worst(&self) -> (f64, f64, f64) {
        let ChannelError {
            psnr_db,
            max_abs,
            bias,
            ..
        } = self.errors.colour;
        let alpha = &self.errors.alpha;
        let bias = if alpha.bias.abs() > bias.abs() {
            alpha.bias
        } else {
            bias
        };
        (psnr_db.min(alpha.psnr_db), max_abs.max(alpha.max_abs), bias)
    }

    /// Visited pixels for one covered pixel.
    pub fn overhead(&self) -> f64 {
        self.visited as f64 / self.covered.max(1) as f64
    }

    /// Are all bars met that apply? `None` if none does.
    pub fn meets_bars(&self) -> Option<bool> {
        let bar = BARS.iter().find(|bar| bar.design == self.design)?;
        let (psnr_db, max_abs, bias) = self.worst();
        if self.view == DEEP_STACK {
            return Some(psnr_db >= bar.deep_stack_db);
        }
        let spans = self.traversal != Traversal::Spans || self.overhead() <= VISITED_PER_COVERED;
        Some(psnr_db >= bar.psnr_db && max_abs <= bar.max_abs && bias.abs() <= bar.bias && spans)
    }
}

/// Measures all designs by both traversals on one view.
pub fn measure(view: &CapturedView) -> Result<Vec<Measurement>> {
    let rules = view.scene.natural_rules;
    let exact = float::draw(&view.scene, &view.camera, &rules, Compositing::FrontToBack).picture;
    let mut measurements = Vec::new();
    for design in DesignChoice::all() {
        for traversal in [Traversal::Box, Traversal::Spans] {
            let options = Options {
                rules: &rules,
                compositing: Compositing::FrontToBack,
                design: &design,
                traversal,
            };
            let FixedDrawing {
                picture, coverage, ..
            } = fixed::draw(&view.scene, &view.camera, &options);
            measurements.push(Measurement {
                view: view.name,
                design: design.name.clone(),
                traversal,
                errors: compare(&picture, &exact)?,
                visited: coverage.visited,
                covered: coverage.covered,
            });
        }
    }
    Ok(measurements)
}

/// The page of all measurements.
pub fn page(measurements: &[Measurement]) -> ResultPage {
    let mut text = opening("Accuracy: fixed point against float");
    text.push_str(
        "Both engines draw the same scene by the same rules, 512x512, front to back. PSNR, largest error and bias (fixed minus float) are the \
         worse of the colour channels and of alpha, on pictures in units of 1.0 that are not quantised. A pixel is *visited* if its \
         radial index is computed and *covered* if it lies inside the footprint.\n\n",
    );
    let bars = BARS.map(|bar| {
        vec![
            bar.design.to_owned(),
            format!("{:.0} dB", bar.psnr_db),
            format!("{:.1}/255", bar.max_abs * 255.0),
            format!("{:.0e}", bar.bias),
            format!("{:.0} dB", bar.deep_stack_db),
        ]
    });
    text.push_str(&table(
        &[
            "bar",
            "PSNR at least",
            "largest error",
            "bias",
            "deep stack",
        ],
        &bars,
    ));
    text.push_str("\nSpans may visit 1.15 pixels for one they cover. `classic8` has no bar: it shows what the others are for.\n");
    let headings = [
        "design",
        "traversal",
        "PSNR dB",
        "largest x255",
        "bias",
        "SSIM",
        "visited",
        "visited/covered",
        "bars",
    ];
    let mut view = "";
    let mut rows = Vec::new();
    for measurement in measurements {
        if measurement.view != view {
            flush(&mut text, &headings, &mut rows);
            view = measurement.view;
            text.push_str(&format!("\n## {view}\n\n"));
        }
        rows.push(row(measurement));
    }
    flush(&mut text, &headings, &mut rows);
    ResultPage {
        file: "accuracy.md",
        text,
    }
}

fn flush(text: &mut String, headings: &[&str], rows: &mut Vec<Vec<String>>) {
    if !rows.is_empty() {
        text.push_str(&table(headings, rows));
        rows.clear();
    }
}

fn row(measurement: &Measurement) -> Vec<String> {
    let (psnr_db, max_abs, bias) = measurement.worst();
    vec![
        measurement.design.clone(),
        traversal_name(measurement.traversal).to_owned(),
        format!("{psnr_db:.1}"),
        format!("{:.3}", max_abs * 255.0),
        format!("{bias:+.1e}"),
        format!(
            "{:.6}",
            measurement
                .errors
                .colour
                .ssim
                .min(measurement.errors.alpha.ssim)
        ),
        measurement.visited.to_string(),
        format!("{:.3}", measurement.overhead()),
        measurement.meets_bars().map_or("none".to_owned(), verdict),
    ]
}
