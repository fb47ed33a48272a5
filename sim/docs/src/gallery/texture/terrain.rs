//! A height field with its photograph, from above and obliquely.

use super::super::Exhibit;
use super::super::surface::{GalleryError, draw_both, exhibit, on_paper};
use super::without;
use splatline_sim::camera::Camera;
use splatline_sim::metrics::compare;
use splatline_sim::picture::Picture;
use splatline_sim::scene::points::height_field::{HeightField, USUAL_SPACING};
use splatline_sim::surface::Style;
use splatline_sim::texture::Texture;
use splatline_sim::texture::coefficients::Method;
use splatline_sim::texture::drape::drape;
use std::path::Path;

const NAME: &str = "A height field with its photograph";
const EQUATION: &str = "[SURF] section 5 (system 13)";

/// Columns and rows of the view from above.
const ABOVE: usize = 512;
/// The photograph's border that the view from above leaves out, where the surface ends: pixels.
const BORDER: usize = 8;

/// Heights and photograph; none where the data folder has none.
pub fn load(data: &Path) -> Result<Option<(HeightField, Texture)>, GalleryError> {
    let heights = data.join("terrain/vtkjs_dem.csv");
    if !heights.is_file() {
        return Ok(None);
    }
    let field = HeightField::load(&heights, USUAL_SPACING)?;
    let photograph = Texture::load(&heights.with_extension("jpg"))?;
    Ok(Some((field, photograph)))
}

/// Three ways to the colours.
pub fn draped(data: &Path) -> Result<Exhibit, GalleryError> {
    let Some((field, photograph)) = load(data)? else {
        return Ok(without(NAME, EQUATION, &data.join("terrain/vtkjs_dem.csv")));
    };
    let mut exhibit = exhibit(
        NAME,
        EQUATION,
        "65,536 heights and a photograph of 2048 x 2048 texels, 8 per spacing and direction (vtk.js example data), as opaque surface splats whose frames follow \
         the slope. Coefficients by plain sampling, pre-filtered, and optimised. From above, at two pixels per spacing, the picture is held \
         against the photograph averaged by the pixel's Gaussian, which is what a perfect texture would show.",
    );
    let oblique = Camera::look_at(
        [0.0, -24.0, 12.0],
        [0.0, -2.0, 1.0],
        [0.0, 0.0, 1.0],
        45.0,
        480,
        300,
    )?;
    let (above, truth) = (above(&field), averaged(&photograph));
    for method in Method::ALL {
        let name = method.name();
        let style = Style::opaque(3.0 * USUAL_SPACING);
        let draped = drape(&field, "vtkjs_dem", &photograph, method, style.cutoff)?;
        let what = format!("{name}, oblique, fixed against float");
        let (drawing, _) = draw_both(&mut exhibit, &what, &draped.scene, &oblique, &style)?;
        exhibit
            .pictures
            .push((name.to_owned(), on_paper(&drawing.picture)));
        let what = format!("{name}, from above, fixed against float");
        let (drawing, _) = draw_both(&mut exhibit, &what, &draped.scene, &above, &style)?;
        let errors = compare(&inner(&drawing.picture), &truth)?;
        exhibit.errors(
            &format!("{name}, from above, against the photograph"),
            &errors.colour,
        );
        if method == Method::Optimised {
            exhibit.number(
                "optimised: iterations of the solver",
                draped.iterations as f64,
                "",
            );
            exhibit.number(
                "optimised: points cut to the range of colours",
                draped.cut as f64,
                "",
            );
        }
    }
    exhibit.insets([180, 150], [96, 60]);
    Ok(exhibit)
}

/// Straight down, so that the field's borders are the picture's.
fn above(field: &HeightField) -> Camera {
    let scale = ABOVE as f64 / (field.spacing * (field.columns - 1) as f64);
    Camera {
        width: ABOVE,
        height: ABOVE,
        fx: scale,
        fy: scale,
        cx: 0.5 * ABOVE as f64,
        cy: 0.5 * ABOVE as f64,
        rotation: [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]],
        translation: [0.0, 0.0, 50.0],
        near: 0.01,
        far: 1e10,
        orthographic: true,
    }
}

/// The photograph under a Gaussian of one pixel's deviation, without the border.
fn averaged(photograph: &Texture) -> Picture {
    let texels = photograph.width as f64 / ABOVE as f64;
    let mut whole = Picture::new(ABOVE, ABOVE);
    let reach = (3.0 * texels) as isize;
    for (index, pixel) in whole.pixels.iter_mut().enumerate() {
        let [u, v] = [index % ABOVE, index / ABOVE].map(|c| (c as f64 + 0.5) * texels);
        let (mut sum, mut colour) = (0.0, [0.0; 3]);
        for dy in -reach..reach {
            for dx in -reach..reach {
                let (x, y) = (u as isize + dx, v as isize + dy);
                let inside = |c: isize, size: usize| (0..size as isize).contains(&c);
                if !inside(x, photograph.width) || !inside(y, photograph.height) {
                    continue;
                }
                let [a, b] = [x as f64 + 0.5 - u, y as f64 + 0.5 - v].map(|d| d / texels);
                let weight = (-0.5 * (a * a + b * b)).exp();
                sum += weight;
                let texel = photograph.texels[y as usize * photograph.width + x as usize];
                colour
                    .iter_mut()
                    .zip(texel)
                    .for_each(|(c, t)| *c += weight * t);
            }
        }
        let [r, g, b] = colour.map(|c| c / sum);
        *pixel = [r, g, b, 1.0];
    }
    inner(&whole)
}

/// A picture without its border.
fn inner(picture: &Picture) -> Picture {
    let (width, height) = (picture.width - 2 * BORDER, picture.height - 2 * BORDER);
    let mut inner = Picture::new(width, height);
    for (index, pixel) in inner.pixels.iter_mut().enumerate() {
        let (x, y) = (index % width + BORDER, index / width + BORDER);
        *pixel = picture.pixels[y * picture.width + x];
    }
    inner
}
