//! Exhibits of systems 6, 7, 14, 15 and 16: antialiasing, kernels, hybrid points, spheres and stamps.

mod hybrid;
mod plane;
mod shapes;
mod sphere;
mod stamp;

use super::Exhibit;
use splatline_sim::design::DesignChoice;
use splatline_sim::metrics::compare;
use splatline_sim::picture::Picture;
use splatline_sim::scene::{self, LoadOptions, Scene};
use std::path::{Path, PathBuf};

pub use hybrid::camera as distant_camera;
pub use plane::{KernelPlane, plane};

/// All exhibits; those that need a data set that is missing say so in their caption and have no pictures.
///
/// `data` is the folder that holds `volumes/aneurism.nhdr`. Takes about a minute.
pub fn kernels(data: &Path) -> Vec<Exhibit> {
    NAMES.iter().flat_map(|name| some(data, name)).collect()
}

/// Names of the groups of exhibits, in the order in which they are shown.
pub const NAMES: [&str; 5] = ["shapes", "antialias", "spheres", "hybrid", "stamps"];

/// One group of exhibits by its name of [`NAMES`]; none for another name.
pub fn some(data: &Path, name: &str) -> Vec<Exhibit> {
    let with_aneurism =
        |exhibits: fn(Result<&Scene, &PathBuf>) -> Vec<Exhibit>| exhibits(aneurism(data).as_ref());
    match name {
        "shapes" => vec![shapes::exhibit()],
        "antialias" => vec![plane::isotropic(), plane::anisotropic()],
        "spheres" => vec![sphere::exhibit()],
        "hybrid" => with_aneurism(|scene| vec![hybrid::distances(scene), hybrid::zoom(scene)]),
        "stamps" => with_aneurism(|scene| vec![stamp::phases(scene), stamp::on_the_plane()]),
        _ => Vec::new(),
    }
}

/// The volume that shows many small splats: arteries in a 256^3 grid.
fn aneurism(data: &Path) -> Result<Scene, PathBuf> {
    let path = data.join("volumes/aneurism.nhdr");
    scene::load(&path, &LoadOptions::default()).map_err(|_| path)
}

/// The exhibit of a scene whose file is missing.
fn without(name: &str, equation: &'static str, missing: &Path) -> Exhibit {
    Exhibit {
        name: name.to_owned(),
        equation,
        caption: format!(
            "Not drawn: '{}' cannot be read. Name the folder that holds it with --data.",
            missing.display()
        ),
        pictures: Vec::new(),
        numbers: Vec::new(),
    }
}

fn standard24() -> DesignChoice {
    match DesignChoice::named("standard24") {
        Some(design) => design,
        None => unreachable!("standard24 is a named design"),
    }
}

/// PSNR, largest difference and bias of a fixed-point picture against its float counterpart, the worse channel group.
fn errors(what: &str, fixed: &Picture, float: &Picture) -> Vec<(String, f64, String)> {
    let Ok(errors) = compare(fixed, float) else {
        return vec![(
            format!("{what}: pictures cannot be compared"),
            f64::NAN,
            String::new(),
        )];
    };
    let (colour, alpha) = (errors.colour, errors.alpha);
    let bias = if colour.bias.abs() > alpha.bias.abs() {
        colour.bias
    } else {
        alpha.bias
    };
    vec![
        number(
            format!("{what}: PSNR"),
            colour.psnr_db.min(alpha.psnr_db),
            "dB",
        ),
        number(
            format!("{what}: largest difference"),
            colour.max_abs.max(alpha.max_abs),
            "",
        ),
        number(format!("{what}: bias"), bias, ""),
    ]
}

fn number(what: impl Into<String>, value: f64, unit: &str) -> (String, f64, String) {
    (what.into(), value, unit.to_owned())
}
