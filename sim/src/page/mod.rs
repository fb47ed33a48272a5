//! The live page: one HTML file in which the kernel draws a scene, compiled to WebAssembly, with its widths on sliders.
//!
//! The module's bytes ([`WASM`]) are built from `sim/page` by `sim/page/build.sh`, which `.ci/run` repeats to see that they are what the sources
//! give. The page holds them, the scene ([`bytes`]), and the checksum of the picture that the host's kernel draws of it: the page draws the
//! same picture first and says whether its bits are the same.

pub mod bytes;

use crate::camera::Camera;
use crate::design::{DesignChoice, NAMES};
use crate::fixed::{self, Options};
use crate::report::html::escape;
use crate::report::scale::PERCENTILE;
use crate::report::table::count;
use crate::report::viewer::packed;
use crate::rules::{Compositing, Rules};
use crate::scene::Scene;
use serde_json::{Value, json};
use splatline::format::{Rounding, Traversal, WIDTH_RANGES};

/// The kernel and the reference, compiled from `sim/page`.
pub const WASM: &[u8] = include_bytes!("page.wasm");

/// The most splats that a page takes: beyond, a browser needs seconds for a picture and the file is larger than mail carries.
pub const MOST_SPLATS: usize = 500_000;

/// What each width is of, in the order of [`WIDTH_RANGES`].
const ABOUT: [&str; WIDTH_RANGES.len()] = [
    "magnitude bits of a splat's difference to the eye",
    "magnitude bits from camera space to a footprint's centre",
    "magnitude bits of setup's mantissas and of the row seeds",
    "fraction bits of a footprint's centre, in pixels",
    "fraction bits of the radial index in the pixel lanes",
    "the footprint table has 2 to this many intervals",
    "bits of the interpolator's multiplier; 0 is none",
    "fraction bits of a footprint table's entry",
    "fraction bits of a footprint's peak opacity",
    "fraction bits of a splat's opacity at a pixel",
    "fraction bits of the deep alpha channel",
    "fraction bits of a splat's colour",
    "fraction bits of the pixel's accumulated colour",
];

/// What a page shows.
#[derive(Clone, Copy)]
pub struct Shown<'a> {
    /// The splats.
    pub scene: &'a Scene,
    /// The first view.
    pub camera: &'a Camera,
    /// Rules of blending.
    pub rules: &'a Rules,
    /// The first widths.
    pub design: &'a DesignChoice,
    /// The first traversal.
    pub traversal: Traversal,
    /// What the camera turns around.
    pub target: [f64; 3],
    /// The axis that it turns around.
    pub up: [f64; 3],
}

/// Why a page could not be made.
#[derive(Debug, thiserror::Error)]
pub enum LivePageError {
    /// Too many splats.
    #[error(
        "the scene has {0} splats, and a live page takes at most {MOST_SPLATS}: thin the scene out, or use `splatline compare`"
    )]
    TooLarge(usize),
    /// The bytes just written could not be read back.
    #[error("the scene cannot be brought into a page")]
    Scene,
    /// Compression failed.
    #[error("cannot compress the page's scene: {0}")]
    Io(#[from] std::io::Error),
}

