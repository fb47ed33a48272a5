//! Spherical kernels in perspective through the kernel (\[HYBRID\] 4.2).

use super::frame::{TileLists, paint_apart};
use super::quantise::{QuantisedScene, kernel_compositing, scaled};
use super::render::{FixedDrawing, Options, culls};
use crate::camera::Camera;
use crate::fast::frame::FrameFacts;
use crate::fast::{TableMemory, whole};
use crate::rules::Compositing;
use crate::scene::{Scene, Splat};
use crate::vector;
use rayon::prelude::*;
use splatline::blend::Pixel;
use splatline::draw::{Coverage, Perspective};
use splatline::format::Traversal;
use splatline::kernel::{PERSPECTIVE_ENTRIES, PerspectiveTable, Rays, fill_perspective};
use splatline::setup::{Ellipse, Index, SphereFootprint, setup_sphere};
use splatline::splat::{SphereSplat, VolumeSplat};

/// Draws a scene whose splats are taken as spheres of their first axis' length.
pub fn draw_spheres(
    scene: &Scene,
    camera: &Camera,
    options: &Options,
    shape: (Ellipse, Index),
) -> FixedDrawing {
    let (design, widths) = (options.design.in_fields(), options.design.widths);
    let quantised = QuantisedScene::new(scene, camera, options.rules);
    let rules = &quantised.rules;
    let set_up = |(splat, sphere): (&Splat, &VolumeSplat)| {
        let sphere = SphereSplat {
            centre: sphere.centre,
            deviation: scaled(vector::length(splat.axes[0])).scaled_by(quantised.scale_log2),
            weight: sphere.weight,
            colour: sphere.colour,
        };
        setup_sphere(design, &quantised.view, rules, &sphere, shape)
    };
    let splats = scene.splats.par_iter().zip(&quantised.splats);
    let results: Vec<_> = splats.map(set_up).collect();
    let culled = culls(&results);
    let spheres: Vec<SphereFootprint> = results.into_iter().flatten().collect();
    let footprints: Vec<_> = spheres.iter().map(|sphere| sphere.footprint).collect();
    let viewport = quantised.view.viewport;
    let mut tiles = TileLists::by_key(&footprints, viewport, &|_, footprint| footprint.depth);
    if options.compositing == Compositing::BackToFront {
        tiles.lists.iter_mut().for_each(|list| list.reverse());
    }
    let table = TableMemory::new(&widths, rules);
    let mut perspective = [0; PERSPECTIVE_ENTRIES];
    fill_perspective(&mut perspective);
    let perspective = Perspective {
        table: PerspectiveTable::new(&perspective),
        rays: Rays::new(&quantised.view),
    };
    let order = kernel_compositing(options.compositing);
    let painter = table.painter(design, order, Traversal::Spans);
    let (pixels, parts) = paint_apart(Pixel::clear(&widths), &tiles, &|window, list, pixels| {
        let mut target = whole(pixels, window);
        let mut coverage = Coverage::default();
        for number in list {
            coverage += painter.draw_sphere(&spheres[*number as usize], &perspective, &mut target);
        }
        coverage
    });
    let mut facts = FrameFacts {
        culled,
        ..FrameFacts::default()
    };
    parts.into_iter().for_each(|part| facts.coverage += part);
    FixedDrawing::new(&quantised, &widths, pixels, facts)
}
