//! Drawing a quantised scene: setup of every splat, depth order, tiles on all cores.

use super::frame::{converter, to_picture};
use super::quantise::{QuantisedScene, kernel_compositing};
use crate::camera::Camera;
use crate::design::DesignChoice;
pub(super) use crate::fast::CHECK_INTERVAL;
use crate::fast::depth_first::DepthFirst;
pub use crate::fast::frame::Times;
use crate::fast::frame::{Cancelled, FrameFacts, FrameMemory, FramePlan, Progress};
use crate::fast::lanes::{VectorLevel, has_vectors};
use crate::fast::setup::{self as fast, Outcome};
use crate::fast::{PaintScratch, TilePainter, TileWork, tile_painter};
use crate::picture::Picture;
use crate::rules::{Compositing, Rules};
use crate::scene::Scene;
use rayon::prelude::*;
use splatline::blend::Pixel;
use splatline::draw::Coverage;
use splatline::footprint::Footprint;
use splatline::format::{Design, RuntimeWidths, Traversal, Widths};
use splatline::raster::Window;
use splatline::rules as kernel;
use splatline::setup::{
    Covariance2d, Cull, conic, covariance, distance, ldl, project, project_axes,
};
use splatline::splat::VolumeSplat;

/// Which implementation paints. All give the same pixels and counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PaintEngine {
    /// The kernel's scalar painter, which is the definition.
    Scalar,
    /// Vectors where they can, else the scalar painter.
    Vectors(VectorLevel),
}

impl PaintEngine {
    /// The vectors, if there are any.
    pub fn vectors(self) -> Option<VectorLevel> {
        match self {
            PaintEngine::Vectors(level) => Some(level),
            PaintEngine::Scalar => None,
        }
    }
}

/// What draws unless something else is asked for.
pub fn best_engine() -> PaintEngine {
    if has_vectors() {
        PaintEngine::Vectors(VectorLevel::Best)
    } else {
        PaintEngine::Scalar
    }
}

/// How to draw.
#[derive(Clone, Debug)]
pub struct Options<'a> {
    /// Rules of blending.
    pub rules: &'a Rules,
    /// Order and operator.
    pub compositing: Compositing,
    /// Widths.
    pub design: &'a DesignChoice,
    /// Order of the pixels.
    pub traversal: Traversal,
}

impl<'a> Options<'a> {
    /// Front to back along the design's own traversal.
    pub fn front_to_back(rules: &'a Rules, design: &'a DesignChoice) -> Options<'a> {
        Options {
            rules,
            compositing: Compositing::FrontToBack,
            design,
            traversal: design.traversal,
        }
    }
}

/// What a drawing gives.
#[derive(Clone, Debug)]
pub struct FixedDrawing {
    /// The picture, converted to double precision without further rounding.
    pub picture: Picture,
    /// The kernel's pixels, row-major.
    pub pixels: Vec<Pixel>,
    /// Splats of the scene.
    pub splats: usize,
    /// Splats of which a coordinate or colour is not finite.
    pub clamped: usize,
    /// Unit of the kernel's colours as a power of two; the picture has been multiplied by it.
    pub colour_log2: i32,
    /// Splats culled, pixels covered, and times of the stages.
    pub facts: FrameFacts,
}

impl FixedDrawing {
    /// Of a scene's pixels and what a frame of them did.
    pub(super) fn new(
        quantised: &QuantisedScene,
        widths: &Widths,
        pixels: Vec<Pixel>,
        facts: FrameFacts,
    ) -> Self {
        let convert = converter(widths, quantised.colour_log2);
        FixedDrawing {
            picture: to_picture(&pixels, quantised.view.viewport, convert),
            pixels,
            splats: quantised.splats.len(),
            clamped: quantised.clamped,
            colour_log2: quantised.colour_log2,
            facts,
        }
    }
}

/// Footprints of all splats, in the scene's order.
pub fn footprints(
    scene: &Scene,
    camera: &Camera,
    options: &Options,
) -> Vec<Result<Footprint, Cull>> {
    let quantised = QuantisedScene::new(scene, camera, options.rules);
    set_up(options.design.in_fields(), &quantised, best_engine())
}

/// Conics (a, b, c) of all splats in double precision, whether or not they reach the viewport; `None` where the depth,
/// the range or the shape culls.
pub fn conics(scene: &Scene, camera: &Camera, options: &Options) -> Vec<Option<[f64; 3]>> {
    let widths = &options.design.widths;
    let conic_of = |variance: &Covariance2d| {
        let conic = conic(widths, variance, ldl(widths, variance)?.horizontal)?;
        let unit = f64::from(conic.exponent).exp2();
        Some(conic.mantissa.map(|m| f64::from(m) * unit))
    };
    let variances = kernel_variances(scene, camera, options);
    variances
        .iter()
        .map(|variance| conic_of(variance.as_ref()?))
        .collect()
}

