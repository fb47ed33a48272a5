//! Cost of area: operators counted per unit from the widths, priced by a replaceable calibration.
//!
//! The counts are those of the kernel's formulas (each multiplication written in `src/setup`, `src/raster`, `src/kernel` and `src/blend` is
//! one multiplier, unless an initiation interval lets it be shared); the prices are those of an FPGA by default. It is an
//! estimate for ranking designs before synthesis: control, routing and pipeline registers are one factor. Energy is not
//! estimated: no source for it fits all of these units. See `docs/hardware-model.md`, section 5.

use super::config::{Config, Layout, Termination};
use serde::{Deserialize, Serialize};
use splatline::format::{Traversal, Widths};
use std::collections::BTreeMap;

/// Prices. The defaults are those of a 7-series FPGA.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Calibration {
    /// What these prices are for and where they come from.
    pub source: String,
    /// LUTs per bit of an adder or comparator.
    pub lut_per_adder_bit: f64,
    /// LUTs per bit and stage of a shifter (each stage shifts by 0 to 3 places).
    pub lut_per_shifter_bit: f64,
    /// Operands of a hardware multiplier, unsigned bits.
    pub multiplier_bits: [u32; 2],
    /// Bits of a block memory.
    pub block_bits: u64,
    /// Memories of at most this many bits are made of LUTs.
    pub lut_memory_limit: u64,
    /// Bits of memory in a LUT.
    pub lut_memory_bits: f64,
    /// Factor on all LUTs for control and what the count leaves out.
    pub lut_overhead: f64,
    /// LUTs that weigh as much as a multiplier and as a block memory, for one number.
    pub luts_per_multiplier: f64,
    /// See `luts_per_multiplier`.
    pub luts_per_block: f64,
}

impl Default for Calibration {
    fn default() -> Self {
        Calibration {
            source: "AMD 7 series: one LUT per carry-chain bit and RAM64X1 (UG474), 25x18 signed multiplier of the DSP48E1 (UG479), \
                     18 Kbit block memory (UG473); weights are the ratios in an XC7A100T, 63400 LUTs : 240 DSP : 270 RAMB18 (DS180); \
                     the overhead of 1.3 is assumed, not measured"
                .to_owned(),
            lut_per_adder_bit: 1.0,
            lut_per_shifter_bit: 1.0,
            multiplier_bits: [24, 17],
            block_bits: 18_432,
            lut_memory_limit: 2_048,
            lut_memory_bits: 64.0,
            lut_overhead: 1.3,
            luts_per_multiplier: 264.0,
            luts_per_block: 235.0,
        }
    }
}

impl Calibration {
    /// Reads a calibration from the text of a TOML file; what it leaves out keeps its default.
    pub fn from_toml(file: &str, text: &str) -> Result<Calibration, String> {
        toml::from_str(text).map_err(|error| format!("{file}: {error}"))
    }
}

/// Operators of one unit.
#[derive(Clone, Debug, Default, PartialEq)]
struct Operators {
    adder_bits: u64,
    /// Widths of shifters that shift by any number of places.
    shifters: Vec<u64>,
    /// Operand widths of multipliers.
    multipliers: Vec<[u64; 2]>,
    /// Bits of memories, each addressed on its own.
    memories: Vec<u64>,
}

/// Resources.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Resources {
    /// Look-up tables of 6 inputs.
    pub luts: f64,
    /// Hardware multipliers.
    pub multipliers: u64,
    /// Block memories.
    pub blocks: u64,
    /// One number: all of it in LUTs.
    pub area: f64,
}

/// Resources by unit, over all instances, and their sum.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Area {
    /// By unit.
    pub units: BTreeMap<&'static str, Resources>,
    /// All units.
    pub total: Resources,
}

/// Estimates a machine that carries a design.
pub fn estimate(
    widths: &Widths,
    traversal: Traversal,
    config: &Config,
    calibration: &Calibration,
) -> Area {
    let bits = Bits::new(widths);
    let rasters = u64::from(config.raster_units);
    let lanes = rasters * u64::from(config.lanes);
    let generators = rasters * u64::from(config.rows_at_once);
    let mut area = Area::default();
    let mut add = |name, count: u64, operators: Operators| {
        let one = operators.price(calibration);
        let scale = |amount: u64| amount * count;
        let luts = one.luts * count as f64;
        let resources = Resources {
            luts,
            multipliers: scale(one.multipliers),
            blocks: scale(one.blocks),
            area: one.area * count as f64,
        };
        area.units.insert(name, resources);
        area.total = area.total.plus(&resources);
    };
    add(
        "setup",
        config.setup_units.into(),
        bits.setup(config.setup_interval),
    );
    add(
        "splat_setup",
        rasters,
        bits.splat_setup(traversal, config.splat_cycles),
    );
    add(
        "row_generator",
        generators,
        bits.row_generator(traversal, config.row_cycles),
    );
    add("lanes", lanes, bits.lane(config));
    add("table", rasters, bits.table(config));
    add("blend", lanes, bits.blend(config.blend_interval));
    add("tile_buffer", rasters, bits.tile_buffer(config));
    add("fifos", rasters, bits.fifos(config));
    area
}

