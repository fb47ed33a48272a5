//! Deferred Phong shading with two materials.

use super::{GalleryError, draw_both, exhibit, on_paper};
use crate::gallery::Exhibit;
use splatline_sim::camera::Camera;
use splatline_sim::scene::points::synthetic::{Paint, scene, sheet, sphere};
use splatline_sim::surface::Style;

/// A matt and a glossy ball on a chequered floor.
pub fn shading() -> Result<Exhibit, GalleryError> {
    let matt = Paint::opaque([0.85, 0.3, 0.2]);
    let glossy = Paint {
        material: 1,
        ..Paint::opaque([0.2, 0.4, 0.85])
    };
    let mut points = sphere([-1.1, 0.0, 1.0], 1.0, 40_000, matt);
    points.extend(sphere([1.1, 0.0, 1.0], 1.0, 40_000, glossy));
    points.extend(sheet(
        [0.0, 0.0, 0.0],
        [[3.5, 0.0, 0.0], [0.0, 3.5, 0.0]],
        0.03,
        |a, b| {
            let odd = ((a * 6.0).floor() + (b * 6.0).floor()).rem_euclid(2.0) > 0.5;
            Paint::opaque(if odd { [0.75; 3] } else { [0.25; 3] })
        },
    ));
    let balls = scene("two balls", points);
    let camera = Camera::look_at([0.0, -7.0, 3.2], [0.0, 0.0, 0.7], balls.up, 36.0, 480, 320)?;
    let style = Style {
        light: Some([-0.5, -0.8, 1.0]),
        ..Style::opaque(0.06)
    };
    let mut exhibit = exhibit(
        "Deferred shading with a material table",
        "[SURF] section 4 (system 10)",
        "A matt and a glossy ball (exponents 8 and 40) on a chequered floor, shaded once per pixel with the filtered normal.",
    );
    let (drawing, _) = draw_both(&mut exhibit, "shaded", &balls, &camera, &style)?;
    exhibit
        .pictures
        .push(("shading".to_owned(), on_paper(&drawing.picture)));
    Ok(exhibit)
}
