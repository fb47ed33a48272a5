//! The live page's engine room: the kernel and the float reference behind plain functions over linear memory.
//!
//! The page's script writes a scene, a camera and widths into memory that it asks for here, calls [`draw`], and reads
//! pictures and figures from memory. Nothing is bound by a generator, so that the whole interface is what this file
//! shows. The arithmetic is the kernel's own at run-time widths, the way into its formats is the host's file, and the
//! reference is the host's crate; what is this crate's own is the loop over tiles, which walks as the host's does, so
//! that pixels and counts are the same. The page shows whether they are: it compares its checksum with the one that the
//! host wrote beside the scene.

// Exported names are attributes that count as unsafe, because two crates might export the same; there is no unsafe
// block here.
#![allow(unsafe_code)]

mod draw;
mod figures;
mod inspect;

use splatline_reference::{camera, metrics, rules, scene};

#[allow(dead_code)]
#[path = "../../src/page/bytes.rs"]
mod bytes;
#[allow(dead_code)]
#[path = "../../engine/src/fixed/quantise.rs"]
mod quantise;
#[allow(dead_code)]
#[path = "../../engine/src/fast/order.rs"]
mod order;
#[allow(dead_code)]
#[path = "../../src/report/scale.rs"]
mod scale;

use camera::Camera;
use draw::{FixedPicture, FloatPicture};
use figures::Compared;
use splatline::format::{Rounding, RuntimeWidths, Traversal, WIDTH_RANGES, Widths};
use std::cell::RefCell;

/// Widths, then rounding (0 nearest, 1 truncate, 2 nearest with ties to even) and traversal (0 box, 1 spans).
const DESIGN: usize = WIDTH_RANGES.len() + 2;

/// Everything between two calls. The module has one thread.
#[derive(Default)]
struct Page {
    input: Vec<u8>,
    camera: [f64; bytes::CAMERA],
    design: [u8; DESIGN],
    scene: Option<draw::LoadedScene>,
    fixed: Option<FixedPicture>,
    float: Option<FloatPicture>,
    compared: Compared,
    text: String,
}

thread_local! {
    static PAGE: RefCell<Page> = RefCell::default();
}

fn with<T>(work: impl FnOnce(&mut Page) -> T) -> T {
    PAGE.with_borrow_mut(work)
}

/// Memory for so many bytes of a scene.
#[unsafe(no_mangle)]
pub extern "C" fn input(length: usize) -> *mut u8 {
    with(|page| {
        page.input = vec![0; length];
        page.input.as_mut_ptr()
    })
}

/// Reads the scene in the input; its splats, or -1 if the bytes are damaged.
#[unsafe(no_mangle)]
pub extern "C" fn load() -> i32 {
    with(|page| {
        let loaded = bytes::decode(&std::mem::take(&mut page.input));
        (page.fixed, page.float) = (None, None);
        page.scene = loaded.map(|(scene, rules)| draw::LoadedScene::new(scene, rules));
        let loaded = page.scene.as_ref();
        loaded.map_or(-1, |loaded| loaded.splats() as i32)
    })
}

/// Where the camera's doubles go.
#[unsafe(no_mangle)]
pub extern "C" fn camera_numbers() -> *mut f64 {
    with(|page| page.camera.as_mut_ptr())
}

/// Where the design's bytes go: the widths in the kernel's order, rounding (0 nearest, 1 truncate, 2 nearest with ties
/// to even), traversal (0 box, 1 spans).
#[unsafe(no_mangle)]
pub extern "C" fn design_bytes() -> *mut u8 {
    with(|page| page.design.as_mut_ptr())
}

/// Draws: bit 0 the kernel, bit 1 the reference. 0, or what was wrong: 1 no scene, 2 a camera that is none, 3 a width
/// out of its range.
#[unsafe(no_mangle)]
pub extern "C" fn draw(what: u32) -> u32 {
    with(|page| match page.draw(what) {
        Ok(()) => 0,
        Err(wrong) => wrong,
    })
}

impl Page {
    fn draw(&mut self, what: u32) -> Result<(), u32> {
        let camera = camera_from(&self.camera).ok_or(2u32)?;
        let (design, traversal) = design_from(&self.design).ok_or(3u32)?;
        let loaded = self.scene.as_mut().ok_or(1u32)?;
        if what & 1 != 0 {
            self.fixed = Some(FixedPicture::draw(loaded, &camera, design, traversal));
        }
        if what & 2 != 0 {
            self.float = Some(FloatPicture::draw(loaded, &camera));
        }
        Ok(())
    }
}

