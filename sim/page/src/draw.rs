//! Both engines' pictures of a view.
//!
//! The kernel paints tiles as the host does: the same tiles, the same order, and the same checks whether a tile has
//! finished. A pixel's value does not depend on them under `spans`, but the counts of visited pixels do, and under
//! `box` the corner that differencing starts from.

use crate::bytes;
use crate::camera::Camera;
use crate::order::Grid;
use crate::quantise::{QuantisedScene, view};
use crate::rules::{Compositing, Rules};
use crate::scene::Scene;
use splatline::blend::Pixel;
use splatline::draw::{Coverage, Painter};
use splatline::footprint::Footprint;
use splatline::format::{Design, Lean18, RuntimeWidths, Standard24, Traversal, Widths};
use splatline::kernel::{FootprintTable, entries, fill};
use splatline::raster::Window;
use splatline::setup::{Cull, setup};
use splatline::target::Target;
use splatline_reference::engines::float;
use splatline_reference::picture::Picture;

/// Columns and rows of the host's tiles.
const TILE: u16 = 64;
/// Footprints that the host paints between two checks whether a tile has finished.
const CHECK_INTERVAL: usize = 64;

/// A scene, and its splats in the kernel's formats.
pub struct LoadedScene {
    scene: Scene,
    rules: Rules,
    quantised: Option<QuantisedScene>,
}

impl LoadedScene {
    pub fn new(scene: Scene, rules: Rules) -> LoadedScene {
        LoadedScene {
            scene,
            rules,
            quantised: None,
        }
    }

    pub fn splats(&self) -> usize {
        self.scene.splats.len()
    }

    /// A splat's centre, scene units.
    pub fn centre(&self, splat: u32) -> [f64; 3] {
        let splat = self.scene.splats.get(splat as usize);
        splat.map_or([f64::NAN; 3], |splat| splat.centre)
    }

    /// The splats, quantised once; again for every camera if their colours depend on it.
    fn quantised(&mut self, camera: &Camera) -> &QuantisedScene {
        let again = self.scene.harmonics.is_some() || self.quantised.is_none();
        let mut quantised = match self.quantised.take() {
            Some(kept) if !again => kept,
            _ => QuantisedScene::new(&self.scene, camera, &self.rules),
        };
        quantised.view = view(camera, quantised.scale_log2);
        self.quantised.insert(quantised)
    }
}

/// A picture through the kernel.
pub struct FixedPicture {
    pub picture: Picture,
    pub rgba: Vec<u8>,
    pub painted: PaintedTiles,
    pub culled: usize,
    pub checksum: u64,
    pub design: RuntimeWidths,
    pub rules: splatline::rules::Rules,
    pub traversal: Traversal,
}

impl FixedPicture {
    pub fn draw(
        loaded: &mut LoadedScene,
        camera: &Camera,
        design: RuntimeWidths,
        traversal: Traversal,
    ) -> FixedPicture {
        let quantised = loaded.quantised(camera);
        // The widths of a named design as constants: the same bits in less time.
        let painted = match design.widths() {
            widths if widths == Lean18::WIDTHS => paint_all(Lean18, quantised, camera, traversal),
            widths if widths == Standard24::WIDTHS => {
                paint_all(Standard24, quantised, camera, traversal)
            }
            _ => paint_all(design, quantised, camera, traversal),
        };
        let pixels = &painted.pixels;
        let picture = picture_of(pixels, camera, &design.widths(), quantised.colour_log2);
        let words = |p: &Pixel| p.colour.into_iter().chain([p.transmittance]);
        FixedPicture {
            rgba: rgba(&picture),
            checksum: bytes::checksum(pixels.iter().flat_map(words)),
            picture,
            culled: painted.footprints.iter().filter(|f| f.is_err()).count(),
            painted,
            design,
            rules: quantised.rules,
            traversal,
        }
    }
}

/// What setup and raster made of it.
pub struct PaintedTiles {
    pub footprints: Vec<Result<Footprint, Cull>>,
    /// Per tile the drawn splats in their order.
    pub lists: Vec<Vec<u32>>,
    pixels: Vec<Pixel>,
    pub coverage: Coverage,
}

