//! Drawing a quantised scene: setup of every splat, depth order, tiles on all cores.

use super::quantise::{QuantisedScene, kernel_compositing};
use crate::camera::Camera;
use crate::design::{DesignChoice, DesignJob};
use crate::picture::Picture;
use crate::rules::{Compositing, Rules};
use crate::scene::Scene;
use rayon::prelude::*;
use splatline::blend::Pixel;
use splatline::draw::{Coverage, Painter};
use splatline::footprint::Footprint;
use splatline::format::{Design, Traversal, Widths};
use splatline::kernel::{FootprintTable, entries, fill};
use splatline::raster::Window;
use splatline::rules as kernel;
use splatline::setup::{Cull, Variance, columns, conic, distance, project, scan, setup, variance};
use splatline::splat::VolumeSplat;
use splatline::target::Target;
use std::time::Instant;

/// Columns and rows of a tile. Any size gives the same picture; this one keeps a tile's pixels in the first-level cache.
const TILE: [u16; 2] = [64, 16];

/// Splats drawn into a tile between two checks whether all its pixels have finished.
pub(super) const CHECK_INTERVAL: usize = 64;

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
    /// Splats of which a coordinate or colour was clamped to its format.
    pub clamped: usize,
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
            set_up(design, self.0, self.1)
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
        let projected = project(widths, &quantised.view, &rules, splat.centre).ok()?;
        let mut columns = columns(widths, &quantised.view, &projected, &splat.axes);
        if let Some(factor) = distance::enlargement(widths, &rules, &projected) {
            columns = distance::enlarge(widths, columns, factor);
        }
        Some(variance(widths, rules.low_pass, &columns))
    };
    quantised.splats.iter().map(variance_of).collect()
}

fn set_up<D: Design + Send + Sync>(
    design: D,
    quantised: &QuantisedScene,
    rules: &kernel::Rules,
) -> Vec<Result<Footprint, Cull>> {
    quantised
        .splats
        .par_iter()
        .map(|splat| setup(design, &quantised.view, rules, splat))
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
    struct Job<'a>(&'a QuantisedScene, &'a Camera, &'a Options<'a>);
    impl DesignJob for Job<'_> {
        type Output = (Drawing, Vec<Result<Footprint, Cull>>);
        fn run<D: Design + Send + Sync>(self, design: D) -> Self::Output {
            draw_with(design, self.0, self.1, self.2)
        }
    }
    let quantised = QuantisedScene::new(scene, camera, options.rules);
    options.design.dispatch(Job(&quantised, camera, options))
}

fn draw_with<D: Design + Send + Sync>(
    design: D,
    quantised: &QuantisedScene,
    camera: &Camera,
    options: &Options,
) -> (Drawing, Vec<Result<Footprint, Cull>>) {
    let rules = quantised.rules(options.rules);
    let started = Instant::now();
    let results = set_up(design, quantised, &rules);
    let mut culled = [0; Cull::ALL.len()];
    let mut footprints = Vec::with_capacity(results.len());
    for result in &results {
        match result {
            Ok(footprint) => footprints.push(*footprint),
            Err(reason) => culled[Cull::ALL.iter().position(|r| r == reason).unwrap_or(0)] += 1,
        }
    }
    let set_up_at = started.elapsed().as_secs_f64();
    let order = depth_order(&footprints, options.compositing);
    let tiles = TileLists::new(&footprints, &order, quantised.view.viewport);
    let sorted_at = started.elapsed().as_secs_f64();
    let (pixels, coverage) = raster(design, &rules, &footprints, &tiles, options);
    let times = Times {
        setup: set_up_at,
        sort: sorted_at - set_up_at,
        raster: started.elapsed().as_secs_f64() - sorted_at,
    };
    let picture = to_picture(&pixels, camera, &design.widths());
    let (splats, clamped) = (quantised.splats.len(), quantised.clamped);
    let drawing = Drawing {
        picture,
        pixels,
        splats,
        culled,
        clamped,
        coverage,
        times,
    };
    (drawing, results)
}

/// Indices of the footprints by depth, nearest first (farthest first for back to front), ties by index.
pub(super) fn depth_order(footprints: &[Footprint], compositing: Compositing) -> Vec<u32> {
    let mut order: Vec<u32> = (0..footprints.len() as u32).collect();
    order.par_sort_by_key(|index| footprints[*index as usize].depth);
    if compositing == Compositing::BackToFront {
        order.reverse();
    }
    order
}

/// For every tile the footprints whose box touches it, in drawing order.
pub(super) struct TileLists {
    viewport: [u16; 2],
    columns: usize,
    lists: Vec<Vec<u32>>,
}

