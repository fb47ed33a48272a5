//! The one port to a memory part that all units share, and who may use it when.
//!
//! Requests are served oldest first. Reads are asked for in the order of time, because the machine always moves on the
//! unit whose next read is the earliest. Writes lie in a queue until one of three things happens: the bus would
//! otherwise be idle before the next read; the queue is full, and half of it is written in one go, so that the bus
//! turns seldom; or a unit needs to know that its write is over.
//!
//! A unit that reads a stream keeps the last burst, so that what lies in it is not read again. A write of less than a
//! burst takes a whole one.

use super::dram::{Dram, DramCounts};
use super::parts::DramPart;
use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

/// When a request was on the bus, in machine cycles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Served {
    /// The first cycle with data.
    pub start: u64,
    /// The cycle in which all of it has been moved.
    pub end: u64,
}

/// A write by its number.
pub type WriteId = u64;

/// One access, as traces show it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Access {
    /// Machine cycle in which it was asked for.
    pub cycle: u64,
    /// First byte of the burst.
    pub address: u64,
    /// To memory?
    pub write: bool,
}

/// A reader's or a writer's place in memory: the burst that it has at hand.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Stream {
    /// Number of the burst plus one; 0 for none.
    last: u64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Write {
    at: u64,
    id: WriteId,
    address: u64,
    bytes: u64,
    /// Will somebody ask when it was served?
    awaited: bool,
}

/// The port.
#[derive(Clone, Debug)]
pub struct Port {
    part: &'static DramPart,
    dram: Dram,
    clock_khz: u64,
    queue: usize,
    waiting: BinaryHeap<Reverse<Write>>,
    over: BTreeMap<WriteId, Served>,
    next: WriteId,
    /// Cycles of the phases that are over.
    before: u64,
    /// Every burst in cycles of the picture, if somebody wants them.
    pub trace: Option<Vec<Access>>,
}

impl Port {
    /// A port of a machine with this clock, whose queue holds so many writes.
    pub fn new(part: &'static DramPart, clock_mhz: u32, queue: u32) -> Port {
        Port {
            part,
            dram: Dram::new(part),
            clock_khz: 1000 * u64::from(clock_mhz.max(1)),
            queue: queue.max(1) as usize,
            waiting: BinaryHeap::new(),
            over: BTreeMap::new(),
            next: 0,
            before: 0,
            trace: None,
        }
    }

    /// What the part did so far.
    pub fn counts(&self) -> DramCounts {
        self.dram.counts
    }

    /// Reads bytes that a unit asks for in a cycle.
    pub fn read(&mut self, at: u64, address: u64, bytes: u64) -> Served {
        self.write_before(at);
        self.serve(at, address, bytes, false)
    }

    /// Reads on in a stream: nothing if its last burst holds all of it.
    pub fn read_on(
        &mut self,
        stream: &mut Stream,
        at: u64,
        address: u64,
        bytes: u64,
    ) -> Option<Served> {
        let [address, bytes] = self.rest(stream, address, bytes)?;
        Some(self.read(at, address, bytes))
    }

    /// The bursts, as address and bytes, that a stream does not have at hand, which it has afterwards; nothing if it
    /// has all.
    #[inline(always)]
    fn rest(&self, stream: &mut Stream, address: u64, bytes: u64) -> Option<[u64; 2]> {
        let (first, last) = self.bursts(address, bytes);
        let first = first + u64::from(stream.last == first + 1);
        stream.last = last + 1;
        let size = self.part.burst_bytes();
        (first <= last).then_some([first * size, (last + 1).saturating_sub(first) * size])
    }

    /// Queues a write that a unit has ready in a cycle; gives the cycle in which the queue takes it.
    pub fn write(&mut self, at: u64, address: u64, bytes: u64) -> u64 {
        self.queue_up(at, address, bytes, false).1
    }

    /// The same for a write of which [`Port::completed`] will be asked.
    pub fn write_kept(&mut self, at: u64, address: u64, bytes: u64) -> WriteId {
        self.queue_up(at, address, bytes, true).0
    }

