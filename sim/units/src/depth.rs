//! Sheet buffers (system 5) and the deep alpha channel (8).

#[cfg(feature = "sheets")]
mod sheets {
    use crate::common::{WIDTHS, painter};
    use splatline::blend::sheets::{DepthSlabs, SheetBuffer};
    use splatline::blend::{Blend, Pixel};
    use splatline::footprint::depth;
    use splatline::format::Standard24;
    use splatline::rules::{Compositing, Rules};
    use splatline::setup::setup;
    use splatline::splat::VolumeSplat;
    use splatline::target::Target;
    use splatline::view::View;

    /// State of a pixel: frame and sheet.
    #[unsafe(no_mangle)]
    pub static mut STATE: core::mem::MaybeUninit<[Pixel; 2]> = core::mem::MaybeUninit::zeroed();

    /// Draws one splat into its sheet and composites the sheet when it is full.
    #[unsafe(no_mangle)]
    pub fn entry(
        view: &View,
        splat: &VolumeSplat,
        slabs: &DepthSlabs,
        sheet: &mut SheetBuffer,
        target: &mut Target,
    ) -> i64 {
        let rules = Rules::EWA;
        let Some(painter) = painter(&rules, Compositing::XRay) else {
            return 0;
        };
        let Ok(footprint) = setup(Standard24, view, &rules, splat) else {
            return 0;
        };
        painter.draw(&footprint, sheet.target());
        sheet.composite_behind(&Blend::new(&WIDTHS, &rules), target);
        slabs.slab(depth::fixed(footprint.depth)).into()
    }
}

#[cfg(feature = "deep")]
mod deep {
    use crate::common::{WIDTHS, painter};
    use splatline::blend::deep::{Channel, DeepPixel};
    use splatline::format::Standard24;
    use splatline::raster::Window;
    use splatline::rules::{Compositing, Rules};
    use splatline::setup::setup;
    use splatline::splat::VolumeSplat;
    use splatline::view::View;

    /// State of a pixel.
    #[unsafe(no_mangle)]
    pub static mut STATE: core::mem::MaybeUninit<DeepPixel> = core::mem::MaybeUninit::zeroed();

    /// Draws one splat into deep pixels.
    #[unsafe(no_mangle)]
    pub fn entry(
        view: &View,
        splat: &VolumeSplat,
        channel: &Channel,
        window: &Window,
        pixels: &mut [DeepPixel],
    ) {
        let rules = Rules::EWA;
        let Some(painter) = painter(&rules, Compositing::FrontToBack) else {
            return;
        };
        let Ok(footprint) = setup(Standard24, view, &rules, splat) else {
            return;
        };
        let colour = footprint.colour.map(|c| c << (28 - WIDTHS.colour));
        let columns = usize::from(window.end[0] - window.first[0]);
        painter.visit(&footprint, window, |x, y, alpha| {
            let at = usize::from(y - window.first[1]) * columns + usize::from(x - window.first[0]);
            if let Some(pixel) = pixels.get_mut(at) {
                let alpha = alpha << (31 - WIDTHS.alpha);
                pixel.front_to_back(channel, alpha, &colour, [x, y], 0);
            }
        });
    }
}
