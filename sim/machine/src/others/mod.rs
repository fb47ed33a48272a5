//! Machines of others, reimplemented from their papers, on the same splats beside ours.
//!
//! What distinguishes them is which pixels of a tile they test for a splat, and what a test costs. Everything else
//! (geometry, sort, memory, order, sixteen lanes) is the same for all, so that a line of the table differs from the
//! next in that alone. They are our reading of the papers and not their authors' designs: cycles follow from the pixels
//! tested, not from a description of their pipelines.
//!
//! | preset | which pixels are tested | what a test takes |
//! |---|---|---|
//! | `box-tiles` | all 256 of every tile that the box meets | the quadratic form, exp, opacity; FP16 |
//! | `sub-tiles` | those of the 8 x 8 sub-tiles that the footprint meets | the same |
//! | `row-sequential` | each row from its first to its last pixel inside, and one more | two additions, exp, opacity; FP16 |
//! | `axis-shared` | as `box-tiles` | one product and two additions; the terms of rows and columns once for each |
//! | `primitive-1997` | the footprint's box | two additions of integers, a table; 8 bits |

mod pixels;
#[cfg(test)]
mod tests;

pub use pixels::tested;

use super::config::{Config, LaneLayout};
use super::energy::actions::{UnitActions, of};
use super::energy::{Energy, EnergyTable, sum};
use super::timing::{Timing, simulate_alone};
use super::workload::{Workload, extract};
use crate::camera::Camera;
use crate::design::DesignChoice;
use crate::fixed::Options;
use crate::host_memory::TooLarge;
use crate::scene::Scene;
use serde::{Deserialize, Serialize};
use std::sync::LazyLock;

/// Which pixels a machine tests.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Tested {
    /// Those that the design's own traversal visits.
    Own,
    /// All of a tile.
    Tiles,
    /// Squares of so many pixels a side, where the footprint meets them.
    SubTiles(u32),
    /// A row from its first to its last pixel inside, and the one that tells it is over.
    Rows,
}

/// Operations in floating point of so many bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Operations {
    /// Bits of a number.
    pub bits: u64,
    /// Additions and products of a pair, of a row of a pair, of a pixel tested, of one inside the cut-off, of one
    /// blended.
    pub pair: [u64; 2],
    /// See `pair`.
    pub row: [u64; 2],
    /// See `pair`.
    pub tested: [u64; 2],
    /// See `pair`.
    pub inside: [u64; 2],
    /// See `pair`.
    pub blended: [u64; 2],
}

/// A machine.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Preset {
    /// Name in tables.
    #[serde(rename = "machine")]
    pub name: String,
    /// The paper that it was reimplemented from; `ours` for our own.
    pub source: String,
    #[serde(skip_serializing)]
    design: String,
    /// Which pixels it tests.
    #[serde(skip_serializing)]
    pub tested: Tested,
    /// Its operations, if it is not the kernel's integers.
    #[serde(skip_serializing)]
    pub float: Option<Operations>,
    /// How its sixteen lanes lie, if they are not those of the splat primitive.
    #[serde(skip_serializing)]
    layout: Option<LaneLayout>,
}

impl Preset {
    /// The design of the kernel whose footprints it draws.
    pub fn design(&self) -> DesignChoice {
        DesignChoice::named(&self.design).expect("presets name designs of ours")
    }

    /// The machine around it.
    pub fn config(&self) -> Config {
        let lanes = 16;
        match self.layout {
            Some(layout) => Config {
                lanes,
                layout,
                ..Config::default()
            },
            None => Config::primitive(lanes),
        }
    }
}

#[derive(Deserialize)]
struct Presets {
    machine: Vec<Preset>,
}

/// All machines, ours last.
pub static PRESETS: LazyLock<Vec<Preset>> = LazyLock::new(|| {
    let presets: Presets = toml::from_str(include_str!("presets.toml")).expect("machines");
    presets.machine
});

/// A machine's work and what it takes.
#[derive(Clone, Debug, Serialize)]
pub struct Outcome {
    /// The machine.
    #[serde(flatten)]
    pub preset: &'static Preset,
    /// Cycles, bytes, pixels.
    #[serde(rename = "cycles")]
    pub timing: Timing,
    /// Its energy.
    pub energy: Energy,
    /// Products a picture, from setup of a pair to the blend; in its own numbers.
    pub products: u64,
}

