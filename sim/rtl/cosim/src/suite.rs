//! The co-simulation suite: which circuits draw which workloads, in a quick extent for `cargo test` and a full one for the record.

use crate::bench::{Bench, Pauses};
use crate::check::{Findings, compare};
use crate::golden::Golden;
use crate::picture::{self, LIMITS, PictureCycles};
use crate::workload::{self, BenchWorkload, GuitarView};
use anyhow::Result;
use splatline::blend::Pixel;
use splatline::format::{Design, Widths};
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

/// Packets that come late, and nothing else: cycles can still be compared.
pub const LATE: Pauses = Pauses {
    packets: 200,
    lanes: 0,
    pixels: 0,
};

/// Every workload is drawn by each circuit so many times.
pub const PASSES: usize = PASSES_BY_PAUSES.len();

const PASSES_BY_PAUSES: [Pauses; 3] = [
    Pauses {
        packets: 0,
        lanes: 0,
        pixels: 0,
    },
    LATE,
    PAUSES,
];

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
    /// Pauses at the interfaces.
    pub pauses: Pauses,
    /// The comparison.
    pub findings: Findings,
}

/// One picture under the limits of one memory.
#[derive(Clone, Debug)]
pub struct PictureLine {
    /// Design.
    pub design: &'static str,
    /// Lanes.
    pub lanes: usize,
    /// Rules.
    pub rules: &'static str,
    /// Workload.
    pub workload: &'static str,
    /// The memory's limits.
    pub limits: &'static str,
    /// The comparison.
    pub cycles: PictureCycles,
}

/// Footprints for one design under one of the rules.
pub struct Loads {
    /// Name of the design.
    pub design: &'static str,
    /// Name of the rules.
    pub rules_name: &'static str,
    choice: DesignChoice,
    scene_rules: Rules,
    rules: splatline::rules::Rules,
    workloads: Vec<BenchWorkload>,
    /// Workloads left out because their data is missing.
    pub missing: Vec<&'static str>,
}

