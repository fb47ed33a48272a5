//! Area of the setup unit in `sim/rtl`: a straight line through its synthesis for designs whose axes are turned in
//! front of the cores, and one for others.
//!
//! The unit is a base and a number of equal cores, each with multipliers of its own; all cores together take a round of
//! slots for as many splats as there are cores. So an interval between two splats is a number of cores. Below eight
//! cycles there is no such circuit: its ends take a record in eight, and so many cores with registers and shifters of
//! their own would be the wrong circuit for it.

use super::{Calibration, Fabric, Family, RESOURCES, lines_of};
use crate::config::Config;
use serde::Deserialize;
use splatline::format::Widths;
use splatline::math::GUARD;
use std::fmt::Write;

/// The counts, as `rtl -- area setup` prints them.
pub const CSV: &str = include_str!("setup.csv");

const HEADING: &str = "design,position,mantissa,round,family,cores";

/// Cycles between two splats at best.
pub const LEAST_INTERVAL: u32 = 8;

/// Cores that a unit has at most.
pub const MOST_CORES: u32 = 32;

/// Numbers of cores that the lines go through.
pub const FITTED_CORES: [u32; 2] = [1, 4];

/// A design with standard24's positions and a shorter mantissa: what a bit of mantissa takes follows from both.
const SHORTER: &str = "24-bit mantissa";

/// One circuit and its counts.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
pub struct SetupUnit {
    /// Name of the design.
    pub design: String,
    /// Bits of the difference to the eye: above 30 it has two parts, and the round is longer.
    pub position: u8,
    /// Bits of a mantissa.
    pub mantissa: u8,
    /// Slots of a splat.
    pub round: u32,
    /// For which devices.
    #[serde(deserialize_with = "Family::by_name")]
    pub family: Family,
    /// Cores.
    pub cores: u32,
    /// The counts.
    #[serde(flatten)]
    pub fabric: Fabric,
}

/// The table's text.
pub fn to_csv(units: &[SetupUnit]) -> String {
    let mut text = format!("{HEADING},{RESOURCES}\n");
    for unit in units {
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "{},{},{},{},{},{},{}",
            unit.design,
            unit.position,
            unit.mantissa,
            unit.round,
            unit.family.name(),
            unit.cores,
            unit.fabric.cells()
        );
    }
    text
}

/// Everything that was synthesised.
///
/// # Panics
/// If the table is not what [`to_csv`] writes; a test reads it.
pub fn synthesised() -> Vec<SetupUnit> {
    lines_of(CSV).expect("setup.csv is a table of synthesised setup units")
}

/// The setup units of a machine as the circuit that takes a splat as often: one with more cores. Nothing where there is
/// no such circuit: below its least interval, beyond its most cores, for a family for which none was synthesised, or
/// where prices are the user's own.
pub(super) fn of_machine(
    widths: &Widths,
    config: &Config,
    calibration: &Calibration,
) -> Option<Fabric> {
    let units = synthesised();
    let round = round(&units, widths)?;
    let cores = (round * config.setup_units).div_ceil(config.setup_interval);
    let rare = config.setup_interval >= LEAST_INTERVAL * config.setup_units;
    let built = rare && cores <= MOST_CORES && calibration.is_own();
    built.then(|| estimate(&units, calibration.family, widths.mantissa, cores))?
}

/// Are axes turned in front of the cores? Their sums, two bits and a sign longer than a window, are then items of 32
/// bits.
pub fn is_turned(mantissa: u8) -> bool {
    u32::from(mantissa) + GUARD + 3 <= 32
}

/// Slots of a splat for a design: more where positions have two parts or axes are turned in the cores. The most where
/// no circuit is alike.
pub fn round(units: &[SetupUnit], widths: &Widths) -> Option<u32> {
    let kind = |position: u8, mantissa: u8| (position > 30, is_turned(mantissa));
    let of = kind(widths.position, widths.mantissa);
    let is_alike = |unit: &&SetupUnit| kind(unit.position, unit.mantissa) == of;
    let same = units.iter().find(is_alike);
    let longest = || units.iter().max_by_key(|unit| unit.round);
    same.or_else(longest).map(|unit| unit.round)
}

