//! What the engines hand to the commands, the same for all engines.

use crate::picture::Picture;
use crate::report::facts::Counts;
use crate::report::{HostTimes, Pixels};
use splatline::footprint::Footprint;
use splatline::setup::Cull;

/// One drawn picture and what drawing it took.
#[derive(Clone, Debug)]
pub struct Drawing {
    /// The picture.
    pub picture: Picture,
    /// Splats that were not drawn, by reason.
    pub culled: Counts,
    /// Splats of which a value was clamped to the kernel's formats; they are drawn.
    pub clamped: u64,
    /// Unit of the kernel's colours as a power of two.
    pub colour_log2: i32,
    /// Work of the rasterizer; nothing for engines that do not count it.
    pub pixels: Option<Pixels>,
    /// Seconds of this run, as the engine divides them; an engine that does not tell stages apart leaves them 0. The
    /// total is measured around the engine by [`super::sweep::measure`].
    pub stages: HostTimes,
    /// Setup's results in the scene's order, for a machine to be timed on; empty for engines that no machine is modelled for.
    pub footprints: Vec<Result<Footprint, Cull>>,
}

/// Where one splat lands. Pixels; the conic is that of the radial index `r = a dx^2 + 2 b dx dy + c dy^2`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FootprintLine {
    /// Centre.
    pub centre: [f64; 2],
    /// Depth along the view.
    pub depth: f64,
    /// a, b, c.
    pub conic: [f64; 3],
    /// x0, y0, x1, y1: first pixel inside, first pixel beyond.
    pub bounds: [usize; 4],
    /// Radial index at which the footprint ends.
    pub cutoff: f64,
}
