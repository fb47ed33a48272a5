//! The few operations on vectors of three that the host needs, in double precision.

/// A vector or point of three coordinates.
pub type Vector = [f64; 3];

/// `a + b`.
pub fn add(a: Vector, b: Vector) -> Vector {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// `a - b`.
pub fn subtract(a: Vector, b: Vector) -> Vector {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// `factor * a`.
pub fn scale(factor: f64, a: Vector) -> Vector {
    a.map(|coordinate| factor * coordinate)
}

/// The scalar product `a . b`.
pub fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The cross product `a x b`.
pub fn cross(a: Vector, b: Vector) -> Vector {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// The cofactors of the matrix of these rows: `b x c`, `c x a` and `a x b`.
pub fn cofactors([a, b, c]: [Vector; 3]) -> [Vector; 3] {
    [cross(b, c), cross(c, a), cross(a, b)]
}

/// The Euclidean length.
pub fn length(a: Vector) -> f64 {
    dot(a, a).sqrt()
}

/// `a` at length 1; nothing where it has no direction.
pub fn unit(a: Vector) -> Option<Vector> {
    let length = length(a);
    (length.is_finite() && length > 0.0).then(|| a.map(|coordinate| coordinate / length))
}

/// The matrix with these entries on its diagonal.
pub fn diagonal([x, y, z]: Vector) -> [Vector; 3] {
    [[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]]
}

/// The columns of a row-major matrix, each times a factor of its own: the axes of a turned Gaussian of these scales.
pub fn scaled_columns(rows: &[Vector; 3], scales: Vector) -> [Vector; 3] {
    [0, 1, 2].map(|k| [0, 1, 2].map(|row: usize| rows[row][k] * scales[k]))
}

/// The product of a row-major matrix and a column vector.
pub fn transform(rows: &[Vector; 3], a: Vector) -> Vector {
    [dot(rows[0], a), dot(rows[1], a), dot(rows[2], a)]
}

/// Whether every coordinate is finite.
pub fn is_finite(a: Vector) -> bool {
    a.iter().all(|coordinate| coordinate.is_finite())
}

/// The solution of `rows a = b` by Cramer's rule; not finite where the rows do not span space.
pub fn solve(rows: &[Vector; 3], b: Vector) -> Vector {
    let columns = cofactors(*rows);
    let determinant = dot(rows[0], columns[0]);
    let once = |b: Vector| {
        let sum = add(
            scale(b[0], columns[0]),
            add(scale(b[1], columns[1]), scale(b[2], columns[2])),
        );
        scale(1.0 / determinant, sum)
    };
    // Once more for what the first solution leaves over.
    let first = once(b);
    add(first, once(subtract(b, transform(rows, first))))
}

/// Turns the left square of the rows into the unit matrix (Gauss and Jordan, with pivots): what stands right of it
/// becomes the solutions.
pub(crate) fn eliminate(rows: &mut [Vec<f64>]) {
    for column in 0..rows.len() {
        let pivot = (column..rows.len())
            .max_by(|&a, &b| rows[a][column].abs().total_cmp(&rows[b][column].abs()))
            .unwrap_or(column);
        rows.swap(column, pivot);
        let scale = 1.0 / rows[column][column];
        rows[column].iter_mut().for_each(|value| *value *= scale);
        let row = rows[column].clone();
        let others = rows.iter_mut().enumerate();
        for (_, other) in others.filter(|(index, _)| *index != column) {
            let factor = other[column];
            for (value, part) in other.iter_mut().zip(&row) {
                *value -= factor * part;
            }
        }
    }
}
