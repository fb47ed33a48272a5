//! Points and splats through the kernel, frame after frame in the same memory: choice, setup, order, slabs, stamps.

use super::quantise::{QuantisedScene, kernel_compositing, scaled};
use super::render::{CHECK_INTERVAL, Options, PaintEngine, painter};
use crate::camera::Camera;
use crate::fast::frame::{FrameFacts, FrameMemory, FramePlan};
use crate::fast::setup::{self as fast, Outcome};
use crate::fast::{PaintScratch, Start, TableMemory, TilePainter, TileWork, whole};
use crate::fixed::frame::converter;
use crate::hybrid::{Hybrid, Points, deviation};
use crate::picture::Picture;
use crate::scene::Scene;
use rayon::prelude::*;
use splatline::blend::Pixel;
use splatline::blend::points::{Slab, Slabs};
use splatline::draw::{Coverage, Painter, PointSettings};
use splatline::footprint::Footprint;
use splatline::format::{Design, RuntimeWidths, Traversal};
use splatline::kernel::FootprintTable;
use splatline::raster::{Stamp, StampShape, Window, fill_stamps};
use splatline::setup::{PointFilter, is_minified, setup_point};
use splatline::splat::VolumeSplat;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// What a frame did beside its pixels.
#[derive(Clone, Copy, Debug, Default)]
pub struct HybridFacts {
    /// Splats culled, pixels covered, and times of the stages.
    pub frame: FrameFacts,
    /// Footprints drawn as points.
    pub points: usize,
    /// Footprints in all.
    pub drawn: usize,
}

/// A scene of spherical kernels with all that its frames of points and splats need.
pub struct HybridRenderer<'a> {
    options: Options<'a>,
    hybrid: &'a Hybrid,
    setup: HybridSetup,
    table: TableMemory,
    /// Draws where points are splats like others.
    painter: Box<dyn TilePainter>,
    memory: FrameMemory,
}

impl<'a> HybridRenderer<'a> {
    /// The scene in the kernel's formats, drawn by an engine that counts pixels or not. The options' rules need a
    /// spacing and a constant cut-off; the error says what they lack. Frames are drawn by the rayon pool that they are
    /// asked for in.
    pub fn new(
        scene: &Scene,
        camera: &Camera,
        options: Options<'a>,
        hybrid: &'a Hybrid,
        (engine, counts): (PaintEngine, bool),
    ) -> Result<Self, String> {
        let quantised = QuantisedScene::with_depths(scene, camera, options.rules);
        let (rules, widths) = (&quantised.rules, &options.design.widths);
        let deviation = scaled(deviation(scene)).scaled_by(quantised.scale_log2);
        let filter = PointFilter::new(widths, rules, deviation).ok_or(
            "points need rules with a spacing and a constant cut-off, such as 'ewa' with --antialias swan",
        )?;
        let options = Options {
            traversal: Traversal::Spans,
            ..options
        };
        Ok(HybridRenderer {
            hybrid,
            table: TableMemory::new(widths, rules),
            painter: painter(rules, &options, engine, counts),
            memory: FrameMemory::default(),
            setup: HybridSetup {
                design: options.design.in_fields(),
                filter,
                points: hybrid.points,
                engine,
                is_point: quantised.splats.iter().map(|_| false.into()).collect(),
                quantised,
            },
            options,
        })
    }

    /// The scene in the kernel's formats.
    pub fn quantised(&self) -> &QuantisedScene {
        &self.setup.quantised
    }

    /// Draws a frame as a picture in double precision, converted without further rounding; one of another size is
    /// replaced. The error says that footprints are too large for a stamp.
    pub fn draw_picture(&mut self, picture: &mut Picture) -> Result<HybridFacts, String> {
        let facts = self.draw()?;
        let quantised = &self.setup.quantised;
        let [width, height] = quantised.view.viewport.map(usize::from);
        if [picture.width, picture.height] != [width, height] {
            *picture = Picture::new(width, height);
        }
        let convert = converter(&self.options.design.widths, quantised.colour_log2);
        self.memory.copy(&mut picture.pixels, convert);
        Ok(facts)
    }

