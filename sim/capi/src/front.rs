//! The front door for firmware in C: a camera and splats from ordinary numbers, a scene sorted and set up, strips as
//! RGB565.
//!
//! By the design SPLATLINE_MICRO16 under SPLATLINE_RULES_3DGS: one design, so that a small image links one painter. All
//! bits are those of the same calls in Rust. A list is `splatline_list_words` words of the caller's, and the number of
//! footprints that the set-up returns.

use crate::memory::{read, slice, slice_mut, write};
use crate::status::{Error, SPLATLINE_OK, code};
use crate::types::{
    SplatlineFootprint, SplatlinePixel, SplatlineSplat, SplatlineView, SplatlineWindow,
};
use splatline::blend::Pixel;
use splatline::front::{CompactScene, PackedList, Splats, packed_words, sort_by_key};
use splatline::splat::{Position, VolumeSplat};
use splatline::view::{Eye, View};
use splatline::{Camera, Gaussian, Micro16, Renderer};

/// The view from `eye` towards `target`, `up` upwards, with a vertical field of view in degrees. SPLATLINE_ERROR_VALUE
/// if a number is not finite, the directions are none, or the size is 0 or above SPLATLINE_LARGEST_VIEWPORT.
///
/// # Safety
/// Pointers are null or lead to what their types say; `eye`, `target` and `up` to three numbers each.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn splatline_look_at(
    eye: *const f32,
    target: *const f32,
    up: *const f32,
    field_of_view: f32,
    columns: u16,
    rows: u16,
    view: *mut SplatlineView,
) -> i32 {
    // SAFETY: the function's own contract.
    code(|| unsafe {
        let [eye, target, up] = [vector(eye)?, vector(target)?, vector(up)?];
        let [eye, target, up] = [eye, target, up].map(|vector| vector.map(f64::from));
        let camera = Camera::look_at(eye, target, up, field_of_view.into(), [columns, rows]);
        let seen = camera.and_then(|camera| camera.view());
        let seen = seen.map_err(|_| Error::Value)?;
        write(view, (&seen).into())
    })
}

/// A splat from ordinary numbers: mean (scene units), rotation as a quaternion w, x, y, z of any length but 0, standard
/// deviations along the turned axes (scene units), opacity at the centre (0 to 1), linear red, green, blue.
/// SPLATLINE_ERROR_VALUE if a number is not finite or the quaternion has length 0.
///
/// # Safety
/// Pointers are null or lead to what their types say; `mean`, `scales` and `colour` to three numbers each, `rotation`
/// to four.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn splatline_gaussian(
    mean: *const f32,
    rotation: *const f32,
    scales: *const f32,
    opacity: f32,
    colour: *const f32,
    splat: *mut SplatlineSplat,
) -> i32 {
    // SAFETY: the function's own contract.
    code(|| unsafe {
        let gaussian = Gaussian {
            mean: vector(mean)?,
            rotation: *read(rotation.cast::<[f32; 4]>())?,
            scales: vector(scales)?,
            opacity,
            colour: vector(colour)?,
        };
        write(splat, (&gaussian.splat().ok_or(Error::Value)?).into())
    })
}

/// Words of 32 bits that a list of `footprints` takes; the last is the picture's viewport.
#[unsafe(no_mangle)]
pub extern "C" fn splatline_list_words(footprints: usize) -> usize {
    footprints
        .saturating_mul(packed_words(&Micro16::WIDTHS))
        .saturating_add(1)
}

/// Sorts a scene by depth, nearest first, and sets it up into a list. Returns the number of footprints on the list, or
/// an error; SPLATLINE_ERROR_SIZE if the list has too few words, and then `needed_words`, unless null, is how many it
/// takes: of what is sorted, if even that has no room, so that a second call may ask for more, but no third.
///
/// # Safety
/// Pointers are null or lead to what their types say; `splats` to `count` splats, `words` to `word_count` words.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn splatline_set_up_scene(
    view: *const SplatlineView,
    splats: *const SplatlineSplat,
    count: usize,
    words: *mut u32,
    word_count: usize,
    needed_words: *mut usize,
) -> i32 {
    // SAFETY: the function's own contract.
    code(|| unsafe {
        let (view, scene) = (read(view)?.view()?, Lent(slice(splats, count)?));
        set_up(&view, &scene, words, word_count, needed_words)
    })
}

/// The same for a scene as `splatline bake -o scene.bin` writes it, `count` bytes; SPLATLINE_ERROR_VALUE if they are
/// not one, whole.
///
/// # Safety
/// Pointers are null or lead to what their types say; `bytes` to `count` bytes, `words` to `word_count` words.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn splatline_set_up_compact(
    view: *const SplatlineView,
    bytes: *const u8,
    count: usize,
    words: *mut u32,
    word_count: usize,
    needed_words: *mut usize,
) -> i32 {
    // SAFETY: the function's own contract.
    code(|| unsafe {
        let (view, bytes) = (read(view)?.view()?, slice(bytes, count)?);
        let scene = CompactScene::read(bytes).ok_or(Error::Value)?;
        set_up(&view, &scene, words, word_count, needed_words)
    })
}

