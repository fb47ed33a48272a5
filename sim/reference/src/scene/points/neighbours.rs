//! What a point's neighbours tell: how far apart points are, and which plane they lie in.

use crate::vector::{self, Vector};
use rayon::prelude::*;
use std::cmp::Ordering;

/// Neighbours that a basis function reaches with its standard deviation. The farthest of them counts, not their mean:
/// where the density of a scan jumps, the mean follows the dense side and leaves holes on the sparse one
/// (docs/systems.md).
const RADIUS_NEIGHBOURS: usize = 6;
/// Neighbours that a plane is laid through.
const PLANE_NEIGHBOURS: usize = 12;
/// Sweeps of Jacobi rotations; three are enough for 3x3.
const SWEEPS: usize = 8;

/// A k-d tree over places: of every part of `order` the middle place divides the others along an axis, and the axes
/// take turns.
pub(super) struct Neighbours<'a> {
    places: &'a [Vector],
    order: Vec<usize>,
}

/// A place by number, and the square of its distance.
type Near = (f64, usize);

impl<'a> Neighbours<'a> {
    /// Builds the tree; all coordinates must be finite.
    pub(super) fn new(places: &'a [Vector]) -> Self {
        let mut order: Vec<usize> = (0..places.len()).collect();
        divide(places, &mut order, 0);
        Neighbours { places, order }
    }

    /// Per place the distance to the farthest of its six nearest neighbours; 0 where all of them lie on the same spot.
    pub(super) fn radii(&self) -> Vec<f64> {
        let radius = |place: &Vector| {
            // The nearest of these is the place itself.
            let found = self.nearest_to(place, RADIUS_NEIGHBOURS + 1);
            found.last().map_or(0.0, |(square, _)| square.sqrt())
        };
        self.places.par_iter().map(radius).collect()
    }

    /// The places nearest to place `index`, itself left out.
    pub(super) fn nearest(&self, index: usize, count: usize) -> Vec<usize> {
        let found = self.nearest_to(&self.places[index], count + 1);
        let others = found.iter().map(|(_, other)| *other);
        others.filter(|other| *other != index).take(count).collect()
    }

    /// Per place the direction in which its neighbours spread least.
    pub(super) fn normals(&self) -> Vec<Vector> {
        let normal = |place: &Vector| {
            let found = self.nearest_to(place, PLANE_NEIGHBOURS + 1);
            let offsets = found
                .iter()
                .map(|(_, other)| vector::subtract(self.places[*other], *place));
            least_direction(&offsets.collect::<Vec<_>>())
        };
        self.places.par_iter().map(normal).collect()
    }

    /// The `count` nearest places, nearest first.
    fn nearest_to(&self, place: &Vector, count: usize) -> Vec<Near> {
        let mut found = Vec::with_capacity(count + 1);
        self.search(place, &self.order, 0, count, &mut found);
        found
    }

    /// Puts the places of a part of the tree among those found, of which `count` stay.
    fn search(
        &self,
        place: &Vector,
        part: &[usize],
        axis: usize,
        count: usize,
        found: &mut Vec<Near>,
    ) {
        let (before, [middle, after @ ..]) = part.split_at(part.len() / 2) else {
            return;
        };
        let offset = vector::subtract(*place, self.places[*middle]);
        let square = vector::dot(offset, offset);
        let at = found.partition_point(|(other, _)| *other < square);
        found.insert(at, (square, *middle));
        found.truncate(count);
        let [nearer, farther] = if offset[axis] < 0.0 {
            [before, after]
        } else {
            [after, before]
        };
        let next = (axis + 1) % 3;
        self.search(place, nearer, next, count, found);
        let reach = found.last().map_or(0.0, |(square, _)| *square);
        if found.len() < count || offset[axis] * offset[axis] < reach {
            self.search(place, farther, next, count, found);
        }
    }
}

/// Puts the middle of the places along an axis into the list's middle, smaller ones before and larger ones behind it,
/// and so on in both halves.
fn divide(places: &[Vector], order: &mut [usize], axis: usize) {
    if order.len() < 2 {
        return;
    }
    let along = |a: &usize, b: &usize| {
        let [a, b] = [a, b].map(|index| places[*index][axis]);
        a.partial_cmp(&b).unwrap_or(Ordering::Equal)
    };
    let middle = order.len() / 2;
    order.select_nth_unstable_by(middle, along);
    let (before, after) = order.split_at_mut(middle);
    let next = (axis + 1) % 3;
    divide(places, before, next);
    divide(places, &mut after[1..], next);
}

