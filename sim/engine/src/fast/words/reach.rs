//! How far the footprint table reaches, so that vectors look nothing up beyond it.

use crate::fast::painter::TableMemory;
use splatline::blend::BlendConstants;
use splatline::draw::cutoff_in_lane;

/// How far a table reaches, in lanes of a design.
#[derive(Clone, Copy, Debug)]
pub struct TableReach {
    intervals: u64,
    /// Bits of the radial index below an interval's number.
    pub rest_bits: u32,
    radial: u8,
    /// Do lanes have 64 bits?
    pub deep: bool,
}

impl TableReach {
    /// Of this table; `None` if an entry exceeds 1, or a constant or the lanes' radial index its format.
    pub fn new(memory: &TableMemory, constants: &BlendConstants, lane_bits: u32) -> Option<Self> {
        let (table, widths) = (memory.table(), &memory.widths);
        let entries = table.entries();
        let deep = lane_bits > 32;
        let fits = entries.iter().all(|entry| *entry <= 1 << widths.weight)
            && u64::from(constants.minimum_transmittance) < 1 << widths.transmittance
            && constants.alpha_max <= 1 << widths.alpha
            && (deep || widths.radial <= 27);
        fits.then_some(TableReach {
            intervals: entries.len().saturating_sub(1) as u64,
            rest_bits: table.rest_bits(),
            radial: widths.radial,
            deep,
        })
    }

    /// One past the largest radial index inside a footprint with this cut-off; `None` if it lies outside the table or
    /// the lanes.
    #[inline(always)]
    pub fn end(&self, cutoff: u32) -> Option<i64> {
        let end = i64::try_from(cutoff_in_lane(cutoff, self.radial)).ok()?;
        let last = end.checked_sub(1)?;
        let fits = (self.deep || end <= i64::from(i32::MAX))
            && (last < 0 || ((last as u64) >> self.rest_bits) < self.intervals);
        fits.then_some(end)
    }
}
