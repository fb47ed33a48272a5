//! Tiles by vectors against the kernel's painter: random widths, arbitrary footprints, any tile; pixels word for word,
//! and the counts.

use super::TILE;
use super::lanes::VectorLevel;
use super::painter::{PaintScratch, TilePainter};
use super::words::WordPainter;
use crate::fast::{Start, TileWork, tile_painter};
use crate::fixed::{QuantisedScene, TableMemory, kernel_rules, whole};
use crate::rules;
use crate::scene::synthetic;
use proptest::prelude::*;
use splatline::blend::Pixel;
use splatline::draw::Coverage;
use splatline::footprint::{Conic, Footprint, Ldl};
use splatline::format::{
    Classic8, Lean18, Rounding, RuntimeWidths, Standard24, Traversal, WIDTH_RANGES, Widths,
};
use splatline::math::SoftFloat;
use splatline::raster::Window;
use splatline::rules::{Compositing, Rules};
use splatline::setup::{Cull, setup};

/// Any widths in lanes of 32 bits.
pub(super) type AnyWidths = RuntimeWidths<i32>;

pub(super) fn any_widths(widths: Widths) -> AnyWidths {
    AnyWidths::for_lanes(widths).expect("the strategies keep to the ranges")
}

/// At most what [`Widths::ranges`] leave.
fn allowed(widths: Widths) -> Widths {
    let ranges = widths.ranges();
    Widths {
        table: widths.table.min(ranges[5].2),
        accumulator: widths.accumulator.min(ranges[12].2),
        ..widths
    }
}

fn widths() -> impl Strategy<Value = Widths> {
    let number = |index: usize, last: u8| WIDTH_RANGES[index].1..=WIDTH_RANGES[index].2.min(last);
    let shape = (
        number(2, 31),
        number(3, 24),
        number(4, 27),
        number(5, 14),
        number(6, 20),
    );
    let blend = (
        number(7, 28),
        number(8, 28),
        number(9, 28),
        number(10, 30),
        number(11, 28),
        number(12, 27),
    );
    let all = (shape, blend, 0..3u8).prop_map(|(shape, blend, rounding)| Widths {
        position: Standard24::WIDTHS.position,
        view: 30,
        mantissa: shape.0,
        subpixel: shape.1,
        radial: shape.2,
        table: shape.3,
        interpolation: shape.4,
        weight: blend.0,
        peak: blend.1,
        alpha: blend.2,
        transmittance: blend.3,
        colour: blend.4,
        accumulator: blend.5,
        rounding: if rounding == 0 {
            Rounding::Truncate
        } else if rounding == 1 {
            Rounding::NearestEven
        } else {
            Rounding::Nearest
        },
    });
    all.prop_map(allowed)
}

/// Widths near those of the named designs, where vectors can draw.
pub(super) fn usual_widths() -> impl Strategy<Value = Widths> {
    (widths(), 0u8..5, 0u8..3).prop_map(|(random, less, more)| {
        let usual = Standard24::WIDTHS;
        allowed(Widths {
            mantissa: random.mantissa,
            radial: usual.radial - less,
            table: usual.table + more,
            weight: (usual.weight + less).min(28),
            alpha: usual.alpha - more,
            colour: usual.colour + less,
            rounding: random.rounding,
            ..usual
        })
    })
}

/// Widths at most as large as those of `lean18`, but for a few bits.
fn narrow_widths() -> impl Strategy<Value = Widths> {
    let less = || 0u8..7;
    let pixels = (0u8..3, less(), less(), less(), less(), less());
    (widths(), pixels, any::<bool>()).prop_map(|(random, less, classic)| {
        let usual = if classic {
            Classic8::WIDTHS
        } else {
            Lean18::WIDTHS
        };
        Widths {
            mantissa: random.mantissa,
            radial: usual.radial - less.0,
            table: usual.table - less.0,
            weight: usual.weight - less.1.min(4),
            alpha: usual.alpha - less.2.min(4),
            transmittance: usual.transmittance - less.3.min(4),
            colour: (usual.colour - less.4).max(4),
            accumulator: (usual.accumulator - less.5.min(less.4)).max(4),
            rounding: random.rounding,
            ..usual
        }
    })
}

