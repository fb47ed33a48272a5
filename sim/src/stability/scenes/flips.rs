//! Decisions by threshold: which pairs of a splat and a pixel an engine draws and the reference does not, and the
//! reverse, and which pixels it finishes sooner or later.
//!
//! Every decision is made by the engine's own code. For the smallest opacity a splat is drawn alone on empty pixels;
//! for the stop at the smallest transmittance the splats are drawn on top of each other, in the true order. Pairs
//! behind a pixel that the reference has finished do not count, since no picture shows them.

use crate::camera::Camera;
use crate::design::DesignChoice;
use crate::fixed::{TableMemory, kernel_rules, whole};
use crate::reference::compositor;
use crate::reference::float::Footprint as Exact;
use crate::reference::{Culled, PixelBox};
use crate::rules::Rules;
use crate::stability::single::SingleFootprint;
use splatline::blend::Pixel;
use splatline::footprint::Footprint;
use splatline::raster::Window;
use splatline::rules::Compositing;
use splatline::setup::Cull;

/// Decisions otherwise than by the reference.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct Flips {
    /// Pairs drawn by the engine alone.
    pub added: u64,
    /// Pairs drawn by the reference alone.
    pub removed: u64,
    /// Pixels finished by an earlier splat than the reference's.
    pub early: u64,
    /// Pixels finished by a later splat, or never.
    pub late: u64,
}

/// An engine's decisions over a picture.
#[derive(Clone, Debug)]
pub(super) struct Decisions {
    pub flips: Flips,
    /// Pixels of which one was decided otherwise, row by row.
    pub pixels: Vec<bool>,
}

/// An engine that says where a splat is drawn.
pub(super) trait DecisionEngine: Sync {
    /// The pixels outside of which splat `index` is not drawn.
    fn bounds(&self, index: usize) -> Window;

    /// Who draws on the pixels of `area`, which are empty yet.
    fn start(&self, area: Window) -> DrawSplat<'_>;
}

/// Draws a splat by its number within bounds, and tells what becomes of each of those pixels, row by row.
pub(super) type DrawSplat<'a> = Box<dyn FnMut(usize, Window) -> Vec<Decided> + 'a>;

/// What becomes of a pixel.
pub(super) struct Decided {
    /// Would the splat be drawn if alone?
    drawn: bool,
    /// Does the pixel take no more splats?
    finished: bool,
}

/// An engine in floating point, which computes what a layer leaves of the light in its own precision.
pub(super) struct FloatSide<'a> {
    /// None of a splat that is not drawn.
    bounds: Box<dyn Fn(usize) -> Option<PixelBox> + Sync + 'a>,
    /// Of a splat at a pixel; none where it is not drawn.
    opacity: Box<dyn Fn(usize, [u16; 2]) -> Option<f64> + Sync + 'a>,
    behind: fn(f64, f64) -> f64,
    stop: f64,
}

/// Double precision.
pub(super) fn double<'a>(
    projected: &'a [Result<Exact, Culled>],
    rules: &'a Rules,
) -> FloatSide<'a> {
    let splat = |index: usize| projected[index].as_ref().ok();
    FloatSide {
        bounds: Box::new(move |index| Some(splat(index)?.bounds)),
        opacity: Box::new(move |index, at| {
            compositor::opacity(splat(index)?, at.map(|at| f64::from(at) + 0.5), rules)
        }),
        behind: |clear, alpha| clear * (1.0 - alpha),
        stop: rules.minimum_transmittance,
    }
}

/// Single precision.
pub(super) fn single<'a>(
    projected: &'a [Option<SingleFootprint>],
    camera: &'a Camera,
    rules: &'a Rules,
) -> FloatSide<'a> {
    let splat = |index: usize| projected[index].as_ref();
    FloatSide {
        bounds: Box::new(move |index| Some(splat(index)?.bounds(camera, rules))),
        opacity: Box::new(move |index, at| {
            let [x, y] = at.map(|at| f32::from(at) + 0.5);
            let opacity = splat(index)?.opacity(x, y, rules);
            (opacity > 0.0).then_some(opacity.into())
        }),
        behind: |clear, alpha| (clear as f32 * (1.0 - alpha as f32)).into(),
        stop: (rules.minimum_transmittance as f32).into(),
    }
}

