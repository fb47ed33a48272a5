//! The front door draws, bit for bit, what the stages draw: the oracle chains them by hand, with a table of its own.

use crate::common::{SIZE, pictures, splats, view};
use proptest::prelude::*;
use splatline::blend::Pixel;
use splatline::blend::edge::USUAL_THRESHOLD;
use splatline::blend::layers::Layers;
use splatline::blend::resolve::Resolve;
use splatline::blend::surface::{Accumulation, Cell, WeightedSum};
use splatline::draw::surface::SurfacePainter;
use splatline::draw::{Coverage, Painter};
use splatline::footprint::Footprint;
use splatline::format::{Classic8, Deep32, Lean18, Micro16, Standard24, Traversal};
use splatline::front::{
    BoundedList, Counts, DisplayList, LentList, ListFull, NoTable, PackedList, Renderer,
    packed_words,
};
use splatline::kernel::{FootprintTable, Kernel, Tabled, entries, fill_gaussian};
use splatline::raster::Window;
use splatline::rules::{Compositing, Rules};
use splatline::setup::{Cull, setup, setup_surface};
use splatline::splat::VolumeSplat;
use splatline::target::cells::CellTarget;
use splatline::target::{Target, TargetError};
use splatline::view::{Projection, View};
use splatline::{Camera, Gaussian, Point, RenderError, SurfaceRenderer, Surfel};

const PIXELS: usize = SIZE as usize * SIZE as usize;

/// A picture stage by stage: setup, a stable sort by depth, the painter over the whole viewport.
fn by_stages<D: Tabled>(
    design: D,
    view: &View,
    rules: &Rules,
    compositing: Compositing,
    traversal: Traversal,
    scene: &[VolumeSplat],
) -> (Vec<Pixel>, Coverage, Counts) {
    let widths = design.widths();
    let mut counts = Counts::default();
    let mut footprints: Vec<Footprint> = Vec::new();
    for splat in scene {
        match setup(design, view, rules, splat) {
            Ok(footprint) => footprints.push(footprint),
            Err(reason) => {
                let place = Cull::ALL.iter().position(|r| *r == reason).unwrap();
                counts.culled[place] += 1;
            }
        }
    }
    counts.drawn = footprints.len() as u32;
    footprints.sort_by_key(|footprint| footprint.depth);
    if compositing == Compositing::BackToFront {
        footprints.reverse();
    }
    let mut table = vec![0; entries(&widths)];
    fill_gaussian(&mut table, &widths, rules.table_range);
    let table = FootprintTable::new(&table, &widths, rules.table_range).unwrap();
    let painter = Painter::new(design, rules, table, compositing, traversal);
    let [columns, rows] = view.viewport;
    let mut pixels = vec![Pixel::clear(&widths); usize::from(columns) * usize::from(rows)];
    let mut target = Target::new(&mut pixels, view.window(), columns.into()).unwrap();
    let mut coverage = Coverage::default();
    for footprint in &footprints {
        coverage += painter.draw(footprint, &mut target);
    }
    (pixels, coverage, counts)
}

