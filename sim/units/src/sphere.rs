//! Spheres near the eye: systems 15 and 16.

use crate::common::painter;
use splatline::blend::Pixel;
use splatline::draw::Perspective;
use splatline::format::Standard24;
use splatline::rules::{Compositing, Rules};
use splatline::setup::{Ellipse, Index, setup_sphere};
use splatline::splat::SphereSplat;
use splatline::target::Target;
use splatline::view::View;

/// State of a pixel.
#[unsafe(no_mangle)]
pub static mut STATE: core::mem::MaybeUninit<Pixel> = core::mem::MaybeUninit::zeroed();

/// Draws one sphere.
#[unsafe(no_mangle)]
pub fn entry(view: &View, sphere: &SphereSplat, perspective: &Perspective, target: &mut Target) {
    let rules = Rules::EWA;
    let Some(painter) = painter(&rules, Compositing::FrontToBack) else {
        return;
    };
    let shape = (Ellipse::Exact, Index::Perspective);
    if let Ok(footprint) = setup_sphere(Standard24, view, &rules, sphere, shape) {
        painter.draw_sphere(&footprint, perspective, target);
    }
}
