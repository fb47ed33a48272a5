//! Co-simulation of the SystemVerilog splat primitive (`sim/rtl`) with the kernel that defines it.
//!
//! [`package`] writes the circuit's parameters from the kernel's, [`tables`] its tables; [`workload`] makes tiles of footprints; [`model`] is the
//! verilated circuit and the only place with foreign code; [`mod@bench`] drives a tile through it; [`golden`] draws the same tile by the
//! kernel; [`stamps`] holds the cycles of its handshakes against the machine's clock (`splatline_sim::machine::primitive`), and [`picture`] those of
//! whole pictures under a memory's limits; [`check`] puts all of them side by side, and [`suite`] does so for all circuits.
//! [`verilate`] and [`circuit`] build other circuits than those that are linked in, [`mutants`] shows that mistakes are noticed, [`switch`] puts many of them into one circuit, [`formal`] proves the queues, [`units`] checks what no packet reaches, [`area`] what the circuit costs, [`bitstream`] packs it for a device.

pub mod area;
pub mod bench;
pub mod bitstream;
pub mod check;
pub mod circuit;
pub mod clocked;
pub mod fmax;
pub mod formal;
pub mod golden;
#[cfg(all(test, has_rtl))]
mod handshakes;
pub mod harmonics;
pub mod machine;
pub mod model;
pub mod mutants;
pub mod order;
pub mod package;
pub mod picture;
pub mod placed;
pub mod registers;
pub mod roots;
pub mod setup;
pub mod stamps;
pub mod suite;
pub mod switch;
pub mod tables;
pub mod units;
pub mod verilate;
mod verilator;
pub mod workload;
