//! The harmonics unit (`sim/rtl/harmonics_unit.sv`): its program, and its co-simulation with the kernel's `setup::harmonics`.
//!
//! `program` is the basis as a list of sums, `schedule` puts them in an order, [`text`] writes that as a circuit reads it; `loads` makes splats and
//! [`unit`](mod@unit) compares every colour.

mod loads;
mod program;
pub(crate) mod scene;
mod schedule;
pub mod text;
pub mod unit;
