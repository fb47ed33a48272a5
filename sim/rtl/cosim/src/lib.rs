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
pub mod harmonics;
pub mod judges;
pub mod machine;
mod memory;
pub mod mutation;
mod netlist;
pub mod order;
pub mod package;
pub mod placement;
pub mod primitive;
mod registers;
pub mod rules;
mod scenes;
pub mod setup;
pub mod simulation;
pub mod tables;
pub mod tools;
pub mod unit;
