//! The scene through the kernel.

use crate::checksum::Checksum;
use crate::design::Firmware16;
use crate::order::{Full, Order};
use crate::phase::{phase_draw, phase_rest, phase_setup};
use crate::scene::{COLUMNS, ROWS, RULES, SCENE, SPLATS, STRIP, STRIP_PIXELS, view};
use crate::table::PACKED;
use heapless::Vec;
use splatline::blend::Pixel;
use splatline::draw::Painter32;
use splatline::footprint::Footprint;
use splatline::raster::Window;
use splatline::setup::setup_for_spans;
use splatline::target::Target;

/// Memory of a picture: all that drawing needs beside the stack.
#[derive(Debug)]
pub struct FixedMemory {
    /// Footprints of the visible splats, in the scene's order.
    pub footprints: Vec<Footprint, SPLATS>,
    /// Their numbers among the footprints, nearest first.
    pub order: Order<u64>,
    /// One strip.
    pub strip: [Pixel; STRIP_PIXELS],
}

impl FixedMemory {
    /// Empty memory.
    pub const EMPTY: FixedMemory = FixedMemory {
        footprints: Vec::new(),
        order: Order::EMPTY,
        strip: [Pixel::EMPTY; STRIP_PIXELS],
    };
}

/// What came out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FixedOutcome {
    /// Checksum of all pixels.
    pub checksum: Checksum,
    /// Splats with a footprint.
    pub visible: u32,
}

/// Draws the scene; `send` gets the memory when a strip is done, and the strip's first row. A splat without a place in
/// the depth order is an error, and nothing is drawn.
pub fn draw(
    memory: &mut FixedMemory,
    mut send: impl FnMut(&FixedMemory, u16),
) -> Result<FixedOutcome, Full> {
    let mut outcome = FixedOutcome::default();
    phase_setup();
    let set_up = set_up(memory);
    phase_rest();
    set_up?;
    outcome.visible = memory.order.iter().count() as u32;
    let mut first_row = 0;
    while first_row < ROWS {
        phase_draw();
        draw_strip(memory, first_row);
        phase_rest();
        for pixel in &memory.strip {
            for word in pixel.colour {
                outcome.checksum.add(word);
            }
            outcome.checksum.add(pixel.transmittance);
        }
        send(memory, first_row);
        first_row += STRIP;
    }
    Ok(outcome)
}

/// Footprints, and their order by depth.
#[inline(never)]
fn set_up(memory: &mut FixedMemory) -> Result<(), Full> {
    let view = view();
    let (footprints, order) = (&mut memory.footprints, &mut memory.order);
    footprints.clear();
    order.clear();
    for splat in &SCENE {
        let Ok(footprint) = setup_for_spans(Firmware16, &view, &RULES, splat) else {
            continue;
        };
        order.insert(footprints.len(), footprint.depth)?;
        footprints.push(footprint).map_err(|_| Full)?;
    }
    Ok(())
}

/// One strip of the picture.
#[inline(never)]
fn draw_strip(memory: &mut FixedMemory, first_row: u16) {
    let window = Window {
        first: [0, first_row],
        end: [COLUMNS, first_row + STRIP],
    };
    let painter = Painter32::new(Firmware16, &RULES, PACKED);
    let target = Target::new(&mut memory.strip, window, COLUMNS.into());
    let (Ok(mut target), Ok(painter)) = (target, painter) else {
        return;
    };
    target.clear(&Firmware16::WIDTHS);
    let footprints = &memory.footprints;
    for number in memory.order.iter() {
        let Some(footprint) = footprints.get(number) else {
            continue;
        };
        // Preparing the rows of a footprint costs more than a look at its box.
        if footprint.first[1] < window.end[1] && footprint.end[1] > window.first[1] {
            draw_footprint(painter, footprint, &mut target);
        }
    }
}

/// By the processor's own pixel loop where there is one.
#[inline(always)]
fn draw_footprint(painter: Painter32<Firmware16>, footprint: &Footprint, target: &mut Target) {
    #[cfg(not(any(armv6m, armv7em, target_arch = "riscv32")))]
    painter.draw(footprint, target);
    #[cfg(any(armv6m, armv7em, target_arch = "riscv32"))]
    painter.draw_with(footprint, target, |_, run| crate::pixel_loop::paint(run));
}