pub(super) const VIEWPORT: [u16; 2] = [150, 77];

pub(super) fn number(
    mantissa: impl Strategy<Value = i32>,
    exponent: impl Strategy<Value = i32>,
) -> impl Strategy<Value = SoftFloat> {
    (mantissa, exponent).prop_map(|(mantissa, exponent)| SoftFloat { mantissa, exponent })
}

/// As the host has them, of either sign.
pub(super) fn normalised(exponent: impl Strategy<Value = i32>) -> impl Strategy<Value = SoftFloat> {
    let mantissa = (1i32 << 30..=i32::MAX, any::<bool>());
    let mantissa = mantissa.prop_map(|(m, minus)| if minus { -m } else { m });
    number(mantissa, exponent)
}

/// Any words at all; the box within the viewport, as the packet promises.
pub(super) fn arbitrary() -> impl Strategy<Value = Footprint> {
    let any_number = || number(any::<i32>(), -70i32..10);
    let scan = (any_number(), any_number(), any_number(), any_number());
    let corner = (0..VIEWPORT[0], 0..VIEWPORT[1]);
    let words = (any::<u32>(), any::<u32>(), any::<[u32; 3]>());
    (
        scan,
        corner.clone(),
        corner,
        words,
        any::<[i64; 2]>(),
        0u32..60,
    )
        .prop_map(
            |(scan, a, b, (cutoff, peak, colour), centre, spare)| Footprint {
                depth: 0,
                centre: centre.map(|c| c >> spare),
                first: [a.0.min(b.0), a.1.min(b.1)],
                end: [a.0.max(b.0) + 1, a.1.max(b.1) + 1],
                ldl: Ldl {
                    horizontal: scan.0,
                    squared_width: scan.1,
                    shear: scan.2,
                    vertical: scan.3,
                },
                conic: Conic {
                    mantissa: [0; 3],
                    exponent: 0,
                },
                cutoff: cutoff >> (spare % 6),
                opacity: peak >> (spare % 8),
                colour: colour.map(|c| c >> (spare % 16)),
            },
        )
}

/// Ordinary footprints, of all sizes and opacities.
pub(super) fn ordinary(
    widths: Widths,
    rules: &Rules,
    seed: u64,
    multiplier: f64,
) -> Vec<Result<Footprint, Cull>> {
    let scene = synthetic::random_gaussians(60, seed, multiplier);
    let camera = synthetic::camera(VIEWPORT[0].into(), VIEWPORT[1].into());
    let quantised = QuantisedScene::new(&scene, &camera, &rules::Rules::GAUSSIAN_3D);
    let splats = quantised.splats.iter();
    splats
        .map(|splat| setup(any_widths(widths), &quantised.view, rules, splat))
        .collect()
}

/// The tile as a painter gives it.
fn painted(
    painter: &dyn TilePainter,
    window: Window,
    footprints: &[Result<Footprint, Cull>],
) -> (Vec<Pixel>, Coverage) {
    let [columns, rows] = [0, 1].map(|axis| usize::from(window.end[axis] - window.first[axis]));
    let list: Vec<u32> = (0..footprints.len() as u32).collect();
    let mut pixels = vec![Pixel::default(); columns * rows];
    let scratch = &mut PaintScratch::default();
    let work = TileWork {
        window,
        footprints,
        list: &list,
        start: Start::Clear,
        pixels: &mut pixels,
    };
    let coverage = painter.paint(scratch, work);
    (pixels, coverage)
}

/// Names the first pixel that differs.
fn assert_same(got: &[Pixel], expected: &[Pixel], by: &str) {
    let mut pairs = got.iter().zip(expected).enumerate();
    let different = pairs.find(|(_, (got, expected))| got != expected);
    assert_eq!(different, None, "{by}");
}

/// The orders of drawing: the first one finishes pixels.
const ORDERS: [Compositing; 3] = [
    Compositing::FrontToBack,
    Compositing::BackToFront,
    Compositing::XRay,
];

