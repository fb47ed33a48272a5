//! A frame through the front door, as an application draws it: a scene in flash, a packed list, strips of eight rows
//! that are brought to the 16 bits a pixel of a display in the buffer that its DMA sends.
#![cfg_attr(target_os = "none", no_std)]

pub mod scene;

use scene::{MOST, SIDE};
#[cfg(feature = "lean18")]
pub use splatline::Lean18 as Drawn;
#[cfg(not(feature = "lean18"))]
pub use splatline::Micro16 as Drawn;
#[cfg(feature = "emulated")]
use splatline::front::CompactScene;
use splatline::front::{PackedList, packed_words};
use splatline::{Pixel, Renderer};
#[cfg(feature = "emulated")]
use splatline_firmware::{fixed_picture::FixedOutcome, phase::phase_rest};

/// Rows of a strip.
pub const STRIP: u16 = 8;

/// What lies behind the scene: a dark blue.
pub const BACKGROUND: u16 = 0x0883;

/// Pixels of a strip.
pub const STRIP_PIXELS: usize = SIDE as usize * STRIP as usize;

/// Words of the list.
pub const WORDS: usize = MOST * packed_words(&Drawn::WIDTHS);

/// All memory that drawing needs beside the stack.
#[derive(Debug)]
pub struct FrameMemory {
    /// The display list.
    pub list: [u32; WORDS],
    /// A strip.
    pub strip: [Pixel; STRIP_PIXELS],
    /// The same as it is sent.
    pub sent: [u16; STRIP_PIXELS],
}

impl FrameMemory {
    /// Empty memory.
    pub const EMPTY: FrameMemory = FrameMemory {
        list: [0; WORDS],
        strip: [Pixel::EMPTY; STRIP_PIXELS],
        sent: [0; STRIP_PIXELS],
    };
}

/// Draws the scenes one after the other, for ever, by one core; `send` gets a strip's first row and its pixels.
pub fn show(memory: &mut FrameMemory, mut send: impl FnMut(u16, &[u16])) -> ! {
    let renderer = Renderer::new(Drawn);
    let view = scene::view();
    let FrameMemory { list, strip, sent } = memory;
    let mut list = PackedList::new(Drawn, list);
    loop {
        for scene in &scene::SCENES {
            // A list that is full is left empty, and shows as the background.
            let _ = renderer.set_up_scene(&view, scene, &mut list);
            for window in view.window().strips(STRIP) {
                if let Ok(frame) = renderer.draw(&list, window, strip) {
                    frame.write_rgb565(BACKGROUND, sent);
                    send(window.first[1], sent);
                }
            }
        }
    }
}

/// Draws a scene, whose pixels are summed up as they are sent; `set_up` and `draw` are called before the phases for
/// which instructions are counted. `None` if memory does not suffice.
#[cfg(feature = "emulated")]
pub fn draw(
    scene: &CompactScene,
    memory: &mut FrameMemory,
    set_up: extern "C" fn(),
    draw: extern "C" fn(),
) -> Option<FixedOutcome> {
    let renderer = Renderer::new(Drawn);
    let view = scene::view();
    let FrameMemory { list, strip, sent } = memory;
    let mut list = PackedList::new(Drawn, list);
    set_up();
    let counts = renderer.set_up_scene(&view, scene, &mut list);
    phase_rest();
    let mut outcome = FixedOutcome {
        visible: counts.ok()?.drawn,
        ..FixedOutcome::default()
    };
    for window in view.window().strips(STRIP) {
        draw();
        // The pixel loop in assembly, which these processors' compilers cannot equal.
        #[cfg(assembly)]
        let frame = renderer.draw_with(&list, window, strip, |_, run| {
            splatline_firmware::pixel_loop::paint(run);
        });
        #[cfg(not(assembly))]
        let frame = renderer.draw(&list, window, strip);
        let frame = frame.ok()?;
        frame.write_rgb565(BACKGROUND, sent);
        phase_rest();
        for pixel in sent.iter().take(window.pixels()) {
            outcome.checksum.add((*pixel).into());
        }
    }
    Some(outcome)
}

/// The same by the kernel's general painter with widths in fields, 64-bit lanes and an unpacked list, and the pixels
/// that were covered.
#[cfg(all(feature = "emulated", not(target_os = "none")))]
pub fn expected(scene: &CompactScene) -> (FixedOutcome, u64, Vec<u16>) {
    use splatline::footprint::Footprint;
    use splatline::format::RuntimeWidths;
    use splatline::front::Splats;
    use splatline::kernel::{entries, fill_gaussian};
    use splatline::{LentList, Rules};
    let widths = Drawn::WIDTHS;
    let mut table = vec![0; entries(&widths)];
    fill_gaussian(&mut table, &widths, 4);
    let design = RuntimeWidths::new(widths).expect("a named design's");
    let renderer = Renderer::with_table(design, Rules::GAUSSIAN_3D, &table).expect("of its length");
    let view = scene::view();
    let splats = (0..scene.len()).filter_map(|number| scene.splat(number));
    let (mut footprints, mut order) = (vec![Footprint::EMPTY; MOST], vec![0; MOST]);
    let mut list = LentList::new(&mut footprints, &mut order);
    let counts = renderer.set_up(&view, splats, &mut list).expect("room");
    let mut pixels = vec![Pixel::EMPTY; view.window().pixels()];
    let frame = renderer.draw(&list, view.window(), &mut pixels);
    let frame = frame.expect("of the picture's size");
    let mut outcome = FixedOutcome {
        visible: counts.drawn,
        ..FixedOutcome::default()
    };
    let sent: Vec<u16> = frame.rgb565(BACKGROUND).collect();
    sent.iter()
        .for_each(|pixel| outcome.checksum.add((*pixel).into()));
    let covered = frame.coverage.map_or(0, |coverage| coverage.covered);
    (outcome, covered, sent)
}
