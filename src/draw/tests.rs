extern crate std;
use super::surface::SurfacePainter;
use super::*;
use crate::blend::points::{Slab, Slabs};
use crate::blend::surface::{Cell, Fragment, Sample, WeightedSum};
use crate::footprint::Ldl;
use crate::footprint::surface::{Attributes, Plane, SurfaceFootprint};
use crate::format::{RuntimeWidths, Standard24, Widths};
use crate::kernel::{PERSPECTIVE_ENTRIES, PerspectiveTable, Rays};
use crate::math::{SoftFloat, reciprocal};
use crate::raster::{Stamp, StampShape, Window, fill_stamps};
use crate::setup::SphereFootprint;
use crate::target::cells::CellTarget;
use std::collections::BTreeMap;
use std::vec::Vec;

/// Peaks and kernel values of as many bits as opacities have, and a table of 16 steps up to r = 4.
const WIDTHS: Widths = Widths {
    table: 4,
    interpolation: 0,
    weight: 18,
    peak: 18,
    alpha: 18,
    ..Standard24::WIDTHS
};

const HALF: u32 = 1 << 17;

/// By distance in pixels: 1/2 in the middle, then 1000, 300, at two pixels the smallest number, beyond nothing.
const STEPS: [u32; 17] = [HALF, 1000, 300, 300, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0];

const MIDDLE: [u16; 2] = [9, 5];

const CENTRE: [i64; 2] = [19 << 23, 11 << 23];

/// r = 0.26 d^2 < 2.5 around [`MIDDLE`]: 29 pixels, of which 13 have an opacity.
fn round(colour: [u32; 3]) -> Footprint {
    let sharpness = SoftFloat::from_wide(26, 0, 24).multiply(
        reciprocal(SoftFloat::from_wide(100, 0, 24), 24).unwrap(),
        24,
    );
    Footprint {
        centre: CENTRE,
        first: [0; 2],
        end: [20, 12],
        ldl: Ldl {
            horizontal: sharpness,
            squared_width: reciprocal(sharpness, 24).unwrap(),
            shear: SoftFloat::ZERO,
            vertical: sharpness,
        },
        cutoff: 5 << 27,
        opacity: 1 << 18,
        colour,
        ..Footprint::EMPTY
    }
}

fn with_painter<T>(draw: impl FnOnce(Painter<RuntimeWidths<i64>>, FootprintTable) -> T) -> T {
    let table = FootprintTable::new(&STEPS, &WIDTHS, 2).unwrap();
    let design = RuntimeWidths::new(WIDTHS).unwrap();
    let order = Compositing::FrontToBack;
    draw(
        Painter::new(design, &Rules::EWA, table, order, Traversal::Spans),
        table,
    )
}

fn transmittances(pixels: &[Pixel], columns: usize) -> BTreeMap<[usize; 2], u32> {
    let clear = Pixel::clear(&WIDTHS);
    let drawn = pixels
        .iter()
        .enumerate()
        .filter(|(_, pixel)| **pixel != clear);
    drawn
        .map(|(at, pixel)| ([at % columns, at / columns], pixel.transmittance()))
        .collect()
}

/// Opacities of 0 are left out, the smallest is not.
#[test]
fn what_is_visited_has_an_opacity() {
    let mut found = Vec::new();
    let window = Window {
        first: [0; 2],
        end: [20, 12],
    };
    let coverage = with_painter(|painter, _| {
        painter.visit(&round([0; 3]), &window, |x, y, alpha| {
            let square = |a: u16, b: u16| a.abs_diff(b).pow(2);
            found.push((square(x, MIDDLE[0]) + square(y, MIDDLE[1]), alpha));
        })
    });
    assert_eq!(coverage.covered, 29);
    let mut expected = std::vec![(0, HALF)];
    for (distance, alpha) in [(1, 1000), (2, 300), (4, 1)] {
        expected.extend([(distance, alpha); 4]);
    }
    found.sort();
    assert_eq!(found, expected);
}

/// A cell that knows the weights of its samples.
#[derive(Clone, Debug)]
struct Weights(Vec<u32>);

impl Cell for Weights {
    const EMPTY: Self = Weights(Vec::new());

    fn add(&mut self, _: &WeightedSum, sample: &Sample) {
        self.0.push(sample.weight);
    }

    fn fragments(&self) -> &[Fragment] {
        &[]
    }
}

/// Samples of surfaces have a weight, too: one without would replace what it lies before.
#[test]
fn what_is_gathered_has_a_weight() {
    let surface = SurfaceFootprint {
        footprint: round([0; 3]),
        plane: Plane {
            origin: 0,
            step: [0; 2],
        },
        attributes: Attributes {
            colour: [0; 3],
            opacity: 0,
            normal: [0; 3],
            material: 0,
        },
        back: false,
    };
    let window = Window {
        first: [0; 2],
        end: [20, 12],
    };
    // Opacities of four bits more than weights have: 16 is the least weight, and 7 has none.
    let widths = Widths {
        weight: 28,
        alpha: 28,
        ..WIDTHS
    };
    let mut steps = STEPS;
    (steps[1], steps[2], steps[4]) = (16, 7, 304);
    let (table, gather) = (
        FootprintTable::new(&steps, &widths, 2).unwrap(),
        WeightedSum::new(&widths, 0),
    );
    let design = RuntimeWidths::<i64>::new(widths).unwrap();
    let painter = SurfacePainter::new(design, &Rules::EWA, table, gather, Traversal::Spans);
    let mut cells = std::vec![Weights::EMPTY; 240];
    let coverage = painter.draw(&surface, &mut CellTarget::new(&mut cells, window).unwrap());
    assert_eq!((coverage.visited, coverage.covered), (29, 29));
    let mut found: Vec<u32> = cells.into_iter().flat_map(|cell| cell.0).collect();
    found.sort();
    assert_eq!(found, [1, 1, 1, 1, 19, 19, 19, 19, HALF >> 4]);
}

