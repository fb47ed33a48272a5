//! Where `standard24` is worse than single precision: by how much, and which of its widths is to blame.
//!
//! Every such case is measured again with one group of widths made larger. The group that brings the error to or below that of
//! single precision is the one that binds.

use super::cases;
use super::table::{STAGES, pairs};
use super::{Line, exact, exact_picture, fixed_errors, project_all};
use crate::design::DesignChoice;
use splatline::format::Widths;
use std::fmt::Write;

/// A group of widths of a design file, made larger.
struct Repair {
    /// As a design file states it, with `base = "standard24"`.
    name: &'static str,
    widen: fn(&mut Widths),
}

/// One group per source of error, then the three of the picture together, then everything.
const REPAIRS: [Repair; 7] = [
    Repair {
        name: "mantissa 28",
        widen: |w| w.mantissa = 28,
    },
    Repair {
        name: "radial 36",
        widen: |w| w.radial = 36,
    },
    Repair {
        name: "table 12, interpolation 18",
        widen: widen_table,
    },
    Repair {
        name: "weight 28, alpha 28",
        widen: widen_opacity,
    },
    Repair {
        name: "colour 24, accumulator 27",
        widen: widen_colour,
    },
    Repair {
        name: "the last three",
        widen: widen_picture,
    },
    Repair {
        name: "all of these",
        widen: |w| {
            (w.mantissa, w.radial) = (28, 36);
            widen_picture(w);
        },
    },
];

fn widen_table(widths: &mut Widths) {
    (widths.table, widths.interpolation) = (12, 18);
}

fn widen_opacity(widths: &mut Widths) {
    (widths.weight, widths.alpha) = (28, 28);
}

fn widen_colour(widths: &mut Widths) {
    (widths.colour, widths.accumulator) = (24, 27);
}

fn widen_picture(widths: &mut Widths) {
    widen_table(widths);
    widen_opacity(widths);
    widen_colour(widths);
}

/// A stage of a case in which `standard24` has the larger error.
#[derive(Clone, Debug, PartialEq)]
pub struct Shortfall {
    /// The case.
    pub case: String,
    /// The stage's name.
    pub stage: &'static str,
    /// Error of single precision.
    pub single: f64,
    /// Error of `standard24`.
    pub fixed: f64,
    /// Error with each group of widths made larger, in the order of the columns.
    pub repaired: Vec<f64>,
}

/// Measures all cases again in which a stage falls short; `quick` as the lines were measured.
pub fn measure(lines: &[Line], quick: bool) -> Vec<Shortfall> {
    let mut shortfalls = Vec::new();
    let designs: Vec<DesignChoice> = REPAIRS.iter().map(design).collect();
    for ((single, fixed), case) in pairs(lines).zip(cases::all(quick)) {
        let short = STAGES.map(|(_, of)| of(&fixed.errors) > of(&single.errors));
        if !short.contains(&true) {
            continue;
        }
        let truth = project_all(&case, &case.scene.weights_for(&case.rules), exact::project);
        let picture = exact_picture(&case, &truth);
        let repaired: Vec<_> = designs
            .iter()
            .map(|design| fixed_errors(&case, design, &truth, &picture))
            .collect();
        for ((stage, of), _) in STAGES.into_iter().zip(short).filter(|(_, short)| *short) {
            shortfalls.push(Shortfall {
                case: case.name.clone(),
                stage,
                single: of(&single.errors),
                fixed: of(&fixed.errors),
                repaired: repaired.iter().map(of).collect(),
            });
        }
    }
    shortfalls
}

fn design(repair: &Repair) -> DesignChoice {
    let named = DesignChoice::named("standard24").expect("standard24 is a design");
    let mut design = named.at_run_time();
    design.name = repair.name.to_owned();
    (repair.widen)(&mut design.widths);
    design
}

/// One line per shortfall; an error that is not above single precision's is in bold type.
pub fn markdown(shortfalls: &[Shortfall]) -> String {
    let names = REPAIRS.map(|repair| repair.name).join(" | ");
    let mut text = format!(
        "Where standard24 is worse than f32, and the same error with some widths made larger (bold: no longer worse):\n\n\
         | stage | case | f32 | standard24 | {names} |\n|---|---|--:|--:|{}\n",
        "--:|".repeat(REPAIRS.len())
    );
    let mut sorted: Vec<&Shortfall> = shortfalls.iter().collect();
    sorted.sort_by_key(|shortfall| STAGES.iter().position(|(name, _)| *name == shortfall.stage));
    for short in sorted {
        // Writing to a String cannot fail.
        let _ = write!(
            text,
            "| {} | {} | {:.1e} | {:.1e} |",
            short.stage, short.case, short.single, short.fixed
        );
        for error in &short.repaired {
            let _ = match *error <= short.single {
                true => write!(text, " **{error:.1e}** |"),
                false => write!(text, " {error:.1e} |"),
            };
        }
        text.push('\n');
    }
    text
}
