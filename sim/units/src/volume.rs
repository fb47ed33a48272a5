//! Volume splats: systems 1, 4 and 5.

use crate::common::painter;
use splatline::blend::Pixel;
use splatline::format::Standard24;
use splatline::rules::{Compositing, Rules};
use splatline::setup::setup;
use splatline::splat::VolumeSplat;
use splatline::target::Target;
use splatline::view::View;

/// State of a pixel.
#[unsafe(no_mangle)]
pub static mut STATE: core::mem::MaybeUninit<Pixel> = core::mem::MaybeUninit::zeroed();

/// Draws one splat.
#[unsafe(no_mangle)]
pub fn entry(view: &View, splat: &VolumeSplat, target: &mut Target) {
    let rules = Rules::GAUSSIAN_3D;
    let Some(painter) = painter(&rules, Compositing::FrontToBack) else {
        return;
    };
    if let Ok(footprint) = setup(Standard24, view, &rules, splat) {
        painter.draw(&footprint, target);
    }
}