/// A stamp draws what its footprint draws, counts what it sees, and leaves finished pixels alone.
#[test]
fn stamps_draw_and_count_as_footprints_do() {
    with_painter(|painter, table| {
        let footprint = round([1 << 20; 3]);
        let shape = StampShape::new(&footprint, 1).unwrap();
        let mut weights = std::vec![0; shape.words()];
        assert!(fill_stamps(
            &mut weights,
            painter.design,
            &table,
            &shape,
            &footprint
        ));
        let stamp = Stamp::new(&weights, shape).unwrap();
        let window = Window {
            first: [4, 2],
            end: [20, 12],
        };
        let clear = [Pixel::clear(&WIDTHS); 160];
        let (mut expected, mut found) = (clear, clear);
        painter.draw(
            &footprint,
            &mut Target::new(&mut expected, window, 16).unwrap(),
        );
        let mut target = Target::new(&mut found, window, 16).unwrap();
        let coverage = painter.draw_stamp(&stamp, &footprint, &mut target);
        assert_eq!(
            (coverage.visited, coverage.covered, coverage.finished),
            (49, 13, 0)
        );
        assert_eq!(transmittances(target.row(5, 4, 16), 16).len(), 5);
        let opaque = Footprint {
            opacity: 2 << 18,
            ..footprint
        };
        painter.draw_stamp(&stamp, &opaque, &mut target);
        let coverage = painter.draw_stamp(&stamp, &footprint, &mut target);
        assert_eq!((coverage.covered, coverage.finished), (13, 1));
        let mut again = clear;
        let mut target = Target::new(&mut again, window, 16).unwrap();
        painter.draw_stamp(&stamp, &footprint, &mut target);
        assert_eq!(transmittances(&again, 16), transmittances(&expected, 16));
        assert_eq!(transmittances(&again, 16).len(), 13);
    });
}

/// A point that lies before a splat hides it, and what is gathered is composited in a window that begins anywhere.
#[test]
fn gathered_points_are_composited_in_their_place() {
    with_painter(|painter, _| {
        let [red, green] = [[1 << 20, 0, 0], [0, 1 << 20, 0]];
        let (point, splat) = (round(red), round(green));
        let settings = PointSettings {
            range: 1 << 10,
            stamp: None,
        };
        let window = Window {
            first: [8, 3],
            end: [12, 8],
        };
        let mut pixels = [Pixel::clear(&WIDTHS); 20];
        let mut memory = [Slab::default(); 20];
        let mut slabs = Slabs::new(&mut memory, window).unwrap();
        let mut target = Target::new(&mut pixels, window, 4).unwrap();
        painter.draw_point(&point, &settings, &mut target, &mut slabs);
        painter.draw_among_points(&splat, &mut target, &mut slabs);
        painter.finish_points(&mut target, &mut slabs);
        let [red, green, _] = target.row(5, 9, 1)[0].colour;
        assert!(red.abs_diff(2 * green) < 4, "{red} before {green}");

        let mut pixels = [Pixel::clear(&WIDTHS); 20];
        let mut slabs = Slabs::new(&mut memory, window).unwrap();
        let mut target = Target::new(&mut pixels, window, 4).unwrap();
        painter.draw_point(&point, &settings, &mut target, &mut slabs);
        painter.finish_points(&mut target, &mut slabs);
        assert_eq!(transmittances(&pixels, 4).len(), 12);
    });
}

/// A sphere ends where its corrected index does, and draws nothing beyond.
#[test]
fn spheres_end_with_their_index() {
    let entries = [0; PERSPECTIVE_ENTRIES];
    let camera = crate::view::View {
        rotation: [[fixed::types::I2F30::ZERO; 3]; 3],
        pose: crate::view::Eye::ORIGIN,
        focal: [SoftFloat::from_wide(1, 0, 24); 2],
        principal: [fixed::types::I32F32::ZERO; 2],
        near: crate::math::Extended::ZERO,
        far: crate::math::Extended::MAX,
        viewport: [20, 12],
        projection: crate::view::Projection::Perspective,
        limits: crate::view::RatioLimits {
            low: [fixed::types::I32F32::MIN; 2],
            high: [fixed::types::I32F32::MAX; 2],
        },
    };
    let perspective = Perspective {
        table: PerspectiveTable::new(&entries),
        rays: Rays::new(&camera),
    };
    with_painter(|painter, _| {
        let drawn = |end: u32| {
            let sphere = SphereFootprint {
                footprint: round([0; 3]),
                // Beyond the table, so that the formula is taken.
                spread: u32::MAX,
                slant: None,
                end,
            };
            let mut pixels = [Pixel::clear(&WIDTHS); 240];
            let window = camera.window();
            painter.draw_sphere(
                &sphere,
                &perspective,
                &mut Target::new(&mut pixels, window, 20).unwrap(),
            );
            transmittances(&pixels, 20).len()
        };
        // The middle's index is 0, so that an end of one unit has it and one of 0 does not.
        assert_eq!([0, 1 << 4].map(drawn), [0, 1]);
    });
}

/// Lanes of more bits than the index are cut, noise below 0 is 0.
#[test]
fn an_end_of_one_unit_holds_zero() {
    assert_eq!(inside(0i64, 3, 1), Some(0));
    assert_eq!(inside(-9i64, 3, 1), Some(0));
    assert_eq!(inside(4i64, 3, 1), None);
}
