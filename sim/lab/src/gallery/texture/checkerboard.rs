//! A checkerboard magnified until its points are far apart: how sharp the edges are.

use super::super::Exhibit;
use super::super::surface::{GalleryError, draw_both, exhibit};
use splatline_sim::camera::Camera;
use splatline_sim::metrics::compare;
use splatline_sim::picture::Picture;
use splatline_sim::scene::points::height_field::HeightField;
use splatline_sim::surface::Style;
use splatline_sim::texture::Texture;
use splatline_sim::texture::coefficients::Method;
use splatline_sim::texture::drape::drape;

/// Points along each side of the plane; a spacing is one scene unit.
const POINTS: usize = 49;
/// Texels per spacing.
const TEXELS: usize = 8;
/// Side of a field in spacings, incommensurable with the grid.
const FIELD: f64 = 5.37;
/// Pixels per spacing.
const MAGNIFICATION: f64 = 12.0;
/// Sides of the picture.
const SIZE: [usize; 2] = [312, 240];
/// Dark and light fields. Optimised coefficients overshoot them by four fifths of the contrast, and colours are unsigned.
const SHADES: [f64; 2] = [0.35, 0.65];

/// The three methods side by side.
pub fn magnified() -> Result<Exhibit, GalleryError> {
    let mut exhibit = exhibit(
        "A magnified checkerboard",
        "[SURF] section 5 (system 13)",
        "A checkerboard of 0.35 and 0.65 on a square grid of points, fields 5.37 spacings wide, seen at 12 pixels per spacing. Coefficients by plain \
         sampling, by the view-independent EWA pre-filter, and by least squares over 8 x 8 texels per spacing. Truth is the exact checkerboard at \
         the pixels' centres. Edge width is the way from 10 % to 90 % of the contrast across the mean profile of every vertical edge, averaged over the edges. With \
         full contrast coefficients would leave the unsigned colours; cut to them, they lose their advantage.",
    );
    let camera = camera();
    let truth = exact(&camera, SHADES);
    for method in Method::ALL {
        let (scene, _) = plane(method, SHADES)?;
        let style = Style::opaque(1.0);
        let what = format!("{}, fixed against float", method.name());
        let (drawing, _) = draw_both(&mut exhibit, &what, &scene, &camera, &style)?;
        measure(&mut exhibit, method.name(), &drawing.picture, &truth)?;
        let picture = drawing.picture;
        exhibit.pictures.push((method.name().to_owned(), picture));
    }
    let (scene, cut) = plane(Method::Optimised, [0.0, 1.0])?;
    let style = Style::opaque(1.0);
    let full = splatline_sim::reference::surface::draw(&scene, &camera, &style).picture;
    let errors = compare(&full, &exact(&camera, [0.0, 1.0]))?;
    exhibit.number(
        "full contrast, optimised: points cut to the range of colours",
        cut as f64,
        "",
    );
    exhibit.number(
        "full contrast, optimised and cut: PSNR",
        errors.colour.psnr_db,
        "dB",
    );
    let (scene, _) = plane(Method::Plain, [0.0, 1.0])?;
    let full = splatline_sim::reference::surface::draw(&scene, &camera, &style).picture;
    let errors = compare(&full, &exact(&camera, [0.0, 1.0]))?;
    exhibit.number("full contrast, plain: PSNR", errors.colour.psnr_db, "dB");
    exhibit.pictures.push(("exact".to_owned(), truth));
    Ok(exhibit)
}

/// Edge width and distance from the exact checkerboard.
fn measure(
    exhibit: &mut Exhibit,
    name: &str,
    picture: &Picture,
    truth: &Picture,
) -> Result<(), GalleryError> {
    let errors = compare(picture, truth)?;
    exhibit.number(format!("{name}: edge width"), edge_width(picture), "pixels");
    exhibit.errors(
        &format!("{name}, against the exact checkerboard"),
        &errors.colour,
    );
    Ok(())
}

/// Points with coefficients by `method`, and how many of these were cut.
fn plane(
    method: Method,
    shades: [f64; 2],
) -> Result<(splatline_sim::scene::points::SurfaceScene, usize), GalleryError> {
    let field = HeightField::from_heights(POINTS, POINTS, 1.0, |_, _| 0.0);
    let side = TEXELS * (POINTS - 1);
    // Rows of texels run to the south.
    let place = |u: f64, v: f64| {
        let middle = 0.5 * (POINTS - 1) as f64;
        [u / TEXELS as f64 - middle, middle - v / TEXELS as f64]
    };
    let texture = Texture::from_pattern(side, side, |u, v| [shade(place(u, v), shades); 3]);
    let draped = drape(
        &field,
        "checkerboard",
        &texture,
        method,
        Style::opaque(1.0).cutoff,
    )?;
    Ok((draped.scene, draped.cut))
}

/// The pattern; its edges lie at multiples of [`FIELD`].
fn shade([x, y]: [f64; 2], shades: [f64; 2]) -> f64 {
    let number = (x / FIELD).floor() + (y / FIELD).floor();
    shades[usize::from(number.rem_euclid(2.0) == 1.0)]
}