/// Draws the part of the picture in `window` and brings it to 16 bits a pixel (red 5, green 6, blue 5) over a
/// background in the same format, row by row without gaps. `pixels` and `sent` have room for `count` pixels, at least
/// the window's.
///
/// # Safety
/// Pointers are null or lead to what their types say; `words` to `word_count` words, `pixels` and `sent` to `count`
/// pixels.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn splatline_draw_rgb565(
    words: *mut u32,
    word_count: usize,
    footprints: usize,
    window: *const SplatlineWindow,
    background: u16,
    pixels: *mut SplatlinePixel,
    sent: *mut u16,
    count: usize,
) -> i32 {
    // SAFETY: the function's own contract; both structs of a pixel have the same fields in C's layout.
    code(|| unsafe {
        let (words, window) = (slice_mut(words, word_count)?, read(window)?);
        let (viewport, words) = words.split_last_mut().ok_or(Error::Size)?;
        let viewport = [*viewport as u16, (*viewport >> 16) as u16];
        let list = PackedList::filled(Micro16, words, footprints, viewport).ok_or(Error::Size)?;
        let pixels = slice_mut(pixels.cast::<Pixel>(), count)?;
        let sent = slice_mut(sent, count)?;
        let frame = Renderer::new(Micro16).draw(&list, window.into(), pixels);
        let frame = frame.map_err(|_| Error::Size)?;
        frame.write_rgb565(background, sent);
        Ok(SPLATLINE_OK)
    })
}

/// Numbers of `count` footprints in `order` by depth, nearest first, ties by number: what drawing front to back asks
/// for.
///
/// # Safety
/// Pointers are null or lead to what their types say; `footprints` to `count` footprints, `order` to as many numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn splatline_sort(
    footprints: *const SplatlineFootprint,
    count: usize,
    order: *mut u32,
) -> i32 {
    code(|| {
        // SAFETY: the function's own contract.
        let (footprints, order) = unsafe { (slice(footprints, count)?, slice_mut(order, count)?) };
        if u32::try_from(count).is_err() {
            return Err(Error::Size);
        }
        for (number, place) in (0u32..).zip(order.iter_mut()) {
            *place = number;
        }
        sort_by_key(order, |number| {
            let depth = |footprint: &SplatlineFootprint| footprint.depth;
            let found = footprints.get(number as usize);
            (found.map_or(u64::MAX, depth), number)
        });
        Ok(SPLATLINE_OK)
    })
}

/// # Safety
/// `words` leads to `word_count` words; `needed_words` is null or leads to a number.
unsafe fn set_up(
    view: &View,
    scene: &impl Splats<Eye>,
    words: *mut u32,
    word_count: usize,
    needed_words: *mut usize,
) -> Result<i32, Error> {
    // SAFETY: the function's own contract.
    let mut words = unsafe { slice_mut(words, word_count) }?;
    // Without a word for the viewport even an empty list has no room.
    let mut nowhere = [0];
    if word_count == 0 {
        words = &mut nowhere;
    }
    let (viewport, list) = words.split_last_mut().ok_or(Error::Size)?;
    let [columns, rows] = view.viewport.map(u32::from);
    *viewport = rows << 16 | columns;
    let mut list = PackedList::new(Micro16, list);
    let needed = match Renderer::new(Micro16).set_up_scene(view, scene, &mut list) {
        Ok(_) if word_count > 0 => return i32::try_from(list.len()).map_err(|_| Error::Size),
        Ok(_) => 0,
        Err(full) => full.needed,
    };
    if !needed_words.is_null() {
        // SAFETY: the function's own contract.
        unsafe { write(needed_words, splatline_list_words(needed)) }?;
    }
    Err(Error::Size)
}

/// # Safety
/// `numbers` is null or leads to three numbers.
unsafe fn vector(numbers: *const f32) -> Result<[f32; 3], Error> {
    // SAFETY: the function's own contract.
    unsafe { read(numbers.cast::<[f32; 3]>()) }.copied()
}

/// Splats of C by number.
struct Lent<'a>(&'a [SplatlineSplat]);

impl Splats<Eye> for Lent<'_> {
    fn len(&self) -> usize {
        self.0.len()
    }

    fn centre(&self, number: usize) -> Option<Position> {
        self.0.get(number).map(|splat| splat.centre.map(Into::into))
    }

    fn splat(&self, number: usize) -> Option<VolumeSplat> {
        self.0.get(number).map(VolumeSplat::from)
    }
}
