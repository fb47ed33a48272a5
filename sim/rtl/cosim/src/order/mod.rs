//! Sorter and binning (`sim/rtl/splat_order.sv`) against the kernel's order and the model's lists.

pub mod loads;
pub mod unit;
