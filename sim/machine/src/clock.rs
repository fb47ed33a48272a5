//! From cycles to time: the clock, pictures a second, and bytes a second.
//!
//! A count of cycles is no answer to "does it run at 60 frames a second". The machine's `clock_mhz` is what its maker
//! promises. Where nobody does, the clock is that of the nearest circuit of the same family that was placed and routed,
//! and says so wherever it is shown: one placement of another width or number of lanes is a hint of the order of
//! magnitude and no promise. Where no raster unit of a family was placed, it is the ECP5's by a stated factor
//! (`area/families.toml`): what both families reach with the same circuit.

use super::area::{Family, lines_of};
use super::config::Config;
use super::timing::Timing;
use crate::design::DesignChoice;
use serde::{Deserialize, Serialize};
use splatline::format::Widths;

/// The placements, as they lie beside this file; `docs/hardware.md` holds them with what is to be known of each.
const PLACED: &str = include_str!("clock/placed.csv");

/// Bytes in a megabyte.
const MEGA: f64 = 1e6;

/// A circuit that was placed and routed.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct RoutedCircuit {
    /// Named design.
    pub design: String,
    /// Pixel lanes.
    pub lanes: u32,
    /// Family of the device.
    pub family: Family,
    /// The device and its speed grade.
    pub device: String,
    /// The clock that it reached, megahertz.
    pub mhz: f64,
    /// Under which conditions.
    pub conditions: String,
    /// Where the figure is from.
    pub source: String,
}

/// The machine's clock and where it comes from.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Clock {
    /// Megahertz.
    pub mhz: f64,
    /// Did nobody give it?
    pub assumed: bool,
    /// Where it comes from, in words.
    pub of: String,
}

/// What a picture takes by the clock.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Throughput {
    /// The clock.
    pub clock: Clock,
    /// Cycles from one picture to the next.
    pub cycles_per_frame: u64,
    /// What sets them: a phase, all of them, or a channel.
    pub limited_by: &'static str,
    /// Pictures a second.
    pub frames_per_s: f64,
    /// Milliseconds from one picture to the next.
    pub ms_per_frame: f64,
    /// Milliseconds from the first splat of a picture to its last pixel.
    pub latency_ms: f64,
    /// Bytes that a picture moves over the memory interface; with a memory part those of whole bursts.
    pub bytes_per_frame: u64,
    /// Bytes a second at that rate.
    pub bytes_per_s: f64,
    /// Bytes a second that the machine's two channels could move, or its memory part at its peak.
    pub channel_bytes_per_s: f64,
    /// What moves them.
    pub memory: &'static str,
    /// Packets of pictures in work lie in memory as often.
    pub frames_in_work: u32,
}

/// Everything that was placed of today's circuit.
///
/// # Panics
/// If the table is none; a test reads it.
pub fn placed() -> Vec<RoutedCircuit> {
    lines_of(PLACED).expect("placed.csv is a table of circuits")
}

impl RoutedCircuit {
    /// How unlike the machine it is: lanes by their ratio, mantissas by their difference.
    fn distance(&self, lanes: u32, widths: &Widths) -> f64 {
        let own = DesignChoice::named(&self.design).map_or(0, |design| design.widths.mantissa);
        let lanes = (f64::from(lanes) / f64::from(self.lanes)).log2().abs();
        lanes + f64::from(own.abs_diff(widths.mantissa)) / 8.0
    }

    fn named(&self) -> String {
        let (design, lanes, device) = (&self.design, self.lanes, &self.device);
        format!(
            "{design} with {lanes} lane(s) on {device} ({})",
            self.conditions
        )
    }
}

impl Clock {
    /// The machine's own clock, or that of the nearest circuit of the family that was placed, or else the ECP5's by the
    /// family's factor.
    pub fn of(config: &Config, widths: &Widths, family: Family) -> Clock {
        if config.clock_mhz > 0 {
            return Clock {
                mhz: config.clock_mhz.into(),
                assumed: false,
                of: "clock_mhz of the machine".to_owned(),
            };
        }
        let nearest = |family| nearest(config.lanes, widths, family);
        let assumed = |mhz: f64, of: String| Clock {
            mhz,
            assumed: true,
            of: format!("assumed: no clock_mhz was given, and {of}"),
        };
        if let Some(own) = nearest(family) {
            let of = format!("{} is the nearest circuit that was placed", own.named());
            return assumed(own.mhz, of);
        }
        let factor = family.clock_factor();
        let Some(other) = nearest(Family::Ecp5) else {
            // A test reads the table, so that this is not met.
            return assumed(1.0, "nothing was placed".to_owned());
        };
        let (part, source) = (factor.of_ecp5, &factor.source);
        let (name, mhz, named) = (family.name(), other.mhz, other.named());
        assumed(
            (mhz * part * 10.0).round() / 10.0,
            format!(
                "no raster unit was placed for {name}: {part} of the {mhz} MHz of {named}, {source}"
            ),
        )
    }
}

