//! Drawing a scene that is larger than memory: depth-ordered chunks, each read from the file anew.
//!
//! ```text
//! file -> unit of the colours                                        once
//! file -> setup -> the nearest footprints beyond the last chunk -> tiles    for each chunk
//! ```
//!
//! The order of drawing is that of the whole scene, by sort key and then by number, so that the pixels are the same whatever the chunks. A chunk
//! is found by selection: of what setup makes of the file, twice as many footprints as a chunk has are kept, and whenever there are more the
//! farther half goes. So memory is bounded whatever the scene's depths, equal ones included, and no list of all depths is needed; the price is
//! that all splats are set up for every chunk. Tiles keep their pixels from chunk to chunk, painted by the kernel's own painter, and nothing
//! is read any more when all of them have finished.

use super::frame::{converter, table, table_entries};
use super::quantise::{QuantisedScene, kernel_compositing};
use super::render::{CHECK_INTERVAL, Options, PaintEngine, set_up};
use crate::camera::Camera;
use crate::design::DesignJob;
use crate::fast::TILE;
use crate::fast::order::Grid;
use crate::picture::Picture;
use crate::rules::Compositing;
use crate::scene::{GaussianFile, LoadError, Skipped};
use rayon::prelude::*;
use splatline::blend::Pixel;
use splatline::draw::Painter;
use splatline::footprint::Footprint;
use splatline::format::Design;
use splatline::raster::Window;
use splatline::setup::Cull;
use splatline::target::Target;

/// Most records that are read at once.
const PART: usize = 1 << 16;

/// Bytes of memory for each footprint of a chunk: two footprints that are kept, and its entries in the lists of tiles, for a footprint that
/// lies in ten tiles.
pub const BYTES: u64 = 2 * size_of::<PlacedFootprint>() as u64 + 40;

/// A footprint and its place in the order of drawing.
#[derive(Clone, Copy)]
struct PlacedFootprint {
    place: DrawingPlace,
    footprint: Footprint,
}

/// Sort key, then number in the scene; turned around where the farthest is drawn first.
type DrawingPlace = (u64, u32);

/// What a drawing by chunks gives.
#[derive(Clone, Debug)]
pub struct ChunkDrawing {
    /// The picture, converted to double precision without further rounding.
    pub picture: Picture,
    /// The kernel's pixels, row-major.
    pub pixels: Vec<Pixel>,
    /// Splats of the scene.
    pub splats: usize,
    /// Records that could not be drawn.
    pub skipped: Skipped,
    /// Splats of which a coordinate or colour is not finite.
    pub clamped: usize,
    /// Splats culled, by reason, in the order of [`Cull::ALL`].
    pub culled: [usize; Cull::ALL.len()],
    /// Footprints that were painted. Fewer than are seen if all pixels had finished before.
    pub painted: usize,
    /// Chunks that were painted.
    pub chunks: usize,
}

/// Draws the file's Gaussians as `camera` sees them, so many footprints at a time; `doing` hears of every chunk.
///
/// The pixels are those of [`draw`](super::draw()).
pub fn draw_in_chunks(
    file: &GaussianFile,
    camera: &Camera,
    options: &Options,
    engine: PaintEngine,
    size: usize,
    doing: &(dyn Fn(usize) + Sync),
) -> Result<ChunkDrawing, LoadError> {
    options.design.dispatch(ChunkJob {
        file,
        camera,
        options,
        engine,
        size: size.max(1),
        doing,
    })
}

struct ChunkJob<'a> {
    file: &'a GaussianFile,
    camera: &'a Camera,
    options: &'a Options<'a>,
    engine: PaintEngine,
    size: usize,
    doing: &'a (dyn Fn(usize) + Sync),
}

