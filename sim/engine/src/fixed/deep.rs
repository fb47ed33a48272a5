//! Pictures with a deep alpha channel of any representation, width and rounding (\[SWAN\] 6).
//!
//! Footprints and opacities are the design's; only the pixel differs. Nothing finishes early: the channel shows all of
//! its error.

use super::frame::{TileLists, paint_apart, to_picture};
use super::quantise::QuantisedScene;
use super::render::{Options, PaintEngine, seen};
use crate::camera::Camera;
use crate::fast::{PathNumbers, TableMemory, TakeOpacities, VisitTask};
use crate::picture::Picture;
use crate::rules::Compositing;
use crate::scene::Scene;
use rayon::prelude::*;
use splatline::blend::deep::{Channel, DeepPixel};
use splatline::footprint::Footprint;
use splatline::format::Traversal;
use splatline::raster::Window;
use splatline::rules::Compositing as KernelCompositing;

/// Draws `scene` through `channel`, front to back or, if the options say so, back to front (X-ray counts as front to
/// back).
pub fn draw(
    scene: &Scene,
    camera: &Camera,
    options: &Options,
    engine: PaintEngine,
    channel: Channel,
) -> Picture {
    let quantised = QuantisedScene::new(scene, camera, options.rules);
    let rules = &quantised.rules;
    let (design, widths) = (options.design.in_fields(), options.design.widths);
    let back_to_front = options.compositing == Compositing::BackToFront;
    let mut seen = seen(design, &quantised, engine);
    sort_by_depth(&mut seen);
    if back_to_front {
        seen.reverse();
    }
    let footprints: Vec<Footprint> = seen.into_iter().map(|(_, footprint)| footprint).collect();
    let table = TableMemory::new(&widths, rules);
    let vectors = match (engine, options.traversal) {
        (PaintEngine::Vectors(choice), Traversal::Spans) => {
            let path = PathNumbers::new(&table, options.design.lane_bits());
            path.map(|path| (path, choice))
        }
        _ => None,
    };
    let order = KernelCompositing::FrontToBack;
    let painter = table.painter(design, order, options.traversal);
    let paint = |window: Window, list: &[u32], pixels: &mut [DeepPixel]| {
        let columns = usize::from(window.columns());
        let mut take = |layer: u32, [x, y]: [u16; 2], opacities: &[i64]| {
            let colour = footprints[layer as usize].colour;
            let colour = colour.map(|c| c << (28 - widths.colour));
            let [first, row] = [x - window.first[0], y - window.first[1]].map(usize::from);
            let pixels = pixels[row * columns + first..].iter_mut();
            for ((pixel, opacity), x) in pixels.zip(opacities).zip(x..) {
                let alpha = (*opacity as u32) << (31 - widths.alpha);
                if alpha == 0 {
                    continue;
                }
                if back_to_front {
                    pixel.back_to_front(&channel, alpha, &colour, [x, y], layer);
                } else {
                    pixel.front_to_back(&channel, alpha, &colour, [x, y], layer);
                }
            }
        };
        let alone = |layer: u32, take: &mut TakeOpacities| {
            painter.visit(&footprints[layer as usize], &window, |x, y, opacity| {
                take(layer, [x, y], &[opacity.into()]);
            });
        };
        match &vectors {
            Some((path, choice)) => {
                let (footprints, alone, take) = (&footprints, &alone, &mut take);
                let task = VisitTask {
                    path,
                    window,
                    footprints,
                    list,
                    alone,
                    take,
                };
                task.visit(*choice);
            }
            None => list.iter().for_each(|layer| alone(*layer, &mut take)),
        }
    };
    let viewport = quantised.view.viewport;
    let tiles = TileLists::by_key(&footprints, viewport, &|layer, _| layer.into());
    let (pixels, _) = paint_apart(DeepPixel::clear(&channel), &tiles, &paint);
    let colour_unit = f64::from(channel.width() as i32 - 1 - quantised.colour_log2).exp2();
    to_picture(&pixels, viewport, |pixel| {
        let [r, g, b] = pixel.colour.map(|c| f64::from(c) / colour_unit);
        let transmittance = f64::from(channel.transmittance(pixel.alpha)) / 31f64.exp2();
        [r, g, b, 1.0 - transmittance]
    })
}

/// The nearest splat first, ties as they come.
pub(super) fn sort_by_depth(seen: &mut [(usize, Footprint)]) {
    seen.par_sort_by_key(|(_, footprint)| footprint.depth);
}
