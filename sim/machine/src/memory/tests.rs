use super::ListWords;
use super::dram::Dram;
use super::parts::{DramPart, PARTS};
use super::port::{Port, Stream};
use crate::config::Config;
use crate::lanes::{LaneShape, LaneWork};
use crate::tests::{changed, machine, one_workload, small_tiles, workload};
use crate::timing::{accesses, simulate_alone};
use crate::workload::{SplatWork, Workload};
use proptest::prelude::*;

/// A command to the part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum DramCommand {
    Activate,
    Precharge,
    Read,
    Write,
    Refresh,
}

/// A command and when it was issued.
#[derive(Clone, Copy, Debug)]
pub(super) struct Issued {
    pub at: u64,
    pub command: DramCommand,
    pub bank: u64,
    pub row: u64,
}

impl DramCommand {
    /// What moves a burst.
    pub(super) fn moving(write: bool) -> DramCommand {
        if write {
            DramCommand::Write
        } else {
            DramCommand::Read
        }
    }
}

impl Dram {
    pub(super) fn issue(&mut self, at: u64, command: DramCommand, bank: u64, row: u64) {
        if let Some(log) = &mut self.log {
            log.push(Issued {
                at,
                command,
                bank,
                row,
            });
        }
    }
}

fn part(name: &str) -> &'static DramPart {
    PARTS.iter().find(|part| part.name == name).unwrap()
}

/// Nanoseconds of a part's clocks.
fn ns(part: &DramPart, clocks: u64) -> f64 {
    clocks as f64 * 1e6 / part.khz as f64
}

