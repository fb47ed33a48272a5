//! Drawing a quantised scene: setup of every splat, depth order, tiles on all cores.

use super::frame::{TileLists, paint_frame, paint_tiles, table, table_entries, to_picture, total};
use super::quantise::{QuantisedScene, kernel_compositing};
use crate::camera::Camera;
use crate::design::{DesignChoice, DesignJob};
pub(super) use crate::fast::CHECK_INTERVAL;
use crate::fast::lanes::{Choice, has_vectors};
use crate::fast::setup as fast;
use crate::fast::{Scratch, tile_painter};
use crate::picture::Picture;
use crate::rules::{Compositing, Rules};
use crate::scene::Scene;
use rayon::prelude::*;
use splatline::blend::Pixel;
use splatline::draw::{Coverage, Painter};
use splatline::footprint::Footprint;
use splatline::format::{Design, Traversal, Widths};
use splatline::rules as kernel;
use splatline::setup::{Cull, Variance, columns, conic, distance, project, scan, setup, variance};
use splatline::splat::VolumeSplat;
use std::time::Instant;

/// Which implementation paints. All give the same pixels and counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Engine {
    /// The kernel's scalar painter, which is the definition.
    Scalar,
    /// Vectors where they can, else the scalar painter.
    Vectors(Choice),
}

/// What draws unless something else is asked for.
fn best_engine() -> Engine {
    if has_vectors() {
        Engine::Vectors(Choice::Best)
    } else {
        Engine::Scalar
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

/// Wall-clock seconds of each part.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Times {
    /// Quantised splats to footprints.
    pub setup: f64,
    /// Depth order and tile lists.
    pub sort: f64,
    /// Footprints to pixels.
    pub raster: f64,
}

/// What a drawing gives.
#[derive(Clone, Debug)]
pub struct Drawing {
    /// The picture, converted to double precision without further rounding.
    pub picture: Picture,
    /// The kernel's pixels, row-major.
    pub pixels: Vec<Pixel>,
    /// Splats of the scene.
    pub splats: usize,
    /// Splats culled, by reason, in the order of [`Cull::ALL`].
    pub culled: [usize; Cull::ALL.len()],
    /// Splats of which a coordinate or colour is not finite.
    pub clamped: usize,
    /// Unit of the kernel's colours as a power of two; the picture has been multiplied by it.
    pub colour_log2: i32,
    /// Pixels visited and covered.
    pub coverage: Coverage,
    /// Time taken.
    pub times: Times,
}

/// Footprints of all splats, in the scene's order.
pub fn footprints(
    scene: &Scene,
    camera: &Camera,
    options: &Options,
) -> Vec<Result<Footprint, Cull>> {
    struct Job<'a>(&'a QuantisedScene, &'a kernel::Rules);
    impl DesignJob for Job<'_> {
        type Output = Vec<Result<Footprint, Cull>>;
        fn run<D: Design + Send + Sync>(self, design: D) -> Self::Output {
            set_up(design, self.0, self.1, best_engine())
        }
    }
    let quantised = QuantisedScene::new(scene, camera, options.rules);
    options
        .design
        .dispatch(Job(&quantised, &quantised.rules(options.rules)))
}

/// Conics (a, b, c) of all splats in double precision, whether or not they reach the viewport; `None` where the depth, the range or the shape
/// culls.
pub fn conics(
    scene: &Scene,
    camera: &Camera,
    rules: &Rules,
    design: &DesignChoice,
) -> Vec<Option<[f64; 3]>> {
    let widths = &design.widths;
    let conic_of = |variance: &Variance| {
        let conic = conic(widths, variance, scan(widths, variance)?.curvature)?;
        let unit = f64::from(conic.exponent).exp2();
        Some(conic.mantissa.map(|m| f64::from(m) * unit))
    };
    let variances = kernel_variances(scene, camera, rules, widths);
    variances
        .iter()
        .map(|variance| conic_of(variance.as_ref()?))
        .collect()
}

/// Vxx, Vxy, Vyy and the determinant of all splats in double precision, whether or not they reach the viewport; `None` where the depth or
/// the range culls.
pub fn variances(
    scene: &Scene,
    camera: &Camera,
    rules: &Rules,
    design: &DesignChoice,
) -> Vec<Option<[f64; 4]>> {
    let in_double = |variance: Variance| {
        let Variance {
            xx,
            xy,
            yy,
            determinant,
        } = variance;
        [xx, xy, yy, determinant].map(|x| f64::from(x.mantissa) * f64::from(x.exponent).exp2())
    };
    let variances = kernel_variances(scene, camera, rules, &design.widths);
    variances.into_iter().map(|v| v.map(in_double)).collect()
}

fn kernel_variances(
    scene: &Scene,
    camera: &Camera,
    rules: &Rules,
    widths: &Widths,
) -> Vec<Option<Variance>> {
    let quantised = QuantisedScene::new(scene, camera, rules);
    let rules = quantised.rules(rules);
    let variance_of = |splat: &VolumeSplat| {
        let projected = project(widths, &quantised.view, &rules, &splat.centre).ok()?;
        let mut columns = columns(widths, &quantised.view.rotation, &projected, &splat.axes);
        if let Some(factor) = distance::enlargement(widths, &rules, &projected) {
            columns = distance::enlarge(widths, columns, factor);
        }
        Some(variance(widths, rules.low_pass, &columns))
    };
    quantised.splats.iter().map(variance_of).collect()
}

