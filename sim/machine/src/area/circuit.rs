//! What the splat primitive of `sim/rtl` is made of, by its widths: operands of its products, words of its memories.
//!
//! Products are counted by tiling each with the family's multiplier, memories by its block shapes. What is counted here
//! is the circuit as it is written; a machine with longer initiation intervals shares multipliers that the circuit has
//! side by side.

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
    /// Bits of the radial index, of a weight, and of a pixel's three sums one by one.
    pub radial: u64,
    pub accumulator: u64,
    pub weight: u64,
    pub peak: u64,
    subpixel: u64,
    alpha: u64,
    pub transmittance: u64,
    colour: u64,
    /// Integer bits of colours and their sums.
    pub range: u64,
    interpolation: u64,
    /// The largest step between two table entries: at its end under `ewa`, e^-2.
    step: u64,
}

impl Bits {
    /// Of a design.
    pub fn new(widths: &Widths) -> Bits {
        let [radial, weight, peak, alpha] =
            [widths.radial, widths.weight, widths.peak, widths.alpha].map(u64::from);
        let [transmittance, colour, accumulator] =
            [widths.transmittance, widths.colour, widths.accumulator].map(u64::from);
        let range = u64::from(widths.colour_range());
        let step = weight.saturating_sub(2);
        Bits {
            mantissa: widths.mantissa.into(),
            lane: radial + peak + weight + alpha + transmittance + 3 * (colour + accumulator),
            table: [1 << widths.table, weight + 1 + step],
            pixel: [transmittance + 2, 3 * (accumulator + range + 1)],
            // Row, column and length; the radial index and its differences; cut-off, peak and colours.
            run: 39 + 96 + (radial + 5) + (peak + 4) + 3 * (colour + range),
            radial,
            accumulator,
            weight,
            peak,
            subpixel: widths.subpixel.into(),
            alpha,
            transmittance,
            colour,
            range,
            interpolation: widths.interpolation.into(),
            step,
        }
    }

    /// Products of splat setup, of which each packet has one: C dy, S dy, C dy^2.
    pub fn setup_products(&self) -> [Product; 3] {
        let m = self.mantissa;
        let product = |operands| Product::new([m, m], operands);
        [[m + 1, m + 2], [m + 1, m + 2], [m + 2, m + 2]].map(product)
    }

    /// Products of a row: half-width, root, A dx, A dx^2.
    pub fn row_products(&self) -> [Product; 4] {
        let m = self.mantissa;
        [
            Product::new([30, m], [m + 1, 30]),
            Product::new([17, 16], [18, 17]),
            Product::new([m + 1, m], [m + 1, m + 2]),
            Product::new([m + 1, m + 1], [m + 3, m + 2]),
        ]
    }

    /// The product of opacity, that of the share of the transmittance, and one colour's. No fraction's 1.0 has a
    /// multiplier.
    pub fn blend_products(&self) -> [Product; 3] {
        let (peak, share) = (self.peak, self.transmittance);
        let colour = self.colour + self.range;
        [
            Product::new([peak + 4, self.weight], [peak + 5, self.weight]),
            Product::new([share, self.alpha], [share + 2, self.alpha]),
            Product::new([share, colour], [share + 2, colour]),
        ]
    }

    /// Bits that a lane's products multiply by few others, which takes additions; of the small primitive its colours'
    /// alone.
    pub fn added(&self, small: bool) -> u64 {
        let [opacity, share, colour] = self.blend_products();
        let products = [colour, colour, colour, opacity, share];
        let products = &products[..if small { 3 } else { 5 }];
        let parts = products.iter().flat_map(|product| parts(product.factors));
        let added = parts.filter(|[a, b]| (2..=FEW).contains(a.min(b)));
        added.map(|[a, b]| a.max(b)).sum()
    }

    /// The table's interpolation; none without fraction bits.
    pub fn interpolation_product(&self) -> Option<Product> {
        let (step, fraction) = (self.step, self.interpolation);
        let product = Product::new([step, fraction], [step + 1, fraction + 1]);
        (fraction > 0).then_some(product)
    }
}

/// A product of the circuit.
#[derive(Clone, Copy, Debug)]
pub struct Product {
    /// Bits of its unsigned factors, as `multiply.sv` has them: area counts these.
    pub factors: [u64; 2],
    /// Bits of its signed operands: energy counts these.
    pub operands: [u64; 2],
}

impl Product {
    const fn new(factors: [u64; 2], operands: [u64; 2]) -> Product {
        Product { factors, operands }
    }
}

/// Bits of adders, and widths of shifters by any number of places.
pub struct Operators {
    pub adder_bits: u64,
    pub shifters: Vec<u64>,
}

impl Operators {
    /// Look-up tables if each took no more than its carry chain or its stages, which shift by up to three places each.
    pub fn luts(&self) -> f64 {
        let stages = |width: u64| u64::from(width.max(2).ilog2().div_ceil(2));
        let shifting = self.shifters.iter().map(|width| width * stages(*width));
        (self.adder_bits + shifting.sum::<u64>()) as f64
    }
}

impl Bits {
    /// Adders and shifters of splat setup, and of a row.
    pub fn operators(&self) -> [Operators; 2] {
        let m = self.mantissa;
        [
            Operators {
                adder_bits: 3 * 64,
                shifters: vec![64; 6],
            },
            Operators {
                adder_bits: 3 * 64 + 4 * (27 + self.subpixel),
                shifters: vec![64, m + 32, m + 32],
            },
        ]
    }
}

