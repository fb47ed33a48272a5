//! Points and splats through the kernel: choice, setup, order, slabs, stamps.

use super::frame::{TileLists, paint_apart, paint_tiles, table, table_entries, to_picture, total};
use super::quantise::{QuantisedScene, kernel_compositing, scaled};
use super::render::{Drawing, Options, Times, best_engine, culls, painter};
use crate::camera::Camera;
use crate::design::DesignJob;
use crate::fast::Scratch;
use crate::hybrid::{Hybrid, Points, deviation};
use crate::scene::Scene;
use rayon::prelude::*;
use splatline::blend::Pixel;
use splatline::blend::points::{Slab, Slabs};
use splatline::draw::{Coverage, Painter, PointSettings};
use splatline::footprint::Footprint;
use splatline::format::{Design, Traversal};
use splatline::kernel::FootprintTable;
use splatline::raster::{Stamp, StampShape, fill_stamps};
use splatline::rules as kernel;
use splatline::setup::{Cull, PointFilter, is_minified, setup, setup_point};
use splatline::splat::VolumeSplat;
use splatline::target::Target;
use std::cell::RefCell;
use std::time::Instant;

thread_local! {
    /// A thread's memory for the tile that it paints.
    static SCRATCH: RefCell<Scratch> = RefCell::default();
}

/// A drawing with the share of points.
#[derive(Clone, Debug)]
pub struct HybridDrawing {
    /// The drawing.
    pub drawing: Drawing,
    /// Footprints drawn as points.
    pub points: usize,
    /// Footprints in all.
    pub drawn: usize,
    /// Words of stamp memory.
    pub stamp_words: usize,
}

/// Draws a scene of spherical kernels as points and splats. The options' rules need a spacing and a constant cut-off.
///
/// The error says what the rules lack, or that footprints are too large for a stamp.
pub fn draw_hybrid(
    scene: &Scene,
    camera: &Camera,
    options: &Options,
    hybrid: &Hybrid,
) -> Result<HybridDrawing, String> {
    struct HybridJob<'a>(
        &'a Hybrid,
        &'a QuantisedScene,
        &'a Camera,
        &'a Options<'a>,
        f64,
    );
    impl DesignJob for HybridJob<'_> {
        type Output = Result<HybridDrawing, String>;
        fn run<D: Design + Send + Sync + 'static>(self, design: D) -> Self::Output {
            let HybridJob(hybrid, quantised, camera, options, deviation) = self;
            let rules = quantised.rules(options.rules);
            let deviation = scaled(deviation).scaled_by(quantised.scale_log2);
            let filter = PointFilter::new(&design.widths(), &rules, deviation).ok_or(
                "points need rules with a spacing and a constant cut-off, such as 'ewa' with --antialias swan",
            )?;
            let engine = HybridEngine {
                design,
                quantised,
                rules,
                filter,
                hybrid,
            };
            engine.draw(camera, options)
        }
    }
    let quantised = QuantisedScene::with_depths(scene, camera, options.rules);
    let job = HybridJob(hybrid, &quantised, camera, options, deviation(scene));
    options.design.dispatch(job)
}

/// A footprint and whether it is the point filter's.
type SplatOrPoint = (Footprint, bool);

struct HybridEngine<'a, D> {
    design: D,
    quantised: &'a QuantisedScene,
    rules: kernel::Rules,
    filter: PointFilter,
    hybrid: &'a Hybrid,
}

