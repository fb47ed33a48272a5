//! The engine `fixed` for surfaces: points quantised once, then gathered by the kernel, tile by tile, in the scene's order.
//!
//! ```text
//! quantise -> setup (kernel) -> tiles (kernel's painter) -> resolve (kernel) -> picture
//! ```
//!
//! There is no sorting: the accumulation buffer decides by depth and the layered buffer takes any order.

use super::frame::{TileLists, paint_apart, table, table_entries, to_picture, total};
use super::quantise::{axis, exp2, position, scale_log2, scaled, view};
use super::render::{Engine, best_engine};
use crate::camera::Camera;
use crate::design::{DesignChoice, DesignJob};
use crate::fast::setup::{self, SurfaceOutcome};
use crate::picture::Picture;
use crate::scene::points::{Material, SurfacePoint, SurfaceScene};
use crate::surface::{Buffer, Style};
use crate::vector;
use fixed::types::U4F28;
use rayon::prelude::*;
use splatline::blend::Pixel;
use splatline::blend::edge::EdgeFilter;
use splatline::blend::layers::Layers;
use splatline::blend::resolve::Resolve;
use splatline::blend::shading::{self, Shading};
use splatline::blend::surface::{Accumulation, Cell, WeightedSum};
use splatline::draw::Coverage;
use splatline::draw::surface::SurfacePainter;
use splatline::footprint::surface::SurfaceFootprint;
use splatline::format::{Design, Traversal};
use splatline::raster::Window;
use splatline::rules as kernel;
use splatline::setup::{Cull, setup_surface};
use splatline::splat::surface::SurfaceSplat;
use splatline::target::cells::CellTarget;
use splatline::view::View;
use std::time::Instant;

/// Columns and rows of a tile; any size gives the same picture.
const TILE: [u16; 2] = [64, 16];

/// Points in the kernel's formats.
#[derive(Clone, Debug)]
pub struct QuantisedPoints {
    /// The camera.
    pub view: View,
    /// The splats, in the scene's order.
    pub splats: Vec<SurfaceSplat>,
    /// Kernel scene units per scene unit, as a power of two.
    pub scale_log2: i32,
    /// Points of which a coordinate is not finite.
    pub clamped: usize,
}

impl QuantisedPoints {
    /// Quantises what both engines draw.
    pub fn new(scene: &SurfaceScene, camera: &Camera) -> Self {
        let scale_log2 = scale_log2(scene.points.iter().map(|point| point.centre), camera);
        let beyond = |p: &&SurfacePoint| p.centre.iter().any(|c| !c.is_finite());
        QuantisedPoints {
            view: view(camera, scale_log2),
            splats: scene
                .points
                .par_iter()
                .map(|p| splat(p, scale_log2))
                .collect(),
            scale_log2,
            clamped: scene.points.par_iter().filter(beyond).count(),
        }
    }
}

fn splat(point: &SurfacePoint, scale_log2: i32) -> SurfaceSplat {
    SurfaceSplat {
        centre: position(point.centre, scale_log2),
        frame: point.frame.map(|tangent| axis(tangent, scale_log2)),
        normal: axis(point.normal, 0),
        weight: scaled(point.weight),
        colour: point.colour.map(U4F28::saturating_from_num),
        opacity: U4F28::saturating_from_num(point.opacity),
        material: point.material,
    }
}

/// What a drawing gives.
#[derive(Clone, Debug)]
pub struct SurfaceDrawing {
    /// The picture, converted to double precision without further rounding.
    pub picture: Picture,
    /// The kernel's pixels, row-major.
    pub pixels: Vec<Pixel>,
    /// Weight sums of all fragments of each pixel, in units of 1.0.
    pub weights: Vec<f64>,
    /// Points culled, by reason, in the order of [`Cull::ALL`].
    pub culled: [usize; Cull::ALL.len()],
    /// Points left out because they show their back.
    pub backfaces: usize,
    /// Points of which a coordinate was clamped to its format.
    pub clamped: usize,
    /// Pixels visited and covered.
    pub coverage: Coverage,
    /// Pixels at which fragments had to be merged.
    pub merged: usize,
    /// Seconds for setup, and for everything after it.
    pub times: [f64; 2],
}

