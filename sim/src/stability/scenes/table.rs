//! The classes as text: one line per engine, and the bars.

use super::{SINGLE, SINGLE_NEAR, SceneLine};
use std::fmt::Write;

/// A Markdown table of all lines, which is legible as plain text too, and the verdicts.
pub fn markdown(lines: &[SceneLine]) -> String {
    let mut text = String::from(
        "| scene | engine | PSNR dB | where nothing flips | largest | bias | conic rel | added | removed | of pairs | stopped early | late | clamped | culled | lost |\n\
         |---|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n",
    );
    for line in lines {
        let shown = |db: f64| {
            if db.is_finite() {
                format!("{db:.1}")
            } else {
                "exact".to_owned()
            }
        };
        let psnr = shown(decibels(line.psnr_db));
        let settled = settled(line).map_or_else(|| "-".to_owned(), shown);
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "| {} | {} | {psnr} | {settled} | {:.1e} | {:+.1e} | {:.1e} | {} | {} | {} | {} | {} | {} | {} | {} |",
            line.class,
            line.engine,
            line.max_abs,
            line.bias,
            line.conic,
            line.flips.added,
            line.flips.removed,
            line.blended,
            line.flips.early,
            line.flips.late,
            line.clamped,
            line.culled,
            line.lost
        );
    }
    text + "\n" + &verdicts(lines)
}

/// How far `standard24` and `deep32` are from the bars, class by class.
pub fn verdicts(lines: &[SceneLine]) -> String {
    let mut text = String::new();
    for class in classes(lines) {
        let Some(verdict) = verdict(lines, class) else {
            continue;
        };
        let meets = |ok: bool| if ok { "meets" } else { "FALLS SHORT of" };
        let _ = writeln!(
            text,
            "- {class}: standard24 {:.1} dB {} {:.1} dB; deep32 {:.1} dB where nothing flips {} {DEEP_BAR} dB; clamped {}",
            verdict.standard,
            meets(verdict.standard >= verdict.bar),
            verdict.bar,
            verdict.deep,
            meets(verdict.deep >= DEEP_BAR),
            verdict.clamped,
        );
    }
    text
}

/// What `standard24` must reach wherever it is more than [`BEHIND`] below single precision.
pub const STANDARD_BAR: f64 = 100.0;
/// How far `standard24` may be below single precision in the true order, decibels.
pub const BEHIND: f64 = 3.0;
/// What `deep32` must reach over the pixels at which nothing is decided otherwise.
pub const DEEP_BAR: f64 = 120.0;

/// One class beside its bars.
#[derive(Clone, Copy, Debug)]
pub struct ClassVerdict {
    /// PSNR of `standard24`.
    pub standard: f64,
    /// The same where nothing flips; 0 if every pixel is decided otherwise.
    pub standard_settled: f64,
    /// What it must reach.
    pub bar: f64,
    /// PSNR of `deep32` where nothing flips; 0 if every pixel is decided otherwise.
    pub deep: f64,
    /// Splats that any design clamped.
    pub clamped: usize,
}

/// A class beside its bars; none if an engine's line is missing.
pub fn verdict(lines: &[SceneLine], class: &str) -> Option<ClassVerdict> {
    let of = |engine: &str| {
        let mut lines = lines.iter();
        lines.find(|line| line.class == class && line.engine == engine)
    };
    let single = decibels(of(SINGLE_NEAR).or(of(SINGLE))?.psnr_db);
    let in_class = lines.iter().filter(|line| line.class == class);
    Some(ClassVerdict {
        standard: decibels(of("standard24")?.psnr_db),
        standard_settled: settled(of("standard24")?).unwrap_or(0.0),
        bar: STANDARD_BAR.min(single - BEHIND),
        deep: settled(of("deep32")?).unwrap_or(0.0),
        clamped: in_class.map(|line| line.clamped).max().unwrap_or(0),
    })
}

/// Infinite if no sample differs.
fn decibels(db: Option<f64>) -> f64 {
    db.unwrap_or(f64::INFINITY)
}

/// None if every pixel is decided otherwise.
fn settled(line: &SceneLine) -> Option<f64> {
    (line.settled > 0.0).then(|| decibels(line.settled_psnr_db))
}

/// The classes' names in the order of their first line.
pub fn classes(lines: &[SceneLine]) -> Vec<&str> {
    let mut names: Vec<&str> = lines.iter().map(|line| line.class.as_str()).collect();
    names.dedup();
    names
}
