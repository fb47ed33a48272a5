//! Floating-point formats beside the fixed design that a search found: what each errs on the same frames, what its lane
//! takes, and the cheapest machine with such lanes.
//!
//! Pictures are drawn with every operation rounded. Area is that of [`crate::machine::area::lane`]. A machine in a
//! format has the rows and the cycles of the fixed design, whose lanes also take a pixel a cycle.

use super::evaluator::{DesignError, Evaluator};
use super::limits::{Limit, are_held};
use super::search::{Judge, Search};
use super::space::{Space, SpacePart};
use crate::machine::area::lane::fixed_lane;
use crate::machine::config::Config;
use crate::machine::energy::of_pixel;
use crate::plan::DesignVariant;
use crate::report::table::decibels;
use anyhow::Result;
use serde::Serialize;
use splatline::format::Widths;

/// What the figures are.
pub const NOTE: &str = "A lane's arithmetic from the radial index to the blended pixel, each unit as Yosys synthesises it alone, without registers and \
     the exponential's table; energy of fp16 and fp32 as published for 45 nm, of other floats by their area: estimates; a machine in a format has the \
     rows and cycles of the fixed design";

/// A format.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FormatRow {
    /// `fixed`, or the engine that draws it.
    pub format: &'static str,
    /// Errors over all frames.
    pub error: Option<DesignError>,
    /// Transistors of a lane's arithmetic.
    pub transistors: u64,
    /// The same by the family, in look-up tables.
    pub lane_luts: f64,
    /// Energy of a pixel in the lane and in the tile's buffer, picojoules.
    pub pj_per_pixel: f64,
    /// Are all limits held, of which a lane alone knows those on errors?
    pub holds: bool,
    /// The cheapest machine found with such lanes; where errors are too large, the fixed design's own with lanes
    /// exchanged.
    pub machine: Option<MachineInFormat>,
}

/// A machine whose lanes are in a format.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MachineInFormat {
    /// All resources, in look-up tables.
    pub luts_in_all: f64,
    /// Pictures a second.
    pub frames_per_s: f64,
    /// Energy of the most expensive frame.
    pub mj_per_frame: f64,
    /// Its settings.
    pub settings: Config,
}

/// What the evaluator's format takes, with errors and without a machine.
fn row(
    evaluator: &Evaluator,
    widths: &Widths,
    error: Option<DesignError>,
    limits: &[Limit],
) -> FormatRow {
    let (subject, lane) = (&evaluator.subject, evaluator.lane());
    let prices = &subject.calibration;
    let units = match &lane {
        Some(lane) => lane.units(prices.family),
        None => fixed_lane(widths, prices),
    };
    let mut errors = limits.iter().filter(|limit| limit.quantity.is_error());
    FormatRow {
        format: evaluator.format.unwrap_or_default().name(),
        error,
        transistors: units.transistors,
        lane_luts: prices.weight(&units.fabric),
        pj_per_pixel: of_pixel(lane.as_ref(), widths, &subject.energy),
        holds: errors.all(|limit| limit.excess_of_error(error) <= 0.0),
        machine: None,
    }
}

/// A row of each of the formats asked for, the fixed design first; `row` is given the evaluator that draws in it, and
/// all frames.
fn rows(
    evaluator: &mut Evaluator,
    row: impl Fn(&Evaluator, &[usize]) -> Result<FormatRow>,
) -> Result<Vec<FormatRow>> {
    let all: Vec<usize> = (0..evaluator.subject.frames.len()).collect();
    let formats = evaluator.subject.formats.clone();
    let mut rows = Vec::new();
    for format in std::iter::once(None).chain(formats.into_iter().map(Some)) {
        evaluator.draw_in(format);
        rows.push(row(evaluator, &all)?);
    }
    evaluator.draw_in(None);
    Ok(rows)
}

/// Beside a design that was fitted.
pub fn beside_design(
    evaluator: &mut Evaluator,
    variant: &DesignVariant,
    limits: &[Limit],
) -> Result<Vec<FormatRow>> {
    rows(evaluator, |evaluator, all| {
        let error = evaluator.error(variant, all)?;
        Ok(row(evaluator, &variant.design.widths, error, limits))
    })
}