/// A unit with so many cores for a family: on lean18's line where axes are turned in front of the cores, on
/// standard24's elsewhere, moved by what a bit of mantissa takes there; nothing where none was synthesised. Two cores
/// share their memories, so that an odd one needs more than half of a pair.
pub fn estimate(units: &[SetupUnit], family: Family, mantissa: u8, cores: u32) -> Option<Fabric> {
    let design = if is_turned(mantissa) {
        "lean18"
    } else {
        "standard24"
    };
    let [few, many] = FITTED_CORES;
    let with = |cores| find(units, family, design, cores);
    let (one, more) = (with(few)?, with(many)?);
    let shorter = find(units, family, SHORTER, few).filter(|_| !is_turned(mantissa));
    let odd = odd_kbit(units, family)?;
    let of = |resource: fn(&Fabric) -> u64| {
        let slope = |a: &SetupUnit, b: &SetupUnit, distance: u32| {
            (resource(&b.fabric) as f64 - resource(&a.fabric) as f64) / f64::from(distance)
        };
        let core = slope(one, more, many - few);
        let base = resource(&one.fabric) as f64 + core * (f64::from(cores) - f64::from(few));
        // Mantissas of turned axes differ by three bits at most.
        let bits = shorter.map_or(0.0, |shorter| {
            let bit = slope(shorter, one, (one.mantissa - shorter.mantissa).into());
            bit * (f64::from(mantissa) - f64::from(one.mantissa))
        });
        (base + bits).round() as u64
    };
    Some(Fabric {
        luts: of(|fabric| fabric.luts),
        flip_flops: of(|fabric| fabric.flip_flops),
        dsps: of(|fabric| fabric.dsps),
        memory_kbit: {
            // The line of pairs, which starts at half of one.
            let half = one.fabric.memory_kbit as f64 - odd;
            let pairs = more.fabric.memory_kbit as f64;
            let core = (pairs - half) / f64::from(many - few);
            let even = half + core * (f64::from(cores) - f64::from(few));
            (even + odd * f64::from(cores % 2)).round() as u64
        },
    })
}

fn find<'a>(
    units: &'a [SetupUnit],
    family: Family,
    design: &str,
    cores: u32,
) -> Option<&'a SetupUnit> {
    let same =
        |unit: &&SetupUnit| unit.family == family && unit.design == design && unit.cores == cores;
    units.iter().find(same)
}

/// What an odd core's memories have more than half of a pair's: lean18's with one core, two, and four.
fn odd_kbit(units: &[SetupUnit], family: Family) -> Option<f64> {
    let with = |cores| find(units, family, "lean18", cores);
    let of = |cores| with(cores).map(|unit| unit.fabric.memory_kbit as f64);
    let (one, two, four) = (of(1)?, of(2)?, of(4)?);
    Some(one - (two - (four - two) / 2.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use splatline::format::{Lean18, Standard24, Traversal};

    #[test]
    fn the_table_is_whole_and_of_todays_widths() {
        let units = synthesised();
        assert_eq!(to_csv(&units), CSV);
        for (name, widths) in [
            ("lean18", Lean18::WIDTHS),
            ("standard24", Standard24::WIDTHS),
        ] {
            for cores in FITTED_CORES {
                let same = |unit: &&SetupUnit| unit.design == name && unit.cores == cores;
                let unit = units.iter().find(same).unwrap();
                let own = [unit.position, unit.mantissa];
                let todays = [widths.position, widths.mantissa];
                assert_eq!(own, todays, "{name}: synthesise it anew");
                assert_eq!(Some(unit.round), round(&units, &widths), "{name}");
            }
        }
        assert!(lines_of::<SetupUnit>("design,widths\nlean18,30\n").is_err());
    }

    /// A unit that takes a splat in a ninth of a round is one of nine cores; what has no circuit is counted.
    #[test]
    fn a_machines_setup_is_the_circuit_where_there_is_one() {
        let units = synthesised();
        let prices = Family::Ecp5.calibration();
        let machine = Config::machine(4);
        let widths = Lean18::WIDTHS;
        let nine = estimate(&units, Family::Ecp5, widths.mantissa, 9);
        assert_eq!(of_machine(&widths, &machine, &prices), nine);
        let [fast, eight] = [7, 8].map(|setup_interval| Config {
            setup_units: 1,
            setup_interval,
            ..machine
        });
        let around = |config: &Config| {
            crate::area::estimate(&widths, Traversal::Spans, config, &prices)
                .around
                .luts
        };
        assert_eq!(of_machine(&widths, &fast, &prices), None);
        assert!(of_machine(&widths, &eight, &prices).is_some());
        let ice40 = Family::Ice40.calibration();
        assert_eq!(of_machine(&widths, &machine, &ice40), None);
        let seventeen = estimate(&units, Family::Ecp5, widths.mantissa, 17);
        let [nine, seventeen] = [nine, seventeen].map(|unit| unit.unwrap().luts);
        assert_eq!(around(&eight) - around(&machine), seventeen - nine);
    }

    #[test]
    fn estimates_are_within_a_twentieth_of_synthesis() {
        let units = synthesised();
        let fitted = |unit: &SetupUnit| match unit.design.as_str() {
            "lean18" | "standard24" => FITTED_CORES.contains(&unit.cores),
            design => (design, unit.cores) == (SHORTER, FITTED_CORES[0]),
        };
        assert!(!units.iter().all(fitted), "nothing is unseen");
        for unit in &units {
            let estimate = estimate(&units, unit.family, unit.mantissa, unit.cores).unwrap();
            let error = estimate.worst_error(&unit.fabric);
            assert!(error < 0.05, "{unit:?}: {estimate}, {error}");
        }
    }
}
