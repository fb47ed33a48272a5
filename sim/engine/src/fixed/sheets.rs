//! Sheet buffers through the kernel: every band of rows lends memory for one sheet and one frame.

use super::frame::{TileLists, paint_apart, table, table_entries, to_picture};
use super::quantise::{QuantisedScene, kernel_rules};
use super::render::{Options, seen};
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
use splatline::splat::VolumeSplat;
use splatline::target::Target;

/// Draws `scene` sheet by sheet, nearest first.
pub fn draw(scene: &Scene, camera: &Camera, options: &Options, plan: &SheetPlan) -> Picture {
    struct SheetsJob<'a>(&'a QuantisedScene, &'a Options<'a>, &'a SheetPlan);
    impl DesignJob for SheetsJob<'_> {
        type Output = Vec<Pixel>;
        fn run<D: Design + Send + Sync>(self, design: D) -> Vec<Pixel> {
            draw_with(design, self.0, self.1, self.2)
        }
    }
    let quantised = QuantisedScene::with_depths(scene, camera, options.rules);
    let pixels = options
        .design
        .dispatch(SheetsJob(&quantised, options, plan));
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
    let slabs = SlabRule::new(plan, quantised.scale_log2);
    let parts = slabs.sorted_parts(quantised, seen(design, quantised, &rules));
    let memory = table_entries(&widths, &rules);
    let table = table(&memory, &widths, &rules);
    let painter = Painter::new(design, &rules, table, Compositing::XRay, options.traversal);
    let blend = Blend::new(&widths, &rules);
    let footprints = parts.iter().map(|(_, footprint)| footprint);
    let tiles = TileLists::in_bands(footprints, quantised.view.viewport);
    let clear = Pixel::clear(&widths);
    let (pixels, _) = paint_apart(clear, &tiles, |window, list, frame| {
        let columns = usize::from(window.end[0]);
        let mut memory = frame.to_vec();
        let buffers = (
            Target::new(frame, window, columns),
            SheetBuffer::new(&mut memory, window, columns, &widths),
        );
        let (Ok(mut target), Ok(mut sheet)) = buffers else {
            unreachable!("the memory has just been made for the window")
        };
        let slab = |index: &u32| parts[*index as usize].0;
        for of_slab in list.chunk_by(|a, b| slab(a) == slab(b)) {
            for index in of_slab {
                painter.draw(&parts[*index as usize].1, sheet.target());
            }
            sheet.composite_behind(&blend, &mut target);
        }
    });
    pixels
}

/// The plan in the kernel's formats.
enum SlabRule {
    Axis(AxisSlabs),
    Depth(DepthSlabs, SheetKind),
}

impl SlabRule {
    fn new(plan: &SheetPlan, scale_log2: i32) -> SlabRule {
        let unit = f64::from(scale_log2).exp2();
        let per_unit = (65536.0 / (plan.thickness * unit)).round() as u32;
        match plan.kind {
            SheetKind::AxisAligned => {
                let largest = plan.direction.iter().fold(0.0, |m: f64, d| m.max(d.abs()));
                let direction = plan
                    .direction
                    .map(|d| I2F30::saturating_from_num(d / largest));
                SlabRule::Axis(AxisSlabs {
                    facing: Facing::new(direction),
                    first: I8F24::saturating_from_num(plan.first * unit),
                    per_unit,
                })
            }
            kind => {
                let nearest = (plan.first * unit * 23f64.exp2()).round() as u32;
                SlabRule::Depth(DepthSlabs { nearest, per_unit }, kind)
            }
        }
    }

    /// All splats in their sheets, nearest sheet first. Compiled once, not for every design.
    fn sorted_parts(
        &self,
        quantised: &QuantisedScene,
        seen: Vec<(usize, Footprint)>,
    ) -> Vec<(i64, Footprint)> {
        let mut parts: Vec<(i64, Footprint)> = seen
            .into_par_iter()
            .flat_map_iter(|(index, footprint)| {
                self.parts(quantised, &quantised.splats[index], footprint)
            })
            .collect();
        parts.par_sort_by_key(|(slab, _)| *slab);
        parts
    }

    /// The sheets that a splat takes part in, with its footprint in each.
    fn parts(
        &self,
        quantised: &QuantisedScene,
        splat: &VolumeSplat,
        footprint: Footprint,
    ) -> Vec<(i64, Footprint)> {
        match self {
            SlabRule::Axis(slabs) => vec![(slabs.slab(splat.centre).into(), footprint)],
            SlabRule::Depth(slabs, SheetKind::ImageAlignedCut) => {
                let depth = depth::fixed(footprint.depth);
                let spread = depth_spread(&quantised.view, &splat.axes);
                let (first, last) = slabs.reach(depth, spread);
                (first..=last)
                    .map(|slab| {
                        let share = slabs.fraction_in(slab, depth, spread);
                        let peak =
                            (u64::from(footprint.opacity) * u64::from(share) + (1 << 15)) >> 16;
                        let peak = peak as u32;
                        (
                            slab.into(),
                            Footprint {
                                opacity: peak,
                                ..footprint
                            },
                        )
                    })
                    .collect()
            }
            SlabRule::Depth(slabs, _) => {
                vec![(slabs.slab(depth::fixed(footprint.depth)).into(), footprint)]
            }
        }
    }
}
