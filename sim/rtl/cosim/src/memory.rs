//! A memory of 16-byte words behind a port that reads and writes at the same time, with latency and random pauses.
//!
//! A word is read as it stands when it is asked for, and written some cycles after it was handed over: who reads what
//! is still being written gets what was there before, as on a bus that promises no order between the two directions. A
//! narrower memory behind the port moves a word in several beats; of a word that is written only those are moved in
//! which anything changes.

use crate::bench::Channel;
use crate::simulation::Simulation;
use splatline_sim::scene::synthetic::Random;
use std::collections::VecDeque;

/// How a memory behaves.
#[derive(Clone, Copy, Debug)]
pub struct MemoryTiming {
    /// Cycles from a request to its word, and from a word to its place.
    pub latency: u64,
    /// How many of 8 cycles it holds a request back.
    pub pauses: u64,
    /// Bytes that it moves in a cycle in each direction: 4, 8 or 16.
    pub bytes: u32,
    /// Is there no room for the last entry of the lists?
    pub full: bool,
}

/// With this latency and these pauses, for so many bytes.
pub const fn timing([latency, pauses]: [u64; 2], bytes: u32, full: bool) -> MemoryTiming {
    MemoryTiming {
        latency,
        pauses,
        bytes,
        full,
    }
}

/// A memory beside a circuit.
pub struct Memory {
    pub words: Vec<[u32; 4]>,
    /// Words read.
    pub read: u64,
    /// Words written.
    pub written: u64,
    /// Accesses beyond its end.
    pub beyond: u64,
    /// Cycles since the last access.
    pub idle: u64,
    timing: MemoryTiming,
    random: Random,
    now: u64,
    /// When all beats before have been moved: of words read, and of those written.
    free: [u64; 2],
    /// Words with the cycle in which they are due.
    reads: VecDeque<(u64, [u32; 4])>,
    /// The same with their addresses, without the quarters that stay as they are.
    writes: VecDeque<(u64, usize, [Option<u32>; 4])>,
    /// Requests for words, and words to be written.
    requests: [Channel; 2],
}

impl Memory {
    /// A memory with these words at the circuit's port. Nothing may be asked for before.
    pub fn new(at: &Simulation, words: Vec<[u32; 4]>, timing: MemoryTiming) -> Memory {
        let writing = ["write_address", "write_word", "write_strobe"];
        Memory {
            words,
            read: 0,
            written: 0,
            beyond: 0,
            idle: 0,
            timing,
            random: Random(1),
            now: 0,
            free: [0; 2],
            reads: VecDeque::new(),
            writes: VecDeque::new(),
            requests: [
                Channel::new(at, "read", &["read_address"]),
                Channel::new(at, "write", &writing),
            ],
        }
    }

    /// The first half of a cycle: what the circuit sees, and its outputs.
    pub fn settle(&mut self, circuit: &mut Simulation) {
        while let Some((_, address, word)) = self.writes.pop_front_if(|(due, ..)| *due <= self.now)
        {
            for (kept, value) in self.words[address].iter_mut().zip(word) {
                *kept = value.unwrap_or(*kept);
            }
        }
        let paused = [(); 2].map(|()| self.random.next() % 8 < self.timing.pauses);
        let sides = self.requests.iter().zip(self.free).zip(paused);
        for ((request, free), paused) in sides {
            circuit.set(request.ready, (!paused && self.now >= free).into());
        }
        circuit.set(circuit.port("settled"), self.writes.is_empty().into());
        let arrived = self.reads.front().filter(|(due, _)| *due <= self.now);
        circuit.set(circuit.port("word_valid"), arrived.is_some().into());
        if let Some((_, word)) = arrived {
            circuit.set_words(circuit.port("word"), word);
        }
        circuit.settle();
    }

    /// The second half: what the circuit asks for, and the clock's edge.
    pub fn edge(&mut self, circuit: &mut Simulation) {
        let [reading, writing] = &self.requests;
        if circuit.read("word_valid") == 1 {
            self.reads.pop_front();
        }
        self.idle += 1;
        if reading.moves(circuit) {
            self.free[0] = self.now + self.beats(0xf);
            let word = self.words.get(circuit.get(reading.data[0]) as usize);
            self.beyond += u64::from(word.is_none());
            let due = self.free[0] + self.timing.latency;
            self.reads.push_back((due, word.copied().unwrap_or([0; 4])));
            self.read += 1;
            self.idle = 0;
        }
        if writing.moves(circuit) {
            let [address, word, strobe] = [0, 1, 2].map(|place| circuit.words(writing.data[place]));
            let (address, strobe) = (address[0] as usize, strobe[0]);
            self.free[1] = self.now + self.beats(strobe);
            if address < self.words.len() {
                let due = self.free[1] + self.timing.latency;
                let lane = |lane| (strobe >> lane & 1 == 1).then_some(word[lane]);
                let lanes = [0, 1, 2, 3].map(lane);
                self.writes.push_back((due, address, lanes));
            } else {
                self.beyond += 1;
            }
            self.written += 1;
            self.idle = 0;
        }
        self.now += 1;
        circuit.edge();
    }

    /// A whole cycle.
    pub fn cycle(&mut self, circuit: &mut Simulation) {
        self.settle(circuit);
        self.edge(circuit);
    }

    /// What shows before any word is looked at: accesses beyond the memory, or that lists are said to be full that are
    /// not.
    pub fn astray(&self, full: bool) -> Option<String> {
        let beyond = self.beyond;
        (beyond > 0 || full != self.timing.full)
            .then(|| format!("{beyond} accesses astray, full: {full}"))
    }

    fn beats(&self, strobe: u32) -> u64 {
        let lanes = self.timing.bytes / 4;
        let beat = (1 << lanes) - 1;
        let moved = |place: &u32| strobe >> place & beat != 0;
        (0..4).step_by(lanes as usize).filter(moved).count() as u64
    }
}

/// A word of nothing.
pub fn noise(random: &mut Random) -> [u32; 4] {
    [(); 4].map(|()| random.next() as u32)
}