/// Beside a point that a search on `frames` ended at.
pub(super) fn beside_point(
    evaluator: &mut Evaluator,
    (space, limits): (&Space, &[Limit]),
    (frames, point): (&[usize], &[usize]),
    judge: Judge,
    progress: &(dyn Fn(&str) + Sync),
) -> Result<Vec<FormatRow>> {
    let axes = 0..space.axes.len();
    let machines: Vec<usize> = axes
        .filter(|axis| space.axes[*axis].part != SpacePart::Design)
        .collect();
    rows(evaluator, |evaluator, all| {
        let mut search = Search::new(evaluator, space, limits, frames.to_vec(), progress);
        let mut at = point.to_vec();
        if evaluator.format.is_some() && search.error_excess(&at)? <= 0.0 {
            at = search.descend(at, &machines, judge)?;
        }
        let choice = search.choice(&at)?;
        let error = evaluator.error(&choice.variant, all)?;
        let reached = evaluator.reached(&choice, error, &evaluator.on_all_frames(&choice)?);
        Ok(FormatRow {
            holds: are_held(limits, &reached),
            machine: Some(MachineInFormat {
                luts_in_all: reached.cost(),
                frames_per_s: reached.pace.frames_per_s,
                mj_per_frame: reached.millijoules,
                settings: choice.machine,
            }),
            ..row(evaluator, &choice.variant.design.widths, error, limits)
        })
    })
}

/// Headings and lines of a table for people.
pub fn table(rows: &[FormatRow]) -> (Vec<&'static str>, Vec<Vec<String>>) {
    let mut headings = vec![
        "format",
        "PSNR dB",
        "largest",
        "bias",
        "transistors a lane",
        "LUT a lane",
        "pJ a pixel",
    ];
    if rows.iter().any(|row| row.machine.is_some()) {
        headings.extend(["LUT in all", "frames/s", "mJ a frame"]);
    }
    headings.push("holds");
    (headings, rows.iter().map(line).collect())
}

fn line(row: &FormatRow) -> Vec<String> {
    let error = |show: fn(DesignError) -> String| row.error.map_or("-".to_owned(), show);
    let mut cells = vec![
        row.format.to_owned(),
        error(|e| decibels(e.psnr_db())),
        error(|e| format!("{:.2e}", e.max_abs)),
        error(|e| format!("{:+.2e}", e.bias)),
        row.transistors.to_string(),
        format!("{:.0}", row.lane_luts),
        format!("{:.1}", row.pj_per_pixel),
    ];
    if let Some(machine) = &row.machine {
        cells.extend([
            format!("{:.0}", machine.luts_in_all),
            format!("{:.2}", machine.frames_per_s),
            format!("{:.3}", machine.mj_per_frame),
        ]);
    }
    cells.push(if row.holds { "yes" } else { "no" }.to_owned());
    cells
}

/// Which is cheapest of those that hold all limits, and by how much.
pub fn verdict(rows: &[FormatRow]) -> String {
    let cost = |row: &&FormatRow| {
        let of_lane = row.transistors as f64;
        row.machine
            .as_ref()
            .map_or(of_lane, |machine| machine.luts_in_all)
    };
    let mut held: Vec<&FormatRow> = rows.iter().filter(|row| row.holds).collect();
    held.sort_by(|a, b| cost(a).total_cmp(&cost(b)));
    match held[..] {
        [] => "None holds all limits".to_owned(),
        [only] => format!(
            "Cheapest: {}, the only one that holds all limits",
            only.format
        ),
        [best, next, ..] => format!(
            "Cheapest: {}; {} takes {:.2} times the transistors a lane, {:.2} times the energy a pixel{}",
            best.format,
            next.format,
            next.transistors as f64 / best.transistors.max(1) as f64,
            next.pj_per_pixel / best.pj_per_pixel,
            next.machine.as_ref().map_or(String::new(), |_| {
                format!(", {:.2} times LUT in all", cost(&next) / cost(&best))
            })
        ),
    }
}

/// All of it for a terminal; nothing if no format was asked for.
pub fn text(rows: &[FormatRow]) -> String {
    if rows.is_empty() {
        return String::new();
    }
    let (headings, lines) = table(rows);
    let headings: Vec<String> = headings.iter().map(ToString::to_string).collect();
    let mut text = String::new();
    for line in std::iter::once(&headings).chain(&lines) {
        for (column, (cell, heading)) in line.iter().zip(&headings).enumerate() {
            let width = heading.len().max(9);
            text += &match column {
                0 => format!("  {cell:<width$}"),
                _ => format!("  {cell:>width$}"),
            };
        }
        text.push('\n');
    }
    text + &format!("  {}\n  {NOTE}\n", verdict(rows))
}
