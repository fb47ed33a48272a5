//! From a pixel's fragments to its colour: divide, shade, cover, composite (SURF 4, 6 and 7).
//!
//! Once per pixel after all splats: every fragment is divided by its weight sum, shaded if there is a light, scaled by
//! its coverage if edges are antialiased, and composited front to back in premultiplied form: C += T q c, T -= T q a.

use super::Pixel;
use super::edge::EdgeFilter;
use super::shading::Shading;
use super::surface::{Cell, WeightedSum, sum_fraction};
use crate::format::Widths;
use crate::math::shift_unsigned;

/// The constants of resolving, one per picture.
#[derive(Clone, Copy, Debug)]
pub struct Resolve<'a> {
    widths: Widths,
    gather: WeightedSum,
    shading: Option<Shading<'a>>,
    edges: Option<EdgeFilter>,
}

impl<'a> Resolve<'a> {
    /// Without `shading` colours stay as they are, without `edges` every touched pixel is fully covered.
    pub fn new(
        widths: &Widths,
        gather: WeightedSum,
        shading: Option<Shading<'a>>,
        edges: Option<EdgeFilter>,
    ) -> Resolve<'a> {
        Resolve {
            widths: *widths,
            gather,
            shading,
            edges,
        }
    }

    /// The pixel at column `x` and row `y`.
    ///
    /// Products are rounded by the design's rounding; the shares taken from T are subtracted from it exactly.
    pub fn pixel<C: Cell>(&self, cell: &C, x: u16, y: u16) -> Pixel {
        let widths = &self.widths;
        let mut pixel = Pixel::clear(widths);
        for fragment in cell.fragments() {
            let filtered = self.gather.normalise(fragment);
            let colour = match &self.shading {
                Some(shading) => shading.shade(&filtered, x, y),
                None => filtered.colour,
            };
            let coverage = self.edges.map_or(1 << 30, |edges| {
                edges.coverage(fragment.weight, sum_fraction(widths))
            });
            let visible = self.product(pixel.transmittance, coverage, 30);
            for (sum, c) in pixel.colour.iter_mut().zip(colour) {
                *sum = sum.saturating_add(self.product(visible, c, widths.transmittance.into()));
            }
            let hidden = self.product(visible, filtered.opacity, widths.accumulator.into());
            pixel.transmittance = pixel.transmittance.saturating_sub(hidden);
        }
        pixel
    }

    fn product(&self, a: u32, b: u32, drop: i32) -> u32 {
        let product = u64::from(a) * u64::from(b);
        shift_unsigned(product, drop, self.widths.rounding).min(u32::MAX.into()) as u32
    }
}
