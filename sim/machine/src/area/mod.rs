//! Area of a machine in an FPGA's own units: look-up tables, flip-flops, multipliers, memory.
//!
//! The raster units are priced by lines that go through Yosys' synthesis of the primitive in `sim/rtl` ([`synthesis`]),
//! so that the machine `primitive-4` is estimated as the circuit that it is. What the circuit has otherwise, a machine
//! is charged by the same lines: every generator of rows like its row generator, every lane like its lane. Geometry
//! setup is the circuit of [`setup`] where a splat comes in eight cycles or more. What no circuit was written or
//! synthesised for (faster setup, queues around the raster units, `box` rows) is counted and kept apart. Sorter,
//! binning, harmonics, readers and their arbiter are their circuits ([`units`]). The memory's controller and the bus
//! are not counted, and every answer says so. See `docs/hardware-model.md`, section 5.

mod calibration;
mod check;
pub(super) mod circuit;
pub mod lane;
pub mod setup;
pub mod surface;
pub mod synthesis;
pub mod units;

pub use calibration::{Calibration, ClockFactor, Family, Lines, LutMemory, PriceLine};

use super::config::{Config, LaneLayout, Overlap, Termination};
use super::primitive::{Intervals, QUEUE};
use circuit::{Bits, GeometryCircuit, Operators};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use splatline::footprint::packet;
use splatline::format::{Traversal, Widths};
use std::fmt;
use std::ops::{Add, Mul};
use surface::SurfaceBits;

/// What a circuit takes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
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

/// A machine's resources.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Area {
    /// The raster units, by lines through synthesis.
    pub raster: Fabric,
    /// Geometry setup, sort, binning, harmonics, readers and queues around them.
    pub around: Fabric,
    /// All of it in look-up tables, for one number.
    pub weight: f64,
}

/// Estimates a machine that carries a design.
pub fn estimate(
    widths: &Widths,
    traversal: Traversal,
    config: &Config,
    calibration: &Calibration,
) -> Area {
    let counted = CountedMachine::new(widths, traversal, config, calibration);
    let raster = counted.raster_unit() * u64::from(config.raster_units);
    let setup = || counted.setup() * u64::from(config.setup_units);
    let around = setup::of_machine(widths, config, calibration).unwrap_or_else(setup)
        + counted.queues()
        + units::of_machine(config, calibration);
    Area {
        raster,
        around,
        weight: calibration.weight(&(raster + around)),
    }
}

/// A machine with a design, and what its circuits are counted by.
pub struct CountedMachine<'a> {
    widths: &'a Widths,
    bits: Bits,
    surface: Option<SurfaceBits>,
    traversal: Traversal,
    config: &'a Config,
    prices: &'a Calibration,
}

impl<'a> CountedMachine<'a> {
    /// By these prices.
    pub fn new(
        widths: &'a Widths,
        traversal: Traversal,
        config: &'a Config,
        prices: &'a Calibration,
    ) -> Self {
        CountedMachine {
            widths,
            bits: Bits::new(widths),
            surface: SurfaceBits::of(widths, config),
            traversal,
            config,
            prices,
        }
    }

    /// One raster unit: what the primitive is for `primitive-1` and its like.
    pub fn raster_unit(&self) -> Fabric {
        let logic = self.surface.map_or(Fabric::default(), |surface| {
            surface.logic(self.widths, self.config, self.prices)
        });
        let rows = self.rows() * u64::from(self.config.rows_at_once);
        self.splat_setup() + rows + self.lanes() + logic
    }

    /// Start values of the rows. `box` has seven products of mantissas where the circuit of `spans` has three.
    ///
    /// The circuit sets a packet up in every cycle, or in four or eight by shared shifters; a machine between two of
    /// them is charged for the larger one's logic.
    fn splat_setup(&self) -> Fabric {
        let (m, interval) = (self.bits.mantissa, self.config.splat_cycles);
        let logic = |lines: &Lines| {
            let setup = match interval {
                0..4 => &lines.setup,
                4..8 => &lines.shared_setup,
                8.. => &lines.small_setup,
            };
            (setup.at(m) + lines.rest).round() as u64
        };
        Fabric {
            luts: logic(&self.prices.luts),
            flip_flops: logic(&self.prices.flip_flops),
            dsps: match self.traversal {
                Traversal::Spans => self.prices.setup_dsps(&self.bits, interval),
                Traversal::Box => self.prices.shared(&[[m, m]; 7], interval),
            },
            memory_kbit: self.prices.blocks_of(&self.prices.setup_kbit, m),
        }
    }

