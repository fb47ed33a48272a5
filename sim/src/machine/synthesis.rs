//! Area of the splat primitive by its widths, calibrated on synthesis: what Yosys will make of it for three families of FPGAs.
//!
//! Multipliers are counted by tiling each product with the family's multiplier, memories by its block shapes; look-up tables and
//! flip-flops grow with the mantissa (setup, rows) or with the bits of a lane. The coefficients of these straight lines are those of lean18 and
//! standard24 with one and four lanes: two widths, so the lines go through both, and only what was *not* fitted says how good they
//! are. `docs/area.md` holds every estimate against its synthesis, with 24-bit mantissas and two lanes as the points in between.

use super::primitive::QUEUE;
use splatline::format::Widths;

/// A family of devices.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// Lattice iCE40: LUT4, 16-bit multipliers (UltraPlus), 4 kbit memories.
    Ice40,
    /// Lattice ECP5: LUT4, 18-bit multipliers, 18 kbit memories.
    Ecp5,
    /// Xilinx 7 series: LUT6, 25 x 18 multipliers, 18 kbit memories.
    Xilinx7,
}

/// What a circuit takes, in the family's own units.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Fabric {
    /// Look-up tables, those used as memory and shift registers included.
    pub luts: u64,
    /// Flip-flops.
    pub flip_flops: u64,
    /// Multiplier blocks.
    pub dsps: u64,
    /// Kilobits of block memory, in whole blocks.
    pub memory_kbit: u64,
}

/// `at_zero + per_bit * bits`.
struct Line {
    at_zero: f64,
    per_bit: f64,
}

/// Look-up tables or flip-flops: lines for setup and rows over the mantissa's bits, for a lane over its own bits, and what is left.
struct Lines {
    setup: Line,
    rows: Line,
    lane: Line,
    rest: f64,
}

/// What a family is made of.
struct Prices {
    luts: Lines,
    flip_flops: Lines,
    /// Operands of a multiplier, signed bits.
    multiplier: [u64; 2],
    /// Multipliers of products whose operands do not depend on the widths: the jumps of setup, the heads of runs in the rows.
    fixed_multipliers: u64,
    /// Words and bits of a block memory's shapes, from the widest on.
    shapes: &'static [[u64; 2]],
    block_kbit: u64,
    /// Kilobits of the root table, and whether queues lie in block memories.
    root_kbit: u64,
    queues_in_blocks: bool,
}

const fn line(at_zero: f64, per_bit: f64) -> Line {
    Line { at_zero, per_bit }
}

impl Line {
    fn at(&self, bits: f64) -> f64 {
        self.at_zero + self.per_bit * bits
    }
}

impl Lines {
    fn at(&self, mantissa: f64, lane_bits: f64, lanes: f64) -> u64 {
        let shared = self.setup.at(mantissa) + self.rows.at(mantissa) + self.rest;
        (shared + lanes * self.lane.at(lane_bits)).round() as u64
    }
}

/// Shapes of an 18 kbit memory.
const SHAPES_18K: [[u64; 2]; 5] = [[512, 36], [1024, 18], [2048, 9], [4096, 4], [8192, 2]];

/// Shapes of a 4 kbit memory.
const SHAPES_4K: [[u64; 2]; 4] = [[256, 16], [512, 8], [1024, 4], [2048, 2]];

const XILINX_7: Prices = Prices {
    luts: Lines {
        setup: line(2971.6, 153.8),
        rows: line(2490.2, 63.1),
        lane: line(305.3, 5.407),
        rest: 25.0,
    },
    flip_flops: Lines {
        setup: line(907.2, 23.6),
        rows: line(1184.0, 15.5),
        lane: line(326.4, 2.403),
        rest: 125.0,
    },
    multiplier: [25, 18],
    fixed_multipliers: 19,
    shapes: &SHAPES_18K,
    block_kbit: 18,
    root_kbit: 0,
    queues_in_blocks: false,
};

