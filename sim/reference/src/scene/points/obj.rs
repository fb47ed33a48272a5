//! Wavefront `.obj`: vertices as points. A format of a few words a line, so own code.
//!
//! | line | read |
//! |---|---|
//! | `v x y z`, with `r g b` or with `w` behind | a place, and a colour (0 to 1, or 0 to 255 if one exceeds 1); `w` is ignored |
//! | `vn x y z` | a normal: the faces say whose; without faces that do, the n-th normal is the n-th vertex's |
//! | `f a//n ...` | pairs vertices with normals; several normals of a vertex are averaged |
//!
//! Faces, lines and curves are not drawn, and a note says so: the points are what is there of the surface.

use super::{Cloud, Record, full_scale, room_for_lines};
use crate::scene::bytes;
use crate::scene::error::{Problem, shorten};
use crate::vector::{self, Vector};
use anyhow::{Context, bail, ensure};

/// What the lines say.
#[derive(Default)]
struct Obj {
    records: Vec<Record>,
    normals: Vec<Vector>,
    /// Sum of the normals that faces give a vertex.
    sums: Vec<Vector>,
    shapes: usize,
}

/// Every vertex as a record.
pub(super) fn cloud(bytes: &[u8]) -> Result<Cloud, Problem> {
    room_for_lines(bytes, 2 * size_of::<Vector>())?;
    let text = String::from_utf8_lossy(bytes);
    let mut obj = Obj::default();
    for (index, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or_default();
        let mut words = line.split_whitespace();
        if let Some(word) = words.next() {
            obj.line(word, words.collect(), index + 1)?;
        }
    }
    obj.finish()
}

fn numbers(words: &[&str], line: usize) -> Result<Vec<f64>, Problem> {
    let place = || format!("line {line}");
    let numbers = words.iter().map(|word| bytes::number(word, place));
    numbers.collect()
}

impl Obj {
    fn line(&mut self, word: &str, words: Vec<&str>, line: usize) -> Result<(), Problem> {
        match word {
            "v" => {
                let Some(record) = vertex(&numbers(&words, line)?) else {
                    let count = words.len();
                    bail!("line {line}: a vertex of {count} numbers; write x y z, or x y z r g b");
                };
                self.records.push(record);
            }
            "vn" => match numbers(&words, line)?[..] {
                [x, y, z] => self.normals.push([x, y, z]),
                _ => bail!(
                    "line {line}: a normal of {} numbers; write three",
                    words.len()
                ),
            },
            "f" => {
                self.shapes += 1;
                for corner in words {
                    self.corner(corner, line)?;
                }
            }
            // What else is made of the points.
            "p" | "l" | "curv" | "curv2" | "surf" | "cstype" | "deg" | "bmat" | "step" | "trim"
            | "hole" | "scrv" | "sp" | "end" | "con" => self.shapes += 1,
            // Lines that have nothing to do with points.
            "vt" | "vp" | "o" | "g" | "s" | "mg" | "mtllib" | "usemtl" | "usemap" | "maplib"
            | "lod" | "shadow_obj" | "trace_obj" | "bevel" | "c_interp" | "d_interp" | "call"
            | "csh" | "parm" | "ctech" => {}
            other => bail!(
                "line {line}: '{}' is no word of .obj; \
                 remove the line, or export the file again",
                shorten(other)
            ),
        }
        Ok(())
    }

    /// `vertex`, `vertex/texture`, `vertex//normal` or all three; negative numbers count from the last.
    fn corner(&mut self, corner: &str, line: usize) -> Result<(), Problem> {
        let mut parts = corner.split('/');
        let vertex = place(parts.next(), self.records.len());
        let normal = parts.nth(1).filter(|part| !part.is_empty());
        let pair = match normal {
            None => vertex.map(|_| None),
            Some(_) => vertex.zip(place(normal, self.normals.len())).map(Some),
        };
        let pair = pair.with_context(|| {
            format!(
                "line {line}: the corner '{}' names nothing above it; \
                 fetch the file again: lines are missing",
                shorten(corner)
            )
        })?;
        if let Some((vertex, normal)) = pair {
            self.sums.resize(self.records.len(), [0.0; 3]);
            self.sums[vertex] = vector::add(self.sums[vertex], self.normals[normal]);
        }
        Ok(())
    }

    fn finish(mut self) -> Result<Cloud, Problem> {
        let count = self.records.len();
        if !self.sums.is_empty() {
            self.sums.resize(count, [0.0; 3]);
            self.normals = self.sums;
        }
        ensure!(
            self.normals.is_empty() || self.normals.len() == count,
            "vn: {} normals for {count} vertices; \
             write one normal per vertex, or faces that pair them (f 1//1)",
            self.normals.len()
        );
        for (record, normal) in self.records.iter_mut().zip(self.normals) {
            // A vertex that no face names, or whose faces look both ways, gets its neighbours' plane.
            record.normal = Some(normal).filter(|normal| *normal != [0.0; 3]);
        }
        full_scale(&mut self.records, &[1.0, 255.0]);
        let note = format!(
            "{} faces and lines are not drawn: only vertices are",
            self.shapes
        );
        Ok(Cloud {
            records: self.records,
            notes: (self.shapes > 0).then_some(note).into_iter().collect(),
        })
    }
}

fn vertex(numbers: &[f64]) -> Option<Record> {
    let (place, colour) = match *numbers {
        [x, y, z] | [x, y, z, _] => ([x, y, z], None),
        [x, y, z, r, g, b] => ([x, y, z], Some([r, g, b])),
        _ => return None,
    };
    Some(Record {
        centre: place,
        colour,
        ..Record::default()
    })
}

/// The place of the n-th of `count`, counted from 1, or from the end below 0.
fn place(word: Option<&str>, count: usize) -> Option<usize> {
    let number: i64 = word?.parse().ok()?;
    let place = match number {
        1.. => usize::try_from(number - 1).ok()?,
        0 => return None,
        _ => count.checked_sub(usize::try_from(number.unsigned_abs()).ok()?)?,
    };
    (place < count).then_some(place)
}
