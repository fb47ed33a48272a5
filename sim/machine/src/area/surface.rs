//! A surface unit, counted: what gathers samples by depth in place of the blend, and what normalises and shades
//! fragments while a tile is read out.
//!
//! No circuit of it was written, so its area is an **estimate**: operators by the kernel's formats, products tiled with
//! the family's multipliers, other logic scaled by what splat setup and rows take beyond their own count. A lane keeps
//! the logic of its blend, which gathering takes the place of.

use super::{Calibration, Fabric, as_synthesised};
use crate::config::Config;
use splatline::blend::surface::sum_fraction;
use splatline::footprint::surface::attribute_fraction;
use splatline::format::Widths;

/// What an answer says of a machine that has one.
pub const ESTIMATED: &str = "the surface unit is an estimate: no circuit of it was written, and surfaces are set up by the unit of volume splats";

/// Cycles from a fragment's sums to its colour: reciprocal, division, composition.
pub const RESOLVE_LATENCY: u64 = 24;

/// Bits of a vector's component in shading, and products of that size: normal 10, ray 12, cosine, reflection and
/// highlight 9, power 16, material 6.
const LIGHT: ([u64; 2], usize) = ([31, 31], 53);

/// Operands of a surface unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SurfaceBits {
    /// Fragments of a pixel.
    pub layers: u64,
    light: bool,
    mantissa: u64,
    weight: u64,
    attribute: u64,
    sum: u64,
    share: u64,
    colour: u64,
    /// Of a fragment's sums, depths and material.
    pub fragment: u64,
    /// Of a packet beside a volume splat's: the depth's plane, opacity, normal, material, and a colour's four more.
    pub packet: u64,
}

impl SurfaceBits {
    /// Bits of the depth's adder in a lane.
    pub const DEPTH: u64 = 64;

    /// Of a design.
    pub fn new(widths: &Widths, layers: u32, light: bool) -> SurfaceBits {
        let fraction = u64::from(sum_fraction(widths));
        let attribute = u64::from(attribute_fraction(widths));
        SurfaceBits {
            layers: layers.max(1).into(),
            light,
            mantissa: widths.mantissa.into(),
            weight: fraction + 1,
            attribute: attribute + 1,
            sum: fraction + 8,
            share: u64::from(widths.transmittance) + 1,
            colour: u64::from(widths.accumulator) + 4,
            fragment: 8 * (fraction + 8) + 2 * 32 + 8,
            packet: 3 * 64 + (attribute + 1) + 3 * (attribute + 2) + 8 + 3 * 4,
        }
    }

    /// Of a machine, if it has one.
    pub fn of(widths: &Widths, config: &Config) -> Option<SurfaceBits> {
        let layers = config.surface_layers;
        (layers > 0).then(|| SurfaceBits::new(widths, layers, config.surface_light > 0))
    }

    /// Products of a sample: its weight with three colours, opacity and normal.
    pub fn gathered(&self) -> [[u64; 2]; 7] {
        [[self.weight, self.attribute]; 7]
    }

    /// Bits of a sample's adders: eight sums, and both ends of every fragment's window of depths.
    pub fn gather_adders(&self) -> u64 {
        8 * self.sum + 2 * 32 * self.layers
    }

    /// Products of a fragment: reciprocal, division of seven sums, composition; light. A merge of two layers takes
    /// seven and seven more.
    pub fn resolved(&self) -> Vec<[u64; 2]> {
        let merges = if self.layers > 1 { 14 } else { 0 };
        let light = if self.light { LIGHT.1 } else { 0 };
        [
            vec![[self.mantissa; 2]; 2],
            vec![[self.sum, self.mantissa]; 7],
            vec![[self.share, self.colour]; 5],
            vec![[self.colour, 31]; merges],
            vec![LIGHT.0; light],
        ]
        .concat()
    }

    /// Bits of a fragment's adders: roundings of its quotients, the composed sums, and a shaded fragment's.
    pub fn resolve_adders(&self) -> u64 {
        let light = if self.light { 20 * 64 } else { 0 };
        7 * 32 + 4 * self.colour + light
    }

    /// Everything of a raster unit's but memories of pixels: gathering in each lane, and one unit that normalises.
    pub(super) fn logic(&self, widths: &Widths, config: &Config, prices: &Calibration) -> Fabric {
        // In several layers a sample's fragment is chosen, and the others move up or down by one.
        let choice = if self.layers > 1 { 3 * self.layers } else { 1 };
        let of_lane = Self::DEPTH + self.gather_adders() + choice * self.fragment;
        let operators = u64::from(config.lanes) * of_lane + self.resolve_adders();
        let [luts, registers] = [&prices.luts, &prices.flip_flops]
            .map(|lines| as_synthesised(operators as f64, lines, widths));
        Fabric {
            luts,
            flip_flops: registers,
            dsps: prices.shared(&self.resolved(), config.resolve_interval),
            memory_kbit: prices.memory(256, 2 * self.mantissa),
        }
    }
}
