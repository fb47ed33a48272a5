//! How much the vectors of a subject will take, counted before any of it is made: a line of a few words can ask for
//! terabytes.
//!
//! Setup is run once for its boxes, which bound the pixels of runs and records from above; nothing is kept of it.

use super::VectorSubject;
use crate::fixed::kernel_rules;
use crate::memory::{self, TooLarge};
use splatline::raster::Window;
use splatline::setup;

/// Bytes of a splat: its records in the five stages of setup, and their texts. Measured, rounded up.
const SPLAT_BYTES: u64 = 2_500;
/// Bytes of a pixel of the picture: the pixel, its record, its text.
const PICTURE_BYTES: u64 = 350;
/// Bytes of a pixel of a footprint's box: its record and text, and its share of a run.
const PIXEL_BYTES: u64 = 350;

/// Refuses a subject whose vectors do not fit into memory.
pub fn room_for(subject: &VectorSubject) -> Result<(), TooLarge> {
    const FIX: &str = "ask for fewer splats or a smaller picture";
    room_for_splats(subject.splats.len())?;
    memory::room_for(bytes(subject), "the test vectors", FIX)
}

/// Refuses a number of splats that do not even fit without their pixels.
pub fn room_for_splats(count: usize) -> Result<(), TooLarge> {
    let bytes = SPLAT_BYTES.saturating_mul(count as u64);
    memory::room_for(bytes, "the splats' test vectors", "ask for fewer splats")
}

fn bytes(subject: &VectorSubject) -> u64 {
    let (design, rules) = (subject.design.in_fields(), kernel_rules(&subject.rules));
    let pixels = |splat| match setup::setup(design, &subject.view, &rules, splat) {
        Ok(footprint) => Window::of(&footprint).pixels() as u64,
        Err(_) => 0,
    };
    let boxes: u64 = subject.splats.iter().map(pixels).sum();
    let picture: u64 = subject.view.viewport.map(u64::from).iter().product();
    boxes * PIXEL_BYTES + picture * PICTURE_BYTES + subject.splats.len() as u64 * SPLAT_BYTES
}