/// Footprints of all points, in the scene's order.
pub fn footprints(
    points: &QuantisedPoints,
    style: &Style,
    design: &DesignChoice,
) -> Vec<Result<SurfaceFootprint, Cull>> {
    struct FootprintsJob<'a>(&'a QuantisedPoints, kernel::Rules);
    impl DesignJob for FootprintsJob<'_> {
        type Output = Vec<Result<SurfaceFootprint, Cull>>;
        fn run<D: Design + Send + Sync>(self, design: D) -> Self::Output {
            let FootprintsJob(points, rules) = self;
            let set_up = |splat| setup_surface(design, &points.view, &rules, splat);
            points.splats.par_iter().map(set_up).collect()
        }
    }
    design.dispatch(FootprintsJob(points, kernel_rules(style)))
}

/// Points set up by one task: their footprints fit the second-level cache.
const BATCH: usize = 1024;

/// What setup makes of some points.
#[derive(Default)]
struct SetUp {
    drawn: Vec<SurfaceFootprint>,
    culled: [usize; Cull::ALL.len()],
    backfaces: usize,
}

impl SetUp {
    fn of(outcomes: &[SurfaceOutcome], cull_backfaces: bool) -> Self {
        let mut all = SetUp::default();
        all.drawn.reserve_exact(outcomes.len());
        for outcome in outcomes {
            match outcome {
                Ok(footprint) if cull_backfaces && footprint.back => all.backfaces += 1,
                Ok(footprint) => all.drawn.push(*footprint),
                Err(reason) => all.culled[reason.place()] += 1,
            }
        }
        all
    }

    fn join(parts: &[SetUp]) -> Self {
        let mut all = SetUp::default();
        all.drawn
            .reserve_exact(parts.iter().map(|part| part.drawn.len()).sum());
        for part in parts {
            all.drawn.extend_from_slice(&part.drawn);
            all.backfaces += part.backfaces;
            let culled = all.culled.iter_mut().zip(part.culled);
            culled.for_each(|(sum, part)| *sum += part);
        }
        all
    }
}

/// Setup of all points, batch by batch, so that the many that are not drawn leave nothing in memory.
fn set_up(points: &QuantisedPoints, style: &Style, design: &DesignChoice, engine: Engine) -> SetUp {
    struct SurfaceSetup<'a>(&'a QuantisedPoints, kernel::Rules, bool, Engine);
    impl DesignJob for SurfaceSetup<'_> {
        type Output = SetUp;
        fn run<D: Design + Send + Sync>(self, design: D) -> SetUp {
            let SurfaceSetup(QuantisedPoints { view, splats, .. }, rules, cull_backfaces, engine) =
                self;
            let batch = |splats: &[SurfaceSplat]| {
                let mut outcomes = [const { Err(Cull::Near) }; BATCH];
                let outcomes = &mut outcomes[..splats.len()];
                match engine {
                    Engine::Vectors(choice) => {
                        setup::set_up(design, view, &rules, splats, outcomes, choice);
                    }
                    Engine::Scalar => {
                        for (splat, outcome) in splats.iter().zip(&mut *outcomes) {
                            *outcome = setup_surface(design, view, &rules, splat);
                        }
                    }
                }
                SetUp::of(outcomes, cull_backfaces)
            };
            let parts: Vec<SetUp> = splats.par_chunks(BATCH).map(batch).collect();
            SetUp::join(&parts)
        }
    }
    let cull_backfaces = style.cull_backfaces;
    design.dispatch(SurfaceSetup(
        points,
        kernel_rules(style),
        cull_backfaces,
        engine,
    ))
}

