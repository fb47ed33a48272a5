//! A workload from the kernel: its rows, and the pixels that it really finished.
//!
//! Every tile is drawn by the kernel's painter. Before a footprint is drawn, its rows are walked once more to note
//! which of the visited pixels are covered and which have not finished; a test holds the sums against the painter's own
//! counts.

use super::order_changes::Before;
use super::{Bins, Pair, TilePart, Workload, WorkloadRow, assemble, each_tile, room_for};
use crate::camera::Camera;
use crate::fixed::{
    self, Options, QuantisedScene, TableMemory, kernel_compositing, kernel_rules, whole,
};
use crate::host_memory::TooLarge;
use crate::picture::Picture;
use crate::rules::Compositing;
use crate::scene::Scene;
use rayon::prelude::*;
use splatline::blend::Pixel;
use splatline::draw::{Painter, cutoff_in_lane};
use splatline::footprint::Footprint;
use splatline::footprint::packet::Layout;
use splatline::format::{Design, Lane, RuntimeWidths, Traversal, Widths};
use splatline::math::shift_signed;
use splatline::raster::{BoxSpans, EllipseSpans, Span, Spans, Window};
use splatline::setup::Cull;
use splatline::target::Target;
use splatline_engine::fast::order::Grid;

/// The work of drawing `scene` in tiles of `tile` columns (at most 64) and rows, unless it does not fit into memory.
pub fn extract(
    scene: &Scene,
    camera: &Camera,
    options: &Options,
    tile: [u16; 2],
) -> Result<Workload, TooLarge> {
    let footprints = fixed::footprints(scene, camera, options);
    room_for(&footprints, [camera.width, camera.height], tile)?;
    Ok(extract_from(&footprints, camera, options, tile))
}

/// The same where setup has been done: `footprints` in the scene's order, as the drawing with these options left them.
pub fn extract_from(
    footprints: &[Result<Footprint, Cull>],
    camera: &Camera,
    options: &Options,
    tile: [u16; 2],
) -> Workload {
    let viewport = [camera.width as u16, camera.height as u16];
    let job = ExtractJob {
        footprints,
        viewport,
        options,
        tile,
        before: None,
    };
    job.extract().0
}

/// A picture in the order of its tiles' lists.
pub struct InOrder {
    /// Its work.
    pub workload: Workload,
    /// The picture.
    pub picture: Picture,
}

/// The work and the picture of lists that keep the order of the picture `before`, which must be of the same scene,
/// screen and tiles; of lists that are sorted anew where there is none. `exact` lists hold only what the traversal
/// visits.
pub fn extract_in_order(
    scene: &Scene,
    camera: &Camera,
    options: &Options,
    tile: [u16; 2],
    before: Option<&Workload>,
    exact: bool,
) -> Result<InOrder, TooLarge> {
    let footprints = fixed::footprints(scene, camera, options);
    room_for(&footprints, [camera.width, camera.height], tile)?;
    let job = ExtractJob {
        footprints: &footprints,
        viewport: [camera.width as u16, camera.height as u16],
        options,
        tile,
        before: before.map(|workload| Before { workload, exact }),
    };
    let (workload, pixels) = job.extract();
    let colour_log2 = QuantisedScene::new(scene, camera, options.rules).colour_log2;
    let convert = fixed::converter(&options.design.widths, colour_log2);
    let mut picture = Picture::new(camera.width, camera.height);
    for (out, pixel) in picture.pixels.iter_mut().zip(&pixels) {
        *out = convert(pixel);
    }
    Ok(InOrder { workload, picture })
}

struct ExtractJob<'a> {
    footprints: &'a [Result<Footprint, Cull>],
    viewport: [u16; 2],
    options: &'a Options<'a>,
    tile: [u16; 2],
    before: Option<Before<'a>>,
}

/// Bits in which the keys of visible splats differ.
fn key_bits(footprints: &[Result<Footprint, Cull>]) -> u64 {
    let mut keys = footprints.iter().flatten().map(|footprint| footprint.depth);
    let first = keys.next().unwrap_or_default();
    keys.fold(0, |bits, key| bits | (key ^ first))
}

/// The place of each splat in the order.
fn ranks(order: &[u32], splats: usize) -> Vec<u32> {
    let mut ranks = vec![u32::MAX; splats];
    for (rank, splat) in (0..).zip(order) {
        ranks[*splat as usize] = rank;
    }
    ranks
}

