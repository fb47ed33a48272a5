//! Prices of a family of FPGAs: what its blocks hold, from its data sheets, and straight lines through what synthesis
//! found.
//!
//! Look-up tables and flip-flops grow with the mantissa (setup, rows) or with the bits of a lane. The lines go through
//! lean18 and standard24 with one and four lanes: two widths, so they meet both, and only what was *not* fitted says
//! how good they are ([`super::synthesis`]). A TOML file may replace any of it, for another device or a chip:
//! `family = "ecp5"` names the prices that it starts from.

use super::Fabric;
use super::circuit::Bits;
use super::synthesis::{Synthesised, SynthesisedPart, synthesised};
use crate::primitive::Intervals;
use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize};
use std::collections::BTreeMap;
use std::sync::LazyLock;

/// A family of devices.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Family {
    /// Xilinx 7 series: LUT6, signed 25 x 18 multipliers (UG479), 18 kbit memories (UG473).
    #[default]
    Xilinx7,
    /// Lattice ECP5: LUT4, signed or unsigned 18-bit multipliers, 18 kbit memories (FPGA-DS-02012).
    Ecp5,
    /// Lattice iCE40: LUT4, signed or unsigned 16-bit multipliers (UltraPlus), 4 kbit memories (FPGA-DS-02008).
    Ice40,
}

/// `at_zero + per_bit * bits`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PriceLine {
    /// Without any bits.
    pub at_zero: f64,
    /// And for each of them.
    pub per_bit: f64,
}

/// Look-up tables or flip-flops: lines for setup and rows over the mantissa's bits, for a lane over its own bits, and
/// what is left.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Lines {
    /// Splat setup of a packet in every cycle.
    pub setup: PriceLine,
    /// Splat setup of a packet in four cycles, whose shifters and multipliers are shared.
    pub shared_setup: PriceLine,
    /// Of a packet in eight cycles.
    pub small_setup: PriceLine,
    /// Row generator.
    pub rows: PriceLine,
    /// That of a row in two cycles.
    pub small_rows: PriceLine,
    /// One lane with its queue of eight runs.
    pub lane: PriceLine,
    /// A bit that a lane multiplies by additions.
    pub added: f64,
    /// Packets, scan and state.
    pub rest: f64,
}

/// A memory made of look-up tables.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LutMemory {
    /// Words.
    pub words: u64,
    /// Bits of a word.
    pub bits: u64,
    /// Look-up tables that it takes.
    pub luts: u64,
}

/// All prices.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Calibration {
    /// Whose prices they are, or which they started from.
    pub family: Family,
    /// Look-up tables.
    pub luts: Lines,
    /// Flip-flops.
    pub flip_flops: Lines,
    /// Factors of a multiplier, unsigned bits.
    pub multiplier: [u64; 2],
    /// Words and bits of a block memory's shapes, from the widest on.
    pub shapes: Vec<[u64; 2]>,
    /// Kilobits of a block.
    pub block_kbit: u64,
    /// Kilobits of splat setup: what waits for a stage, and splats that wait for the rows.
    pub setup_kbit: PriceLine,
    /// Kilobits of a row generator: the root table, what waits for a stage, and rows that wait for lanes.
    pub row_kbit: PriceLine,
    /// What queues are made of, if not of blocks.
    pub lut_memory: Option<LutMemory>,
    /// Look-up tables that weigh as much as a multiplier, for one number: their ratio in a device.
    pub luts_per_dsp: f64,
    /// And as much as a kilobit of block memory.
    pub luts_per_kbit: f64,
}

/// What data sheets say: everything that is not fitted.
#[derive(Clone, Deserialize)]
struct SynthesisSheet {
    multiplier: [u64; 2],
    shapes: Vec<[u64; 2]>,
    block_kbit: u64,
    lut_memory: Option<LutMemory>,
    /// Look-up tables and flip-flops of a bit that a lane multiplies by additions.
    added: [f64; 2],
    /// Look-up tables, multipliers and kilobits of the device whose ratios are the weights.
    device: [f64; 3],
    clock: ClockFactor,
}

/// The clock of a family beside that of the ECP5 with the same circuit.
#[derive(Clone, Debug, Deserialize)]
pub struct ClockFactor {
    /// Which part of the ECP5's.
    pub of_ecp5: f64,
    /// Where that is from.
    pub source: String,
}

