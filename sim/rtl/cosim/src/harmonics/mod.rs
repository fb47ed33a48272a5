//! The harmonics unit (`sim/rtl/harmonics_unit.sv`): its program, and its co-simulation with the kernel's
//! `setup::harmonics`.
//!
//! [`program`] is the basis as a list of sums, put in an order and written as a circuit reads it; `loads` makes splats
//! and [`unit`](mod@unit) compares every colour.

pub(crate) mod loads;
pub mod program;
pub mod unit;