impl ExtractJob<'_> {
    /// The work, and the screen's pixels.
    fn extract(&self) -> (Workload, Vec<Pixel>) {
        let (design, widths) = (self.options.design.in_fields(), &self.options.design.widths);
        let table = TableMemory::new(widths, &kernel_rules(self.options.rules));
        let compositing = kernel_compositing(self.options.compositing);
        let painter = table.painter(design, compositing, self.options.traversal);
        let order = self.order();
        let boxes = order.iter().filter_map(|index| {
            let footprint = self.footprints[*index as usize].as_ref().ok()?;
            Some((*index, Window::of(footprint)))
        });
        let mut bins = Bins::new(boxes, self.viewport, self.tile);
        let rank = self.before.map(|before| {
            let rank = ranks(&order, self.footprints.len());
            before.keep_order(&mut bins, &rank);
            rank
        });
        let parts = each_tile(bins.lists.len(), &|at| {
            self.tile(design, &painter, &bins.lists[at], bins.grid.window(at))
        });
        let screen = self.screen(&parts, widths, &bins.grid);
        let packet_bytes = 4 * Layout::new(widths, self.options.traversal).words() as u32;
        let mut workload = assemble(parts, &bins, self.footprints.len(), packet_bytes);
        workload.key_bits = key_bits(self.footprints);
        let changes = self.before.zip(rank);
        workload.order_changes = changes.map(|(before, rank)| before.changes(&workload, &rank));
        (workload, screen)
    }

    /// Visible splats in drawing order: by depth, ties by index.
    fn order(&self) -> Vec<u32> {
        let depth = |index: &u32| {
            let footprint = self.footprints[*index as usize].as_ref();
            footprint.map_or(0, |footprint| footprint.depth)
        };
        let visible = |index: &u32| self.footprints[*index as usize].is_ok();
        let all = 0..self.footprints.len() as u32;
        let mut order: Vec<u32> = all.filter(visible).collect();
        order.par_sort_by_key(depth);
        if self.options.compositing == Compositing::BackToFront {
            order.reverse();
        }
        order
    }

    /// All tiles' pixels as one screen.
    fn screen(&self, parts: &[TilePart], widths: &Widths, grid: &Grid) -> Vec<Pixel> {
        let [width, height] = self.viewport.map(usize::from);
        let mut screen = vec![Pixel::clear(widths); width * height];
        for (rows, part) in grid.split(&mut screen).into_iter().zip(parts) {
            for (place, pixel) in rows.into_iter().flatten().zip(&part.pixels) {
                *place = *pixel;
            }
        }
        screen
    }

    fn tile(
        &self,
        design: RuntimeWidths,
        painter: &Painter<RuntimeWidths>,
        list: &[u32],
        window: Window,
    ) -> TilePart {
        let widths = design.widths();
        let mut pixels = vec![Pixel::clear(&widths); window.pixels()];
        let mut target = whole(&mut pixels, window);
        let mut part = TilePart::default();
        for index in list {
            let Ok(footprint) = &self.footprints[*index as usize] else {
                continue;
            };
            let traversal = self.options.traversal;
            part.note(design, *index, footprint, traversal, &mut target);
            // Nothing that comes after the last pixel has finished changes the tile.
            if part.finished_after.is_none() {
                painter.draw(footprint, &mut target);
            }
            if part.finished_after.is_none() && target.is_finished() {
                part.finished_after = Some(part.pairs.len() as u32);
            }
        }
        TilePart { pixels, ..part }
    }
}

impl TilePart {
    /// Notes a footprint's rows in a tile whose pixels are `target`'s, before it is drawn there.
    pub(super) fn note(
        &mut self,
        design: RuntimeWidths,
        splat: u32,
        footprint: &Footprint,
        traversal: Traversal,
        target: &mut Target,
    ) {
        let window = target.window();
        let visible = Window::of(footprint).intersect(&window);
        let first = self.rows.len();
        let height = usize::from(visible.rows());
        self.rows.resize(first + height, WorkloadRow::default());
        let note = Note {
            footprint,
            widths: &design.widths(),
            window,
            first_row: visible.first[1],
        };
        let rows = &mut self.rows[first..];
        match traversal {
            Traversal::Spans => {
                note.rows(EllipseSpans::new(design, footprint, &window), target, rows)
            }
            Traversal::Box => note.rows(BoxSpans::new(design, footprint, &window), target, rows),
        }
        let visits = rows.iter().any(|row| row.length > 0);
        self.pairs.push(Pair {
            splat,
            rows_end: self.rows.len() as u32,
            first_row: (visible.first[1] - window.first[1]) as u8,
            visits,
        });
    }
}

/// Notes the rows of one footprint in one tile.
struct Note<'a> {
    footprint: &'a Footprint,
    widths: &'a Widths,
    window: Window,
    first_row: u16,
}