    /// One generator of rows. `box` only adds: four words of 63 bits, counted.
    fn rows(&self) -> Fabric {
        if self.traversal == Traversal::Box {
            return Fabric {
                luts: 4 * 63,
                flip_flops: 4 * 63,
                ..Fabric::default()
            };
        }
        let (m, prices) = (self.bits.mantissa, self.prices);
        let logic = |lines: &Lines| {
            let shared = self.config.row_cycles >= Intervals::SMALL.rows;
            let rows = if shared {
                &lines.small_rows
            } else {
                &lines.rows
            };
            rows.at(m).round() as u64
        };
        let products = self.bits.row_products().map(|product| product.factors);
        let [half_width, root, _, across] = products.map(|factors| prices.tiles(factors));
        Fabric {
            luts: logic(&prices.luts),
            flip_flops: logic(&prices.flip_flops),
            dsps: match self.config.row_cycles {
                // As `row_seed.sv` shares them.
                2 => half_width + root + across,
                cycles => prices.shared(&products, cycles),
            },
            memory_kbit: prices.blocks_of(&prices.row_kbit, m),
        }
    }

    /// Is it the small primitive, which multiplies opacities and shares without additions?
    fn small(&self) -> bool {
        (self.config.lanes, self.config.intervals()) == (1, Intervals::SMALL)
    }

    /// All lanes with their queues, tables and banks. Only with the layout `rows` has each lane a queue of its own.
    fn lanes(&self) -> Fabric {
        let (config, bits, prices) = (self.config, &self.bits, self.prices);
        let lanes = u64::from(config.lanes);
        let queues = match config.layout {
            LaneLayout::Rows => lanes,
            _ => 1,
        };
        let queue = |runs: u32| prices.queue(runs.into(), bits.run);
        // A mask of the tile's columns, with the search for the next open group.
        let mask = match config.pixel_termination {
            Termination::Skip => 2 * u64::from(config.tile_width),
            Termination::Discard => 0,
        };
        let lane = |lines: &Lines| {
            let one = lines.lane.at(bits.lane) + lines.added * bits.added(self.small()) as f64;
            (lanes as f64 * one).round() as u64
        };
        // The lines hold a lane with the circuit's queue.
        let luts = lane(&prices.luts) + lanes * mask + queues * queue(config.row_fifo).luts;
        let [words, entry] = bits.table;
        let pixel = match self.surface {
            Some(surface) => vec![surface.layers * surface.fragment],
            None => bits.pixel.to_vec(),
        };
        let words_of_bank = config.bank_words();
        let bank = pixel.iter().map(|word| prices.memory(words_of_bank, *word));
        Fabric {
            luts: luts.saturating_sub(lanes * queue(QUEUE).luts),
            flip_flops: lane(&prices.flip_flops),
            dsps: self.lane_dsps(),
            memory_kbit: self.table_ports() * prices.memory(words, entry)
                + config.banks() * u64::from(config.tile_buffers) * bank.sum::<u64>()
                + queues * queue(config.row_fifo).memory_kbit,
        }
    }

    /// Ports of the footprint table, one a lane unless they are given.
    fn table_ports(&self) -> u64 {
        match self.config.table_ports {
            0 => self.config.lanes.into(),
            ports => ports.min(self.config.lanes).into(),
        }
    }

    /// Multipliers of all lanes of a raster unit.
    fn lane_dsps(&self) -> u64 {
        let (bits, config) = (&self.bits, self.config);
        let [opacity, share, colour] = bits.blend_products().map(|product| product.factors);
        let blend = |products: &[[u64; 2]]| self.prices.shared(products, config.blend_interval);
        let apart = |product| {
            let spared = self.prices.tiles(product);
            self.prices.tiles_beyond(0, product) - spared
        };
        let apart = if self.small() {
            apart(opacity) + apart(share)
        } else {
            0
        };
        let interpolation = bits.interpolation_product();
        let interpolation = interpolation.map_or(0, |product| self.prices.tiles(product.factors));
        let blended = match self.surface {
            Some(surface) => blend(&surface.gathered()),
            None => blend(&[share]) + blend(&[colour; 3]),
        };
        u64::from(config.lanes) * (blend(&[opacity]) + apart + blended)
            + self.table_ports() * interpolation
    }