/// Compares the two pictures; 1 if there are not two of one size. `percentile` of the errors end the colour scale,
/// unless `limit` (above 0) does.
#[unsafe(no_mangle)]
pub extern "C" fn compare(percentile: f64, limit: f64) -> u32 {
    with(|page| match (&page.fixed, &page.float) {
        (Some(fixed), Some(float)) if fixed.picture.width == float.picture.width => {
            page.compared = Compared::new(fixed, float, percentile, limit);
            0
        }
        _ => 1,
    })
}

/// RGBA bytes of a layer (0 fixed, 1 float, 2 error), row by row.
#[unsafe(no_mangle)]
pub extern "C" fn pixels(layer: u32) -> *const u8 {
    with(|page| {
        let rgba = match layer {
            0 => page.fixed.as_ref().map(|fixed| &fixed.rgba),
            1 => page.float.as_ref().map(|float| &float.rgba),
            _ => Some(&page.compared.rgba),
        };
        rgba.map_or(std::ptr::null(), Vec::as_ptr)
    })
}

/// Figures, in the order of [`figures::NAMES`].
#[unsafe(no_mangle)]
pub extern "C" fn figures() -> *const f64 {
    with(|page| {
        page.compared.tell(page.fixed.as_ref());
        page.compared.figures.as_ptr()
    })
}

/// Pixels that differ, in bins of the signed error over the colour scale, and 1 bin more beyond each end.
#[unsafe(no_mangle)]
pub extern "C" fn histogram() -> *const f64 {
    with(|page| page.compared.histogram.as_ptr())
}

/// One channel (0 to 3) of a layer's pixel; NaN outside.
#[unsafe(no_mangle)]
pub extern "C" fn value(layer: u32, channel: u32, x: u32, y: u32) -> f64 {
    with(|page| {
        let of = |picture: &splatline_reference::picture::Picture| {
            let inside = (x as usize) < picture.width && (y as usize) < picture.height;
            let place = y as usize * picture.width + x as usize;
            let pixel = picture.pixels.get(place).filter(|_| inside)?;
            pixel.get(channel as usize).copied()
        };
        let fixed = || of(&page.fixed.as_ref()?.picture);
        let float = || of(&page.float.as_ref()?.picture);
        let value = match layer {
            0 => fixed(),
            1 => float(),
            _ => fixed().zip(float()).map(|(a, b)| a - b),
        };
        value.unwrap_or(f64::NAN)
    })
}

/// The splat that gives pixel (x, y) most of its light, or -1. [`text`] is then its packet as JSON.
#[unsafe(no_mangle)]
pub extern "C" fn pick(x: u32, y: u32) -> i32 {
    with(|page| {
        let (Some(fixed), Some(loaded)) = (&page.fixed, &page.scene) else {
            return -1;
        };
        match inspect::heaviest(fixed, loaded, x, y) {
            Some((splat, text)) => {
                page.text = text;
                splat as i32
            }
            None => -1,
        }
    })
}

/// UTF-8 bytes of the last text.
#[unsafe(no_mangle)]
pub extern "C" fn text() -> *const u8 {
    with(|page| page.text.as_ptr())
}

/// How many there are.
#[unsafe(no_mangle)]
pub extern "C" fn text_length() -> usize {
    with(|page| page.text.len())
}

fn camera_from(numbers: &[f64; bytes::CAMERA]) -> Option<Camera> {
    let [width, height, fx, fy, cx, cy] = *numbers.first_chunk()?;
    let size = |pixels: f64| (1.0..=4096.0).contains(&pixels).then_some(pixels as usize);
    let row = |i: usize| [0, 1, 2].map(|k| numbers[6 + 3 * i + k]);
    if !numbers[..18].iter().all(|n| n.is_finite()) {
        return None;
    }
    Some(Camera {
        width: size(width)?,
        height: size(height)?,
        fx,
        fy,
        cx,
        cy,
        rotation: [0, 1, 2].map(row),
        translation: row(3),
        near: numbers[18],
        far: numbers[19],
        orthographic: numbers[20] != 0.0,
    })
}

fn design_from(bytes: &[u8; DESIGN]) -> Option<(RuntimeWidths, Traversal)> {
    let [numbers @ .., rounding, traversal] = *bytes;
    let rounding = match rounding {
        0 => Rounding::Nearest,
        1 => Rounding::Truncate,
        _ => Rounding::NearestEven,
    };
    let widths = Widths::from_numbers(numbers, rounding);
    let traversal = match traversal {
        0 => Traversal::Box,
        _ => Traversal::Spans,
    };
    Some((RuntimeWidths::new(widths).ok()?, traversal))
}
