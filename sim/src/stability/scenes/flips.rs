//! Decisions at the smallest opacity: which pairs of a splat and a pixel an engine draws and the reference does not, and the reverse.
//!
//! Every pair is decided by the engine's own code: a splat is drawn alone. Pairs behind a pixel that the reference has finished do not count,
//! since no picture shows them.

use crate::camera::Camera;
use crate::design::{DesignChoice, DesignJob};
use crate::fixed;
use crate::reference::compositor::{self, Projected};
use crate::reference::float::Footprint as Exact;
use crate::reference::{Culled, PixelBox};
use crate::rules::Rules;
use crate::stability::single::SingleFootprint;
use rayon::prelude::*;
use splatline::blend::Pixel;
use splatline::draw::Painter;
use splatline::footprint::Footprint;
use splatline::format::Design;
use splatline::raster::Window;
use splatline::rules::Compositing;
use splatline::setup::Cull;
use splatline::target::Target;

/// Side of the squares of pixels that are decided at a time.
const TILE: usize = 64;

/// Pairs decided otherwise than by the reference.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct Flips {
    /// Drawn by the engine alone.
    pub added: u64,
    /// Drawn by the reference alone.
    pub removed: u64,
}

impl std::ops::AddAssign for Flips {
    fn add_assign(&mut self, other: Flips) {
        self.added += other.added;
        self.removed += other.removed;
    }
}

/// An engine that says where a splat is drawn.
pub(super) trait Decides: Sync {
    /// The pixels outside of which splat `index` is not drawn.
    fn bounds(&self, index: usize) -> PixelBox;

    /// Marks the pixels of `area` in which it is drawn, row by row.
    fn mark(&self, index: usize, area: PixelBox, marks: &mut Vec<bool>);
}

const NOWHERE: PixelBox = PixelBox {
    x0: 0,
    y0: 0,
    x1: 0,
    y1: 0,
};

fn mark_each(area: PixelBox, marks: &mut Vec<bool>, drawn: impl Fn(usize, usize) -> bool) {
    marks.clear();
    for y in area.y0..area.y1 {
        marks.extend((area.x0..area.x1).map(|x| drawn(x, y)));
    }
}

/// Double precision.
pub(super) struct Double<'a> {
    pub projected: &'a [Result<Exact, Culled>],
    pub rules: &'a Rules,
}

impl Decides for Double<'_> {
    fn bounds(&self, index: usize) -> PixelBox {
        self.projected[index]
            .as_ref()
            .map_or(NOWHERE, Projected::bounds)
    }

    fn mark(&self, index: usize, area: PixelBox, marks: &mut Vec<bool>) {
        mark_each(area, marks, |x, y| {
            let at = [x as f64 + 0.5, y as f64 + 0.5];
            let splat = self.projected[index].as_ref().ok();
            splat.is_some_and(|splat| compositor::opacity(splat, at, self.rules).is_some())
        });
    }
}

/// Single precision.
pub(super) struct Single<'a> {
    pub projected: &'a [Option<SingleFootprint>],
    pub camera: &'a Camera,
    pub rules: &'a Rules,
}

impl Decides for Single<'_> {
    fn bounds(&self, index: usize) -> PixelBox {
        self.projected[index]
            .as_ref()
            .map_or(NOWHERE, |f| f.bounds(self.camera, self.rules))
    }

    fn mark(&self, index: usize, area: PixelBox, marks: &mut Vec<bool>) {
        mark_each(area, marks, |x, y| {
            let at = [x as f32 + 0.5, y as f32 + 0.5];
            let splat = self.projected[index].as_ref();
            splat.is_some_and(|splat| splat.opacity(at[0], at[1], self.rules) > 0.0)
        });
    }
}

/// The kernel under a design.
pub(super) struct Fixed<'a> {
    pub footprints: &'a [Result<Footprint, Cull>],
    pub design: &'a DesignChoice,
    pub rules: splatline::rules::Rules,
    pub table: Vec<u32>,
}

impl<'a> Fixed<'a> {
    pub fn new(
        footprints: &'a [Result<Footprint, Cull>],
        design: &'a DesignChoice,
        rules: &Rules,
    ) -> Self {
        let rules = fixed::kernel_rules(rules);
        let table = fixed::table_entries(&design.widths, &rules);
        Fixed {
            footprints,
            design,
            rules,
            table,
        }
    }
}

impl Decides for Fixed<'_> {
    fn bounds(&self, index: usize) -> PixelBox {
        let Ok(footprint) = &self.footprints[index] else {
            return NOWHERE;
        };
        let [x0, y0] = footprint.first.map(usize::from);
        let [x1, y1] = footprint.last.map(usize::from);
        PixelBox { x0, y0, x1, y1 }
    }

    fn mark(&self, index: usize, area: PixelBox, marks: &mut Vec<bool>) {
        match &self.footprints[index] {
            Ok(footprint) => self.design.dispatch(Alone {
                engine: self,
                footprint,
                area,
                marks,
            }),
            Err(_) => mark_each(area, marks, |_, _| false),
        }
    }
}

