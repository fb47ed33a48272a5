//! A scene in a trainer's terms, and steps of numbers: what all writers begin with.

use splatline_sim::scene::{Gaussian, HARMONIC_0, Harmonics, Scene, Splat};

/// All Gaussians of a scene; their rotations have length 1, w at least 0.
pub(super) struct Trained<'a> {
    pub(super) degree: u8,
    pub(super) records: Vec<Gaussian<'a>>,
}

impl<'a> Trained<'a> {
    pub(super) fn of(scene: &'a Scene) -> Trained<'a> {
        let harmonics = scene.harmonics.as_ref();
        let record = |(index, splat)| gaussian(splat, index, harmonics);
        Trained {
            degree: harmonics.map_or(0, |harmonics| harmonics.degree),
            records: scene.splats.iter().enumerate().map(record).collect(),
        }
    }

    /// Coefficients of degree 1 and up.
    pub(super) fn coefficients(&self) -> usize {
        (usize::from(self.degree) + 1).pow(2) - 1
    }

    /// Least and greatest of some numbers of all records.
    pub(super) fn range<const N: usize>(
        &self,
        of: impl Fn(&Gaussian) -> [f64; N],
    ) -> [[f64; N]; 2] {
        range(&self.records, of)
    }
}

pub(super) fn range<const N: usize>(
    records: &[Gaussian],
    of: impl Fn(&Gaussian) -> [f64; N],
) -> [[f64; N]; 2] {
    let mut found = [[f64::INFINITY; N], [f64::NEG_INFINITY; N]];
    for values in records.iter().map(of) {
        for (k, value) in values.into_iter().enumerate() {
            found[0][k] = found[0][k].min(value);
            found[1][k] = found[1][k].max(value);
        }
    }
    found
}

fn gaussian<'a>(splat: &Splat, index: usize, harmonics: Option<&'a Harmonics>) -> Gaussian<'a> {
    let scales = splat.axes.map(length);
    let per_splat = harmonics.map_or(0, |h| (usize::from(h.degree) + 1).pow(2) - 1);
    let stored = harmonics.and_then(|h| {
        h.coefficients
            .get(index * per_splat..(index + 1) * per_splat)
    });
    let base = harmonics.and_then(|h| h.base.get(index));
    Gaussian {
        centre: splat.centre,
        scales,
        rotation: quaternion(splat.axes, scales),
        opacity: splat.weight,
        base: base.map_or(splat.colour, |base| base.map(f64::from)),
        harmonics: stored.unwrap_or_default(),
    }
}

/// What trainers store for the scales.
pub(super) fn log_scales(gaussian: &Gaussian) -> [f64; 3] {
    gaussian.scales.map(f64::ln)
}

/// What they store for the colour of degree 0.
pub(super) fn constant_harmonics(gaussian: &Gaussian) -> [f64; 3] {
    gaussian.base.map(|base| (base - 0.5) / HARMONIC_0)
}

pub(super) fn length(axis: [f64; 3]) -> f64 {
    axis.iter().map(|part| part * part).sum::<f64>().sqrt()
}

/// The turn of three orthogonal axes, w at least 0. Each part's square is a sum of diagonal entries; the largest one gives the signs.
pub(super) fn quaternion(axes: [[f64; 3]; 3], scales: [f64; 3]) -> [f64; 4] {
    // Entry of row and column: the axes are the columns.
    let m = |row: usize, column: usize| {
        if scales[column] > 0.0 {
            axes[column][row] / scales[column]
        } else {
            f64::from(u8::from(row == column))
        }
    };
    let [x, y, z] = [m(0, 0), m(1, 1), m(2, 2)];
    let squares = [
        1.0 + x + y + z,
        1.0 + x - y - z,
        1.0 - x + y - z,
        1.0 - x - y + z,
    ];
    let largest = (0..4)
        .max_by(|a, b| squares[*a].total_cmp(&squares[*b]))
        .unwrap_or(0);
    let q = 0.5 * squares[largest].max(0.0).sqrt();
    let over = 0.25 / q;
    let (wx, wy, wz) = (m(2, 1) - m(1, 2), m(0, 2) - m(2, 0), m(1, 0) - m(0, 1));
    let (xy, xz, yz) = (m(0, 1) + m(1, 0), m(0, 2) + m(2, 0), m(1, 2) + m(2, 1));
    let parts = match largest {
        0 => [q, wx * over, wy * over, wz * over],
        1 => [wx * over, q, xy * over, xz * over],
        2 => [wy * over, xy * over, q, yz * over],
        _ => [wz * over, xz * over, yz * over, q],
    };
    if parts[0] < 0.0 {
        parts.map(|part| -part)
    } else {
        parts
    }
}

/// The place of the largest part, and the others with its sign taken out, in units of sqrt(1/2).
pub(super) fn smallest_three(parts: [f64; 4]) -> (usize, [f64; 3]) {
    let largest = (0..4)
        .max_by(|a, b| parts[*a].abs().total_cmp(&parts[*b].abs()))
        .unwrap_or(0);
    let sign = std::f64::consts::SQRT_2.copysign(parts[largest]);
    let mut others = (0..4)
        .filter(|place| *place != largest)
        .map(|place| parts[place] * sign);
    (
        largest,
        std::array::from_fn(|_| others.next().unwrap_or_default()),
    )
}

/// Nearest of 0 to `most` for 0 to 1.
pub(super) fn step(part: f64, most: u32) -> u32 {
    (part.clamp(0.0, 1.0) * f64::from(most)).round() as u32
}

pub(super) fn byte(part: f64) -> u8 {
    step(part, 255) as u8
}

/// Where a number lies in a range, 0 to 1.
pub(super) fn part(value: f64, least: f64, greatest: f64) -> f64 {
    if greatest > least {
        (value - least) / (greatest - least)
    } else {
        0.0
    }
}

pub(super) fn floats(values: impl IntoIterator<Item = f64>) -> Vec<u8> {
    values
        .into_iter()
        .flat_map(|value| (value as f32).to_le_bytes())
        .collect()
}
