//! A surface's frames, one after the other in the same memory.
//!
//! ```text
//! parts of the points: setup, bounds -> tile lists in the scene's order
//!     -> tiles, each in a place of its own -> picture
//! ```

use super::tiles::{GatherTiles, Resolved, SurfaceScratch, SurfaceTiles, TileConstants};
use super::{QuantisedPoints, SurfaceOptions, direction, kernel_rules, material, threshold};
use crate::camera::Camera;
use crate::fast::frame::{AREA, CullCounts, add_counts, copy_tiles, note};
use crate::fast::order::{Grid, TileOrder};
use crate::fast::setup::{self, SurfaceOutcome};
use crate::fast::surface::{GatherNumbers, SurfaceTile};
use crate::fast::{TILE, TableMemory};
use crate::fixed::frame::converter;
use crate::fixed::quantise::exp2;
use crate::fixed::render::PaintEngine;
use crate::picture::Picture;
use crate::scene::points::SurfaceScene;
use crate::surface::Buffer;
use rayon::prelude::*;
use splatline::blend::Pixel;
use splatline::blend::edge::EdgeFilter;
use splatline::blend::layers::Layers;
use splatline::blend::resolve::Resolve;
use splatline::blend::shading::{self, Shading};
use splatline::blend::surface::{Accumulation, WeightedSum, sum_fraction};
use splatline::draw::Coverage;
use splatline::draw::surface::SurfacePainter;
use splatline::format::Traversal;
use splatline::raster::Window;
use splatline::setup::Cull;
use std::cell::RefCell;
use std::time::Instant;

thread_local! {
    /// A thread's memory for the tile that it paints, kept from frame to frame.
    static SCRATCH: RefCell<SurfaceScratch> = RefCell::default();
}

/// What a frame did beside its pixels.
#[derive(Clone, Copy, Debug, Default)]
pub struct SurfaceFacts {
    /// Points culled, by reason, in the order of [`Cull::ALL`].
    pub culled: CullCounts,
    /// Points left out because they show their back.
    pub backfaces: usize,
    /// Pixels visited and covered.
    pub coverage: Coverage,
    /// Pixels at which fragments had to be merged.
    pub merged: usize,
    /// Seconds for setup, for lists, and for everything after them.
    pub times: [f64; 3],
}

impl SurfaceFacts {
    fn add(mut self, other: SurfaceFacts) -> Self {
        self.culled = add_counts(self.culled, other.culled);
        self.backfaces += other.backfaces;
        self.coverage += other.coverage;
        self.merged += other.merged;
        self
    }
}

/// A surface with all that its frames need.
pub struct SurfaceRenderer<'a> {
    points: QuantisedPoints,
    camera: &'a Camera,
    options: SurfaceOptions<'a>,
    table: TableMemory,
    threshold: u32,
    /// What vectors gather by, if they can.
    numbers: Option<GatherNumbers>,
    materials: Vec<shading::Material>,
    outcomes: Vec<SurfaceOutcome>,
    order: TileOrder,
    /// Tile after tile, each row by row.
    resolved: Vec<Resolved>,
}

impl<'a> SurfaceRenderer<'a> {
    /// The scene in the kernel's formats. Frames are drawn by the rayon pool that they are asked for in.
    pub fn new(scene: &SurfaceScene, camera: &'a Camera, options: &SurfaceOptions<'a>) -> Self {
        let SurfaceOptions { style, design, .. } = *options;
        let points = QuantisedPoints::new(scene, camera);
        let table = TableMemory::new(&design.widths, &kernel_rules(style));
        let threshold = threshold(style, &points);
        let numbers = match (options.engine, options.traversal) {
            (PaintEngine::Vectors(_), Traversal::Spans) => {
                GatherNumbers::new(&table, threshold, design.lane_bits())
            }
            _ => None,
        };
        SurfaceRenderer {
            points,
            camera,
            options: *options,
            table,
            threshold,
            numbers,
            materials: scene.materials.iter().map(material).collect(),
            outcomes: Vec::new(),
            order: TileOrder::default(),
            resolved: Vec::new(),
        }
    }

    /// Draws a frame as a picture in double precision, converted without further rounding; one of another size is
    /// replaced.
    pub fn draw_picture(&mut self, picture: &mut Picture) -> SurfaceFacts {
        let started = Instant::now();
        let facts = self.draw();
        let Camera { width, height, .. } = *self.camera;
        if [picture.width, picture.height] != [width, height] {
            *picture = Picture::new(width, height);
        }
        let convert = converter(&self.options.design.widths, 0);
        self.copy(&mut picture.pixels, |pixel, _| convert(pixel));
        let [setup, lists, _] = facts.times;
        let rest = started.elapsed().as_secs_f64() - setup - lists;
        SurfaceFacts {
            times: [setup, lists, rest],
            ..facts
        }
    }

    /// The last frame's pixels, row by row, as the caller wants them; `convert` is given a pixel and its weight sums,
    /// in units of 1.0.
    pub(super) fn copy<T: Send>(&self, frame: &mut [T], convert: impl Fn(&Pixel, f64) -> T + Sync) {
        let unit = exp2(-i32::from(sum_fraction(&self.options.design.widths)));
        let of_pixel =
            |Resolved { pixel, weight }: &Resolved| convert(pixel, *weight as f64 * unit);
        copy_tiles(&self.resolved, self.points.view.viewport, frame, of_pixel);
    }

