//! The splat under the pointer: which one it is, and its packet, field by field.

use crate::draw::{FixedPicture, LoadedScene, grid, painter, table};
use splatline::blend::Pixel;
use splatline::footprint::Footprint;
use splatline::footprint::packet::Layout;
use splatline::format::Design;
use splatline::raster::Window;
use splatline::target::Target;

/// The splat that takes the largest share of the pixel's transmittance, found by drawing the pixel's splats once more,
/// into that pixel alone. With it as JSON its part of the pixel's light, 0 to 1, its place among the splats that cover
/// the pixel, from 1, their number, and its packet.
pub fn heaviest(
    fixed: &FixedPicture,
    loaded: &LoadedScene,
    x: u32,
    y: u32,
) -> Option<(u32, String)> {
    let (width, height) = (fixed.picture.width, fixed.picture.height);
    if x as usize >= width || y as usize >= height {
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
    let mut tile = 0;
    grid([width, height]).touched(&window, |touched| tile = touched);
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
    let share = f64::from(share) / f64::from(1u32 << widths.transmittance);
    let [x, y, z] = loaded.centre(splat);
    let found = format!(
        "\"splat\":{splat},\"share\":{share},\"place\":{place},\"covering\":{covering},\"centre\":[{x},{y},{z}]"
    );
    let footprint = fixed.painted.footprints[splat as usize].as_ref().ok()?;
    Some((
        splat,
        format!("{{{found},{}}}", packet_json(fixed, footprint)),
    ))
}

/// The packet as JSON: fields with their bits, most significant first.
fn packet_json(fixed: &FixedPicture, footprint: &Footprint) -> String {
    let layout = Layout::new(&fixed.design.widths(), fixed.traversal);
    let packet = layout.encode(footprint);
    let (bits, words) = (layout.bits(), layout.words());
    let mut text = format!("\"bits\":{bits},\"words\":{words},\"fields\":[");
    let present = layout.fields().iter().filter(|field| field.width > 0);
    for (index, field) in present.enumerate() {
        let comma = if index == 0 { "" } else { "," };
        text += &format!(
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
    text + "]"
}
