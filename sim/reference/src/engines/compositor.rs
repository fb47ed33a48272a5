//! Order and blending, shared by both engines of the reference.
//!
//! Splats are ordered by the place that their engine gave them, ties by index, and blended pixel by pixel (EWA 4.1
//! "every-sample" compositing; X-ray: SWAN 3.1). The picture is cut into bands of rows that rayon draws side by side: a
//! band goes through its splats in order and skips the rest once every pixel is finished. Only speed depends on the
//! cutting: a pixel meets its splats in the same order as in a loop over all of them.

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

use super::{Counts, Culled, FloatDrawing, PixelBox, in_bands};
use crate::camera::Camera;
use crate::picture::Picture;
use crate::rules::{Compositing, Rules};
use crate::scene::{Scene, Splat};

/// Told the rows done and the rows in all, from any thread.
pub type RowProgress<'a> = &'a (dyn Fn(usize, usize) + Sync);

/// What every splat on the screen has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OnScreen {
    /// Pixels outside of which it leaves no trace.
    pub bounds: PixelBox,
    /// What it is sorted by, the least first.
    pub place: f64,
    /// Linear RGB.
    pub colour: [f64; 3],
}

/// A splat on the screen, as the compositor needs it.
pub trait ScreenSplat: Send + Sync {
    /// Where it is seen.
    fn on_screen(&self) -> OnScreen;

    /// Radial index r and peak opacity at a point of the picture, in pixels.
    fn radial_index_and_peak(&self, point: [f64; 2]) -> (f64, f64);

    /// The columns `x0 <= x < x1` outside of which the splat leaves no trace on the row at height `y`.
    fn row_span(&self, y: f64) -> (usize, usize) {
        let _ = y;
        let bounds = self.on_screen().bounds;
        (bounds.x0, bounds.x1)
    }
}

/// Indices of the splats that were not culled: nearest first, equal places in the order of their indices.
pub fn order<S: ScreenSplat>(projected: &[Result<S, Culled>]) -> Vec<usize> {
    let drawn = projected.iter().enumerate().filter_map(|(index, outcome)| {
        let splat = outcome.as_ref().ok()?;
        Some((splat.on_screen().place, index))
    });
    let mut ordered: Vec<(f64, usize)> = drawn.collect();
    ordered.par_sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    ordered.into_iter().map(|(_, index)| index).collect()
}

/// The opacity of a splat at a point of the picture, or nothing where the rules leave it out.
pub fn opacity(splat: &impl ScreenSplat, point: [f64; 2], rules: &Rules) -> Option<f64> {
    let (radial_index, peak) = splat.radial_index_and_peak(point);
    let opacity = rules.alpha_max.min(peak * rules.kernel.at(radial_index));
    // Written so that a NaN, which f64::min would turn into alpha_max, is left out.
    let inside = radial_index < rules.cutoff && peak > 0.0;
    (inside && opacity > 0.0 && opacity >= rules.alpha_min).then_some(opacity)
}

/// Calls `see` with the column, row and centre of every pixel of an area on which a splat may leave a trace.
pub fn for_each_pixel(
    splat: &impl ScreenSplat,
    area: PixelBox,
    mut see: impl FnMut(usize, usize, [f64; 2]),
) {
    let inside = area.intersection(&splat.on_screen().bounds);
    for y in inside.y0..inside.y1 {
        let centre_y = y as f64 + 0.5;
        let (x0, x1) = splat.row_span(centre_y);
        for x in inside.x0.max(x0)..inside.x1.min(x1) {
            see(x, y, [x as f64 + 0.5, centre_y]);
        }
    }
}

/// Projects every splat of the scene with the weight that the rules need and the colour that the camera sees, in the
/// scene's order.
pub fn project_all<Footprint: Send>(
    scene: &Scene,
    camera: &Camera,
    rules: &Rules,
    project: impl Fn(&Splat) -> Result<Footprint, Culled> + Sync + Send,
) -> Vec<Result<Footprint, Culled>> {
    let (weights, colours) = (scene.weights_for(rules), scene.colours(camera));
    let splats = scene.splats.par_iter().zip(weights).zip(colours);
    let seen = splats.map(|((splat, weight), colour)| Splat {
        weight,
        colour,
        ..*splat
    });
    seen.map(|splat| project(&splat)).collect()
}