impl DesignJob for ChunkJob<'_> {
    type Output = Result<ChunkDrawing, LoadError>;

    fn run<D: Design + Send + Sync + 'static>(self, design: D) -> Self::Output {
        let facts = self.look()?;
        let view = super::quantise::view(self.camera, 0);
        let tiles = &mut ChunkTiles::new(view.viewport, Pixel::clear(&design.widths()));
        let mut drawing = ChunkDrawing {
            picture: Picture::new(self.camera.width, self.camera.height),
            pixels: Vec::new(),
            splats: facts.splats,
            skipped: facts.skipped,
            clamped: 0,
            culled: [0; Cull::ALL.len()],
            painted: 0,
            chunks: 0,
        };
        let rules = super::kernel_rules(self.options.rules);
        let widths = design.widths();
        let memory = table_entries(&widths, &rules);
        let table = table(&memory, &widths, &rules);
        let order = kernel_compositing(self.options.compositing);
        let painter = Painter::new(design, &rules, table, order, self.options.traversal);
        let mut last = None;
        loop {
            (self.doing)(drawing.chunks + 1);
            let chunk = self.select(design, last, &facts)?;
            drawing.culled = chunk.culled;
            drawing.clamped = chunk.clamped;
            let Some(farthest) = chunk.nearest.last() else {
                break;
            };
            last = Some(farthest.place);
            paint(&painter, &chunk.nearest, tiles);
            drawing.painted += chunk.nearest.len();
            drawing.chunks += 1;
            if !chunk.more || tiles.are_finished() {
                break;
            }
        }
        drawing.pixels = tiles.frame();
        let convert = converter(&design.widths(), facts.colour_log2);
        let pixels = drawing.picture.pixels.par_iter_mut();
        pixels
            .zip(&drawing.pixels)
            .for_each(|(to, from)| *to = convert(from));
        Ok(drawing)
    }
}

/// What the whole file has to say before anything is drawn.
struct FileFacts {
    colour_log2: i32,
    splats: usize,
    skipped: Skipped,
}

/// The footprints of a chunk in the order of drawing.
struct Chunk {
    nearest: Vec<PlacedFootprint>,
    /// Are there footprints beyond?
    more: bool,
    culled: [usize; Cull::ALL.len()],
    clamped: usize,
}

impl ChunkJob<'_> {
    /// The unit of all colours and the number of splats.
    fn look(&self) -> Result<FileFacts, LoadError> {
        let mut facts = FileFacts {
            colour_log2: 0,
            splats: 0,
            skipped: Skipped::default(),
        };
        for part in self.file.parts(PART)? {
            let part = part?;
            let unit = QuantisedScene::unit_of_colours(&part, self.camera);
            facts.colour_log2 = facts.colour_log2.max(unit);
            facts.splats += part.splats.len();
            facts.skipped.non_finite += part.skipped.non_finite;
            facts.skipped.zero_rotation += part.skipped.zero_rotation;
        }
        Ok(facts)
    }

    /// The nearest footprints beyond the place of the last one.
    fn select<D: Design + Send + Sync>(
        &self,
        design: D,
        last: Option<DrawingPlace>,
        facts: &FileFacts,
    ) -> Result<Chunk, LoadError> {
        let backwards = self.options.compositing == Compositing::BackToFront;
        let mut selection = Selection::new(self.size, last);
        let mut culled = [0; Cull::ALL.len()];
        let (mut index, mut clamped) = (0u32, 0);
        for part in self.file.parts(PART.min(2 * self.size))? {
            let rules = self.options.rules;
            let part = QuantisedScene::part(&part?, self.camera, rules, facts.colour_log2);
            clamped += part.clamped;
            let kernel_rules = part.rules(rules);
            for outcome in set_up(design, &part, &kernel_rules, self.engine) {
                match outcome {
                    Ok(footprint) if Window::of(&footprint).is_empty() => {}
                    Ok(footprint) if backwards => {
                        selection.offer((!footprint.depth, !index), footprint);
                    }
                    Ok(footprint) => selection.offer((footprint.depth, index), footprint),
                    Err(reason) => culled[reason.place()] += 1,
                }
                index += 1;
            }
        }
        let (nearest, more) = selection.finish();
        Ok(Chunk {
            nearest,
            more,
            culled,
            clamped,
        })
    }
}

/// Paints a chunk over what the tiles hold.
fn paint<D: Design + Send + Sync>(
    painter: &Painter<D>,
    chunk: &[PlacedFootprint],
    tiles: &mut ChunkTiles,
) {
    let grid = tiles.grid;
    let mut lists = vec![Vec::new(); grid.len()];
    for (number, placed) in (0u32..).zip(chunk) {
        let bounds = Window::of(&placed.footprint);
        grid.touched(&bounds, |tile| lists[tile].push(number));
    }
    let work = tiles.tiles.par_iter_mut().zip(&lists).enumerate();
    work.for_each(|(number, (tile, list))| {
        if tile.is_finished {
            return;
        }
        let window = grid.window(number);
        let columns = usize::from(window.end[0] - window.first[0]);
        let Ok(mut target) = Target::new(&mut tile.pixels, window, columns) else {
            unreachable!("the tile's memory has been made for its window")
        };
        for part in list.chunks(CHECK_INTERVAL) {
            for number in part {
                painter.draw(&chunk[*number as usize].footprint, &mut target);
            }
            tile.is_finished = target.is_finished();
            if tile.is_finished {
                break;
            }
        }
    });
}

