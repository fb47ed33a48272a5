//! A timing as a table for people, and several of them as worst, 95th percentile and mean.

use super::clock::Throughput;
use super::memory::MemoryFacts;
use super::memory::dram::DramCounts;
use super::timing::Timing;
use serde::Serialize;
use std::fmt::Write;

/// Of several values, more being worse.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Spread {
    /// The largest.
    pub worst: f64,
    /// The smallest that 95 of 100 values do not exceed.
    pub percentile_95: f64,
    /// Their mean.
    pub mean: f64,
}

impl Spread {
    /// Of these values; of none, 0.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Spread {
        let mut sorted: Vec<f64> = values.into_iter().collect();
        sorted.sort_by(f64::total_cmp);
        let count = sorted.len();
        let rank = (count * 95).div_ceil(100).max(1) - 1;
        let value = |place: usize| sorted.get(place).copied().unwrap_or(0.0);
        Spread {
            worst: value(count.saturating_sub(1)),
            percentile_95: value(rank),
            mean: sorted.iter().sum::<f64>() / count.max(1) as f64,
        }
    }
}

/// The pace of many frames.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OverFrames {
    /// How many.
    pub frames: usize,
    /// The slowest one's name.
    pub worst_frame: String,
    /// Milliseconds a frame.
    pub ms_per_frame: Spread,
    /// Cycles a frame.
    pub cycles_per_frame: Spread,
    /// Bytes a frame.
    pub bytes_per_frame: Spread,
    /// Pictures a second if every frame took as long as the worst.
    pub frames_per_s_at_worst: f64,
}

impl OverFrames {
    /// Over frames with their names; `named` must not be empty.
    pub fn new(named: &[(&str, &Throughput)]) -> OverFrames {
        let over = |of: fn(&Throughput) -> f64| Spread::of(named.iter().map(|(_, pace)| of(pace)));
        let slower = named
            .iter()
            .max_by(|a, b| a.1.ms_per_frame.total_cmp(&b.1.ms_per_frame));
        let ms_per_frame = over(|pace| pace.ms_per_frame);
        OverFrames {
            frames: named.len(),
            worst_frame: slower.map_or(String::new(), |(name, _)| (*name).to_owned()),
            ms_per_frame,
            cycles_per_frame: over(|pace| pace.cycles_per_frame as f64),
            bytes_per_frame: over(|pace| pace.bytes_per_frame as f64),
            frames_per_s_at_worst: 1e3 / ms_per_frame.worst,
        }
    }

    /// For people.
    pub fn text(&self) -> String {
        let line = |name: &str, spread: &Spread, unit: f64| {
            let values = [spread.worst, spread.percentile_95, spread.mean];
            let [worst, p95, mean] = values.map(|value| value / unit);
            format!("{name:<20} {worst:>12.3} {p95:>12.3} {mean:>12.3}\n")
        };
        format!(
            "{} frames, the worst is {} ({:.2} frames a second)\n{:<20} {:>12} {:>12} {:>12}\n{}{}{}",
            self.frames,
            self.worst_frame,
            self.frames_per_s_at_worst,
            "",
            "worst",
            "95 %",
            "mean",
            line("ms a frame", &self.ms_per_frame, 1.0),
            line("Mcycles a frame", &self.cycles_per_frame, 1e6),
            line("MB a frame", &self.bytes_per_frame, 1e6),
        )
    }
}

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
        let causes = time.stalled.iter();
        let causes = causes.map(|(cause, cycles)| format!("{cause} {cycles}"));
        let causes: Vec<String> = causes.collect();
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
    let fifos = timing.fifos.iter();
    let fifos = fifos.map(|(name, fifo)| format!("{name} {}/{}", fifo.high_water, fifo.depth));
    let fifos: Vec<String> = fifos.collect();
    let _ = writeln!(text, "FIFOs, fullest/depth: {}", fifos.join(", "));
    let bytes = &timing.bytes;
    let _ = writeln!(
        text,
        "bytes: splats read {}, harmonics {}, packets written {}, sorted {}, packets read {} (discarded {}), found in caches {} ({:.1} % of look-ups), pixels written {}",
        bytes.splats_read,
        bytes.harmonics_read,
        bytes.packets_written,
        bytes.sort_moved,
        bytes.packets_read,
        bytes.packets_discarded,
        bytes.packets_cached,
        100.0 * timing.pixels.packet_hit_rate(),
        bytes.pixels_written
    );
    if let Some(memory) = &timing.memory {
        text += &memory_line(memory);
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
    if let Some(work) = &timing.surface {
        let _ = writeln!(
            text,
            "surface unit (estimate): {} samples = {} begun + {} accumulated + {} discarded; {} merges, {} fragments normalised, in {} pixels",
            work.samples,
            work.begun,
            work.accumulated,
            work.discarded,
            work.merges,
            work.fragments,
            work.pixels
        );
    }
    let _ = writeln!(
        text,
        "per raster cycle and lane: {:.4} covered, {:.4} live",
        pixels.covered_per_cycle_and_lane, pixels.live_per_cycle_and_lane
    );
    text
}

/// What a memory part did.
fn memory_line(memory: &MemoryFacts) -> String {
    let DramCounts {
        reads,
        writes,
        row_hits,
        row_misses,
        row_conflicts,
        refreshes,
        turnarounds,
    } = memory.counts;
    let (part, moved, peak) = (memory.part, memory.bytes_moved, memory.bytes_at_peak);
    let share = 100.0 * moved as f64 / peak.max(1) as f64;
    format!(
        "memory {part}: {reads} bursts read, {writes} written, {moved} bytes moved of {peak} at peak ({share:.1} %); \
         rows: {row_hits} hits, {row_misses} misses, {row_conflicts} conflicts; {refreshes} refreshes, {turnarounds} turns of the bus\n"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn worst_percentile_and_mean_of_many_values() {
        let spread = Spread::of((1..=100).map(f64::from));
        assert_eq!((spread.worst, spread.percentile_95), (100.0, 95.0));
        assert!((spread.mean - 50.5).abs() < 1e-12);
        let one = Spread::of([3.0]);
        assert_eq!((one.worst, one.percentile_95, one.mean), (3.0, 3.0, 3.0));
        assert_eq!(Spread::of([]), Spread::default());
    }
}
