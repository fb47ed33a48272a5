//! The classes as text: one line per engine, and the bars.

use super::{SINGLE, SINGLE_NEAR, SceneLine};

/// All lines as CSV.
pub fn csv(lines: &[SceneLine]) -> String {
    let mut text = String::from(
        "scene,engine,PSNR dB,where nothing flips,largest,bias,conic rel,added,removed,of pairs,stopped early,late,clamped,culled,lost\n",
    );
    for line in lines {
        let settled = settled(line).map_or_else(|| "-".to_owned(), shown);
        text += &format!(
            "\"{}\",\"{}\",{},{settled},{:.1e},{:+.1e},{:.1e},{},{},{},{},{},{},{},{}\n",
            line.class,
            line.engine,
            shown(decibels(line.psnr_db)),
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
    text
}

fn shown(db: f64) -> String {
    if db.is_finite() {
        format!("{db:.1}")
    } else {
        "exact".to_owned()
    }
}

/// A line for each class: single precision and the designs, each with PSNR, largest error and bias, and the bars of
/// `standard24` and `deep32`.
pub fn markdown(lines: &[SceneLine]) -> String {
    const ENGINES: [&str; 4] = [SINGLE, "lean18", "standard24", "deep32"];
    let mut text = String::from(
        "| scene | f32 | lean18 | standard24 | deep32 | bar of standard24 | deep32 where nothing flips, of 120 dB |\n|---|---|---|---|---|---|---|\n",
    );
    for class in classes(lines) {
        text += &format!("| {class}");
        for engine in ENGINES {
            let cell = line_of(lines, class, engine).map_or("-".to_owned(), |line| {
                let psnr = shown(decibels(line.psnr_db));
                format!("{psnr}, {:.1e}, {:+.1e}", line.max_abs, line.bias)
            });
            text += &format!(" | {cell}");
        }
        let bars = verdict(lines, class).map_or("- | -".to_owned(), |verdict| {
            let standard = meets(verdict.standard >= verdict.bar);
            let deep = meets(verdict.deep >= DEEP_BAR);
            format!(
                "{:.1} dB {standard} | {} {deep}",
                verdict.bar,
                shown(verdict.deep)
            )
        });
        text += &format!(" | {bars} |\n");
    }
    text
}

fn meets(ok: bool) -> &'static str {
    if ok { "met" } else { "MISSED" }
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

fn line_of<'a>(lines: &'a [SceneLine], class: &str, engine: &str) -> Option<&'a SceneLine> {
    let mut lines = lines.iter();
    lines.find(|line| line.class == class && line.engine == engine)
}

/// A class beside its bars; none if an engine's line is missing.
pub fn verdict(lines: &[SceneLine], class: &str) -> Option<ClassVerdict> {
    let of = |engine: &str| line_of(lines, class, engine);
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
