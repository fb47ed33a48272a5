//! Co-simulation of the SystemVerilog circuits (`sim/rtl`) with the kernel and the machine's model, which define them.
//!
//! ```text
//! package, tables, setup::text, harmonics::program: parameters, tables and programs, from the kernel's
//!   -> circuit: a unit of a design, verilated into a library (mutation: with small mistakes in it)
//!   -> simulation: its ports and its clock, the only place with foreign code
//!   -> bench, memory: what drives it; rules: what it is told first
//!   -> unit: what is given to a circuit and compared, from which reports and judgements follow
//!   -> primitive, setup, harmonics, order, machine: loads and golden words of each
//! ```
//! [`judges`] says which comparison judges which mutations, [`formal`] proves what units promise; [`area`] and [`asic`]
//! count what circuits cost, [`placement`] how fast they are on a device.

mod adders;
pub mod area;
pub mod asic;
pub mod bench;
pub mod circuit;
pub mod formal;
/// The harmonics unit (`sim/rtl/harmonics_unit.sv`): its program is the basis as a list of sums, put in an order and
/// written as a circuit reads it; every colour is compared with the kernel's `setup::harmonics`.
pub mod harmonics {
    pub(crate) mod loads;
    pub mod program;
    pub mod unit;
}
pub mod judges;
/// The whole machine (`sim/rtl/splat_machine.sv`) from a memory image to a frame.
pub mod machine {
    pub mod area;
    mod image;
    mod loads;
    pub mod shell;
    pub mod unit;
    pub use loads::MachineLoad;
}
mod memory;
pub mod mutation;
mod netlist;
pub mod order;
pub mod package;
pub mod placement;
/// The splat primitive (`sim/rtl/splat_primitive.sv`): every word of its tile buffer against the kernel's, every
/// handshake inside it against the machine's clock (`splatline_sim::machine::primitive`).
pub mod primitive {
    mod stamps;
    pub mod unit;
    mod words;
    pub mod workload;
}
mod registers;
pub mod rules;
mod scenes;
/// The setup unit (`sim/rtl/setup_unit.sv`): its program, its constants, and its co-simulation with the kernel's
/// `setup`.
pub mod setup {
    mod assemble;
    pub(crate) mod constants;
    mod exact;
    mod loads;
    pub mod program;
    mod tables;
    pub mod text;
    pub mod unit;
    pub(crate) use loads::record;
    pub use loads::{SetupLoad, enlarged};
}
pub mod simulation;
pub mod tables;
pub mod tools;
pub mod unit;
