//! Nodes' transforms, and what they do to spherical harmonics.
//!
//! Places and axes go through any affine map. A colour c(d) seen in direction d becomes c(R^T d): the coefficients of
//! each degree are mixed by a matrix that follows from the harmonics' own values in a few directions, so that no
//! formula for it is needed.

use super::super::error::Problem;
use super::super::gaussian::{HARMONICS, harmonic_basis, rotation_matrix};
use crate::vector;
use anyhow::bail;
use serde::Deserialize;

/// Deviation from a rotation and one scale up to which harmonics have a meaning.
const TOLERANCE: f64 = 1e-4;

/// A node's transform as the file states it.
#[derive(Deserialize)]
pub(super) struct Stated {
    /// Column by column.
    matrix: Option<[f64; 16]>,
    translation: Option<[f64; 3]>,
    /// x, y, z, w.
    rotation: Option<[f64; 4]>,
    scale: Option<[f64; 3]>,
}

/// An affine map: `linear` (rows) and then `offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Transform {
    pub(super) linear: [[f64; 3]; 3],
    pub(super) offset: [f64; 3],
}

impl Stated {
    pub(super) fn matrix(&self) -> Transform {
        if let Some(m) = &self.matrix {
            return Transform {
                linear: [0, 1, 2].map(|row| [m[row], m[row + 4], m[row + 8]]),
                offset: [m[12], m[13], m[14]],
            };
        }
        let [x, y, z, w] = self.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]);
        let rotation = rotation_matrix([w, x, y, z]).unwrap_or(Transform::IDENTITY.linear);
        let scale = self.scale.unwrap_or([1.0; 3]);
        Transform {
            linear: rotation.map(|row| [row[0] * scale[0], row[1] * scale[1], row[2] * scale[2]]),
            offset: self.translation.unwrap_or([0.0; 3]),
        }
    }
}

impl Transform {
    pub(super) const IDENTITY: Transform = Transform {
        linear: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        offset: [0.0; 3],
    };

    /// `inner` first, then this.
    pub(super) fn then(&self, inner: &Transform) -> Transform {
        let column = |k: usize| inner.linear.map(|row| row[k]);
        let columns = [0, 1, 2].map(|k| vector::transform(&self.linear, column(k)));
        Transform {
            linear: [0, 1, 2].map(|row| columns.map(|column| column[row])),
            offset: vector::add(vector::transform(&self.linear, inner.offset), self.offset),
        }
    }

    /// What the transform does to so many coefficients; nothing where it does nothing.
    pub(super) fn harmonics(&self, count: usize) -> Result<Option<Turn>, Problem> {
        if count == 0 || self.linear == Transform::IDENTITY.linear {
            return Ok(None);
        }
        let lengths = self.linear.map(vector::length);
        let scale = lengths[0];
        let rotation = self.linear.map(|row| vector::scale(1.0 / scale, row));
        let orthonormal = (0..3).all(|i| {
            (0..3).all(|j| {
                let expected = f64::from(u8::from(i == j));
                (vector::dot(rotation[i], rotation[j]) - expected).abs() <= TOLERANCE
            })
        });
        if orthonormal {
            Ok(Some(Turn::new(&rotation, count)))
        } else {
            bail!(
                "node transform: it scales axes differently or shears, which view-dependent \
                 colours cannot follow; apply the transform to the Gaussians before exporting, or \
                 leave the harmonics out"
            )
        }
    }
}

/// Per degree the matrix that takes coefficients before a rotation to those after it.
pub(super) struct Turn(Vec<Vec<Vec<f64>>>);

impl Turn {
    fn new(rotation: &[[f64; 3]; 3], count: usize) -> Turn {
        let mut degrees = Vec::new();
        let mut first = 0;
        while first < count.min(HARMONICS) {
            let width = 2 * degrees.len() + 3;
            degrees.push(mixing(rotation, first, width));
            first += width;
        }
        Turn(degrees)
    }

