//! What was placed and routed: a line for each circuit and seed, kept as they come, so that an interrupted run loses nothing and a later one goes on.
//!
//! A line says which sources it is of. Where these have changed since, it is out of date: the page says so, and a new placement of that circuit replaces
//! all of its lines.

use anyhow::{Context, Result};
use splatline_sim::atomic;
use splatline_sim::machine::area::Fabric;
use std::fs;
use std::path::Path;

/// Where the lines are kept.
pub const PLACED: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/placed.csv");

/// Where the model's clocks are kept.
pub const CLOCKS: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../../machine/src/clock/placed.csv"
);

const HEADING: &str =
    "circuit,sources,tool,seed,luts,flip_flops,dsps,memory_kbit,mhz,seconds,path\n";

/// One circuit placed and routed with one seed.
#[derive(Clone, Debug, PartialEq)]
pub struct PlacedLine {
    /// As in `lean18 splat_primitive 4`.
    pub circuit: String,
    /// A number that changes with the circuit's sources, and with what synthesises and places it.
    pub sources: u64,
    /// What placed it, with its version.
    pub tool: String,
    /// Where the placer's random numbers began.
    pub seed: u32,
    /// What the circuit takes.
    pub fabric: Fabric,
    /// Fmax.
    pub mhz: f64,
    /// How long placing and routing took.
    pub seconds: u64,
    /// From and to which cells the slowest path leads, and its nanoseconds.
    pub path: String,
}

impl PlacedLine {
    fn to_text(&self) -> String {
        let counts = self.fabric.resources().map(|(_, count)| count.to_string());
        format!(
            "{},{:016x},{},{},{},{:.2},{},{}\n",
            self.circuit,
            self.sources,
            self.tool,
            self.seed,
            counts.join(","),
            self.mhz,
            self.seconds,
            self.path
        )
    }

    /// The path comes last, since it has commas of its own.
    fn parse(line: &str) -> Option<PlacedLine> {
        let fields: Vec<&str> = line.splitn(11, ',').collect();
        let [
            circuit,
            sources,
            tool,
            seed,
            luts,
            flip_flops,
            dsps,
            memory_kbit,
            mhz,
            seconds,
            path,
        ] = fields.try_into().ok()?;
        Some(PlacedLine {
            circuit: circuit.to_owned(),
            sources: u64::from_str_radix(sources, 16).ok()?,
            tool: tool.to_owned(),
            seed: seed.parse().ok()?,
            fabric: Fabric {
                luts: luts.parse().ok()?,
                flip_flops: flip_flops.parse().ok()?,
                dsps: dsps.parse().ok()?,
                memory_kbit: memory_kbit.parse().ok()?,
            },
            mhz: mhz.parse().ok()?,
            seconds: seconds.parse().ok()?,
            path: path.to_owned(),
        })
    }
}

/// Everything that was kept.
pub fn read(file: &Path) -> Result<Vec<PlacedLine>> {
    let text = fs::read_to_string(file).with_context(|| file.display().to_string())?;
    let lines = text.strip_prefix(HEADING);
    let lines = lines.with_context(|| format!("{}: not headed {HEADING}", file.display()))?;
    let parsed = lines.lines().map(|line| {
        PlacedLine::parse(line).with_context(|| format!("{}: '{line}'", file.display()))
    });
    parsed.collect()
}

/// Keeps a line in place of that circuit's lines of other sources.
pub fn keep(file: &Path, line: &PlacedLine) -> Result<()> {
    let mut lines = read(file)?;
    lines.retain(|kept| {
        kept.circuit != line.circuit || (kept.sources == line.sources && kept.seed != line.seed)
    });
    let place = lines.partition_point(|kept| {
        (kept.circuit.as_str(), kept.seed) < (line.circuit.as_str(), line.seed)
    });
    lines.insert(place, line.clone());
    let text: String = lines.iter().map(PlacedLine::to_text).collect();
    Ok(atomic::write(file, [HEADING, &text].concat().as_bytes())?)
}

/// The place of the median among so many; of two in the middle the slower one's.
fn middle(count: usize) -> usize {
    (count - 1) / 2
}

/// Seeds from which on a median is taken for a circuit's clock: two seeds differ by up to a fifth.
const ENOUGH: usize = 5;

