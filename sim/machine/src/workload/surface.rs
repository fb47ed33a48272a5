//! A workload of surfaces from the kernel: its rows, and what its pixels did with the samples that they were given.
//!
//! Nothing is sorted and no pixel finishes: every tile takes its splats in the scene's order, and pixels decide by
//! depth. Each sample is counted as it is added to the kernel's own cell.

use super::{Bins, TilePart, Workload, assemble, each_tile, room_for};
use crate::area::surface::SurfaceBits;
use crate::design::DesignChoice;
use crate::fixed::surface::{HostCell, QuantisedPoints, footprints, kernel_rules, threshold};
use crate::fixed::{TableMemory, whole};
use crate::host_memory::TooLarge;
use crate::surface::{Buffer, Style};
use serde::Serialize;
use splatline::blend::Pixel;
use splatline::blend::layers::Layers;
use splatline::blend::surface::{Accumulation, Cell, Fragment, Sample, WeightedSum};
use splatline::draw::surface::SurfacePainter;
use splatline::footprint::Footprint;
use splatline::footprint::packet::Layout;
use splatline::footprint::surface::SurfaceFootprint;
use splatline::format::{Design, RuntimeWidths, Traversal};
use splatline::raster::Window;
use splatline::setup::Cull;
use splatline::target::cells::CellTarget;
use std::ops::AddAssign;

/// What a surface unit does for a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct SurfaceCounts {
    /// Samples: covered pixels, once per splat, of which the weight is not 0.
    pub samples: u64,
    /// Of these, samples that began a fragment, in an empty place or in place of one that lay behind.
    pub begun: u64,
    /// Samples that were accumulated into a fragment.
    pub accumulated: u64,
    /// Samples that lay behind, or found their fragment full.
    pub discarded: u64,
    /// Pairs of fragments that were merged for want of room.
    pub merges: u64,
    /// Fragments that were left, each of which is normalised.
    pub fragments: u64,
    /// Pixels that have one.
    pub pixels: u64,
}

/// A surface unit's work, and the fragments that it normalises of each tile: those that are left and two for each
/// merge.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SurfaceWork {
    /// Sums over the picture.
    pub counts: SurfaceCounts,
    /// Tile by tile.
    pub resolved: Vec<u32>,
}

impl AddAssign for SurfaceCounts {
    fn add_assign(&mut self, other: SurfaceCounts) {
        self.samples += other.samples;
        self.begun += other.begun;
        self.accumulated += other.accumulated;
        self.discarded += other.discarded;
        self.merges += other.merges;
        self.fragments += other.fragments;
        self.pixels += other.pixels;
    }
}

/// Fragments of a pixel that a style needs room for.
pub fn layers_of(style: &Style) -> u32 {
    match style.buffer {
        Buffer::Accumulation | Buffer::Layers(0 | 1) => 1,
        Buffer::Layers(layers @ 2..=4) => layers as u32,
        Buffer::Layers(_) => 8,
    }
}

/// The work of drawing points in tiles of `tile` columns (at most 64) and rows, unless it does not fit into memory.
pub fn extract_surface(
    points: &QuantisedPoints,
    style: &Style,
    design: &DesignChoice,
    traversal: Traversal,
    tile: [u16; 2],
) -> Result<Workload, TooLarge> {
    let viewport = points.view.viewport;
    let found = footprints(points, style, design);
    let seen = |found: &SurfaceFootprint| !(style.cull_backfaces && found.back);
    let shape = |found: &Result<SurfaceFootprint, Cull>| match found {
        Ok(found) if seen(found) => Ok(found.footprint),
        Ok(_) => Err(Cull::Transparent),
        Err(reason) => Err(*reason),
    };
    let shapes: Vec<Result<Footprint, Cull>> = found.iter().map(shape).collect();
    room_for(&shapes, viewport.map(usize::from), tile)?;
    let boxes = (0..).zip(&shapes).filter_map(|(index, shape)| {
        let bounds = Window::of(shape.as_ref().ok()?);
        (!bounds.is_empty()).then_some((index, bounds))
    });
    let job = SurfaceJob {
        bins: Bins::new(boxes, viewport, tile),
        found: &found,
        style,
        threshold: threshold(style, points),
        traversal,
        design: design.in_fields(),
    };
    Ok(match style.buffer {
        Buffer::Accumulation => job.gather::<Accumulation>(),
        Buffer::Layers(0 | 1) => job.gather::<Layers<1>>(),
        Buffer::Layers(2) => job.gather::<Layers<2>>(),
        Buffer::Layers(3) => job.gather::<Layers<3>>(),
        Buffer::Layers(4) => job.gather::<Layers<4>>(),
        Buffer::Layers(_) => job.gather::<Layers<8>>(),
    })
}

