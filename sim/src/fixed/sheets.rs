//! Sheet buffers through the kernel: every band of rows lends memory for one sheet and one frame.

use super::bands::{area, draw_bands, touches, with_table};
use super::quantise::{QuantisedScene, kernel_rules};
use super::render::{Options, to_picture};
use crate::camera::Camera;
use crate::design::DesignJob;
use crate::picture::Picture;
use crate::scene::Scene;
use crate::sheets::{SheetKind, SheetPlan};
use fixed::types::{I2F30, I8F24};
use rayon::prelude::*;
use splatline::blend::sheets::{AxisSlabs, DepthSlabs, Facing, SheetBuffer, depth_spread};
use splatline::blend::{Blend, Pixel};
use splatline::draw::Painter;
use splatline::footprint::{Footprint, depth};
use splatline::format::Design;
use splatline::rules::Compositing;
use splatline::setup::setup;
use splatline::splat::VolumeSplat;
use splatline::target::Target;

/// Draws `scene` sheet by sheet, nearest first.
pub fn draw(scene: &Scene, camera: &Camera, options: &Options, plan: &SheetPlan) -> Picture {
    struct Job<'a>(&'a QuantisedScene, &'a Options<'a>, &'a SheetPlan);
    impl DesignJob for Job<'_> {
        type Output = Vec<Pixel>;
        fn run<D: Design + Send + Sync>(self, design: D) -> Vec<Pixel> {
            draw_with(design, self.0, self.1, self.2)
        }
    }
    let quantised = QuantisedScene::with_depths(scene, camera, options.rules);
    let pixels = options.design.dispatch(Job(&quantised, options, plan));
    to_picture(
        &pixels,
        camera,
        &options.design.widths,
        quantised.colour_log2,
    )
}

fn draw_with<D: Design + Send + Sync>(
    design: D,
    quantised: &QuantisedScene,
    options: &Options,
    plan: &SheetPlan,
) -> Vec<Pixel> {
    let rules = kernel_rules(options.rules);
    let widths = design.widths();
    let slabs = Slabs::new(plan, quantised.scale_log2);
    let mut parts: Vec<(i64, Footprint)> = quantised
        .splats
        .par_iter()
        .filter_map(|splat| Some((splat, setup(design, &quantised.view, &rules, splat).ok()?)))
        .flat_map_iter(|(splat, footprint)| slabs.parts(quantised, splat, footprint))
        .collect();
    parts.par_sort_by_key(|(slab, _)| *slab);
    with_table(&widths, rules.table_range, |table| {
        let painter = Painter::new(design, &rules, table, Compositing::XRay, options.traversal);
        let blend = Blend::new(&widths, &rules);
        draw_bands(quantised.view.viewport, |window| {
            let columns = usize::from(window.last[0]);
            let mut frame = vec![Pixel::clear(&widths); area(&window)];
            let mut memory = frame.clone();
            let buffers = (
                Target::new(&mut frame, window, columns),
                SheetBuffer::new(&mut memory, window, columns, &widths),
            );
            let (Ok(mut target), Ok(mut sheet)) = buffers else {
                unreachable!("the memory has just been made for the window")
            };
            for of_slab in parts.chunk_by(|a, b| a.0 == b.0) {
                let mut touched = false;
                for (_, footprint) in of_slab.iter().filter(|part| touches(&part.1, &window)) {
                    painter.draw(footprint, sheet.target());
                    touched = true;
                }
                if touched {
                    sheet.composite_behind(&blend, &mut target);
                }
            }
            frame
        })
    })
}

/// The plan in the kernel's formats.
enum Slabs {
    Axis(AxisSlabs),
    Depth(DepthSlabs, SheetKind),
}

impl Slabs {
    fn new(plan: &SheetPlan, scale_log2: i32) -> Slabs {
        let unit = f64::from(scale_log2).exp2();
        let per_unit = (65536.0 / (plan.thickness * unit)).round() as u32;
        match plan.kind {
            SheetKind::AxisAligned => {
                let largest = plan.direction.iter().fold(0.0, |m: f64, d| m.max(d.abs()));
                let direction = plan
                    .direction
                    .map(|d| I2F30::saturating_from_num(d / largest));
                Slabs::Axis(AxisSlabs {
                    facing: Facing::new(direction),
                    first: I8F24::saturating_from_num(plan.first * unit),
                    per_unit,
                })
            }
            kind => {
                let nearest = (plan.first * unit * 23f64.exp2()).round() as u32;
                Slabs::Depth(DepthSlabs { nearest, per_unit }, kind)
            }
        }
    }

    /// The sheets that a splat takes part in, with its footprint in each.
    fn parts(
        &self,
        quantised: &QuantisedScene,
        splat: &VolumeSplat,
        footprint: Footprint,
    ) -> Vec<(i64, Footprint)> {
        match self {
            Slabs::Axis(slabs) => vec![(slabs.slab(splat.centre).into(), footprint)],
            Slabs::Depth(slabs, SheetKind::ImageAlignedCut) => {
                let depth = depth::fixed(footprint.depth);
                let spread = depth_spread(&quantised.view, &splat.axes);
                let (first, last) = slabs.reach(depth, spread);
                (first..=last)
                    .map(|slab| {
                        let share = slabs.share(slab, depth, spread);
                        let peak = (u64::from(footprint.peak) * u64::from(share) + (1 << 15)) >> 16;
                        let peak = peak as u32;
                        (slab.into(), Footprint { peak, ..footprint })
                    })
                    .collect()
            }
            Slabs::Depth(slabs, _) => {
                vec![(slabs.slab(depth::fixed(footprint.depth)).into(), footprint)]
            }
        }
    }
}
