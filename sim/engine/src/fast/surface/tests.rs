//! Gathering on vectors against the kernel's painter: sums and layers word for word, and the counts.

use super::{Gather, GatherNumbers, GatherTask, SumTile, SurfaceTile};
use crate::camera::Camera;
use crate::fast::TableMemory;
use crate::fast::lanes::VectorLevel;
use crate::fast::setup::SurfaceOutcome;
use crate::fast::tests::{AnyWidths, VIEWPORT, any_widths, arbitrary, usual_widths, window};
use crate::fixed::surface::{QuantisedPoints, kernel_rules};
use crate::scene::points::synthetic::{Paint, scene, sphere};
use crate::surface::Style;
use proptest::prelude::*;
use splatline::blend::layers::Layers;
use splatline::blend::surface::{Accumulation, Cell, Fragment, Sample, WeightedSum};
use splatline::draw::Coverage;
use splatline::draw::surface::SurfacePainter;
use splatline::footprint::surface::{Attributes, Plane, SurfaceFootprint, attribute_fraction};
use splatline::format::{Standard24, Traversal, Widths};
use splatline::raster::Window;
use splatline::rules::Rules;
use splatline::setup::setup_surface;
use splatline::target::cells::CellTarget;

const LEVELS: [VectorLevel; 3] = [VectorLevel::Best, VectorLevel::Avx2, VectorLevel::Portable];

/// One tile drawn under some widths.
struct Subject<'a> {
    widths: Widths,
    rules: Rules,
    threshold: u32,
    footprints: &'a [SurfaceOutcome],
    window: Window,
}

impl Subject<'_> {
    fn gather(&self) -> WeightedSum {
        WeightedSum::new(&self.widths, self.threshold)
    }

    /// By the kernel.
    fn expected<C: Cell>(&self) -> (Vec<C>, Coverage) {
        self.with_painter(|painter| {
            let mut cells = vec![C::EMPTY; self.window.pixels()];
            let mut target = CellTarget::new(&mut cells, self.window).unwrap();
            let mut coverage = Coverage::default();
            for footprint in self.footprints.iter().flatten() {
                coverage += painter.draw(footprint, &mut target);
            }
            (cells, coverage)
        })
    }

    fn with_painter<T>(&self, work: impl FnOnce(&SurfacePainter<AnyWidths>) -> T) -> T {
        let table = TableMemory::new(&self.widths, &self.rules);
        let (design, rules, gather) = (any_widths(self.widths), &self.rules, self.gather());
        let (table, traversal) = (table.table(), Traversal::Spans);
        work(&SurfacePainter::new(
            design, rules, table, gather, traversal,
        ))
    }

    /// By vectors, into whatever gathers; `None` where they cannot.
    fn painted(&self, choice: VectorLevel, gather: Gather, counts: bool) -> Option<Coverage> {
        let table = TableMemory::new(&self.widths, &self.rules);
        let numbers = GatherNumbers::new(&table, self.threshold, i32::BITS)?;
        let list: Vec<u32> = (0..self.footprints.len() as u32).collect();
        self.with_painter(|painter| {
            let task = GatherTask {
                numbers: &numbers,
                tile: SurfaceTile {
                    window: self.window,
                    footprints: self.footprints,
                    list: &list,
                },
                record: &|footprint, window, cells| {
                    painter.draw(footprint, &mut CellTarget::new(cells, window).unwrap())
                },
                gather,
                counts,
            };
            task.paint(choice)
        })
    }

    /// Draws by both; `false` if vectors do not.
    fn agree(&self) -> bool {
        let (cells, coverage) = self.expected::<Accumulation>();
        let (layers, _) = self.expected::<Layers<2>>();
        let known = |fragments: &[Fragment]| {
            let fragment = fragments.first().copied().unwrap_or_default();
            // The greatest depth is not kept, and that of an empty pixel is anything.
            let near = if fragment.weight == 0 {
                0
            } else {
                fragment.near
            };
            Fragment {
                near,
                far: 0,
                ..fragment
            }
        };
        for (choice, counts) in LEVELS
            .into_iter()
            .flat_map(|level| [(level, false), (level, true)])
        {
            let mut tile = SumTile::default();
            tile.open(self.window);
            let Some(got) = self.painted(choice, Gather::Sums(&mut tile), counts) else {
                return false;
            };
            assert!(got == coverage || !counts, "{choice:?}");
            let got = tile.cells().map(|cell| known(cell.fragments()));
            let expected = cells.iter().map(|cell| known(cell.fragments()));
            for (place, (got, expected)) in got.zip(expected).enumerate() {
                assert_eq!(got, expected, "{choice:?}, pixel {place}");
            }
            if !counts {
                continue;
            }
            let (gathered, got) = self.layers(choice);
            assert_eq!(got, Some(coverage), "{choice:?}");
            assert!(gathered == layers, "{choice:?}");
        }
        true
    }

    /// Two layers by vectors.
    fn layers(&self, choice: VectorLevel) -> (Vec<Layers<2>>, Option<Coverage>) {
        let gather = self.gather();
        let mut cells = vec![Layers::<2>::EMPTY; self.window.pixels()];
        let columns = usize::from(self.window.columns());
        let mut take =
            |attributes: &Attributes, place: [u16; 2], weights: &[i64], depths: &[i64]| {
                let [x, y] = [0, 1].map(|axis| usize::from(place[axis] - self.window.first[axis]));
                for (k, (weight, depth)) in weights.iter().zip(depths).enumerate() {
                    if *weight > 0 {
                        let (weight, depth) = (*weight as u32, *depth as u32);
                        let sample = Sample {
                            weight,
                            depth,
                            attributes,
                        };
                        cells[y * columns + x + k].add(&gather, &sample);
                    }
                }
            };
        let coverage = self.painted(choice, Gather::Samples(&mut take), true);
        (cells, coverage)
    }
}

