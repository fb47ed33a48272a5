//! What a scene really uses: units, layers, ranges and FIFO depths.
//!
//! Depths are found by a run with FIFOs so deep that none is ever full, and then by halving each one, with the others
//! deep, for as long as the picture takes at most [`SLACK`] more cycles.

use super::statistics::Statistics;
use crate::machine::config::Config;
use crate::machine::lanes::{LaneShape, LaneWork};
use crate::machine::simulate;
use crate::machine::workload::Workload;
use serde::Serialize;
use splatline::footprint::Footprint;
use std::collections::BTreeMap;

/// Cycles that a shallower FIFO may cost.
pub const SLACK: f64 = 0.01;

const DEEP: u32 = 4096;
const FIFOS: [&str; 5] = [
    "setup_fifo",
    "bin_fifo",
    "packet_fifo",
    "splat_fifo",
    "row_fifo",
];

/// What is needed.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Needs {
    /// Units by name, with the reason where one is not needed.
    pub units: BTreeMap<&'static str, String>,
    /// Depth of each FIFO that costs at most 1 % of the cycles that deep FIFOs take.
    pub fifo_depths: BTreeMap<&'static str, u32>,
    /// Most entries in each FIFO with deep FIFOs.
    pub fifo_high_water: BTreeMap<&'static str, u64>,
    /// Cycles with deep FIFOs.
    pub cycles: u64,
    /// Most splats that blend into one pixel, finished splats left out.
    pub deepest_pixel: u32,
    /// Most pairs of one tile.
    pub longest_tile_list: u32,
    /// Splats visible.
    pub visible: usize,
    /// Smallest and largest binary exponent of the LDL form's horizontal factor 1/(half-width)^2 per square pixel.
    pub curvature_log2: Option<[i32; 2]>,
    /// Largest footprint: columns and rows on the screen.
    pub largest_box: [u16; 2],
    /// Longest run in a tile.
    pub longest_run: u32,
    /// Largest and smallest peak opacity of a splat.
    pub peaks: Option<[f64; 2]>,
    /// Pixels that had finished when a splat covered them, of all covered pixels.
    pub finished_part: f64,
    /// Pairs whose traversal visits no pixel, of all pairs.
    pub empty_pairs_part: f64,
}

/// Examines a workload, its statistics and the footprints that it came from. `peak_bits` are the fraction bits of a
/// peak, `alpha_max` is what the rules clamp a pixel's opacity to.
pub fn needs(
    (workload, statistics): (&Workload, &Statistics),
    footprints: &[Footprint],
    peak_bits: u8,
    alpha_max: f64,
    machine: &Config,
) -> Needs {
    let totals = workload.totals();
    let part = |some: u64, all: usize| {
        if all == 0 {
            0.0
        } else {
            some as f64 / all as f64
        }
    };
    let empty = workload.pairs.iter().filter(|pair| !pair.visits).count() as u64;
    let exponents = footprints
        .iter()
        .map(|footprint| footprint.ldl.horizontal.leading());
    let peaks = footprints
        .iter()
        .map(|footprint| f64::from(footprint.opacity) / f64::from(peak_bits).exp2());
    let (least, highest) = (exponents.clone().min(), peaks.clone().reduce(f64::max));
    let finished = totals.covered - totals.live;
    let runs = workload.rows.iter().map(|row| row.length);
    let lists = (0..workload.tiles.len()).map(|tile| workload.pairs_in(tile).len());
    let mut needs = Needs {
        deepest_pixel: statistics.layers_per_pixel.largest as u32,
        longest_tile_list: lists.max().unwrap_or(0) as u32,
        visible: footprints.len(),
        curvature_log2: least.zip(exponents.max()).map(<[i32; 2]>::from),
        largest_box: footprints.iter().fold([0, 0], |largest, footprint| {
            [0, 1].map(|axis| largest[axis].max(footprint.end[axis] - footprint.first[axis]))
        }),
        longest_run: runs.max().unwrap_or(0).into(),
        peaks: highest.zip(peaks.reduce(f64::min)).map(<[f64; 2]>::from),
        finished_part: part(finished, totals.covered as usize),
        empty_pairs_part: part(empty, workload.pairs.len()),
        ..Needs::default()
    };
    needs.find_depths(workload, machine);
    needs.judge_units(workload, statistics.finished_tiles, alpha_max);
    needs
}

impl Needs {
    fn find_depths(&mut self, workload: &Workload, machine: &Config) {
        let work = LaneWork::new(workload, LaneShape::from(machine));
        let mut deep = *machine;
        let set = |config: &mut Config, name: &str, depth: u32| {
            let set = config.set("profile", name, &toml::Value::from(depth));
            set.expect("every depth tried is one that a FIFO can have");
        };
        FIFOS.iter().for_each(|name| set(&mut deep, name, DEEP));
        let best = simulate(workload, &work, &deep);
        self.cycles = best.total;
        let fifos = best.fifos.iter();
        self.fifo_high_water = fifos.map(|(name, fifo)| (*name, fifo.high_water)).collect();
        let allowed = best.total as f64 * (1.0 + SLACK);
        for name in FIFOS {
            let fits = |depth: u32| {
                let mut config = deep;
                set(&mut config, name, depth);
                simulate(workload, &work, &config).total as f64 <= allowed
            };
            let mut depth = DEEP;
            while depth > 1 && fits(depth / 2) {
                depth /= 2;
            }
            self.fifo_depths.insert(name, depth);
        }
    }

    fn judge_units(&mut self, workload: &Workload, tiles: [u64; 2], alpha_max: f64) {
        let [finished_tiles, tiles] = tiles;
        let per_cent = |part: f64| format!("{:.1} %", 100.0 * part);
        let mut judge = |unit, needed: bool, reason: String| {
            let verdict = if needed { "used" } else { "not needed" };
            self.units.insert(unit, format!("{verdict}: {reason}"));
        };
        let (visible, layers) = (self.visible, self.deepest_pixel);
        let splats = workload.splats.len();
        let reason = format!("{visible} of {splats} splats are visible");
        judge("setup", visible > 0, reason);
        let (finished, empty) = (self.finished_part, self.empty_pairs_part);
        let reason = format!("{} of covered pixels had finished", per_cent(finished));
        judge("pixel_termination", finished > 0.0, reason);
        let reason = format!("{finished_tiles} of {tiles} tiles finish");
        judge("tile_termination", finished_tiles > 0, reason);
        let reason = format!("{} of pairs visit no pixel", per_cent(empty));
        judge("exact_binning", empty > 0.0, reason);
        let high = self.peaks.map_or(0.0, |[high, _]| high);
        let reason = format!("largest peak {high:.4}, opacities end at {alpha_max}");
        judge("opacity_clamp", high > alpha_max, reason);
        let reason = format!("at most {layers} layers in a pixel");
        judge("over", layers > 1, reason);
    }
}