impl Resources {
    fn plus(&self, other: &Resources) -> Resources {
        Resources {
            luts: self.luts + other.luts,
            multipliers: self.multipliers + other.multipliers,
            blocks: self.blocks + other.blocks,
            area: self.area + other.area,
        }
    }
}

impl Operators {
    fn price(&self, prices: &Calibration) -> Resources {
        let stages = |width: u64| f64::from(width.max(2).ilog2().div_ceil(2));
        let shifting: f64 = self
            .shifters
            .iter()
            .map(|width| *width as f64 * stages(*width))
            .sum();
        let (small, large): (Vec<u64>, Vec<u64>) = self
            .memories
            .iter()
            .partition(|bits| **bits <= prices.lut_memory_limit);
        let memory_luts = small.iter().sum::<u64>() as f64 / prices.lut_memory_bits;
        let logic = self.adder_bits as f64 * prices.lut_per_adder_bit
            + shifting * prices.lut_per_shifter_bit
            + memory_luts;
        let luts = logic * prices.lut_overhead;
        let multipliers = self
            .multipliers
            .iter()
            .map(|operands| tiles(*operands, prices.multiplier_bits))
            .sum();
        let blocks = large
            .iter()
            .map(|bits| bits.div_ceil(prices.block_bits.max(1)))
            .sum();
        let area = luts
            + multipliers as f64 * prices.luts_per_multiplier
            + blocks as f64 * prices.luts_per_block;
        Resources {
            luts,
            multipliers,
            blocks,
            area,
        }
    }
}

/// Hardware multipliers that a product takes, laid out the better way round.
fn tiles([a, b]: [u64; 2], [wide, narrow]: [u32; 2]) -> u64 {
    let cover = |a: u64, b: u64| a.div_ceil(wide.max(1).into()) * b.div_ceil(narrow.max(1).into());
    cover(a, b).min(cover(b, a))
}

/// The design's widths as numbers to count with.
struct Bits {
    view: u64,
    mantissa: u64,
    subpixel: u64,
    radial: u64,
    table: u64,
    interpolation: u64,
    weight: u64,
    peak: u64,
    alpha: u64,
    transmittance: u64,
    colour: u64,
    accumulator: u64,
    packet: u64,
}

impl Bits {
    fn new(widths: &Widths) -> Bits {
        let [
            view,
            mantissa,
            subpixel,
            radial,
            table,
            interpolation,
            weight,
            peak,
            alpha,
            transmittance,
            colour,
            accumulator,
        ] = widths.numbers().map(u64::from);
        let packet = splatline::footprint::packet::Layout::new(widths).bits() as u64;
        Bits {
            view,
            mantissa,
            subpixel,
            radial,
            table,
            interpolation,
            weight,
            peak,
            alpha,
            transmittance,
            colour: colour + 4,
            accumulator: accumulator + 4,
            packet,
        }
    }

    /// Multipliers that a unit with this initiation interval needs for `count` products.
    fn shared(operands: [u64; 2], count: u64, interval: u32) -> Vec<[u64; 2]> {
        vec![operands; count.div_ceil(u64::from(interval.max(1))) as usize]
    }

    /// Projection (9 products of position and rotation, 4 of ratios and focal length), columns of J W S (27 + 12), variance (15), LDL
    /// and conic (10), peak and cut-off (4), reciprocals and roots by table and one or two products (8).
    fn setup(&self, interval: u32) -> Operators {
        let (v, m) = (self.view, self.mantissa);
        let mut multipliers = Self::shared([v, 32], 9, interval);
        multipliers.extend(Self::shared([v, v], 4, interval));
        multipliers.extend(Self::shared([v, m], 27, interval));
        multipliers.extend(Self::shared([m, m], 12 + 15 + 10 + 4 + 8, interval));
        Operators {
            adder_bits: 60 * (m + 2) + 9 * (v + 32),
            shifters: vec![m; 40],
            multipliers,
            memories: vec![2 * 256 * m.min(18)],
        }
    }

    /// Start values of the rows: both traversals align their coefficients once per pair.
    fn splat_setup(&self, traversal: Traversal, interval: u32) -> Operators {
        let m = self.mantissa;
        let (products, adder_bits, shifts) = match traversal {
            Traversal::Spans => (3, 3 * 64, 6),
            Traversal::Box => (7, 6 * 63, 9),
        };
        Operators {
            adder_bits,
            shifters: vec![64; shifts],
            multipliers: Self::shared([m, m], products, interval),
            memories: vec![],
        }
    }