/// Vxx, Vxy, Vyy and the determinant of all splats in double precision, whether or not they reach the viewport; `None`
/// where the depth or the range culls.
pub fn variances(scene: &Scene, camera: &Camera, options: &Options) -> Vec<Option<[f64; 4]>> {
    let in_double = |variance: Covariance2d| {
        let Covariance2d {
            xx,
            xy,
            yy,
            determinant,
        } = variance;
        [xx, xy, yy, determinant].map(|x| f64::from(x.mantissa) * f64::from(x.exponent).exp2())
    };
    let variances = kernel_variances(scene, camera, options);
    variances.into_iter().map(|v| v.map(in_double)).collect()
}

fn kernel_variances(
    scene: &Scene,
    camera: &Camera,
    options: &Options,
) -> Vec<Option<Covariance2d>> {
    let quantised = QuantisedScene::new(scene, camera, options.rules);
    let widths = &options.design.widths;
    let rules = &quantised.rules;
    let variance_of = |splat: &VolumeSplat| {
        let projected = project(widths, &quantised.view, rules, &splat.centre).ok()?;
        let mut columns = project_axes(widths, &quantised.view.rotation, &projected, &splat.axes);
        if let Some(factor) = distance::enlargement(widths, rules, &projected) {
            columns = distance::enlarge(widths, columns, factor);
        }
        Some(covariance(widths, rules.low_pass, &columns))
    };
    quantised.splats.iter().map(variance_of).collect()
}

/// Setup of some of the scene's splats into as many places, with the keys that the scene is sorted by.
fn set_up_part(
    design: RuntimeWidths,
    quantised: &QuantisedScene,
    engine: PaintEngine,
    splats: &[VolumeSplat],
    outcomes: &mut [Outcome],
) {
    fast::set_up(
        design,
        &quantised.view,
        &quantised.rules,
        splats,
        outcomes,
        engine.vectors(),
    );
    quantised.sort_keys(&design.widths(), splats, outcomes);
}

/// Footprints of all splats that have one, in the scene's order, with the sort keys that setup gives them.
pub(super) fn seen(
    design: RuntimeWidths,
    quantised: &QuantisedScene,
    engine: PaintEngine,
) -> Vec<(usize, Footprint)> {
    let QuantisedScene { view, rules, .. } = quantised;
    let batch = |(number, splats): (usize, &[VolumeSplat])| {
        let mut outcomes = vec![Err(Cull::Near); splats.len()];
        fast::set_up(design, view, rules, splats, &mut outcomes, engine.vectors());
        numbered(number * BATCH, outcomes)
    };
    let batches = quantised.splats.par_chunks(BATCH).enumerate();
    batches.flat_map_iter(batch).collect()
}

/// Those that have a footprint, with their numbers from `first` on.
pub(super) fn numbered(
    first: usize,
    outcomes: Vec<Outcome>,
) -> impl Iterator<Item = (usize, Footprint)> {
    let numbered = (first..).zip(outcomes);
    numbered.filter_map(|(index, outcome)| Some((index, outcome.ok()?)))
}

/// Splats set up by one task.
const BATCH: usize = 1024;

/// Setup of the scene, a splat a place.
pub fn set_up(
    design: RuntimeWidths,
    quantised: &QuantisedScene,
    engine: PaintEngine,
) -> Vec<Outcome> {
    let splats = &quantised.splats;
    let mut outcomes: Vec<_> = splats.par_iter().map(|_| Err(Cull::Near)).collect();
    let places = outcomes.par_chunks_mut(BATCH);
    let batches = places.zip(splats.par_chunks(BATCH));
    batches.for_each(|(outcomes, splats)| {
        set_up_part(design, quantised, engine, splats, outcomes);
    });
    outcomes
}

/// Draws `scene` as `camera` sees it.
pub fn draw(scene: &Scene, camera: &Camera, options: &Options) -> FixedDrawing {
    draw_with_footprints(scene, camera, options).0
}

/// The same, with what setup made of every splat, in the scene's order: a machine can be timed on it without a second
/// setup.
pub fn draw_with_footprints(
    scene: &Scene,
    camera: &Camera,
    options: &Options,
) -> (FixedDrawing, Vec<Result<Footprint, Cull>>) {
    let quantised = QuantisedScene::new(scene, camera, options.rules);
    draw_quantised(&quantised, options, best_engine())
}

