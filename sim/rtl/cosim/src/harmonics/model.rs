//! The verilated harmonics unit: its inputs and outputs, as the shim has them.
#![allow(unsafe_code)]

use crate::clocked::{ClockedInputs, ClockedModel};

/// The circuit's inputs in one cycle; `Inputs` of harmonics_shim.cpp.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct HarmonicsInputs {
    /// Reset.
    pub rst: u8,
    /// A splat is offered.
    pub splat_valid: u8,
    /// Its degree.
    pub degree: u8,
    /// A word is offered.
    pub word_valid: u8,
    /// A colour is taken.
    pub colour_ready: u8,
    /// Padding.
    pub spare: [u8; 3],
    /// The splat's direction.
    pub direction: [i32; 3],
    /// Base or coefficient.
    pub word: [i32; 3],
}

/// The circuit's outputs in one cycle, before its edge; `Outputs` of harmonics_shim.cpp.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct HarmonicsOutputs {
    /// The splat is taken.
    pub splat_ready: u8,
    /// The word is taken.
    pub word_ready: u8,
    /// A colour is offered.
    pub colour_valid: u8,
    /// Padding.
    pub spare: u8,
    /// The colour.
    pub colour: [u32; 3],
}

/// The unit being simulated.
pub type HarmonicsModel = ClockedModel<HarmonicsInputs>;

// SAFETY: harmonics_shim.cpp has functions of this name, and structs of which these are the mirrors.
unsafe impl ClockedInputs for HarmonicsInputs {
    type Outputs = HarmonicsOutputs;
    const NAME: &'static str = "harmonics";

    fn reset() -> Self {
        HarmonicsInputs {
            rst: 1,
            ..HarmonicsInputs::default()
        }
    }
}
