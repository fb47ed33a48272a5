//! The suite as text: one line per engine and case, a verdict per case, and the summary of the bars.

use super::{StabilityLine, StageErrors};

/// The named design that the bars are about.
pub const JUDGED: &str = "standard24";
/// How much better than single precision the form of a needle must be.
const NEEDLE_BAR: f64 = 10.0;

/// A stage's name and its error.
pub type StageColumn = (&'static str, fn(&StageErrors) -> f64);

/// Stages in the order of the columns, each of which has a derived bound.
pub const STAGES: [StageColumn; 8] = [
    ("centre", |e| e.centre),
    ("depth", |e| e.depth),
    ("peak", |e| e.peak),
    ("variance", |e| e.variance),
    ("determinant", |e| e.determinant),
    ("form", |e| e.form),
    ("r", |e| e.radial),
    ("picture", |e| e.picture),
];

/// All lines as CSV; the last column names the stages in which a design is worse than `f32`, without any tolerance.
pub fn csv(lines: &[StabilityLine]) -> String {
    let mut text = String::from(
        "case,engine,centre px,depth rel,peak rel,variance rel,determinant rel,form rel,r abs,picture,bias,PSNR dB,decided otherwise,on a threshold,\
         wrong culls,worse than f32 in\n",
    );
    let mut single = StageErrors::default();
    for line in lines {
        let e = &line.errors;
        let mut worse = String::new();
        if line.engine == "f32" {
            single = line.errors;
        } else {
            worse = worse_stages(e, &single);
        }
        let psnr = e.psnr_db.map(|db| format!("{db:.1}"));
        let psnr = psnr.unwrap_or("exact".to_owned());
        let stages = STAGES.map(|(_, of)| format!("{:.1e}", of(e))).join(",");
        text += &format!(
            "\"{}\",{},{stages},{:.1e},{psnr},{},{},{},{worse}\n",
            line.case, line.engine, e.bias, e.decided_wrongly, e.edges, e.culled_wrongly
        );
    }
    text
}

/// The stages in which `fixed` has the larger error; `-` if there is none.
fn worse_stages(fixed: &StageErrors, single: &StageErrors) -> String {
    let worse = STAGES.iter().filter(|(_, of)| of(fixed) > of(single));
    let names: Vec<&str> = worse.map(|(name, _)| *name).collect();
    if names.is_empty() {
        "-".to_owned()
    } else {
        names.join("; ")
    }
}

/// The bars, each with the number of cases that meet it.
pub fn summary(lines: &[StabilityLine]) -> String {
    let mut text = format!("Bars of {JUDGED}, {} cases:\n\n", pairs(lines).count());
    for (name, of) in STAGES {
        let worse: Vec<String> = pairs(lines)
            .map(|(single, fixed)| (fixed, of(&single.errors), of(&fixed.errors)))
            .filter(|(_, single, fixed)| fixed > single)
            .map(|(line, single, fixed)| format!("{} ({fixed:.1e}, f32 {single:.1e})", line.case))
            .collect();
        text += &format!(
            "- {name} worse than f32 in {} cases{}{}\n",
            worse.len(),
            if worse.is_empty() { "" } else { ": " },
            worse.join("; ")
        );
    }
    let decisions = std::iter::once("f32").chain(crate::design::NAMES);
    let decisions: Vec<String> = decisions
        .map(|engine| {
            let of_engine = lines.iter().filter(|line| line.engine == engine);
            let (wrong, all) = of_engine.fold((0, 0), |(wrong, all), line| {
                (wrong + line.errors.decided_wrongly, all + line.errors.edges)
            });
            format!("{engine} {wrong} of {all}")
        })
        .collect();
    text += &format!(
        "- pixels on a threshold decided otherwise: {}\n",
        decisions.join(", ")
    );
    let needles = pairs(lines).filter(|(single, _)| single.needle);
    let gain = |single: &StabilityLine, fixed| needle_gain(&single.errors, fixed);
    let gains = needles.map(|(single, fixed)| (gain(single, &fixed.errors), &*fixed.case));
    let gains: Vec<(f64, &str)> = gains.collect();
    if let Some((gain, case)) = gains.iter().min_by(|a, b| a.0.total_cmp(&b.0)) {
        let verdict = if *gain >= NEEDLE_BAR {
            "pass"
        } else {
            "FALLS SHORT"
        };
        text += &format!(
            "- form of {} needles at least {gain:.1e} times better than f32 ({case}; bar {NEEDLE_BAR}): {verdict}\n",
            gains.len()
        );
    }
    text
}

/// The steps' bounds beside what is used of them: the largest share over all splats and pixels, and the largest error.
pub fn bounds(lines: &[StabilityLine]) -> String {
    let designs = ["lean18", JUDGED, "deep32"];
    let mut text = format!(
        "`docs/error-analysis.md` derives a bound for each step. The table has the largest part of it that a splat or a pixel uses, and the case in which it does; 1 is the bound.\n\n\
         | step | {} |\n|---|{}\n",
        designs.join(" | "),
        "---|".repeat(designs.len())
    );
    for (step, (name, _)) in STAGES.iter().enumerate() {
        let cells = designs.map(|design| {
            let of_design = lines.iter().filter(|line| line.engine == design);
            let share = |line: &&StabilityLine| line.errors.shares[step];
            let most = of_design.max_by(|a, b| share(a).total_cmp(&share(b)));
            let cell = most.map(|line| format!("{:.2} {}", share(&line), line.case));
            cell.unwrap_or_default()
        });
        text += &format!("| {name} | {} |\n", cells.join(" | "));
    }
    text
}

/// How many times smaller the form's error is than in single precision.
pub fn needle_gain(single: &StageErrors, fixed: &StageErrors) -> f64 {
    single.form / fixed.form
}

/// For each case the line of single precision and the judged design's.
pub fn pairs(lines: &[StabilityLine]) -> impl Iterator<Item = (&StabilityLine, &StabilityLine)> {
    engine_pairs(lines, JUDGED)
}

/// For each case the line of single precision and another engine's.
pub fn engine_pairs<'a>(
    lines: &'a [StabilityLine],
    engine: &str,
) -> impl Iterator<Item = (&'a StabilityLine, &'a StabilityLine)> {
    let of = |engine: &str| {
        let engine = engine.to_owned();
        lines.iter().filter(move |line| line.engine == engine)
    };
    of("f32").zip(of(engine))
}