/// Draws projected splats.
pub fn draw<S: ScreenSplat>(
    projected: &[Result<S, Culled>],
    camera: &Camera,
    rules: &Rules,
    compositing: Compositing,
    progress: RowProgress,
) -> FloatDrawing {
    let mut counts = Counts::of_projected(projected);
    let mut picture = Picture::new(camera.width, camera.height);
    let mut ordered: Vec<&S> = order(projected)
        .iter()
        .filter_map(|&i| projected[i].as_ref().ok())
        .collect();
    if compositing == Compositing::BackToFront {
        ordered.reverse();
    }
    let rows_done = AtomicUsize::new(0);
    counts.covered_pixels = in_bands(&mut picture.pixels, camera.width, |band, pixels| {
        let covered = draw_band(&ordered, band, pixels, rules, compositing);
        let rows = band.y1 - band.y0;
        let before = rows_done.fetch_add(rows, Ordering::Relaxed);
        progress(before + rows, camera.height);
        covered
    });
    FloatDrawing { picture, counts }
}

/// Draws a band of rows into its part of the picture; returns the pairs of splat and pixel blended.
fn draw_band<S: ScreenSplat>(
    ordered: &[&S],
    band: PixelBox,
    pixels: &mut [[f64; 4]],
    rules: &Rules,
    compositing: Compositing,
) -> u64 {
    let mut gathered = vec![BandPixel::EMPTY; pixels.len()];
    let (mut covered, mut unfinished) = (0, gathered.len());
    for splat in ordered {
        if unfinished == 0 {
            break;
        }
        let colour = splat.on_screen().colour;
        for_each_pixel(*splat, band, |x, y, centre| {
            let pixel = &mut gathered[(y - band.y0) * band.x1 + x];
            if pixel.finished {
                return;
            }
            if let Some(opacity) = opacity(*splat, centre, rules) {
                covered += u64::from(pixel.add(opacity, colour, rules, compositing));
                unfinished -= usize::from(pixel.finished);
            }
        });
    }
    for (target, pixel) in pixels.iter_mut().zip(&gathered) {
        *target = pixel.output(compositing);
    }
    covered
}

/// A pixel that is being gathered.
#[derive(Clone, Copy)]
struct BandPixel {
    /// Premultiplied colour so far.
    colour: [f64; 3],
    /// Product of 1 - opacity so far.
    transmittance: f64,
    /// Sum of the opacities so far, for X-ray.
    opacity_sum: f64,
    /// Whether later splats are skipped.
    finished: bool,
}

impl BandPixel {
    const EMPTY: BandPixel = BandPixel {
        colour: [0.0; 3],
        transmittance: 1.0,
        opacity_sum: 0.0,
        finished: false,
    };

    /// Gathers one splat; returns whether it was blended.
    fn add(
        &mut self,
        opacity: f64,
        colour: [f64; 3],
        rules: &Rules,
        compositing: Compositing,
    ) -> bool {
        let next = self.transmittance * (1.0 - opacity);
        let (kept, share) = match compositing {
            Compositing::FrontToBack => {
                self.finished = next <= rules.minimum_transmittance;
                if self.finished && rules.omit_finishing {
                    return false;
                }
                (1.0, self.transmittance * opacity)
            }
            Compositing::BackToFront => (1.0 - opacity, opacity),
            Compositing::XRay => (1.0, opacity),
        };
        for (sum, channel) in self.colour.iter_mut().zip(colour) {
            *sum = *sum * kept + share * channel;
        }
        self.transmittance = next;
        self.opacity_sum += opacity;
        true
    }

    /// RGBA as the picture holds it.
    fn output(&self, compositing: Compositing) -> [f64; 4] {
        let [r, g, b] = self.colour;
        match compositing {
            Compositing::XRay => [r, g, b, self.opacity_sum].map(|sum| sum.min(1.0)),
            _ => [r, g, b, 1.0 - self.transmittance],
        }
    }
}
