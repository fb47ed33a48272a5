//! What the ways of sorting cost on five scenes: cycles, bytes and memory on the chip (`docs/decisions/depth-order.md`).

use super::loads::{SCENES, ordered, scenes};
use anyhow::Result;
use splatline_sim::design::DesignChoice;
use splatline_sim::machine::config::Sorter;
use splatline_sim::machine::lanes::{LaneShape, LaneWork};
use splatline_sim::machine::{Config, Timing, simulate};

/// Bits of a counter of splats, of a word that is sorted, and words that wait behind a read.
const COUNTER: u64 = 24;
const WORD: u64 = 128;
const WAITING: u64 = 128;

/// A way of sorting.
struct SortWay {
    name: String,
    config: Config,
    /// Bits of memory on the chip.
    bits: u64,
}

/// All ways around the whole machine with four lanes.
fn ways() -> Vec<SortWay> {
    let machine = Config::machine(4);
    let stream = WAITING * WORD;
    let entries = SortWay {
        name: "radix, list entries, digits of 8 bits".to_owned(),
        config: Config {
            sorter: Sorter::Passes,
            // Six digits of the key and one of the tile.
            sort_passes: 7,
            ..machine
        },
        bits: 7 * 256 * COUNTER + stream,
    };
    let radix = [4, 6, 8, 12].map(|digit| SortWay {
        name: format!("radix, splats, digits of {digit} bits"),
        config: Config {
            sort_digit: digit,
            ..machine
        },
        bits: u64::from(48u32.div_ceil(digit)) * COUNTER * (1 << digit) + stream,
    });
    let merge =
        [(64, 16), (256, 16), (1024, 16), (1024, 64), (4096, 64)].map(|(run, ways)| SortWay {
            name: format!("merge, splats, runs of {run}, {ways} ways"),
            config: Config {
                sorter: Sorter::Merge,
                sort_run: run,
                sort_ways: ways,
                ..machine
            },
            // Two queues of half a run in each stage of the chip's sorter, each twice as long as the one before; words on their way for every run.
            bits: 2 * u64::from(run) * WORD + u64::from(ways) * WAITING / 4 * WORD,
        });
    let mut all = vec![entries];
    all.extend(radix);
    all.extend(merge);
    all
}

/// Prints splats and lists of the scenes, and the table of the ways.
pub fn print(size: usize) -> Result<()> {
    let design = DesignChoice::load("lean18")?;
    let (seen, missing) = scenes(&SCENES, size)?;
    for name in missing {
        println!("(no {name}: its data is not at hand)");
    }
    println!("| scene | splats | seen | list entries | longest list | bits in which keys differ |");
    println!("|---|---:|---:|---:|---:|---|");
    let mut rows: Vec<Vec<Timing>> = Vec::new();
    let ways = ways();
    for seen in &seen {
        let (workload, load) = ordered(seen, &design);
        let lengths = load.lists.iter().map(Vec::len);
        println!(
            "| {} | {} | {} | {} | {} | {:012x} |",
            load.name,
            workload.splats.len(),
            load.splats.len(),
            lengths.clone().sum::<usize>(),
            lengths.max().unwrap_or(0),
            workload.key_bits
        );
        let work = LaneWork::new(&workload, LaneShape::from(&ways[0].config));
        let timings = ways
            .iter()
            .map(|way| simulate(&workload, &work, &way.config));
        rows.push(timings.collect());
    }
    let names = seen.iter().map(|seen| seen.name);
    let heads: Vec<String> = names.map(|name| format!(" {name} |")).collect();
    println!("\n| way | memory, kbit |{}", heads.concat());
    println!("|---|---:|{}", "---:|".repeat(heads.len()));
    for (index, way) in ways.iter().enumerate() {
        let cells: Vec<String> = rows.iter().map(|row| cell(&row[index])).collect();
        let kilobits = way.bits.div_ceil(1024);
        println!("| {} | {kilobits} |{}", way.name, cells.concat());
    }
    Ok(())
}

/// Thousands of cycles of the sort with the filling of the lists, their part of all cycles, megabytes sorted.
fn cell(timing: &Timing) -> String {
    let moved = timing.bytes.sort_moved + timing.bytes.sorted_read;
    format!(
        " {:.0}, {:.2} %, {:.2} |",
        timing.sort as f64 / 1e3,
        100.0 * timing.sort as f64 / timing.total as f64,
        moved as f64 / 1e6
    )
}
