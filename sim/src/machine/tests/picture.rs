//! Cycles of whole pictures against the clock that is fed with the kernel's rows, splat by splat.

use super::super::primitive::{
    PacketStamp, PrimitiveClock, QUEUE, TILE, for_each_slot, picture_cycles, tile_cycles,
};
use crate::design::DesignChoice;
use crate::fast::lanes::VectorLevel;
use crate::fixed;
use crate::rules::{Compositing, Rules};
use crate::scene::synthetic;
use proptest::prelude::*;
use splatline::footprint::{Conic, Footprint, Ldl};
use splatline::format::{Design, Lean18, Standard24, Traversal};
use splatline::math::SoftFloat;
use splatline::raster::Window;

const CHOICES: [VectorLevel; 3] = [VectorLevel::Best, VectorLevel::Avx2, VectorLevel::Portable];
const VIEWPORT: [u16; 2] = [150, 77];

/// Cycles of one tile, and stamps of its splats.
type Cycles = (u64, Vec<PacketStamp>);

fn clocked<D: Design>(design: D, list: &[Footprint], window: &Window, lanes: usize) -> Cycles {
    let mut clock = PrimitiveClock::new(lanes, QUEUE);
    let mut stamps = Vec::new();
    for footprint in list {
        stamps.push(clock.packet(0));
        for_each_slot(design, footprint, window, lanes, |run| {
            clock.slot(run);
        });
    }
    (clock.idle_at(), stamps)
}

fn fast<D: Design>(
    design: D,
    list: &[Footprint],
    window: Window,
    lanes: usize,
    choice: VectorLevel,
) -> Option<Cycles> {
    let mut stamps = Vec::new();
    let note = |stamp| stamps.push(stamp);
    let cycles = tile_cycles(design, list.iter(), window, lanes, choice, note)?;
    Some((cycles, stamps))
}

/// The tiles of the viewport, row by row.
fn tiles() -> Vec<Window> {
    let [columns, rows] = [0, 1].map(|axis| VIEWPORT[axis].div_ceil(TILE[axis]));
    let tile = |index: u16| {
        let first = [index % columns * TILE[0], index / columns * TILE[1]];
        let last = [0, 1].map(|axis| (first[axis] + TILE[axis]).min(VIEWPORT[axis]));
        Window { first, end: last }
    };
    (0..columns * rows).map(tile).collect()
}

/// The footprints whose boxes touch the window.
fn touching(footprints: &[Footprint], window: &Window) -> Vec<Footprint> {
    let bounds = Window::of;
    let touches = |footprint: &&Footprint| !bounds(footprint).intersect(window).is_empty();
    footprints.iter().filter(touches).copied().collect()
}

/// Every tile of the picture, together and alone.
fn compare<D: Design + Sync>(
    design: D,
    footprints: &[Footprint],
    lanes: usize,
    choice: VectorLevel,
) {
    let picture = picture_cycles(design, footprints, VIEWPORT, lanes, choice).unwrap();
    for (window, cycles) in tiles().into_iter().zip(picture) {
        let list = touching(footprints, &window);
        let expected = clocked(design, &list, &window, lanes);
        assert_eq!(cycles, expected.0, "{window:?}, {lanes} lanes, {choice:?}");
        assert_eq!(fast(design, &list, window, lanes, choice), Some(expected));
    }
}

fn ordinary(name: &str, seed: u64, size: f64) -> Vec<Footprint> {
    let scene = synthetic::random_gaussians(400, seed, size);
    let camera = synthetic::camera(VIEWPORT[0].into(), VIEWPORT[1].into());
    let options = fixed::Options {
        rules: &Rules::GAUSSIAN_3D,
        compositing: Compositing::FrontToBack,
        design: &DesignChoice::named(name).unwrap(),
        traversal: Traversal::Spans,
    };
    let footprints = fixed::footprints(&scene, &camera, &options);
    footprints.into_iter().flatten().collect()
}

/// Sizes from far below a tile, where rows run dry, to far above it, where queues are full.
#[test]
fn scenes_take_the_cycles_of_the_clock() {
    for lanes in [1, 2, 4, 8, 16] {
        for size in [0.5, 4.0, 30.0] {
            for choice in CHOICES {
                let seed = lanes as u64;
                compare(Lean18, &ordinary("lean18", seed, size), lanes, choice);
                compare(
                    Standard24,
                    &ordinary("standard24", seed, size),
                    lanes,
                    choice,
                );
            }
        }
    }
}

#[test]
fn lanes_that_no_circuit_has_are_refused() {
    assert_eq!(
        picture_cycles(Lean18, &[], VIEWPORT, 3, VectorLevel::Best),
        None
    );
    assert_eq!(
        picture_cycles(Lean18, &[], VIEWPORT, 0, VectorLevel::Best),
        None
    );
}

/// Any words at all, which leave the vectors' arithmetic; the box within the viewport, as the packet promises.
fn arbitrary() -> impl Strategy<Value = Footprint> {
    let number = (any::<i32>(), -70i32..10)
        .prop_map(|(mantissa, exponent)| SoftFloat { mantissa, exponent });
    let scan = (number.clone(), number.clone(), number.clone(), number);
    let corner = (0..VIEWPORT[0], 0..VIEWPORT[1]);
    let centre = (any::<[i64; 2]>(), 0u32..60);
    (scan, corner.clone(), corner, any::<u32>(), centre).prop_map(
        |(scan, a, b, cutoff, (centre, spare))| Footprint {
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
            conic: Conic::default(),
            cutoff: cutoff >> (spare % 6),
            opacity: 0,
            colour: [0; 3],
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]
    #[test]
    fn arbitrary_footprints_take_the_cycles_of_the_clock(
        footprints in proptest::collection::vec(arbitrary(), 1..40),
        lanes in 0u32..5,
        choice in 0usize..3,
    ) {
        compare(Lean18, &footprints, 1 << lanes, CHOICES[choice]);
        compare(Standard24, &footprints, 1 << lanes, CHOICES[choice]);
    }

    /// A window anywhere in a block; footprints beside it take a slot.
    #[test]
    fn any_window_of_a_block(
        footprints in proptest::collection::vec(arbitrary(), 1..20),
        corners in [0..TILE[0], 0..TILE[1], 0..TILE[0], 0..TILE[1]],
        lanes in 0u32..5,
    ) {
        let [left, top, right, bottom] = corners;
        let first = [32 + left.min(right), top.min(bottom)];
        let last = [33 + left.max(right), 1 + top.max(bottom)];
        let window = Window { first, end: last };
        let expected = clocked(Standard24, &footprints, &window, 1 << lanes);
        let got = fast(Standard24, &footprints, window, 1 << lanes, VectorLevel::Best);
        prop_assert_eq!(got, Some(expected));
    }
}