    /// Geometry setup where no circuit was synthesised ([`setup`], [`circuit::Geometry`]): more often than once in
    /// eight cycles, or for another family.
    ///
    /// Its operators are counted. Those of splat setup and rows, counted the same way, come out several times smaller
    /// than their synthesis (rounding, saturation, special cases); geometry setup is taken to be short by the same
    /// factor.
    fn setup(&self) -> Fabric {
        let (geometry, prices) = (GeometryCircuit::new(self.widths), self.prices);
        let operators = geometry.counted().luts();
        let logic = |lines: &Lines| as_synthesised(operators, lines, self.widths);
        Fabric {
            luts: logic(&prices.luts),
            flip_flops: logic(&prices.flip_flops),
            dsps: prices.shared(&geometry.products(), self.config.setup_interval),
            memory_kbit: 2 * prices.memory(GeometryCircuit::TABLE_WORDS, geometry.table_bits),
        }
    }

    /// Queues of splats and packets. The circuit has none between splat setup and rows.
    fn queues(&self) -> Fabric {
        let config = self.config;
        let bits = packet_bits(self.widths, self.traversal, config);
        let queue = |depth: u32, bits: u64| self.prices.queue(depth.into(), bits);
        let splats = match config.overlap {
            Overlap::Primitive => Fabric::default(),
            _ => queue(config.splat_fifo, bits),
        };
        // Each packet of a cache with the rest of its splat's number, up to 2^24 splats.
        let cache = match config.packet_cache {
            0 => Fabric::default(),
            packets => queue(packets, bits + 24),
        };
        let each = queue(config.packet_fifo, bits) + splats + cache;
        each * u64::from(config.raster_units)
            + queue(config.setup_fifo, 8 * u64::from(config.splat_bytes))
            + queue(config.bin_fifo, bits)
    }
}

/// What so many counted look-up tables of operators take, if synthesis adds as much to them as to those of splat setup
/// and rows.
fn as_synthesised(operators: f64, lines: &Lines, widths: &Widths) -> u64 {
    let m = u64::from(widths.mantissa);
    let written = Bits::new(widths).operators();
    let written: f64 = written.iter().map(Operators::luts).sum();
    let synthesised = lines.setup.at(m) + lines.rows.at(m);
    (operators * synthesised / written).round() as u64
}

/// Bits of a packet of a machine.
pub fn packet_bits(widths: &Widths, traversal: Traversal, config: &Config) -> u64 {
    let surface = SurfaceBits::of(widths, config).map_or(0, |bits| bits.packet);
    packet::Layout::new(widths, traversal).bits() as u64 + surface
}

impl Fabric {
    /// The resources with their names, in the order of all tables.
    pub fn resources(&self) -> [(&'static str, u64); 4] {
        [
            ("LUT", self.luts),
            ("FF", self.flip_flops),
            ("DSP", self.dsps),
            ("kbit", self.memory_kbit),
        ]
    }

    /// The largest deviation from what was found, of any resource, as a part of 1.
    pub fn worst_error(&self, found: &Fabric) -> f64 {
        let pairs = self.resources().into_iter().zip(found.resources());
        pairs
            .filter(|((_, estimated), (_, found))| estimated != found)
            .map(|((_, estimated), (_, found))| (estimated as f64 / found as f64 - 1.0).abs())
            .fold(0.0, f64::max)
    }
}

/// Headings of [`Fabric::cells`].
const RESOURCES: &str = "luts,flip_flops,dsps,memory_kbit";

/// The lines of a table whose heading names the fields of a line.
pub(crate) fn lines_of<Line: DeserializeOwned>(text: &str) -> csv::Result<Vec<Line>> {
    csv::Reader::from_reader(text.as_bytes())
        .into_deserialize()
        .collect()
}

impl Fabric {
    /// The resources as columns of a table.
    pub fn cells(&self) -> String {
        let counts = self.resources().map(|(_, count)| count.to_string());
        counts.join(",")
    }
}

impl fmt::Display for Fabric {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let resources = self.resources();
        let words = resources.map(|(name, count)| format!("{count} {name}"));
        f.write_str(&words.join(", "))
    }
}

impl Add for Fabric {
    type Output = Fabric;
    fn add(self, other: Fabric) -> Fabric {
        Fabric {
            luts: self.luts + other.luts,
            flip_flops: self.flip_flops + other.flip_flops,
            dsps: self.dsps + other.dsps,
            memory_kbit: self.memory_kbit + other.memory_kbit,
        }
    }
}

impl Mul<u64> for Fabric {
    type Output = Fabric;
    fn mul(self, count: u64) -> Fabric {
        Fabric {
            luts: self.luts * count,
            flip_flops: self.flip_flops * count,
            dsps: self.dsps * count,
            memory_kbit: self.memory_kbit * count,
        }
    }
}

#[cfg(test)]
mod tests;