const ECP5: Prices = Prices {
    luts: Lines {
        setup: line(6787.8, 156.9),
        rows: line(3957.4, 51.7),
        lane: line(2015.7, 4.606),
        rest: 4.0,
    },
    flip_flops: Lines {
        setup: line(4375.8, 69.9),
        rows: line(4445.4, 68.7),
        lane: line(291.7, 4.792),
        rest: 130.0,
    },
    multiplier: [18, 18],
    fixed_multipliers: 15,
    shapes: &SHAPES_18K,
    block_kbit: 18,
    root_kbit: 36,
    queues_in_blocks: false,
};

const ICE40: Prices = Prices {
    luts: Lines {
        setup: line(4802.2, 159.6),
        rows: line(3605.4, 38.2),
        lane: line(1227.7, 4.373),
        rest: -21.0,
    },
    flip_flops: Lines {
        setup: line(4184.4, 67.2),
        rows: line(4358.6, 67.3),
        lane: line(426.2, 5.299),
        rest: 130.0,
    },
    multiplier: [17, 17],
    fixed_multipliers: 14,
    shapes: &SHAPES_4K,
    block_kbit: 4,
    root_kbit: 12,
    queues_in_blocks: true,
};

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

    fn prices(self) -> &'static Prices {
        match self {
            Family::Ice40 => &ICE40,
            Family::Ecp5 => &ECP5,
            Family::Xilinx7 => &XILINX_7,
        }
    }
}

/// The primitive of a design with so many lanes and a tile of so many pixels.
pub fn estimate(widths: &Widths, lanes: u32, tile_pixels: u64, family: Family) -> Fabric {
    let prices = family.prices();
    let bits = Bits::new(widths);
    let lanes = u64::from(lanes.max(1));
    let measure = |lines: &Lines| lines.at(bits.mantissa as f64, bits.lane as f64, lanes as f64);
    let tiled = |products: &[[u64; 2]]| -> u64 {
        let tiles = products.iter().map(|operands| prices.tiles(*operands));
        tiles.sum()
    };
    Fabric {
        luts: measure(&prices.luts),
        flip_flops: measure(&prices.flip_flops),
        dsps: prices.fixed_multipliers
            + tiled(&bits.shared_products())
            + lanes * tiled(&bits.lane_products()),
        memory_kbit: prices.root_kbit
            + lanes * prices.lane_memory(&bits, tile_pixels.div_ceil(lanes)),
    }
}

impl Prices {
    /// Multipliers of a product of signed operands: Yosys puts the wider one on the wider side, be it better or not.
    fn tiles(&self, [a, b]: [u64; 2]) -> u64 {
        let [wide, narrow] = self.multiplier.map(|bits| bits - 1);
        (a.max(b) - 1).div_ceil(wide) * (a.min(b) - 1).div_ceil(narrow)
    }

    /// Kilobits of a memory: blocks of the shape that takes fewest.
    fn memory(&self, words: u64, bits: u64) -> u64 {
        let blocks = self
            .shapes
            .iter()
            .map(|[deep, wide]| words.div_ceil(*deep) * bits.div_ceil(*wide));
        // The widest shape of a 36 kbit pair of blocks has 9 bits where a single block has 4.
        let pairs = 2 * words.div_ceil(4096) * bits.div_ceil(9);
        let pairs = if self.block_kbit == 18 {
            pairs
        } else {
            u64::MAX
        };
        self.block_kbit * blocks.min().unwrap_or(0).min(pairs)
    }

    /// Kilobits of one lane: its footprint table, its banks of the tile, its queue.
    fn lane_memory(&self, bits: &Bits, words: u64) -> u64 {
        let queue = if self.queues_in_blocks {
            self.memory(QUEUE.into(), bits.run)
        } else {
            0
        };
        self.memory(1 << bits.table, bits.entry)
            + self.memory(words, bits.depth)
            + self.memory(words, 3 * bits.sum)
            + queue
    }
}

/// Bits of everything that the circuit's size depends on.
struct Bits {
    mantissa: u64,
    table: u64,
    /// Sum of the widths that go through a lane.
    lane: u64,
    peak: u64,
    weight: u64,
    alpha: u64,
    transmittance: u64,
    colour: u64,
    interpolation: u64,
    /// The largest step between two table entries: at its end under `ewa`, e^-2.
    step: u64,
    /// A table entry with its step, and words of the tile buffer.
    entry: u64,
    depth: u64,
    sum: u64,
    run: u64,
}

