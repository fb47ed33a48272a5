//! The pictures of a case: the truth's in double precision, single precision's in single precision.
//!
//! The rules have thresholds: a pixel is drawn or not at r = c, and is finished or not at the smallest transmittance.
//! There the picture is discontinuous, and any error at all, however small, can decide otherwise. Which pixels lie on
//! such an edge follows from the truth alone; at those the wrong decisions are counted, and the largest difference is
//! taken over all others.

use super::bounds::ErrorBounds;
use super::cases::Case;
use super::errors::worse;
use super::exact::RationalFootprint;
use super::single::{self, SingleFootprint};
use super::{StageErrors, pixels};
use crate::fixed;
use crate::metrics;
use crate::picture::Picture;
use crate::rules::Rules;

/// Half-width of an edge, in the radial index and relative to the smallest transmittance: more than any engine of 24
/// bits or more is wrong by on ordinary splats.
const EDGE: Edge = Edge {
    radial: 1.0 / 16_384.0,
    depth: 0.0,
};

/// Difference at a pixel on an edge from which on it counts as a wrong decision.
const DECIDED: f64 = 1.0 / 8_192.0;

/// The truth's picture.
#[derive(Clone, Debug)]
pub(super) struct TruePictures {
    picture: Picture,
    /// Pixels on an edge of the rules, row-major.
    edges: Vec<bool>,
}

/// The errors of `picture`, which has the truth's size.
pub(super) fn errors(mut picture: Picture, truth: &TruePictures) -> StageErrors {
    let exact = &truth.picture;
    let mut decided_wrongly = 0;
    for (index, _) in truth.edges.iter().enumerate().filter(|(_, edge)| **edge) {
        let (got, expected) = (&mut picture.pixels[index], exact.pixels[index]);
        let off = (0..4).any(|c| (got[c] - expected[c]).abs() > DECIDED);
        decided_wrongly += usize::from(off);
        *got = expected;
    }
    let errors = metrics::compare(&picture, exact);
    let errors = errors.expect("both pictures have the camera's size");
    let psnr = errors.colour.psnr_db;
    StageErrors {
        picture: errors.colour.max_abs.max(errors.alpha.max_abs),
        bias: errors.colour.bias,
        psnr_db: psnr.is_finite().then_some(psnr),
        edges: truth.edges.iter().filter(|edge| **edge).count(),
        decided_wrongly,
        ..StageErrors::default()
    }
}

/// Nearest first, ties by index.
fn by_depth<F>(projected: &[Option<F>], depth: impl Fn(&F) -> f64) -> Vec<(usize, &F)> {
    let all = projected.iter().enumerate();
    let mut order: Vec<(usize, &F)> = all.filter_map(|(i, f)| Some((i, f.as_ref()?))).collect();
    order.sort_by(|a, b| depth(a.1).total_cmp(&depth(b.1)));
    order
}

/// A splat's part in a pixel.
struct PictureLayer {
    index: usize,
    r: f64,
    /// Its opacity, and the light that reaches it.
    alpha: f64,
    clear: f64,
}

/// How close to a threshold a splat's pixel is on an edge.
#[derive(Clone, Copy, Default)]
pub(super) struct Edge {
    /// In the radial index, and relative to the smallest transmittance.
    pub radial: f64,
    /// In depth, scene units: nearer neighbours may change places.
    pub depth: f64,
}