    /// `spans`: centre, vertical and its difference; half-width by the root table and a product; two products for the seed. `box`: additions.
    fn row_generator(&self, traversal: Traversal, interval: u32) -> Operators {
        let m = self.mantissa;
        match traversal {
            Traversal::Box => Operators {
                adder_bits: 4 * 63,
                ..Operators::default()
            },
            Traversal::Spans => {
                let mut multipliers = Self::shared([m, m], 2, interval);
                multipliers.extend(Self::shared([m, 28], 1, interval));
                let adder_bits = 3 * 64 + 4 * (27 + self.subpixel);
                Operators {
                    adder_bits,
                    shifters: vec![64, m + 32, m + 32],
                    multipliers,
                    memories: vec![256 * 16],
                }
            }
        }
    }

    /// Two additions and a comparison per pixel; a mask and its priority encoder where finished groups are skipped.
    fn lane(&self, config: &Config) -> Operators {
        let word = self.radial + 5;
        let mask = if config.pixel_termination == Termination::Skip {
            u64::from(config.tile_width) * 2
        } else {
            0
        };
        Operators {
            adder_bits: 3 * word + mask,
            ..Operators::default()
        }
    }

    /// A copy of the table per port, with the interpolator's product.
    fn table(&self, config: &Config) -> Operators {
        let ports = if config.table_ports == 0 {
            config.lanes
        } else {
            config.table_ports.min(config.lanes)
        } as usize;
        let multipliers = if self.interpolation > 0 {
            vec![[self.interpolation, self.weight + 1]; ports]
        } else {
            vec![]
        };
        let copy = ((1 << self.table) + 1) * self.weight;
        Operators {
            adder_bits: ports as u64 * self.weight,
            multipliers,
            memories: vec![copy; ports],
            ..Operators::default()
        }
    }

    /// Opacity, share, three colours.
    fn blend(&self, interval: u32) -> Operators {
        let mut multipliers = Self::shared([self.peak + 4, self.weight + 1], 1, interval);
        multipliers.extend(Self::shared(
            [self.transmittance + 1, self.alpha + 1],
            1,
            interval,
        ));
        multipliers.extend(Self::shared(
            [self.transmittance + 1, self.colour],
            3,
            interval,
        ));
        let adder_bits = 3 * self.accumulator + 2 * (self.transmittance + 1) + 2 * (self.alpha + 1);
        Operators {
            adder_bits,
            multipliers,
            ..Operators::default()
        }
    }

    /// Every bank of every buffer is a memory of its own.
    fn tile_buffer(&self, config: &Config) -> Operators {
        let banks = u64::from(if config.buffer_banks == 0 {
            config.lanes
        } else {
            config.buffer_banks
        });
        let pixel = 3 * self.accumulator + self.transmittance + 2;
        let pixels = u64::from(config.tile_width) * u64::from(config.tile_height);
        let memories =
            vec![pixels.div_ceil(banks) * pixel; (banks * u64::from(config.tile_buffers)) as usize];
        Operators {
            memories,
            ..Operators::default()
        }
    }

    /// Packets, splats (as wide as packets), and runs: three lane words and a place.
    fn fifos(&self, config: &Config) -> Operators {
        let run = 3 * (self.radial + 5) + 24;
        let queues = if config.layout == Layout::Rows {
            config.lanes
        } else {
            1
        };
        let mut memories = vec![run * u64::from(config.row_fifo); queues as usize];
        memories.push(self.packet * u64::from(config.packet_fifo));
        memories.push(self.packet * u64::from(config.splat_fifo));
        Operators {
            memories,
            ..Operators::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use splatline::format::{Classic8, Deep32, Lean18, Standard24};

    fn total(widths: &Widths, config: &Config) -> Resources {
        estimate(widths, Traversal::Spans, config, &Calibration::default()).total
    }

    #[test]
    fn designs_are_ranked_by_their_widths() {
        let areas = [
            Classic8::WIDTHS,
            Lean18::WIDTHS,
            Standard24::WIDTHS,
            Deep32::WIDTHS,
        ]
        .map(|w| total(&w, &Config::default()).area);
        assert!(areas.is_sorted() && areas[3] > 1.5 * areas[0], "{areas:?}");
    }

    #[test]
    fn more_of_anything_is_never_smaller() {
        let base = total(&Standard24::WIDTHS, &Config::default());
        for words in [
            "lanes=2",
            "raster_units=2",
            "rows_at_once=4",
            "row_fifo=64",
            "tile_width=64",
            "setup_units=2",
            "pixel_termination=skip",
        ] {
            let mut config = Config::default();
            config.set_words(&[words.to_owned()]).unwrap();
            assert!(
                total(&Standard24::WIDTHS, &config).area > base.area,
                "{words}"
            );
        }
    }

    #[test]
    fn products_are_tiled_the_better_way_round() {
        assert_eq!(tiles([17, 24], [24, 17]), 1);
        assert_eq!(tiles([18, 25], [24, 17]), 2);
        assert_eq!(tiles([25, 25], [24, 17]), 4);
        assert_eq!(tiles([34, 20], [24, 17]), 2);
        assert!(
            Calibration::from_toml("c.toml", "lut_overhed = 1.0")
                .unwrap_err()
                .contains("c.toml")
        );
    }
}
