//! The live page: one HTML file in which the kernel draws a scene, compiled to WebAssembly, with its widths on sliders.
//!
//! The module's bytes ([`WASM`]) are built from `sim/page` by `sim/page/build.sh`, which `.ci/run` repeats to see that
//! they are what the sources give. The page holds them, the scene ([`bytes`]), and the checksum of the picture that the
//! host's kernel draws of it: the page draws the same picture first and says whether its bits are the same.

pub mod bytes;

use crate::camera::Camera;
use crate::design::{DesignChoice, NAMES};
use crate::fixed::{self, Options};
use crate::report::html::escape;
use crate::report::scale::PERCENTILE;
use crate::report::shell::Shell;
use crate::report::table::count;
use crate::report::viewer::packed;
use crate::scene::Scene;
use anyhow::{Context, Result, ensure};
use serde::Serialize;
use splatline::format::{Rounding, Traversal, WIDTH_RANGES};
use std::collections::BTreeMap;

/// The kernel and the reference, compiled from `sim/page`.
pub const WASM: &[u8] = include_bytes!("page.wasm");

/// The most splats that a page takes: beyond, a browser needs seconds for a picture and the file is larger than mail
/// carries.
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
pub struct Shown<'a> {
    pub scene: &'a Scene,
    /// The first view.
    pub camera: &'a Camera,
    /// Rules of blending, and the first widths and traversal.
    pub options: Options<'a>,
    /// What the camera turns around.
    pub target: [f64; 3],
    /// The axis that it turns around.
    pub up: [f64; 3],
}

pub fn html(shown: &Shown) -> Result<String> {
    let splats = shown.scene.splats.len();
    ensure!(
        splats <= MOST_SPLATS,
        "the scene has {splats} splats, and a live page takes at most {MOST_SPLATS}: thin the scene out, or use `splatline compare`"
    );
    let bytes = bytes::encode(shown.scene, shown.options.rules);
    let checksum = host_checksum(shown, &bytes);
    let checksum = checksum.context("the scene cannot be brought into a page")?;
    let settings = serde_json::to_string(&settings(shown, checksum))?;
    let facts = format!(
        "{} splats at {} × {}, rules {}.",
        count(splats as u64),
        shown.camera.width,
        shown.camera.height,
        escape(shown.options.rules.name)
    );
    let scripts = format!(
        "<script type=\"application/json\" id=\"settings\">{settings}</script>\n\
         <script type=\"text/plain\" id=\"wasm\">{wasm}</script>\n\
         <script type=\"text/plain\" id=\"scene\">{scene}</script>\n\
         <script>\n{script}</script>\n",
        // In JSON a slash may be escaped, and then no text of a stranger's ends the script.
        settings = settings.replace('/', "\\/").replace("<!", "\\u003c!"),
        wasm = packed(WASM)?,
        scene = packed(&bytes)?,
        script = include_str!("page.js"),
    );
    let name = &shown.scene.name;
    let shell = Shell {
        title: &format!("{name}: splatline, live"),
        product: "splatline: a scene drawn while you watch, fixed point beside float",
        heading: name,
        facts: &format!(
            "<p class=\"facts\">{facts} <b id=\"same\" class=\"unknown\">drawing</b></p>\n<p class=\"bad\" id=\"failure\" hidden></p>\n"
        ),
        body: include_str!("page.html"),
        footer: &include_str!("footer.html").replace("{version}", env!("CARGO_PKG_VERSION")),
        scripts: &scripts,
        script_policy: " 'wasm-unsafe-eval'",
    };
    Ok(shell.html())
}

/// The checksum of the host's picture of what the page holds.
fn host_checksum(shown: &Shown, bytes: &[u8]) -> Option<u64> {
    let (scene, rules) = bytes::decode(bytes)?;
    let options = Options {
        rules: &rules,
        ..shown.options
    };
    let drawing = fixed::draw(&scene, shown.camera, &options);
    let words = drawing
        .pixels
        .iter()
        .flat_map(|pixel| pixel.colour.into_iter().chain([pixel.transmittance]));
    Some(bytes::checksum(words))
}

/// What the page's script reads.
#[derive(Serialize)]
struct LiveSettings<'a> {
    splats: usize,
    camera: [f64; bytes::CAMERA],
    target: [f64; 3],
    up: [f64; 3],
    widths: Vec<WidthSlider>,
    designs: BTreeMap<String, DesignSettings>,
    /// Buttons lie from small to large.
    order: Vec<&'a str>,
    design: &'a str,
    percentile: f64,
    checksum: String,
}

#[derive(Serialize)]
struct WidthSlider {
    name: &'static str,
    low: u8,
    high: u8,
    about: &'static str,
}

#[derive(Serialize)]
struct DesignSettings {
    widths: [u8; WIDTH_RANGES.len()],
    rounding: u8,
    traversal: u8,
}

impl DesignSettings {
    fn new(design: &DesignChoice, traversal: Traversal) -> DesignSettings {
        DesignSettings {
            widths: design.widths.numbers(),
            rounding: match design.widths.rounding {
                Rounding::Nearest => 0,
                Rounding::Truncate => 1,
                Rounding::NearestEven => 2,
            },
            traversal: u8::from(traversal == Traversal::Spans),
        }
    }
}

fn settings<'a>(shown: &'a Shown, checksum: u64) -> LiveSettings<'a> {
    let widths = WIDTH_RANGES.iter().zip(ABOUT);
    let slider = |(&(name, low, high), about)| WidthSlider {
        name,
        low,
        high,
        about,
    };
    let design = shown.options.design;
    let named = NAMES.into_iter().filter_map(DesignChoice::named);
    let named = named.map(|design| (design.traversal, design));
    // The last of a name counts.
    let all = named.chain([(shown.options.traversal, design.clone())]);
    let by_name = |(traversal, design): (Traversal, DesignChoice)| {
        let settings = DesignSettings::new(&design, traversal);
        (design.name, settings)
    };
    let designs = all.map(by_name).collect();
    let mut order = NAMES.to_vec();
    if !order.contains(&design.name.as_str()) {
        order.push(&design.name);
    }
    LiveSettings {
        splats: shown.scene.splats.len(),
        camera: camera_numbers(shown.camera),
        target: shown.target,
        up: shown.up,
        widths: widths.map(slider).collect(),
        designs,
        order,
        design: &design.name,
        percentile: PERCENTILE,
        checksum: format!("{checksum:016x}"),
    }
}

/// The camera as the page's wasm takes it. JSON writes an infinite far plane as null, and every other double so that it
/// is read back the same.
fn camera_numbers(camera: &Camera) -> [f64; bytes::CAMERA] {
    let [width, height] = [camera.width, camera.height].map(|side| side as f64);
    let head = [width, height, camera.fx, camera.fy, camera.cx, camera.cy];
    let orthographic = u8::from(camera.orthographic).into();
    let tail = [camera.near, camera.far, orthographic];
    let mut all = head
        .iter()
        .chain(camera.rotation.as_flattened())
        .chain(&camera.translation)
        .chain(&tail);
    std::array::from_fn(|_| all.next().copied().unwrap_or_default())
}

#[cfg(test)]
mod tests;
