//! Height fields as surfaces: a grid of heights becomes surface splats whose tangent frames follow the slope.
//!
//! The file is text: one row of the grid per line, heights separated by commas or semicolons, every line as long as the
//! first; blank lines are passed over. The first line is the southernmost row, so that x runs to the east, y to the
//! north and z up; a photograph, whose first row is the northernmost, registers after this flip.
//!
//! The basis function of a grid point is a Gaussian on the grid, lifted onto the surface: its frame is S = s d (1, 0,
//! h_x), s d (0, 1, h_y) with the grid's spacing d, the slopes by central differences and s = [`DEVIATION`] (SURF 3.2:
//! the local parameterisation).

use super::{INSIDE_CUTOFF, Material, SurfacePoint, SurfaceScene};
use crate::memory;
use crate::scene::error::{LoadError, Problem, shorten};
use crate::scene::file::read_file;
use crate::vector::{self, Vector};
use anyhow::{bail, ensure};
use std::path::Path;

/// Standard deviation of a basis function in grid spacings. The truncated functions then overlap without gaps (they
/// reach 1.06 spacings) and their sum hardly varies over a square grid (docs/systems.md).
pub const DEVIATION: f64 = 0.75;

/// Distance of neighbouring heights, in units of height, where nobody gives one.
pub const USUAL_SPACING: f64 = 0.1;

/// Heights of a file at most.
const MOST_HEIGHTS: usize = 1 << 24;

/// Heights on a square grid.
#[derive(Clone, Debug, PartialEq)]
pub struct HeightField {
    /// Heights from west to east, at least 2.
    pub columns: usize,
    /// Rows from south to north, at least 2.
    pub rows: usize,
    /// Row-major, the southernmost row first; all finite.
    pub heights: Vec<f64>,
    /// Distance of neighbours, scene units.
    pub spacing: f64,
}

/// A height field without a file: hills of two wave lengths.
const HILLS: &str = "hills";

/// Is the path that of a height field?
pub fn is_height_field(path: &Path) -> bool {
    let csv = path
        .extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case("csv"));
    csv || path == Path::new(HILLS)
}

impl HeightField {
    /// Loads a text file of heights, or makes the field named `hills`.
    pub fn load(path: &Path, spacing: f64) -> Result<HeightField, LoadError> {
        if path == Path::new(HILLS) {
            let wave = |x: usize, y: usize| (0.35 * x as f64).sin() + (0.21 * y as f64).cos();
            return Ok(HeightField::from_heights(64, 64, spacing, |x, y| {
                2.0 * spacing * wave(x, y)
            }));
        }
        read_file(path)
            .and_then(|bytes| HeightField::parse(&bytes, spacing))
            .map_err(LoadError::about(path.display()))
    }

    /// Reads a file's bytes; a problem names the line.
    pub(crate) fn parse(bytes: &[u8], spacing: f64) -> Result<HeightField, Problem> {
        let text = String::from_utf8_lossy(bytes);
        // Counted before a number is read: a row of millions takes long to be read and is refused at once.
        let separators = bytes.iter().filter(|byte| b",;".contains(byte)).count();
        let count = separators + text.lines().filter(|line| !line.trim().is_empty()).count();
        ensure!(
            count <= MOST_HEIGHTS,
            "heights: there are more than {MOST_HEIGHTS}; give a smaller grid"
        );
        let each = size_of::<f64>() + size_of::<SurfacePoint>();
        memory::room_for_records(count as u64, each, "the grid's points")?;
        let (mut columns, mut rows, mut heights) = (0, 0, Vec::new());
        for (index, line) in text.lines().enumerate() {
            let line = line.trim();
            if line.is_empty() {
                continue;
            }
            let before = heights.len();
            read_row(line, index + 1, &mut heights)?;
            let count = heights.len() - before;
            if rows == 0 {
                columns = count;
            }
            ensure!(
                count == columns,
                "line {}: it has {count} heights where the first row has {columns}; \
                 give every row of the grid the same number of heights",
                index + 1
            );
            rows += 1;
        }
        ensure!(
            columns >= 2 && rows >= 2,
            "heights: the grid has {rows} rows of {columns}; \
             give at least 2 rows of 2 heights, one row per line, separated by commas"
        );
        Ok(HeightField {
            columns,
            rows,
            heights,
            spacing,
        })
    }

    /// The grid that has height `height(column, row)` everywhere.
    pub fn from_heights(
        columns: usize,
        rows: usize,
        spacing: f64,
        height: impl Fn(usize, usize) -> f64,
    ) -> HeightField {
        let [columns, rows] = [columns, rows].map(|count| count.max(2));
        let places = 0..columns * rows;
        let heights = places.map(|index| height(index % columns, index / columns));
        HeightField {
            columns,
            rows,
            heights: heights.collect(),
            spacing,
        }
    }