/// Geometry setup, counted: projection (9 products of position and rotation, 27 where they have two parts, and 4 of
/// ratios and focal length), columns of J W S (27 + 12), variance (15), LDL and conic (10), peak and cut-off (4),
/// reciprocals and roots by table and a product or two (8).
pub struct GeometryCircuit {
    /// Position relative to the eye, and its rotation: what a splat takes before it can be culled.
    pub rotation: SetupStage,
    /// Everything after that.
    pub footprint: SetupStage,
    /// Bits of a word of either table.
    pub table_bits: u64,
}

/// Products and adders of a part of geometry setup, and its look-ups.
pub struct SetupStage {
    pub products: Vec<[u64; 2]>,
    pub operators: Operators,
    pub lookups: u64,
}

impl GeometryCircuit {
    /// Words of each of the two tables, for reciprocals and for roots.
    pub const TABLE_WORDS: u64 = 256;

    /// Of a design.
    pub fn new(widths: &Widths) -> GeometryCircuit {
        let [position, view, m] = [widths.position, widths.view, widths.mantissa].map(u64::from);
        // Beyond 30 bits the difference to the eye and the rotation have two parts, of whose products the lowest is
        // left out.
        let low = position.saturating_sub(30);
        let cross = if low > 0 { 18 } else { 0 };
        let rotation = [vec![[position.min(30); 2]; 9], vec![[30, low]; cross]];
        let footprint = [
            vec![[view, view]; 4],
            vec![[view, m]; 27],
            vec![[m, m]; 12 + 15 + 10 + 4 + 8],
        ];
        GeometryCircuit {
            rotation: SetupStage {
                products: rotation.concat(),
                operators: Operators {
                    // Alignment of splat and eye in 61 bits, the difference, its block exponent and the rotation's sums
                    // come first.
                    adder_bits: 9 * 64 + 3 * 61,
                    shifters: [vec![61; 6], vec![position; 3]].concat(),
                },
                lookups: 0,
            },
            footprint: SetupStage {
                products: footprint.concat(),
                operators: Operators {
                    adder_bits: 60 * (m + 2),
                    shifters: vec![m; 40],
                },
                lookups: 4,
            },
            table_bits: m.min(18),
        }
    }

    /// All products.
    pub fn products(&self) -> Vec<[u64; 2]> {
        [&self.rotation, &self.footprint]
            .map(|stage| stage.products.clone())
            .concat()
    }

    /// All other operators.
    pub fn counted(&self) -> Operators {
        let all = [&self.rotation, &self.footprint].map(|stage| &stage.operators);
        Operators {
            adder_bits: all.iter().map(|part| part.adder_bits).sum(),
            shifters: all.map(|part| part.shifters.clone()).concat(),
        }
    }
}

/// Bits of a factor's part that `multiply.sv` gives a multiplier.
const PART: u64 = 18;

/// Bits of a part that takes no multiplier, if it need not; `ADDED_BITS` of `multiply.sv`.
const FEW: u64 = 4;

/// Bits of the smallest product that Yosys makes with a multiplier (`DSP_Y_MINWIDTH` of Xilinx 7; 11 for iCE40).
const SMALLEST: u64 = 9;

/// The products that `multiply.sv` cuts one into.
fn parts([a, b]: [u64; 2]) -> impl Iterator<Item = [u64; 2]> {
    cut(a, PART).flat_map(move |a| cut(b, PART).map(move |b| [a, b]))
}

/// Bits of what a factor is cut into.
fn cut(bits: u64, size: u64) -> impl Iterator<Item = u64> {
    (0..bits.div_ceil(size)).map(move |piece| (bits - piece * size).min(size))
}

impl Calibration {
    /// Multipliers of a product, which is cut into parts as in `multiply.sv`: Yosys puts a part's wider factor on the
    /// wider side, be it better or not. A part of few bits takes gates or additions, and what a multiplier leaves over
    /// takes some if it is small.
    pub fn tiles(&self, product: [u64; 2]) -> u64 {
        self.tiles_beyond(FEW, product)
    }

    /// The same where parts of so many bits take additions.
    pub fn tiles_beyond(&self, few: u64, product: [u64; 2]) -> u64 {
        let [wide, narrow] = self.multiplier.map(|bits| bits.max(1));
        let of_part = |[a, b]: [u64; 2]| -> u64 {
            if a.min(b) <= few {
                return 0;
            }
            let sums = cut(a.max(b), wide)
                .flat_map(|long| cut(a.min(b), narrow).map(move |short| long + short));
            sums.filter(|bits| *bits >= SMALLEST).count() as u64
        };
        parts(product).map(of_part).sum()
    }

    /// Multipliers for products of the same unit, of which a longer interval lets several share one.
    pub fn shared(&self, products: &[[u64; 2]], interval: u32) -> u64 {
        let all = products.iter().map(|operands| self.tiles(*operands));
        all.sum::<u64>().div_ceil(interval.max(1).into())
    }

    /// Kilobits of a memory: blocks of the shape that takes fewest.
    pub fn memory(&self, words: u64, bits: u64) -> u64 {
        let blocks = |[deep, wide]: &[u64; 2]| words.div_ceil(*deep) * bits.div_ceil(*wide);
        let blocks = self.shapes.iter().map(blocks).min().unwrap_or(0);
        // The deepest shape of a 36 kbit pair of blocks has 9 bits where a single block has 4.
        let pairs = 2 * words.div_ceil(4096) * bits.div_ceil(9);
        let paired = self.block_kbit == 18;
        self.block_kbit * if paired { blocks.min(pairs) } else { blocks }
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