/// Eigenvector of the smallest eigenvalue of the offsets' covariance, by cyclic Jacobi rotations.
fn least_direction(offsets: &[Vector]) -> Vector {
    let mean = offsets.iter().fold([0.0; 3], |sum, o| vector::add(sum, *o));
    let mean = vector::scale(1.0 / offsets.len().max(1) as f64, mean);
    let mut matrix = [[0.0; 3]; 3];
    for offset in offsets {
        let d = vector::subtract(*offset, mean);
        for (i, row) in matrix.iter_mut().enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                *entry += d[i] * d[j];
            }
        }
    }
    let mut vectors = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for _ in 0..SWEEPS {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            rotate(&mut matrix, &mut vectors, p, q);
        }
    }
    let least = (0..3)
        .min_by(|&a, &b| matrix[a][a].total_cmp(&matrix[b][b]))
        .unwrap_or(2);
    [vectors[0][least], vectors[1][least], vectors[2][least]]
}

/// Turns rows and columns p and q so that entry (p, q) becomes 0.
fn rotate(matrix: &mut [[f64; 3]; 3], vectors: &mut [[f64; 3]; 3], p: usize, q: usize) {
    let angle = 0.5 * f64::atan2(2.0 * matrix[p][q], matrix[q][q] - matrix[p][p]);
    let (sine, cosine) = angle.sin_cos();
    for row in matrix.iter_mut().chain(vectors.iter_mut()) {
        let (a, b) = (row[p], row[q]);
        row[p] = cosine * a - sine * b;
        row[q] = sine * a + cosine * b;
    }
    let (upper, lower) = (matrix[p], matrix[q]);
    matrix[p] = [0, 1, 2].map(|c: usize| cosine * upper[c] - sine * lower[c]);
    matrix[q] = [0, 1, 2].map(|c: usize| sine * upper[c] + cosine * lower[c]);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tilted_plane_has_its_normal_and_its_spacing() {
        let (u, v) = ([0.6, 0.0, 0.8], [0.0, 1.0, 0.0]);
        let place = |i: usize, j: usize| {
            vector::add(vector::scale(i as f64, u), vector::scale(j as f64, v))
        };
        let places: Vec<Vector> = (0..400).map(|n| place(n % 20, n / 20)).collect();
        let neighbours = Neighbours::new(&places);
        let middle = 210;
        let normal = neighbours.normals()[middle];
        let cosine = vector::dot(normal, [-0.8, 0.0, 0.6]).abs();
        assert!((cosine - 1.0).abs() < 1e-12, "{normal:?}");
        // Four neighbours at 1 and two of four at sqrt(2).
        assert!((neighbours.radii()[middle] - 2f64.sqrt()).abs() < 1e-12);
    }

    /// The distances of the tree's neighbours are those of all places, sorted.
    #[test]
    fn the_nearest_places_are_found() {
        let number = |n: usize| ((n * 7919 + 13) % 1009) as f64 / 101.0;
        let places: Vec<Vector> = (0..500)
            .map(|n| [number(n), number(3 * n + 1), number(n * n).floor()])
            .collect();
        let neighbours = Neighbours::new(&places);
        for place in &places {
            let mut squares: Vec<f64> = places
                .iter()
                .map(|other| {
                    let offset = vector::subtract(*place, *other);
                    vector::dot(offset, offset)
                })
                .collect();
            squares.sort_by(f64::total_cmp);
            for count in [1, 7, 13] {
                let found = neighbours.nearest_to(place, count);
                let found: Vec<f64> = found.iter().map(|(square, _)| *square).collect();
                assert_eq!(found, squares[..count]);
            }
        }
    }

    #[test]
    fn points_on_one_spot_have_no_radius() {
        let places = [[1.0, 2.0, 3.0]; 9];
        assert_eq!(Neighbours::new(&places).radii(), vec![0.0; 9]);
    }
}
