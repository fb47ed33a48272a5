//! The classes as text: one line per engine, and the bars.

use super::{SINGLE, SINGLE_NEAR, SceneLine};
use std::fmt::Write;

/// A Markdown table of all lines, which is legible as plain text too, and the verdicts.
pub fn markdown(lines: &[SceneLine]) -> String {
    let mut text = String::from(
        "| scene | engine | PSNR dB | largest | bias | conic rel | drawn besides | left out | of pairs | clamped | culled | lost |\n\
         |---|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n",
    );
    for line in lines {
        let psnr = line
            .psnr_db
            .map_or_else(|| "exact".to_owned(), |db| format!("{db:.1}"));
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "| {} | {} | {psnr} | {:.1e} | {:+.1e} | {:.1e} | {} | {} | {} | {} | {} | {} |",
            line.class,
            line.engine,
            line.max_abs,
            line.bias,
            line.conic,
            line.flips.added,
            line.flips.removed,
            line.blended,
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
        let of = |engine: &str| {
            let mut lines = lines.iter();
            lines.find(|line| line.class == class && line.engine == engine)
        };
        let psnr = |line: &SceneLine| line.psnr_db.unwrap_or(f64::INFINITY);
        let (Some(standard), Some(deep)) = (of("standard24"), of("deep32")) else {
            continue;
        };
        let single = of(SINGLE_NEAR).or(of(SINGLE)).map_or(0.0, psnr);
        let meets = |ok: bool| if ok { "meets" } else { "FALLS SHORT of" };
        let standard_ok = psnr(standard) >= 100.0 || psnr(standard) >= single - 3.0;
        let flipped = deep.flips.added + deep.flips.removed;
        let deep_ok = psnr(deep) >= 120.0 || flipped > 0;
        let _ = writeln!(
            text,
            "- {class}: standard24 {:.1} dB {} 100 dB or single precision's {single:.1} - 3; deep32 {:.1} dB with {flipped} flips {} 120 dB where nothing flips",
            psnr(standard),
            meets(standard_ok),
            psnr(deep),
            meets(deep_ok),
        );
    }
    text
}

/// The classes' names in the order of their first line.
fn classes(lines: &[SceneLine]) -> Vec<&str> {
    let mut names: Vec<&str> = lines.iter().map(|line| line.class.as_str()).collect();
    names.dedup();
    names
}
