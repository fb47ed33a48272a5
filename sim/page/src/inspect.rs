//! The splat under the pointer: which one it is, and its packet, field by field.

use crate::draw::{FixedPicture, LoadedScene, PageTiles, painter, table};
use splatline::blend::Pixel;
use splatline::footprint::packet::Layout;
use splatline::format::Design;
use splatline::raster::Window;
use splatline::target::Target;
use std::fmt::Write;

/// A splat of a pixel.
pub struct Picked {
    pub splat: u32,
    /// Its part of the pixel's light, 0 to 1.
    share: f64,
    /// Its place among the splats that cover the pixel, from 1, and their number.
    place: usize,
    covering: usize,
    centre: [f64; 3],
}

/// The splat that takes the largest share of the pixel's transmittance, found by drawing the pixel's splats once more,
/// into that pixel alone.
pub fn heaviest(fixed: &FixedPicture, loaded: &LoadedScene, x: u32, y: u32) -> Option<Picked> {
    let (width, height) = (fixed.picture.width, fixed.picture.height);
    let (column, row) = (x as usize, y as usize);
    if column >= width || row >= height {
        return None;
    }
    let widths = fixed.design.widths();
    let memory = table(&widths, &fixed.rules);
    let painter = painter(fixed.design, &fixed.rules, &memory, fixed.traversal);
    let window = Window {
        first: [x as u16, y as u16],
        end: [x as u16 + 1, y as u16 + 1],
    };
    let mut pixel = [Pixel::clear(&widths)];
    let (mut best, mut covering) = (None, 0);
    let tile = PageTiles::new([width, height]).at(column, row);
    for &splat in fixed.painted.lists.get(tile)? {
        let Ok(footprint) = &fixed.painted.footprints[splat as usize] else {
            continue;
        };
        let before = pixel[0].transmittance();
        let Ok(mut target) = Target::new(&mut pixel, window, 1) else {
            return None;
        };
        let coverage = painter.draw(footprint, &mut target);
        covering += usize::from(coverage.covered > 0);
        let share = before - pixel[0].transmittance().min(before);
        if coverage.covered > 0 && best.is_none_or(|(_, most, _)| share > most) {
            best = Some((splat, share, covering));
        }
    }
    let (splat, share, place) = best?;
    Some(Picked {
        splat,
        share: f64::from(share) / f64::from(1u32 << widths.transmittance),
        place,
        covering,
        centre: loaded.centre(splat),
    })
}

/// The packet as JSON: fields with their bits, most significant first.
pub fn packet_json(fixed: &FixedPicture, picked: &Picked) -> String {
    let mut text = String::new();
    let Some(Ok(footprint)) = fixed.painted.footprints.get(picked.splat as usize) else {
        return text;
    };
    let layout = Layout::new(&fixed.design.widths(), fixed.traversal);
    let packet = layout.encode(footprint);
    let [x, y, z] = picked.centre;
    // Writing to a String cannot fail.
    let _ = write!(
        text,
        "{{\"splat\":{},\"share\":{},\"place\":{},\"covering\":{},\"centre\":[{x},{y},{z}],\"bits\":{},\"words\":{},\"fields\":[",
        picked.splat,
        picked.share,
        picked.place,
        picked.covering,
        layout.bits(),
        layout.words()
    );
    let present = layout.fields().iter().filter(|field| field.width > 0);
    for (index, field) in present.enumerate() {
        let comma = if index == 0 { "" } else { "," };
        let _ = write!(
            text,
            "{comma}{{\"name\":\"{}\",\"offset\":{},\"width\":{},\"signed\":{},\"fraction\":{},\"bits\":\"",
            field.name, field.offset, field.width, field.signed, field.fraction
        );
        for bit in (0..u16::from(field.width)).rev() {
            let place = usize::from(field.offset + bit);
            let is_set = packet[place / 32] >> (place % 32) & 1 == 1;
            text.push(if is_set { '1' } else { '0' });
        }
        text.push_str("\"}");
    }
    text.push_str("]}");
    text
}
