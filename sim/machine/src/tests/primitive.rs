//! The primitive's clock against its registers: the circuit of `sim/rtl`, stage by stage, without its data.

use super::super::config::Config;
use super::super::primitive::{Intervals, LaneRun, PrimitiveClock};
use super::super::simulate_alone;
use super::super::workload::{Pair, SplatWork, Tile, Workload};
use super::{covered_row, workload};
use proptest::prelude::*;
use std::collections::VecDeque;

/// The primitive with so many lanes, for [`workload`]'s tiles.
fn primitive(lanes: u32) -> Config {
    Config {
        tile_width: 16,
        tile_height: 8,
        ..Config::primitive(lanes)
    }
}

/// Two tiles without splats between two with one: written while the second one is drawn, as far as there is time before
/// it is read out.
#[test]
fn gaps_of_the_write_channel_take_backgrounds() {
    let drawn = |splats: std::ops::Range<u32>| Pair {
        splat: splats.start,
        rows_end: splats.end,
        first_row: 0,
        visits: true,
    };
    let tile = |pairs_end| Tile {
        pairs_end,
        finished_after: u32::MAX,
        pixels: 128,
    };
    let picture = |tiles: Vec<Tile>| Workload {
        tile: [16, 8],
        packet_bytes: 48,
        rows: vec![covered_row(0, 16, false); 2],
        splats: vec![SplatWork::default(); 2],
        pairs: vec![drawn(0..1), drawn(1..2)],
        tiles,
        ..Workload::default()
    };
    // 128 pixels of 16 bytes: read out in 128 cycles, written in 16 of 128 bytes each.
    let config = Config {
        write_bandwidth: 128,
        ..primitive(1)
    };
    let raster = |tiles| simulate_alone(&picture(tiles), &config).raster;
    let alone = raster(vec![tile(1), tile(2)]);
    assert_eq!(raster(vec![tile(1), tile(1), tile(1), tile(2)]), alone + 32);
    // Before the first tile's read-out there is time for five.
    assert_eq!(raster(vec![tile(0), tile(0), tile(1), tile(2)]), alone);
    assert_eq!(raster(vec![tile(1), tile(2), tile(2), tile(2)]), alone + 32);
}

/// A packet: the cycle from which it is offered, and its rows.
type NaivePacket = (u64, Vec<Option<LaneRun>>);

/// Cycles of all handshakes: packets, splats, and runs into queues and out of them (lane by lane).
#[derive(Debug, Default, PartialEq)]
struct Handshakes {
    accepted: Vec<u64>,
    begun: Vec<u64>,
    left: Vec<u64>,
    popped: Vec<Vec<u64>>,
    idle_at: u64,
}

/// A queue behind a pipeline: memory, the word read, the register, and the places that are taken. Some rest for a cycle
/// after an entry has left.
struct NaiveBuffer<T> {
    rests: bool,
    memory: VecDeque<T>,
    word: Option<T>,
    out: Option<T>,
    occupied: usize,
}

impl<T> NaiveBuffer<T> {
    fn new(rests: bool) -> Self {
        NaiveBuffer {
            rests,
            memory: VecDeque::new(),
            word: None,
            out: None,
            occupied: 0,
        }
    }

    /// The clock's edge: a place is claimed, an entry comes in, the one at the end leaves.
    fn edge(&mut self, claim: bool, entry: Option<T>, leaves: bool) {
        self.occupied = self.occupied + usize::from(claim) - usize::from(leaves);
        let rests_now = leaves && self.rests;
        if leaves {
            self.out = None;
        }
        if self.out.is_none() && !rests_now {
            self.out = self.word.take();
        }
        if self.word.is_none() {
            self.word = self.memory.pop_front();
        }
        self.memory.extend(entry);
    }
}

/// A lane: its queue, the run at the queue's front, pixels to come of the run that it draws (row, column, count), and
/// where it has been.
struct NaiveLane {
    queue: VecDeque<LaneRun>,
    front: Option<LaneRun>,
    at: Option<(u16, u16, u16)>,
    been: [Option<(u16, u16)>; 5],
    /// Was the run at the front there in the cycle before?
    compared: bool,
}