    /// Draws a frame into the renderer's memory.
    fn draw(&mut self) -> Result<HybridFacts, String> {
        let HybridRenderer {
            options,
            hybrid,
            setup,
            table,
            painter,
            memory,
        } = self;
        let (quantised, table) = (&setup.quantised, &*table);
        let started = Instant::now();
        let stamps = match hybrid.phase_bits {
            Some(bits) => setup.stamps(&table.table(), bits)?,
            None => None,
        };
        let stamped_at = started.elapsed().as_secs_f64();
        let shape = stamps.as_ref().map(|(_, shape)| shape);
        let order = kernel_compositing(options.compositing);
        let among_points = PointTiles {
            painter: table.painter(setup.design, order, Traversal::Spans),
            gathering: PointSettings {
                range: depth_range(hybrid, quantised),
                stamp: (stamps.as_ref()).and_then(|(words, shape)| Stamp::new(words, *shape)),
            },
            gathers: hybrid.depth_range.is_some(),
            clear: Pixel::clear(&options.design.widths),
            is_point: &setup.is_point,
        };
        // Without stamps and slabs points are splats like others, which the fast engine draws.
        let plain = stamps.is_none() && hybrid.depth_range.is_none();
        let plan = FramePlan {
            viewport: quantised.view.viewport,
            back_to_front: options.compositing == crate::rules::Compositing::BackToFront,
            depth_first: None,
            set_up: &|first, splats, outcomes| setup.set_up(first, splats, outcomes, shape),
            painter: if plain { &**painter } else { &among_points },
            progress: &|_, _| true,
        };
        let Ok(mut frame) = memory.draw(&quantised.splats, &plan) else {
            unreachable!("nobody cancels")
        };
        frame.times.setup += stamped_at;
        let [points, drawn] = self.counts();
        Ok(HybridFacts {
            frame,
            points,
            drawn,
        })
    }

    /// Footprints drawn as points, and footprints in all.
    fn counts(&self) -> [usize; 2] {
        let outcomes = self.memory.outcomes().par_iter().zip(&self.setup.is_point);
        let count = |(outcome, is_point): (&Outcome, &AtomicBool)| match outcome {
            Ok(footprint) if !Window::of(footprint).is_empty() => {
                [is_point.load(Ordering::Relaxed).into(), 1]
            }
            _ => [0, 0],
        };
        outcomes
            .map(count)
            .reduce(|| [0; 2], |a, b| [a[0] + b[0], a[1] + b[1]])
    }
}

/// The depth range in the footprints' UQ9.23.
fn depth_range(hybrid: &Hybrid, quantised: &QuantisedScene) -> u32 {
    let range = hybrid.depth_range.unwrap_or(0.0);
    let unit = f64::from(quantised.scale_log2 + 23).exp2();
    (range * unit) as u32
}

/// Setup of points and splats.
struct HybridSetup {
    design: RuntimeWidths,
    quantised: QuantisedScene,
    filter: PointFilter,
    points: Points,
    engine: PaintEngine,
    /// Is a splat a point? Written by the thread that sets it up.
    is_point: Vec<AtomicBool>,
}

impl HybridSetup {
    /// Sets up splats numbered from `first`. With stamps, boxes of points become those of their stamps: empty ones are
    /// not drawn.
    fn set_up(
        &self,
        first: usize,
        splats: &[VolumeSplat],
        outcomes: &mut [Outcome],
        shape: Option<&StampShape>,
    ) {
        let flags = self.is_point.get(first..).unwrap_or_default();
        let mut points = 0;
        for (flag, splat) in flags.iter().zip(splats) {
            let is_point = self.is_point(splat);
            flag.store(is_point, Ordering::Relaxed);
            points += usize::from(is_point);
        }
        if points < splats.len() {
            let QuantisedScene { view, rules, .. } = &self.quantised;
            let vectors = self.engine.vectors();
            fast::set_up(self.design, view, rules, splats, outcomes, vectors);
        }
        if points == 0 {
            return;
        }
        for ((flag, splat), outcome) in flags.iter().zip(splats).zip(outcomes) {
            if flag.load(Ordering::Relaxed) {
                *outcome = self.set_up_point(splat);
                if let (Some(shape), Ok(footprint)) = (shape, outcome) {
                    self.move_to_phase(shape, footprint);
                }
            }
        }
    }

