//! Energy of a picture on a machine: the actions that the accounts count, times a table of picojoules.
//!
//! Energies are whole attojoules from the single action on, so that what units take is the sum of their actions, and
//! what the picture takes the sum of its units, exactly and in any order. It is an estimate: the table's figures are
//! the literature's for a single operation, and clock tree, pipeline registers, control, wires and leakage are not in
//! it. See `docs/hardware-model.md`.

mod accelergy;
pub(crate) mod actions;
mod table;

pub use accelergy::action_counts;
pub use actions::Action;
pub use table::{EnergyTable, SHIPPED};

use super::area::lane::FloatLane;
use super::config::Config;
use super::timing::Timing;
use serde::Serialize;
use splatline::format::{Traversal, Widths};
use std::fmt::Write;

/// Attojoules of a millijoule.
const MILLI: f64 = 1e15;
/// Attojoules of a picojoule.
const PICO: f64 = 1e6;

/// One unit's energy.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct UnitEnergy {
    /// The unit.
    pub unit: &'static str,
    /// Sum over its actions.
    pub attojoules: u64,
    /// Of this, actions of the memory outside the chip.
    pub dram_attojoules: u64,
    /// What it did.
    pub actions: Vec<Action>,
}

/// A picture's energy.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Energy {
    /// What kind of number this is, and what it leaves out.
    pub of: String,
    /// Sum over all units.
    pub attojoules: u64,
    /// The same in mJ a picture.
    pub mj_per_frame: f64,
    /// pJ for each pixel of the screen.
    pub pj_per_pixel: f64,
    /// pJ for each splat of the scene.
    pub pj_per_splat: f64,
    /// pJ for each pixel of a footprint that was blended.
    pub pj_per_blend: f64,
    /// All units in the order of the data.
    pub units: Vec<UnitEnergy>,
}

/// Energy of a picture that took `timing` on a machine that carries a design, with the arithmetic of its lanes in
/// floating point if a lane is given.
pub fn estimate(
    lane: Option<&FloatLane>,
    widths: &Widths,
    traversal: Traversal,
    config: &Config,
    timing: &Timing,
    table: &EnergyTable,
) -> Energy {
    let mut units = actions::of(widths, traversal, config, timing, table);
    if let Some(lane) = lane {
        actions::put_lane(&mut units, lane, config, timing);
    }
    sum(units, config, timing, table)
}

/// Picojoules of a lane's arithmetic and its pixel's words for one pixel that is visited, covered and blended.
pub fn of_pixel(lane: Option<&FloatLane>, widths: &Widths, table: &EnergyTable) -> f64 {
    let (config, mut timing) = (Config::default(), Timing::default());
    let pixels = &mut timing.pixels;
    (pixels.visited, pixels.covered, pixels.live) = (1, 1, 1);
    let energy = estimate(lane, widths, Traversal::Spans, &config, &timing, table);
    let mut units = energy.units.iter();
    let of_lane = |unit: &&UnitEnergy| ["lanes", "blend"].contains(&unit.unit);
    total(units.by_ref().filter(of_lane).map(|unit| unit.attojoules)) as f64 / PICO
}

/// Adds up units. Sums stay at the largest number of 64 bits, which is 18 J a picture.
pub(crate) fn sum(
    units: Vec<actions::UnitActions>,
    config: &Config,
    timing: &Timing,
    table: &EnergyTable,
) -> Energy {
    let units: Vec<UnitEnergy> = units.into_iter().map(UnitEnergy::new).collect();
    let attojoules = total(units.iter().map(|unit| unit.attojoules));
    let per = |count: u64| attojoules as f64 / PICO / count.max(1) as f64;
    Energy {
        of: table.statement(),
        attojoules,
        mj_per_frame: attojoules as f64 / MILLI,
        pj_per_pixel: per(timing.bytes.pixels_written / u64::from(config.pixel_bytes)),
        pj_per_splat: per(timing.splats.fetched),
        pj_per_blend: per(timing.pixels.live),
        units,
    }
}

fn total(energies: impl Iterator<Item = u64>) -> u64 {
    energies.fold(0, u64::saturating_add)
}

impl Action {
    /// Of all of them.
    pub fn attojoules(&self) -> u64 {
        self.count.saturating_mul(self.attojoules_each)
    }
}

impl UnitEnergy {
    fn new(unit: actions::UnitActions) -> UnitEnergy {
        let of_dram = |action: &&Action| action.component == "dram";
        UnitEnergy {
            unit: unit.name,
            attojoules: total(unit.actions.iter().map(Action::attojoules)),
            dram_attojoules: total(unit.actions.iter().filter(of_dram).map(Action::attojoules)),
            actions: unit.actions,
        }
    }
}

impl Energy {
    /// A table for people.
    pub fn text(&self) -> String {
        let mut text = format!(
            "energy: {:.4} mJ a frame, {:.1} pJ a pixel of the screen, {:.1} pJ a splat, {:.1} pJ a blended pixel\n",
            self.mj_per_frame, self.pj_per_pixel, self.pj_per_splat, self.pj_per_blend
        );
        for unit in &self.units {
            let share = 100.0 * unit.attojoules as f64 / self.attojoules.max(1) as f64;
            // Writing to a String cannot fail.
            let _ = writeln!(
                text,
                "  {:<14} {:>10.4} mJ {share:>6.2} %  of this DRAM {:.4} mJ",
                unit.unit,
                unit.attojoules as f64 / MILLI,
                unit.dram_attojoules as f64 / MILLI
            );
        }
        let _ = writeln!(text, "  {}", self.of);
        text
    }
}

#[cfg(test)]
mod tests;