static SHEETS: LazyLock<BTreeMap<Family, SynthesisSheet>> =
    LazyLock::new(|| toml::from_str(include_str!("families.toml")).expect("a sheet a family"));

impl Family {
    /// All of them.
    pub const ALL: [Family; 3] = [Family::Xilinx7, Family::Ecp5, Family::Ice40];

    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Family::Ice40 => "iCE40",
            Family::Ecp5 => "ECP5",
            Family::Xilinx7 => "Xilinx 7",
        }
    }

    /// The family as options and files call it.
    pub fn by_key(key: &str) -> Option<Family> {
        let value = toml::Value::String(key.to_owned());
        value.try_into().ok()
    }

    /// The family of a name, of tables that have it so.
    pub(super) fn by_name<'de, D: Deserializer<'de>>(from: D) -> Result<Family, D::Error> {
        let name = String::deserialize(from)?;
        let named = Family::ALL.into_iter().find(|family| family.name() == name);
        named.ok_or_else(|| D::Error::custom("no family has this name"))
    }

    fn sheet(self) -> &'static SynthesisSheet {
        &SHEETS[&self]
    }

    /// What its clock is beside the ECP5's.
    pub fn clock_factor(self) -> &'static ClockFactor {
        &self.sheet().clock
    }

    /// Prices calibrated on the synthesis of today's circuits.
    pub fn calibration(self) -> Calibration {
        Calibration::fitted(self, &synthesised())
    }
}

impl Default for Calibration {
    fn default() -> Self {
        Family::default().calibration()
    }
}

impl Calibration {
    /// Prices calibrated on these circuits, of which a family's own with one and four lanes of two designs are used.
    pub fn fitted(family: Family, circuits: &[Synthesised]) -> Calibration {
        let sheet = family.sheet();
        let fitted = |line: &&Synthesised| line.family == family && line.fitted();
        let found: Vec<Synthesised> = circuits.iter().filter(fitted).cloned().collect();
        Calibration {
            family,
            luts: lines(&found, |fabric| fabric.luts, sheet.added[0]),
            flip_flops: lines(&found, |fabric| fabric.flip_flops, sheet.added[1]),
            multiplier: sheet.multiplier,
            shapes: sheet.shapes.clone(),
            block_kbit: sheet.block_kbit,
            setup_kbit: over_mantissa(&found, SHARED_SETUP, |fabric| fabric.memory_kbit),
            row_kbit: over_mantissa(&found, ROWS, |fabric| fabric.memory_kbit),
            lut_memory: sheet.lut_memory,
            luts_per_dsp: sheet.device[0] / sheet.device[1],
            luts_per_kbit: sheet.device[0] / sheet.device[2],
        }
    }

    /// Reads prices from the text of a TOML file; what it leaves out is that of its `family`.
    pub fn from_toml(file: &str, text: &str) -> Result<Calibration, String> {
        #[derive(Deserialize)]
        struct Start {
            #[serde(default)]
            family: Family,
        }
        let problem = |error: toml::de::Error| format!("{file}: {error}");
        let start: Start = toml::from_str(text).map_err(problem)?;
        let changes: toml::Table = toml::from_str(text).map_err(problem)?;
        let mut prices = toml::Table::try_from(start.family.calibration())
            .map_err(|error| format!("{file}: {error}"))?;
        replace(&mut prices, changes);
        let prices: Calibration = prices.try_into().map_err(problem)?;
        let refused =
            |(key, value, allowed)| format!("{file}: {key} = {value}: allowed are {allowed}");
        prices.check().map_err(refused)?;
        Ok(prices)
    }

    /// Are these the family's own prices?
    pub fn is_own(&self) -> bool {
        *self == self.family.calibration()
    }

    /// Multipliers of splat setup where a packet comes in so many cycles: C dy and C dy^2 share theirs
    /// (`shared_multiply.sv`), S dy has its own.
    pub(super) fn setup_dsps(&self, bits: &Bits, interval: u32) -> u64 {
        let [along, shear, _] = bits.setup_products().map(|product| product.factors);
        let shared = 2u64.div_ceil(interval.max(1).into());
        self.tiles(along) * shared + self.tiles(shear)
    }

    /// A line's kilobits in whole blocks.
    pub(super) fn blocks_of(&self, line: &PriceLine, bits: u64) -> u64 {
        (line.at(bits) / self.block_kbit as f64).round() as u64 * self.block_kbit
    }

