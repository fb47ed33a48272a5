//! The verilated splat primitive behind a safe handle.
#![allow(unsafe_code)]

use crate::switch::MistakeNumber;
use libloading::Library;
use std::ffi::c_void;
use std::fmt;
use std::path::Path;

/// Cycles for which a new circuit is reset.
pub const RESET_CYCLES: u64 = 4;

/// The circuit's inputs in one cycle; `Inputs` of shim.cpp.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct Inputs {
    /// Reset.
    pub rst: u8,
    /// A footprint table entry is written.
    pub table_valid: u8,
    /// A tile is offered.
    pub tile_valid: u8,
    /// A packet is offered.
    pub packet_valid: u8,
    /// No packet follows; read out.
    pub finish_valid: u8,
    /// A pixel of the read-out is taken.
    pub pixel_ready: u8,
    /// The lanes may move.
    pub lanes_enable: u8,
    /// The rules' `omit_finishing`.
    pub omit_finishing: u8,
    /// The footprint table ends at r = 16.
    pub wide_table: u8,
    /// Sign of what the units are fed with.
    pub unit_negative: u8,
    /// Padding.
    pub spare: [u8; 2],
    /// The tile's window.
    pub first_column: u16,
    /// The tile's window.
    pub first_row: u16,
    /// The tile's window.
    pub end_column: u16,
    /// The tile's window.
    pub end_row: u16,
    /// UQ1.alpha.
    pub alpha_max: u32,
    /// UQ1.transmittance.
    pub minimum_transmittance: u32,
    /// Entry of the footprint table.
    pub table_index: u32,
    /// UQ1.weight.
    pub table_low: u32,
    /// UQ1.weight.
    pub table_step: u32,
    /// Products of peak and weight below it are skipped, UQ1.(peak + weight).
    pub least: u64,
    /// Magnitude of what the units are fed with, 40 bits.
    pub unit_magnitude: u64,
    /// What it is aligned by.
    pub unit_shift: u16,
    /// Padding.
    pub spare2: u16,
    /// The packet's words.
    pub packet: Packet,
}

/// The circuit's outputs in one cycle, before its edge; `Outputs` of shim.cpp.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct Outputs {
    /// A tile is taken.
    pub tile_ready: u8,
    /// A packet is taken.
    pub packet_ready: u8,
    /// All packets are drawn.
    pub finish_ready: u8,
    /// A pixel is offered.
    pub pixel_valid: u8,
    /// Every packet's last pixel has left its lane.
    pub raster_idle: u8,
    /// Every pixel is in the tile buffer.
    pub idle: u8,
    /// The pixel's flag.
    pub finished: u8,
    /// The row generator takes a splat over from setup.
    pub splat_begun: u8,
    /// A run leaves the row generator for a queue.
    pub run_left: u8,
    /// Padding.
    pub spare: u8,
    /// A bit for each lane that pops a run from its queue.
    pub lanes_popped: u16,
    /// UQ1.transmittance.
    pub transmittance: u32,
    /// UQ5.accumulator.
    pub red: u32,
    /// UQ5.accumulator.
    pub green: u32,
    /// UQ5.accumulator.
    pub blue: u32,
    /// Packets dropped for their version.
    pub foreign_packets: u32,
    /// A root of the row unit, UQ0.24.
    pub root: u32,
    /// `squared` holds something that moves on.
    pub squared_valid: u8,
    /// `root` holds something that moves on.
    pub root_valid: u8,
    /// Sign of the mantissa that the units made three cycles later.
    pub normal_negative: u8,
    /// Padding.
    pub padding: u8,
    /// What the row unit takes a root of.
    pub squared: u64,
    /// What the units aligned, four cycles later.
    pub aligned: u64,
    /// That mantissa's magnitude.
    pub normal: u32,
    /// And its exponent.
    pub normal_exponent: u16,
    /// Padding.
    pub padding2: u16,
}

/// A pixel of the read-out; `ReadOut` of shim.cpp.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ReadOut {
    /// The pixel's flag.
    pub finished: u32,
    /// UQ1.transmittance.
    pub transmittance: u32,
    /// UQ5.accumulator.
    pub red: u32,
    /// UQ5.accumulator.
    pub green: u32,
    /// UQ5.accumulator.
    pub blue: u32,
}

