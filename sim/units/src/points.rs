//! Points beside splats: systems 6 and 14, by spans or by stamps (7).

use crate::common::{WIDTHS, painter};
use splatline::blend::points::{Slab, Slabs};
use splatline::draw::PointSettings;
use splatline::format::Standard24;
use splatline::math::SoftFloat;
#[cfg(feature = "stamp")]
use splatline::raster::Stamp;
use splatline::rules::{Compositing, Rules};
use splatline::setup::{PointFilter, is_minified, setup, setup_point};
use splatline::splat::VolumeSplat;
use splatline::target::Target;
use splatline::view::View;

/// State of a pixel.
#[unsafe(no_mangle)]
pub static mut STATE: core::mem::MaybeUninit<(splatline::blend::Pixel, Slab)> =
    core::mem::MaybeUninit::zeroed();

/// Draws one sample as point or splat.
#[unsafe(no_mangle)]
pub fn entry(
    view: &View,
    spacing: SoftFloat,
    splat: &VolumeSplat,
    target: &mut Target,
    slabs: &mut Slabs,
    #[cfg(feature = "stamp")] stamp: Stamp,
) {
    let rules = Rules {
        spacing,
        ..Rules::EWA
    };
    let (Some(painter), Some(filter)) = (
        painter(&rules, Compositing::FrontToBack),
        PointFilter::new(&WIDTHS, &rules, spacing),
    ) else {
        return;
    };
    #[cfg(feature = "stamp")]
    let stamp = Some(stamp);
    #[cfg(not(feature = "stamp"))]
    let stamp = None;
    let gathering = PointSettings {
        range: 1 << 20,
        stamp,
    };
    if is_minified(&WIDTHS, view, &rules, splat) {
        if let Ok(point) = setup_point(Standard24, view, &rules, splat, &filter) {
            painter.draw_point(&point, &gathering, target, slabs);
        }
    } else if let Ok(footprint) = setup(Standard24, view, &rules, splat) {
        painter.draw_among_points(&footprint, target, slabs);
    }
    painter.finish_points(target, slabs);
}
