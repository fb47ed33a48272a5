//! Pictures with a deep alpha channel of any representation, width and rounding (\[SWAN\] 6).
//!
//! Footprints and opacities are the design's; only the pixel differs. Nothing finishes early: the channel shows all of
//! its error.

use super::frame::{TileLists, paint_apart, table, table_entries};
use super::quantise::{QuantisedScene, kernel_rules};
use super::render::{Options, seen};
use crate::camera::Camera;
use crate::design::DesignJob;
use crate::picture::Picture;
use crate::rules::Compositing;
use crate::scene::Scene;
use rayon::prelude::*;
use splatline::blend::deep::{Channel, DeepPixel};
use splatline::draw::Painter;
use splatline::footprint::Footprint;
use splatline::format::Design;
use splatline::rules::Compositing as KernelCompositing;

/// Draws `scene` through `channel`, front to back or, if the options say so, back to front (X-ray counts as front to back).
pub fn draw(scene: &Scene, camera: &Camera, options: &Options, channel: Channel) -> Picture {
    struct DeepJob<'a>(&'a QuantisedScene, &'a Options<'a>, Channel);
    impl DesignJob for DeepJob<'_> {
        type Output = Vec<DeepPixel>;
        fn run<D: Design + Send + Sync>(self, design: D) -> Vec<DeepPixel> {
            draw_with(design, self.0, self.1, self.2)
        }
    }
    let quantised = QuantisedScene::new(scene, camera, options.rules);
    let pixels = options
        .design
        .dispatch(DeepJob(&quantised, options, channel));
    to_picture(&pixels, camera, &channel, quantised.colour_log2)
}

/// Compiled once, not for every design.
fn in_order(seen: Vec<(usize, Footprint)>, back_to_front: bool) -> Vec<Footprint> {
    let footprints = seen.into_iter().map(|(_, footprint)| footprint);
    let mut footprints: Vec<Footprint> = footprints.collect();
    footprints.par_sort_by_key(|footprint| footprint.depth);
    if back_to_front {
        footprints.reverse();
    }
    footprints
}

fn draw_with<D: Design + Send + Sync>(
    design: D,
    quantised: &QuantisedScene,
    options: &Options,
    channel: Channel,
) -> Vec<DeepPixel> {
    let rules = kernel_rules(options.rules);
    let widths = design.widths();
    let back_to_front = options.compositing == Compositing::BackToFront;
    let footprints = in_order(seen(design, quantised, &rules), back_to_front);
    let memory = table_entries(&widths, &rules);
    let table = table(&memory, &widths, &rules);
    let order = KernelCompositing::FrontToBack;
    let painter = Painter::new(design, &rules, table, order, options.traversal);
    let tiles = TileLists::in_bands(footprints.iter(), quantised.view.viewport);
    let clear = DeepPixel::clear(&channel);
    let (pixels, _) = paint_apart(clear, &tiles, |window, list, pixels| {
        let width = usize::from(window.end[0]);
        for layer in list {
            let footprint = &footprints[*layer as usize];
            let colour = footprint.colour.map(|c| c << (28 - widths.colour));
            painter.visit(footprint, &window, |x, y, alpha| {
                let pixel = &mut pixels[usize::from(y - window.first[1]) * width + usize::from(x)];
                let alpha = alpha << (31 - widths.alpha);
                if back_to_front {
                    pixel.back_to_front(&channel, alpha, &colour, [x, y], *layer);
                } else {
                    pixel.front_to_back(&channel, alpha, &colour, [x, y], *layer);
                }
            });
        }
    });
    pixels
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