    fn queue_up(&mut self, at: u64, address: u64, bytes: u64, awaited: bool) -> (WriteId, u64) {
        let mut accepted = at;
        if self.waiting.len() >= self.queue {
            for _ in 0..self.queue.div_ceil(2) {
                // Each place is free when its write is over.
                accepted = accepted.max(self.write_one().map_or(0, |served| served.start));
            }
        }
        let id = self.next;
        self.next += 1;
        self.waiting.push(Reverse(Write {
            at,
            id,
            address,
            bytes,
            awaited,
        }));
        (id, accepted)
    }

    /// Writes on in a stream, which holds a burst back until it is whole.
    pub fn write_on(&mut self, stream: &mut Stream, at: u64, address: u64, bytes: u64) -> u64 {
        match self.rest(stream, address, bytes) {
            Some([address, bytes]) => self.write(at, address, bytes),
            None => at,
        }
    }

    /// When a write was served: now, if it has not been yet, with all that are older.
    pub fn completed(&mut self, id: WriteId) -> Served {
        while !self.over.contains_key(&id) && self.write_one().is_some() {}
        self.over.remove(&id).unwrap_or_default()
    }

    /// Serves all writes, and begins another phase from cycle 0 with all rows closed; gives the cycle in which nothing
    /// is on the bus any more and the units, which took so many cycles, have ended.
    pub fn end_of_phase(&mut self, cycles: u64) -> u64 {
        while self.write_one().is_some() {}
        let end = self.machine(self.dram.idle_at()).max(cycles);
        self.before += end;
        let counts = self.dram.counts;
        self.dram = Dram::new(self.part);
        self.dram.counts = counts;
        end
    }

    /// Writes for which the bus has time before a read, and half of a full queue.
    fn write_before(&mut self, at: u64) {
        let due = |port: &Port| {
            port.waiting
                .peek()
                .is_some_and(|Reverse(write)| write.at <= at)
        };
        if self.waiting.len() >= self.queue {
            for _ in 0..self.queue.div_ceil(2) {
                if due(self) {
                    self.write_one();
                }
            }
        }
        while due(self) && self.time_for_a_write(at) {
            self.write_one();
        }
    }

    /// Would the oldest write be over, and the bus turned again, before a cycle?
    fn time_for_a_write(&self, at: u64) -> bool {
        let Some(Reverse(write)) = self.waiting.peek() else {
            return false;
        };
        let part = self.part;
        let free = self.dram.idle_at().max(self.part_clock(write.at));
        let bursts = write.bytes.div_ceil(part.burst_bytes());
        let takes = part.rcd + part.cwl + bursts * part.burst_clocks() + part.wtr;
        free + takes <= self.part_clock(at)
    }

    fn write_one(&mut self) -> Option<Served> {
        let Reverse(write) = self.waiting.pop()?;
        let served = self.serve(write.at, write.address, write.bytes, true);
        if write.awaited {
            self.over.insert(write.id, served);
        }
        Some(served)
    }

    fn serve(&mut self, at: u64, address: u64, bytes: u64, write: bool) -> Served {
        let (first, last) = self.bursts(address, bytes);
        let requested = self.part_clock(at);
        let mut served: Option<Served> = None;
        for burst in first..=last {
            let address = burst * self.part.burst_bytes();
            let transfer = self.dram.burst(requested, address, write);
            if let Some(trace) = &mut self.trace {
                trace.push(Access {
                    cycle: self.before + at,
                    address,
                    write,
                });
            }
            let start = served.map_or(self.machine(transfer.start), |served| served.start);
            let end = self.machine(transfer.end);
            served = Some(Served { start, end });
        }
        served.unwrap_or_default()
    }

    /// Numbers of the first and last burst of some bytes, at least one.
    fn bursts(&self, address: u64, bytes: u64) -> (u64, u64) {
        let size = self.part.burst_bytes();
        (address / size, (address + bytes.max(1) - 1) / size)
    }

    /// A machine cycle in clocks of the part, rounded up.
    fn part_clock(&self, cycle: u64) -> u64 {
        convert(cycle, self.part.khz, self.clock_khz)
    }

    /// A clock of the part in machine cycles, rounded up.
    fn machine(&self, clock: u64) -> u64 {
        convert(clock, self.clock_khz, self.part.khz)
    }
}

fn convert(time: u64, to: u64, from: u64) -> u64 {
    let product = u128::from(time) * u128::from(to);
    u64::try_from(product.div_ceil(u128::from(from))).unwrap_or(u64::MAX)
}