/// Splats set up by one task.
const BATCH: usize = 1024;

fn set_up<D: Design + Send + Sync>(
    design: D,
    quantised: &QuantisedScene,
    rules: &kernel::Rules,
    engine: Engine,
) -> Vec<Result<Footprint, Cull>> {
    let QuantisedScene { view, splats, .. } = quantised;
    if let Engine::Vectors(choice) = engine {
        // Filled in parallel: most of its time is the first touch of its memory.
        let mut outcomes: Vec<_> = splats.par_iter().map(|_| Err(Cull::Near)).collect();
        outcomes
            .par_chunks_mut(BATCH)
            .zip(splats.par_chunks(BATCH))
            .for_each(|(outcomes, splats)| {
                fast::set_up(design, view, rules, splats, outcomes, choice);
            });
        return outcomes;
    }
    splats
        .par_iter()
        .map(|splat| setup(design, view, rules, splat))
        .collect()
}

/// Draws `scene` as `camera` sees it.
pub fn draw(scene: &Scene, camera: &Camera, options: &Options) -> Drawing {
    draw_with_footprints(scene, camera, options).0
}

/// The same, with what setup made of every splat, in the scene's order: a machine can be timed on it without a second setup.
pub fn draw_with_footprints(
    scene: &Scene,
    camera: &Camera,
    options: &Options,
) -> (Drawing, Vec<Result<Footprint, Cull>>) {
    let quantised = QuantisedScene::new(scene, camera, options.rules);
    draw_quantised(&quantised, camera, options, best_engine())
}

/// A scene that has been quantised already, by the engine asked for.
pub fn draw_quantised(
    quantised: &QuantisedScene,
    camera: &Camera,
    options: &Options,
    engine: Engine,
) -> (Drawing, Vec<Result<Footprint, Cull>>) {
    struct Job<'a>(&'a QuantisedScene, &'a Camera, &'a Options<'a>, Engine);
    impl DesignJob for Job<'_> {
        type Output = (Drawing, Vec<Result<Footprint, Cull>>);
        fn run<D: Design + Send + Sync>(self, design: D) -> Self::Output {
            draw_with(design, self.0, self.1, self.2, self.3)
        }
    }
    options
        .design
        .dispatch(Job(quantised, camera, options, engine))
}

fn draw_with<D: Design + Send + Sync>(
    design: D,
    quantised: &QuantisedScene,
    camera: &Camera,
    options: &Options,
    engine: Engine,
) -> (Drawing, Vec<Result<Footprint, Cull>>) {
    let rules = quantised.rules(options.rules);
    let started = Instant::now();
    let results = set_up(design, quantised, &rules, engine);
    let set_up_at = started.elapsed().as_secs_f64();
    let tiles = TileLists::by_depth(&results, options.compositing, quantised.view.viewport);
    let sorted_at = started.elapsed().as_secs_f64();
    let (pixels, coverage) = raster(design, &rules, &results, &tiles, options, engine);
    let times = Times {
        setup: set_up_at,
        sort: sorted_at - set_up_at,
        raster: started.elapsed().as_secs_f64() - sorted_at,
    };
    let picture = to_picture(&pixels, camera, &design.widths(), quantised.colour_log2);
    let (splats, clamped) = (quantised.splats.len(), quantised.clamped);
    let drawing = Drawing {
        picture,
        pixels,
        splats,
        culled: culls(&results),
        clamped,
        colour_log2: quantised.colour_log2,
        coverage,
        times,
    };
    (drawing, results)
}

/// How many results were culled, by reason, in the order of [`Cull::ALL`].
pub fn culls<T>(results: &[Result<T, Cull>]) -> [usize; Cull::ALL.len()] {
    let mut culled = [0; Cull::ALL.len()];
    for reason in results.iter().filter_map(|result| result.as_ref().err()) {
        culled[Cull::ALL.iter().position(|r| r == reason).unwrap_or(0)] += 1;
    }
    culled
}

fn raster<D: Design + Send + Sync>(
    design: D,
    rules: &kernel::Rules,
    results: &[Result<Footprint, Cull>],
    tiles: &TileLists,
    options: &Options,
    engine: Engine,
) -> (Vec<Pixel>, Coverage) {
    let widths = design.widths();
    let memory = table_entries(&widths, rules);
    let table = table(&memory, &widths, rules);
    let footprint = |index: u32| results[index as usize].as_ref().ok();
    let spans_in_order =
        options.compositing == Compositing::FrontToBack && options.traversal == Traversal::Spans;
    if let Engine::Vectors(choice) = engine
        && spans_in_order
        && let Some(painter) = tile_painter(design, rules, table, choice)
    {
        let (pixels, parts) = paint_frame(
            Pixel::clear(&widths),
            tiles,
            Scratch::default,
            |scratch, window, list, rows| painter.paint(scratch, window, results, list, rows),
        );
        return (pixels, total(parts));
    }
    let compositing = kernel_compositing(options.compositing);
    let painter = Painter::new(design, rules, table, compositing, options.traversal);
    paint_tiles(&widths, tiles, |list, target| {
        let mut coverage = Coverage::default();
        for part in list.chunks(CHECK_INTERVAL) {
            for footprint in part.iter().filter_map(|index| footprint(*index)) {
                coverage += painter.draw(footprint, target);
            }
            if target.is_finished() {
                break;
            }
        }
        coverage
    })
}