/// Composites the splats in `order` at a point: every layer that is drawn, the light that is left, and whether the
/// point lies on an edge.
fn composite(
    rules: &Rules,
    order: &[(usize, &RationalFootprint)],
    (x, y): (f64, f64),
    edge_of: impl Fn(usize) -> Edge,
    mut each: impl FnMut(PictureLayer),
) -> (f64, bool) {
    let (mut clear, mut edge) = (1.0, false);
    let mut before = f64::NEG_INFINITY;
    for (index, footprint) in order {
        let r = footprint.radial(x, y);
        let width = edge_of(*index);
        edge |= (r - footprint.cutoff).abs() < width.radial;
        let alpha = (footprint.peak * (-0.5 * r).exp()).min(rules.alpha_max);
        if r >= rules.cutoff || alpha <= 0.0 || alpha < rules.alpha_min {
            continue;
        }
        let rest = clear * (1.0 - alpha);
        edge |= (rest / rules.minimum_transmittance - 1.0).abs() < width.radial;
        edge |= footprint.depth != before && footprint.depth - before < width.depth;
        before = footprint.depth;
        if rules.omit_finishing && rest <= rules.minimum_transmittance {
            break;
        }
        each(PictureLayer {
            index: *index,
            r,
            alpha,
            clear,
        });
        clear = rest;
        if clear <= rules.minimum_transmittance {
            break;
        }
    }
    (clear, edge)
}

/// The truth's picture, composited in double precision.
pub(super) fn exact(case: &Case, projected: &[Option<RationalFootprint>]) -> TruePictures {
    let order = by_depth(projected, |f| f.depth);
    let mut picture = Picture::new(case.camera.width, case.camera.height);
    let mut edges = vec![false; picture.pixels.len()];
    let targets = picture.pixels.iter_mut().zip(&mut edges);
    for ((pixel, edge), at) in targets.zip(pixels(case)) {
        let mut sum = [0.0; 3];
        let add = |layer: PictureLayer| {
            let colour = case.scene.splats[layer.index].colour;
            for (sum, colour) in sum.iter_mut().zip(colour) {
                *sum += layer.clear * layer.alpha * colour;
            }
        };
        let (clear, on_edge) = composite(&case.rules, &order, at, |_| EDGE, add);
        *edge = on_edge;
        *pixel = [sum[0], sum[1], sum[2], 1.0 - clear];
    }
    TruePictures { picture, edges }
}

/// The largest share of its bound that a pixel's error takes, but for pixels on an edge as wide as the design's own
/// bounds; 0 for a design without bounds.
///
/// An opacity's error moves a pixel by at most the light that reaches the layer (colours are at most 1); each layer
/// rounds its share and its colour once, and colours themselves are rounded.
pub(super) fn share_of_bound(
    case: &Case,
    picture: &Picture,
    truth: &TruePictures,
    projected: &[Option<RationalFootprint>],
    bounds: &[Option<ErrorBounds>],
) -> f64 {
    let order = by_depth(projected, |f| f.depth);
    let range = fixed::kernel_rules(&case.rules).table_range;
    let pairs = picture.pixels.iter().zip(&truth.picture.pixels);
    let edge = |of: &ErrorBounds| of.edge(range);
    let widths = bounds
        .iter()
        .map(|of| of.as_ref().map(edge).unwrap_or_default());
    let widths: Vec<Edge> = widths.collect();
    let mut largest = 0.0;
    for ((got, expected), at) in pairs.zip(pixels(case)) {
        let mut bound = 0.0;
        let add = |layer: PictureLayer| {
            if let Some(bounds) = &bounds[layer.index] {
                bound += layer.clear * bounds.opacity(layer.r, range) + bounds.layer();
            }
        };
        let (_, edge) = composite(&case.rules, &order, at, |index| widths[index], add);
        let error = (0..4).fold(0.0, |most: f64, c| most.max((got[c] - expected[c]).abs()));
        if !edge && bound > 0.0 {
            largest = worse(largest, error / bound);
        }
    }
    largest
}

/// The picture of single precision, composited in single precision.
pub(super) fn single(case: &Case, projected: &[Option<SingleFootprint>]) -> Picture {
    let order = by_depth(projected, |f| f.position[2].into());
    let order: Vec<usize> = order.into_iter().map(|(index, _)| index).collect();
    let splats = case.scene.splats.iter();
    let colours: Vec<[f64; 3]> = splats.map(|splat| splat.colour).collect();
    single::picture(projected, &colours, &order, &case.camera, &case.rules)
}