/// A scene that has been quantised already, by the engine asked for.
pub fn draw_quantised(
    quantised: &QuantisedScene,
    options: &Options,
    engine: PaintEngine,
) -> (FixedDrawing, Vec<Result<Footprint, Cull>>) {
    let mut memory = FrameMemory::default();
    let painter = painter(&quantised.rules, options, engine, true);
    let facts = paint_whole(quantised, options, engine, &*painter, &mut memory);
    let (pixels, widths) = (memory.pixels(), &options.design.widths);
    let drawing = FixedDrawing::new(quantised, widths, pixels, facts);
    (drawing, memory.into_outcomes())
}

/// A frame in memory, by whatever paints its tiles. It does not know how the scene is held, and is therefore compiled
/// here and not again by whoever draws.
pub(crate) fn paint_with(
    quantised: &QuantisedScene,
    options: &Options,
    engine: PaintEngine,
    (painter, depth_first): (&dyn TilePainter, Option<DepthFirst>),
    memory: &mut FrameMemory,
    progress: &Progress,
) -> Result<FrameFacts, Cancelled> {
    let design = options.design.in_fields();
    let plan = FramePlan {
        viewport: quantised.view.viewport,
        back_to_front: options.compositing == Compositing::BackToFront,
        depth_first,
        set_up: &|_, splats, outcomes| {
            set_up_part(design, quantised, engine, splats, outcomes);
        },
        painter,
        progress,
    };
    memory.draw(&quantised.splats, &plan)
}

/// The same where no splat is left out and nobody cancels.
fn paint_whole(
    quantised: &QuantisedScene,
    options: &Options,
    engine: PaintEngine,
    painter: &dyn TilePainter,
    memory: &mut FrameMemory,
) -> FrameFacts {
    let painter = (painter, None);
    let Ok(facts) = paint_with(quantised, options, engine, painter, memory, &|_, _| true) else {
        unreachable!("nobody cancels")
    };
    facts
}

/// What draws a scene by one design after the other: fresh memory costs as much as drawing, so a picture lies where the
/// last one lay.
#[derive(Clone, Debug)]
pub struct Canvas {
    memory: FrameMemory,
    /// What was drawn last.
    pub picture: Picture,
}

impl Canvas {
    /// Of a camera's size.
    pub fn new(camera: &Camera) -> Canvas {
        Canvas {
            memory: FrameMemory::default(),
            picture: Picture::new(camera.width, camera.height),
        }
    }

    /// The picture that [`draw_quantised`] draws; `only` names windows without whose tiles the rest of it means
    /// nothing.
    pub fn draw(&mut self, quantised: &QuantisedScene, options: &Options, only: Option<&[Window]>) {
        let engine = best_engine();
        let inner = painter(&quantised.rules, options, engine, false);
        let chosen = ChosenTiles { inner, only };
        paint_whole(quantised, options, engine, &chosen, &mut self.memory);
        let convert = converter(&options.design.widths, quantised.colour_log2);
        self.memory.copy(&mut self.picture.pixels, convert);
    }
}

/// Paints the tiles that touch one of some windows, or all.
struct ChosenTiles<'a> {
    inner: Box<dyn TilePainter>,
    only: Option<&'a [Window]>,
}

impl TilePainter for ChosenTiles<'_> {
    fn paint(&self, scratch: &mut PaintScratch, work: TileWork) -> Coverage {
        let touches = |other: &Window| !work.window.intersect(other).is_empty();
        match self.only {
            Some(only) if !only.iter().any(touches) => Coverage::default(),
            _ => self.inner.paint(scratch, work),
        }
    }
}

/// What paints tiles under these options.
pub fn painter(
    rules: &kernel::Rules,
    options: &Options,
    engine: PaintEngine,
    counts: bool,
) -> Box<dyn TilePainter> {
    let order = kernel_compositing(options.compositing);
    let (choice, traversal) = (engine.vectors(), options.traversal);
    match options.design.in_short_lanes() {
        Some(design) => tile_painter(design, rules, order, traversal, choice, counts),
        None => {
            let design = options.design.in_fields();
            tile_painter(design, rules, order, traversal, choice, counts)
        }
    }
}

/// How many results were culled, by reason, in the order of [`Cull::ALL`].
pub fn culls<T>(results: &[Result<T, Cull>]) -> [usize; Cull::ALL.len()] {
    let mut culled = [0; Cull::ALL.len()];
    for reason in results.iter().filter_map(|result| result.as_ref().err()) {
        culled[reason.place()] += 1;
    }
    culled
}
