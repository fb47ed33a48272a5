//! Pictures with a deep alpha channel of any representation, width and rounding (\[SWAN\] 6).
//!
//! Footprints and opacities are the design's; only the pixel differs. Nothing finishes early: the channel shows all of
//! its error.

use super::frame::{TileLists, paint_apart, table, table_entries};
use super::quantise::{QuantisedScene, kernel_rules};
use super::render::{Options, PaintEngine, seen};
use crate::camera::Camera;
use crate::fast::{OpacityVisitor, TakeOpacities};
use crate::picture::Picture;
use crate::rules::Compositing;
use crate::scene::Scene;
use rayon::prelude::*;
use splatline::blend::deep::{Channel, DeepPixel};
use splatline::draw::Painter;
use splatline::footprint::Footprint;
use splatline::format::{Traversal, Widths};
use splatline::raster::Window;
use splatline::rules::Compositing as KernelCompositing;

/// Draws `scene` through `channel`, front to back or, if the options say so, back to front (X-ray counts as front to back).
pub fn draw(
    scene: &Scene,
    camera: &Camera,
    options: &Options,
    engine: PaintEngine,
    channel: Channel,
) -> Picture {
    let quantised = QuantisedScene::new(scene, camera, options.rules);
    let pixels = draw_pixels(&quantised, options, engine, channel);
    to_picture(&pixels, camera, &channel, quantised.colour_log2)
}

/// The nearest splat first, ties as they come.
pub(super) fn sort_by_depth(seen: &mut [(usize, Footprint)]) {
    seen.par_sort_by_key(|(_, footprint)| footprint.depth);
}

fn draw_pixels(
    quantised: &QuantisedScene,
    options: &Options,
    engine: PaintEngine,
    channel: Channel,
) -> Vec<DeepPixel> {
    let rules = kernel_rules(options.rules);
    let (design, widths) = (options.design.in_fields(), options.design.widths);
    let back_to_front = options.compositing == Compositing::BackToFront;
    let mut seen = seen(design, quantised, &rules, engine);
    sort_by_depth(&mut seen);
    if back_to_front {
        seen.reverse();
    }
    let footprints: Vec<Footprint> = seen.into_iter().map(|(_, footprint)| footprint).collect();
    let memory = table_entries(&widths, &rules);
    let table = table(&memory, &widths, &rules);
    let visitor = match (engine, options.traversal) {
        (PaintEngine::Vectors(choice), Traversal::Spans) => {
            let lane_bits = options.design.lane_bits();
            OpacityVisitor::new(&widths, &rules, &table, lane_bits, choice)
        }
        _ => None,
    };
    let order = KernelCompositing::FrontToBack;
    let painter = Painter::new(design, &rules, table, order, options.traversal);
    let layers = DeepLayers {
        channel,
        back_to_front,
        widths,
        footprints: &footprints,
        visitor,
        alone: &|index, window, take| {
            let footprint = &footprints[index as usize];
            painter.visit(footprint, &window, |x, y, opacity| {
                take(index, [x, y], &[opacity.into()]);
            });
        },
    };
    layers.paint(quantised.view.viewport)
}

/// Visits a footprint's pixels in a window by the kernel.
type Alone<'a> = dyn Fn(u32, Window, &mut TakeOpacities) + Sync + 'a;

/// Layers of a picture, in drawing order.
struct DeepLayers<'a> {
    channel: Channel,
    back_to_front: bool,
    widths: Widths,
    footprints: &'a [Footprint],
    visitor: Option<OpacityVisitor>,
    alone: &'a Alone<'a>,
}

impl DeepLayers<'_> {
    fn paint(&self, viewport: [u16; 2]) -> Vec<DeepPixel> {
        let tiles = TileLists::by_key(self.footprints, viewport, &|layer, _| layer.into());
        let clear = DeepPixel::clear(&self.channel);
        let paint = |window: Window, list: &[u32], pixels: &mut [DeepPixel]| {
            self.paint_tile(window, list, pixels);
        };
        paint_apart(clear, &tiles, paint).0
    }

    fn paint_tile(&self, window: Window, list: &[u32], pixels: &mut [DeepPixel]) {
        let columns = usize::from(window.columns());
        let mut take = |layer: u32, [x, y]: [u16; 2], opacities: &[i64]| {
            let colour = self.footprints[layer as usize].colour;
            let colour = colour.map(|c| c << (28 - self.widths.colour));
            let [first, row] = [x - window.first[0], y - window.first[1]].map(usize::from);
            let pixels = pixels[row * columns + first..].iter_mut();
            for ((pixel, opacity), x) in pixels.zip(opacities).zip(x..) {
                let alpha = (*opacity as u32) << (31 - self.widths.alpha);
                if alpha == 0 {
                    continue;
                }
                let channel = &self.channel;
                if self.back_to_front {
                    pixel.back_to_front(channel, alpha, &colour, [x, y], layer);
                } else {
                    pixel.front_to_back(channel, alpha, &colour, [x, y], layer);
                }
            }
        };
        let alone = |layer: u32, take: &mut TakeOpacities| (self.alone)(layer, window, take);
        match &self.visitor {
            Some(visitor) => visitor.visit(window, self.footprints, list, &alone, &mut take),
            None => list.iter().for_each(|layer| alone(*layer, &mut take)),
        }
    }
}

fn to_picture(
    pixels: &[DeepPixel],
    camera: &Camera,
    channel: &Channel,
    colour_log2: i32,
) -> Picture {
    let colour_unit = f64::from(channel.width() as i32 - 1 - colour_log2).exp2();
    let mut picture = Picture::new(camera.width, camera.height);
    for (out, pixel) in picture.pixels.iter_mut().zip(pixels) {
        let [r, g, b] = pixel.colour.map(|c| f64::from(c) / colour_unit);
        let transmittance = f64::from(channel.transmittance(pixel.alpha)) / 31f64.exp2();
        *out = [r, g, b, 1.0 - transmittance];
    }
    picture
}
