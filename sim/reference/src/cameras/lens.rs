//! Lenses: where they move a ray, in pixels. Pictures are drawn by pinholes; photographs are undistorted to them
//! ([`crate::texture::image::undistorted`]), and elsewhere the distortion is told.

/// Where a lens moves a direction (x / z, y / z): the models of COLMAP, whose parameters are OpenCV's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Distortion {
    /// A quotient of polynomials of the squared radius, and decentring.
    Polynomial {
        /// k1 to k6; the last three are the denominator's.
        radial: [f64; 6],
        /// p1 and p2.
        tangential: [f64; 2],
    },
    /// The radius becomes the angle to the axis; then a polynomial of its square, decentring and a thin prism.
    Fisheye {
        /// k1 to k4.
        radial: [f64; 4],
        /// p1 and p2.
        tangential: [f64; 2],
        /// sx1 and sy1.
        prism: [f64; 2],
    },
    /// `atan(2 r tan(w / 2)) / w` of the radius (Devernay and Faugeras).
    FieldOfView(f64),
}

impl Default for Distortion {
    /// None.
    fn default() -> Distortion {
        Distortion::Polynomial {
            radial: [0.0; 6],
            tangential: [0.0; 2],
        }
    }
}

impl Distortion {
    /// Where the lens moves a direction (x / z, y / z).
    pub fn apply(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let r = x.hypot(y);
        match *self {
            Distortion::Polynomial { radial, tangential } => {
                let [k1, k2, k3, k4, k5, k6] = radial;
                let rr = r * r;
                let above = 1.0 + rr * (k1 + rr * (k2 + rr * k3));
                let below = 1.0 + rr * (k4 + rr * (k5 + rr * k6));
                moved([x, y], above / below, tangential, [0.0; 2])
            }
            Distortion::Fisheye {
                radial: [k1, k2, k3, k4],
                tangential,
                prism,
            } => {
                let to_angle = if r > 0.0 { r.atan() / r } else { 1.0 };
                let angle = [x * to_angle, y * to_angle];
                let rr = angle[0] * angle[0] + angle[1] * angle[1];
                let radial = 1.0 + rr * (k1 + rr * (k2 + rr * (k3 + rr * k4)));
                moved(angle, radial, tangential, prism)
            }
            Distortion::FieldOfView(width) => {
                let bent = |r: f64| (2.0 * r * (0.5 * width).tan()).atan() / width;
                let scale = if r > 0.0 && width != 0.0 {
                    bent(r) / r
                } else {
                    1.0
                };
                [x * scale, y * scale]
            }
        }
    }
}

/// Radial scale, decentring and thin prism.
fn moved([x, y]: [f64; 2], radial: f64, [p1, p2]: [f64; 2], [sx, sy]: [f64; 2]) -> [f64; 2] {
    let rr = x * x + y * y;
    [
        x * radial + 2.0 * p1 * x * y + p2 * (rr + 2.0 * x * x) + sx * rr,
        y * radial + p1 * (rr + 2.0 * y * y) + 2.0 * p2 * x * y + sy * rr,
    ]
}

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
            "lens distortion of up to {most:.1} pixels at the corners is not drawn; compare --photos undistorts the photographs"
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
            distortion: Distortion::Polynomial {
                radial: [0.1, 0.0, 0.0, 0.0, 0.0, 0.0],
                tangential: [0.0; 2],
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
            let parameters = parameters.split(' ').map(|p| p.parse().unwrap());
            let lens = colmap::lens_of(model, [1280, 720], &parameters.collect::<Vec<_>>());
            let numbers: Vec<f64> = numbers.iter().map(|n| n.parse().unwrap()).collect();
            let [u, v] = lens.unwrap().pixel([numbers[0], numbers[1]]);
            let apart = (u - numbers[2]).hypot(v - numbers[3]);
            assert!(apart < 0.01, "{line}: {u} {v}");
            compared += 1;
        }
        assert_eq!(compared, 45);
    }
}