    /// A grid point's place, the middle of the grid at x = y = 0.
    pub fn place(&self, column: usize, row: usize) -> Vector {
        let middle = |count: usize| 0.5 * (count - 1) as f64;
        [
            self.spacing * (column as f64 - middle(self.columns)),
            self.spacing * (row as f64 - middle(self.rows)),
            self.heights[row * self.columns + column],
        ]
    }

    /// Slopes (h_x, h_y): central differences, one-sided at the border.
    pub fn slope(&self, column: usize, row: usize) -> [f64; 2] {
        let difference = |ahead: Vector, behind: Vector, axis: usize| {
            (ahead[2] - behind[2]) / (ahead[axis] - behind[axis])
        };
        let (east, west) = ((column + 1).min(self.columns - 1), column.saturating_sub(1));
        let (north, south) = ((row + 1).min(self.rows - 1), row.saturating_sub(1));
        [
            difference(self.place(east, row), self.place(west, row), 0),
            difference(self.place(column, north), self.place(column, south), 1),
        ]
    }

    /// The surface, grey; points in the order of the heights.
    pub fn scene(&self, name: &str) -> SurfaceScene {
        let points: Vec<SurfacePoint> = (0..self.heights.len())
            .map(|index| self.point(index % self.columns, index / self.columns))
            .collect();
        SurfaceScene {
            name: name.to_owned(),
            points,
            materials: vec![Material::MATT],
            radius: DEVIATION * self.spacing,
            skipped: 0,
            coloured: false,
            notes: Vec::new(),
            up: [0.0, 0.0, 1.0],
        }
    }

    fn point(&self, column: usize, row: usize) -> SurfacePoint {
        let [across, along] = self.slope(column, row);
        let reach = DEVIATION * self.spacing;
        let normal = [-across, -along, 1.0];
        SurfacePoint {
            centre: self.place(column, row),
            frame: [[reach, 0.0, reach * across], [0.0, reach, reach * along]],
            normal: vector::scale(1.0 / vector::length(normal), normal),
            weight: share_of_cell(),
            colour: super::WITHOUT_COLOUR,
            opacity: 1.0,
            material: 0,
        }
    }
}

/// The weight by which basis functions on the square grid sum to 1: a cell over the integral inside the cut-off.
fn share_of_cell() -> f64 {
    1.0 / (std::f64::consts::TAU * DEVIATION * DEVIATION * INSIDE_CUTOFF)
}

fn read_row(line: &str, number: usize, heights: &mut Vec<f64>) -> Result<(), Problem> {
    for (index, word) in line.split([',', ';']).enumerate() {
        let height = word
            .trim()
            .parse()
            .ok()
            .filter(|height| f64::is_finite(*height));
        let Some(height) = height else {
            let shown = shorten(word);
            bail!(
                "line {number}, height {}: '{}' is no finite number; \
                 write heights such as 1.5, separated by commas",
                index + 1,
                shown.trim()
            );
        };
        heights.push(height);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::damage_tests::{assert_refused, rows};

    #[test]
    fn rows_run_from_south_to_north() {
        let field = HeightField::parse(b"0, 1, 2\n\n10;11;12\r\n", 0.5).unwrap();
        assert_eq!((field.columns, field.rows), (3, 2));
        assert_eq!(field.place(0, 0), [-0.5, -0.25, 0.0]);
        assert_eq!(field.place(2, 1), [0.5, 0.25, 12.0]);
        assert_eq!(field.slope(1, 0), [2.0, 20.0]);
    }

    #[test]
    fn malformed_files_name_the_line_and_the_fix() {
        let table = r"
            1,2\n3,x => line 2, height 2: 'x' is no finite number; write heights
            1,2\n3,inf => line 2, height 2: 'inf'
            1,2\n3, => line 2, height 2: ''
            1,2\n\n3,4,5 => line 3: it has 3 heights where the first row has 2
            => the grid has 0 rows of 0
            1,2,3 => the grid has 1 rows of 3; give at least 2 rows
        ";
        for [text, expected] in rows(table) {
            assert_refused(&[(text, &*expected)], |bytes| {
                HeightField::parse(bytes, 0.5)
            });
        }
    }

    #[test]
    fn a_plane_has_its_normal_and_frames_that_lie_in_it() {
        let field = HeightField::from_heights(9, 7, 0.25, |x, y| 0.5 * x as f64 - 0.25 * y as f64);
        for point in &field.scene("plane").points {
            let [a, b] = point.frame.map(|axis| vector::dot(axis, point.normal));
            assert!(a.abs() < 1e-15 && b.abs() < 1e-15);
            let tilt = vector::scale(1.0 / point.normal[2], point.normal);
            assert!((tilt[0] + 2.0).abs() < 1e-12 && (tilt[1] - 1.0).abs() < 1e-12);
        }
    }
}