    fn is_point(&self, splat: &VolumeSplat) -> bool {
        match self.points {
            Points::All => true,
            Points::None => false,
            Points::Auto => {
                let QuantisedScene { view, rules, .. } = &self.quantised;
                is_minified(&self.design.widths(), view, rules, splat)
            }
        }
    }

    fn set_up_point(&self, splat: &VolumeSplat) -> Outcome {
        let QuantisedScene { view, rules, .. } = &self.quantised;
        setup_point(self.design, view, rules, splat, &self.filter)
    }

    /// The box of a point becomes that of its stamp.
    fn move_to_phase(&self, shape: &StampShape, footprint: &mut Footprint) {
        let placement = shape.place(footprint.centre, self.design.widths().subpixel);
        let bounds = shape.bounds(&placement, self.quantised.view.viewport);
        (footprint.first, footprint.end) = (bounds.first, bounds.end);
    }

    /// Stamp memory and shape, if there is a point to stamp.
    fn stamps(
        &self,
        table: &FootprintTable,
        bits: u8,
    ) -> Result<Option<(Vec<u32>, StampShape)>, String> {
        let point = |splat: &VolumeSplat| {
            let is_point = self.is_point(splat);
            is_point.then(|| self.set_up_point(splat).ok()).flatten()
        };
        let Some(point) = self.quantised.splats.par_iter().find_map_first(point) else {
            return Ok(None);
        };
        let shape = StampShape::new(&point, bits).map_err(|error| {
            let [columns, rows] = error.side;
            format!("no stamp of {columns}x{rows} pixels at 2^{} phases: choose a smaller spacing or fewer phases", error.phase_bits)
        })?;
        let mut words = vec![0; shape.words()];
        fill_stamps(&mut words, self.design, table, &shape, &point);
        Ok(Some((words, shape)))
    }
}

/// Paints tiles in which points are gathered or stamped.
struct PointTiles<'a> {
    painter: Painter<'a, RuntimeWidths>,
    gathering: PointSettings<'a>,
    /// Are points gathered within a depth range?
    gathers: bool,
    clear: Pixel,
    is_point: &'a [AtomicBool],
}

impl TilePainter for PointTiles<'_> {
    fn paint(&self, _: &mut PaintScratch, work: TileWork) -> Coverage {
        if work.start == Start::Clear {
            work.pixels.fill(self.clear);
        }
        let window = work.window;
        let mut target = whole(work.pixels, window);
        // Points are gathered, splats composited behind what was gathered before them; elsewhere both are composited
        // one by one, points by the stamp if there is one.
        let mut memory = Vec::new();
        let mut slabs = None;
        if self.gathers {
            memory.resize(window.pixels(), Slab::default());
            slabs = Some(Slabs::new(&mut memory, window).expect("as many slabs as pixels"));
        }
        let (painter, mut coverage) = (&self.painter, Coverage::default());
        for (number, index) in work.list.iter().enumerate() {
            let Ok(footprint) = &work.footprints[*index as usize] else {
                continue;
            };
            let is_point = self.is_point[*index as usize].load(Ordering::Relaxed);
            coverage += match (&mut slabs, &self.gathering.stamp) {
                (Some(slabs), _) if is_point => {
                    painter.draw_point(footprint, &self.gathering, &mut target, slabs)
                }
                (Some(slabs), _) => painter.draw_among_points(footprint, &mut target, slabs),
                (None, Some(stamp)) if is_point => {
                    painter.draw_stamp(stamp, footprint, &mut target)
                }
                (None, _) => painter.draw(footprint, &mut target),
            };
            if number % CHECK_INTERVAL == 0 && target.is_finished() {
                break;
            }
        }
        if let Some(slabs) = &mut slabs {
            painter.finish_points(&mut target, slabs);
        }
        coverage
    }
}
