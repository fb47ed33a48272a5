//! Spherical kernels in perspective through the kernel (\[HYBRID\] 4.2).

use super::frame::{TileLists, paint_tiles, table, table_entries, to_picture};
use super::quantise::{QuantisedScene, kernel_compositing, scaled};
use super::render::{FixedDrawing, Options, Times, culls};
use crate::camera::Camera;
use crate::design::DesignJob;
use crate::scene::{Scene, Splat};
use crate::vector;
use rayon::prelude::*;
use splatline::draw::{Coverage, Painter, Perspective};
use splatline::format::{Design, Traversal};
use splatline::kernel::{PERSPECTIVE_ENTRIES, PerspectiveTable, Rays, fill_perspective};
use splatline::setup::{Cull, Ellipse, Index, SphereFootprint, setup_sphere};
use splatline::splat::{SphereSplat, VolumeSplat};

/// Draws a scene whose splats are taken as spheres of their first axis' length.
pub fn draw_spheres(
    scene: &Scene,
    camera: &Camera,
    options: &Options,
    shape: (Ellipse, Index),
) -> FixedDrawing {
    struct SphereJob<'a>(&'a Scene, &'a Camera, &'a Options<'a>, (Ellipse, Index));
    impl DesignJob for SphereJob<'_> {
        type Output = FixedDrawing;
        fn run<D: Design + Send + Sync>(self, design: D) -> FixedDrawing {
            draw_with(design, self.0, self.1, self.2, self.3)
        }
    }
    options
        .design
        .dispatch(SphereJob(scene, camera, options, shape))
}

fn draw_with<D: Design + Send + Sync>(
    design: D,
    scene: &Scene,
    camera: &Camera,
    options: &Options,
    shape: (Ellipse, Index),
) -> FixedDrawing {
    let widths = design.widths();
    let quantised = QuantisedScene::new(scene, camera, options.rules);
    let rules = quantised.rules(options.rules);
    let set_up = |(splat, sphere): (&Splat, &VolumeSplat)| {
        let sphere = SphereSplat {
            centre: sphere.centre,
            deviation: scaled(vector::length(splat.axes[0])).scaled_by(quantised.scale_log2),
            weight: sphere.weight,
            colour: sphere.colour,
        };
        setup_sphere(design, &quantised.view, &rules, &sphere, shape)
    };
    let results = set_up_each(&scene.splats, &quantised.splats, &set_up);
    let culled = culls(&results);
    let spheres: Vec<SphereFootprint> = results.into_iter().flatten().collect();
    let footprints: Vec<_> = spheres.iter().map(|sphere| sphere.footprint).collect();
    let tiles = TileLists::by_depth(&footprints, options.compositing, quantised.view.viewport);
    let memory = table_entries(&widths, &rules);
    let mut perspective = [0; PERSPECTIVE_ENTRIES];
    fill_perspective(&mut perspective);
    let perspective = Perspective {
        table: PerspectiveTable::new(&perspective),
        rays: Rays::new(&quantised.view),
    };
    let painter = Painter::new(
        design,
        &rules,
        table(&memory, &widths, &rules),
        kernel_compositing(options.compositing),
        Traversal::Spans,
    );
    let (pixels, coverage) = paint_tiles(&widths, &tiles, |list, target| {
        let mut coverage = Coverage::default();
        for number in list {
            coverage += painter.draw_sphere(&spheres[*number as usize], &perspective, target);
        }
        coverage
    });
    FixedDrawing {
        picture: to_picture(&pixels, camera, &widths, quantised.colour_log2),
        pixels,
        splats: scene.splats.len(),
        culled,
        clamped: quantised.clamped,
        colour_log2: quantised.colour_log2,
        coverage,
        times: Times::default(),
    }
}

type SphereOutcome = Result<SphereFootprint, Cull>;

/// Compiled once, not for every design.
fn set_up_each(
    scene: &[Splat],
    quantised: &[VolumeSplat],
    set_up: &(dyn Fn((&Splat, &VolumeSplat)) -> SphereOutcome + Sync),
) -> Vec<SphereOutcome> {
    scene.par_iter().zip(quantised).map(set_up).collect()
}