impl<D: Design + Send + Sync + 'static> HybridEngine<'_, D> {
    fn draw(&self, camera: &Camera, options: &Options) -> Result<HybridDrawing, String> {
        let widths = self.design.widths();
        let started = Instant::now();
        let results = self.set_up();
        let culled = culls(&results);
        let (mut footprints, mut is_point): (Vec<_>, Vec<_>) =
            results.into_iter().flatten().unzip();
        let memory = table_entries(&widths, &self.rules);
        let table = table(&memory, &widths, &self.rules);
        let first_point = is_point.iter().position(|point| *point);
        let stamps = self.stamps(&table, first_point.map(|index| &footprints[index]))?;
        if let Some((_, shape)) = &stamps {
            self.move_to_phases(shape, &mut footprints, &mut is_point);
        }
        let set_up_at = started.elapsed().as_secs_f64();
        let viewport = self.quantised.view.viewport;
        let tiles = TileLists::by_depth(&footprints, options.compositing, viewport);
        let sorted_at = started.elapsed().as_secs_f64();
        let plain = stamps.is_none() && self.hybrid.depth_range.is_none();
        let (pixels, coverage) = if plain {
            self.paint_plain(options, &footprints, &tiles)
        } else {
            let list = footprints.iter().copied().zip(is_point.iter().copied());
            let drawn: Vec<SplatOrPoint> = list.collect();
            self.paint_points(options, (table, stamps.as_ref()), &drawn, &tiles)
        };
        let times = Times {
            setup: set_up_at,
            sort: sorted_at - set_up_at,
            raster: started.elapsed().as_secs_f64() - sorted_at,
        };
        Ok(HybridDrawing {
            points: is_point.iter().filter(|point| **point).count(),
            drawn: footprints.len(),
            stamp_words: stamps.map_or(0, |(words, _)| words.len()),
            drawing: Drawing {
                picture: to_picture(&pixels, camera, &widths, self.quantised.colour_log2),
                pixels,
                splats: self.quantised.splats.len(),
                culled,
                clamped: self.quantised.clamped,
                colour_log2: self.quantised.colour_log2,
                coverage,
                times,
            },
        })
    }

    /// Without stamps and slabs points are splats like others, which the fast engine draws.
    fn paint_plain(
        &self,
        options: &Options,
        footprints: &[Footprint],
        tiles: &TileLists,
    ) -> (Vec<Pixel>, Coverage) {
        let options = Options {
            traversal: Traversal::Spans,
            ..options.clone()
        };
        let painter = painter(self.design, &self.rules, &options, best_engine(), true);
        let outcomes: Vec<_> = footprints.iter().map(|footprint| Ok(*footprint)).collect();
        let clear = Pixel::clear(&self.design.widths());
        let (pixels, parts) = paint_apart(clear, tiles, |window, list, pixels| {
            SCRATCH
                .with_borrow_mut(|scratch| painter.paint(scratch, window, &outcomes, list, pixels))
        });
        (pixels, total(parts))
    }

    fn paint_points(
        &self,
        options: &Options,
        (table, stamps): (FootprintTable, Option<&(Vec<u32>, StampShape)>),
        drawn: &[SplatOrPoint],
        tiles: &TileLists,
    ) -> (Vec<Pixel>, Coverage) {
        let order = kernel_compositing(options.compositing);
        let painter = Painter::new(self.design, &self.rules, table, order, Traversal::Spans);
        let gathering = PointSettings {
            range: self.depth_range(),
            stamp: stamps.and_then(|(words, shape)| Stamp::new(words, *shape)),
        };
        paint_tiles(&self.design.widths(), tiles, |list, target| {
            let list = list.iter().map(|index| {
                let (footprint, is_point) = &drawn[*index as usize];
                (footprint, *is_point)
            });
            match self.hybrid.depth_range {
                Some(_) => gather_tile(&painter, &gathering, list, target),
                None => stamp_tile(&painter, &gathering, list, target),
            }
        })
    }

    fn set_up(&self) -> Vec<Result<SplatOrPoint, Cull>> {
        let splats = self.quantised.splats.par_iter();
        splats.map(|splat| self.set_up_one(splat)).collect()
    }

    fn set_up_one(&self, splat: &VolumeSplat) -> Result<SplatOrPoint, Cull> {
        let (view, widths) = (&self.quantised.view, self.design.widths());
        let as_point = match self.hybrid.points {
            Points::All => true,
            Points::None => false,
            Points::Auto => is_minified(&widths, view, &self.rules, splat),
        };
        let footprint = if as_point {
            setup_point(self.design, view, &self.rules, splat, &self.filter)
        } else {
            setup(self.design, view, &self.rules, splat)
        };
        footprint.map(|footprint| (footprint, as_point))
    }