/// What a tile took; `DrawnCycles` of shim.cpp.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DrawnCycles {
    /// From the tile's offer to its last pixel's read-out.
    pub cycles: u64,
    /// From the first packet's handshake to the last packet's last pixel; 0 without packets.
    pub raster_cycles: u64,
}

pub use splatline::footprint::packet::Packet;

/// Why there is no circuit to simulate.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Missing {
    /// The crate was built without Verilator.
    Verilator,
    /// No model of this design with so many lanes.
    Model(String, usize),
    /// A shared library that is no circuit.
    Library(String),
}

impl std::error::Error for Missing {}

impl fmt::Display for Missing {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Missing::Verilator => {
                write!(
                    formatter,
                    "verilator was not found when this was built: install it (apt-get install verilator) and build again"
                )
            }
            Missing::Model(design, lanes) => write!(
                formatter,
                "no circuit for design '{design}' with {lanes} lanes: lean18 and standard24 with 1 or 4 exist"
            ),
            Missing::Library(message) => write!(formatter, "not a circuit: {message}"),
        }
    }
}

/// A circuit being simulated.
pub struct Model {
    circuit: Circuit,
    cycles: u64,
}

impl Model {
    /// The circuit of a design after reset. The seed chooses what its registers held before.
    pub fn new(design: &str, lanes: usize, seed: u32) -> Result<Model, Missing> {
        let functions = linked::functions(design, lanes)?;
        Ok(Self::after_reset(Circuit::new(functions, None, seed, 0)))
    }

    /// The circuit `name` in a shared library made of a verilated model and the shim.
    pub fn from_library(path: &Path, name: &str, seed: u32) -> Result<Model, Missing> {
        Model::with_mistake(path, name, seed, 0)
    }

    /// The same with one of the mistakes that the circuit was built with ([`crate::switch`]); 0 is none.
    pub fn with_mistake(
        path: &Path,
        name: &str,
        seed: u32,
        mistake: MistakeNumber,
    ) -> Result<Model, Missing> {
        let (functions, library) = load(path, name)
            .map_err(|error| Missing::Library(format!("{}: {error}", path.display())))?;
        Ok(Self::after_reset(Circuit::new(
            functions,
            Some(library),
            seed,
            mistake,
        )))
    }

    fn after_reset(circuit: Circuit) -> Model {
        let mut model = Model { circuit, cycles: 0 };
        let reset = Inputs {
            rst: 1,
            ..Inputs::default()
        };
        for _ in 0..RESET_CYCLES {
            model.tick(&reset);
        }
        model
    }

    /// One cycle: the outputs belong to these inputs, before the clock's edge.
    pub fn tick(&mut self, inputs: &Inputs) -> Outputs {
        self.cycles += 1;
        self.circuit.tick(inputs)
    }

    /// A whole tile in one call, for speed: `inputs` offer it, the packets follow at once, and `pixels`, as many as its window has, are
    /// read out. Nothing if the circuit hangs.
    pub fn draw(
        &mut self,
        inputs: &Inputs,
        packets: &[Packet],
        pixels: &mut [ReadOut],
    ) -> Option<DrawnCycles> {
        let drawn = self.circuit.draw(inputs, packets, pixels)?;
        self.cycles += drawn.cycles;
        Some(drawn)
    }

    /// Cycles so far.
    pub fn cycles(&self) -> u64 {
        self.cycles
    }
}

type Make = unsafe extern "C" fn(u32, u32) -> *mut c_void;
type Destroy = unsafe extern "C" fn(*mut c_void);
type Tick = unsafe extern "C" fn(*mut c_void, *const Inputs, *mut Outputs);
type Draw = unsafe extern "C" fn(
    *mut c_void,
    *const Inputs,
    *const Packet,
    usize,
    *mut ReadOut,
    usize,
    *mut DrawnCycles,
) -> bool;

/// The C functions of one verilated model.
#[derive(Clone, Copy)]
struct Functions {
    make: Make,
    destroy: Destroy,
    tick: Tick,
    draw: Draw,
}

/// One simulation and the functions that belong to it.
struct Circuit {
    simulation: *mut c_void,
    functions: Functions,
    /// Keeps the code loaded, where it came from a shared library.
    _library: Option<Library>,
}

