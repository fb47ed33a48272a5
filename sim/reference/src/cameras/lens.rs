//! Lenses: where they move a ray, in pixels. Pictures are drawn by pinholes; photographs are undistorted to them
//! ([`crate::texture::image::undistorted`]), or what a wider pinhole shows is bent as the lens does
//! ([`crate::texture::image::distorted`]); elsewhere the distortion is told.

use crate::camera::{Camera, MAX_SIZE};

/// What becomes of the radius of a direction (x / z, y / z) before the polynomials.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Projection {
    /// It stays.
    #[default]
    Perspective,
    /// It becomes the angle to the axis.
    Fisheye,
    /// `atan(2 r tan(w / 2)) / w` (Devernay and Faugeras).
    FieldOfView(f64),
}

/// Where a lens moves a direction: the models of COLMAP, whose parameters are OpenCV's. None by default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Distortion {
    /// What comes first.
    pub projection: Projection,
    /// Coefficients of the squared radius and its powers, after 1.
    pub radial: [f64; 4],
    /// Those of the polynomial that this one is divided by.
    pub divisor: [f64; 3],
    /// Decentring, p1 and p2.
    pub tangential: [f64; 2],
    /// A thin prism, sx1 and sy1.
    pub prism: [f64; 2],
}

impl Distortion {
    /// Where the lens moves a direction (x / z, y / z).
    pub fn apply(&self, direction: [f64; 2]) -> [f64; 2] {
        let r = direction[0].hypot(direction[1]);
        let scale = match self.projection {
            Projection::Fisheye if r > 0.0 => r.atan() / r,
            Projection::FieldOfView(width) if r > 0.0 && width != 0.0 => {
                (2.0 * r * (0.5 * width).tan()).atan() / width / r
            }
            _ => 1.0,
        };
        let [x, y] = direction.map(|part| part * scale);
        let rr = x * x + y * y;
        let [k1, k2, k3, k4] = self.radial;
        let [d1, d2, d3] = self.divisor;
        let above = 1.0 + rr * (k1 + rr * (k2 + rr * (k3 + rr * k4)));
        let radial = above / (1.0 + rr * (d1 + rr * (d2 + rr * d3)));
        let ([p1, p2], [sx, sy]) = (self.tangential, self.prism);
        [
            x * radial + 2.0 * p1 * x * y + p2 * (rr + 2.0 * x * x) + sx * rr,
            y * radial + p1 * (rr + 2.0 * y * y) + 2.0 * p2 * x * y + sy * rr,
        ]
    }
}

/// Steps of Newton's method at most.
const MOST_STEPS: usize = 50;
/// How close it comes, focal lengths.
const CLOSE: f64 = 1e-12;
/// Step of its differences.
const DIFFERENCE: f64 = 1e-7;
/// Largest angle to the axis that it begins with.
const MOST_ANGLE: f64 = 1.5;

/// A lens with its sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// Columns and rows of its photographs.
    pub size: [u64; 2],
    /// Focal lengths, pixels.
    pub focal: [f64; 2],
    /// Principal point, pixels.
    pub principal: [f64; 2],
    /// How it bends.
    pub distortion: Distortion,
}

impl Lens {
    /// The pixel that a direction (x / z, y / z) is seen at.
    pub fn pixel(&self, direction: [f64; 2]) -> [f64; 2] {
        let bent = self.distortion.apply(direction);
        [0, 1].map(|axis: usize| self.focal[axis] * bent[axis] + self.principal[axis])
    }

    /// The direction that is seen at a pixel, by Newton's method; nothing where the lens shows no direction.
    pub fn direction(&self, pixel: [f64; 2]) -> Option<[f64; 2]> {
        let sought = self.pinhole_direction(pixel);
        let angle = sought[0].hypot(sought[1]);
        let mut found = match self.distortion.projection {
            // Without the polynomial the radius is an angle.
            Projection::Fisheye if angle > 0.0 => {
                sought.map(|x| x * (angle.min(MOST_ANGLE).tan() / angle))
            }
            _ => sought,
        };
        for _ in 0..MOST_STEPS {
            let seen = self.distortion.apply(found);
            let off = [seen[0] - sought[0], seen[1] - sought[1]];
            if off[0].hypot(off[1]) < CLOSE {
                return Some(found);
            }
            let step = DIFFERENCE * (1.0 + found[0].hypot(found[1]));
            let slope = |axis: usize| {
                let mut beside = found;
                beside[axis] += step;
                let beside = self.distortion.apply(beside);
                [0, 1].map(|k: usize| (beside[k] - seen[k]) / step)
            };
            let [a, b] = [slope(0), slope(1)];
            let determinant = a[0] * b[1] - b[0] * a[1];
            // Beyond the fold of a polynomial there is nothing to be seen.
            if determinant <= 0.0 || !determinant.is_finite() {
                return None;
            }
            found[0] -= (b[1] * off[0] - b[0] * off[1]) / determinant;
            found[1] -= (a[0] * off[1] - a[1] * off[0]) / determinant;
        }
        None
    }