    /// Boxes of points become those of their stamps; a stamp that leaves the viewport is dropped.
    fn move_to_phases(
        &self,
        shape: &StampShape,
        footprints: &mut Vec<Footprint>,
        is_point: &mut Vec<bool>,
    ) {
        let subpixel = self.design.widths().subpixel;
        let viewport = self.quantised.view.viewport;
        for (footprint, _) in footprints.iter_mut().zip(&*is_point).filter(|(_, p)| **p) {
            let placement = shape.place(footprint.centre, subpixel);
            let bounds = shape.bounds(&placement, viewport);
            (footprint.first, footprint.end) = (bounds.first, bounds.end);
        }
        let visible = |f: &Footprint| f.first[0] < f.end[0] && f.first[1] < f.end[1];
        let kept: Vec<bool> = footprints.iter().map(visible).collect();
        let mut at = kept.iter();
        footprints.retain(|_| at.next().copied().unwrap_or(false));
        let mut at = kept.iter();
        is_point.retain(|_| at.next().copied().unwrap_or(false));
    }

    /// The depth range in the footprints' UQ9.23.
    fn depth_range(&self) -> u32 {
        let range = self.hybrid.depth_range.unwrap_or(0.0);
        let unit = f64::from(self.quantised.scale_log2 + 23).exp2();
        (range * unit) as u32
    }

    /// Stamp memory and shape, if stamps are asked for and there is a point to stamp.
    fn stamps(
        &self,
        table: &FootprintTable,
        point: Option<&Footprint>,
    ) -> Result<Option<(Vec<u32>, StampShape)>, String> {
        let (Some(bits), Some(point)) = (self.hybrid.phase_bits, point) else {
            return Ok(None);
        };
        let shape = StampShape::new(point, bits).map_err(|error| {
            let [columns, rows] = error.side;
            format!("no stamp of {columns}x{rows} pixels at 2^{} phases: choose a smaller spacing or fewer phases", error.phase_bits)
        })?;
        let mut words = vec![0; shape.words()];
        fill_stamps(&mut words, self.design, table, &shape, point);
        Ok(Some((words, shape)))
    }
}

/// Points are gathered, splats composited behind what was gathered before them.
fn gather_tile<'a, D: Design>(
    painter: &Painter<D>,
    gathering: &PointSettings,
    list: impl Iterator<Item = (&'a Footprint, bool)>,
    target: &mut Target,
) -> Coverage {
    let window = target.window();
    let area =
        usize::from(window.end[0] - window.first[0]) * usize::from(window.end[1] - window.first[1]);
    let mut memory = vec![Slab::default(); area];
    let Some(mut slabs) = Slabs::new(&mut memory, window) else {
        unreachable!("the slabs have just been made for the window")
    };
    let mut coverage = Coverage::default();
    for (number, (footprint, is_point)) in list.enumerate() {
        coverage += if is_point {
            painter.draw_point(footprint, gathering, target, &mut slabs)
        } else {
            painter.draw_among_points(footprint, target, &mut slabs)
        };
        if number % super::render::CHECK_INTERVAL == 0 && target.is_finished() {
            break;
        }
    }
    painter.finish_points(target, &mut slabs);
    coverage
}

/// Points and splats are composited one by one, points by the stamp if there is one.
fn stamp_tile<'a, D: Design>(
    painter: &Painter<D>,
    gathering: &PointSettings,
    list: impl Iterator<Item = (&'a Footprint, bool)>,
    target: &mut Target,
) -> Coverage {
    let mut coverage = Coverage::default();
    for (number, (footprint, is_point)) in list.enumerate() {
        coverage += match &gathering.stamp {
            Some(stamp) if is_point => painter.draw_stamp(stamp, footprint, target),
            _ => painter.draw(footprint, target),
        };
        if number % super::render::CHECK_INTERVAL == 0 && target.is_finished() {
            break;
        }
    }
    coverage
}
