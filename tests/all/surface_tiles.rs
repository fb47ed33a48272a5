//! A picture of surfaces is the same whatever its tiles, and no cell outside the window is written.

use fixed::types::{I2F30, I32F32, U4F28};
use proptest::prelude::*;
use splatline::blend::edge::EdgeFilter;
use splatline::blend::layers::Layers;
use splatline::blend::resolve::Resolve;
use splatline::blend::shading::{Material, Shading};
use splatline::blend::surface::{Cell, Filtered, Sample, WeightedSum};
use splatline::draw::surface::SurfacePainter;
use splatline::footprint::surface::{Attributes, SurfaceFootprint};
use splatline::format::{Design, Standard24, Traversal};
use splatline::kernel::{FootprintTable, entries, gaussian};
use splatline::math::{Extended, SoftFloat};
use splatline::raster::Window;
use splatline::rules::Rules;
use splatline::setup::setup_surface;
use splatline::splat::Axis;
use splatline::splat::surface::SurfaceSplat;
use splatline::target::cells::CellTarget;
use splatline::view::{Eye, Projection, RatioLimits, View};

const SIDE: u16 = 96;
static TABLE: [u32; entries(&Standard24::WIDTHS)] = gaussian(&Standard24::WIDTHS, 2);

/// A number of setup as the depth range has it.
fn number(value: SoftFloat) -> Extended {
    Extended {
        value: value.mantissa.into(),
        exponent: value.exponent,
    }
}

fn scaled(value: f64) -> SoftFloat {
    SoftFloat::from_wide((value * 2f64.powi(40)) as i64, -40, 31)
}

fn view() -> View {
    let (one, zero) = (I2F30::from_bits(1 << 30), I2F30::ZERO);
    View {
        rotation: [[one, zero, zero], [zero, one, zero], [zero, zero, one]],
        pose: Eye::ORIGIN,
        focal: [scaled(90.0); 2],
        principal: [I32F32::from_num(48); 2],
        near: number(scaled(0.01)),
        far: number(scaled(500.0)),
        viewport: [SIDE; 2],
        projection: Projection::Perspective,
        limits: RatioLimits {
            low: [I32F32::MIN; 2],
            high: [I32F32::MAX; 2],
        },
    }
}

fn footprint(centre: [f64; 3], frame: [[f64; 3]; 2]) -> Option<SurfaceFootprint> {
    let splat = SurfaceSplat {
        centre: centre.map(scaled),
        frame: frame.map(|axis| Axis::from_components(axis.map(scaled))),
        normal: Axis::from_components([0.3, -0.2, 0.9].map(scaled)),
        weight: scaled(0.4),
        colour: [0.2, 0.5, 0.9].map(U4F28::from_num),
        opacity: U4F28::from_num(0.7),
        material: 1,
    };
    setup_surface(Standard24, &view(), &Rules::SURFACE, &splat).ok()
}

/// Light of 32 times a colour of 8 saturates where the sums' format ends, at 16.
#[test]
fn shading_saturates_at_16() {
    let widths = Standard24.widths();
    let bright = Material {
        ambient: u32::MAX,
        ..Material::UNLIT
    };
    let (materials, view) = ([bright], view());
    let shading = Shading::new(&widths, &materials, [0, 0, -(1 << 30)], &view);
    let filtered = Filtered {
        colour: [8 << widths.accumulator, 0, 1],
        ..Filtered::default()
    };
    let limit = (16u64 << widths.accumulator).min(u32::MAX.into()) as u32 - 1;
    assert_eq!(shading.shade(&filtered, 40, 40), [limit, 0, 32]);
}

/// Cells of a window after drawing all footprints; one cell more is lent and must stay empty.
fn cells(footprints: &[SurfaceFootprint], window: Window, traversal: Traversal) -> Vec<Layers<3>> {
    let widths = Standard24.widths();
    let table = FootprintTable::new(&TABLE, &widths, 2).unwrap();
    let gather = WeightedSum::new(&widths, 1 << 20);
    let painter = SurfacePainter::new(Standard24, &Rules::SURFACE, table, gather, traversal);
    let size = [0, 1].map(|axis| usize::from(window.end[axis] - window.first[axis]));
    let mut cells = vec![Layers::EMPTY; size[0] * size[1] + 1];
    let mut target = CellTarget::new(&mut cells, window).unwrap();
    for footprint in footprints {
        painter.draw(footprint, &mut target);
    }
    assert_eq!(cells.pop(), Some(Layers::EMPTY));
    cells
}

