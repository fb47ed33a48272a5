//! What designs and engines must reach. Pages print verdicts by them, and tests hold the embedded scenes to them.

use crate::views::DEEP_STACK;
use splatline::format::Traversal;
use splatline_sim::metrics::Errors;
use splatline_sim::plan::golden::worst;

/// What a design must reach: PSNR in dB at least, largest error and bias in units of 1.0 at most.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bar {
    pub design: &'static str,
    pub psnr_db: f64,
    pub max_abs: f64,
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

/// Largest relative difference of a conic from the 60-digit one that a design may have.
pub const CONIC_BARS: [(&str, f64); 2] = [("standard24", 1e-4), ("deep32", 2e-6)];

/// The float engine's bars: conics relative, pictures in units of 1.0.
pub const FLOAT_CONIC: f64 = 1e-9;
pub const FLOAT_PICTURE: f64 = 2e-5;

/// The picture of another renderer must agree to this.
pub const TINY_DB: f64 = 40.0;

/// One design by one traversal on one scene.
#[derive(Clone, Debug)]
pub struct Measurement {
    pub view: &'static str,
    pub design: String,
    pub traversal: Traversal,
    /// Against the float reference.
    pub errors: Errors,
    pub visited: u64,
    pub covered: u64,
}

impl Measurement {
    /// PSNR, largest error and bias: the worse of colour and alpha in each respect.
    pub fn worst(&self) -> (f64, f64, f64) {
        worst(&self.errors)
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

/// `met`, `MISSED`, or `none` without a bar.
pub fn verdict(met: Option<bool>) -> String {
    match met {
        Some(true) => "met",
        Some(false) => "MISSED",
        None => "none",
    }
    .to_owned()
}

#[cfg(test)]
#[path = "bars_tests.rs"]
mod tests;
