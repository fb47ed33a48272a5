//! The arithmetic of one lane, from the radial index to the blended pixel, in fixed point and in floating-point
//! formats: area of its units, each synthesised alone.
//!
//! `lane_units.csv` is printed by `python sim/python/examples/notebooks/lane_units.py`, from the units of
//! `lane_units.sv` beside it: transistors (`abc -g cmos`), and cells of a family. No pipeline registers and no timing
//! are in it, nor a float's exponential, for which both have the same table: an estimate that ranks formats. A machine
//! in a format is the fixed one with a lane's arithmetic exchanged.

use super::circuit::Bits;
use super::{Area, Calibration, CountedMachine, Fabric, Family, lines_of};
use crate::config::Config;
use serde::Deserialize;
use splatline::format::{Traversal, Widths};
use std::sync::LazyLock;

static UNITS: LazyLock<Vec<LaneLine>> = LazyLock::new(|| {
    lines_of(include_str!("lane_units.csv")).expect("lane_units.csv is a table of units")
});

/// A unit of a format for a family.
#[derive(Deserialize)]
struct LaneLine {
    unit: String,
    format: String,
    family: Family,
    #[serde(flatten)]
    units: LaneUnits,
}

/// Sums and products of a pixel: its radial index from the neighbour's, its opacity, its share with three colours and
/// what is left of the light.
pub(crate) const OPERATIONS: [[u64; 2]; 3] = [[3, 2], [0, 1], [4, 5]];

/// A lane's arithmetic.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
pub struct LaneUnits {
    /// Transistors.
    pub transistors: u64,
    /// Cells of a family of FPGAs.
    #[serde(flatten)]
    pub fabric: Fabric,
}

/// A lane in floating point by the formats of its stages: radial index, opacity, blending. `fp32`, `fp16`, `bfloat16`,
/// `e4m3` or `e5m2`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FloatLane {
    /// Names.
    pub stages: [&'static str; 3],
    /// Bits of a pixel's number.
    pub bits: u64,
}

/// A unit of the table, if it is there.
fn unit(name: &str, format: &str, family: Family) -> Option<LaneUnits> {
    let mut lines = UNITS.iter().filter(|line| line.family == family);
    let found = lines.find(|line| line.unit == name && line.format == format);
    found.map(|line| line.units)
}

/// A float's sum and product, by their names in the table; nothing for a format that it does not have.
fn float_units(format: &str, family: Family) -> [LaneUnits; 2] {
    ["float_add", "float_multiply"].map(|name| unit(name, format, family).unwrap_or_default())
}

/// Transistors of a format's sum and product.
pub(crate) fn transistors(format: &str) -> [u64; 2] {
    float_units(format, Family::default()).map(|unit| unit.transistors)
}

impl FloatLane {
    /// Its arithmetic, if a pixel comes in every cycle.
    pub fn units(&self, family: Family) -> LaneUnits {
        self.shared_units(family, 1)
    }

    /// The same if blending has so many cycles for a pixel, in which sums and products share units.
    fn shared_units(&self, family: Family, interval: u64) -> LaneUnits {
        let mut all = LaneUnits::default();
        let [radial, blended @ ..] = OPERATIONS;
        let [opacity, blended] = blended.map(|counts| counts.map(|count| count.div_ceil(interval)));
        for (format, operations) in self.stages.iter().zip([radial, opacity, blended]) {
            for (unit, count) in float_units(format, family).iter().zip(operations) {
                all.transistors += unit.transistors * count;
                all.fabric = all.fabric + unit.fabric * count;
            }
        }
        all
    }
}

/// Transistors of a product and of a sum in fixed point: curves through the table's.
fn product_transistors([a, b]: [u64; 2]) -> u64 {
    (41 * a * b).saturating_sub(27 * (a + b))
}

fn sum_transistors(bits: u64) -> u64 {
    (33 * bits).saturating_sub(20)
}

/// Bits of a lane's sums in fixed point: two of the radial index, its interpolation, what is left of the light, three
/// colours.
fn sums(bits: &Bits) -> [u64; 7] {
    let (radial, colour) = (bits.radial + 5, bits.accumulator + bits.range + 1);
    let [weight, left] = [bits.weight + 1, bits.transmittance + 2];
    [radial, radial, weight, left, colour, colour, colour]
}

