//! Surface splats: systems 2, 4 and 9 with the accumulation buffer, and with layers, shading and edges systems 10 to
//! 12.

use crate::common::{TABLE, WIDTHS};
use splatline::blend::Pixel;
#[cfg(feature = "layers")]
use splatline::blend::edge::EdgeFilter;
#[cfg(feature = "layers")]
use splatline::blend::layers::Layers;
use splatline::blend::resolve::Resolve;
#[cfg(feature = "layers")]
use splatline::blend::shading::{Material, Shading};
#[cfg(not(feature = "layers"))]
use splatline::blend::surface::Accumulation;
use splatline::blend::surface::WeightedSum;
use splatline::draw::surface::SurfacePainter;
use splatline::format::{Standard24, Traversal};
use splatline::kernel::FootprintTable;
use splatline::rules::Rules;
use splatline::setup::setup_surface;
use splatline::splat::surface::SurfaceSplat;
use splatline::target::cells::CellTarget;
use splatline::view::View;

#[cfg(feature = "layers")]
type DeepBuffer = Layers<4>;
#[cfg(not(feature = "layers"))]
type DeepBuffer = Accumulation;

/// State of a pixel.
#[unsafe(no_mangle)]
pub static mut STATE: core::mem::MaybeUninit<DeepBuffer> = core::mem::MaybeUninit::zeroed();

/// Draws one splat and resolves one cell.
#[unsafe(no_mangle)]
pub fn entry(
    view: &View,
    splat: &SurfaceSplat,
    target: &mut CellTarget<DeepBuffer>,
    #[cfg(feature = "layers")] materials: &[Material],
    cell: &DeepBuffer,
    out: &mut Pixel,
) {
    let rules = Rules {
        table_range: 4,
        ..Rules::SURFACE
    };
    let Ok(table) = FootprintTable::new(&TABLE, &WIDTHS, rules.table_range) else {
        return;
    };
    let gather = WeightedSum::new(&WIDTHS, 1 << 20);
    let painter = SurfacePainter::new(Standard24, &rules, table, gather, Traversal::Spans);
    if let Ok(footprint) = setup_surface(Standard24, view, &rules, splat) {
        painter.draw(&footprint, target);
    }
    #[cfg(feature = "layers")]
    let (shading, edges) = (
        Some(Shading::new(&WIDTHS, materials, [0, 0, -(1 << 30)], view)),
        EdgeFilter::new(429_496_730),
    );
    #[cfg(not(feature = "layers"))]
    let (shading, edges) = (None, None);
    *out = Resolve::new(&WIDTHS, gather, shading, edges).pixel(cell, 0, 0);
}