/// Points of a ball and of a smaller one behind it, so that depths are on either side of the threshold.
fn ordinary(widths: Widths, rules: &Rules, count: usize) -> Vec<SurfaceOutcome> {
    let paint = |material, shade| Paint {
        colour: [shade, 0.5, 1.0 - shade],
        opacity: 0.8,
        material,
    };
    let mut points = sphere([0.1, 0.0, 0.0], 0.8, count, paint(1, 0.9));
    points.extend(sphere([0.0, 0.1, 0.5], 0.6, count / 2, paint(0, 0.2)));
    let [width, height] = VIEWPORT.map(usize::from);
    let eye = [0.3, -2.4, 0.4];
    let camera = Camera::look_at(eye, [0.0; 3], [0.0, 0.0, 1.0], 45.0, width, height).unwrap();
    let points = QuantisedPoints::new(&scene("balls", points), &camera);
    let splats = points.splats.iter();
    splats
        .map(|splat| setup_surface(any_widths(widths), &points.view, rules, splat))
        .collect()
}

/// Any rows and depths; attributes at most 1 in the attributes' format, and beyond it once in a while.
fn arbitrary_surface(widths: Widths) -> impl Strategy<Value = SurfaceFootprint> {
    let depths = (any::<[i64; 3]>(), 0u32..60);
    let attributes = (any::<[i32; 7]>(), any::<u8>(), 0u8..40, any::<bool>());
    (arbitrary(), depths, attributes).prop_map(move |(shape, (depths, spare), attributes)| {
        let (values, material, beyond, back) = attributes;
        let one = 1i32 << attribute_fraction(&widths);
        let values = values.map(|v| if beyond == 0 { v } else { v % (one + 1) });
        let [r, g, b, opacity, normal @ ..] = values;
        let [origin, across, down] = depths.map(|depth| depth >> spare);
        SurfaceFootprint {
            footprint: shape,
            plane: Plane {
                origin,
                step: [across >> 8, down >> 8],
            },
            attributes: Attributes {
                colour: [r, g, b].map(i32::unsigned_abs),
                opacity: opacity.unsigned_abs(),
                normal,
                material,
            },
            back,
        }
    })
}

fn widths_and_surfaces() -> impl Strategy<Value = (Widths, Vec<SurfaceFootprint>)> {
    usual_widths().prop_flat_map(|widths| {
        let footprints = prop::collection::vec(arbitrary_surface(widths), 1..24);
        (Just(widths), footprints)
    })
}

fn fits(footprint: &SurfaceFootprint, widths: &Widths) -> bool {
    let one = 1u32 << attribute_fraction(widths);
    let Attributes {
        colour,
        opacity,
        normal,
        ..
    } = footprint.attributes;
    colour.iter().chain([&opacity]).all(|value| *value <= one)
        && normal.iter().all(|n| n.unsigned_abs() <= one)
}

fn surface_rules(threshold: f64) -> Rules {
    kernel_rules(&Style::opaque(threshold))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn ordinary_points(
        widths in usual_widths(), count in 20usize..900, threshold in 0u32..1 << 24, tile in (0u16..3, 0u16..2),
    ) {
        let rules = surface_rules(0.1);
        let footprints = &ordinary(widths, &rules, count);
        let subject = Subject { widths, rules, threshold, footprints, window: window(tile) };
        prop_assert!(subject.agree());
    }

    #[test]
    fn arbitrary_words((widths, footprints) in widths_and_surfaces(), threshold: u32, tile in (0u16..3, 0u16..2)) {
        let all_fit = footprints.iter().all(|footprint| fits(footprint, &widths));
        let footprints: &Vec<_> = &footprints.into_iter().map(Ok).collect();
        let subject = Subject { widths, rules: surface_rules(0.1), threshold, footprints, window: window(tile) };
        prop_assert!(subject.agree() || !all_fit);
    }
}

/// More samples than a pixel's sum of weights has room for.
#[test]
fn a_full_pixel_stays_as_it_is() {
    let widths = Standard24::WIDTHS;
    let rules = surface_rules(0.1);
    let opaque = |surface: &SurfaceFootprint| {
        let mut surface = *surface;
        surface.footprint.opacity = 1 << widths.peak;
        Ok(surface)
    };
    let once: Vec<_> = ordinary(widths, &rules, 60)
        .iter()
        .flatten()
        .map(opaque)
        .collect();
    let footprints: &Vec<_> = &(0..200).flat_map(|_| once.iter().copied()).collect();
    for tile in [(0, 0), (1, 0)] {
        let subject = Subject {
            widths,
            rules,
            threshold: 1 << 22,
            footprints,
            window: window(tile),
        };
        let (cells, _) = subject.expected::<Accumulation>();
        let full = |cell: &&Accumulation| cell.fragments().iter().any(|f| f.weight > 127 << 24);
        assert!(cells.iter().filter(full).count() > 20);
        assert!(subject.agree());
    }
}
