//! A verilated circuit behind a safe handle: its ports by name, and half cycles of its clock.
#![allow(unsafe_code)]

use crate::mutation::MutationNumber;
use anyhow::{Context, Result};
use libloading::Library;
use std::collections::HashMap;
use std::ffi::{CStr, c_char, c_void};
use std::path::Path;

/// A circuit being simulated.
pub struct Simulation {
    state: *mut c_void,
    eval: unsafe extern "C" fn(*mut c_void, u8),
    destroy: unsafe extern "C" fn(*mut c_void),
    ports: Vec<PortData>,
    names: HashMap<String, Port>,
    /// Keeps the code loaded.
    _library: Library,
}

/// A port of the circuit; mirrors `Port` of shim.cpp.
#[repr(C)]
#[derive(Clone, Copy)]
struct PortData {
    name: *const c_char,
    data: *mut c_void,
    bits: u32,
    is_input: bool,
}

/// A port's place among those of its circuit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Port(usize);

impl Simulation {
    /// The circuit in a library that [`Circuit`](crate::circuit::Circuit) has built, with the mutation of this number;
    /// 0 is none. The seed chooses what its registers hold; inputs are 0.
    pub fn new(library: &Path, seed: u32, mutation: MutationNumber) -> Result<Simulation> {
        // SAFETY: the library is the shim and a verilated model, whose loading runs no code of its own; the symbols
        // have the shim's types, and the simulation is freed by the same library before that is unloaded. A port may be
        // all zeros.
        unsafe {
            let library = Library::new(library).context("a circuit's library")?;
            let make: unsafe extern "C" fn(u32, u32) -> *mut c_void =
                *library.get(b"circuit_make")?;
            let port: unsafe extern "C" fn(*mut c_void, usize, *mut PortData) -> bool =
                *library.get(b"circuit_port")?;
            let mut simulation = Simulation {
                state: make(seed, mutation as u32),
                eval: *library.get(b"circuit_eval")?,
                destroy: *library.get(b"circuit_destroy")?,
                ports: Vec::new(),
                names: HashMap::new(),
                _library: library,
            };
            let mut found: PortData = std::mem::zeroed();
            while port(simulation.state, simulation.ports.len(), &mut found) {
                let name = CStr::from_ptr(found.name).to_str()?.to_owned();
                let place = Port(simulation.ports.len());
                simulation.names.insert(name, place);
                simulation.ports.push(found);
                if found.is_input {
                    simulation.set(place, 0);
                }
            }
            Ok(simulation)
        }
    }

    /// The port of this name; panics if the circuit has none.
    pub fn port(&self, name: &str) -> Port {
        let port = self.names.get(name);
        *port.unwrap_or_else(|| panic!("the circuit has no port '{name}'"))
    }

    /// The ports of these names.
    pub fn ports<const N: usize>(&self, names: [&str; N]) -> [Port; N] {
        names.map(|name| self.port(name))
    }

    /// Drives a port with a number; what does not fit is cut off.
    pub fn set(&mut self, port: Port, value: u64) {
        self.set_words(port, &[value as u32, (value >> 32) as u32]);
    }

    /// Drives a port of any width with words of 32 bits; words that are missing are 0.
    pub fn set_words(&mut self, port: Port, words: &[u32]) {
        let PortData { data, bits, .. } = self.ports[port.0];
        for index in 0..bits.div_ceil(32) as usize {
            let kept = (bits - 32 * index as u32).min(32);
            let word = words.get(index).copied().unwrap_or(0) & (u32::MAX >> (32 - kept));
            // SAFETY: the pointer is the port's in the living model, which stores up to 32 bits in the smallest C
            // integer that holds them, and more of them in words of 32 bits or in an integer of two such words, the
            // lower one first.
            unsafe {
                match bits {
                    0..=8 => *data.cast() = word as u8,
                    9..=16 => *data.cast() = word as u16,
                    _ => *data.cast::<u32>().add(index) = word,
                }
            }
        }
    }

    /// What is at a port; of one with more than 64 bits the lowest.
    pub fn get(&self, port: Port) -> u64 {
        let word = |index| u64::from(self.word(port, index));
        match self.ports[port.0].bits {
            0..=32 => word(0),
            _ => word(0) | word(1) << 32,
        }
    }

    /// Is a port of one bit set?
    pub fn is(&self, port: Port) -> bool {
        self.get(port) != 0
    }

    /// What is at the port of this name.
    pub fn read(&self, name: &str) -> u64 {
        self.get(self.port(name))
    }

    /// A port's words.
    pub fn words(&self, port: Port) -> Vec<u32> {
        let count = self.ports[port.0].bits.div_ceil(32) as usize;
        (0..count).map(|index| self.word(port, index)).collect()
    }

    fn word(&self, port: Port, index: usize) -> u32 {
        let PortData { data, bits, .. } = self.ports[port.0];
        // SAFETY: as in `set_words`; the port has this word.
        unsafe {
            match bits {
                0..=8 => u32::from(*data.cast::<u8>()),
                9..=16 => u32::from(*data.cast::<u16>()),
                _ => *data.cast::<u32>().add(index),
            }
        }
    }

    /// The outputs follow the inputs, before the clock's edge.
    pub fn settle(&mut self) {
        // SAFETY: the simulation was made by the same library.
        unsafe { (self.eval)(self.state, 0) };
    }

    /// The clock's edge.
    pub fn edge(&mut self) {
        // SAFETY: as in `settle`.
        unsafe { (self.eval)(self.state, 1) };
    }
}

impl Drop for Simulation {
    fn drop(&mut self) {
        // SAFETY: made by the same library, not used afterwards; the library is dropped after this.
        unsafe { (self.destroy)(self.state) }
    }
}