/// The least of what is offered, in bounded memory.
struct Selection {
    size: usize,
    /// Nothing up to this one is taken.
    last: Option<DrawingPlace>,
    /// Nothing beyond this one is taken.
    farthest: Option<DrawingPlace>,
    kept: Vec<PlacedFootprint>,
    more: bool,
}

impl Selection {
    fn new(size: usize, last: Option<DrawingPlace>) -> Self {
        Selection {
            size,
            last,
            farthest: None,
            kept: Vec::new(),
            more: false,
        }
    }

    fn offer(&mut self, place: DrawingPlace, footprint: Footprint) {
        if self.last.is_some_and(|last| place <= last) {
            return;
        }
        if self.farthest.is_some_and(|farthest| place > farthest) {
            self.more = true;
            return;
        }
        self.kept.push(PlacedFootprint { place, footprint });
        if self.kept.len() >= 2 * self.size {
            self.drop_farther();
        }
    }

    /// Keeps as many as a chunk has.
    fn drop_farther(&mut self) {
        if self.kept.len() <= self.size {
            return;
        }
        let (_, farthest, _) = self
            .kept
            .select_nth_unstable_by_key(self.size - 1, |placed| placed.place);
        self.farthest = Some(farthest.place);
        self.kept.truncate(self.size);
        self.more = true;
    }

    /// The least ones in order, and whether there are others.
    fn finish(mut self) -> (Vec<PlacedFootprint>, bool) {
        self.drop_farther();
        self.kept.sort_unstable_by_key(|placed| placed.place);
        (self.kept, self.more)
    }
}

/// The picture between two chunks.
struct ChunkTiles {
    grid: Grid,
    tiles: Vec<ChunkTile>,
}

struct ChunkTile {
    pixels: Vec<Pixel>,
    is_finished: bool,
}

impl ChunkTiles {
    fn new(viewport: [u16; 2], clear: Pixel) -> Self {
        let grid = Grid::new(viewport, TILE);
        let tile = |number| ChunkTile {
            pixels: vec![clear; grid.window(number).pixels()],
            is_finished: false,
        };
        ChunkTiles {
            grid,
            tiles: (0..grid.len()).map(tile).collect(),
        }
    }

    fn are_finished(&self) -> bool {
        self.tiles.iter().all(|tile| tile.is_finished)
    }

    /// The pixels row by row.
    fn frame(&self) -> Vec<Pixel> {
        let [columns, rows] = self.grid.viewport().map(usize::from);
        let mut frame = vec![Pixel::default(); columns * rows];
        let parts = self.grid.split(&mut frame);
        for (mut rows, tile) in parts.into_iter().zip(&self.tiles) {
            let columns = rows.first().map_or(1, |row| row.len().max(1));
            for (row, pixels) in rows.iter_mut().zip(tile.pixels.chunks(columns)) {
                row.copy_from_slice(pixels);
            }
        }
        frame
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::DesignChoice;
    use crate::fixed::{best_engine, draw};
    use crate::rules::Rules;
    use crate::scene::{LoadOptions, load};
    use splatline::format::Traversal;
    use std::path::PathBuf;

    /// Properties of a Gaussian of degree 1, in the file's order.
    const PROPERTIES: [&str; 23] = [
        "x", "y", "z", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3",
        "opacity", "f_dc_0", "f_dc_1", "f_dc_2", "f_rest_0", "f_rest_1", "f_rest_2", "f_rest_3",
        "f_rest_4", "f_rest_5", "f_rest_6", "f_rest_7", "f_rest_8",
    ];

    fn header(encoding: &str, count: usize) -> String {
        let properties = PROPERTIES.map(|name| format!("property float {name}\n"));
        let properties = properties.concat();
        format!("ply\nformat {encoding} 1.0\nelement vertex {count}\n{properties}end_header\n")
    }

    /// A file of Gaussians in a box, a third of them on four planes of equal depth, some of which cannot be drawn.
    fn file(name: &str, count: usize) -> PathBuf {
        let mut state = 11u32;
        let mut next = |from: f32, to: f32| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            from + (to - from) * (state >> 8) as f32 / 16_777_216.0
        };
        let mut bytes = header("binary_little_endian", count).into_bytes();
        for number in 0..count {
            let mut record: Vec<f32> = (0..PROPERTIES.len()).map(|_| next(-1.0, 1.0)).collect();
            if number % 3 == 0 {
                record[2] = (number / 3 % 4) as f32 * 0.5 - 1.0;
            }
            for scale in &mut record[3..6] {
                *scale = next(-4.0, -2.0);
            }
            record[10] = next(-2.0, 3.0);
            record[11] = next(-1.0, 80.0);
            if number % 97 == 5 {
                record[0] = f32::NAN;
            }
            bytes.extend(record.iter().flat_map(|value| value.to_le_bytes()));
        }
        let path = std::env::temp_dir().join(format!("splatline-{}-{name}", std::process::id()));
        std::fs::write(&path, bytes).unwrap();
        path
    }

