//! Order and binning in hardware (`sim/rtl/splat_order.sv`): its co-simulation with the kernel's order and the model's lists, its mistakes, and what
//! the ways of sorting cost (`docs/decisions/depth-order.md`).

pub mod bench;
pub mod circuit;
pub mod loads;
pub mod mistakes;
pub mod model;