impl NaiveLane {
    /// The run at the front, if it is popped now.
    fn popped(&self) -> Option<LaneRun> {
        let last = self.at.is_none_or(|(_, _, count)| count == 1);
        let run = self.front.filter(|_| last && self.compared)?;
        let here = self.at.map(|(row, column, _)| (row, column));
        let places = std::iter::once(here).chain(self.been);
        // Its pixel at a place left `age` cycles ago would come at least 7 cycles after that.
        let meets = (1..).zip(places).any(|(age, place)| {
            place.is_some_and(|(row, column)| {
                let ahead = column.wrapping_sub(run.column);
                row == run.row && ahead < run.length && ahead + age < 7
            })
        });
        (!meets).then_some(run)
    }

    fn edge(&mut self, entry: Option<LaneRun>) {
        let popped = self.popped();
        self.been.rotate_right(1);
        self.been[0] = self.at.map(|(row, column, _)| (row, column));
        self.at = match (popped, self.at) {
            (Some(run), _) => Some((run.row, run.column, run.length)),
            (None, Some((row, column, count))) if count > 1 => Some((row, column + 1, count - 1)),
            _ => None,
        };
        self.compared = self.front.is_some() && popped.is_none();
        if popped.is_some() {
            self.front = None;
        }
        if self.front.is_none() {
            self.front = self.queue.pop_front();
        }
        self.queue.extend(entry);
    }

    fn idle(&self) -> bool {
        self.queue.is_empty() && self.front.is_none() && self.at.is_none()
    }
}

fn clocked(
    packets: &[NaivePacket],
    lanes: usize,
    queue: usize,
    intervals: Intervals,
) -> Handshakes {
    let mut setup: [Option<usize>; 24] = [None; 24];
    let mut splats = NaiveBuffer::new(true);
    let mut issued: Option<(usize, usize)> = None;
    let mut rows: [Option<Option<LaneRun>>; 32] = [None; 32];
    let mut slots = NaiveBuffer::new(false);
    let lane = || NaiveLane {
        queue: VecDeque::new(),
        front: None,
        at: None,
        been: [None; 5],
        compared: false,
    };
    let mut units: Vec<NaiveLane> = (0..lanes).map(|_| lane()).collect();
    let mut seen = Handshakes {
        popped: vec![Vec::new(); lanes],
        ..Handshakes::default()
    };
    let mut says_idle = false;
    for now in 0.. {
        if seen.accepted.len() == packets.len() && says_idle {
            seen.idle_at = now;
            return seen;
        }
        // What the wires say in this cycle.
        let leaving: Option<Option<LaneRun>> = slots.out;
        let leaves =
            leaving.is_some_and(|run| run.is_none_or(|run| units[run.lane].queue.len() < queue));
        let turn = now % u64::from(intervals.rows) == 0;
        let issues = issued.filter(|_| slots.occupied < 64 && turn);
        let last = issues.is_some_and(|(splat, row)| row + 1 == packets[splat].1.len());
        let takes_splat = issued.is_none() || last;
        let begins: Option<usize> = splats.out.filter(|_| takes_splat);
        let packet = Some(seen.accepted.len()).filter(|next| {
            now % u64::from(intervals.setup) == 0
                && splats.occupied < 32
                && packets.get(*next).is_some_and(|(from, _)| *from <= now)
        });
        says_idle = splats.occupied == 0
            && issued.is_none()
            && slots.occupied == 0
            && units.iter().all(NaiveLane::idle)
            && packet.is_none();
        // The clock's edge.
        for (number, unit) in units.iter_mut().enumerate() {
            seen.popped[number].extend(unit.popped().map(|_| now));
            let entry = leaving.flatten().filter(|run| leaves && run.lane == number);
            seen.left.extend(entry.map(|_| now));
            unit.edge(entry);
        }
        slots.edge(issues.is_some(), rows[31], leaves);
        rows.rotate_right(1);
        rows[0] = issues.map(|(splat, row)| packets[splat].1[row]);
        splats.edge(packet.is_some(), setup[23], begins.is_some());
        setup.rotate_right(1);
        setup[0] = packet;
        issued = if takes_splat {
            begins.map(|splat| (splat, 0))
        } else {
            issues.map(|(splat, row)| (splat, row + 1)).or(issued)
        };
        seen.begun.extend(begins.map(|_| now));
        seen.accepted.extend(packet.map(|_| now));
    }
    seen
}