/// A part, nanoseconds to the first data from a closed row, an open one and another one, nanoseconds of a row cycle,
/// bytes a second, share of refresh.
type TestSheet = (&'static str, [f64; 3], f64, f64, f64);

/// Figures of the data sheets, written here and nowhere else.
const SHEETS: [TestSheet; 3] = [
    // CL 3 at 6 ns, tRCD 18 ns, tRP 18 ns, tRC 60 ns, 16 bits at 166 MHz, 60 ns of every 7.8125 us.
    ("sdr-166-x16", [36.0, 18.0, 54.0], 60.0, 333.3e6, 0.00768),
    // 13.75 ns each, tRAS 35 ns, 1600 million transfers of two bytes, 260 ns of every 7.8 us.
    ("ddr3-1600-x16", [27.5, 13.75, 41.25], 48.75, 3.2e9, 0.0333),
    // RL 28 at 0.625 ns, tRCD 18 ns, tRPpb 18 ns, tRAS 42 ns, 3200 million transfers of four bytes, 280 ns of every
    // 3.904 us.
    ("lpddr4-3200-x32", [35.5, 17.5, 53.5], 60.0, 12.8e9, 0.0717),
];

/// Every part says which sheet and which table in it its figures are from.
#[test]
fn every_part_names_its_sheet() {
    for part in PARTS.iter() {
        assert!(SHEETS.iter().any(|(name, ..)| *name == part.name));
        let mut sheets = ["JEDEC", "data sheet"].into_iter();
        let sheet = sheets.any(|word| part.source.contains(word));
        assert!(sheet && part.source.contains("table"), "{}", part.name);
    }
}

#[test]
fn rows_cost_what_the_data_sheets_say() {
    for (name, to_data, row_cycle, ..) in SHEETS {
        let part = part(name);
        let clock = ns(part, 1);
        let mut dram = Dram::new(part);
        let row = part.row_bytes * part.banks;
        // Far enough apart that nothing but the row matters, and before the first refresh.
        let data = |dram: &mut Dram, at: u64, address: u64| {
            ns(part, dram.burst(at, address, false).start - at)
        };
        let near = |found: f64, wanted: f64| (wanted - 1e-3..wanted + 1.7 * clock).contains(&found);
        for ((at, address), wanted) in [(0, 0), (200, 64), (400, row)].into_iter().zip(to_data) {
            let found = data(&mut dram, at, address);
            assert!(near(found, wanted), "{name}: {found} ns, not {wanted}");
        }
        // Rows of one bank in turn: a row cycle each, or the time to read and close it if that is longer.
        let mut dram = Dram::new(part);
        let first = dram.burst(0, 0, false).start;
        let turns = (1..=4).map(|turn| dram.burst(0, turn * row, false).start);
        let each = ns(part, turns.last().unwrap() - first) / 4.0;
        let read_out = ns(part, part.rcd + part.rtp + part.rp);
        let expected = row_cycle.max(read_out);
        assert!(near(each, expected), "{name}: {each} ns a row");
    }
}

/// A long stream reaches the peak bandwidth less the share of refresh and little more; in its time there are as many
/// refreshes as the sheet asks for.
#[test]
fn a_stream_has_the_peak_bandwidth_less_refresh() {
    for (name, _, _, peak, refresh) in SHEETS {
        let part = part(name);
        assert!((part.peak_bytes_per_s() as f64 / peak - 1.0).abs() < 1e-3);
        let share = part.rfc as f64 / part.refi as f64;
        assert!((share / refresh - 1.0).abs() < 0.01, "{name}: {share}");
        let mut dram = Dram::new(part);
        let bursts = 200_000;
        let read = |burst| dram.burst(0, burst * part.burst_bytes(), false).end;
        let end = (0..bursts).map(read).last().unwrap();
        let seconds = ns(part, end) * 1e-9;
        let bandwidth = (bursts * part.burst_bytes()) as f64 / seconds;
        let reached = bandwidth / peak;
        assert!(
            reached < 1.0 - 0.9 * share && reached > 1.0 - share - 0.02,
            "{name}: {reached} of the peak, refresh takes {share}"
        );
        assert!(dram.counts.refreshes.abs_diff(end / part.refi) <= 1);
        assert_eq!(dram.counts.reads, bursts);
    }
}

/// What the rules say about two commands, looked up for every pair of them.
fn check_rules(part: &DramPart, log: &[Issued]) -> Result<(), TestCaseError> {
    use DramCommand::{Activate, Precharge, Read, Refresh, Write};
    let bursts = part.burst_clocks();
    for (index, later) in log.iter().enumerate() {
        for earlier in &log[..index] {
            let (a, b) = (earlier.command, later.command);
            let same = earlier.bank == later.bank;
            let gap = match (a, b) {
                (Activate, Activate) if same => part.ras + part.rp,
                (Activate, Activate) => part.rrd,
                (Activate, Read | Write) if same => part.rcd,
                (Activate, Precharge) if same => part.ras,
                (Precharge, Activate) if same => part.rp,
                (Read, Precharge) if same => part.rtp,
                (Write, Precharge) if same => part.cwl + bursts + part.wr,
                (Read, Read) | (Write, Write) => part.ccd,
                (Write, Read) => part.cwl + bursts + part.wtr,
                (Read, Write) => (part.cl + bursts).saturating_sub(part.cwl),
                (Refresh, Activate) => part.rfc,
                (Precharge, Refresh) => part.rp,
                _ => 0,
            };
            // A bank's rules run in the order of its commands, which are logged in that order; banks may overtake each
            // other.
            let ordered = match (a, b) {
                _ if same => true,
                (Refresh, _) | (_, Refresh) | (Activate, Activate) => true,
                (Activate | Precharge, _) | (_, Activate | Precharge) => false,
                _ => true,
            };
            prop_assert!(
                !ordered || later.at >= earlier.at + gap,
                "{}: {earlier:?} then {later:?}, {gap} clocks apart",
                part.name
            );
        }
        let activations = log[..=index]
            .iter()
            .filter(|found| found.command == Activate);
        let activations: Vec<u64> = activations.map(|found| found.at).collect();
        if let [.., fifth, _, _, _, last] = activations[..] {
            prop_assert!(last >= fifth + part.faw);
        }
    }
    Ok(())
}

/// Reads and writes find their row open, told from the log alone.
fn check_rows(part: &DramPart, log: &[Issued]) -> Result<(), TestCaseError> {
    let mut open: Vec<Option<u64>> = vec![None; part.banks as usize];
    for issued in log {
        let bank = issued.bank as usize;
        match issued.command {
            DramCommand::Activate => {
                prop_assert_eq!(open[bank], None);
                open[bank] = Some(issued.row);
            }
            DramCommand::Precharge => {
                prop_assert!(open[bank].is_some());
                open[bank] = None;
            }
            DramCommand::Refresh => prop_assert!(open.iter().all(Option::is_none)),
            DramCommand::Read | DramCommand::Write => prop_assert_eq!(open[bank], Some(issued.row)),
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    /// Whatever is asked for, no two commands are nearer than the data sheet allows, and data never meet on the bus.
    #[test]
    fn no_rule_of_a_part_is_broken(which in 0usize..3, requests in proptest::collection::vec((0u64..900, 0u64..40, any::<bool>()), 1..60)) {
        let part = &PARTS[which];
        let mut dram = Dram::new(part);
        dram.log = Some(Vec::new());
        let (mut at, mut bus) = (0, 0);
        for (gap, place, write) in requests {
            // Few rows, so that all three cases of a row occur; long gaps, so that refreshes do.
            at += if gap > 800 { gap * 4 } else { gap / 40 };
            let address = place % 5 * part.row_bytes * part.banks + place / 5 * part.row_bytes / 2;
            let transfer = dram.burst(at, address, write);
            prop_assert!(transfer.start >= bus && transfer.start >= at);
            bus = transfer.end;
        }
        let log = dram.log.take().unwrap();
        check_rules(part, &log)?;
        check_rows(part, &log)?;
    }

    /// Behind any part a machine draws the same pixels, its accounts add up (asserted where they are closed), every
    /// byte that it wants is moved, and the trace holds every burst once.
    #[test]
    fn machines_with_parts_do_the_same_work(workload in workload(), config in machine(), which in 1u32..=3, mhz in 20u32..900, queue in 1u32..40, harmonics in 0u32..64) {
        let with = Config { memory_part: which, clock_mhz: mhz, write_queue: queue, harmonics_bytes: harmonics, ..config };
        let plain = simulate_alone(&workload, &Config { harmonics_bytes: harmonics, ..config });
        let timing = simulate_alone(&workload, &with);
        let facts = timing.memory.clone().unwrap();
        prop_assert_eq!(timing.pixels.live, plain.pixels.live);
        prop_assert_eq!(timing.pixels.pairs, plain.pixels.pairs);
        prop_assert_eq!(timing.bytes, plain.bytes);
        prop_assert_eq!(timing.splats, plain.splats);
        let bytes = timing.bytes;
        let written = bytes.pixels_written + bytes.packets_written + bytes.sort_moved / 2;
        prop_assert!(facts.counts.writes * PARTS[which as usize - 1].burst_bytes() >= written);
        prop_assert!(facts.counts.reads * PARTS[which as usize - 1].burst_bytes() >= bytes.splats_read);
        prop_assert!(facts.bytes_moved <= facts.bytes_at_peak + 4096, "{facts:?}");
        let counts = facts.counts;
        prop_assert_eq!(counts.reads + counts.writes, counts.row_hits + counts.row_misses + counts.row_conflicts);
        let work = LaneWork::new(&workload, LaneShape::from(&with));
        let trace = accesses(&workload, &work, &with).unwrap();
        prop_assert_eq!(trace.iter().filter(|access| access.write).count() as u64, counts.writes);
        prop_assert_eq!(trace.len() as u64, counts.reads + counts.writes);
    }
}

/// A stream of splats of 32 bytes reads a burst of 64 once for two of them, and a burst of 16 twice for each.
#[test]
fn streams_read_no_burst_twice() {
    for (name, bursts) in [("lpddr4-3200-x32", 50), ("ddr3-1600-x16", 200)] {
        let mut port = Port::new(part(name), 200, 8);
        let mut stream = Stream::default();
        for splat in 0..100 {
            port.read_on(&mut stream, splat, 32 * splat, 32);
        }
        assert_eq!(port.counts().reads, bursts);
    }
}

/// Writes wait for their turn: while reads keep the bus busy a full queue is halved in one go, so that the bus turns
/// twice for four of them.
#[test]
fn writes_are_held_back_and_go_in_batches() {
    let mut port = Port::new(part("ddr3-1600-x16"), 800, 8);
    for step in 0..64u64 {
        port.write(step, (1 << 20) + 16 * step, 16);
        port.read(step, 16 * step, 16);
    }
    port.end_of_phase(0);
    let counts = port.counts();
    assert_eq!([counts.reads, counts.writes], [64, 64]);
    assert!(counts.turnarounds <= 2 * 64 / 4 + 1, "{counts:?}");
    // Alone, a write waits for nobody: the read long after it finds it done.
    let mut port = Port::new(part("ddr3-1600-x16"), 800, 8);
    port.write(0, 0, 16);
    port.read(500, 4096, 16);
    assert_eq!(port.counts().writes, 1);
}

/// List entries of a picture whose lists hold all that their boxes meet.
fn entries_of(workload: &Workload) -> u64 {
    let tiles = |splat: &SplatWork| u64::from(splat.tiles);
    workload.splats.iter().map(tiles).sum()
}

/// The passes of a sort move each entry twice and take their channel's time where that is longer than the comparisons'.
#[test]
fn sort_and_harmonics_are_charged() {
    let workload = one_workload();
    let entries = entries_of(&workload);
    let narrow = Config {
        sort_passes: 8,
        sort_bytes: 16,
        read_bandwidth: 8,
        write_bandwidth: 2,
        ..small_tiles()
    };
    let timing = simulate_alone(&workload, &narrow);
    assert_eq!(timing.sort, entries * 8 * 16 / 2);
    assert_eq!(timing.bytes.sort_moved, entries * 8 * 16 * 2);
    let seen = workload.visible() as u64;
    let with = changed(narrow, "harmonics_bytes=96");
    let more = simulate_alone(&workload, &with);
    assert_eq!(more.bytes.harmonics_read, 96 * seen);
    let fetched = [&more, &timing].map(|timing| timing.units["fetch"].busy);
    assert_eq!(fetched[0], fetched[1] + 12 * seen);
    // On a part the sort takes at least as long as its bytes take on the bus.
    let sdr = changed(narrow, "clock_mhz=100 memory_part=sdr-166-x16");
    let bytes_a_cycle = part("sdr-166-x16").peak_bytes_per_s() as f64 / 100e6;
    let least = timing.bytes.sort_moved as f64 / bytes_a_cycle;
    assert!(simulate_alone(&workload, &sdr).sort as f64 >= least);
}

/// Splats sorted before they are binned: a word for each instead of its entries, digits that differ, and the lists
/// filled afterwards.
#[test]
fn a_sort_before_the_lists_is_charged_by_splats() {
    let workload = Workload {
        key_bits: 0xff00_ff01,
        ..one_workload()
    };
    let (entries, visible) = (entries_of(&workload), workload.visible() as u64);
    let words = "read_bandwidth=1024 write_bandwidth=1024 sorter=radix sort_bytes=16";
    let wide = changed(Config::default(), words);
    let fill = visible + entries;
    // A pass begins when what the one before wrote is there, and its first splat comes after the latency.
    let waits = 2 * u64::from(wide.latency);
    let timing = simulate_alone(&workload, &wide);
    assert_eq!(timing.sort, 6 * 256 + 3 * visible + fill + 4 * waits);
    assert_eq!(timing.bytes.sort_moved, 3 * 2 * 16 * visible);
    assert_eq!(timing.bytes.sorted_read, 16 * visible);
    let passes = changed(wide, "sorter=passes");
    let written = |config: &Config| simulate_alone(&workload, config).bytes.packets_written;
    assert_eq!(written(&wide), written(&passes) + 16 * visible);
    // Two ways and runs of one: as many merges as the count has bits, and the last one feeds the lists.
    let merge = changed(wide, "sorter=merge sort_run=1 sort_ways=2");
    let merges = u64::from(visible.next_power_of_two().ilog2());
    let timing = simulate_alone(&workload, &merge);
    let written = merges.saturating_sub(1);
    assert_eq!(timing.sort, written * (visible + waits) + fill + waits);
    // The channels limit both.
    let narrow = changed(wide, "read_bandwidth=4 write_bandwidth=1");
    let timing = simulate_alone(&workload, &narrow);
    let filled = fill.max(4 * visible).max(4 * entries);
    // Sums of counts come before anything moves.
    assert_eq!(timing.sort, 6 * 256 + 3 * 16 * visible + filled + 4 * waits);
}

/// Entries that follow each other are read by the word: as many cycles as all their bytes take, and never fewer before
/// an entry is there.
#[test]
fn lists_without_gaps_are_read_by_the_word() {
    for (entry, word, first) in [
        (4, 16, [1, 0, 0, 0, 1, 0]),
        (4, 4, [1, 1, 1, 1, 1, 1]),
        (4, 3, [2, 1, 1, 2, 1, 1]),
        (4, 1, [4, 4, 4, 4, 4, 4]),
        (12, 8, [2, 1, 2, 1, 2, 1]),
    ] {
        let mut lists = ListWords {
            word,
            entry,
            left: 0,
        };
        let cycles = first.map(|_| lists.read());
        assert_eq!(cycles, first, "{entry} of {word}");
        assert_eq!(cycles.iter().sum::<u64>(), (6 * entry).div_ceil(word));
    }
}

/// A phase does not end before its last splat has come out of setup, though it be culled.
#[test]
fn culled_splats_take_as_long_as_others() {
    let workload = Workload {
        splats: vec![SplatWork::default(); 3],
        ..Workload::default()
    };
    let words = "splat_bytes=64 read_bandwidth=64 latency=10 setup_interval=20 setup_latency=500";
    let config = changed(Config::default(), words);
    // One splat after the other: read, taken, the latency.
    let timing = simulate_alone(&workload, &config);
    assert_eq!(timing.geometry, 1 + 10 + 2 * 20 + 500);
}