/// The whole file.
pub fn html(shown: &Shown) -> Result<String, LivePageError> {
    let splats = shown.scene.splats.len();
    if splats > MOST_SPLATS {
        return Err(LivePageError::TooLarge(splats));
    }
    let bytes = bytes::encode(shown.scene, shown.rules);
    let checksum = host_checksum(shown, &bytes).ok_or(LivePageError::Scene)?;
    let settings = settings(shown, checksum).to_string();
    let facts = format!(
        "{} splats at {} × {}, rules {}.",
        count(splats as u64),
        shown.camera.width,
        shown.camera.height,
        escape(shown.rules.name)
    );
    let body = include_str!("page.html")
        .replace("{facts}", &facts)
        .replace("{version}", env!("CARGO_PKG_VERSION"))
        .replace("{name}", &escape(&shown.scene.name));
    Ok(format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src 'unsafe-inline' 'wasm-unsafe-eval'; style-src 'unsafe-inline'; img-src data:\">\n\
         <title>{title}: splatline, live</title>\n<style>\n{style}{live}</style>\n</head>\n<body>\n{body}\
         <script type=\"application/json\" id=\"settings\">{settings}</script>\n\
         <script type=\"text/plain\" id=\"wasm\">{wasm}</script>\n\
         <script type=\"text/plain\" id=\"scene\">{scene}</script>\n\
         <script>\n{script}</script>\n</body>\n</html>\n",
        title = escape(&shown.scene.name),
        style = include_str!("../report/page.css"),
        live = include_str!("live.css"),
        // In JSON a slash may be escaped, and then no text of a stranger's ends the script.
        settings = settings.replace('/', "\\/").replace("<!", "\\u003c!"),
        wasm = packed(WASM)?,
        scene = packed(&bytes)?,
        script = include_str!("page.js"),
    ))
}

/// The checksum of the host's picture of what the page holds.
fn host_checksum(shown: &Shown, bytes: &[u8]) -> Option<u64> {
    let (scene, rules) = bytes::decode(bytes)?;
    let options = Options {
        rules: &rules,
        compositing: Compositing::FrontToBack,
        design: shown.design,
        traversal: shown.traversal,
    };
    let drawing = fixed::draw(&scene, shown.camera, &options);
    let words = drawing
        .pixels
        .iter()
        .flat_map(|pixel| pixel.colour.into_iter().chain([pixel.transmittance]));
    Some(bytes::checksum(words))
}

fn settings(shown: &Shown, checksum: u64) -> Value {
    let widths: Vec<Value> = WIDTH_RANGES
        .iter()
        .zip(ABOUT)
        .map(|((name, low, high), about)| json!({"name": name, "low": low, "high": high, "about": about}))
        .collect();
    let mut designs = serde_json::Map::new();
    for name in NAMES {
        if let Some(choice) = DesignChoice::named(name) {
            designs.insert(name.to_owned(), design_settings(&choice, choice.traversal));
        }
    }
    designs.insert(
        shown.design.name.clone(),
        design_settings(shown.design, shown.traversal),
    );
    // A map's keys come back in alphabetical order; buttons lie from small to large.
    let mut order = NAMES.to_vec();
    if !order.contains(&shown.design.name.as_str()) {
        order.push(&shown.design.name);
    }
    json!({
        "splats": shown.scene.splats.len(),
        "camera": camera_numbers(shown.camera),
        "target": shown.target,
        "up": shown.up,
        "widths": widths,
        "designs": designs,
        "order": order,
        "design": shown.design.name,
        "percentile": PERCENTILE,
        "checksum": format!("{checksum:016x}"),
    })
}

fn design_settings(design: &DesignChoice, traversal: Traversal) -> Value {
    json!({
        "widths": design.widths.numbers(),
        "rounding": u8::from(design.widths.rounding == Rounding::Truncate),
        "traversal": u8::from(traversal == Traversal::Spans),
    })
}

/// The camera as the page's wasm takes it. JSON writes an infinite far plane as null, and every other double so that it is read back the same.
fn camera_numbers(camera: &Camera) -> [f64; bytes::CAMERA] {
    let Camera {
        width,
        height,
        fx,
        fy,
        cx,
        cy,
        rotation,
        translation,
        near,
        far,
        orthographic,
    } = camera;
    let head = [*width as f64, *height as f64, *fx, *fy, *cx, *cy];
    let tail = [*near, *far, f64::from(u8::from(*orthographic))];
    let mut all = head
        .iter()
        .chain(rotation.as_flattened())
        .chain(translation)
        .chain(&tail);
    std::array::from_fn(|_| all.next().copied().unwrap_or_default())
}

#[cfg(test)]
mod tests;