impl Note<'_> {
    fn rows<R: Spans>(&self, mut runs: R, target: &mut Target, rows: &mut [WorkloadRow]) {
        let drop = runs.fraction() as i32 - i32::from(self.widths.radial);
        while let Some(run) = runs.next_span() {
            // A second seed within a row of the tile continues its run.
            let part = self.row(run, drop, target);
            let row = &mut rows[usize::from(run.y - self.first_row)];
            *row = match row.length {
                0 => part,
                _ => WorkloadRow {
                    open: row.open | part.open,
                    covered: row.covered | part.covered,
                    x: row.x,
                    length: row.length + part.length,
                },
            };
        }
    }

    /// The same comparison as in the painter's lanes.
    fn row<L: Lane>(&self, run: Span<L>, drop: i32, target: &mut Target) -> WorkloadRow {
        let end = cutoff_in_lane(self.footprint.cutoff, self.widths.radial);
        let x = run.x - self.window.first[0];
        let mut row = WorkloadRow {
            open: 0,
            covered: 0,
            x: x as u8,
            length: run.length as u8,
        };
        let pixels = target.row(run.y, run.x, run.length).iter();
        for (column, (pixel, lane)) in (x..).zip(pixels.zip(run.radials())) {
            let inside = (shift_signed(lane.to_wide(), drop).max(0) as u64) < end;
            row.open |= u64::from(!pixel.is_finished()) << column;
            row.covered |= u64::from(inside) << column;
        }
        row
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::DesignChoice;
    use crate::rules::Rules;
    use crate::scene::synthetic;

    fn spans(design: &DesignChoice) -> Options<'_> {
        Options {
            rules: &Rules::GAUSSIAN_3D,
            compositing: Compositing::FrontToBack,
            design,
            traversal: Traversal::Spans,
        }
    }

    #[test]
    fn sums_are_the_painters_own() {
        let scene = synthetic::random_gaussians(2_000, 3, 2.0);
        let camera = synthetic::camera(100, 75);
        for (name, traversal) in [
            ("standard24", Traversal::Spans),
            ("lean18", Traversal::Box),
            ("deep32", Traversal::Spans),
        ] {
            let design = DesignChoice::named(name).unwrap();
            let options = Options {
                traversal,
                ..spans(&design)
            };
            let workload = extract(&scene, &camera, &options, [16, 8]).unwrap();
            // Back to front no pixel finishes, so the painter's sums are those of a drawing without termination.
            let all = Options {
                compositing: Compositing::BackToFront,
                ..options.clone()
            };
            let drawn = fixed::draw(&scene, &camera, &all).facts.coverage;
            let drawn = [drawn.visited, drawn.covered];
            let totals = workload.totals();
            assert_eq!([totals.visited, totals.covered], drawn, "{name}");
            let totals = extract(&scene, &camera, &all, [64, 16]).unwrap().totals();
            assert_eq!([totals.visited, totals.covered], drawn, "{name}");
            assert_eq!(totals.live, totals.covered, "{name}");
        }
    }

    /// Sorted anew the picture is the drawing's; after a step of the camera most of it is kept, some came and left, and
    /// it is another one.
    #[test]
    fn kept_lists_draw_nearly_the_same_picture() {
        let scene = synthetic::random_gaussians(3_000, 3, 2.0);
        let camera = synthetic::camera(70, 52);
        let design = DesignChoice::named("standard24").unwrap();
        let options = spans(&design);
        let draw = |camera: &Camera, before| {
            extract_in_order(&scene, camera, &options, [16, 16], before, true).unwrap()
        };
        let first = draw(&camera, None);
        let drawn = fixed::draw(&scene, &camera, &options);
        assert_eq!(first.picture, drawn.picture);
        let anew = extract(&scene, &camera, &options, [16, 16]).unwrap();
        assert_eq!(first.workload, anew);
        let still = draw(&camera, Some(&first.workload));
        let changes = still.workload.order_changes.unwrap();
        assert_eq!((changes.came, changes.left, changes.inversions), (0, 0, 0));
        assert_eq!(still.picture, first.picture);

        let [x, y, z] = camera.eye();
        let (eye, up) = ([x + 0.2, y + 0.1, z], [0.0, -1.0, 0.0]);
        let moved = Camera::look_at(eye, [0.0; 3], up, 40.0, 70, 52).unwrap();
        let anew = draw(&moved, None);
        let old = draw(&moved, Some(&first.workload));
        let changes = old.workload.order_changes.unwrap();
        let entries = old.workload.pairs.iter().filter(|pair| pair.visits).count() as u64;
        let some = (1..entries).contains(&changes.came) && changes.left > 0;
        let few = (1..changes.pairs / 2).contains(&changes.inversions);
        assert!(some && few, "{changes:?}");
        assert_ne!(old.picture, anew.picture);
        let sorted = |workload: &Workload, tile: usize| {
            let pairs = workload.pairs_of(tile).iter();
            let mut splats: Vec<u32> = pairs.map(|pair| pair.splat).collect();
            splats.sort_unstable();
            splats
        };
        for tile in 0..anew.workload.tiles.len() {
            assert_eq!(sorted(&old.workload, tile), sorted(&anew.workload, tile));
        }
    }

    #[test]
    fn live_pixels_do_not_depend_on_the_tile_size() {
        let scene = synthetic::random_gaussians(3_000, 5, 8.0);
        let camera = synthetic::camera(64, 48);
        let design = DesignChoice::named("standard24").unwrap();
        let options = spans(&design);
        let [small, large] =
            [[8, 8], [64, 64]].map(|tile| extract(&scene, &camera, &options, tile).unwrap());
        assert_eq!(small.totals().live, large.totals().live);
        assert!(
            small.totals().live < small.totals().covered,
            "some pixels must have finished for this test to mean anything"
        );
        let mut tiles = small.tiles.iter();
        assert!(tiles.any(|tile| tile.finished_after != u32::MAX));
        assert_eq!(small.visible(), large.visible());
    }
}