/// The same through the front door, whole and in strips of `rows`, by both display lists.
fn compare<D: Tabled>(
    design: D,
    view: &View,
    rules: Rules,
    compositing: Compositing,
    traversal: Traversal,
    scene: &[VolumeSplat],
    rows: u16,
) -> Result<(), TestCaseError> {
    let (expected, coverage, counts) =
        by_stages(design, view, &rules, compositing, traversal, scene);
    let renderer = Renderer::with_rules(design, rules)
        .unwrap()
        .with_compositing(compositing)
        .with_traversal(traversal);
    let mut bounded = BoundedList::<24>::new();
    let mut pixels = [Pixel::default(); PIXELS];
    let (frame, got) = renderer
        .render(view, scene, &mut bounded, &mut pixels)
        .unwrap();
    prop_assert_eq!(frame.pixels, expected.as_slice());
    let by_words = D::PACKED_16.is_some()
        && rules.table_range == 4
        && (compositing, traversal) == (Compositing::FrontToBack, Traversal::Spans);
    prop_assert_eq!(frame.coverage, (!by_words).then_some(coverage));
    prop_assert_eq!(got, counts);
    prop_assert_eq!(got.total() as usize, scene.len());

    let (mut footprints, mut order) = ([Footprint::EMPTY; 24], [7; 30]);
    let mut lent = LentList::new(&mut footprints, &mut order);
    prop_assert_eq!(renderer.set_up(view, scene, &mut lent), Ok(counts));
    prop_assert_eq!(lent.footprints(), bounded.footprints());
    prop_assert_eq!(lent.order(), bounded.order());
    let mut strip = [Pixel::default(); PIXELS];
    let mut joined = Vec::new();
    let (mut sum, mut counted) = (Coverage::default(), true);
    for window in view.window().strips(rows) {
        let part = renderer.draw(&lent, window, &mut strip).unwrap();
        joined.extend_from_slice(part.pixels);
        counted &= part.coverage.is_some();
        sum += part.coverage.unwrap_or_default();
    }
    prop_assert!(
        joined == expected,
        "strips of {rows} rows differ from the frame"
    );
    prop_assert!(!counted || sum == coverage);

    // The packed list: any order of the conics that it does not keep would show in a box.
    if traversal == Traversal::Spans {
        let mut words = vec![7; (scene.len() + 1) * packed_words(&design.widths())];
        let mut packed = PackedList::new(design, &mut words);
        prop_assert_eq!(renderer.set_up_scene(view, scene, &mut packed), Ok(counts));
        prop_assert_eq!(packed.len(), counts.drawn as usize);
        for (place, number) in bounded.order().iter().enumerate() {
            let expected = Footprint {
                depth: 0,
                conic: Footprint::EMPTY.conic,
                ..bounded.footprints()[*number as usize]
            };
            prop_assert_eq!(packed.footprint(place), Some(expected));
        }
        joined.clear();
        for window in view.window().strips(rows) {
            joined.extend_from_slice(renderer.draw(&packed, window, &mut strip).unwrap().pixels);
        }
        prop_assert!(joined == expected, "the packed list draws another picture");
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn the_front_door_draws_what_the_stages_draw(
        mut scene in prop::collection::vec(splats(), 0..20), angles in prop::array::uniform2(-0.5f64..0.5), twins in 0usize..4,
        design in 0..5, mode in 0usize..3, orthographic: bool, gaussian_3d: bool, by_box: bool, rows in 1u16..SIZE,
    ) {
        // Some splats twice, in another colour: equal depths must keep the scene's order.
        for twin in 0..twins.min(scene.len()) {
            let mut again = scene[twin];
            again.colour.rotate_left(1);
            scene.push(again);
        }
        let projection = if orthographic { Projection::Orthographic } else { Projection::Perspective };
        let view = view(angles[0], angles[1], projection);
        let rules = if gaussian_3d { Rules::GAUSSIAN_3D } else { Rules::EWA };
        let mode = [Compositing::FrontToBack, Compositing::BackToFront, Compositing::XRay][mode];
        let traversal = if by_box { Traversal::Box } else { Traversal::Spans };
        match design {
            0 => compare(Classic8, &view, rules, mode, traversal, &scene, rows)?,
            1 => compare(Lean18, &view, rules, mode, traversal, &scene, rows)?,
            2 => compare(Micro16, &view, rules, mode, traversal, &scene, rows)?,
            3 => compare(Standard24, &view, rules, mode, traversal, &scene, rows)?,
            _ => compare(Deep32, &view, rules, mode, traversal, &scene, rows)?,
        }
    }

    /// Any f32 in any field: a splat is drawn, culled for a reason, or invalid, and counted once.
    #[test]
    fn every_number_is_drawn_culled_or_invalid(
        fields in prop::collection::vec(prop::array::uniform14(prop_oneof![3 => -4.0f32..4.0, 1 => any::<u32>().prop_map(f32::from_bits)]), 1..8),
    ) {
        let camera = Camera::look_at([0.0, 0.0, -4.0], [0.0; 3], [0.0, -1.0, 0.0], 45.0, [SIZE; 2]).unwrap();
        let scene: Vec<Gaussian> = fields.iter().map(|f| Gaussian {
            mean: [f[0], f[1], f[2]], rotation: [f[3], f[4], f[5], f[6]], scales: [f[7], f[8], f[9]], opacity: f[10], colour: [f[11], f[12], f[13]],
        }).collect();
        let mut list = BoundedList::<8>::new();
        let mut pixels = [Pixel::default(); PIXELS];
        let (frame, counts) = Renderer::new(Standard24).render(&camera.view().unwrap(), &scene, &mut list, &mut pixels).unwrap();
        prop_assert_eq!(counts.total() as usize, scene.len());
        let invalid = fields.iter().filter(|f| f.iter().any(|x| !x.is_finite()) || f[3..7] == [0.0; 4]);
        prop_assert_eq!(counts.invalid as usize, invalid.count());
        prop_assert_eq!(frame.rgb8([0; 3]).count(), PIXELS);
    }
}

pub fn camera() -> Camera {
    Camera::look_at(
        [0.0, 0.0, -4.0],
        [0.0; 3],
        [0.0, -1.0, 0.0],
        45.0,
        [SIZE; 2],
    )
    .unwrap()
}

#[test]
fn gaussians_and_points_are_their_splats() {
    let view = camera().view().unwrap();
    let gaussian = Gaussian {
        mean: [0.3, 0.1, 0.0],
        rotation: [0.9, 0.1, -0.2, 0.4],
        scales: [0.5, 0.2, 0.05],
        opacity: 0.8,
        colour: [1.0, 0.5, 0.25],
    };
    let point = Point {
        position: [-0.3, 0.2, 0.5],
        deviation: 0.3,
        opacity: 0.7,
        colour: [0.2, 0.9, 0.4],
    };
    let splats = [gaussian.splat().unwrap(), point.splat().unwrap()];
    let renderer = Renderer::new(Standard24);
    let (mut list, mut other) = (BoundedList::<2>::new(), BoundedList::<2>::new());
    renderer.set_up(&view, splats, &mut list).unwrap();
    renderer.add(&view, [gaussian], &mut other).unwrap();
    renderer.add(&view, [point], &mut other).unwrap();
    other.sort();
    assert_eq!(list.footprints(), other.footprints());
    assert_eq!(list.order(), other.order());
    // A point's footprint is round in the middle of the picture.
    let middle = Point {
        position: [0.0; 3],
        ..point
    };
    renderer.set_up(&view, [middle], &mut list).unwrap();
    let [round] = list.footprints() else {
        panic!("one footprint");
    };
    assert_eq!(round.ldl.shear.mantissa, 0);
    assert_eq!(round.first[0], round.first[1]);
    assert_eq!(round.end[0], round.end[1]);
}

#[test]
fn a_full_list_says_how_much_it_lacks() {
    let view = camera().view().unwrap();
    let behind = Gaussian {
        mean: [0.0, 0.0, -9.0],
        ..Gaussian::UNIT
    };
    let invalid = Gaussian {
        opacity: f32::NAN,
        ..Gaussian::UNIT
    };
    let scene = [
        Gaussian::UNIT,
        behind,
        Gaussian::UNIT,
        invalid,
        Gaussian::UNIT,
        Gaussian::UNIT,
    ];
    let renderer = Renderer::new(Standard24);
    let full = ListFull {
        capacity: 2,
        needed: 4,
    };
    let mut list = BoundedList::<2>::new();
    assert_eq!(renderer.set_up(&view, scene, &mut list), Err(full));
    assert!(list.footprints().is_empty() && list.order().is_empty());
    let (mut footprints, mut order) = ([Footprint::EMPTY; 3], [0; 2]);
    let mut lent = LentList::new(&mut footprints, &mut order);
    assert!(lent.footprints().is_empty());
    assert_eq!(renderer.set_up(&view, scene, &mut lent), Err(full));
    assert!(lent.footprints().is_empty() && lent.order().is_empty());
    let (mut list, mut pixels) = (BoundedList::<4>::new(), [Pixel::default(); PIXELS]);
    let counts = renderer.set_up(&view, scene, &mut list).unwrap();
    assert_eq!(
        (counts.drawn, counts.culled_for(Cull::Near), counts.invalid),
        (4, 1, 1)
    );
    let short = renderer.render(&view, scene, &mut list, &mut pixels[1..]);
    let expected = TargetError {
        needed: PIXELS,
        found: PIXELS - 1,
    };
    assert_eq!(short.unwrap_err(), RenderError::Target(expected));
}

#[test]
fn windows_may_be_empty_inverted_or_outside() {
    let view = camera().view().unwrap();
    let renderer = Renderer::new(Standard24);
    let mut list = BoundedList::<1>::new();
    renderer.set_up(&view, [Gaussian::UNIT], &mut list).unwrap();
    let mut pixels = [Pixel::default(); PIXELS];
    for (first, last, expected) in [
        ([5, 5], [5, 9], 0),
        ([9, 9], [5, 5], 0),
        ([65000, 3], [65010, 5], 20),
        ([0, 0], [3, 65535], 3 * 65535),
    ] {
        let window = Window { first, end: last };
        match renderer.draw(&list, window, &mut pixels) {
            Ok(frame) => {
                assert_eq!(frame.pixels.len(), expected);
                assert_eq!(frame.rgb565(0x1234).count(), expected);
                assert_eq!(frame.pixel(last[0], last[1]), None);
            }
            Err(error) => assert_eq!((error.needed, error.found), (expected, PIXELS)),
        }
    }
    assert_eq!(view.window().strips(0).count(), usize::from(SIZE));
    let heights: Vec<u16> = view.window().strips(40).map(|strip| strip.rows()).collect();
    assert_eq!(heights, [40, 40, 16]);
}

#[test]
fn rules_without_a_table_of_the_design_ask_for_one() {
    let cubic = Rules::EWA.with_kernel(Kernel::Cubic);
    let missing = Renderer::with_rules(Standard24, cubic).unwrap_err();
    assert_eq!(
        missing,
        NoTable {
            kernel: Kernel::Cubic,
            table_range: cubic.table_range
        }
    );
    let widths = Standard24::WIDTHS;
    let mut table = vec![0; entries(&widths)];
    splatline::kernel::fill(&mut table, &widths, cubic.table_range, Kernel::Cubic);
    assert!(Renderer::with_table(Standard24, cubic, &table[1..]).is_err());
    let view = camera().view().unwrap();
    let mut list = BoundedList::<1>::new();
    let renderer = Renderer::with_table(Standard24, cubic, &table).unwrap();
    assert_eq!(
        renderer
            .set_up(&view, [Gaussian::UNIT], &mut list)
            .map(|c| c.drawn),
        Ok(1)
    );
}

#[test]
fn a_designs_tables_are_those_that_the_kernel_fills() {
    fn check<D: Tabled>(design: D) {
        let widths = design.widths();
        assert_eq!(D::WIDTHS, widths);
        for (table, range) in [(D::GAUSSIAN_4, 2), (D::GAUSSIAN_16, 4)] {
            let mut filled = vec![0; entries(&widths)];
            fill_gaussian(&mut filled, &widths, range);
            assert_eq!(table, filled);
        }
    }
    check(Classic8);
    check(Micro16);
    check(Lean18);
    check(Standard24);
    check(Deep32);
}

/// A ball, a needle and a leaf that pass through each other, a spot behind them, in Gaussians and a point.
fn still_life<D: Tabled>(renderer: &Renderer<D>, name: &str, camera: Camera) {
    let ball = Gaussian {
        mean: [-0.3, 0.2, 0.3],
        scales: [0.35; 3],
        opacity: 0.9,
        colour: [1.0, 0.5, 0.1],
        ..Gaussian::UNIT
    };
    let needle = Gaussian {
        mean: [0.2, 0.0, 0.0],
        rotation: [0.9, 0.1, -0.2, 0.4],
        scales: [0.9, 0.03, 0.03],
        colour: [0.3, 1.0, 0.4],
        ..ball
    };
    let leaf = Gaussian {
        mean: [0.4, -0.4, 0.6],
        rotation: [0.9, 0.3, 0.2, -0.5],
        scales: [0.5, 0.2, 0.01],
        colour: [0.2, 0.4, 1.0],
        ..ball
    };
    let spot = Point {
        position: [1.5, 1.0, 4.0],
        deviation: 0.4,
        opacity: 0.6,
        colour: [1.0, 1.0, 0.9],
    };
    let view = camera.view().unwrap();
    let mut list = BoundedList::<4>::new();
    renderer
        .add(&view, [ball, needle, leaf], &mut list)
        .unwrap();
    renderer.add(&view, [spot], &mut list).unwrap();
    list.sort();
    let mut pixels = vec![Pixel::default(); PIXELS];
    let frame = renderer.draw(&list, view.window(), &mut pixels).unwrap();
    pictures::check(name, &frame, [20, 24, 40]);
}

#[test]
fn still_lifes_look_like_their_pictures() {
    let parallel = camera().orthographic(24.0);
    still_life(&Renderer::new(Standard24), "perspective", camera());
    still_life(&Renderer::new(Standard24), "orthographic", parallel);
    still_life(&Renderer::ewa(Lean18), "ewa", camera());
    still_life(&Renderer::new(Classic8), "classic8", camera());
    let x_ray = Renderer::new(Standard24).with_compositing(Compositing::XRay);
    still_life(&x_ray, "x-ray", camera());
}

/// Surfels of a ball: opaque, or so transparent that its back shines through.
fn ball_of_surfels(opacity: f32) -> Vec<Surfel> {
    let turn = |i: u16| {
        let (height, angle) = (1.0 - (2.0 * f32::from(i) + 1.0) / 300.0, 2.4 * f32::from(i));
        let ring = (1.0 - height * height).sqrt();
        [ring * angle.cos(), height, ring * angle.sin()]
    };
    let surfel = |i: u16| {
        let [x, y, z] = turn(i);
        let length = (x * x + z * z).sqrt();
        let across = [-z / length * 0.12, 0.0, x / length * 0.12];
        let along = [
            -x * y / length * 0.12,
            length * 0.12,
            -z * y / length * 0.12,
        ];
        Surfel {
            position: [x, y, z],
            tangents: [across, along],
            weight: 0.4,
            colour: [0.5 + 0.5 * x, 0.5 + 0.5 * y, 0.7],
            opacity,
            material: 0,
        }
    };
    (0..300).map(surfel).collect()
}

/// The surface renderer against its stages, whole and in strips.
fn surfaces<C: Cell + PartialEq>(opacity: f32, name: &str) {
    let view = camera().view().unwrap();
    let (widths, threshold) = (Standard24::WIDTHS, splatline::float::depth(0.2));
    let mut scene = ball_of_surfels(opacity);
    let mut cells = vec![C::EMPTY; PIXELS];
    let gather = WeightedSum::new(&widths, threshold);
    let mut target = CellTarget::new(&mut cells, view.window()).unwrap();
    let (table, spans) = (splatline::kernel::table_4::<Standard24>(), Traversal::Spans);
    let painter = SurfacePainter::new(Standard24, &Rules::SURFACE, table, gather, spans);
    let mut drawn = 0;
    for surfel in &scene {
        let footprint = setup_surface(Standard24, &view, &Rules::SURFACE, &surfel.splat().unwrap());
        drawn += u32::from(footprint.map(|f| painter.draw(&f, &mut target)).is_ok());
    }
    let resolve = Resolve::new(&widths, gather, None, None);
    let places = (0..SIZE).flat_map(|y| (0..SIZE).map(move |x| (x, y)));
    let expected: Vec<Pixel> = places
        .zip(&cells)
        .map(|((x, y), c)| resolve.pixel(c, x, y))
        .collect();

    let renderer = SurfaceRenderer::new(Standard24, threshold);
    let (mut cells, mut pixels) = (vec![C::EMPTY; PIXELS], vec![Pixel::default(); PIXELS]);
    let mut joined = Vec::new();
    for window in view.window().strips(20) {
        let strip = renderer
            .draw(&view, &scene, window, &mut cells, &mut pixels)
            .unwrap()
            .0;
        joined.extend_from_slice(strip.pixels);
    }
    let mut invalid = scene[7];
    invalid.position[1] = f32::NAN;
    scene.insert(100, invalid);
    let whole = renderer.draw(&view, &scene, view.window(), &mut cells, &mut pixels);
    let (frame, counts) = whole.unwrap();
    assert!(frame.pixels == expected && joined == expected, "{name}");
    assert_eq!(
        (counts.drawn, counts.invalid, counts.total()),
        (drawn, 1, 301)
    );
    pictures::check(name, &frame, [20, 24, 40]);
    let pixel = |x: u16, y: u16| expected[usize::from(y) * usize::from(SIZE) + usize::from(x)];
    for [columns, rows] in [[4, SIZE], [0, SIZE]] {
        let window = Window {
            first: [SIZE / 2, 0],
            end: [SIZE / 2 + columns, rows],
        };
        let part = renderer.draw(&view, &scene, window, &mut cells, &mut pixels);
        let (part, _) = part.unwrap();
        let places = (0..rows).flat_map(|y| (0..columns).map(move |x| (SIZE / 2 + x, y)));
        let own: Vec<Pixel> = places.map(|(x, y)| pixel(x, y)).collect();
        assert!(part.pixels == own);
    }
    let edges = splatline::blend::edge::EdgeFilter::new(USUAL_THRESHOLD);
    let other = SurfaceRenderer::new(Standard24, threshold)
        .with_resolve(|gather| Resolve::new(&widths, gather, None, edges))
        .with_traversal(Traversal::Box);
    let window = view.window();
    let (mut plain, mut edged) = (pixels.clone(), pixels.clone());
    let (plain, _) = renderer
        .draw(&view, &scene, window, &mut cells, &mut plain)
        .unwrap();
    let (edged, _) = other
        .draw(&view, &scene, window, &mut cells, &mut edged)
        .unwrap();
    assert!(plain.pixels != edged.pixels);
    let mut boxed = pixels.clone();
    let (boxed, _) = renderer
        .with_traversal(Traversal::Box)
        .draw(&view, &scene, window, &mut cells, &mut boxed)
        .unwrap();
    assert!(boxed.pixels != edged.pixels);
    let visited = |frame: &splatline::front::Frame| frame.coverage.unwrap().visited;
    assert!(visited(&edged) > visited(&plain));
    let short = renderer.draw(&view, &scene, view.window(), &mut cells[1..], &mut pixels);
    assert_eq!(
        short.unwrap_err(),
        TargetError {
            needed: PIXELS,
            found: PIXELS - 1
        }
    );
}

#[test]
fn surfels_are_drawn_as_by_the_stages() {
    surfaces::<Accumulation>(1.0, "surfels");
    surfaces::<Layers<4>>(0.5, "surfels-transparent");
}