/// The rules of surfaces with the style's filter and cut-off.
pub fn kernel_rules(style: &Style) -> kernel::Rules {
    let cutoff = (style.cutoff * exp2(28))
        .round()
        .clamp(0.0, 15.0 * exp2(28));
    kernel::Rules {
        low_pass: scaled(style.low_pass),
        cutoff: kernel::Cutoff::Radial(cutoff as u32),
        table_range: if style.cutoff <= 4.0 { 2 } else { 4 },
        ..kernel::Rules::SURFACE
    }
}

/// Draws `scene` as `camera` sees it. A number of layers that [`crate::surface::LAYERS`] lacks counts as the next larger one.
pub fn draw(
    scene: &SurfaceScene,
    camera: &Camera,
    style: &Style,
    design: &DesignChoice,
    traversal: Traversal,
) -> SurfaceDrawing {
    let points = QuantisedPoints::new(scene, camera);
    let options = SurfaceOptions {
        style,
        design,
        traversal,
        engine: best_engine(),
    };
    draw_quantised(&points, scene, camera, &options)
}

/// How a surface is drawn.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceOptions<'a> {
    /// Filter, buffer and light.
    pub style: &'a Style,
    /// Widths.
    pub design: &'a DesignChoice,
    /// Order of the pixels.
    pub traversal: Traversal,
    /// Which implementation sets up; all give the same bits.
    pub engine: Engine,
}

/// Draws points of `scene` that have been quantised for `camera`.
pub fn draw_quantised(
    points: &QuantisedPoints,
    scene: &SurfaceScene,
    camera: &Camera,
    options: &SurfaceOptions,
) -> SurfaceDrawing {
    let SurfaceOptions {
        style,
        design,
        traversal,
        engine,
    } = *options;
    let started = Instant::now();
    let SetUp {
        drawn,
        culled,
        backfaces,
    } = set_up(points, style, design, engine);
    let setup_time = started.elapsed().as_secs_f64();
    let frame = SurfaceFrame {
        view: &points.view,
        footprints: &drawn,
        materials: scene.materials.iter().map(material).collect(),
        light: style.light.map(|light| direction(camera, light)),
        edges: style
            .edge
            .and_then(|tau| EdgeFilter::new((tau * exp2(30)) as u32)),
        threshold: (style.threshold * exp2(points.scale_log2 + 23)).round() as u32,
        rules: kernel_rules(style),
        traversal,
    };
    let raster = match style.buffer {
        Buffer::Accumulation => design.dispatch(GatherJob::<Accumulation>::new(&frame)),
        Buffer::Layers(0 | 1) => design.dispatch(GatherJob::<Layers<1>>::new(&frame)),
        Buffer::Layers(2) => design.dispatch(GatherJob::<Layers<2>>::new(&frame)),
        Buffer::Layers(3) => design.dispatch(GatherJob::<Layers<3>>::new(&frame)),
        Buffer::Layers(4) => design.dispatch(GatherJob::<Layers<4>>::new(&frame)),
        Buffer::Layers(_) => design.dispatch(GatherJob::<Layers<8>>::new(&frame)),
    };
    SurfaceDrawing {
        picture: to_picture(&raster.pixels, camera, &design.widths, 0),
        pixels: raster.pixels,
        weights: raster.weights,
        culled,
        backfaces,
        clamped: points.clamped,
        coverage: raster.coverage,
        merged: raster.merged,
        times: [setup_time, started.elapsed().as_secs_f64() - setup_time],
    }
}

/// A material in the kernel's UQ5.27.
fn material(material: &Material) -> shading::Material {
    let unit = exp2(shading::COEFFICIENT as i32);
    let coefficient = |value: f64| (value * unit).round().clamp(0.0, u32::MAX.into()) as u32;
    shading::Material {
        ambient: coefficient(material.ambient),
        diffuse: coefficient(material.diffuse),
        specular: coefficient(material.specular),
        exponent: material.exponent,
    }
}

