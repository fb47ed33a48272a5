//! A timing as a table for people.

use super::timing::Timing;
use std::fmt::Write;

/// Phases, accounts, FIFOs, bytes and pixels. Every account adds up to instances x total.
pub fn text(name: &str, timing: &Timing) -> String {
    let mut text = String::new();
    // Writing to a String cannot fail.
    let _ = writeln!(
        text,
        "{name}: {} cycles = geometry {} + sort {} + raster {}",
        timing.total, timing.geometry, timing.sort, timing.raster
    );
    let _ = writeln!(
        text,
        "{:<14} {:>5} {:>12} {:>7} {:>12} {:>12}  stalled by",
        "unit", "count", "busy", "busy %", "stalled", "idle"
    );
    for (unit, time) in &timing.units {
        let causes: Vec<String> = time
            .stalled
            .iter()
            .map(|(cause, cycles)| format!("{cause} {cycles}"))
            .collect();
        let _ = writeln!(
            text,
            "{unit:<14} {:>5} {:>12} {:>7.2} {:>12} {:>12}  {}",
            time.instances,
            time.busy,
            time.utilisation * 100.0,
            time.stalled_sum(),
            time.idle,
            causes.join(", ")
        );
    }
    let fifos: Vec<String> = timing
        .fifos
        .iter()
        .map(|(fifo, entry)| format!("{fifo} {}/{}", entry.high_water, entry.depth))
        .collect();
    let _ = writeln!(text, "FIFOs, fullest/depth: {}", fifos.join(", "));
    let bytes = &timing.bytes;
    let _ = writeln!(
        text,
        "bytes: splats read {}, harmonics {}, packets written {}, sorted {}, packets read {} (in vain {}), pixels written {}",
        bytes.splats_read,
        bytes.harmonics_read,
        bytes.packets_written,
        bytes.sort_moved,
        bytes.packets_read,
        bytes.packets_in_vain,
        bytes.pixels_written
    );
    if let Some(memory) = &timing.memory {
        let c = &memory.counts;
        let _ = writeln!(
            text,
            "memory {}: {} bursts read, {} written, {} bytes moved of {} at peak ({:.1} %); rows: {} hits, {} misses, {} conflicts; {} refreshes, {} turns of the bus",
            memory.part,
            c.reads,
            c.writes,
            memory.bytes_moved,
            memory.bytes_at_peak,
            100.0 * memory.bytes_moved as f64 / memory.bytes_at_peak.max(1) as f64,
            c.row_hits,
            c.row_misses,
            c.row_conflicts,
            c.refreshes,
            c.turnarounds
        );
    }
    let pixels = &timing.pixels;
    let _ = writeln!(
        text,
        "work: {} pairs ({} left out), {} rows, {} groups ({} skipped), {} slots, {} visited, {} covered, {} live",
        pixels.pairs,
        pixels.pairs_left_out,
        pixels.rows,
        pixels.groups,
        pixels.groups_skipped,
        pixels.slots,
        pixels.visited,
        pixels.covered,
        pixels.live
    );
    let _ = writeln!(
        text,
        "per raster cycle and lane: {:.4} covered, {:.4} live",
        pixels.covered_per_cycle_and_lane, pixels.live_per_cycle_and_lane
    );
    text
}
