//! What a pixel gathers beside its colour: depths, normals, counts, and which splats it is made of.
//!
//! With w = transmittance times opacity of a splat at the pixel, front to back as the rules say:
//!
//! - depth: accumulated (sum of w z), normalised (that by the sum of w), and median (z of the splat that brings the
//!   transmittance to 1/2 or less);
//! - normal: sum of w n, of length 1, n being the shortest axis in camera space, turned to the eye;
//! - count: splats that were blended, and those that were looked up before the pixel was finished: inside the row's
//!   span, however faint;
//! - first: the first splat that was blended; id: the one of the largest w. Both are numbers in the scene's order, -1
//!   without any.

use super::compositor::{for_each_pixel, opacity, order};
use super::{float, in_bands};
use crate::camera::Camera;
use crate::rules::Rules;
use crate::scene::{Scene, Splat};
use crate::vector::{self, Vector};

/// One pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapPixel {
    /// 1 - transmittance.
    pub alpha: f64,
    /// Sum of w z.
    pub accumulated_depth: f64,
    /// z of the splat that brought the transmittance to 1/2; 0 if none did.
    pub median_depth: f64,
    /// Sum of w n.
    pub normal: Vector,
    /// Splats that were blended.
    pub blended: u32,
    /// Splats that were looked up.
    pub visited: u32,
    /// The first that was blended.
    pub first: Option<usize>,
    /// The one that contributes most.
    pub largest: Option<usize>,
    transmittance: f64,
    most: f64,
    finished: bool,
}

impl MapPixel {
    /// Of nothing.
    pub const EMPTY: MapPixel = MapPixel {
        alpha: 0.0,
        accumulated_depth: 0.0,
        median_depth: 0.0,
        normal: [0.0; 3],
        blended: 0,
        visited: 0,
        first: None,
        largest: None,
        transmittance: 1.0,
        most: 0.0,
        finished: false,
    };

    /// The depth over what covers the pixel; 0 of nothing.
    pub fn normalised_depth(&self) -> f64 {
        if self.alpha > 0.0 {
            self.accumulated_depth / self.alpha
        } else {
            0.0
        }
    }

    fn add(&mut self, opacity: f64, place: (f64, Vector), index: usize, rules: &Rules) {
        let next = self.transmittance * (1.0 - opacity);
        self.finished = next <= rules.minimum_transmittance;
        if !(self.finished && rules.omit_finishing) {
            self.blend(self.transmittance * opacity, next, place, index);
        }
    }

    /// A splat of this weight, depth and normal, and the transmittance that it leaves.
    pub fn blend(&mut self, weight: f64, next: f64, (depth, normal): (f64, Vector), index: usize) {
        self.accumulated_depth += weight * depth;
        self.normal = vector::add(self.normal, vector::scale(weight, normal));
        if self.transmittance > 0.5 && next <= 0.5 {
            self.median_depth = depth;
        }
        self.blended += 1;
        self.first = self.first.or(Some(index));
        if weight > self.most {
            (self.most, self.largest) = (weight, Some(index));
        }
        self.transmittance = next;
        self.alpha = 1.0 - next;
    }
}

/// All pixels, row by row; the caller's rayon pool decides the number of threads.
pub fn draw(scene: &Scene, camera: &Camera, rules: &Rules) -> Vec<MapPixel> {
    let projected = float::footprints(scene, camera, rules);
    let ordered: Vec<(usize, &float::Footprint, Vector)> = order(&projected)
        .into_iter()
        .filter_map(|index| {
            let footprint = projected[index].as_ref().ok()?;
            let (_, normal) = depth_and_normal(&scene.splats[index], camera);
            Some((index, footprint, normal))
        })
        .collect();
    let width = camera.width;
    let mut pixels = vec![MapPixel::EMPTY; width * camera.height];
    in_bands(&mut pixels, width, |rows, pixels| {
        for (index, footprint, normal) in &ordered {
            for_each_pixel(*footprint, rows, |x, y, centre| {
                let pixel = &mut pixels[(y - rows.y0) * width + x];
                if pixel.finished {
                    return;
                }
                pixel.visited += 1;
                if let Some(opacity) = opacity(*footprint, centre, rules) {
                    pixel.add(opacity, (footprint.depth, *normal), *index, rules);
                }
            });
        }
        0
    });
    pixels
}