struct SurfaceJob<'a> {
    bins: Bins,
    found: &'a [Result<SurfaceFootprint, Cull>],
    style: &'a Style,
    threshold: u32,
    traversal: Traversal,
    design: RuntimeWidths,
}

/// A cell of the kernel's with what became of its samples: begun, accumulated, discarded.
#[derive(Clone)]
struct CountedCell<C> {
    cell: C,
    samples: [u64; 3],
}

impl<C: Cell> Cell for CountedCell<C> {
    const EMPTY: Self = CountedCell {
        cell: C::EMPTY,
        samples: [0; 3],
    };

    fn add(&mut self, gather: &WeightedSum, sample: &Sample) {
        let near_enough = |fragment: &Fragment| {
            let low = fragment.near.saturating_sub(gather.threshold);
            let high = fragment.far.saturating_add(gather.threshold);
            (low..=high).contains(&sample.depth)
        };
        let joins = self.cell.fragments().iter().any(near_enough);
        let before = self.cell.clone();
        self.cell.add(gather, sample);
        let stays = before.fragments() == self.cell.fragments();
        let [begun, accumulated, discarded] = &mut self.samples;
        *match (stays, joins) {
            (true, _) => discarded,
            (false, true) => accumulated,
            (false, false) => begun,
        } += 1;
    }

    fn fragments(&self) -> &[Fragment] {
        self.cell.fragments()
    }
}