/// One splat on an empty picture: where it leaves a trace, it is drawn.
struct Alone<'a, 'b> {
    engine: &'a Fixed<'a>,
    footprint: &'a Footprint,
    area: PixelBox,
    marks: &'b mut Vec<bool>,
}

impl DesignJob for Alone<'_, '_> {
    type Output = ();

    fn run<D: Design + Send + Sync>(self, design: D) {
        let Alone {
            engine,
            footprint,
            area,
            marks,
        } = self;
        let widths = design.widths();
        let clear = Pixel::clear(&widths);
        let columns = area.x1 - area.x0;
        let mut pixels = vec![clear; columns * (area.y1 - area.y0)];
        let window = Window {
            first: [area.x0 as u16, area.y0 as u16],
            last: [area.x1 as u16, area.y1 as u16],
        };
        let Ok(mut target) = Target::new(&mut pixels, window, columns) else {
            unreachable!("the memory has just been made for its window")
        };
        let table = fixed::table(&engine.table, &widths, &engine.rules);
        let traversal = engine.design.traversal;
        let painter = Painter::new(
            design,
            &engine.rules,
            table,
            Compositing::FrontToBack,
            traversal,
        );
        painter.draw(footprint, &mut target);
        marks.clear();
        marks.extend(pixels.iter().map(|pixel| *pixel != clear));
    }
}

/// Flips of every engine against the reference; `order` lists all splats, nearest first.
pub(super) fn count(
    reference: &Double,
    engines: &[&dyn Decides],
    order: &[usize],
    camera: &Camera,
) -> Vec<Flips> {
    let across = camera.width.div_ceil(TILE);
    let tiles = 0..across * camera.height.div_ceil(TILE);
    let counted: Vec<Vec<Flips>> = tiles
        .into_par_iter()
        .map(|tile| {
            let (x0, y0) = (tile % across * TILE, tile / across * TILE);
            let area = PixelBox {
                x0,
                y0,
                x1: (x0 + TILE).min(camera.width),
                y1: (y0 + TILE).min(camera.height),
            };
            count_tile(reference, engines, order, area)
        })
        .collect();
    let mut sums = vec![Flips::default(); engines.len()];
    for flips in &counted {
        for (sum, flips) in sums.iter_mut().zip(flips) {
            *sum += *flips;
        }
    }
    sums
}

fn count_tile(
    reference: &Double,
    engines: &[&dyn Decides],
    order: &[usize],
    area: PixelBox,
) -> Vec<Flips> {
    let mut flips = vec![Flips::default(); engines.len()];
    let columns = area.x1 - area.x0;
    let mut clear = vec![1.0; columns * (area.y1 - area.y0)];
    let (mut expected, mut got) = (Vec::new(), Vec::new());
    for &index in order {
        let mut bounds = reference.bounds(index).intersection(&area);
        for engine in engines {
            bounds = hull(bounds, engine.bounds(index).intersection(&area));
        }
        if bounds.is_empty() {
            continue;
        }
        reference.mark(index, bounds, &mut expected);
        for (flips, engine) in flips.iter_mut().zip(engines) {
            engine.mark(index, bounds, &mut got);
            let pairs = expected.iter().zip(&got).zip(places(bounds, area));
            for ((expected, got), place) in pairs {
                let seen = clear[place] > 0.0;
                flips.added += u64::from(seen && *got && !expected);
                flips.removed += u64::from(seen && *expected && !got);
            }
        }
        for (drawn, place) in expected.iter().zip(places(bounds, area)) {
            if *drawn {
                let at = [place % columns + area.x0, place / columns + area.y0];
                clear[place] = behind(reference, index, at, clear[place]);
            }
        }
    }
    flips
}

/// What the rules leave of the light behind a splat that is drawn; 0 once the pixel is finished.
fn behind(reference: &Double, index: usize, at: [usize; 2], clear: f64) -> f64 {
    let Ok(splat) = &reference.projected[index] else {
        return clear;
    };
    let at = at.map(|x| x as f64 + 0.5);
    let opacity = compositor::opacity(splat, at, reference.rules).unwrap_or(0.0);
    let rest = clear * (1.0 - opacity);
    match rest <= reference.rules.stop {
        true => 0.0,
        false => rest,
    }
}

/// The places of the pixels of `bounds` in a tile that holds `area`.
fn places(bounds: PixelBox, area: PixelBox) -> impl Iterator<Item = usize> {
    let columns = area.x1 - area.x0;
    (bounds.y0..bounds.y1)
        .flat_map(move |y| (bounds.x0..bounds.x1).map(move |x| (x, y)))
        .map(move |(x, y)| (y - area.y0) * columns + x - area.x0)
}

/// The smallest rectangle around both.
fn hull(a: PixelBox, b: PixelBox) -> PixelBox {
    match (a.is_empty(), b.is_empty()) {
        (true, _) => b,
        (_, true) => a,
        _ => PixelBox {
            x0: a.x0.min(b.x0),
            y0: a.y0.min(b.y0),
            x1: a.x1.max(b.x1),
            y1: a.y1.max(b.y1),
        },
    }
}