/// A splat's depth, and its normal where maps take it from.
pub fn depth_and_normal(splat: &Splat, camera: &Camera) -> (f64, Vector) {
    (camera.to_camera(splat.centre)[2], normal(splat, camera))
}

/// The direction in camera space in which a splat is thinnest, turned to the eye.
fn normal(splat: &Splat, camera: &Camera) -> Vector {
    let [a, b, c] = splat.axes;
    // A flat one has no third axis: across the other two.
    let shortest = [a, b, c]
        .into_iter()
        .min_by(|a, b| vector::length(*a).total_cmp(&vector::length(*b)))
        .filter(|axis| vector::length(*axis) > 0.0)
        .unwrap_or_else(|| vector::cross(a, b));
    let turned = vector::transform(&camera.rotation, shortest);
    let length = vector::length(turned);
    if length == 0.0 || !length.is_finite() {
        return [0.0; 3];
    }
    let unit = vector::scale(1.0 / length, turned);
    let towards = vector::dot(unit, camera.ray(camera.to_camera(splat.centre)));
    vector::scale(if towards > 0.0 { -1.0 } else { 1.0 }, unit)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rules::Compositing;
    use crate::scene::synthetic;

    /// Alpha is the picture's own, counts are its counts, and depths lie between those of the nearest and the farthest
    /// splat.
    #[test]
    fn maps_are_of_the_picture() {
        let scene = synthetic::random_gaussians(300, 4, 3.0);
        let camera = synthetic::camera(50, 37);
        let rules = Rules::GAUSSIAN_3D;
        let pixels = draw(&scene, &camera, &rules);
        let drawing = float::draw(&scene, &camera, &rules, Compositing::FrontToBack);
        for (pixel, expected) in pixels.iter().zip(&drawing.picture.pixels) {
            assert!((pixel.alpha - expected[3]).abs() < 1e-12);
            assert!(pixel.visited >= pixel.blended);
            assert_eq!(
                pixel.blended > 0,
                pixel.first.is_some() && pixel.largest.is_some()
            );
        }
        let blended: u64 = pixels.iter().map(|pixel| u64::from(pixel.blended)).sum();
        assert_eq!(blended, drawing.counts.covered_pixels);
        let depths = scene
            .splats
            .iter()
            .map(|splat| camera.to_camera(splat.centre)[2]);
        let [least, most] = depths.fold([f64::MAX, 0.0], |[l, m], z| [l.min(z), m.max(z)]);
        for pixel in pixels.iter().filter(|pixel| pixel.alpha > 0.0) {
            let depth = pixel.normalised_depth();
            assert!(depth >= least.min(camera.near) && depth <= most);
            let length = vector::length(pixel.normal);
            assert!(length <= pixel.alpha + 1e-12 && pixel.normal[2] < 1.0);
        }
    }

    /// Two discs behind each other, by hand: weights 0.6 and 0.4 * 0.9.
    #[test]
    fn two_splats_by_hand() {
        let mut scene = synthetic::random_gaussians(2, 1, 1.0);
        let camera = synthetic::camera(9, 9);
        let ray = |depth: f64| {
            let place = [0.0, 0.0, depth];
            let moved = vector::subtract(place, camera.translation);
            [0, 1, 2].map(|k: usize| {
                (0..3)
                    .map(|row| camera.rotation[row][k] * moved[row])
                    .sum::<f64>()
            })
        };
        for (splat, (depth, weight)) in scene.splats.iter_mut().zip([(4.0, 0.9), (2.0, 0.6)]) {
            splat.centre = ray(depth);
            splat.axes = [[50.0, 0.0, 0.0], [0.0, 50.0, 0.0], [0.0, 0.0, 1e-3]];
            splat.weight = weight;
        }
        scene.harmonics = None;
        let rules = Rules {
            alpha_max: 1.0,
            low_pass: 0.0,
            ..Rules::GAUSSIAN_3D
        };
        let pixel = draw(&scene, &camera, &rules)[4 * 9 + 4];
        assert!((pixel.alpha - 0.96).abs() < 1e-3, "{pixel:?}");
        assert!((pixel.accumulated_depth - (0.6 * 2.0 + 0.36 * 4.0)).abs() < 5e-3);
        assert!((pixel.median_depth - 2.0).abs() < 1e-6);
        assert_eq!(
            (pixel.blended, pixel.first, pixel.largest),
            (2, Some(1), Some(1))
        );
        assert!(pixel.normal[2] < -0.9);
    }
}
