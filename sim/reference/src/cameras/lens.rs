//! What lens distortion would do, in pixels: said, since it is not drawn.

/// Coefficients of the common polynomial model (OpenCV's names).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Distortion {
    /// k1 to k6; the last three are the denominator's.
    pub(super) radial: [f64; 6],
    /// p1 and p2.
    pub(super) tangential: [f64; 2],
}

impl Distortion {
    /// Where the lens moves a direction (x / z, y / z).
    fn apply(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [k1, k2, k3, k4, k5, k6] = self.radial;
        let [p1, p2] = self.tangential;
        let rr = x * x + y * y;
        let above = 1.0 + rr * (k1 + rr * (k2 + rr * k3));
        let below = 1.0 + rr * (k4 + rr * (k5 + rr * k6));
        let radial = above / below;
        [
            x * radial + 2.0 * p1 * x * y + p2 * (rr + 2.0 * x * x),
            y * radial + p1 * (rr + 2.0 * y * y) + 2.0 * p2 * x * y,
        ]
    }

    /// A sentence about the largest displacement among the picture's corners, or nothing without distortion.
    pub(super) fn note(
        &self,
        [width, height]: [u64; 2],
        focal: [f64; 2],
        principal: [f64; 2],
    ) -> Option<String> {
        if *self == Distortion::default() {
            return None;
        }
        let corners = [[0, 0], [width, 0], [0, height], [width, height]];
        let moved = corners.map(|corner| {
            let ray: [f64; 2] =
                std::array::from_fn(|axis| (corner[axis] as f64 - principal[axis]) / focal[axis]);
            let bent = self.apply(ray);
            ((bent[0] - ray[0]) * focal[0]).hypot((bent[1] - ray[1]) * focal[1])
        });
        let most = moved.into_iter().fold(0.0, f64::max);
        Some(format!(
            "lens distortion of up to {most:.1} pixels at the corners is not drawn; compare with undistorted photographs"
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_displacement_is_in_pixels() {
        let barrel = Distortion {
            radial: [0.1, 0.0, 0.0, 0.0, 0.0, 0.0],
            ..Distortion::default()
        };
        // The corner lies at (1, 1): the radius grows by 0.1 * 2 of sqrt(2) * 100 pixels.
        let note = barrel.note([200, 200], [100.0; 2], [100.0; 2]).unwrap();
        assert!(note.contains("up to 28.3 pixels"), "{note}");
        assert_eq!(Distortion::default().note([2, 2], [1.0; 2], [1.0; 2]), None);
    }
}