    pub(super) fn apply(&self, coefficients: &mut [[f32; 3]]) {
        let mut first = 0;
        for matrix in &self.0 {
            let before: Vec<[f32; 3]> = coefficients[first..first + matrix.len()].to_vec();
            for (after, row) in coefficients[first..].iter_mut().zip(matrix) {
                *after = [0, 1, 2].map(|channel| {
                    let products = row.iter().zip(&before);
                    let sum: f64 = products.map(|(m, b)| m * f64::from(b[channel])).sum();
                    sum as f32
                });
            }
            first += matrix.len();
        }
    }
}

/// M with Y(d) M c = Y(R^T d) c for every d: solved over as many directions as there are harmonics of the degree.
fn mixing(rotation: &[[f64; 3]; 3], first: usize, width: usize) -> Vec<Vec<f64>> {
    let basis = |direction: [f64; 3]| harmonic_basis(direction)[first..first + width].to_vec();
    let back =
        |d: [f64; 3]| [0, 1, 2].map(|k| (0..3).map(|row| rotation[row][k] * d[row]).sum::<f64>());
    let directions: Vec<[f64; 3]> = (0..width).map(|i| spread(i, width)).collect();
    let mut rows: Vec<Vec<f64>> = directions
        .iter()
        .map(|d| [basis(*d), basis(back(*d))].concat())
        .collect();
    vector::eliminate(&mut rows);
    rows.iter().map(|row| row[width..].to_vec()).collect()
}

/// Directions in which the harmonics of a degree are independent: a spiral over a part of the sphere.
fn spread(index: usize, count: usize) -> [f64; 3] {
    let z = 0.95 - 0.9 * index as f64 / count as f64;
    let angle = 2.399_963_229_728_653 * index as f64;
    let radius = (1.0 - z * z).sqrt();
    [radius * angle.cos(), radius * angle.sin(), z]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::gaussian::colour;

    fn quarter_turn_and_tilt() -> [[f64; 3]; 3] {
        rotation_matrix([0.8, -0.3, 0.5, 0.2]).unwrap()
    }

    /// The colour after the turn in a turned direction is the colour before it in the direction itself.
    #[test]
    fn colours_turn_with_the_scene() {
        let rotation = quarter_turn_and_tilt();
        let turned = Transform {
            linear: rotation.map(|row| vector::scale(2.5, row)),
            offset: [0.0; 3],
        };
        let before: Vec<[f32; 3]> = (0..24)
            .map(|k| {
                [
                    0.1 * (k as f32).sin(),
                    0.05 * k as f32 - 0.5,
                    0.3 / (1.0 + k as f32),
                ]
            })
            .collect();
        let mut after = before.clone();
        turned.harmonics(24).unwrap().unwrap().apply(&mut after);
        for direction in [[0.6, 0.0, 0.8], [-0.48, 0.64, -0.6], [0.0, -1.0, 0.0]] {
            let expected = colour([3.0; 3], &before, direction);
            let found = colour([3.0; 3], &after, vector::transform(&rotation, direction));
            for (a, b) in expected.iter().zip(found) {
                assert!((a - b).abs() < 1e-5, "{expected:?} {found:?}");
            }
        }
    }

    #[test]
    fn transforms_are_composed_inner_first() {
        let json = r#"{"translation": [1, 2, 3], "rotation": [0, 0, 0.7071067811865476, 0.7071067811865476], "scale": [2, 1, 1]}"#;
        let stated: Stated = serde_json::from_str(json).unwrap();
        let place = |t: &Transform, p| vector::add(vector::transform(&t.linear, p), t.offset);
        let inner = stated.matrix();
        let at = place(&inner, [1.0, 0.0, 0.0]);
        for (found, expected) in at.iter().zip([1.0, 4.0, 3.0]) {
            assert!((found - expected).abs() < 1e-12, "{at:?}");
        }
        let json = "{\"matrix\": [0, 1, 0, 0,  -1, 0, 0, 0,  0, 0, 1, 0,  5, 6, 7, 1]}";
        let outer: Transform = serde_json::from_str::<Stated>(json).unwrap().matrix();
        let both = place(&outer.then(&inner), [1.0, 0.0, 0.0]);
        let steps = place(&outer, at);
        for (found, expected) in both.iter().zip(steps) {
            assert!((found - expected).abs() < 1e-12);
        }
        assert!(inner.harmonics(3).is_err() && inner.harmonics(0).unwrap().is_none());
    }
}
