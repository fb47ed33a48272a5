//! Exhibits of systems 13 and 17: texture coefficients, a height field with its photograph, warped depth images and textures.

mod checkerboard;
mod plane;
mod terrain;
mod warp;

use super::Exhibit;
use super::surface::{GalleryError, exhibit, standard};
use splatline_sim::camera::Camera;
use splatline_sim::fixed::{HybridDrawing, Options, draw_hybrid};
use splatline_sim::hybrid::Hybrid;
use splatline_sim::metrics::compare;
use splatline_sim::picture::Picture;
use splatline_sim::reference;
use splatline_sim::rules::Compositing;
use splatline_sim::scene::Scene;
use splatline_sim::texture::warp::rules;
use std::path::Path;

/// Names of the groups of exhibits, in the order in which they are shown.
pub const NAMES: [&str; 4] = ["checkerboard", "terrain", "warp", "plane"];

/// One group by its name of [`NAMES`]; nothing for another name.
///
/// `data` is the folder that holds `terrain/vtkjs_dem.csv`; where it does not, the captions say so.
pub fn some(data: &Path, name: &str) -> Result<Vec<Exhibit>, GalleryError> {
    match name {
        "checkerboard" => Ok(vec![checkerboard::magnified()?]),
        "terrain" => Ok(vec![terrain::draped(data)?]),
        "warp" => Ok(vec![warp::depth_image(data)?]),
        "plane" => Ok(vec![plane::textured()?]),
        _ => Ok(Vec::new()),
    }
}

/// The exhibit of a data set that is missing.
fn without(name: &str, equation: &'static str, missing: &Path) -> Exhibit {
    let caption = format!(
        "Not drawn: '{}' cannot be read. Name the folder that holds it with --data.",
        missing.display()
    );
    exhibit(name, equation, &caption)
}

/// Draws samples as points and splats by both engines, notes share of points and errors, returns both pictures.
fn draw_samples(
    exhibit: &mut Exhibit,
    what: &str,
    samples: &Scene,
    camera: &Camera,
    hybrid: &Hybrid,
) -> Result<[Picture; 2], GalleryError> {
    let (rules, design) = (rules(samples), standard());
    let options = Options {
        rules: &rules,
        compositing: Compositing::FrontToBack,
        design: &design,
        traversal: design.traversal,
    };
    let drawn = draw_hybrid(samples, camera, &options, hybrid).map_err(GalleryError::Points)?;
    let float = reference::hybrid::draw(samples, camera, &rules, hybrid).picture;
    let HybridDrawing {
        drawing,
        points,
        drawn,
        ..
    } = drawn;
    let errors = compare(&drawing.picture, &float)?;
    exhibit.number(format!("{what}: samples drawn"), drawn as f64, "");
    exhibit.number(
        format!("{what}: share of points"),
        points as f64 / drawn.max(1) as f64,
        "",
    );
    exhibit.errors(
        &format!("{what}, fixed against float, colour"),
        &errors.colour,
    );
    exhibit.errors(
        &format!("{what}, fixed against float, alpha"),
        &errors.alpha,
    );
    Ok([drawing.picture, float])
}