    /// The pinhole that sees all that this lens shows of a camera's picture, with as many pixels to a focal length in
    /// the middle.
    pub fn pinhole(&self, camera: &Camera) -> Option<Camera> {
        let lens = self.resized([camera.width, camera.height]);
        let mut ends = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        for y in 0..camera.height {
            for x in 0..camera.width {
                let Some(seen) = lens.direction([x, y].map(|place| place as f64 + 0.5)) else {
                    continue;
                };
                for axis in 0..2 {
                    ends[axis] = [ends[axis][0].min(seen[axis]), ends[axis][1].max(seen[axis])];
                }
            }
        }
        let focal = [camera.fx, camera.fy];
        // A pixel beyond either end, for the interpolation.
        let before = [0, 1].map(|axis: usize| (-ends[axis][0] * focal[axis]).ceil() + 1.0);
        let after = [0, 1].map(|axis: usize| (ends[axis][1] * focal[axis]).ceil() + 1.0);
        let size = [0, 1].map(|axis: usize| before[axis] + after[axis]);
        size.iter()
            .all(|side| (1.0..=MAX_SIZE as f64).contains(side))
            .then(|| Camera {
                width: size[0] as usize,
                height: size[1] as usize,
                cx: before[0],
                cy: before[1],
                ..camera.clone()
            })
    }

    /// The lens of the same photographs in another size.
    pub fn resized(&self, size: [usize; 2]) -> Lens {
        let scale = [0, 1].map(|axis: usize| size[axis] as f64 / self.size[axis] as f64);
        Lens {
            size: size.map(|side| side as u64),
            focal: [0, 1].map(|axis: usize| self.focal[axis] * scale[axis]),
            principal: [0, 1].map(|axis: usize| self.principal[axis] * scale[axis]),
            ..*self
        }
    }

    /// The direction that the pinhole of the same numbers sees at a pixel.
    pub fn pinhole_direction(&self, pixel: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|axis: usize| (pixel[axis] - self.principal[axis]) / self.focal[axis])
    }

    /// A sentence about the largest displacement among the picture's corners, or nothing without distortion.
    pub(super) fn note(&self) -> Option<String> {
        if self.distortion == Distortion::default() {
            return None;
        }
        let [width, height] = self.size.map(|side| side as f64);
        let corners = [[0.0, 0.0], [width, 0.0], [0.0, height], [width, height]];
        let moved = corners.map(|corner| {
            let seen = self.pixel(self.pinhole_direction(corner));
            (seen[0] - corner[0]).hypot(seen[1] - corner[1])
        });
        let most = moved.into_iter().fold(0.0, f64::max);
        Some(format!(
            "lens distortion of up to {most:.1} pixels at the corners is drawn by render --distort alone; compare --photos undistorts the photographs"
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::super::colmap;
    use super::*;

    #[test]
    fn the_displacement_is_in_pixels() {
        let barrel = Lens {
            size: [200, 200],
            focal: [100.0; 2],
            principal: [100.0; 2],
            distortion: Distortion {
                radial: [0.1, 0.0, 0.0, 0.0],
                ..Distortion::default()
            },
        };
        // The corner lies at (1, 1): the radius grows by 0.1 * 2 of sqrt(2) * 100 pixels.
        let note = barrel.note().unwrap();
        assert!(note.contains("up to 28.3 pixels"), "{note}");
        let straight = Lens {
            distortion: Distortion::default(),
            ..barrel
        };
        assert_eq!(straight.note(), None);
    }

    /// Made by `assets/lenses.py`: rays and their pixels by COLMAP's own code, 0.01 pixels.
    #[test]
    fn rays_are_seen_where_colmap_sees_them() {
        let mut compared = 0;
        let table = include_str!("../../assets/lenses.tsv");
        for line in table.lines().filter(|line| !line.starts_with('#')) {
            let fields: Vec<&str> = line.split('\t').collect();
            let [model, parameters, ref numbers @ ..] = fields[..] else {
                panic!("{line}")
            };
            let camera = format!("1 {model} 1280 720 {parameters}");
            let numbers: Vec<f64> = numbers.iter().map(|n| n.parse().unwrap()).collect();
            let (_, lens) = colmap::text_camera(&camera).unwrap();
            let [u, v] = lens.pixel([numbers[0], numbers[1]]);
            let apart = (u - numbers[2]).hypot(v - numbers[3]);
            assert!(apart < 0.01, "{line}: {u} {v}");
            let [x, y] = lens.direction([numbers[2], numbers[3]]).unwrap();
            let apart = (x - numbers[0]).hypot(y - numbers[1]) * 900.0;
            assert!(apart < 0.01, "{line}: {x} {y}");
            compared += 1;
        }
        assert_eq!(compared, 45);
    }
}