fn camera() -> Camera {
    Camera {
        width: SIZE[0],
        height: SIZE[1],
        fx: MAGNIFICATION,
        fy: MAGNIFICATION,
        cx: 0.5 * SIZE[0] as f64 + 0.4,
        cy: 0.5 * SIZE[1] as f64 - 0.3,
        rotation: [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]],
        translation: [0.0, 0.0, 20.0],
        near: 0.01,
        far: 1e10,
        orthographic: true,
    }
}

fn in_plane(camera: &Camera, column: usize, row: usize) -> [f64; 2] {
    [
        (column as f64 + 0.5 - camera.cx) / camera.fx,
        (camera.cy - row as f64 - 0.5) / camera.fy,
    ]
}

fn exact(camera: &Camera, shades: [f64; 2]) -> Picture {
    let mut picture = Picture::new(camera.width, camera.height);
    for (index, pixel) in picture.pixels.iter_mut().enumerate() {
        let place = in_plane(camera, index % camera.width, index / camera.width);
        let value = shade(place, shades);
        *pixel = [value, value, value, 1.0];
    }
    picture
}

/// Mean way from 10 % to 90 % of the contrast over the vertical edges of the row of fields above y = 0.
fn edge_width(picture: &Picture) -> f64 {
    let camera = camera();
    // Rows of four spacings in the middle of the row of fields: corners stay out, the grid's period is averaged.
    let middle = camera.cy - 0.5 * FIELD * MAGNIFICATION;
    let first = (middle - 2.0 * MAGNIFICATION) as usize;
    let rows = first..first + (4.0 * MAGNIFICATION) as usize;
    let count = rows.len() as f64;
    let mean = |column: usize| {
        let values = rows
            .clone()
            .map(|row| picture.pixels[row * picture.width + column][0]);
        (values.sum::<f64>() / count - SHADES[0]) / (SHADES[1] - SHADES[0])
    };
    let profile: Vec<f64> = (0..picture.width).map(mean).collect();
    let reach = (0.4 * FIELD * MAGNIFICATION) as usize;
    let edges = (-2..=2).map(|k| (camera.cx + f64::from(k) * FIELD * MAGNIFICATION) as usize);
    let widths: Vec<f64> = edges
        .map(|edge| width_at(&profile[edge - reach..edge + reach]))
        .collect();
    widths.iter().sum::<f64>() / widths.len() as f64
}

/// Pixels between the last value of at most 10 % and the first of at least 90 % around the middle of a profile, or the other way round.
fn width_at(profile: &[f64]) -> f64 {
    let rising = profile.last() > profile.first();
    let profile: Vec<f64> = if rising {
        profile.to_vec()
    } else {
        profile.iter().rev().copied().collect()
    };
    let crossing = profile.iter().position(|value| *value >= 0.5).unwrap_or(0);
    let between = |index: usize, level: f64| {
        let (before, after) = (profile[index - 1], profile[index]);
        index as f64 - (after - level) / (after - before)
    };
    let low = (1..=crossing).rev().find(|&i| profile[i - 1] <= 0.1);
    let high = (crossing.max(1)..profile.len()).find(|&i| profile[i] >= 0.9);
    match (low, high) {
        (Some(low), Some(high)) => between(high, 0.9) - between(low, 0.1),
        _ => f64::NAN,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_width_of_a_ramp_is_four_fifths_of_it() {
        let ramp: Vec<f64> = (0..60)
            .map(|i| ((f64::from(i) - 20.3) / 10.0).clamp(0.0, 1.0))
            .collect();
        assert!((width_at(&ramp) - 8.0).abs() < 1e-9);
        let falling: Vec<f64> = ramp.iter().map(|value| 1.0 - value).collect();
        assert!((width_at(&falling) - 8.0).abs() < 1e-9);
        let step: Vec<f64> = (0..20).map(|i| f64::from(i / 10)).collect();
        assert!((width_at(&step) - 0.8).abs() < 1e-9);
    }

    #[test]
    fn optimised_edges_are_sharper_and_nearer_to_the_truth() {
        let exhibit = magnified().unwrap();
        let value = |name: &str| {
            let found = exhibit.numbers.iter().find(|(what, _, _)| what == name);
            found.unwrap_or_else(|| panic!("{name}")).1
        };
        let width = |name: &str| value(&format!("{name}: edge width"));
        assert!(width("optimised") < 0.8 * width("plain") && width("plain") < width("prefiltered"));
        let psnr = |name: &str| value(&format!("{name}, against the exact checkerboard: PSNR"));
        assert!(psnr("optimised") > psnr("plain") + 0.8 && psnr("plain") > psnr("prefiltered"));
        for method in Method::ALL {
            let error = value(&format!(
                "{}, fixed against float, colour: PSNR",
                method.name()
            ));
            assert!(error >= 60.0, "{error}");
        }
    }
}