impl DecisionEngine for FloatSide<'_> {
    fn bounds(&self, index: usize) -> Window {
        let PixelBox { x0, y0, x1, y1 } = (self.bounds)(index).unwrap_or_default();
        Window {
            first: [x0, y0].map(|at| at as u16),
            end: [x1, y1].map(|at| at as u16),
        }
    }

    fn start(&self, area: Window) -> DrawSplat<'_> {
        let columns = usize::from(area.columns());
        // The light that is left, 0 once finished.
        let mut clear = vec![1.0; area.pixels()];
        Box::new(move |index, bounds| {
            let decide = |place: usize| {
                let [x, y] = [place % columns, place / columns].map(|at| at as u16);
                let at = [x + area.first[0], y + area.first[1]];
                let opacity = (self.opacity)(index, at);
                if let Some(opacity) = opacity {
                    let rest = (self.behind)(clear[place], opacity);
                    clear[place] = if rest <= self.stop { 0.0 } else { rest };
                }
                Decided {
                    drawn: opacity.is_some(),
                    finished: clear[place] == 0.0,
                }
            };
            places(bounds, area).map(decide).collect()
        })
    }
}

/// The kernel under a design.
pub(super) struct FixedSide<'a> {
    footprints: &'a [Result<Footprint, Cull>],
    design: &'a DesignChoice,
    table: TableMemory,
}

impl<'a> FixedSide<'a> {
    pub fn new(
        footprints: &'a [Result<Footprint, Cull>],
        design: &'a DesignChoice,
        rules: &Rules,
    ) -> Self {
        FixedSide {
            footprints,
            design,
            table: TableMemory::new(&design.widths, &kernel_rules(rules)),
        }
    }

    /// One splat by the kernel's painter.
    fn draw(&self, footprint: &Footprint, area: Window, pixels: &mut [Pixel]) {
        let (design, order) = (self.design.in_fields(), Compositing::FrontToBack);
        let painter = self.table.painter(design, order, self.design.traversal);
        painter.draw(footprint, &mut whole(pixels, area));
    }
}

impl DecisionEngine for FixedSide<'_> {
    fn bounds(&self, index: usize) -> Window {
        self.footprints[index].as_ref().map_or(EMPTY, Window::of)
    }

    fn start(&self, area: Window) -> DrawSplat<'_> {
        let clear = Pixel::clear(&self.design.widths);
        let mut pixels = vec![clear; area.pixels()];
        Box::new(move |index, bounds| {
            let mut alone = vec![clear; bounds.pixels()];
            if let Ok(footprint) = &self.footprints[index] {
                self.draw(footprint, bounds, &mut alone);
                self.draw(footprint, area, &mut pixels);
            }
            let decided = |(place, alone): (usize, &Pixel)| Decided {
                drawn: *alone != clear,
                finished: pixels[place].is_finished(),
            };
            places(bounds, area).zip(&alone).map(decided).collect()
        })
    }
}

