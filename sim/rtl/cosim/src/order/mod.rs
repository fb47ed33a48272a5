//! Sorter and binning (`sim/rtl/splat_order.sv`) against the kernel's order and the model's lists.

pub(crate) mod loads;
pub mod unit;
