//! A photograph over a height field (\[SURF\] 5): every grid point gets a texture coefficient as its colour.

use super::Texture;
use super::coefficients::{Method, SamplePoint, coefficients};
use crate::scene::points::SurfaceScene;
use crate::scene::points::height_field::{DEVIATION, HeightField};
use anyhow::Result;

/// Grid points on a texture that covers the field from border to border, its first row in the north.
pub fn sample_points(field: &HeightField, texture: &Texture) -> Vec<SamplePoint> {
    let across = texture.width as f64 / (field.columns - 1) as f64;
    let down = texture.height as f64 / (field.rows - 1) as f64;
    let point = |index: usize| {
        let (column, row) = (index % field.columns, index / field.columns);
        SamplePoint {
            place: [
                across * column as f64,
                texture.height as f64 - down * row as f64,
            ],
            axes: [[DEVIATION * across, 0.0], [0.0, -DEVIATION * down]],
        }
    };
    (0..field.heights.len()).map(point).collect()
}

/// The field with colours by `method`, cut to 0 to 1, for drawings that end basis functions at `cutoff`.
pub fn drape(
    field: &HeightField,
    name: &str,
    texture: &Texture,
    method: Method,
    cutoff: f64,
) -> Result<SurfaceScene> {
    let points = sample_points(field, texture);
    let colours = coefficients(texture, &points, method, cutoff)?;
    let mut scene = field.scene(name);
    let mut cut = 0;
    for (point, colour) in scene.points.iter_mut().zip(colours) {
        point.colour = colour.map(|channel| channel.clamp(0.0, 1.0));
        cut += usize::from(point.colour != colour);
    }
    scene.coloured = true;
    scene
        .notes
        .push(format!("colours: {} coefficients", method.name()));
    if cut > 0 {
        scene.notes.push(format!(
            "colours: {cut} coefficients cut to the range of colours"
        ));
    }
    Ok(scene)
}