/// An engine's decisions against the reference's; `order` lists all splats, nearest first.
pub(super) fn count(
    reference: &dyn DecisionEngine,
    engine: &dyn DecisionEngine,
    order: &[usize],
    camera: &Camera,
) -> Decisions {
    let area = Window {
        first: [0; 2],
        end: [camera.width as u16, camera.height as u16],
    };
    let mut flips = Flips::default();
    let mut pixels = vec![false; area.pixels()];
    // Whether the reference has finished a pixel before the splat at hand.
    let mut finished = pixels.clone();
    // The stop was decided otherwise, and has been counted.
    let mut stopped = pixels.clone();
    let (mut truth, mut draw) = (reference.start(area), engine.start(area));
    for &index in order {
        let [own, other] = [reference, engine].map(|of| of.bounds(index).intersect(&area));
        let bounds = hull(own, other);
        if bounds.is_empty() {
            continue;
        }
        let decided = truth(index, bounds).into_iter().zip(draw(index, bounds));
        for (place, (expected, got)) in places(bounds, area).zip(decided) {
            if finished[place] {
                continue;
            }
            flips.added += u64::from(got.drawn && !expected.drawn);
            flips.removed += u64::from(expected.drawn && !got.drawn);
            pixels[place] |= expected.drawn != got.drawn;
            if !stopped[place] {
                flips.early += u64::from(got.finished && !expected.finished);
                flips.late += u64::from(expected.finished && !got.finished);
                stopped[place] = expected.finished != got.finished;
                pixels[place] |= stopped[place];
            }
            finished[place] = expected.finished;
        }
    }
    Decisions { flips, pixels }
}

/// No pixel.
const EMPTY: Window = Window {
    first: [0; 2],
    end: [0; 2],
};

/// The places of the pixels of `bounds` in a tile that holds `area`.
fn places(bounds: Window, area: Window) -> impl Iterator<Item = usize> {
    let columns = usize::from(area.columns());
    let from = |axis: usize| usize::from(bounds.first[axis] - area.first[axis]);
    let (left, top) = (from(0), from(1));
    let rows = top..top + usize::from(bounds.rows());
    let row = left..left + usize::from(bounds.columns());
    rows.flat_map(move |y| row.clone().map(move |x| y * columns + x))
}

/// The smallest rectangle around both.
fn hull(a: Window, b: Window) -> Window {
    match (a.is_empty(), b.is_empty()) {
        (true, _) => b,
        (_, true) => a,
        _ => Window {
            first: [0, 1].map(|axis| a.first[axis].min(b.first[axis])),
            end: [0, 1].map(|axis| a.end[axis].max(b.end[axis])),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::super::classes::{self, Size};
    use super::*;
    use crate::reference::float;

    const RULES: Rules = Rules::GAUSSIAN_3D;

    /// Decisions of the reference under other rules, against the reference.
    fn under(rules: Rules) -> (Flips, usize) {
        let class = &classes::all(Size::QUICK, 3)[0];
        let project = |rules| float::footprints(&class.scene, &class.camera, rules);
        let (truth, other) = (project(&RULES), project(&rules));
        let order: Vec<usize> = compositor::order(&truth);
        let engine = double(&other, &rules);
        let decisions = count(&double(&truth, &RULES), &engine, &order, &class.camera);
        let flipped = decisions.pixels.iter().filter(|flipped| **flipped);
        (decisions.flips, flipped.count())
    }

    #[test]
    fn an_engine_agrees_with_itself() {
        assert_eq!(under(RULES), (Flips::default(), 0));
    }

    #[test]
    fn another_threshold_flips_to_one_side() {
        let moved = |factor: f64| Rules {
            alpha_min: RULES.alpha_min * factor,
            ..RULES
        };
        let (lower, pixels) = under(moved(0.9));
        assert!(lower.added > 100 && lower.removed == 0, "{lower:?}");
        assert!(pixels > 100 && pixels as u64 <= lower.added, "{pixels}");
        let (higher, _) = under(moved(1.1));
        assert!(higher.removed > 100 && higher.added == 0, "{higher:?}");
    }

    #[test]
    fn another_stop_finishes_pixels_sooner_or_later() {
        let [sooner, later] = [0.5, 0.0].map(|minimum_transmittance| {
            let rules = Rules {
                minimum_transmittance,
                ..RULES
            };
            under(rules).0
        });
        assert!(sooner.early > 10 && sooner.late == 0, "{sooner:?}");
        assert_eq!((sooner.added, sooner.removed), (0, 0));
        assert_eq!(later.early, 0, "{later:?}");
    }
}