/// What the model takes for its clock, `sim/machine/src/clock/placed.csv`: the median of each whole primitive that was placed often enough.
pub fn clocks(lines: &[PlacedLine]) -> String {
    let mut text = "design,lanes,family,device,mhz,conditions,source\n".to_owned();
    for seeds in lines.chunk_by(|a, b| a.circuit == b.circuit) {
        let Some((design, lanes)) = seeds[0].circuit.split_once(" splat_primitive ") else {
            continue;
        };
        if seeds.len() < ENOUGH {
            continue;
        }
        let mut speeds: Vec<f64> = seeds.iter().map(|line| line.mhz).collect();
        speeds.sort_by(f64::total_cmp);
        text += &format!(
            "{design},{lanes},ecp5,ECP5 LFE5U-85F grade 6,{:.1},median of {} seeds,docs/hardware.md\n",
            speeds[middle(speeds.len())],
            speeds.len()
        );
    }
    text
}

/// A circuit's line of the table: the median's speed and path (of two in the middle the slower), and the extremes. `now` are its sources as they are; empty, if it was never placed.
pub fn summary(lines: &[PlacedLine], now: u64) -> String {
    let mut by_speed: Vec<&PlacedLine> = lines.iter().collect();
    by_speed.sort_by(|a, b| a.mhz.total_cmp(&b.mhz));
    let (Some(slowest), Some(fastest)) = (by_speed.first(), by_speed.last()) else {
        return String::new();
    };
    let median = by_speed[middle(by_speed.len())];
    let seeds: Vec<String> = lines.iter().map(|line| line.seed.to_string()).collect();
    let counts = median
        .fabric
        .resources()
        .map(|(_, count)| count.to_string());
    let dated = if lines.iter().all(|line| line.sources == now) {
        ""
    } else {
        " (before the last change of its sources)"
    };
    format!(
        "| {}{dated} | {} | {} | {:.1} | {:.1} to {:.1} | {} | {} | {} |\n",
        median.circuit,
        counts.join(", "),
        seeds.join(", "),
        median.mhz,
        slowest.mhz,
        fastest.mhz,
        median.path,
        lines.iter().map(|line| line.seconds).sum::<u64>() / lines.len() as u64,
        median.tool
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(seed: u32, sources: u64, mhz: f64) -> PlacedLine {
        PlacedLine {
            circuit: "lean18 splat_primitive 1".to_owned(),
            sources,
            tool: "nextpnr-ecp5 0.4".to_owned(),
            seed,
            fabric: Fabric {
                luts: 9,
                flip_flops: 8,
                dsps: 7,
                memory_kbit: 36,
            },
            mhz,
            seconds: 60,
            path: "`a` to `b`: 9.0, 5.0 of it wires".to_owned(),
        }
    }

    #[test]
    fn the_models_clock_is_the_median() {
        let speeds = [(1, 90.25), (2, 100.0), (3, 80.0), (4, 99.0), (5, 81.0)];
        let lines = speeds.map(|(seed, mhz)| line(seed, 5, mhz));
        let printed =
            "lean18,1,ecp5,ECP5 LFE5U-85F grade 6,90.2,median of 5 seeds,docs/hardware.md";
        assert_eq!(clocks(&lines).lines().nth(1), Some(printed));
        assert_eq!(clocks(&lines[..4]).lines().count(), 1);
    }

    /// `rtl -- area page` writes it.
    #[test]
    fn the_committed_clocks_are_of_what_was_placed() {
        let committed = fs::read_to_string(CLOCKS).unwrap();
        assert_eq!(committed, clocks(&read(PLACED.as_ref()).unwrap()));
    }

    #[test]
    fn lines_are_kept_in_order_until_the_sources_change() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("placed.csv");
        fs::write(&file, HEADING).unwrap();
        for (seed, mhz) in [(3, 90.25), (1, 100.0), (2, 80.0), (1, 101.0)] {
            keep(&file, &line(seed, 5, mhz)).unwrap();
        }
        let kept = read(&file).unwrap();
        assert_eq!(
            kept,
            [line(1, 5, 101.0), line(2, 5, 80.0), line(3, 5, 90.25)]
        );
        assert_eq!(
            summary(&kept, 5),
            "| lean18 splat_primitive 1 | 9, 8, 7, 36 | 1, 2, 3 | 90.2 | 80.0 to 101.0 | `a` to `b`: 9.0, 5.0 of it wires | 60 | nextpnr-ecp5 0.4 |\n"
        );
        assert!(summary(&kept, 6).contains("before the last change"));
        keep(&file, &line(2, 6, 70.0)).unwrap();
        assert_eq!(read(&file).unwrap(), [line(2, 6, 70.0)]);
    }
}
