//! The generated SystemVerilog package of a design: widths and packet layout, from the kernel's own values.
//!
//! `sim/rtl/<design>/splatline_pkg.sv` is this module's output; a test compares the committed files with it, so that
//! the parameters of the model and of the circuit cannot drift apart.

use anyhow::{Result, bail, ensure};
use splatline::footprint::packet::{Layout, VERSION};
use splatline::format::{Rounding, Traversal, WIDTH_RANGES, Widths};
use splatline::raster::{BLOCK, GUARD, vertical_fraction};
use splatline::rules::Rules;
use splatline_sim::fixed::TableMemory;
pub use splatline_sim::machine::primitive::TILE;
use std::fmt::Display;

/// Base-2 logarithms of a tile's columns and rows. The columns are a seed block's, so that a row is one run from its
/// seed on.
const TILE_BITS: [u32; 2] = [TILE[0].ilog2(), TILE[1].ilog2()];
const _: () = assert!(TILE[0] == BLOCK && TILE[0].is_power_of_two() && TILE[1].is_power_of_two());

/// The package, but for its numbers, its name, the packet's fields and the types.
const TEXT: &str = include_str!("../templates/package.txt");

/// Types of the units' interfaces, in terms of the generated widths.
const TYPES: &str = include_str!("../../types.svh");

/// The footprint table of a design under `rules` in the circuit's form, UQ1.weight: the kernel at the start of each
/// interval, and the step down to its end.
pub fn table(widths: &Widths, rules: &Rules) -> Vec<[u32; 2]> {
    let memory = TableMemory::new(widths, rules).entries;
    // Beyond its end the kernel is 0.
    let next = memory.iter().skip(1).copied().chain([0]);
    let entries = memory.iter().zip(next);
    entries.map(|(low, next)| [*low, low - next]).collect()
}

/// Can the circuit be built for these widths? An error names the one that is refused, and what it must be.
fn check(widths: &Widths) -> Result<()> {
    if let Err(error) = widths.check() {
        let (field, value, (low, high)) = (error.field, error.value, error.range);
        bail!("{field} = {value}: it must be from {low} to {high}");
    }
    let (radial, interpolation) = (widths.radial, widths.interpolation);
    let (alpha, accumulator) = (widths.alpha, widths.accumulator);
    let finest = (radial + 4).saturating_sub(widths.table);
    let opacity = widths.peak + widths.weight;
    let share = widths.transmittance + widths.colour;
    ensure!(
        widths.rounding != Rounding::Truncate,
        "rounding = truncate: the circuit rounds to nearest"
    );
    ensure!(
        radial <= 27,
        "radial = {radial}: the circuit's lanes have 32 bits, which hold at most 27"
    );
    ensure!(
        (1..=finest).contains(&interpolation),
        "interpolation = {interpolation}: the circuit needs from 1 to radial + 4 - table = {finest}"
    );
    ensure!(
        alpha < opacity,
        "alpha = {alpha}: the circuit needs less than peak + weight = {opacity}"
    );
    ensure!(
        accumulator < share,
        "accumulator = {accumulator}: the circuit needs less than transmittance + colour = {share}"
    );
    Ok(())
}

/// The text of a design's package; an error that names the width for which there is no circuit.
pub fn text(name: &str, widths: &Widths) -> Result<String> {
    if let Err(refusal) = check(widths) {
        bail!("there is no circuit for design '{name}': {refusal}");
    }
    let kinds = [Rules::EWA, Rules::GAUSSIAN_3D];
    let steps = kinds.iter().flat_map(|rules| table(widths, rules));
    let steps = steps.map(|[_, step]| u32::BITS - step.leading_zeros());
    let (layout, range) = (Layout::new(widths, Traversal::Spans), widths.colour_range());
    let ranges = WIDTH_RANGES.iter().zip(widths.numbers());
    let text = ranges.fold(TEXT.to_owned(), |text, ((width, ..), bits)| {
        filled(&text, &[(width, &bits)])
    });
    Ok(filled(
        &text,
        &[
            ("name", &name),
            ("steps", &steps.max().unwrap_or(1)),
            ("colour_bits", &(widths.colour + range)),
            ("sum", &(widths.accumulator + range + 1)),
            ("even", &u8::from(widths.rounding == Rounding::NearestEven)),
            ("block", &BLOCK.ilog2()),
            ("guard", &GUARD),
            ("vertical", &vertical_fraction(widths)),
            ("columns", &TILE_BITS[0]),
            ("rows", &TILE_BITS[1]),
            ("bits", &layout.bits()),
            ("version", &VERSION),
            ("fields", &fields(&layout)),
            ("types", &TYPES),
        ],
    ))
}

/// A text with values in the places of their names, each written `@name@`.
pub fn filled(text: &str, values: &[(&str, &dyn Display)]) -> String {
    values.iter().fold(text.to_owned(), |text, (name, value)| {
        text.replace(&format!("@{name}@"), &value.to_string())
    })
}

/// The fields of the packet as a packed struct: the first one is the least significant, so the order is reversed.
fn fields(layout: &Layout) -> String {
    let fields = layout.fields().iter().rev().filter(|field| field.width > 0);
    let lines = fields.map(|field| {
        let sign = if field.signed { "signed " } else { "" };
        let format = match field.fraction {
            0 => String::new(),
            bits => format!("  // {bits} fraction bits"),
        };
        let (name, high) = (field.name, field.width - 1);
        format!("    logic {sign}[{high}:0] {name};{format}\n")
    });
    lines.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use splatline::format::{Classic8, Deep32, Lean18, Standard24};

    #[test]
    fn every_design_has_a_package_or_a_refusal_that_names_a_width() {
        assert!(check(&Lean18::WIDTHS).is_ok());
        assert!(check(&Standard24::WIDTHS).is_ok());
        let error = |name, widths| text(name, widths).unwrap_err().to_string();
        assert_eq!(
            error("deep32", &Deep32::WIDTHS),
            "there is no circuit for design 'deep32': radial = 44: the circuit's lanes have 32 bits, which hold at most 27"
        );
        assert_eq!(
            error("classic8", &Classic8::WIDTHS),
            "there is no circuit for design 'classic8': rounding = truncate: the circuit rounds to nearest"
        );
    }

    /// Every corner of every range is refused by the name of a width, or has a package.
    #[test]
    fn refusals_name_a_width() {
        for (field, low, high) in WIDTH_RANGES {
            for value in [low, high] {
                let widths = with(field, value);
                if let Err(refusal) = check(&widths) {
                    let refusal = refusal.to_string();
                    let named = WIDTH_RANGES
                        .iter()
                        .any(|(name, ..)| refusal.starts_with(&format!("{name} = ")));
                    assert!(named, "{refusal}");
                } else {
                    assert!(text("corner", &widths).is_ok());
                }
            }
        }
    }

    fn with(field: &str, value: u8) -> Widths {
        let mut widths = Lean18::WIDTHS;
        let place = match field {
            "position" => &mut widths.position,
            "view" => &mut widths.view,
            "mantissa" => &mut widths.mantissa,
            "subpixel" => &mut widths.subpixel,
            "radial" => &mut widths.radial,
            "table" => &mut widths.table,
            "interpolation" => &mut widths.interpolation,
            "weight" => &mut widths.weight,
            "peak" => &mut widths.peak,
            "alpha" => &mut widths.alpha,
            "transmittance" => &mut widths.transmittance,
            "colour" => &mut widths.colour,
            "accumulator" => &mut widths.accumulator,
            _ => unreachable!("a field of WIDTH_RANGES"),
        };
        *place = value;
        widths
    }
}