    /// Points of which a coordinate was clamped to its format.
    pub fn clamped(&self) -> usize {
        self.points.clamped
    }

    fn draw(&mut self) -> SurfaceFacts {
        let started = Instant::now();
        let grid = Grid::new(self.points.view.viewport, TILE);
        let set_up = self.set_up();
        let set_up_at = started.elapsed().as_secs_f64();
        self.order.sort(&grid);
        let sorted_at = started.elapsed().as_secs_f64();
        let painted = self.paint(&grid);
        let rest = started.elapsed().as_secs_f64() - sorted_at;
        SurfaceFacts {
            times: [set_up_at, sorted_at - set_up_at, rest],
            ..set_up.add(painted)
        }
    }

    fn set_up(&mut self) -> SurfaceFacts {
        let (QuantisedPoints { view, splats, .. }, options) = (&self.points, &self.options);
        let (design, vectors) = (options.design.in_fields(), options.engine.vectors());
        let rules = &self.table.rules;
        if self.outcomes.len() != splats.len() {
            // In parallel: most of its time is the first touch of its memory.
            self.outcomes = splats.par_iter().map(|_| Err(Cull::Near)).collect();
        }
        self.order.fill(
            splats,
            &mut self.outcomes,
            &|work| work(),
            &|splats, outcomes, first, keys| {
                setup::set_up(design, view, rules, splats, outcomes, vectors);
                let mut backfaces = 0;
                // In the scene's order: for the sort all are equally near.
                let culled = note(outcomes, first, keys, |surface| {
                    let is_left_out = options.style.cull_backfaces && surface.back;
                    backfaces += usize::from(is_left_out);
                    (!is_left_out).then(|| (0, Window::of(&surface.footprint)))
                });
                SurfaceFacts {
                    culled,
                    backfaces,
                    ..SurfaceFacts::default()
                }
            },
            SurfaceFacts::add,
        )
    }

    /// Every tile into cells of the style's kind.
    fn paint(&mut self, grid: &Grid) -> SurfaceFacts {
        let (options, widths) = (&self.options, &self.options.design.widths);
        let gather = WeightedSum::new(widths, self.threshold);
        let shading = options.style.light.map(|light| {
            let light = direction(self.camera, light);
            Shading::new(widths, &self.materials, light, &self.points.view)
        });
        let edge = options.style.edge;
        let edges = edge.and_then(|tau| EdgeFilter::new((tau * exp2(30)) as u32));
        let constants = TileConstants {
            gather,
            resolve: Resolve::new(widths, gather, shading, edges),
            numbers: self.numbers.as_ref().zip(options.engine.vectors()),
            counts: options.counts,
        };
        let (design, table) = (options.design.in_fields(), &self.table);
        let (rules, traversal) = (&table.rules, options.traversal);
        let painter = SurfacePainter::new(design, rules, table.table(), gather, traversal);
        let (outcomes, order, resolved) = (&self.outcomes, &self.order, &mut self.resolved);
        let mut frame =
            |tiles: &dyn SurfaceTiles| paint_tiles(grid, tiles, outcomes, order, resolved);
        match options.style.buffer {
            Buffer::Accumulation => frame(&GatherTiles::<Accumulation>::new(painter, &constants)),
            Buffer::Layers(0 | 1) => frame(&GatherTiles::<Layers<1>>::new(painter, &constants)),
            Buffer::Layers(2) => frame(&GatherTiles::<Layers<2>>::new(painter, &constants)),
            Buffer::Layers(3) => frame(&GatherTiles::<Layers<3>>::new(painter, &constants)),
            Buffer::Layers(4) => frame(&GatherTiles::<Layers<4>>::new(painter, &constants)),
            Buffer::Layers(_) => frame(&GatherTiles::<Layers<8>>::new(painter, &constants)),
        }
    }
}

/// Every tile on some core. Not inlined, so that a profiler can tell it from the rest.
#[inline(never)]
fn paint_tiles(
    grid: &Grid,
    tiles: &dyn SurfaceTiles,
    outcomes: &[SurfaceOutcome],
    order: &TileOrder,
    resolved: &mut Vec<Resolved>,
) -> SurfaceFacts {
    resolved.resize(grid.len() * AREA, Resolved::default());
    // One by one: a thread that has drawn its own empty ones takes over from another's full ones.
    let places = resolved.par_chunks_mut(AREA).enumerate().with_max_len(1);
    let painted = places.map(|(tile, resolved)| {
        let window = grid.window(tile);
        let resolved = &mut resolved[..window.pixels()];
        let tile = SurfaceTile {
            window,
            footprints: outcomes,
            list: order.list(tile),
        };
        let (coverage, merged) =
            SCRATCH.with_borrow_mut(|scratch| tiles.paint(scratch, tile, resolved));
        SurfaceFacts {
            coverage,
            merged,
            ..SurfaceFacts::default()
        }
    });
    painted.reduce(SurfaceFacts::default, SurfaceFacts::add)
}