/// A direction of the scene as a unit vector in camera space, Q1.30.
fn direction(camera: &Camera, world: vector::Vector) -> shading::Direction {
    let turned = vector::transform(&camera.rotation, world);
    let length = vector::length(turned);
    turned.map(|part| (part / length * exp2(30)).round() as i32)
}

/// What all tiles of a picture share.
struct SurfaceFrame<'a> {
    view: &'a View,
    footprints: &'a [SurfaceFootprint],
    materials: Vec<shading::Material>,
    light: Option<shading::Direction>,
    edges: Option<EdgeFilter>,
    threshold: u32,
    rules: kernel::Rules,
    traversal: Traversal,
}

/// What gathering and resolving give.
struct SurfaceRaster {
    pixels: Vec<Pixel>,
    weights: Vec<f64>,
    coverage: Coverage,
    merged: usize,
}

/// A cell type that tells whether its fragments had to be merged.
trait HostCell: Cell + Send {
    fn merged(&self) -> bool {
        false
    }
}

impl HostCell for Accumulation {}

impl<const L: usize> HostCell for Layers<L> {
    fn merged(&self) -> bool {
        self.merges() > 0
    }
}

struct GatherJob<'a, C> {
    frame: &'a SurfaceFrame<'a>,
    cell: std::marker::PhantomData<C>,
}

impl<'a, C> GatherJob<'a, C> {
    fn new(frame: &'a SurfaceFrame<'a>) -> Self {
        GatherJob {
            frame,
            cell: std::marker::PhantomData,
        }
    }
}

impl<C: HostCell> DesignJob for GatherJob<'_, C> {
    type Output = SurfaceRaster;

    fn run<D: Design + Send + Sync>(self, design: D) -> SurfaceRaster {
        let frame = self.frame;
        let widths = design.widths();
        let memory = table_entries(&widths, &frame.rules);
        let table = table(&memory, &widths, &frame.rules);
        let gather = WeightedSum::new(&widths, frame.threshold);
        let painter = SurfacePainter::new(design, &frame.rules, table, gather, frame.traversal);
        let shading = frame
            .light
            .map(|light| Shading::new(&widths, &frame.materials, light, frame.view));
        let resolve = Resolve::new(&widths, gather, shading, frame.edges);
        let unit = exp2(i32::from(splatline::blend::surface::sum_fraction(&widths)));
        let footprints = frame.footprints.iter().map(|surface| &surface.footprint);
        let tiles = TileLists::in_order(footprints, frame.view.viewport, TILE);
        let paint = |window: Window, list: &[u32], resolved: &mut [(Pixel, f64)]| {
            let columns = usize::from(window.end[0] - window.first[0]);
            let mut cells = vec![C::EMPTY; resolved.len()];
            let mut coverage = Coverage::default();
            let Ok(mut target) = CellTarget::new(&mut cells, window) else {
                unreachable!("the tile's memory has just been made for its window")
            };
            for index in list {
                coverage += painter.draw(&frame.footprints[*index as usize], &mut target);
            }
            for (index, (cell, resolved)) in cells.iter().zip(resolved).enumerate() {
                let (x, y) = ((index % columns) as u16, (index / columns) as u16);
                let pixel = resolve.pixel(cell, window.first[0] + x, window.first[1] + y);
                let weights = cell.fragments().iter().map(|f| f64::from(f.weight));
                *resolved = (pixel, weights.sum::<f64>() / unit);
            }
            let merged = cells.iter().filter(|cell| cell.merged()).count();
            (coverage, merged)
        };
        let (resolved, parts) = paint_apart((Pixel::default(), 0.0), &tiles, paint);
        let (pixels, weights) = resolved.into_iter().unzip();
        let (coverage, merged): (Vec<_>, Vec<usize>) = parts.into_iter().unzip();
        SurfaceRaster {
            pixels,
            weights,
            coverage: total(coverage),
            merged: merged.iter().sum(),
        }
    }
}