    /// One number for all of it, in look-up tables. Flip-flops stand behind the look-up tables of the same cells and
    /// weigh nothing.
    pub fn weight(&self, fabric: &Fabric) -> f64 {
        fabric.luts as f64
            + fabric.dsps as f64 * self.luts_per_dsp
            + fabric.memory_kbit as f64 * self.luts_per_kbit
    }
}

impl PriceLine {
    /// The line's value.
    pub fn at(&self, bits: u64) -> f64 {
        (self.at_zero + self.per_bit * bits as f64).max(0.0)
    }

    fn through(a: [f64; 2], b: [f64; 2]) -> PriceLine {
        let per_bit = (b[1] - a[1]) / (b[0] - a[0]);
        PriceLine {
            at_zero: a[1] - per_bit * a[0],
            per_bit,
        }
    }
}

/// Splat setup as the primitive has it.
const SHARED_SETUP: SynthesisedPart = SynthesisedPart::Setup(Intervals::USUAL.setup);
/// And rows.
const ROWS: SynthesisedPart = SynthesisedPart::Rows(Intervals::USUAL.rows);

/// What the two designs that are fitted take, over bits of theirs.
fn points(
    found: &[Synthesised],
    part: SynthesisedPart,
    bits: fn(&Bits) -> u64,
    of: fn(&Fabric) -> u64,
) -> Vec<[f64; 2]> {
    let point = |line: &Synthesised| {
        let bits = bits(&Bits::new(&line.widths)) as f64;
        [bits, of(&line.fabric) as f64]
    };
    let lines = found.iter().filter(|line| line.part == part);
    lines.map(point).collect()
}

/// The line of a part that depends on the mantissa alone.
fn over_mantissa(
    found: &[Synthesised],
    part: SynthesisedPart,
    of: fn(&Fabric) -> u64,
) -> PriceLine {
    let points = points(found, part, |bits| bits.mantissa, of);
    PriceLine::through(points[0], points[1])
}

/// Lines through the two designs that are fitted.
fn lines(found: &[Synthesised], of: fn(&Fabric) -> u64, added: f64) -> Lines {
    let mantissa = |part| points(found, part, |bits| bits.mantissa, of);
    let of_lanes = |lanes| points(found, SynthesisedPart::Lanes(lanes), |bits| bits.lane, of);
    let (setup, rows) = (mantissa(SHARED_SETUP), mantissa(ROWS));
    let (one, four) = (of_lanes(1), of_lanes(4));
    let of_lane = |(one, four): (&[f64; 2], &[f64; 2])| [one[0], (four[1] - one[1]) / 3.0];
    let lane: Vec<[f64; 2]> = one.iter().zip(&four).map(of_lane).collect();
    let left = |i: usize| one[i][1] - lane[i][1] - setup[i][1] - rows[i][1];
    let rest: Vec<f64> = (0..one.len()).map(left).collect();
    let additions = points(
        found,
        SynthesisedPart::Lanes(1),
        |bits| bits.added(false),
        of,
    );
    let without = |(lane, [bits, _]): (&[f64; 2], &[f64; 2])| [lane[0], lane[1] - added * bits];
    let lane: Vec<[f64; 2]> = lane.iter().zip(&additions).map(without).collect();
    Lines {
        setup: over_mantissa(found, SynthesisedPart::Setup(1), of),
        shared_setup: PriceLine::through(setup[0], setup[1]),
        small_setup: over_mantissa(found, SynthesisedPart::Setup(Intervals::SMALL.setup), of),
        rows: PriceLine::through(rows[0], rows[1]),
        small_rows: over_mantissa(found, SynthesisedPart::Rows(Intervals::SMALL.rows), of),
        lane: PriceLine::through(lane[0], lane[1]),
        added,
        rest: rest.iter().sum::<f64>() / rest.len().max(1) as f64,
    }
}

/// Puts changes over prices, table by table.
fn replace(prices: &mut toml::Table, changes: toml::Table) {
    for (key, value) in changes {
        match (prices.get_mut(&key), value) {
            (Some(toml::Value::Table(inner)), toml::Value::Table(changes)) => {
                replace(inner, changes);
            }
            (_, value) => {
                prices.insert(key, value);
            }
        }
    }
}
