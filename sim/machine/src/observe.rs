//! What a trace sees of a simulation. The default observer sees nothing and costs nothing.

/// A stage of a raster unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Stage {
    /// The packet is read from memory: from request to arrival.
    Fetch,
    /// Splat setup.
    Setup,
    /// Row generator, one event per band.
    Rows,
    /// Pixel lanes, one event per band.
    Lanes,
    /// Table and blend of a band's last group.
    Blend,
    /// Write-back of a tile.
    WriteBack,
}

/// A stage at work on something, from cycle `start` up to `end` of the raster phase.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Event {
    /// Raster unit.
    pub unit: u32,
    /// Stage.
    pub stage: Stage,
    /// Lane with the layout `rows`, else 0.
    pub lane: u32,
    /// Tile.
    pub tile: u32,
    /// Splat; `u32::MAX` for a write-back.
    pub splat: u32,
    /// Row or row pair of the tile; 0 where a stage works on a whole splat or tile.
    pub row: u32,
    /// First cycle.
    pub start: u64,
    /// One past the last cycle.
    pub end: u64,
}

/// Receives events. Within one unit and stage they come in the order of time.
pub trait Observer {
    /// Are events wanted at all?
    const WATCHES: bool;
    /// One event.
    fn event(&mut self, event: Event);
}

/// Sees nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Blind;

impl Observer for Blind {
    const WATCHES: bool = false;
    #[inline(always)]
    fn event(&mut self, _: Event) {}
}

impl Observer for Vec<Event> {
    const WATCHES: bool = true;
    fn event(&mut self, event: Event) {
        self.push(event);
    }
}
