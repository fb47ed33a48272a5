//! What one action takes: picojoules by kind and width, from a TOML that names node and source of every entry.
//!
//! The literature gives two or three widths of each kind. What lies between them is a power of the width, the one that
//! goes through both neighbours: adders grow about linearly, multipliers with the product of their operands, memories
//! with the root of their capacity, and the figures that ship have just these slopes.

use super::super::area::lane::transistors;
use crate::input::line_at;
use serde::{Deserialize, Serialize};
use toml::Spanned;

/// The table that ships: 45 nm figures.
pub const SHIPPED: &str = include_str!("45nm.toml");

/// Largest energy of an entry, pJ: no action of a chip takes a microjoule, and sums stay whole numbers.
const MOST_PJ: f64 = 1e6;
/// Largest factor for another node.
const MOST_SCALE: f64 = 100.0;
/// Attojoules of a picojoule.
const ATTO: f64 = 1e6;

/// Energies by kind and width.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EnergyTable {
    /// Process and voltage.
    pub node: String,
    scale: f64,
    adder: PriceCurve,
    multiplier: PriceCurve,
    float_adder: PriceCurve,
    float_multiplier: PriceCurve,
    memory: PriceCurve,
    dram_bit: f64,
    shipped: bool,
}

/// Picojoules over a width, by increasing width; at least one point.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct PriceCurve {
    points: Vec<[f64; 2]>,
    /// Slope in logarithms where there is one point only.
    alone: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct EnergyFile {
    node: String,
    scale: Option<Spanned<f64>>,
    adder: Vec<EnergyEntry>,
    multiplier: Vec<EnergyEntry>,
    memory: Vec<MemoryEntry>,
    float_adder: Vec<EnergyEntry>,
    float_multiplier: Vec<EnergyEntry>,
    dram: EnergyEntry,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct EnergyEntry {
    bits: Spanned<i64>,
    pj: Spanned<f64>,
    source: Spanned<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MemoryEntry {
    bytes: Spanned<i64>,
    bits: Spanned<i64>,
    pj: Spanned<f64>,
    source: Spanned<String>,
}

impl Default for EnergyTable {
    fn default() -> Self {
        let table = EnergyTable::from_toml("45nm.toml", SHIPPED);
        table.expect("the table that ships is one, which a test says")
    }
}

impl EnergyTable {
    /// Reads a table; `file` is its name for messages, which name line, key and what is allowed.
    pub fn from_toml(file: &str, text: &str) -> Result<EnergyTable, String> {
        let parsed: EnergyFile =
            toml::from_str(text).map_err(|error| format!("{file}: {error}"))?;
        let check = EnergyCheck { file, text };
        let scale = match &parsed.scale {
            None => 1.0,
            Some(scale) => check.positive("scale", scale, MOST_SCALE)?,
        };
        let widths = |kind, entries: &[EnergyEntry], alone| {
            let point = |entry: &EnergyEntry| {
                check.source(kind, &entry.source)?;
                let bits = check.whole(&format!("{kind}.bits"), &entry.bits, 1, 4096)?;
                let pj = check.positive(&format!("{kind}.pj"), &entry.pj, MOST_PJ)?;
                Ok(([bits, pj], entry.bits.span().start))
            };
            check.curve(kind, entries.iter().map(point), alone)
        };
        let memory = |entry: &MemoryEntry| {
            check.source("memory", &entry.source)?;
            let bytes = check.whole("memory.bytes", &entry.bytes, 1, 1 << 40)?;
            let bits = check.whole("memory.bits", &entry.bits, 1, 4096)?;
            let pj = check.positive("memory.pj", &entry.pj, MOST_PJ)?;
            Ok(([bytes, pj / bits], entry.bytes.span().start))
        };
        check.source("dram", &parsed.dram.source)?;
        let dram_bits = check.whole("dram.bits", &parsed.dram.bits, 1, 4096)?;
        let dram_pj = check.positive("dram.pj", &parsed.dram.pj, MOST_PJ)?;
        let squared = |mut curve: PriceCurve| {
            curve.points.iter_mut().for_each(|[bits, _]| *bits *= *bits);
            curve
        };
        Ok(EnergyTable {
            node: parsed.node,
            scale,
            adder: widths("adder", &parsed.adder, 1.0)?,
            multiplier: squared(widths("multiplier", &parsed.multiplier, 1.0)?),
            float_adder: widths("float_adder", &parsed.float_adder, 1.0)?,
            float_multiplier: squared(widths("float_multiplier", &parsed.float_multiplier, 1.0)?),
            memory: check.curve("memory", parsed.memory.iter().map(memory), 0.5)?,
            dram_bit: dram_pj / dram_bits,
            shipped: text == SHIPPED,
        })
    }

    /// Attojoules of an addition, subtraction or comparison of integers.
    pub fn adder(&self, bits: u64) -> u64 {
        whole(self.scale * self.adder.at(bits as f64))
    }

    /// Of a product of integers.
    pub fn multiplier(&self, [a, b]: [u64; 2]) -> u64 {
        whole(self.scale * self.multiplier.at((a * b) as f64))
    }

    /// Of a floating-point addition or comparison.
    pub fn float_adder(&self, bits: u64) -> u64 {
        whole(self.scale * self.float_adder.at(bits as f64))
    }

    /// Of a floating-point product.
    pub fn float_multiplier(&self, bits: u64) -> u64 {
        whole(self.scale * self.float_multiplier.at((bits * bits) as f64))
    }

    /// Of a sum and a product in a format by its name: half and single precision as the table has them, others as half
    /// precision by their units' transistors.
    pub fn float_operations(&self, format: &str) -> [u64; 2] {
        let bits = if format == "fp32" { 32 } else { 16 };
        let published = [self.float_adder(bits), self.float_multiplier(bits)];
        if ["fp32", "fp16"].contains(&format) {
            return published;
        }
        let (own, half) = (transistors(format), transistors("fp16"));
        let share = |which: usize| own[which] as f64 / half[which].max(1) as f64;
        [0, 1].map(|which| (published[which] as f64 * share(which)).round() as u64)
    }

    /// Of reading or writing a word of a memory of so many bytes.
    pub fn memory(&self, bytes: u64, bits: u64) -> u64 {
        whole(self.scale * self.memory.at(bytes as f64) * bits as f64)
    }

    /// Of a byte over the memory interface.
    pub fn dram_byte(&self) -> u64 {
        whole(self.dram_bit * 8.0)
    }

    /// What a reader of an estimate must know.
    pub fn statement(&self) -> String {
        let source = if self.shipped {
            "figures of the literature"
        } else {
            "a table of your own"
        };
        format!(
            "estimate by {source} for {}: actions counted times energy each; without clock tree, pipeline registers, control, wires, leakage, and what a DRAM \
             takes when idle (docs/hardware-model.md)",
            self.node
        )
    }
}

/// Attojoules as a whole number, so that sums are exact in any order.
fn whole(pj: f64) -> u64 {
    (pj * ATTO).round() as u64
}

impl PriceCurve {
    /// The value at a width: on the power that goes through the two points around it, or nearest to it.
    fn at(&self, x: f64) -> f64 {
        let x = x.max(1.0);
        let after = self.points.partition_point(|[at, _]| *at < x);
        let last = self.points.len() - 1;
        let high = after.clamp(1, last.max(1)).min(last);
        let [x0, y0] = self.points[high.saturating_sub(1)];
        let [x1, y1] = self.points[high];
        let slope = if x1 > x0 {
            (y1 / y0).ln() / (x1 / x0).ln()
        } else {
            self.alone
        };
        y0 * (x / x0).powf(slope)
    }
}

/// Checks values and names file and line of those that are refused.
struct EnergyCheck<'a> {
    file: &'a str,
    text: &'a str,
}

impl EnergyCheck<'_> {
    fn refused<T>(&self, at: usize, what: &str, allowed: &str) -> Result<T, String> {
        let (file, line) = (self.file, line_at(self.text, at));
        Err(format!("{file}:{line}: {what}: {allowed}"))
    }

    fn positive(&self, key: &str, value: &Spanned<f64>, most: f64) -> Result<f64, String> {
        let number = *value.as_ref();
        if number.is_finite() && number > 0.0 && number <= most {
            return Ok(number);
        }
        let allowed = format!("allowed are numbers above 0 up to {most}");
        self.refused(value.span().start, &format!("{key} = {number}"), &allowed)
    }

    fn whole(&self, key: &str, value: &Spanned<i64>, low: i64, high: i64) -> Result<f64, String> {
        let number = *value.as_ref();
        if (low..=high).contains(&number) {
            return Ok(number as f64);
        }
        let allowed = format!("allowed are {low} to {high}");
        self.refused(value.span().start, &format!("{key} = {number}"), &allowed)
    }

    fn source(&self, kind: &str, source: &Spanned<String>) -> Result<(), String> {
        if !source.as_ref().trim().is_empty() {
            return Ok(());
        }
        let allowed = "name the paper or the data sheet that the energy is from";
        let what = format!("{kind}.source is empty");
        self.refused(source.span().start, &what, allowed)
    }

    fn curve(
        &self,
        kind: &str,
        points: impl Iterator<Item = Result<([f64; 2], usize), String>>,
        alone: f64,
    ) -> Result<PriceCurve, String> {
        let mut curve = PriceCurve {
            points: Vec::new(),
            alone,
        };
        for point in points {
            let (point, at) = point?;
            if curve.points.last().is_some_and(|last| last[0] >= point[0]) {
                let what = format!("{kind}: {} is not above the entry before", point[0]);
                return self.refused(at, &what, "entries of a kind come by increasing width");
            }
            curve.points.push(point);
        }
        if curve.points.is_empty() {
            let file = self.file;
            return Err(format!(
                "{file}: {kind} has no entry: at least one is needed"
            ));
        }
        Ok(curve)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::{says, with_line};

    #[test]
    fn the_table_that_ships_gives_its_entries_and_follows_them_between() {
        let table = EnergyTable::default();
        assert_eq!([table.adder(8), table.adder(32)], [30_000, 100_000]);
        let products = [8, 32].map(|bits| table.multiplier([bits; 2]));
        assert_eq!(products, [200_000, 3_100_000]);
        assert_eq!(table.memory(8192, 64), 10_000_000);
        assert_eq!(table.memory(1 << 20, 32), 50_000_000);
        assert_eq!(table.dram_byte(), 243_750_000);
        // Sixteen times the area of a product, 15.5 times its energy; a quarter of a memory, half the energy.
        let ratio = table.multiplier([16, 16]) as f64 / table.multiplier([8, 8]) as f64;
        assert!((ratio - 15.5f64.sqrt()).abs() < 1e-3, "{ratio}");
        assert_eq!(table.memory(2048, 64), 5_000_000);
        assert_eq!(table.multiplier([4, 16]), table.multiplier([8, 8]));
    }

    /// Every number of the file, one after the other: outside its range it is refused by line, key and what is allowed;
    /// every entry has a source.
    #[test]
    fn every_number_has_a_range_and_every_entry_a_source() {
        let (mut numbers, mut sources, mut entries) = (0, 0, 0);
        for (index, line) in SHIPPED.lines().enumerate() {
            entries += usize::from(line.starts_with('['));
            let Some((key, value)) = line.split_once(" = ").filter(|_| !line.starts_with('#'))
            else {
                continue;
            };
            let wrong: &[&str] = match key {
                "source" => &["\"\"", "\" \""],
                "bits" | "bytes" => &["0", "-1", "2000000000000"],
                "node" => continue,
                _ => &["0", "-1", "-0.1", "nan", "inf", "1e9"],
            };
            for wrong in wrong {
                let text = with_line(SHIPPED, index, &format!("{key} = {wrong}"));
                let printed = EnergyTable::from_toml("mine.toml", &text).unwrap_err();
                let place = format!("mine.toml:{}: ", index + 1);
                assert!(printed.starts_with(&place), "{printed}");
                let mut words = ["allowed", "name the paper"].into_iter();
                assert!(words.any(|words| printed.contains(words)), "{printed}");
                says(&printed, &[key]);
            }
            numbers += usize::from(value.parse::<f64>().is_ok());
            sources += usize::from(key == "source");
        }
        assert!(numbers > 20, "{numbers}");
        assert_eq!(sources, entries);
    }

    /// Published where it is, else by area.
    #[test]
    fn formats_of_less_area_take_less() {
        let table = EnergyTable::default();
        assert_eq!(table.float_operations("fp16"), [400_000, 1_100_000]);
        assert_eq!(table.float_operations("fp32"), [900_000, 3_700_000]);
        let names = ["fp32", "fp16", "bfloat16", "e4m3"];
        let products = names.map(|name| table.float_operations(name)[1]);
        assert!(products.is_sorted_by(|a, b| a > b), "{products:?}");
    }

    #[test]
    fn wider_is_never_cheaper() {
        let table = EnergyTable::default();
        for bits in 1..128 {
            assert!(table.adder(bits) < table.adder(bits + 1));
            assert!(table.multiplier([bits, 18]) < table.multiplier([bits + 1, 18]));
            assert!(table.memory(64 * bits, 8) < table.memory(64 * bits + 64, 8));
        }
    }

    #[test]
    fn a_scale_is_of_the_chip_and_not_of_its_dram() {
        let text = SHIPPED.replace("scale = 1.0", "scale = 0.5");
        let half = EnergyTable::from_toml("h.toml", &text).unwrap();
        assert_eq!(half.adder(32), 50_000);
        assert_eq!(half.dram_byte(), EnergyTable::default().dram_byte());
        assert!(half.statement().contains("table of your own"));
    }

    /// Whatever is wrong, the message names file, line and key.
    #[test]
    fn what_no_chip_takes_is_refused_by_name_and_line() {
        let source = "source = \"Horowitz 2014, figure 1.1.9\"";
        let bits = ["bits = 8\npj = 0.2", "bits = 0\npj = 0.2"];
        let of_bits = "25: multiplier.bits = 0: allowed are 1 to 4096";
        let order = ["bytes = 32768", "bytes = 8192"];
        for ([from, to], expected) in [
            (bits, of_bits),
            (order, "memory: 8192 is not above"),
            ([source, "source = \" \""], "17: adder.source is empty"),
            (["[dram]", "[drum]"], "drum"),
            ([SHIPPED, "node = \"x\"\n"], "missing field"),
        ] {
            assert!(SHIPPED.contains(from));
            let text = SHIPPED.replacen(from, to, 1);
            let message = EnergyTable::from_toml("mine.toml", &text).unwrap_err();
            assert!(message.starts_with("mine.toml:"), "{message}");
            says(&message, &[expected]);
        }
    }
}
