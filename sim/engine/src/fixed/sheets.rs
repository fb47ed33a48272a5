//! Sheet buffers: tile by tile, each slab's splats are added by whatever paints tiles, and the sheet is laid behind
//! what the tile holds.

use super::frame::{TileLists, converter, paint_apart, to_picture};
use super::quantise::QuantisedScene;
use super::render::{Options, PaintEngine, painter, seen};
use crate::camera::Camera;
use crate::fast::setup::Outcome;
use crate::fast::{PaintScratch, Start, TilePainter, TileWork, whole};
use crate::picture::Picture;
use crate::rules::Compositing;
use crate::scene::Scene;
use crate::sheets::{SheetKind, SheetPlan};
use fixed::types::{I2F30, I8F24};
use rayon::prelude::*;
use splatline::blend::sheets::{AxisSlabs, DepthSlabs, Facing, SheetBuffer, depth_spread};
use splatline::blend::{Blend, Pixel};
use splatline::footprint::{Footprint, depth};
use splatline::format::Widths;
use splatline::raster::{BLOCK, Window};
use splatline::splat::VolumeSplat;

/// Draws `scene` sheet by sheet, nearest first.
pub fn draw(
    scene: &Scene,
    camera: &Camera,
    options: &Options,
    engine: PaintEngine,
    plan: &SheetPlan,
) -> Picture {
    let quantised = QuantisedScene::with_depths(scene, camera, options.rules);
    let rules = &quantised.rules;
    let widths = options.design.widths;
    let slabs = SlabRule::new(plan, quantised.scale_log2);
    let seen = seen(options.design.in_fields(), &quantised, engine);
    let parts = seen.into_par_iter().flat_map_iter(|(index, footprint)| {
        slabs.parts(&quantised, &quantised.splats[index], footprint)
    });
    let (slabs, footprints): (Vec<i64>, Vec<Footprint>) = parts.unzip();
    let nearest = slabs.par_iter().min().copied().unwrap_or(0);
    let key = |index: u32, _: &Footprint| (slabs[index as usize] - nearest) as u64;
    let tiles = TileLists::by_key(&footprints, quantised.view.viewport, &key);
    let footprints: Vec<Outcome> = footprints.into_iter().map(Ok).collect();
    let sums = Options {
        compositing: Compositing::XRay,
        ..*options
    };
    let painter = painter(rules, &sums, engine, false);
    let sheets = Sheets {
        painter: &*painter,
        slabs: &slabs,
        footprints: &footprints,
        blend: Blend::new(&widths, rules),
        widths,
    };
    let paint = |window: Window, list: &[u32], pixels: &mut [Pixel]| {
        sheets.paint_tile(window, list, pixels);
    };
    let (pixels, _) = paint_apart(Pixel::clear(&widths), &tiles, &paint);
    let convert = converter(&widths, quantised.colour_log2);
    to_picture(&pixels, quantised.view.viewport, convert)
}

/// All footprints in their sheets.
struct Sheets<'a> {
    painter: &'a dyn TilePainter,
    slabs: &'a [i64],
    footprints: &'a [Outcome],
    blend: Blend,
    widths: Widths,
}

impl Sheets<'_> {
    fn paint_tile(&self, window: Window, list: &[u32], pixels: &mut [Pixel]) {
        let (mut scratch, mut memory) = (PaintScratch::default(), pixels.to_vec());
        let mut target = whole(pixels, window);
        let slab = |index: &u32| self.slabs[*index as usize];
        for of_slab in list.chunk_by(|a, b| slab(a) == slab(b)) {
            let touched = self.touched(of_slab, &window);
            let sheet = &mut memory[..touched.pixels()];
            let work = TileWork {
                window: touched,
                footprints: self.footprints,
                list: of_slab,
                start: Start::Clear,
                pixels: &mut *sheet,
            };
            self.painter.paint(&mut scratch, work);
            let sheet = SheetBuffer::drawn(sheet, touched, columns(&touched), &self.widths);
            if let Ok(mut sheet) = sheet {
                sheet.composite_behind(&self.blend, &mut target);
            }
        }
    }

    /// The part of the tile that these footprints touch, from the beginning of a block: a row has seeds at every block.
    fn touched(&self, list: &[u32], tile: &Window) -> Window {
        let footprints = list
            .iter()
            .flat_map(|index| &self.footprints[*index as usize]);
        let windows = footprints.map(|footprint| Window::of(footprint).intersect(tile));
        let all = windows.reduce(|a, b| Window {
            first: [0, 1].map(|axis| a.first[axis].min(b.first[axis])),
            end: [0, 1].map(|axis| a.end[axis].max(b.end[axis])),
        });
        let all = all.unwrap_or(Window {
            end: tile.first,
            ..*tile
        });
        Window {
            first: [all.first[0] - all.first[0] % BLOCK, all.first[1]],
            ..all
        }
    }
}

fn columns(window: &Window) -> usize {
    window.columns().into()
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
                        let cut = Footprint {
                            opacity: peak as u32,
                            ..footprint
                        };
                        (slab.into(), cut)
                    })
                    .collect()
            }
            SlabRule::Depth(slabs, _) => {
                vec![(slabs.slab(depth::fixed(footprint.depth)).into(), footprint)]
            }
        }
    }
}
