//! What no machine goes below on a frame, from counts alone: cycles by splats and pixels, bytes by what must be read
//! and written once.
//!
//! A search asks here before it simulates: what cannot hold the limits even so is left out, and a question that no
//! machine of the space can hold is refused in a second instead of after a search.

use crate::machine::timing::{Bytes, PixelWork, SplatCounts};
use crate::machine::workload::{SurfaceCounts, Workload};
use crate::machine::{Config, Timing};

/// Counts are those of the design that a search starts from. Another one may blend fewer pixels, where its opacities
/// round to 0: this part is counted.
const SAME_WHATEVER_THE_DESIGN: f64 = 0.9;

/// What a frame has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FrameCounts {
    /// Splats of the scene, each of which is read and set up.
    pub splats: u64,
    /// Pixels of footprints that must be blended.
    pub blended: u64,
    /// Pixels of the screen, each of which is written.
    pub pixels: u64,
}

impl FrameCounts {
    /// Of a frame's work.
    pub fn of(workload: &Workload) -> FrameCounts {
        let blended = workload.totals().live as f64 * SAME_WHATEVER_THE_DESIGN;
        let pixels = workload.tiles.iter().map(|tile| u64::from(tile.pixels));
        FrameCounts {
            splats: workload.splats.len() as u64,
            blended: blended as u64,
            pixels: pixels.sum(),
        }
    }

    /// Cycles, bytes and work that a machine cannot do with less of: every splat through setup, every blended pixel
    /// through a lane, every byte over its channel.
    pub fn least_timing(&self, machine: &Config) -> Timing {
        let (splats, blended, pixels) = (self.splats, self.blended, self.pixels);
        let bytes = Bytes {
            splats_read: splats * u64::from(machine.splat_bytes),
            pixels_written: pixels * u64::from(machine.pixel_bytes),
            ..Bytes::default()
        };
        let interval = u64::from(machine.setup_interval);
        let lanes = u64::from(machine.lanes) * u64::from(machine.raster_units);
        let set_up = splats / u64::from(machine.setup_units) * interval;
        let drawn = blended / lanes * u64::from(machine.blend_interval);
        let over_channels = machine.memory_part().is_none();
        let moved = |bytes: u64, per_cycle: u32| {
            if over_channels {
                bytes / u64::from(per_cycle)
            } else {
                0
            }
        };
        let read = moved(bytes.splats_read, machine.read_bandwidth);
        let geometry = set_up.saturating_sub(interval).max(read);
        let raster = drawn.max(moved(bytes.pixels_written, machine.write_bandwidth));
        Timing {
            total: geometry + raster,
            geometry,
            raster,
            splats: SplatCounts {
                fetched: splats,
                ..SplatCounts::default()
            },
            pixels: PixelWork {
                visited: blended,
                covered: blended,
                live: blended,
                ..PixelWork::default()
            },
            bytes,
            surface: (machine.surface_layers > 0).then(SurfaceCounts::default),
            ..Timing::default()
        }
    }
}
