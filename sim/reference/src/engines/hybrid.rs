//! Points and splats in double precision (\[HYBRID\] 2 and 4), by one plain loop over fragments.
//!
//! Points have one circular footprint, the one that a spherical splat has at the distance k. With a depth range, the
//! points that a pixel meets within it are summed; the sum is composited when the next fragment lies beyond, or belongs
//! to a splat.

use super::compositor::{self, for_each_pixel, opacity};
use super::float::{self, Footprint, screen_position, visible_position};
use super::jacobian::{Jacobian, ScreenVariance};
use super::kernels::enlargement;
use super::{Counts, Culled, FloatDrawing, PixelBox};
use crate::camera::Camera;
use crate::hybrid::{Hybrid, Points, deviation};
use crate::picture::Picture;
use crate::rules::Rules;
use crate::scene::{Scene, Splat};

/// Draws front to back. The rules need a spacing and a constant cut-off.
///
/// With phase bits, the centres of points are rounded as a stamp rounds them.
pub fn draw(scene: &Scene, camera: &Camera, rules: &Rules, hybrid: &Hybrid) -> FloatDrawing {
    let area = (deviation(scene) / rules.spacing).powi(2);
    let is_point = |splat: &Splat| is_point(splat, camera, rules, hybrid.points);
    let projected = compositor::project_all(scene, camera, rules, |splat| {
        if is_point(splat) {
            point(splat, camera, rules, area, hybrid.phase_bits)
        } else {
            float::project(splat, camera, rules)
        }
    });
    let mut counts = Counts::of_projected(&projected);
    let mut cells = vec![FloatCell::EMPTY; camera.width * camera.height];
    // By the depth, whatever the scene says: points are gathered by differences of depths.
    for index in compositor::order(&projected) {
        if let Ok(footprint) = &projected[index] {
            let range = hybrid
                .depth_range
                .filter(|_| is_point(&scene.splats[index]));
            counts.covered_pixels += splat_into(&mut cells, camera, footprint, rules, range);
        }
    }
    let mut picture = Picture::new(camera.width, camera.height);
    for (out, cell) in picture.pixels.iter_mut().zip(&mut cells) {
        cell.close(rules);
        let [r, g, b] = cell.colour;
        *out = [r, g, b, 1.0 - cell.transmittance];
    }
    FloatDrawing { picture, counts }
}

/// Points are the samples beyond the distance k.
fn is_point(splat: &Splat, camera: &Camera, rules: &Rules, points: Points) -> bool {
    let depth = camera.to_camera(splat.centre)[2];
    let jacobian = Jacobian::at(camera, [0.0; 2], depth);
    match points {
        Points::All => true,
        Points::None => false,
        Points::Auto => enlargement(rules, &jacobian) > 1.0,
    }
}

/// A circle of variance `area`, square pixels, with its centre at the nearest of the stamp's phases if there are any.
fn point(
    splat: &Splat,
    camera: &Camera,
    rules: &Rules,
    area: f64,
    phase_bits: Option<u8>,
) -> Result<Footprint, Culled> {
    let position = visible_position(splat, camera)?;
    if splat.weight <= 0.0 {
        return Err(Culled::Transparent);
    }
    let half = (rules.cutoff * area).sqrt();
    let around = |centre: [f64; 2]| PixelBox::around(centre, [half; 2], camera);
    let exact = screen_position(position, camera);
    if around(exact).is_empty() {
        return Err(Culled::OutsideViewport);
    }
    let centre = match phase_bits.map(|bits| f64::from(bits).exp2()) {
        Some(phases) => exact.map(|coordinate| (coordinate * phases + 0.5).floor() / phases),
        None => exact,
    };
    let [across, down] = Jacobian::at(camera, [0.0; 2], position[2]).scale;
    let share = if rules.normalised {
        rules.kernel.circular_peak(area)
    } else {
        rules.spacing * rules.spacing
    };
    let variance = ScreenVariance {
        a: area,
        b: 0.0,
        c: area,
        determinant: area * area,
        sharp_determinant: area * area,
    };
    Ok(Footprint {
        centre,
        depth: position[2],
        place: position[2],
        variance,
        peak: splat.weight * across * down * share,
        cutoff: rules.cutoff,
        bounds: around(centre),
        colour: splat.colour,
    })
}

/// Blends one footprint into its pixels, or gathers it over a range of depths; returns how many it covered.
fn splat_into(
    cells: &mut [FloatCell],
    camera: &Camera,
    footprint: &Footprint,
    rules: &Rules,
    gathered_over: Option<f64>,
) -> u64 {
    let mut covered = 0;
    for_each_pixel(footprint, PixelBox::whole(camera), |x, y, centre| {
        let cell = &mut cells[y * camera.width + x];
        if cell.finished {
            return;
        }
        let Some(alpha) = opacity(footprint, centre, rules) else {
            return;
        };
        covered += 1;
        if let Some(range) = gathered_over {
            cell.gather(alpha, footprint, range, rules);
        } else {
            cell.close(rules);
            cell.over(alpha, footprint.colour.map(|c| c * alpha), rules);
        }
    });
    covered
}

/// A pixel with what it has gathered and not yet composited.
#[derive(Clone, Copy)]
struct FloatCell {
    colour: [f64; 3],
    transmittance: f64,
    finished: bool,
    /// Sums of opacity and of opacity times colour, and the depth of the first point.
    slab: Option<(f64, [f64; 3], f64)>,
}

impl FloatCell {
    const EMPTY: FloatCell = FloatCell {
        colour: [0.0; 3],
        transmittance: 1.0,
        finished: false,
        slab: None,
    };

    fn gather(&mut self, alpha: f64, point: &Footprint, range: f64, rules: &Rules) {
        let is_beyond = |(_, _, first)| point.depth - first > range;
        if self.slab.is_some_and(is_beyond) {
            self.close(rules);
            if self.finished {
                return;
            }
        }
        let (opacity, colour, _) = self.slab.get_or_insert((0.0, [0.0; 3], point.depth));
        *opacity += alpha;
        for (sum, channel) in colour.iter_mut().zip(point.colour) {
            *sum += alpha * channel;
        }
    }

    fn close(&mut self, rules: &Rules) {
        let Some((opacity, colour, _)) = self.slab.take() else {
            return;
        };
        let excess = opacity.max(1.0);
        self.over(opacity / excess, colour.map(|c| c / excess), rules);
    }

    /// Premultiplied colour behind what is there.
    fn over(&mut self, alpha: f64, colour: [f64; 3], rules: &Rules) {
        if self.finished {
            return;
        }
        let next = self.transmittance * (1.0 - alpha);
        self.finished = next <= rules.minimum_transmittance;
        if self.finished && rules.omit_finishing {
            return;
        }
        for (sum, channel) in self.colour.iter_mut().zip(colour) {
            *sum += self.transmittance * channel;
        }
        self.transmittance = next;
    }
}
