//! The splat primitive (`sim/rtl/splat_primitive.sv`): every word of its tile buffer against the kernel's, every
//! handshake inside it against the machine's clock (`splatline_sim::machine::primitive`).

mod stamps;
pub mod unit;
mod words;
pub mod workload;