/// Sets all splats up and paints all tiles.
fn paint_all<D: Design>(
    design: D,
    quantised: &QuantisedScene,
    camera: &Camera,
    traversal: Traversal,
) -> PaintedTiles {
    let (rules, widths) = (&quantised.rules, design.widths());
    let splats = quantised.splats.iter();
    let mut footprints: Vec<_> = splats
        .map(|splat| setup(design, &quantised.view, rules, splat))
        .collect();
    quantised.sort_keys(&widths, &quantised.splats, &mut footprints);
    let grid = grid([camera.width, camera.height]);
    let lists = lists(&grid, &footprints);
    let memory = table(&widths, rules);
    let painter = painter(design, rules, &memory, traversal);
    let mut pixels = vec![Pixel::clear(&widths); camera.width * camera.height];
    let mut coverage = Coverage::default();
    for (tile, list) in lists.iter().enumerate() {
        let window = grid.window(tile);
        let start = usize::from(window.first[1]) * camera.width + usize::from(window.first[0]);
        let Ok(mut target) = Target::new(&mut pixels[start..], window, camera.width) else {
            continue;
        };
        coverage += paint(&painter, &footprints, list, &mut target);
    }
    PaintedTiles {
        footprints,
        lists,
        pixels,
        coverage,
    }
}

/// A picture in double precision.
pub struct FloatPicture {
    pub picture: Picture,
    pub rgba: Vec<u8>,
}

impl FloatPicture {
    pub fn draw(loaded: &LoadedScene, camera: &Camera) -> FloatPicture {
        let LoadedScene { scene, rules, .. } = loaded;
        let picture = float::draw(scene, camera, rules, Compositing::FrontToBack).picture;
        FloatPicture {
            rgba: rgba(&picture),
            picture,
        }
    }
}

/// The footprint table's entries.
pub fn table(widths: &Widths, rules: &splatline::rules::Rules) -> Vec<u32> {
    let mut memory = vec![0; entries(widths)];
    fill(&mut memory, widths, rules.table_range, rules.kernel);
    memory
}

/// The painter over them.
pub fn painter<'a, D: Design>(
    design: D,
    rules: &splatline::rules::Rules,
    memory: &'a [u32],
    traversal: Traversal,
) -> Painter<'a, D> {
    let Ok(table) = FootprintTable::new(memory, &design.widths(), rules.table_range) else {
        unreachable!("the entries have been made for these widths")
    };
    let order = splatline::rules::Compositing::FrontToBack;
    Painter::new(design, rules, table, order, traversal)
}

fn paint<D: Design>(
    painter: &Painter<D>,
    footprints: &[Result<Footprint, Cull>],
    list: &[u32],
    target: &mut Target,
) -> Coverage {
    let mut coverage = Coverage::default();
    for part in list.chunks(CHECK_INTERVAL) {
        let drawn = part.iter().flat_map(|i| &footprints[*i as usize]);
        for footprint in drawn {
            coverage += painter.draw(footprint, target);
        }
        if target.is_finished() {
            break;
        }
    }
    coverage
}

/// The screen in the host's tiles.
pub fn grid([width, height]: [usize; 2]) -> Grid {
    Grid::new([width as u16, height as u16], [TILE; 2])
}

/// For every tile the splats whose box touches it, nearest first, ties by index.
fn lists(grid: &Grid, footprints: &[Result<Footprint, Cull>]) -> Vec<Vec<u32>> {
    let drawn = footprints.iter().zip(0..);
    let drawn = drawn.filter_map(|(footprint, index)| Some((footprint.as_ref().ok()?, index)));
    let mut order: Vec<(&Footprint, u32)> = drawn.collect();
    order.sort_unstable_by_key(|(footprint, index)| (footprint.depth, *index));
    let mut lists = vec![Vec::new(); grid.len()];
    for (footprint, index) in order {
        let bounds = Window::of(footprint);
        if !bounds.is_empty() {
            grid.touched(&bounds, |tile| lists[tile].push(index));
        }
    }
    lists
}

fn picture_of(pixels: &[Pixel], camera: &Camera, widths: &Widths, colour_log2: i32) -> Picture {
    let colour = f64::from(colour_log2 - i32::from(widths.accumulator)).exp2();
    let share = f64::from(-i32::from(widths.transmittance)).exp2();
    let value = |pixel: &Pixel| {
        let [r, g, b] = pixel.colour.map(|c| f64::from(c) * colour);
        [r, g, b, 1.0 - f64::from(pixel.transmittance()) * share]
    };
    Picture {
        width: camera.width,
        height: camera.height,
        pixels: pixels.iter().map(value).collect(),
    }
}

/// The picture on black, as a canvas takes it.
fn rgba(picture: &Picture) -> Vec<u8> {
    let byte = |value: f64| (value.clamp(0.0, 1.0) * 255.0 + 0.5) as u8;
    let mut bytes = vec![255; picture.pixels.len() * 4];
    for (out, [r, g, b, _]) in bytes.as_chunks_mut::<4>().0.iter_mut().zip(&picture.pixels) {
        *out = [byte(*r), byte(*g), byte(*b), 255];
    }
    bytes
}
