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
use serde::Serialize;
use splatline::format::{Traversal, Widths};

/// Which pixels a machine tests.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Preset {
    /// Name in tables.
    #[serde(rename = "machine")]
    pub name: &'static str,
    /// The paper that it was reimplemented from; `ours` for our own.
    pub source: &'static str,
    /// Design of the kernel whose footprints it draws.
    #[serde(skip)]
    pub design: &'static str,
    /// Which pixels it tests.
    #[serde(skip)]
    pub tested: Tested,
    /// Its operations, if it is not the kernel's integers.
    #[serde(skip)]
    pub float: Option<Operations>,
    /// The machine around it.
    #[serde(skip)]
    pub config: fn() -> Config,
}

/// dx and dy, the quadratic form in five products and two sums, exp as a table with one product and one sum, opacity.
const FORM: Operations = Operations {
    bits: 16,
    pair: [2, 0],
    row: [0, 0],
    tested: [4, 5],
    // exp by a table with a product and a sum; times the opacity; compared with the smallest.
    inside: [2, 2],
    // 1 - alpha, the transmittance, the share; a product and a sum a channel.
    blended: [4, 5],
};

/// Forward differences along a row: its start takes the form.
const DIFFERENCES: Operations = Operations {
    row: [4, 5],
    tested: [3, 0],
    ..FORM
};

/// a dx^2 and 2 b dx for sixteen columns, dy and c dy^2 for a row; a pixel adds and multiplies what is there.
const SHARED_AXES: Operations = Operations {
    pair: [2 + 16, 3 * 16],
    row: [1, 2],
    tested: [3, 1],
    ..FORM
};

/// All machines, ours last.
pub const PRESETS: [Preset; 7] = [
    Preset {
        name: "box-tiles",
        source: "Kerbl et al., 3D Gaussian Splatting for Real-Time Radiance Field Rendering, SIGGRAPH 2023, section 6, in FP16",
        design: "standard24",
        tested: Tested::Tiles,
        float: Some(FORM),
        config: || sixteen(LaneLayout::Aligned),
    },
    Preset {
        name: "sub-tiles",
        source: "Lee et al., GSCore, ASPLOS 2024: sub-tile skipping; the test of a sub-tile is exact here",
        design: "standard24",
        tested: Tested::SubTiles(8),
        float: Some(FORM),
        config: || sixteen(LaneLayout::Aligned),
    },
    Preset {
        name: "row-sequential",
        source: "Ye et al., Gaussian Blending Unit, HPCA 2025: row-sequential shading",
        design: "standard24",
        tested: Tested::Rows,
        float: Some(DIFFERENCES),
        config: || sixteen(LaneLayout::Rows),
    },
    Preset {
        name: "axis-shared",
        source: "axis-oriented rasterization with terms shared along both axes, 2025",
        design: "standard24",
        tested: Tested::Tiles,
        float: Some(SHARED_AXES),
        config: || sixteen(LaneLayout::Aligned),
    },
    Preset {
        name: "primitive-1997",
        source: "Swan et al., IEEE Visualization 1997, section 6: the splat primitive, in the 8 bits of its time",
        design: "classic8",
        tested: Tested::Own,
        float: None,
        config: || sixteen(LaneLayout::Aligned),
    },
    Preset {
        name: "splatline lean18",
        source: "ours",
        design: "lean18",
        tested: Tested::Own,
        float: None,
        config: || Config::primitive(16),
    },
    Preset {
        name: "splatline standard24",
        source: "ours",
        design: "standard24",
        tested: Tested::Own,
        float: None,
        config: || Config::primitive(16),
    },
];

fn sixteen(layout: LaneLayout) -> Config {
    Config {
        lanes: 16,
        layout,
        ..Config::default()
    }
}

/// A machine's work and what it takes.
#[derive(Clone, Debug, Serialize)]
pub struct Outcome {
    /// The machine.
    #[serde(flatten)]
    pub preset: Preset,
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
    let run = |preset: &Preset| {
        let design = DesignChoice::named(preset.design).expect("presets name designs of ours");
        let (widths, traversal) = (&design.widths, design.traversal);
        let own = Options {
            design: &design,
            traversal,
            ..*options
        };
        let config = (preset.config)();
        let tile = [config.tile_width, config.tile_height];
        let workload = extract(scene, camera, &own, tile)?;
        Ok(outcome(preset, &workload, widths, traversal, table))
    };
    PRESETS.iter().map(run).collect()
}

/// The units between setup of a pair and the blend.
const PIXEL_PATH: [&str; 4] = ["splat_setup", "row_generator", "lanes", "blend"];

/// What a machine takes for a workload that our own traversal gave.
pub fn outcome(
    preset: &Preset,
    workload: &Workload,
    widths: &Widths,
    traversal: Traversal,
    table: &EnergyTable,
) -> Outcome {
    let config = (preset.config)();
    let workload = tested(workload, preset.tested);
    let timing = simulate_alone(&workload, &config);
    let mut units = of(widths, traversal, &config, &timing, table);
    if let Some(operations) = &preset.float {
        replace(&mut units, operations, &timing, table);
    }
    let path = units.iter().filter(|unit| PIXEL_PATH.contains(&unit.name));
    let actions = path.flat_map(|unit| &unit.actions);
    let products = actions.filter(|action| action.action == "multiply");
    let products = products.map(|action| action.count).sum();
    Outcome {
        preset: *preset,
        energy: sum(units, &config, &timing, table),
        timing,
        products,
    }
}

/// Puts floating-point units into the places of the kernel's. A pixel has four numbers.
fn replace<'t>(
    units: &mut [UnitActions<'t>],
    operations: &Operations,
    timing: &Timing,
    table: &'t EnergyTable,
) {
    let pixels = &timing.pixels;
    let bits = operations.bits;
    let mut put = |name: &'static str, count: u64, operations: [u64; 2]| {
        let mut unit = UnitActions::new(name, table);
        unit.float(bits, operations, count);
        if let Some(place) = units.iter_mut().find(|unit| unit.name == name) {
            *place = unit;
        }
    };
    put("splat_setup", pixels.pairs, operations.pair);
    put("row_generator", pixels.rows, operations.row);
    put("lanes", pixels.visited, operations.tested);
    put("blend", pixels.live, operations.blended);
    for unit in units {
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
        outcome.preset.name.to_owned(),
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
