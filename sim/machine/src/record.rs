//! What a picture takes on a machine that carries a design, as one record: cycles, throughput, area, energy, and how
//! the work is spread.
//!
//! ```text
//! workload, machine -> timing -> throughput, energy \
//! widths, machine, prices -> area ------------------- PictureRecord
//! ```

use super::area::{self, Calibration, Fabric, synthesis};
use super::clock::{Clock, Throughput};
use super::config::Config;
use super::energy::{self, Energy, EnergyTable};
use super::histogram::Histograms;
use super::lanes::{LaneShape, LaneWork};
use super::parts::Part;
use super::summary;
use super::timing::{Timing, simulate};
use super::workload::Workload;
use serde::Serialize;
use splatline::format::{Traversal, Widths};
use std::time::Instant;

/// What area, clock and energy are counted by.
#[derive(Debug)]
pub struct Prices {
    /// Area.
    pub calibration: Calibration,
    /// The part that it should fit, by its name.
    pub part: Option<(String, Part)>,
    /// Energy.
    pub energy: EnergyTable,
}

/// A machine with a design, and what its costs are counted by.
#[derive(Clone, Copy, Debug)]
pub struct CostedMachine<'a> {
    /// Widths of the design.
    pub widths: &'a Widths,
    /// How it finds a splat's pixels.
    pub traversal: Traversal,
    /// The machine.
    pub config: &'a Config,
    /// The prices.
    pub prices: &'a Prices,
}

/// Area, and how it was counted.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AreaRecord {
    /// The raster units.
    pub raster: Fabric,
    /// Geometry setup and queues around them.
    pub around: Fabric,
    /// All of it as one number.
    pub luts_in_all: f64,
    /// What kind of estimate it is.
    pub of: String,
    /// The part that it should fit.
    pub part: Option<Part>,
}

/// Speed of the simulation itself.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct HostSpeed {
    /// Seconds of the simulation.
    pub simulation_s: f64,
    /// Simulated cycles in a second.
    pub cycles_per_s: f64,
}

/// One picture.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PictureRecord {
    /// Which picture.
    pub scene: String,
    /// Splats of the scene.
    pub splats: usize,
    /// Splats that are not culled.
    pub visible: usize,
    /// Cycles and accounts.
    pub cycles: Timing,
    /// Pictures a second.
    pub pace: Throughput,
    /// Area.
    pub area: AreaRecord,
    /// Energy.
    pub energy: Energy,
    /// How work is spread over tiles and splats.
    pub histograms: Histograms,
    /// Speed of the simulation.
    pub host: HostSpeed,
}

impl CostedMachine<'_> {
    /// Frames a second for this timing.
    pub fn throughput(&self, timing: &Timing) -> Throughput {
        let clock = Clock::of(self.config, self.widths, self.prices.calibration.family);
        Throughput::new(timing, self.config, clock)
    }

    /// Area.
    pub fn area(&self) -> AreaRecord {
        let prices = &self.prices.calibration;
        let area = area::estimate(self.widths, self.traversal, self.config, prices);
        AreaRecord {
            raster: area.raster,
            around: area.around,
            luts_in_all: area.weight,
            of: synthesis::statement_of(prices, self.config),
            part: self.prices.part.as_ref().map(|(_, part)| part.clone()),
        }
    }

    /// Energy of a picture with this timing.
    pub fn energy(&self, timing: &Timing) -> Energy {
        let (config, table) = (self.config, &self.prices.energy);
        energy::estimate(None, self.widths, self.traversal, config, timing, table)
    }

    /// The area in words, and how much of the part it takes if there is one; the memory's channels could move so many
    /// bytes a second.
    pub fn area_text(&self, record: &AreaRecord, channel_bytes_per_s: f64) -> String {
        let (raster, around, of) = (record.raster, record.around, &record.of);
        let part = self.prices.part.as_ref();
        let part = part.map(|(name, part)| part.text(name, raster + around, channel_bytes_per_s));
        let part = part.unwrap_or_default();
        format!("area: raster units {raster}; around them {around}\n{of}\n{part}")
    }

    /// Simulates a picture, and counts all of it.
    pub fn picture(&self, scene: &str, workload: &Workload) -> PictureRecord {
        let work = LaneWork::new(workload, LaneShape::from(self.config));
        let started = Instant::now();
        let cycles = simulate(workload, &work, self.config);
        let simulation_s = started.elapsed().as_secs_f64();
        PictureRecord {
            scene: scene.to_owned(),
            splats: workload.splats.len(),
            visible: workload.visible(),
            pace: self.throughput(&cycles),
            area: self.area(),
            energy: self.energy(&cycles),
            histograms: Histograms::new(&work, self.config, workload.splats.len()),
            host: HostSpeed {
                simulation_s,
                cycles_per_s: cycles.total as f64 / simulation_s,
            },
            cycles,
        }
    }

    /// The record for people.
    pub fn text(&self, record: &PictureRecord) -> String {
        let host = record.host;
        format!(
            "{}{}{}{}host: {:.1} ms for {} cycles: {:.0} million simulated cycles per second on one core\n",
            summary::text(&record.scene, &record.cycles),
            record.pace.text(),
            self.area_text(&record.area, record.pace.channel_bytes_per_s),
            record.energy.text(),
            host.simulation_s * 1e3,
            record.cycles.total,
            host.cycles_per_s / 1e6,
        )
    }
}
