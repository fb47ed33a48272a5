//! A memory of 16-byte words behind a port that reads and writes at the same time, with latency and random pauses.
//!
//! A word is read as it stands when it is asked for, and written some cycles after it was handed over: who reads what is still being written gets what was
//! there before, as on a bus that promises no order between the two directions. A narrower memory behind the port moves a word in several beats; of a
//! word that is written only those are moved in which anything changes.

use crate::random::split_mix;
use crate::simulation::{Port, Simulation};
use anyhow::Result;
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
}

/// A memory beside a circuit.
pub struct Memory {
    /// What it holds.
    pub words: Vec<[u32; 4]>,
    /// Words read.
    pub read: u64,
    /// Words written.
    pub written: u64,
    /// Accesses beyond its end.
    pub beyond: u64,
    timing: MemoryTiming,
    random: u64,
    now: u64,
    /// When all beats before have been moved.
    read_free: u64,
    write_free: u64,
    reads: VecDeque<(u64, [u32; 4])>,
    writes: VecDeque<MemoryWrite>,
    ports: MemoryPorts,
}

struct MemoryWrite {
    due: u64,
    address: usize,
    strobe: u32,
    word: [u32; 4],
}

struct MemoryPorts {
    read_valid: Port,
    read_ready: Port,
    read_address: Port,
    word_valid: Port,
    word: Port,
    write_valid: Port,
    write_ready: Port,
    write_address: Port,
    write_word: Port,
    write_strobe: Port,
    settled: Port,
}

impl Memory {
    /// A memory with these words at the circuit's port. Nothing may be asked for before.
    pub fn new(
        circuit: &Simulation,
        words: Vec<[u32; 4]>,
        timing: MemoryTiming,
        seed: u64,
    ) -> Result<Memory> {
        let port = |name| circuit.port(name);
        Ok(Memory {
            words,
            read: 0,
            written: 0,
            beyond: 0,
            timing,
            random: seed,
            now: 0,
            read_free: 0,
            write_free: 0,
            reads: VecDeque::new(),
            writes: VecDeque::new(),
            ports: MemoryPorts {
                read_valid: port("read_valid")?,
                read_ready: port("read_ready")?,
                read_address: port("read_address")?,
                word_valid: port("word_valid")?,
                word: port("word")?,
                write_valid: port("write_valid")?,
                write_ready: port("write_ready")?,
                write_address: port("write_address")?,
                write_word: port("write_word")?,
                write_strobe: port("write_strobe")?,
                settled: port("settled")?,
            },
        })
    }

    /// The first half of a cycle: what the circuit sees, and its outputs.
    pub fn settle(&mut self, circuit: &mut Simulation) {
        while let Some(write) = self.writes.pop_front_if(|write| write.due <= self.now) {
            for (lane, value) in write.word.into_iter().enumerate() {
                if write.strobe >> lane & 1 == 1 {
                    self.words[write.address][lane] = value;
                }
            }
        }
        let paused = [(); 2].map(|()| split_mix(&mut self.random) % 8 < self.timing.pauses);
        let ports = &self.ports;
        let readable = !paused[0] && self.now >= self.read_free;
        let writable = !paused[1] && self.now >= self.write_free;
        circuit.set(ports.read_ready, readable.into());
        circuit.set(ports.write_ready, writable.into());
        circuit.set(ports.settled, self.writes.is_empty().into());
        let arrived = self.reads.front().filter(|(due, _)| *due <= self.now);
        circuit.set(ports.word_valid, arrived.is_some().into());
        if let Some((_, word)) = arrived {
            circuit.set_words(ports.word, word);
        }
        circuit.settle();
    }

    /// The second half: what the circuit asks for, and the clock's edge.
    pub fn edge(&mut self, circuit: &mut Simulation) {
        let ports = &self.ports;
        let both = |valid, ready| circuit.is(valid) && circuit.is(ready);
        if circuit.is(ports.word_valid) {
            self.reads.pop_front();
        }
        if both(ports.read_valid, ports.read_ready) {
            self.read_free = self.now + self.beats(0xf);
            let word = self.words.get(circuit.get(ports.read_address) as usize);
            self.beyond += u64::from(word.is_none());
            let due = self.read_free + self.timing.latency;
            self.reads.push_back((due, word.copied().unwrap_or([0; 4])));
            self.read += 1;
        }
        if both(ports.write_valid, ports.write_ready) {
            let strobe = circuit.get(ports.write_strobe) as u32;
            let address = circuit.get(ports.write_address) as usize;
            self.write_free = self.now + self.beats(strobe);
            let mut word = [0; 4];
            word.copy_from_slice(&circuit.words(ports.write_word));
            if address < self.words.len() {
                self.writes.push_back(MemoryWrite {
                    due: self.write_free + self.timing.latency,
                    address,
                    strobe,
                    word,
                });
            } else {
                self.beyond += 1;
            }
            self.written += 1;
        }
        self.now += 1;
        circuit.edge();
    }

    /// A whole cycle.
    pub fn cycle(&mut self, circuit: &mut Simulation) {
        self.settle(circuit);
        self.edge(circuit);
    }

    fn beats(&self, strobe: u32) -> u64 {
        let lanes = self.timing.bytes / 4;
        let beat = (1 << lanes) - 1;
        let moved = |place: &u32| strobe >> place & beat != 0;
        (0..4).step_by(lanes as usize).filter(moved).count() as u64
    }
}
