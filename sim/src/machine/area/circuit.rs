//! What the splat primitive of `sim/rtl` is made of, by its widths: operands of its products, words of its memories.
//!
//! Products are counted by tiling each with the family's multiplier, memories by its block shapes. What is counted here is the circuit as it
//! is written; a machine with longer initiation intervals shares multipliers that the circuit has side by side.

use super::Fabric;
use super::calibration::Calibration;
use splatline::format::Widths;

/// Bits of everything that the circuit's size depends on.
pub struct Bits {
    /// Mantissas of setup and rows.
    pub mantissa: u64,
    /// Sum of the widths that go through a lane.
    pub lane: u64,
    /// Words of the footprint table, and bits of an entry with its step.
    pub table: [u64; 2],
    /// Bits of a pixel's transmittance with its flag, and of its three sums.
    pub pixel: [u64; 2],
    /// Bits of a run in a lane's queue.
    pub run: u64,
    peak: u64,
    weight: u64,
    alpha: u64,
    transmittance: u64,
    colour: u64,
    interpolation: u64,
    /// The largest step between two table entries: at its end under `ewa`, e^-2.
    step: u64,
}

impl Bits {
    /// Of a design.
    pub fn new(widths: &Widths) -> Bits {
        let [
            _,
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
        Bits {
            mantissa,
            lane: radial + peak + weight + alpha + transmittance + 3 * (colour + accumulator),
            table: [1 << table, weight + 1 + step],
            pixel: [transmittance + 2, 3 * (accumulator + 5)],
            // Row, column and length; the radial index and its differences; cut-off, peak and colours.
            run: 39 + 96 + (radial + 5) + (peak + 4) + 3 * (colour + 4),
            peak,
            weight,
            alpha,
            transmittance,
            colour,
            interpolation,
            step,
        }
    }

    /// Products of splat setup: C dy, S dy, C dy^2. Signed bits here and below.
    pub fn setup_products(&self) -> [[u64; 2]; 3] {
        let m = self.mantissa;
        [[m + 1, m + 2], [m + 1, m + 2], [m + 2, m + 2]]
    }

    /// Products of a row: half-width, root, A dx, A dx^2.
    pub fn row_products(&self) -> [[u64; 2]; 4] {
        let m = self.mantissa;
        [[m + 1, 33], [18, 17], [m + 1, m + 2], [m + 3, m + 2]]
    }

    /// The product of opacity, that of the share of the transmittance, and one colour's.
    pub fn blend_products(&self) -> [[u64; 2]; 3] {
        [
            [self.peak + 5, self.weight],
            [self.transmittance + 2, self.alpha],
            [self.transmittance + 2, self.colour + 4],
        ]
    }

    /// The table's interpolation; none without fraction bits.
    pub fn interpolation_product(&self) -> Option<[u64; 2]> {
        (self.interpolation > 0).then_some([self.step + 1, self.interpolation + 1])
    }
}

impl Calibration {
    /// Multipliers of a product: Yosys puts the wider operand on the wider side, be it better or not.
    pub fn tiles(&self, [a, b]: [u64; 2]) -> u64 {
        let [wide, narrow] = self.multiplier.map(|bits| bits.max(2) - 1);
        (a.max(b) - 1).div_ceil(wide) * (a.min(b) - 1).div_ceil(narrow)
    }

    /// Multipliers of several products.
    pub fn tiled(&self, products: &[[u64; 2]]) -> u64 {
        products.iter().map(|operands| self.tiles(*operands)).sum()
    }

    /// Kilobits of a memory: blocks of the shape that takes fewest.
    pub fn memory(&self, words: u64, bits: u64) -> u64 {
        let blocks = self
            .shapes
            .iter()
            .map(|[deep, wide]| words.div_ceil(*deep) * bits.div_ceil(*wide));
        // The deepest shape of a 36 kbit pair of blocks has 9 bits where a single block has 4.
        let pairs = 2 * words.div_ceil(4096) * bits.div_ceil(9);
        let pairs = if self.block_kbit == 18 {
            pairs
        } else {
            u64::MAX
        };
        self.block_kbit * blocks.min().unwrap_or(0).min(pairs)
    }

    /// A queue: a memory of look-up tables or of blocks, whichever weighs less.
    pub fn queue(&self, words: u64, bits: u64) -> Fabric {
        let blocks = Fabric {
            memory_kbit: self.memory(words, bits),
            ..Fabric::default()
        };
        let Some(cell) = &self.lut_memory else {
            return blocks;
        };
        let logic = Fabric {
            luts: words.div_ceil(cell.words) * bits.div_ceil(cell.bits) * cell.luts,
            ..Fabric::default()
        };
        if self.weight(&logic) <= self.weight(&blocks) {
            logic
        } else {
            blocks
        }
    }
}
