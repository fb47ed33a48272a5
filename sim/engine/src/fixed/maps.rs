//! Maps of the kernel's own picture: what its words say a pixel is made of, for those who look for a splat in a
//! co-simulation.
//!
//! Opacities are those that [`Painter::visit`] hands out, and transmittance is the kernel's word, so alpha is the
//! picture's, bit for bit. A machine needs beside a pixel's word of [`Pixel`] two counters, two numbers of splats and
//! the largest contribution so far (a word of transmittance and a comparison), and for depths a multiplication and an
//! addition; depths and normals themselves come from the host.
//!
//! [`Painter::visit`]: splatline::draw::Painter::visit

use super::deep::sort_by_depth;
use super::frame::{TileLists, paint_apart};
use super::quantise::QuantisedScene;
use super::render::{Options, best_engine, numbered, set_up};
use crate::camera::Camera;
use crate::fast::TableMemory;
use crate::scene::Scene;
use crate::vector::Vector;
use rayon::prelude::*;
use splatline::blend::{Blend, Pixel};
use splatline::footprint::Footprint;
use splatline::raster::{EllipseSpans, Spans, Window};
use splatline::rules::Compositing;
use splatline_reference::engines::maps::{MapPixel, depth_and_normal};

/// All pixels, row by row, front to back.
pub fn draw_maps(scene: &Scene, camera: &Camera, options: &Options) -> Vec<MapPixel> {
    let quantised = QuantisedScene::new(scene, camera, options.rules);
    let (design, widths) = (options.design.in_fields(), options.design.widths);
    let rules = &quantised.rules;
    let places = scene.splats.par_iter();
    let places: Vec<(f64, Vector)> = places
        .map(|splat| depth_and_normal(splat, camera))
        .collect();
    let outcomes = set_up(design, &quantised, best_engine());
    let mut seen: Vec<(usize, Footprint)> = numbered(0, outcomes).collect();
    sort_by_depth(&mut seen);
    let (indices, footprints): (Vec<usize>, Vec<Footprint>) = seen.into_iter().unzip();
    let table = TableMemory::new(&widths, rules);
    let order = Compositing::FrontToBack;
    let painter = table.painter(design, order, options.traversal);
    let blend = Blend::new(&widths, rules);
    let unit = (-f64::from(widths.transmittance)).exp2();
    let paint = |window: Window, list: &[u32], pixels: &mut [(Pixel, MapPixel)]| {
        let [left, top] = window.first;
        let place = |x: u16, y: u16| {
            usize::from(y - top) * usize::from(window.columns()) + usize::from(x - left)
        };
        for layer in list {
            let footprint = &footprints[*layer as usize];
            let index = indices[*layer as usize];
            let mut rows = EllipseSpans::new(design, footprint, &window);
            while let Some(run) = rows.next_span() {
                let first = place(run.x, run.y);
                for (word, map) in &mut pixels[first..first + usize::from(run.length)] {
                    map.visited += u32::from(!word.is_finished());
                }
            }
            painter.visit(footprint, &window, |x, y, opacity| {
                let (word, map) = &mut pixels[place(x, y)];
                let before = word.transmittance();
                if !word.is_finished() {
                    blend.front_to_back_of_opacity(word, opacity, &footprint.colour);
                }
                let after = word.transmittance();
                if after < before {
                    let [weight, left] = [before - after, after].map(|t| f64::from(t) * unit);
                    map.blend(weight, left, places[index], index);
                }
            });
        }
    };
    let tiles = TileLists::by_key(&footprints, quantised.view.viewport, &|layer, _| {
        layer.into()
    });
    let clear = (Pixel::clear(&widths), MapPixel::EMPTY);
    let (pixels, _) = paint_apart(clear, &tiles, &paint);
    pixels.into_iter().map(|(_, map)| map).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::DesignChoice;
    use crate::fixed;
    use crate::rules::{self, Rules};
    use crate::scene::synthetic;
    use splatline::format::Traversal;
    use splatline_reference::engines::maps;

    /// Alpha is the picture's, bit for bit; what a fine design blends, and which of it is first and most, is what
    /// double precision says.
    #[test]
    fn maps_are_of_the_kernels_picture() {
        let scene = synthetic::random_gaussians(400, 5, 3.0);
        let camera = synthetic::camera(70, 45);
        for rules in [Rules::GAUSSIAN_3D, Rules::INRIA] {
            for name in ["lean18", "standard24", "deep32"] {
                let design = DesignChoice::named(name).unwrap();
                let options = Options {
                    rules: &rules,
                    design: &design,
                    compositing: rules::Compositing::FrontToBack,
                    traversal: Traversal::Spans,
                };
                let found = draw_maps(&scene, &camera, &options);
                let picture = fixed::draw(&scene, &camera, &options).picture;
                let expected = maps::draw(&scene, &camera, &rules);
                let mut same = 0;
                for ((found, expected), pixel) in found.iter().zip(&expected).zip(&picture.pixels) {
                    assert_eq!(found.alpha, pixel[3], "{name}");
                    assert!(
                        found.blended <= found.visited
                            && (found.blended > 0) == found.first.is_some()
                    );
                    let apart = (found.accumulated_depth - expected.accumulated_depth).abs();
                    assert!(apart < 0.02, "{name}: {apart}");
                    let who = |map: &MapPixel| (map.blended, map.first, map.largest);
                    same += usize::from(who(found) == who(expected));
                }
                assert!(
                    same * 100 >= 98 * found.len(),
                    "{name}: {same} of {}",
                    found.len()
                );
            }
        }
    }
}