/// The arithmetic of a lane in fixed point, if a pixel comes in every cycle. A sum takes a look-up table a bit,
/// products the family's multipliers.
pub fn fixed_lane(widths: &Widths, calibration: &Calibration) -> LaneUnits {
    let bits = Bits::new(widths);
    let [opacity, share, colour] = bits.blend_products().map(|product| product.factors);
    let interpolation = bits.interpolation_product().map(|product| product.factors);
    let products = [opacity, share, colour, colour, colour]
        .into_iter()
        .chain(interpolation);
    let products: u64 = products.map(product_transistors).sum();
    let machine = Config::primitive(1);
    LaneUnits {
        transistors: products + sums(&bits).map(sum_transistors).iter().sum::<u64>(),
        fabric: Fabric {
            luts: sums(&bits).iter().sum(),
            dsps: CountedMachine::new(widths, Traversal::Spans, &machine, calibration).lane_dsps(),
            ..Fabric::default()
        },
    }
}

/// A machine's area with the arithmetic of all its lanes in floating point.
pub fn in_format(
    area: Area,
    lane: &FloatLane,
    widths: &Widths,
    config: &Config,
    calibration: &Calibration,
) -> Area {
    let counted = CountedMachine {
        surface: None,
        ..CountedMachine::new(widths, Traversal::Spans, config, calibration)
    };
    let units = u64::from(config.raster_units);
    let lanes = units * u64::from(config.lanes);
    let float = lane.shared_units(calibration.family, config.blend_interval.max(1).into());
    let float = float.fabric * lanes;
    let raster = Fabric {
        luts: (area.raster.luts + float.luts)
            .saturating_sub(lanes * sums(&counted.bits).iter().sum::<u64>()),
        dsps: (area.raster.dsps + float.dsps).saturating_sub(units * counted.lane_dsps()),
        ..area.raster
    };
    let weight = calibration.weight(&(raster + area.around));
    Area {
        raster,
        weight,
        ..area
    }
}

#[cfg(test)]
mod tests {
    use super::super::estimate;
    use super::*;
    use splatline::format::{Lean18, Standard24};

    fn lane(format: &'static str) -> FloatLane {
        let stages = [format; 3];
        FloatLane { stages, bits: 16 }
    }

    #[test]
    fn every_format_is_there_for_every_family_and_more_bits_take_more() {
        for family in Family::ALL {
            let units = ["fp32", "fp16", "bfloat16", "e4m3"].map(|name| lane(name).units(family));
            assert!(units.is_sorted_by(|wide, narrow| wide.transistors > narrow.transistors));
            assert!(units.iter().all(|units| units.fabric.luts > 300));
            assert!(lane("e5m2").units(family).transistors > 0);
        }
        assert_eq!(lane("fp64").units(Family::Ecp5), LaneUnits::default());
    }

    /// The curves of fixed point against the units that were synthesised.
    #[test]
    fn fixed_units_are_those_of_synthesis() {
        let found = |name: &str, size: &str| {
            let unit = unit(name, size, Family::Ecp5).unwrap();
            unit.transistors as f64
        };
        for (size, factors) in [
            ("6x6", [6, 6]),
            ("6x9", [6, 9]),
            ("8x8", [8, 8]),
            ("12x12", [12, 12]),
            ("16x16", [16, 16]),
            ("18x26", [18, 26]),
        ] {
            let curve = product_transistors(factors) as f64 / found("fixed_multiply", size);
            assert!((curve - 1.0).abs() < 0.07, "{size}: {curve}");
        }
        for (size, bits) in [("8", 8), ("16", 16), ("32", 32)] {
            assert_eq!(sum_transistors(bits) as f64, found("fixed_add", size));
        }
    }

    #[test]
    fn a_machine_in_a_format_differs_by_its_lanes_alone() {
        let prices = Family::Xilinx7.calibration();
        let config = Config::primitive(4);
        for widths in [Lean18::WIDTHS, Standard24::WIDTHS] {
            let fixed = estimate(&widths, Traversal::Spans, &config, &prices);
            let half = in_format(fixed, &lane("fp16"), &widths, &config, &prices);
            assert_eq!(half.around, fixed.around);
            assert_eq!(half.raster.memory_kbit, fixed.raster.memory_kbit);
            let float = lane("fp16").units(prices.family);
            let units = [float, fixed_lane(&widths, &prices)];
            let [float, own] = units.map(|units| prices.weight(&units.fabric) * 4.0);
            assert!((half.weight - fixed.weight - float + own).abs() < 1e-6);
        }
    }
}