/// The rules of scenes by name.
fn rules() -> [(&'static str, Rules); 2] {
    [("3dgs", Rules::GAUSSIAN_3D), ("ewa", Rules::EWA)]
}

impl Loads {
    /// Sets all workloads of a design up, for each of the rules.
    pub fn all(design: &'static str, extent: Extent) -> Result<Vec<Loads>> {
        let choice = DesignChoice::named(design).expect("the suite names existing designs");
        Self::all_of(design, &choice, extent)
    }

    /// The same for a design of any widths.
    pub fn all_of(
        design: &'static str,
        choice: &DesignChoice,
        extent: Extent,
    ) -> Result<Vec<Loads>> {
        let of = |rules| Self::of(design, choice.clone(), rules, extent);
        let scenes: Result<Vec<Loads>> = rules().into_iter().map(of).collect();
        let faint = Self::faint(design, choice.clone(), extent);
        Ok(scenes?.into_iter().chain([faint]).collect())
    }

    /// Random packets by rules that skip what is faint inside of a footprint. Those of scenes skip nothing there: `3dgs` ends a footprint where it
    /// becomes faint, and `ewa` draws what is there.
    fn faint(design: &'static str, choice: DesignChoice, extent: Extent) -> Loads {
        let rules = Rules {
            alpha_min: Rules::GAUSSIAN_3D.alpha_min,
            ..Rules::EWA
        };
        let count = match extent {
            Extent::Quick => 600,
            Extent::Full => 20_000,
        };
        Loads {
            design,
            rules_name: "ewa, faint skipped",
            scene_rules: rules,
            rules: kernel_rules(&rules),
            workloads: vec![workload::random(&choice.widths, count, 20, 9)],
            choice,
            missing: Vec::new(),
        }
    }

    /// Sets the workloads of scenes up for one of their rules.
    fn of(
        design: &'static str,
        choice: DesignChoice,
        (rules_name, rules): (&'static str, Rules),
        extent: Extent,
    ) -> Result<Loads> {
        let rules = &rules;
        let widths = choice.widths;
        let full = extent == Extent::Full;
        let (random, size) = if full { (40_000, 512) } else { (1_200, 256) };
        let mut workloads = vec![
            workload::random(&widths, random, 20, 7),
            workload::random(&widths, random / 4, 1, 8),
            workload::vast(&widths, random / 12, 10),
            workload::crowd(&choice, rules),
            workload::sparse(&choice, rules),
            workload::deep_stack(&choice, rules, if full { 128 } else { 64 }),
            workload::hard(&choice, rules)?,
        ];
        let mut missing = Vec::new();
        for (name, load) in [
            (
                "guitar",
                workload::guitar(&choice, rules, GuitarView::Close, size)?,
            ),
            ("lion", workload::lion(&choice, rules, size)?),
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
            scene_rules: *rules,
            rules: kernel_rules(rules),
            workloads,
            missing,
        })
    }

    /// The design's widths.
    pub fn widths(&self) -> &Widths {
        &self.choice.widths
    }

    /// Draws everything by a circuit with so many lanes: as fast as it goes, with packets that come late, with back-pressure everywhere. Lines come as
    /// they are asked for, so that whoever looks for a difference need not wait for the rest.
    pub fn check<'a>(
        &'a self,
        bench: &'a mut Bench,
        lanes: usize,
    ) -> impl Iterator<Item = Line> + 'a {
        let passes = |workload| PASSES_BY_PAUSES.map(|pauses| (workload, pauses));
        let all = self.workloads.iter().flat_map(passes);
        all.map(move |(workload, pauses)| Line {
            design: self.design,
            lanes,
            rules: self.rules_name,
            workload: workload.name,
            pauses,
            findings: self.choice.dispatch(ModelLine {
                bench: &mut *bench,
                lanes,
                rules: &self.rules,
                workload,
                pauses,
            }),
        })
    }

    /// Cycles of whole pictures under the limits of memories, by model and circuit, and the circuit's words against the kernel's.
    pub fn pictures(&self, bench: &mut Bench, lanes: usize) -> Result<Vec<PictureLine>> {
        let mut lines = Vec::new();
        for workload in self.workloads.iter().filter(|load| load.viewport.is_some()) {
            for limits in LIMITS {
                let config = picture::machine(lanes, &limits);
                let model =
                    picture::model_cycles(&self.choice, &self.scene_rules, workload, &config)?;
                let (circuit, pixels) =
                    picture::circuit_cycles(bench, self.widths(), workload, &config, model)?;
                let mismatches = self.choice.dispatch(WordsLine {
                    rules: &self.rules,
                    workload,
                    pixels: &pixels,
                });
                let cycles = PictureCycles {
                    model,
                    circuit,
                    mismatches,
                };
                lines.push(PictureLine {
                    design: self.design,
                    lanes,
                    rules: self.rules_name,
                    workload: workload.name,
                    limits: limits.name,
                    cycles,
                });
            }
        }
        Ok(lines)
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
const QUICK: (usize, usize) = (6_000, 200);

/// Keeps tiles spread over the workload until the limits are reached.
fn shorten(workload: &mut BenchWorkload) {
    let (mut pairs, mut tiles) = (0, Vec::new());
    // A stride coprime to every number of tiles that occurs visits them all, far apart from each other.
    let count = workload.tiles.len();
    for i in 0..count.min(QUICK.1) {
        let tile = &workload.tiles[i * 37 % count];
        if tiles.is_empty() || pairs + tile.list.len() <= QUICK.0 {
            pairs += tile.list.len();
            tiles.push(tile.clone());
        }
    }
    if tiles.len() < count {
        workload.viewport = None;
    }
    workload.tiles = tiles;
}

struct ModelLine<'a> {
    bench: &'a mut Bench,
    lanes: usize,
    rules: &'a splatline::rules::Rules,
    workload: &'a BenchWorkload,
    pauses: Pauses,
}

impl DesignJob for ModelLine<'_> {
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

/// The words of a picture's tiles against the kernel's: how many pixels differ.
struct WordsLine<'a> {
    rules: &'a splatline::rules::Rules,
    workload: &'a BenchWorkload,
    pixels: &'a [Vec<Pixel>],
}

impl DesignJob for WordsLine<'_> {
    type Output = u64;

    fn run<D: Design + Send + Sync>(self, design: D) -> u64 {
        let golden = Golden::new(design, self.rules);
        let mut mismatches = 0;
        for (tile, got) in self.workload.tiles.iter().zip(self.pixels) {
            let expected = golden.draw(tile, &self.workload.footprints).0;
            let pairs = got.iter().zip(&expected);
            mismatches += pairs.filter(|(got, expected)| got != expected).count() as u64;
        }
        mismatches
    }
}
