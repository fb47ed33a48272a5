//! The engine `fixed` for surfaces: points quantised once, then gathered by the kernel, tile by tile, in the scene's
//! order.
//!
//! ```text
//! quantise -> setup -> tiles -> resolve (kernel) -> picture
//! ```
//!
//! Setup and tiles are vectors' where these can do it, else the kernel's. There is no sorting: the accumulation buffer
//! decides by depth and the layered buffer takes any order.

mod renderer;
mod tiles;

pub use renderer::{SurfaceFacts, SurfaceRenderer};
pub use tiles::HostCell;

use super::quantise::{axis, exp2, position, scale_log2, scaled, view};
use super::render::{PaintEngine, best_engine};
use crate::camera::Camera;
use crate::design::DesignChoice;
use crate::fast::setup::SurfaceOutcome;
use crate::picture::Picture;
use crate::scene::points::{Material, SurfacePoint, SurfaceScene};
use crate::surface::Style;
use crate::vector;
use fixed::types::U4F28;
use rayon::prelude::*;
use splatline::blend::Pixel;
use splatline::blend::shading;
use splatline::format::Traversal;
use splatline::rules as kernel;
use splatline::setup::setup_surface;
use splatline::splat::surface::SurfaceSplat;
use splatline::view::View;

/// Points in the kernel's formats.
#[derive(Clone, Debug)]
pub struct QuantisedPoints {
    /// The camera.
    pub view: View,
    /// The splats, in the scene's order.
    pub splats: Vec<SurfaceSplat>,
    /// Kernel scene units per scene unit, as a power of two.
    pub scale_log2: i32,
    /// Points of which a coordinate is not finite.
    pub clamped: usize,
}

impl QuantisedPoints {
    /// Quantises what both engines draw.
    pub fn new(scene: &SurfaceScene, camera: &Camera) -> Self {
        let scale_log2 = scale_log2(scene.points.iter().map(|point| point.centre), camera);
        let beyond = |p: &&SurfacePoint| p.centre.iter().any(|c| !c.is_finite());
        QuantisedPoints {
            view: view(camera, scale_log2),
            splats: scene
                .points
                .par_iter()
                .map(|p| splat(p, scale_log2))
                .collect(),
            scale_log2,
            clamped: scene.points.par_iter().filter(beyond).count(),
        }
    }
}

fn splat(point: &SurfacePoint, scale_log2: i32) -> SurfaceSplat {
    SurfaceSplat {
        centre: position(point.centre, scale_log2),
        frame: point.frame.map(|tangent| axis(tangent, scale_log2)),
        normal: axis(point.normal, 0),
        weight: scaled(point.weight),
        colour: point.colour.map(U4F28::saturating_from_num),
        opacity: U4F28::saturating_from_num(point.opacity),
        material: point.material,
    }
}

/// What a drawing gives.
#[derive(Clone, Debug)]
pub struct SurfaceDrawing {
    /// The picture, converted to double precision without further rounding.
    pub picture: Picture,
    /// The kernel's pixels, row-major.
    pub pixels: Vec<Pixel>,
    /// Weight sums of all fragments of each pixel, in units of 1.0.
    pub weights: Vec<f64>,
    /// Points of which a coordinate was clamped to its format.
    pub clamped: usize,
    /// Points culled, pixels covered, and times of the stages.
    pub facts: SurfaceFacts,
}

/// Footprints of all points, in the scene's order.
pub fn footprints(
    points: &QuantisedPoints,
    style: &Style,
    design: &DesignChoice,
) -> Vec<SurfaceOutcome> {
    let (design, rules) = (design.in_fields(), kernel_rules(style));
    let set_up = |splat| setup_surface(design, &points.view, &rules, splat);
    points.splats.par_iter().map(set_up).collect()
}

/// The rules of surfaces with the style's filter and cut-off.
pub fn kernel_rules(style: &Style) -> kernel::Rules {
    let cutoff = (style.cutoff * exp2(28))
        .round()
        .clamp(0.0, 15.0 * exp2(28));
    kernel::Rules {
        low_pass: scaled(style.low_pass),
        cutoff: kernel::Cutoff::Radial(cutoff as u32),
        table_range: if style.cutoff <= 4.0 { 2 } else { 4 },
        ..kernel::Rules::SURFACE
    }
}

/// The style's depth threshold in the pixels' format.
pub fn threshold(style: &Style, points: &QuantisedPoints) -> u32 {
    (style.threshold * exp2(points.scale_log2 + 23)).round() as u32
}

/// Draws `scene` as `camera` sees it. A number of layers that [`crate::surface::LAYERS`] lacks counts as the next
/// larger one.
pub fn draw(
    scene: &SurfaceScene,
    camera: &Camera,
    style: &Style,
    design: &DesignChoice,
    traversal: Traversal,
) -> SurfaceDrawing {
    let options = SurfaceOptions {
        style,
        design,
        traversal,
        engine: best_engine(),
        counts: true,
    };
    draw_with(scene, camera, &options)
}

/// How a surface is drawn.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceOptions<'a> {
    /// Filter, buffer and light.
    pub style: &'a Style,
    /// Widths.
    pub design: &'a DesignChoice,
    /// Order of the pixels.
    pub traversal: Traversal,
    /// Which implementation draws; all give the same bits.
    pub engine: PaintEngine,
    /// Are visited and covered pixels counted? If not, footprints behind others may be left out, and the counts are
    /// anything.
    pub counts: bool,
}

/// Draws `scene` as `camera` sees it, by the engine that the options name.
pub fn draw_with(
    scene: &SurfaceScene,
    camera: &Camera,
    options: &SurfaceOptions,
) -> SurfaceDrawing {
    let mut renderer = SurfaceRenderer::new(scene, camera, options);
    let mut picture = Picture::new(camera.width, camera.height);
    let facts = renderer.draw_picture(&mut picture);
    let mut resolved = vec![(Pixel::default(), 0.0); picture.pixels.len()];
    renderer.copy(&mut resolved, |pixel, weight| (*pixel, weight));
    let (pixels, weights) = resolved.into_iter().unzip();
    SurfaceDrawing {
        picture,
        pixels,
        weights,
        clamped: renderer.clamped(),
        facts,
    }
}

/// A material in the kernel's UQ5.27.
fn material(material: &Material) -> shading::Material {
    let unit = exp2(shading::COEFFICIENT as i32);
    let coefficient = |value: f64| (value * unit).round().clamp(0.0, u32::MAX.into()) as u32;
    shading::Material {
        ambient: coefficient(material.ambient),
        diffuse: coefficient(material.diffuse),
        specular: coefficient(material.specular),
        exponent: material.exponent,
    }
}

/// A direction of the scene as a unit vector in camera space, Q1.30.
fn direction(camera: &Camera, world: vector::Vector) -> shading::Direction {
    let turned = vector::transform(&camera.rotation, world);
    let length = vector::length(turned);
    turned.map(|part| (part / length * exp2(30)).round() as i32)
}
