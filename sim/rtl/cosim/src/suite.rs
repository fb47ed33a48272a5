//! The co-simulation suite: which circuits draw which workloads, in a quick extent for `cargo test` and a full one for the record.

use crate::bench::{Bench, Pauses};
use crate::check::{Findings, compare};
use crate::workload::{self, GuitarView, Workload};
use anyhow::Result;
use splatline::format::Design;
use splatline_sim::design::{DesignChoice, DesignJob};
use splatline_sim::fixed::kernel_rules;
use splatline_sim::rules::Rules;

/// The designs that the circuit is generated for.
pub const DESIGNS: [&str; 2] = ["lean18", "standard24"];

/// The numbers of lanes that are verilated.
pub const LANES: [usize; 2] = [1, 4];

/// Back-pressure at every interface, in 256ths of the cycles.
pub const PAUSES: Pauses = Pauses {
    packets: 80,
    lanes: 60,
    pixels: 90,
};

/// How much is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extent {
    /// Some tiles of each workload: seconds.
    Quick,
    /// All tiles: at least ten million pixels for each circuit and each of the rules.
    Full,
}

/// One line of the suite's result.
#[derive(Clone, Debug)]
pub struct Line {
    /// Design.
    pub design: &'static str,
    /// Lanes.
    pub lanes: usize,
    /// Rules.
    pub rules: &'static str,
    /// Workload.
    pub workload: &'static str,
    /// Was there back-pressure?
    pub paused: bool,
    /// The comparison.
    pub findings: Findings,
}

/// Footprints for one design under one of the rules.
pub struct Loads {
    /// Name of the design.
    pub design: &'static str,
    /// Name of the rules.
    pub rules_name: &'static str,
    choice: DesignChoice,
    rules: splatline::rules::Rules,
    workloads: Vec<Workload>,
    /// Workloads left out because their data is missing.
    pub missing: Vec<&'static str>,
}

/// The rules by name.
pub fn rules() -> [(&'static str, Rules); 2] {
    [("3dgs", Rules::GAUSSIAN_3D), ("ewa", Rules::EWA)]
}

impl Loads {
    /// Sets all workloads up.
    pub fn new(
        design: &'static str,
        rules_name: &'static str,
        rules: &Rules,
        extent: Extent,
    ) -> Result<Loads> {
        let choice = DesignChoice::named(design).expect("the suite names existing designs");
        let widths = choice.widths;
        let full = extent == Extent::Full;
        let (random, size) = if full { (40_000, 512) } else { (1_200, 256) };
        let mut workloads = vec![
            workload::random(&widths, random, 20, 7),
            workload::random(&widths, random / 4, 1, 8),
            workload::deep_stack(&choice, rules, if full { 128 } else { 64 }),
        ];
        let mut missing = Vec::new();
        for (name, load) in [
            ("hard", workload::hard(&choice, rules)?),
            (
                "guitar",
                workload::guitar(&choice, rules, GuitarView::Close, size)?,
            ),
        ] {
            match load {
                Some(load) => workloads.push(load),
                None => missing.push(name),
            }
        }
        if !full {
            workloads.iter_mut().for_each(shorten);
        }
        Ok(Loads {
            design,
            rules_name,
            choice,
            rules: kernel_rules(rules),
            workloads,
            missing,
        })
    }

    /// Draws everything by a circuit with so many lanes, once as fast as it goes and once with back-pressure.
    pub fn check(&self, bench: &mut Bench, lanes: usize) -> Vec<Line> {
        let mut lines = Vec::new();
        for workload in &self.workloads {
            for pauses in [Pauses::default(), PAUSES] {
                let findings = self.choice.dispatch(Comparison {
                    bench,
                    lanes,
                    rules: &self.rules,
                    workload,
                    pauses,
                });
                lines.push(Line {
                    design: self.design,
                    lanes,
                    rules: self.rules_name,
                    workload: workload.name,
                    paused: pauses != Pauses::default(),
                    findings,
                });
            }
        }
        lines
    }

    /// The circuit that these loads are for.
    pub fn bench(&self, lanes: usize) -> Result<Bench> {
        Ok(Bench::new(
            self.design,
            &self.choice.widths,
            lanes,
            &self.rules,
            1,
        )?)
    }

    /// The same bench around a circuit from elsewhere.
    pub fn bench_around(&self, model: crate::model::Model) -> Bench {
        Bench::around(model, &self.choice.widths, &self.rules, 1)
    }
}

/// The quick extent's limits: pairs of splat and tile, tiles.
const QUICK: (usize, usize) = (9_000, 300);

/// Keeps tiles spread over the workload until the limits are reached.
fn shorten(workload: &mut Workload) {
    let (mut pairs, mut tiles) = (0, Vec::new());
    // A stride coprime to every number of tiles that occurs visits them all, far apart from each other.
    let count = workload.tiles.len();
    for i in 0..count.min(QUICK.1) {
        let tile = &workload.tiles[i * 37 % count];
        if pairs + tile.list.len() <= QUICK.0 {
            pairs += tile.list.len();
            tiles.push(tile.clone());
        }
    }
    workload.tiles = tiles;
}

struct Comparison<'a> {
    bench: &'a mut Bench,
    lanes: usize,
    rules: &'a splatline::rules::Rules,
    workload: &'a Workload,
    pauses: Pauses,
}

impl DesignJob for Comparison<'_> {
    type Output = Findings;

    fn run<D: Design + Send + Sync>(self, design: D) -> Findings {
        let tiles = 0..self.workload.tiles.len();
        compare(
            self.bench,
            design,
            self.lanes,
            self.rules,
            self.workload,
            tiles,
            self.pauses,
        )
    }
}
