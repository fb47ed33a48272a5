//! The primitive's clock against its registers: the circuit of `sim/rtl`, stage by stage, without its data.

use super::super::config::Config;
use super::super::primitive::{LaneRun, PrimitiveClock};
use super::super::simulate_alone;
use super::workload;
use proptest::prelude::*;
use std::collections::VecDeque;

/// A packet: the cycle from which it is offered, and its rows.
type Packet = (u64, Vec<Option<LaneRun>>);

/// Cycles of all handshakes: packets, splats, and runs into queues and out of them (lane by lane).
#[derive(Debug, Default, PartialEq)]
struct Handshakes {
    taken: Vec<u64>,
    begun: Vec<u64>,
    left: Vec<u64>,
    popped: Vec<Vec<u64>>,
    idle_at: u64,
}

/// The registers: setup's stages, the splat whose rows are issued, the rows' stages, queues, and pixels to come in each lane.
struct Registers {
    setup: [Option<usize>; 8],
    issued: Option<(usize, usize)>,
    rows: [Option<Option<LaneRun>>; 12],
    queues: Vec<VecDeque<LaneRun>>,
    pixels: Vec<u16>,
}

impl Registers {
    fn idle(&self) -> bool {
        let pipelines = self.setup.iter().all(Option::is_none)
            && self.issued.is_none()
            && self.rows.iter().all(Option::is_none);
        pipelines
            && self.queues.iter().all(VecDeque::is_empty)
            && self.pixels.iter().all(|left| *left == 0)
    }
}

fn clocked(packets: &[Packet], lanes: usize, queue: usize) -> Handshakes {
    let mut at = Registers {
        setup: [None; 8],
        issued: None,
        rows: [None; 12],
        queues: vec![VecDeque::new(); lanes],
        pixels: vec![0; lanes],
    };
    let mut seen = Handshakes {
        popped: vec![Vec::new(); lanes],
        ..Handshakes::default()
    };
    for now in 0.. {
        if seen.taken.len() == packets.len() && at.idle() {
            seen.idle_at = now;
            return seen;
        }
        // What the wires say in this cycle.
        let leaving = at.rows[11].flatten();
        let rows_move = leaving.is_none_or(|run| at.queues[run.lane].len() < queue);
        let last_row = at
            .issued
            .is_none_or(|(splat, row)| row + 1 == packets[splat].1.len());
        let takes_splat = rows_move && last_row;
        let setup_moves = at.setup[7].is_none() || takes_splat;
        let packet = Some(seen.taken.len())
            .filter(|next| setup_moves && packets.get(*next).is_some_and(|(from, _)| *from <= now));
        // The clock's edge.
        for lane in 0..lanes {
            if at.pixels[lane] <= 1
                && let Some(run) = at.queues[lane].pop_front()
            {
                at.pixels[lane] = run.length;
                seen.popped[lane].push(now);
            } else {
                at.pixels[lane] = at.pixels[lane].saturating_sub(1);
            }
        }
        if rows_move {
            if let Some(run) = leaving {
                at.queues[run.lane].push_back(run);
                seen.left.push(now);
            }
            at.rows.rotate_right(1);
            at.rows[0] = at.issued.map(|(splat, row)| packets[splat].1[row]);
            at.issued = at.issued.map(|(splat, row)| (splat, row + 1));
        }
        if takes_splat {
            at.issued = at.setup[7].map(|splat| (splat, 0));
            seen.begun.extend(at.setup[7].map(|_| now));
        }
        if setup_moves {
            at.setup.rotate_right(1);
            at.setup[0] = packet;
            seen.taken.extend(packet.map(|_| now));
        }
    }
    seen
}

fn recurrence(packets: &[Packet], lanes: usize, queue: usize) -> Handshakes {
    let mut clock = PrimitiveClock::new(lanes, queue as u32);
    let mut seen = Handshakes {
        popped: vec![Vec::new(); lanes],
        ..Handshakes::default()
    };
    for (offered, rows) in packets {
        let stamp = clock.packet(*offered);
        seen.taken.push(stamp.taken);
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

/// Packets with gaps between them; rows of neighbouring lanes, some of them empty.
fn packets() -> impl Strategy<Value = (Vec<Packet>, usize, usize)> {
    let packet = (
        0u64..40,
        0usize..4,
        proptest::collection::vec(0u16..12, 1..7),
    );
    let packets = proptest::collection::vec(packet, 1..40);
    (packets, 0u32..3, 1usize..5, any::<bool>()).prop_map(|(packets, lanes, queue, gaps)| {
        let lanes = 1 << lanes;
        let mut offered = 0;
        let mut packet = |(gap, first, lengths): (u64, usize, Vec<u16>)| {
            offered += if gaps { gap } else { 0 };
            let run = |(row, length): (usize, u16)| {
                let lane = (first + row) % lanes;
                (length > 0).then_some(LaneRun { lane, length })
            };
            (offered, lengths.into_iter().enumerate().map(run).collect())
        };
        let packets = packets.into_iter().map(&mut packet).collect();
        (packets, lanes, queue)
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]
    #[test]
    fn the_clock_is_that_of_the_registers((packets, lanes, queue) in packets()) {
        prop_assert_eq!(recurrence(&packets, lanes, queue), clocked(&packets, lanes, queue));
    }

    /// Accounts add up (asserted inside), and nothing gets faster with less memory.
    #[test]
    fn the_primitive_as_a_machine(work in workload(), lanes in 0u32..4, bandwidth in 1u32..64) {
        let config = Config { tile_width: 16, tile_height: 8, ..Config::primitive(1 << lanes) };
        let slower = Config { read_bandwidth: bandwidth, write_bandwidth: bandwidth, ..config };
        prop_assert!(simulate_alone(&work, &config).raster <= simulate_alone(&work, &slower).raster);
    }
}