impl TileLists {
    pub(super) fn new(footprints: &[Footprint], order: &[u32], viewport: [u16; 2]) -> Self {
        let [columns, rows] = [0, 1].map(|axis| usize::from(viewport[axis].div_ceil(TILE[axis])));
        let mut lists = vec![Vec::new(); columns * rows];
        for index in order {
            let footprint = &footprints[*index as usize];
            let tile = |pixel: u16, axis: usize| usize::from(pixel / TILE[axis]);
            for y in tile(footprint.first[1], 1)..=tile(footprint.last[1] - 1, 1) {
                for x in tile(footprint.first[0], 0)..=tile(footprint.last[0] - 1, 0) {
                    lists[y * columns + x].push(*index);
                }
            }
        }
        TileLists {
            viewport,
            columns,
            lists,
        }
    }

    fn window(&self, tile: usize) -> Window {
        let first = [
            (tile % self.columns) as u16 * TILE[0],
            (tile / self.columns) as u16 * TILE[1],
        ];
        let last = [0, 1].map(|axis| (first[axis] + TILE[axis]).min(self.viewport[axis]));
        Window { first, last }
    }
}

fn raster<D: Design + Send + Sync>(
    design: D,
    rules: &kernel::Rules,
    footprints: &[Footprint],
    tiles: &TileLists,
    options: &Options,
) -> (Vec<Pixel>, Coverage) {
    let widths = design.widths();
    let memory = table_entries(&widths, rules);
    let table = table(&memory, &widths, rules);
    let painter = Painter::new(
        design,
        rules,
        table,
        kernel_compositing(options.compositing),
        options.traversal,
    );
    paint_tiles(&widths, tiles, |list, target| {
        let mut coverage = Coverage::default();
        for part in list.chunks(CHECK_INTERVAL) {
            for index in part {
                coverage += painter.draw(&footprints[*index as usize], target);
            }
            if target.is_finished() {
                break;
            }
        }
        coverage
    })
}

/// The footprint table's entries for the rules' kernel.
pub(crate) fn table_entries(widths: &Widths, rules: &kernel::Rules) -> Vec<u32> {
    let mut memory = vec![0; entries(widths)];
    fill(&mut memory, widths, rules.table_range, rules.kernel);
    memory
}

/// The table over [`table_entries`].
pub(crate) fn table<'a>(
    memory: &'a [u32],
    widths: &Widths,
    rules: &kernel::Rules,
) -> FootprintTable<'a> {
    match FootprintTable::new(memory, widths, rules.table_range) {
        Ok(table) => table,
        Err(_) => unreachable!("the entries have been made for these widths"),
    }
}

/// Paints every tile by `paint`, which is given the tile's footprints in drawing order, and joins the tiles.
pub(super) fn paint_tiles(
    widths: &Widths,
    tiles: &TileLists,
    paint: impl Fn(&[u32], &mut Target) -> Coverage + Sync,
) -> (Vec<Pixel>, Coverage) {
    let parts: Vec<(Vec<Pixel>, Coverage)> = (0..tiles.lists.len())
        .into_par_iter()
        .map(|tile| paint_tile(widths, &tiles.lists[tile], tiles.window(tile), &paint))
        .collect();
    let [width, height] = tiles.viewport.map(usize::from);
    let mut frame = vec![Pixel::clear(widths); width * height];
    let mut coverage = Coverage::default();
    for (tile, (pixels, part)) in parts.iter().enumerate() {
        coverage += *part;
        let window = tiles.window(tile);
        let columns = usize::from(window.last[0] - window.first[0]);
        for (row, y) in pixels
            .chunks_exact(columns)
            .zip(usize::from(window.first[1])..)
        {
            let start = y * width + usize::from(window.first[0]);
            frame[start..start + columns].copy_from_slice(row);
        }
    }
    (frame, coverage)
}

fn paint_tile(
    widths: &Widths,
    list: &[u32],
    window: Window,
    paint: impl Fn(&[u32], &mut Target) -> Coverage,
) -> (Vec<Pixel>, Coverage) {
    let columns = usize::from(window.last[0] - window.first[0]);
    let rows = usize::from(window.last[1] - window.first[1]);
    let mut pixels = vec![Pixel::clear(widths); columns * rows];
    let Ok(mut target) = Target::new(&mut pixels, window, columns) else {
        unreachable!("the tile's memory has just been made for its window")
    };
    let coverage = paint(list, &mut target);
    (pixels, coverage)
}

/// Colour and 1 - T in units of 1.0.
pub(super) fn to_picture(pixels: &[Pixel], camera: &Camera, widths: &Widths) -> Picture {
    let colour_unit = f64::from(widths.accumulator).exp2();
    let opaque = f64::from(widths.transmittance).exp2();
    let mut picture = Picture::new(camera.width, camera.height);
    for (out, pixel) in picture.pixels.iter_mut().zip(pixels) {
        let [r, g, b] = pixel.colour.map(|c| f64::from(c) / colour_unit);
        *out = [r, g, b, 1.0 - f64::from(pixel.clear_share()) / opaque];
    }
    picture
}
