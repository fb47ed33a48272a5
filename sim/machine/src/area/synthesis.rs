//! What Yosys made of the primitive: the counts that the estimate is calibrated on and held against.
//!
//! `synthesised.csv` is printed by `rtl -- area primitive` of `sim/rtl/cosim`, with the widths that were synthesised.
//! Two designs with one and four lanes are fitted; two lanes and a design between the two have not been seen by the
//! fit.

use super::calibration::{Calibration, Family};
use super::surface::ESTIMATED;
use super::{CountedMachine, Fabric, RESOURCES, lines_of, units};
use crate::config::Config;
use crate::design::DesignChoice;
use crate::primitive::Intervals;
use serde::Deserialize;
use splatline::format::{Lean18, Rounding, Standard24, Traversal, Widths};
use std::fmt::Write;

/// The table, as it lies beside this file.
pub const CSV: &str = include_str!("synthesised.csv");

const HEADING: &str = "design,widths,family,part";

/// What was synthesised.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SynthesisedPart {
    /// The splat setup alone, of a packet in so many cycles.
    Setup(u32),
    /// The row generator alone, of a row in so many cycles.
    Rows(u32),
    /// The primitive with so many lanes.
    Lanes(u32),
    /// That with one lane, as small as it gets.
    Small,
}

/// A design whose circuits are synthesised.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Subject {
    /// Its name.
    pub name: &'static str,
    /// Its widths.
    pub widths: Widths,
}

/// One circuit and its counts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Synthesised {
    /// Name of the design.
    pub design: String,
    /// Its widths when it was synthesised.
    pub widths: Widths,
    /// For which devices.
    pub family: Family,
    /// What of it.
    pub part: SynthesisedPart,
    /// The counts.
    pub fabric: Fabric,
}

/// What `splatline fit random:300 --max-error 0.00001 --size 64x64` proposes.
const FITTED: &str = include_str!("fitted.toml");

/// Name of the design that `splatline fit` proposed.
pub const OF_FIT: &str = "of fit";

/// The designs, and two between them that the lines have not seen, one of them from `splatline fit`.
///
/// # Panics
/// If `fitted.toml` is not a design; a test reads it.
pub fn subjects() -> [Subject; 4] {
    let between = Widths {
        mantissa: 24,
        subpixel: 20,
        table: 10,
        interpolation: 14,
        weight: 24,
        alpha: 24,
        colour: 18,
        accumulator: 24,
        ..Standard24::WIDTHS
    };
    let proposed = DesignChoice::from_toml("fitted.toml", FITTED).expect("fitted.toml is a design");
    let subject = |name, widths| Subject { name, widths };
    [
        subject("lean18", Lean18::WIDTHS),
        subject("standard24", Standard24::WIDTHS),
        subject("24-bit mantissa", between),
        subject(OF_FIT, proposed.widths),
    ]
}

/// Everything that was synthesised.
///
/// # Panics
/// If the table is not what [`to_csv`] writes; a test reads it.
pub fn synthesised() -> Vec<Synthesised> {
    parse(CSV).expect("synthesised.csv is a table of synthesised circuits")
}

/// The lines of a table; nothing if one of them is none.
pub fn parse(text: &str) -> Option<Vec<Synthesised>> {
    let synthesised = |line: SynthesisLine| {
        let numbers: Result<Vec<u8>, _> = line.widths.split(' ').map(str::parse).collect();
        let part = match line.part.split_once(' ') {
            Some(("setup", interval)) => SynthesisedPart::Setup(interval.parse().ok()?),
            Some(("rows", interval)) => SynthesisedPart::Rows(interval.parse().ok()?),
            _ if line.part == "small" => SynthesisedPart::Small,
            _ => SynthesisedPart::Lanes(line.part.parse().ok()?),
        };
        Some(Synthesised {
            widths: widths_of(&line.design, numbers.ok()?.try_into().ok()?),
            design: line.design,
            family: line.family,
            part,
            fabric: line.fabric,
        })
    };
    let lines = lines_of(text).ok()?;
    lines.into_iter().map(synthesised).collect()
}

/// A line of the table.
#[derive(Deserialize)]
struct SynthesisLine {
    design: String,
    widths: String,
    #[serde(deserialize_with = "Family::by_name")]
    family: Family,
    part: String,
    #[serde(flatten)]
    fabric: Fabric,
}

/// The circuit begins at the packet: how positions became footprints is nothing to it. It rounds as the design of this
/// name does.
fn widths_of(design: &str, numbers: [u8; 12]) -> Widths {
    let mut all = [Standard24::WIDTHS.position; 13];
    all[1..].copy_from_slice(&numbers);
    let mut subjects = subjects().into_iter();
    let known = subjects.find(|subject| subject.name == design);
    let rounding = known.map_or(Rounding::Nearest, |subject| subject.widths.rounding);
    Widths::from_numbers(all, rounding)
}

/// The table's text.
pub fn to_csv(lines: &[Synthesised]) -> String {
    let mut text = format!("{HEADING},{RESOURCES}\n");
    for line in lines {
        let [_, numbers @ ..] = line.widths.numbers();
        let widths = numbers.map(|width| width.to_string()).join(" ");
        let part = match line.part {
            SynthesisedPart::Setup(interval) => format!("setup {interval}"),
            SynthesisedPart::Rows(interval) => format!("rows {interval}"),
            SynthesisedPart::Lanes(lanes) => lanes.to_string(),
            SynthesisedPart::Small => "small".to_owned(),
        };
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "{},{widths},{},{part},{}",
            line.design,
            line.family.name(),
            line.fabric.cells()
        );
    }
    text
}

