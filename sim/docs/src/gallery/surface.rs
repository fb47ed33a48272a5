//! Exhibits of the surface splats: systems 2, 3, 9, 10, 11 and 12.

mod edges;
mod flattening;
mod lion;
mod shading;
mod transparent;

use super::Exhibit;
use splatline::format::Traversal;
use splatline_sim::camera::{Camera, CameraError};
use splatline_sim::design::DesignChoice;
use splatline_sim::fixed::surface::SurfaceDrawing;
use splatline_sim::metrics::{CompareError, compare};
use splatline_sim::picture::Picture;
use splatline_sim::scene::LoadError;
use splatline_sim::scene::points::SurfaceScene;
use splatline_sim::surface::Style;
use splatline_sim::texture::solve::NotConverged;
use splatline_sim::{fixed, reference};
use std::path::Path;

/// Why an exhibit could not be made.
#[derive(Debug, thiserror::Error)]
pub enum GalleryError {
    /// A cloud could not be loaded.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// A camera makes no sense.
    #[error(transparent)]
    Camera(#[from] CameraError),
    /// Two pictures could not be compared.
    #[error(transparent)]
    Compare(#[from] CompareError),
    /// Texture coefficients were not found.
    #[error(transparent)]
    Coefficients(#[from] NotConverged),
    /// A scene could not be drawn as points and splats.
    #[error("{0}")]
    Points(String),
}

/// All exhibits; that of the scanned cloud only where `data` holds it.
pub fn surface(data: &Path) -> Result<Vec<Exhibit>, GalleryError> {
    let mut exhibits = Vec::new();
    let cloud = data.join("points/lion_takanawa.ply");
    if cloud.is_file() {
        exhibits.push(lion::lion(&cloud)?);
    }
    exhibits.push(transparent::transparent()?);
    exhibits.push(edges::edges()?);
    exhibits.push(shading::shading()?);
    exhibits.push(flattening::flattening()?);
    exhibits.push(flattening::plane_depth()?);
    Ok(exhibits)
}

/// The design that the bars are stated for.
pub(super) fn standard() -> DesignChoice {
    DesignChoice::named("standard24").unwrap_or_else(|| unreachable!("a named design"))
}

/// Draws through the kernel.
fn draw_fixed(scene: &SurfaceScene, camera: &Camera, style: &Style) -> SurfaceDrawing {
    fixed::surface::draw(scene, camera, style, &standard(), Traversal::Spans)
}

/// Draws by both engines, notes colour and alpha errors, returns the kernel's drawing and the reference's picture.
pub(super) fn draw_both(
    exhibit: &mut Exhibit,
    what: &str,
    scene: &SurfaceScene,
    camera: &Camera,
    style: &Style,
) -> Result<(SurfaceDrawing, Picture), CompareError> {
    let drawing = draw_fixed(scene, camera, style);
    let float = reference::surface::draw(scene, camera, style).picture;
    let errors = compare(&drawing.picture, &float)?;
    exhibit.errors(&format!("{what}, colour"), &errors.colour);
    exhibit.errors(&format!("{what}, alpha"), &errors.alpha);
    Ok((drawing, float))
}

/// An exhibit without pictures and numbers.
pub(super) fn exhibit(name: &str, equation: &'static str, caption: &str) -> Exhibit {
    Exhibit {
        name: name.to_owned(),
        equation,
        caption: caption.to_owned(),
        pictures: Vec::new(),
        numbers: Vec::new(),
    }
}

/// A premultiplied picture over white paper, as a page shows it.
pub(super) fn on_paper(picture: &Picture) -> Picture {
    let mut shown = picture.clone();
    for [r, g, b, a] in &mut shown.pixels {
        let paper = 1.0 - *a;
        (*r, *g, *b, *a) = (*r + paper, *g + paper, *b + paper, 1.0);
    }
    shown
}