proptest! {
    /// Resolving is total: fragments, materials, light and camera of any bits.
    #[test]
    fn every_fragment_resolves(
        samples in proptest::collection::vec((any::<[u32; 6]>(), any::<[i32; 3]>(), any::<u8>()), 1..6),
        coefficients: [u32; 3], exponent: u8, light: [i32; 3], focal: (i32, i32), principal: i64,
        tau: u32, place: [u16; 2], orthographic: bool,
    ) {
        let widths = Standard24.widths();
        let gather = WeightedSum::new(&widths, 1000);
        let mut cell = Layers::<3>::EMPTY;
        for ([weight, depth, r, g, b, opacity], normal, material) in samples {
            let attributes = Attributes { colour: [r, g, b], opacity, normal, material: material % 2 };
            cell.add(&gather, &Sample { weight: weight >> 4, depth, attributes: &attributes });
        }
        let [ambient, diffuse, specular] = coefficients;
        let materials = [Material { ambient, diffuse, specular, exponent }];
        let view = View {
            focal: [SoftFloat { mantissa: focal.0, exponent: focal.1 }; 2],
            principal: [I32F32::from_bits(principal); 2],
            projection: if orthographic { Projection::Orthographic } else { Projection::Perspective },
            ..view()
        };
        let shading = Shading::new(&widths, &materials, light, &view);
        let resolve = Resolve::new(&widths, gather, Some(shading), EdgeFilter::new(tau));
        let [x, y] = place;
        let pixel = resolve.pixel(&cell, x, y);
        prop_assert!(pixel.transmittance <= 1 << widths.transmittance);
    }

    #[test]
    fn tiles_make_the_whole(
        places in proptest::collection::vec((proptest::array::uniform3(-2f64..2.0), proptest::array::uniform2(proptest::array::uniform3(-0.8f64..0.8))), 1..8),
        cut in proptest::array::uniform2(1..SIDE),
        by_box: bool,
    ) {
        let traversal = if by_box { Traversal::Box } else { Traversal::Spans };
        let footprints: Vec<_> =
            places.iter().filter_map(|([x, y, z], frame)| footprint([*x, *y, z + 4.0], *frame)).collect();
        let whole = cells(&footprints, Window { first: [0; 2], end: [SIDE; 2] }, traversal);
        let [x, y] = cut;
        for (first, last) in [([0, 0], [x, y]), ([x, 0], [SIDE, y]), ([0, y], [x, SIDE]), ([x, y], [SIDE, SIDE])] {
            let part = cells(&footprints, Window { first, end: last }, traversal);
            let columns = usize::from(last[0] - first[0]);
            for (index, cell) in part.iter().enumerate() {
                let (column, row) = (index % columns + usize::from(first[0]), index / columns + usize::from(first[1]));
                prop_assert_eq!(cell, &whole[row * usize::from(SIDE) + column], "column {} row {}", column, row);
            }
        }
    }
}

/// Weights of one splat at the corner of the screen as digits, in ninths of the peak: exp(-1) at the edge.
#[test]
fn one_splat_as_text() {
    let splat = footprint([-1.9, -1.95, 4.0], [[0.2, 0.05, 0.1], [-0.05, 0.12, 0.0]]).unwrap();
    let window = Window {
        first: [0, 0],
        end: [14, 11],
    };
    let cells = cells(&[splat], window, Traversal::Spans);
    let peak = f64::from(splat.footprint.opacity) / 2f64.powi(28 - 24);
    let sign = |cell: &Layers<3>| match cell.fragments().first() {
        Some(fragment) => format!("{:.0}", 9.0 * f64::from(fragment.weight) / peak),
        None => ".".to_owned(),
    };
    let rows: Vec<String> = cells
        .chunks(14)
        .map(|row| row.iter().map(sign).collect())
        .collect();
    let expected = "
55555544......
6677766543....
67888877654...
678999887654..
6788999887654.
5667888887654.
3456777776654.
..44556665544.
....34444444..
..............
..............";
    assert_eq!(rows.join("\n"), expected.trim());
}