/// The circuit of a family that is most like the machine; nothing if none was placed.
fn nearest(lanes: u32, widths: &Widths, family: Family) -> Option<RoutedCircuit> {
    let mut all = placed();
    all.retain(|placed| placed.family == family);
    let distance = |placed: &RoutedCircuit| placed.distance(lanes, widths);
    all.into_iter()
        .min_by(|a, b| distance(a).total_cmp(&distance(b)))
}

impl Throughput {
    /// The pace of a picture with this timing.
    pub fn new(timing: &Timing, config: &Config, clock: Clock) -> Throughput {
        let (cycles, limited_by) = interval(timing, config);
        let hertz = clock.mhz * MEGA;
        let seconds = cycles.max(1) as f64 / hertz;
        let moved = timing.memory.as_ref().map(|memory| memory.bytes_moved);
        let bytes = moved.unwrap_or(timing.bytes.all());
        let part = config.memory_part();
        Throughput {
            cycles_per_frame: cycles,
            limited_by,
            frames_per_s: seconds.recip(),
            ms_per_frame: seconds * 1e3,
            latency_ms: timing.total as f64 / hertz * 1e3,
            bytes_per_frame: bytes,
            bytes_per_s: bytes as f64 / seconds,
            channel_bytes_per_s: config.channel_bytes_per_cycle(clock.mhz) * hertz,
            memory: part.map_or("the channels", |part| part.name.as_str()),
            frames_in_work: config.overlap_frames,
            clock,
        }
    }

    /// The pace in three lines.
    pub fn text(&self) -> String {
        let Clock { mhz, of, .. } = &self.clock;
        format!(
            "clock: {mhz} MHz ({of})\n\
             pace: {:.2} frames a second, {:.3} ms a frame, limited by {}; {:.3} ms from first splat to last pixel\n\
             traffic: {:.2} MB a frame, {:.1} MB a second of {:.1} that {} could move\n",
            self.frames_per_s,
            self.ms_per_frame,
            self.limited_by,
            self.latency_ms,
            self.bytes_per_frame as f64 / MEGA,
            self.bytes_per_s / MEGA,
            self.channel_bytes_per_s / MEGA,
            self.memory,
        )
    }
}