    /// The oracle is the whole scene's picture, whatever the chunks, orders and depths that are equal.
    #[test]
    fn chunks_draw_the_whole_scenes_picture() {
        let path = file("chunks.ply", 1500);
        let scene = load(&path, &LoadOptions::default()).unwrap();
        let camera = Camera::look_at([0.0, 0.0, -3.0], [0.0; 3], scene.up, 50.0, 150, 100).unwrap();
        let file = GaussianFile::open(&path).unwrap();
        let design = DesignChoice::named("standard24").unwrap();
        for compositing in [Compositing::FrontToBack, Compositing::BackToFront] {
            let options = Options {
                rules: &Rules::GAUSSIAN_3D,
                compositing,
                design: &design,
                traversal: Traversal::Spans,
            };
            let whole = draw(&scene, &camera, &options);
            let seen = whole.splats - whole.culled.iter().sum::<usize>();
            for (size, chunks) in [
                (1, 0),
                (97, seen.div_ceil(97)),
                (700, seen.div_ceil(700)),
                (seen, 1),
                (5000, 1),
            ] {
                if size == 1 && compositing == Compositing::BackToFront {
                    continue;
                }
                let size = if size == 1 { 31 } else { size };
                let drawn =
                    draw_in_chunks(&file, &camera, &options, best_engine(), size, &|_| ()).unwrap();
                assert!(drawn.pixels == whole.pixels, "{size} {compositing:?}");
                assert!(drawn.picture.pixels == whole.picture.pixels);
                assert_eq!(drawn.culled, whole.culled);
                assert_eq!((drawn.splats, drawn.skipped), (whole.splats, scene.skipped));
                if chunks > 0 {
                    assert_eq!((drawn.chunks, drawn.painted), (chunks, seen), "{size}");
                }
            }
        }
        std::fs::remove_file(path).unwrap();
    }

    /// What `--help` says of a footprint's memory.
    #[test]
    fn a_footprint_of_a_chunk_takes_about_280_bytes() {
        assert!((270..290).contains(&BYTES), "{BYTES}");
    }

    /// Equal depths are told apart by number; what was drawn before is not taken again.
    #[test]
    fn a_selection_keeps_the_least_beyond_the_last() {
        let mut selection = Selection::new(2, Some((3, 7)));
        let footprint = Footprint::EMPTY;
        for place in [
            (3, 6),
            (9, 1),
            (3, 7),
            (5, 2),
            (3, 8),
            (9, 0),
            (4, 4),
            (5, 1),
            (2, 9),
        ] {
            selection.offer(place, footprint);
        }
        let (kept, more) = selection.finish();
        let places: Vec<DrawingPlace> = kept.iter().map(|placed| placed.place).collect();
        assert_eq!((places, more), (vec![(3, 8), (4, 4)], true));
    }

    #[test]
    fn other_files_are_refused_with_one_message() {
        let refused = |name: &str, contents: &[u8]| {
            let path =
                std::env::temp_dir().join(format!("splatline-{}-{name}", std::process::id()));
            std::fs::write(&path, contents).unwrap();
            let message = GaussianFile::open(&path).unwrap_err().to_string();
            std::fs::remove_file(path).unwrap();
            message
        };
        let text = header("ascii", 1);
        for (name, contents) in [("a.splat", "x"), ("b.ply", text.as_str())] {
            let message = refused(name, contents.as_bytes());
            assert!(message.contains("binary .ply files"), "{message}");
        }
        let short = header("binary_little_endian", 2);
        let message = refused("c.ply", [short.as_bytes(), &[0; 92]].concat().as_slice());
        assert!(
            message.contains("184 bytes are needed but 92 are left"),
            "{message}"
        );
    }
}