/// Runs all machines on the same splats, each with its own design in place of that of the options.
pub fn run_all(
    scene: &Scene,
    camera: &Camera,
    options: &Options,
    table: &EnergyTable,
) -> Result<Vec<Outcome>, TooLarge> {
    let run = |preset: &'static Preset| {
        let design = preset.design();
        let own = Options {
            design: &design,
            traversal: design.traversal,
            ..*options
        };
        let config = preset.config();
        let tile = [config.tile_width, config.tile_height];
        let workload = extract(scene, camera, &own, tile)?;
        Ok(outcome(preset, &workload, table))
    };
    PRESETS.iter().map(run).collect()
}

/// The units between setup of a pair and the blend.
const PIXEL_PATH: [&str; 4] = ["splat_setup", "row_generator", "lanes", "blend"];

/// What a machine takes for a workload that our own traversal gave.
pub fn outcome(preset: &'static Preset, workload: &Workload, table: &EnergyTable) -> Outcome {
    let (design, config) = (preset.design(), preset.config());
    let workload = tested(workload, preset.tested);
    let timing = simulate_alone(&workload, &config);
    let mut units = of(&design.widths, design.traversal, &config, &timing, table);
    if let Some(operations) = &preset.float {
        replace(&mut units, operations, &timing);
    }
    let path = units.iter().filter(|unit| PIXEL_PATH.contains(&unit.name));
    let actions = path.flat_map(|unit| &unit.actions);
    let products = actions.filter(|action| action.action == "multiply");
    let products = products.map(|action| action.count).sum();
    Outcome {
        preset,
        energy: sum(units, &config, &timing, table),
        timing,
        products,
    }
}

/// Puts floating-point units into the places of the kernel's. A pixel has four numbers.
fn replace(units: &mut [UnitActions], operations: &Operations, timing: &Timing) {
    let (pixels, bits) = (&timing.pixels, operations.bits);
    for unit in units {
        let (count, own) = match unit.name {
            "splat_setup" => (pixels.pairs, operations.pair),
            "row_generator" => (pixels.rows, operations.row),
            "lanes" => (pixels.visited, operations.tested),
            "blend" => (pixels.live, operations.blended),
            _ => continue,
        };
        unit.actions.clear();
        unit.float(bits, own, count);
        match unit.name {
            "lanes" => {
                unit.float(bits, operations.inside, pixels.covered);
                unit.memory("table", 256, 2 * bits, [pixels.covered, 0]);
            }
            "blend" => unit.memory("tile_buffer", 16, 4 * bits, [pixels.covered, pixels.live]),
            _ => {}
        }
    }
}

/// An outcome's cells in a table; ratios are to the pixels that were blended.
pub fn cells(outcome: &Outcome) -> [String; 11] {
    let Timing { pixels, bytes, .. } = &outcome.timing;
    let blended = pixels.live.max(1) as f64;
    let units = outcome.energy.units.iter();
    let path = units.filter(|unit| PIXEL_PATH.contains(&unit.unit));
    let path: u64 = path.map(|unit| unit.attojoules).sum();
    [
        outcome.preset.name.clone(),
        pixels.visited.to_string(),
        pixels.covered.to_string(),
        pixels.live.to_string(),
        format!("{:.2}", pixels.visited as f64 / blended),
        format!("{:.2}", outcome.products as f64 / blended),
        outcome.timing.total.to_string(),
        outcome.timing.raster.to_string(),
        format!("{:.2}", bytes.all() as f64 / 1e6),
        format!("{:.3}", outcome.energy.mj_per_frame),
        format!("{:.3}", path as f64 / 1e15),
    ]
}

/// A Markdown table.
pub fn table_of(outcomes: &[Outcome]) -> String {
    let mut text = String::from(
        "| machine | pixels tested | inside | blended | tested for one blended | products for one blended | cycles | raster cycles | MB | mJ | of this pixel path, mJ |\n\
         |---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n",
    );
    for outcome in outcomes {
        text.push_str(&format!("| {} |\n", cells(outcome).join(" | ")));
    }
    text
}

/// What must be said beside the table.
pub fn note() -> String {
    let mut text = String::from(
        "Machines other than ours are reimplemented from the paper, not their authors' designs: sixteen lanes each, geometry, sort and memory as ours, cycles from \
         the pixels tested. Energy is an estimate.\n\n",
    );
    for preset in PRESETS.iter().filter(|preset| preset.source != "ours") {
        text.push_str(&format!("- `{}`: {}\n", preset.name, preset.source));
    }
    text
}