impl Synthesised {
    /// Do the calibration's lines go through it?
    pub fn fitted(&self) -> bool {
        let mut fitted = subjects().into_iter().take(2);
        let unseen = [SynthesisedPart::Lanes(2), SynthesisedPart::Small];
        fitted.any(|subject| subject.name == self.design) && !unseen.contains(&self.part)
    }

    /// The estimate of the same circuit, if it is a whole one.
    pub fn estimate(&self, calibration: &Calibration) -> Option<Fabric> {
        let config = match self.part {
            SynthesisedPart::Lanes(lanes) => Config::primitive(lanes),
            SynthesisedPart::Small => Config::primitive(1).with_intervals(Intervals::SMALL),
            _ => return None,
        };
        let widths = &self.widths;
        Some(CountedMachine::new(widths, Traversal::Spans, &config, calibration).raster_unit())
    }
}

/// By how much a family's own estimate misses synthesis at worst, of LUT, FF, DSP and memory; as parts of 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AreaErrors {
    /// Circuits that the lines go through.
    pub fitted: f64,
    /// Circuits that the fit has not seen; none if none was synthesised.
    pub unseen: Option<f64>,
}

/// Holds a family's estimate against its synthesis.
pub fn errors(family: Family) -> AreaErrors {
    let calibration = family.calibration();
    let (mut fitted, mut unseen) = (0.0, None);
    for line in synthesised().iter().filter(|line| line.family == family) {
        let Some(estimate) = line.estimate(&calibration) else {
            continue;
        };
        let worst = estimate.worst_error(&line.fabric);
        if line.fitted() {
            fitted = f64::max(fitted, worst);
        } else {
            unseen = Some(f64::max(unseen.unwrap_or(0.0), worst));
        }
    }
    AreaErrors { fitted, unseen }
}

/// What kind of estimate the area of a machine is.
pub fn statement_of(calibration: &Calibration, config: &Config) -> String {
    let statement = statement(calibration);
    match config.surface_layers {
        0 => statement,
        _ => format!("{statement}; {ESTIMATED}"),
    }
}

/// What kind of estimate the area of machines without a surface unit is.
pub fn statement(calibration: &Calibration) -> String {
    let name = calibration.family.name();
    if !calibration.is_own() {
        return format!(
            "area by prices of your own, begun from those of {name}; not held against any synthesis"
        );
    }
    let AreaErrors { fitted, unseen } = errors(calibration.family);
    let unseen = unseen.map_or(String::new(), |unseen| {
        let percent = 100.0 * unseen;
        format!(" and {percent:.1} % of circuits that the calibration has not seen")
    });
    format!(
        "area for {name}: the raster unit of sim/rtl (layout rows, one row a cycle) is estimated within {:.1} % of its synthesis{unseen} (LUT, FF, DSP, memory; \
         docs/hardware.md); sorter, binning, harmonics, readers and arbiter are their synthesis; other layouts, geometry setup and queues are counted{}; {}",
        100.0 * fitted,
        match calibration.family {
            Family::Ecp5 | Family::Xilinx7 =>
                ", but for geometry setup of a splat in eight cycles or more (docs/hardware.md)",
            _ => "",
        },
        units::LEFT_OUT
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_whole_and_of_todays_widths() {
        let lines = synthesised();
        assert_eq!(to_csv(&lines), CSV);
        for line in &lines {
            let mut subjects = subjects().into_iter();
            let subject = subjects
                .find(|subject| subject.name == line.design)
                .unwrap();
            // The circuit knows no positions.
            let position = line.widths.position;
            let widths = Widths {
                position,
                ..subject.widths
            };
            assert_eq!(widths, line.widths, "{}: synthesise it anew", line.design);
        }
        use SynthesisedPart::{Lanes, Rows, Setup, Small};
        for family in Family::ALL {
            for design in ["lean18", "standard24"] {
                for part in [
                    Setup(1),
                    Setup(4),
                    Setup(8),
                    Rows(1),
                    Rows(2),
                    Lanes(1),
                    Lanes(4),
                    Small,
                ] {
                    let of = |line: &&Synthesised| (line.family, line.part) == (family, part);
                    let mut designs = lines.iter().filter(of).map(|line| line.design.as_str());
                    assert!(designs.any(|name| name == design), "{design}: {part:?}");
                }
            }
        }
        assert_eq!(parse("design,widths\nlean18,30\n"), None);
    }

    #[test]
    fn estimates_are_within_a_tenth_of_synthesis() {
        for family in Family::ALL {
            let AreaErrors { fitted, unseen } = errors(family);
            let worst = unseen.unwrap_or(0.0).max(fitted);
            assert!(worst < 0.1, "{family:?}: {fitted}, {unseen:?}");
        }
    }

    #[test]
    fn prices_of_ones_own_are_said_to_be_so() {
        let own = Calibration::from_toml("c.toml", "family = \"ecp5\"\nluts_per_dsp = 100.0\n");
        assert!(statement(&own.unwrap()).contains("not held against"));
        assert!(statement(&Family::Ecp5.calibration()).contains("ECP5"));
    }
}