impl Circuit {
    fn new(
        functions: Functions,
        library: Option<Library>,
        seed: u32,
        mistake: MistakeNumber,
    ) -> Self {
        // SAFETY: the shim allocates a simulation that nothing else refers to; the library, if any, is still loaded.
        let simulation = unsafe { (functions.make)(seed, mistake as u32) };
        Circuit {
            simulation,
            functions,
            _library: library,
        }
    }

    fn tick(&mut self, inputs: &Inputs) -> Outputs {
        let mut outputs = Outputs::default();
        // SAFETY: the simulation came from the same model's `make`; both structs mirror the shim's and outlive the call.
        unsafe { (self.functions.tick)(self.simulation, inputs, &mut outputs) };
        outputs
    }

    fn draw(
        &mut self,
        inputs: &Inputs,
        packets: &[Packet],
        pixels: &mut [ReadOut],
    ) -> Option<DrawnCycles> {
        let mut drawn = DrawnCycles::default();
        // SAFETY: as in `tick`; the slices are passed with their lengths.
        let answered = unsafe {
            (self.functions.draw)(
                self.simulation,
                inputs,
                packets.as_ptr(),
                packets.len(),
                pixels.as_mut_ptr(),
                pixels.len(),
                &mut drawn,
            )
        };
        answered.then_some(drawn)
    }
}

impl Drop for Circuit {
    fn drop(&mut self) {
        // SAFETY: made by the same model's `make`, not used afterwards; the library is dropped after this.
        unsafe { (self.functions.destroy)(self.simulation) }
    }
}

/// The functions of the model `name` in a shared library.
fn load(path: &Path, name: &str) -> Result<(Functions, Library), libloading::Error> {
    // SAFETY: the library is the shim and a verilated model, whose loading runs no code of its own; the symbols have the
    // shim's types.
    unsafe {
        let library = Library::new(path)?;
        let functions = Functions {
            make: *library.get(format!("{name}_make").as_bytes())?,
            destroy: *library.get(format!("{name}_destroy").as_bytes())?,
            tick: *library.get(format!("{name}_tick").as_bytes())?,
            draw: *library.get(format!("{name}_draw").as_bytes())?,
        };
        Ok((functions, library))
    }
}

#[cfg(has_rtl)]
mod linked {
    use super::{DrawnCycles, Functions, Inputs, Missing, Outputs, Packet, ReadOut};
    use std::ffi::c_void;

    /// The functions of one model that build.rs has linked in.
    macro_rules! functions {
        ($make:ident, $destroy:ident, $tick:ident, $draw:ident) => {{
            unsafe extern "C" {
                fn $make(seed: u32, mistake: u32) -> *mut c_void;
                fn $destroy(simulation: *mut c_void);
                fn $tick(simulation: *mut c_void, inputs: *const Inputs, outputs: *mut Outputs);
                fn $draw(
                    simulation: *mut c_void,
                    inputs: *const Inputs,
                    packets: *const Packet,
                    count: usize,
                    pixels: *mut ReadOut,
                    pixel_count: usize,
                    drawn: *mut DrawnCycles,
                ) -> bool;
            }
            Functions {
                make: $make,
                destroy: $destroy,
                tick: $tick,
                draw: $draw,
            }
        }};
    }

    #[rustfmt::skip]
    pub fn functions(design: &str, lanes: usize) -> Result<Functions, Missing> {
        Ok(match (design, lanes) {
            ("lean18", 1) => functions!(lean18_1_make, lean18_1_destroy, lean18_1_tick, lean18_1_draw),
            ("lean18", 4) => functions!(lean18_4_make, lean18_4_destroy, lean18_4_tick, lean18_4_draw),
            ("standard24", 1) => functions!(standard24_1_make, standard24_1_destroy, standard24_1_tick, standard24_1_draw),
            ("standard24", 4) => functions!(standard24_4_make, standard24_4_destroy, standard24_4_tick, standard24_4_draw),
            _ => return Err(Missing::Model(design.to_owned(), lanes)),
        })
    }
}

#[cfg(not(has_rtl))]
mod linked {
    use super::{Functions, Missing};

    pub fn functions(_design: &str, _lanes: usize) -> Result<Functions, Missing> {
        Err(Missing::Verilator)
    }
}