/// Cycles from one picture to the next, and what sets them.
///
/// Phases of different pictures run side by side where their packets have buffers of their own in memory. They share
/// the channels: a channel that is asked for more bytes than it moves sets the rate.
fn interval(timing: &Timing, config: &Config) -> (u64, &'static str) {
    let [geometry, sort, raster] = [timing.geometry, timing.sort, timing.raster];
    let total = timing.total;
    if config.overlap_frames < 2 {
        return (total, "all phases, one after the other");
    }
    let phases = match config.overlap_frames {
        2 => vec![(geometry + sort, "geometry and sort"), (raster, "raster")],
        _ => vec![(geometry, "geometry"), (sort, "sort"), (raster, "raster")],
    };
    let [read, written] = timing.bytes.directions();
    let channels = [
        (read.div_ceil(config.read_bandwidth.into()), "reading"),
        (written.div_ceil(config.write_bandwidth.into()), "writing"),
    ];
    // No picture takes less than the phases of its own.
    let slowest = phases.into_iter().chain(channels).max_by_key(|one| one.0);
    let (cycles, name) = slowest.unwrap_or((total, "all phases, one after the other"));
    (cycles.min(total.max(1)), name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::memory::MemoryFacts;
    use crate::memory::dram::DramCounts;
    use crate::tests::{changed, refused, says};
    use crate::timing::Bytes;

    fn timing() -> Timing {
        Timing {
            total: 1_000,
            geometry: 300,
            sort: 100,
            raster: 600,
            bytes: Bytes {
                splats_read: 3_200,
                pixels_written: 6_400,
                ..Bytes::default()
            },
            ..Timing::default()
        }
    }

    fn machine(clock_mhz: u32, overlap_frames: u32) -> Config {
        Config {
            clock_mhz,
            overlap_frames,
            ..Config::default()
        }
    }

    fn pace(config: &Config) -> Throughput {
        let design = DesignChoice::named("lean18").unwrap();
        let clock = Clock::of(config, &design.widths, Family::Xilinx7);
        Throughput::new(&timing(), config, clock)
    }

    #[test]
    fn every_placement_is_a_circuit_of_the_hardware_page() {
        let page = include_str!("../../../docs/hardware.md");
        let lines = PLACED.lines().count() - 1;
        assert_eq!(placed().len(), lines, "a line of placed.csv is none");
        for placed in placed() {
            let lanes = ["no", "one", "two", "three", "four"][placed.lanes as usize];
            let name = format!("| {}, {lanes} lane", placed.design);
            let figure = format!("| {:.1} |", placed.mhz);
            let mut lines = page.lines().filter(|line| line.starts_with(&name));
            assert!(lines.any(|line| line.contains(&figure)), "{name}");
            assert!(DesignChoice::named(&placed.design).is_some());
            assert_eq!(placed.source, "docs/hardware.md");
        }
    }

    #[test]
    fn a_clock_that_nobody_gave_says_so() {
        let assumed = pace(&machine(0, 1));
        assert!(assumed.clock.assumed && assumed.clock.mhz > 0.0);
        assert!(assumed.text().contains("assumed: no clock_mhz was given"));
        let given = pace(&machine(100, 1));
        assert!(!given.clock.assumed && given.text().contains("clock: 100 MHz (clock_mhz"));
    }

    /// What was placed on one family is never another's clock: that is a factor with its source.
    #[test]
    fn each_family_has_a_clock_of_its_own() {
        let widths = DesignChoice::named("lean18").unwrap().widths;
        let [xilinx, ecp5, ice40] =
            Family::ALL.map(|family| Clock::of(&machine(0, 1), &widths, family));
        assert_eq!(ecp5.mhz, 120.4);
        assert!(
            ecp5.of.contains("on ECP5 LFE5U-85F grade 6") && !ecp5.of.contains("no raster unit")
        );
        for (clock, name) in [(&xilinx, "Xilinx 7"), (&ice40, "iCE40")] {
            let named = format!("no raster unit was placed for {name}");
            says(&clock.of, &[&named]);
            assert!(clock.mhz != ecp5.mhz && clock.assumed);
        }
        assert!(ice40.mhz < 0.3 * ecp5.mhz, "{ice40:?}");
        assert!(xilinx.mhz > ecp5.mhz, "{xilinx:?}");
    }

    #[test]
    fn pictures_in_work_are_limited_by_the_slowest_phase_or_channel() {
        let cycles = |config: &Config| {
            let pace = pace(config);
            (pace.cycles_per_frame, pace.limited_by)
        };
        assert_eq!(cycles(&machine(100, 1)).0, 1_000);
        assert_eq!(cycles(&machine(100, 2)), (600, "raster"));
        assert_eq!(cycles(&machine(100, 3)), (600, "raster"));
        let narrow = changed(machine(100, 3), "write_bandwidth=8");
        assert_eq!(cycles(&narrow), (800, "writing"));
    }

    /// A part moves whole bursts at no more than its bus takes, whatever the channels that it stands in for would do.
    #[test]
    fn with_a_memory_part_the_rates_are_the_parts() {
        let config = changed(machine(100, 1), "memory_part=ddr3-1600-x16");
        let facts = MemoryFacts {
            part: "ddr3-1600-x16",
            source: "",
            counts: DramCounts::default(),
            bytes_moved: 16_000,
            bytes_at_peak: 32_000,
        };
        let timing = Timing {
            memory: Some(facts),
            ..timing()
        };
        let pace = Throughput::new(&timing, &config, pace(&config).clock);
        assert_eq!(pace.cycles_per_frame, 1_000);
        assert_eq!(pace.bytes_per_frame, 16_000);
        assert!((pace.bytes_per_s - 1.6e9).abs() < 1.0);
        assert!((pace.channel_bytes_per_s - 3.2e9).abs() < 1.0);
        let moves = "of 3200.0 that ddr3-1600-x16 could move";
        says(&pace.text(), &[moves]);
        let wide = changed(config, "read_bandwidth=1024");
        assert_eq!(Throughput::new(&timing, &wide, pace.clock.clone()), pace);
        let printed = refused(config, "overlap_frames=2");
        let expected = "overlap_frames = 2: allowed is 1 with a memory part";
        says(&printed, &[expected]);
    }

    /// 1,000 cycles at 100 MHz are 10 microseconds; 9,600 bytes in them 960 MB a second.
    #[test]
    fn time_and_bytes_follow_from_the_clock() {
        let pace = pace(&machine(100, 1));
        assert!((pace.frames_per_s - 100_000.0).abs() < 1e-6);
        assert!((pace.ms_per_frame - 0.01).abs() < 1e-12 && pace.latency_ms == pace.ms_per_frame);
        assert!((pace.bytes_per_s - 960e6).abs() < 1.0);
        assert_eq!(pace.bytes_per_frame, 9_600);
    }
}
