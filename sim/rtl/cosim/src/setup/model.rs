//! The verilated setup unit: its inputs and outputs, as the shim has them.
#![allow(unsafe_code)]

use crate::clocked::{ClockedInputs, ClockedModel};
use splatline::footprint::packet::Packet;

/// Words of a record.
pub const RECORD: usize = 19;

/// The circuit's inputs in one cycle; `SetupInputs` of setup_shim.cpp.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct SetupInputs {
    /// Reset.
    pub rst: u8,
    /// A constant is written.
    pub constant_valid: u8,
    /// Its address.
    pub constant_index: u8,
    /// A record is offered.
    pub record_valid: u8,
    /// A packet is taken.
    pub packet_ready: u8,
    /// Padding.
    pub spare: [u8; 3],
    /// The constant.
    pub constant_value: u64,
    /// Its exponent.
    pub constant_exponent: u32,
    /// The record.
    pub record: [u32; RECORD],
}

/// The circuit's outputs in one cycle, before its edge; `SetupOutputs` of setup_shim.cpp.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct SetupOutputs {
    /// The record is taken.
    pub record_ready: u8,
    /// A packet is offered.
    pub packet_valid: u8,
    /// Why it is none.
    pub cull: u8,
    /// Padding.
    pub spare: u8,
    /// The packet.
    pub packet: Packet,
}

/// The unit being simulated.
pub type SetupModel = ClockedModel<SetupInputs>;

// SAFETY: setup_shim.cpp has functions of this name, and structs of which these are the mirrors.
unsafe impl ClockedInputs for SetupInputs {
    type Outputs = SetupOutputs;
    const NAME: &'static str = "setup";

    fn reset() -> Self {
        SetupInputs {
            rst: 1,
            ..SetupInputs::default()
        }
    }
}