impl Bits {
    fn new(widths: &Widths) -> Bits {
        let [
            _,
            mantissa,
            _,
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
        let step = weight.saturating_sub(2);
        // Row, column and length; the radial index and its differences; cut-off, peak and colours.
        let run = 39 + 96 + (radial + 5) + (peak + 4) + 3 * (colour + 4);
        Bits {
            mantissa,
            table,
            lane: radial + peak + weight + alpha + transmittance + 3 * (colour + accumulator),
            peak,
            weight,
            alpha,
            transmittance,
            colour,
            interpolation,
            step,
            entry: weight + 1 + step,
            depth: transmittance + 2,
            sum: accumulator + 5,
            run,
        }
    }

    /// Products of mantissas in setup (C dy, S dy, C dy^2) and rows (half-width, root, A dx, A dx^2), signed bits.
    fn shared_products(&self) -> [[u64; 2]; 7] {
        let m = self.mantissa;
        [
            [m + 1, m + 2],
            [m + 1, m + 2],
            [m + 2, m + 2],
            [m + 1, 33],
            [18, 17],
            [m + 1, m + 2],
            [m + 3, m + 2],
        ]
    }

    /// Products of a lane: opacity, share, three colours, interpolation, signed bits.
    fn lane_products(&self) -> [[u64; 2]; 6] {
        let colour = [self.transmittance + 2, self.colour + 4];
        [
            [self.peak + 5, self.weight],
            [self.transmittance + 2, self.alpha],
            colour,
            colour,
            colour,
            [self.step + 1, self.interpolation + 1],
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use splatline::format::{Lean18, Standard24};

    /// Synthesis (Yosys 0.23) of both designs with one and four lanes, from `docs/area.md`.
    const SYNTHESISED: [(Family, Widths, u32, [u64; 4]); 12] = [
        (Family::Xilinx7, Lean18::WIDTHS, 1, [10789, 3751, 45, 162]),
        (Family::Xilinx7, Lean18::WIDTHS, 4, [15111, 6245, 78, 432]),
        (
            Family::Xilinx7,
            Standard24::WIDTHS,
            1,
            [13460, 4327, 65, 360],
        ),
        (
            Family::Xilinx7,
            Standard24::WIDTHS,
            4,
            [19031, 7376, 128, 1152],
        ),
        (Family::Ecp5, Lean18::WIDTHS, 1, [17476, 12744, 47, 198]),
        (Family::Ecp5, Lean18::WIDTHS, 4, [26425, 16638, 81, 468]),
        (Family::Ecp5, Standard24::WIDTHS, 1, [19939, 14499, 66, 396]),
        (
            Family::Ecp5,
            Standard24::WIDTHS,
            4,
            [29952, 19500, 132, 1188],
        ),
        (Family::Ice40, Lean18::WIDTHS, 1, [14049, 12633, 59, 216]),
        (Family::Ice40, Lean18::WIDTHS, 4, [20487, 17250, 122, 524]),
        (
            Family::Ice40,
            Standard24::WIDTHS,
            1,
            [16451, 14386, 65, 416],
        ),
        (
            Family::Ice40,
            Standard24::WIDTHS,
            4,
            [23899, 20227, 131, 1244],
        ),
    ];

    #[test]
    fn estimates_are_within_a_tenth_of_synthesis() {
        for (family, widths, lanes, found) in SYNTHESISED {
            let fabric = estimate(&widths, lanes, 1024, family);
            let estimated = [
                fabric.luts,
                fabric.flip_flops,
                fabric.dsps,
                fabric.memory_kbit,
            ];
            for (estimated, found) in estimated.iter().zip(found) {
                let error = *estimated as f64 / found as f64 - 1.0;
                assert!(
                    error.abs() < 0.1,
                    "{family:?}, {lanes} lanes: {fabric:?} against {found}"
                );
            }
        }
    }
}