/// A tile's pixels within the viewport.
pub(super) fn window((x, y): (u16, u16)) -> Window {
    let first = [x * TILE[0], y * TILE[1]];
    let end = [0, 1].map(|axis| (first[axis] + TILE[axis]).min(VIEWPORT[axis]));
    Window { first, end }
}

/// Draws by vectors and by the kernel in these orders; `false` if vectors do not draw under these widths.
fn agree(
    widths: Widths,
    rules: &Rules,
    footprints: &[Result<Footprint, Cull>],
    tile: (u16, u16),
    orders: &[Compositing],
) -> bool {
    let (design, traversal) = (any_widths(widths), Traversal::Spans);
    let (table, window) = (TableMemory::new(&widths, rules), window(tile));
    for order in orders.iter().copied() {
        let mut pixels = vec![Pixel::clear(&widths); window.pixels()];
        let mut target = whole(&mut pixels, window);
        let scalar = table.painter(design, order, traversal);
        let mut expected = Coverage::default();
        for footprint in footprints.iter().flatten() {
            expected += scalar.draw(footprint, &mut target);
        }
        let check = |painter: &dyn TilePainter, counts: bool, by: &str| {
            let (got, coverage) = painted(painter, window, footprints);
            assert_same(&got, &pixels, &format!("{by}, {order:?}, counts: {counts}"));
            assert!(!counts || coverage == expected, "{by}, {order:?}");
        };
        for counts in [true, false] {
            for choice in [VectorLevel::Best, VectorLevel::Avx2, VectorLevel::Portable] {
                let Some(painter) = WordPainter::new(design, rules, order, choice, counts) else {
                    return false;
                };
                check(&painter, counts, &format!("{choice:?}"));
            }
            let choice = Some(VectorLevel::Best);
            let chosen = tile_painter(design, rules, order, traversal, choice, counts);
            check(&*chosen, counts, "chosen");
        }
    }
    true
}

/// Those of volumes, of captured scenes, and volumes' with a least opacity that does not follow from rounding.
fn any_rules() -> impl Strategy<Value = Rules> {
    let [ewa, captured] = [rules::Rules::EWA, rules::Rules::GAUSSIAN_3D].map(|r| kernel_rules(&r));
    let threshold = Rules {
        alpha_min: 16 * captured.alpha_min,
        ..ewa
    };
    prop_oneof![Just(ewa), Just(captured), Just(threshold)]
}

proptest! {
    #[test]
    fn random_widths(
        widths in widths(), rules in any_rules(), seed: u64, multiplier in 0.2f64..10.0, tile in (0u16..3, 0u16..2),
    ) {
        let footprints = ordinary(widths, &rules, seed, multiplier);
        agree(widths, &rules, &footprints, tile, &ORDERS);
    }

    #[test]
    fn usual_widths_are_drawn_by_vectors(
        widths in usual_widths(), rules in any_rules(), seed: u64, multiplier in 0.2f64..10.0, tile in (0u16..3, 0u16..2),
    ) {
        let footprints = ordinary(widths, &rules, seed, multiplier);
        prop_assert!(agree(widths, &rules, &footprints, tile, &ORDERS));
    }

    #[test]
    fn designs_of_few_bits(
        widths in narrow_widths(), rules in any_rules(), seed: u64, multiplier in 0.2f64..10.0, footprints in prop::collection::vec(arbitrary(), 0..20),
        tile in (0u16..3, 0u16..2),
    ) {
        let mut all = ordinary(widths, &rules, seed, multiplier);
        all.extend(footprints.into_iter().map(Ok));
        agree(widths, &rules, &all, tile, &ORDERS[..1]);
    }

    #[test]
    fn arbitrary_footprints(
        widths in usual_widths(), rules in any_rules(), footprints in prop::collection::vec(arbitrary(), 1..40), tile in (0u16..3, 0u16..2),
    ) {
        let footprints: Vec<_> = footprints.into_iter().map(Ok).collect();
        prop_assert!(agree(widths, &rules, &footprints, tile, &ORDERS));
    }
}