fn recurrence(
    packets: &[NaivePacket],
    lanes: usize,
    queue: usize,
    intervals: Intervals,
) -> Handshakes {
    let mut clock = PrimitiveClock::new(lanes, queue as u32, intervals, 0);
    let mut seen = Handshakes {
        popped: vec![Vec::new(); lanes],
        ..Handshakes::default()
    };
    for (offered, rows) in packets {
        let stamp = clock.packet(*offered);
        seen.accepted.push(stamp.accepted);
        seen.begun.push(stamp.begun);
        for run in rows {
            let slot = clock.slot(*run);
            if let (Some(run), Some(popped)) = (run, slot.popped) {
                seen.left.push(slot.left);
                seen.popped[run.lane].push(popped);
            }
        }
    }
    seen.idle_at = clock.idle_at();
    seen
}

/// Packets with gaps between them; rows of neighbouring lanes, some of them empty, that often meet those before them.
fn packets() -> impl Strategy<Value = (Vec<NaivePacket>, usize, usize)> {
    let packet = (
        0u64..40,
        0u16..4,
        proptest::collection::vec((0u16..12, 0u16..8), 1..7),
    );
    let packets = proptest::collection::vec(packet, 1..80);
    (packets, 0u32..3, 1usize..5, any::<bool>()).prop_map(|(packets, lanes, queue, gaps)| {
        let lanes = 1 << lanes;
        let mut offered = 0;
        let mut packet = |(gap, first, rows): (u64, u16, Vec<(u16, u16)>)| {
            offered += if gaps { gap } else { 0 };
            let run = |(row, (length, column)): (u16, (u16, u16))| {
                let lane = usize::from(row) % lanes;
                (length > 0).then_some(LaneRun {
                    lane,
                    row,
                    column,
                    length,
                })
            };
            (offered, (first..).zip(rows).map(run).collect())
        };
        let packets = packets.into_iter().map(&mut packet).collect();
        (packets, lanes, queue)
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]
    #[test]
    fn the_clock_is_that_of_the_registers((packets, lanes, queue) in packets()) {
        for intervals in [Intervals { setup: 1, ..Intervals::USUAL }, Intervals::USUAL, Intervals::SMALL] {
            let [clock, registers] = [recurrence, clocked].map(|run| run(&packets, lanes, queue, intervals));
            prop_assert_eq!(clock, registers);
        }
    }

    /// Tiles without splats keep the write channel for their bytes, as far as nobody waits for it, and change nothing
    /// else.
    #[test]
    fn backgrounds_take_what_the_channel_leaves(work in workload(), bandwidth in 1u32..64) {
        let config = Config { write_bandwidth: bandwidth, ..primitive(4) };
        let mut drawn = work.clone();
        let (mut first, mut empty) = (0, 0);
        drawn.tiles.retain(|tile| {
            let keeps = tile.pairs_end > std::mem::replace(&mut first, tile.pairs_end);
            empty += u64::from(!keeps);
            keeps
        });
        let [all, without] = [&work, &drawn].map(|work| simulate_alone(work, &config));
        let fill = (128 * u64::from(config.pixel_bytes)).div_ceil(bandwidth.into());
        let [lanes, channel] = ["lanes", "write_back"].map(|unit| [&all, &without].map(|timing| &timing.units[unit]));
        prop_assert_eq!((lanes[0].busy, &lanes[0].stalled), (lanes[1].busy, &lanes[1].stalled));
        prop_assert_eq!(channel[0].busy, channel[1].busy + empty * fill);
        prop_assert!(all.raster >= without.raster.max(channel[0].busy));
        prop_assert!(all.raster <= without.raster + empty * fill);
        prop_assert_eq!(all.bytes.pixels_written, 128 * 16 * work.tiles.len() as u64);
    }

    /// Accounts add up (asserted inside), and nothing gets faster with less memory.
    #[test]
    fn the_primitive_as_a_machine(work in workload(), lanes in 0u32..4, bandwidth in 1u32..64) {
        let config = primitive(1 << lanes);
        let slower = Config { read_bandwidth: bandwidth, write_bandwidth: bandwidth.min(config.write_bandwidth), ..config };
        prop_assert!(simulate_alone(&work, &config).raster <= simulate_alone(&work, &slower).raster);
    }
}