impl SurfaceJob<'_> {
    /// The work of all tiles, in cells of this kind.
    fn gather<C: HostCell>(&self) -> Workload {
        let (design, widths) = (self.design, self.design.widths());
        let rules = kernel_rules(self.style);
        let memory = TableMemory::new(&widths, &rules);
        let table = memory.table();
        let gather = WeightedSum::new(&widths, self.threshold);
        let painter = SurfacePainter::new(design, &rules, table, gather, self.traversal);
        let painted = each_tile(self.bins.lists.len(), &|tile| {
            self.tile::<C>(&painter, tile)
        });
        let (parts, counts): (Vec<TilePart>, Vec<SurfaceCounts>) = painted.into_iter().unzip();
        let mut work = SurfaceWork::default();
        for counts in counts {
            let resolved = counts.fragments + 2 * counts.merges;
            work.resolved.push(resolved.min(u32::MAX.into()) as u32);
            work.counts += counts;
        }
        let bits = Layout::new(&widths, self.traversal).bits() as u64;
        let attributes = SurfaceBits::new(&widths, layers_of(self.style), false).packet;
        let packet_bytes = 4 * (bits + attributes).div_ceil(32) as u32;
        Workload {
            surface: Some(work),
            ..assemble(parts, &self.bins, self.found.len(), packet_bytes)
        }
    }

    /// Rows and samples of one tile.
    fn tile<C: HostCell>(
        &self,
        painter: &SurfacePainter<RuntimeWidths>,
        tile: usize,
    ) -> (TilePart, SurfaceCounts) {
        let (widths, window) = (self.design.widths(), self.bins.grid.window(tile));
        let mut part = TilePart::default();
        let mut cells = vec![CountedCell::<C>::EMPTY; window.pixels()];
        // None of these ever finishes.
        let mut open = vec![Pixel::clear(&widths); window.pixels()];
        let mut open = whole(&mut open, window);
        let Ok(mut target) = CellTarget::new(&mut cells, window) else {
            unreachable!("the tile's memory has just been made for its window")
        };
        for index in &self.bins.lists[tile] {
            let Ok(found) = &self.found[*index as usize] else {
                continue;
            };
            let footprint = &found.footprint;
            part.note(self.design, *index, footprint, self.traversal, &mut open);
            painter.draw(found, &mut target);
        }
        let mut counts = SurfaceCounts::default();
        for CountedCell { cell, samples } in &cells {
            let fragments = cell.fragments().len() as u64;
            let [begun, accumulated, discarded] = *samples;
            counts += SurfaceCounts {
                samples: begun + accumulated + discarded,
                begun,
                accumulated,
                discarded,
                merges: cell.merges(),
                fragments,
                pixels: u64::from(fragments > 0),
            };
        }
        (part, counts)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Camera;
    use crate::fixed::surface::draw;
    use crate::scene::points::SurfaceScene;
    use crate::scene::points::synthetic::{Paint, scene, sheet, sphere};
    use crate::{Config, simulate_alone};

    /// A ball through a translucent sheet.
    fn ball_and_sheet() -> SurfaceScene {
        let paint = Paint {
            colour: [0.9, 0.4, 0.2],
            opacity: 0.6,
            material: 0,
        };
        let mut points = sphere([0.1, 0.0, 0.0], 0.8, 3_000, paint);
        let tilted = [[1.2, 0.3, 0.1], [0.0, 0.5, 1.0]];
        points.extend(sheet([0.0; 3], tilted, 0.05, |_, _| paint));
        scene("ball and sheet", points)
    }

    /// Whatever the tiles, the unit's counts are those of the kernel's drawing and of each other, and so are the
    /// machine's pixels and bytes.
    #[test]
    fn counts_are_the_drawings() {
        let scene = ball_and_sheet();
        let up = [0.0, 0.0, 1.0];
        let camera = Camera::look_at([0.5, -4.0, 1.0], [0.0; 3], up, 35.0, 70, 52).unwrap();
        let design = DesignChoice::named("standard24").unwrap();
        let points = QuantisedPoints::new(&scene, &camera);
        let threshold = 3.0 * 0.05;
        let culled = Style {
            cull_backfaces: true,
            ..Style::layered(threshold, 8)
        };
        for (style, traversal) in [
            (Style::opaque(threshold), Traversal::Spans),
            (Style::layered(threshold, 1), Traversal::Box),
            (Style::layered(threshold, 2), Traversal::Spans),
            (culled, Traversal::Spans),
        ] {
            let drawn = draw(&scene, &camera, &style, &design, traversal);
            let by_tiles = [[16, 16], [64, 8]]
                .map(|tile| extract_surface(&points, &style, &design, traversal, tile).unwrap());
            let surfaces = by_tiles
                .each_ref()
                .map(|work| work.surface.as_ref().unwrap());
            let [counts, others] = surfaces.map(|work| work.counts);
            assert_eq!(counts, others);
            let seen = drawn.weights.iter().filter(|weight| **weight > 0.0).count();
            assert_eq!(counts.pixels, seen as u64);
            let kept = counts.begun + counts.accumulated;
            assert_eq!(counts.samples, kept + counts.discarded);
            assert_eq!(counts.merges > 0, drawn.facts.merged > 0);
            assert!(counts.merges >= drawn.facts.merged as u64 && counts.begun >= counts.fragments);
            match style.buffer {
                Buffer::Accumulation => {
                    assert!(counts.discarded > 0 && counts.fragments == counts.pixels)
                }
                _ => assert!(counts.discarded == 0 && counts.fragments >= counts.pixels),
            }
            for (workload, surface) in by_tiles.iter().zip(surfaces) {
                let (totals, drawn) = (workload.totals(), drawn.facts.coverage);
                assert_eq!(totals.visited, drawn.visited);
                assert_eq!(totals.covered, drawn.covered);
                assert!(counts.samples <= totals.covered && totals.live == totals.covered);
                let sum: u64 = surface.resolved.iter().map(|count| u64::from(*count)).sum();
                assert_eq!(sum, counts.fragments + 2 * counts.merges);
                let timed = |resolve_interval| {
                    let config = Config {
                        tile_width: workload.tile[0],
                        tile_height: workload.tile[1],
                        surface_layers: layers_of(&style),
                        resolve_interval,
                        ..Config::default()
                    };
                    simulate_alone(workload, &config)
                };
                let (fast, slow) = (timed(1), timed(64));
                let sorting = [fast.sort, fast.splats.sorted, fast.bytes.sort_moved];
                assert_eq!(sorting, [0; 3]);
                assert_eq!(fast.surface, Some(counts));
                assert_eq!(fast.pixels.covered, drawn.covered);
                assert_eq!(fast.bytes, slow.bytes);
                // With one buffer to spare a tile's division hides behind the next one's lanes only while it is
                // shorter.
                let [busy, longer] = [&fast, &slow].map(|timing| timing.units["write_back"].busy);
                assert!(longer >= 64 * sum && longer > busy && slow.raster > fast.raster);
            }
        }
    }
}
