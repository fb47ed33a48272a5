//! What each width of `standard24` buys: the suite with its widths taken back, one after the other and one at a time.
//!
//! The design began with 24-bit mantissas and a table of 2^10 intervals, chosen by scenes. Each step from there to
//! today's widths is measured by the number of cases that are worse than single precision, stage by stage, and priced.

use super::table::{JUDGED, STAGES, engine_pairs, needle_gain};
use super::{StabilityLine, measure};
use crate::design::DesignChoice;
use crate::machine::area::{CountedMachine, Family, synthesis};
use crate::machine::config::Config;
use splatline::format::Widths;

/// A change of one width: its name in a design file, and what the design began with.
type Step = (&'static str, u8, fn(&mut Widths) -> &mut u8);

/// Where designs are priced.
const FAMILY: Family = Family::Xilinx7;

/// In the order in which the data meets them.
const STEPS: [Step; 8] = [
    ("mantissa", 24, |w| &mut w.mantissa),
    ("subpixel", 20, |w| &mut w.subpixel),
    ("table", 10, |w| &mut w.table),
    ("interpolation", 14, |w| &mut w.interpolation),
    ("weight", 24, |w| &mut w.weight),
    ("alpha", 24, |w| &mut w.alpha),
    ("colour", 18, |w| &mut w.colour),
    ("accumulator", 24, |w| &mut w.accumulator),
];

/// Both tables as Markdown.
pub fn markdown(quick: bool) -> String {
    let designs = [growing(), shrinking()];
    let lines = measure(&designs.concat(), quick);
    let [growing, shrinking] = designs;
    let note = synthesis::statement(&FAMILY.calibration());
    format!(
        "LUT, FF, DSP and memory are those of the primitive with one lane ({note}).\n\nThe next table goes from the widths that `standard24` began with to today's, one after the other. It counts the cases that are worse than f32:\n\n{}\n\
         The last table takes a bit off one of today's widths at a time:\n\n{}",
        table(&growing, &lines),
        table(&shrinking, &lines)
    )
}

/// From the first widths to today's.
fn growing() -> Vec<DesignChoice> {
    let mut design = variant("began with", |widths| {
        for (_, began, of) in STEPS {
            *of(widths) = began;
        }
    });
    let mut today = design_of_today().widths;
    let mut designs = vec![design.clone()];
    for (field, began, of) in STEPS {
        let bits = *of(&mut today);
        *of(&mut design.widths) = bits;
        design.name = format!("{field} {began} to {bits}");
        designs.push(design.clone());
    }
    // The next design's price, to compare with.
    designs.extend(DesignChoice::named("deep32"));
    designs
}

/// Today's widths, each one bit smaller.
fn shrinking() -> Vec<DesignChoice> {
    let smaller = |(field, _, of): &Step| {
        let mut design = variant("", |widths| *of(widths) -= 1);
        design.name = format!("{field} {}", of(&mut design.widths));
        design
    };
    STEPS.iter().map(smaller).collect()
}

fn variant(name: &str, change: impl Fn(&mut Widths)) -> DesignChoice {
    let mut design = design_of_today().at_run_time();
    design.name = name.to_owned();
    change(&mut design.widths);
    design
}

fn design_of_today() -> DesignChoice {
    DesignChoice::named(JUDGED).expect("the judged design has a name")
}

fn table(designs: &[DesignChoice], lines: &[StabilityLine]) -> String {
    let stages: Vec<&str> = STAGES.iter().map(|(name, _)| *name).collect();
    let heading = format!(
        "| widths | {} | wrong decisions | needle 10:1, times better | table, kbit | LUT | FF | DSP | memory, kbit |\n|---|{}\n",
        stages.join(" | "),
        "--:|".repeat(STAGES.len() + 7)
    );
    let rows = designs.iter().map(|design| row(design, lines));
    heading + &rows.collect::<String>()
}

fn row(design: &DesignChoice, lines: &[StabilityLine]) -> String {
    let pairs = || engine_pairs(lines, &design.name);
    let worse = |of: fn(&super::StageErrors) -> f64| {
        let fell_short = |(single, fixed): &(&StabilityLine, &StabilityLine)| {
            of(&fixed.errors) > of(&single.errors)
        };
        pairs().filter(fell_short).count()
    };
    let counts: Vec<String> = STAGES
        .iter()
        .map(|(_, of)| worse(*of).to_string())
        .collect();
    let decisions: usize = pairs().map(|(_, fixed)| fixed.errors.decided_wrongly).sum();
    let needle = pairs()
        .find(|(single, _)| single.needle)
        .map_or(0.0, |(single, fixed)| {
            needle_gain(&single.errors, &fixed.errors)
        });
    let widths = &design.widths;
    let kbit = f64::from(widths.weight + 1) * f64::from(widths.table).exp2() / 1024.0;
    let machine = Config::primitive(1);
    let area = CountedMachine::new(widths, design.traversal, &machine, &FAMILY.calibration())
        .raster_unit();
    let area = area.resources().map(|(_, count)| count.to_string());
    format!(
        "| {} | {} | {decisions} | {needle:.1} | {kbit:.0} | {} |\n",
        design.name,
        counts.join(" | "),
        area.join(" | ")
    )
}
