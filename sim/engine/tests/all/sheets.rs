//! Sheets and the deep channel, painted by vectors: the same bits as by the kernel's own painter.

use splatline::blend::deep::{Channel, ChannelRounding, Representation};
use splatline_engine::camera::Camera;
use splatline_engine::design::DesignChoice;
use splatline_engine::fast::lanes::VectorLevel;
use splatline_engine::fixed::{self, Options, PaintEngine};
use splatline_engine::picture::Picture;
use splatline_engine::rules::{Antialias, Compositing, Rules};
use splatline_engine::scene::{Scene, synthetic};
use splatline_engine::sheets::{SheetKind, SheetPlan};
use splatline_reference::engines::sheets;

const KINDS: [SheetKind; 3] = [
    SheetKind::AxisAligned,
    SheetKind::ImageAligned,
    SheetKind::ImageAlignedCut,
];

const LEVELS: [VectorLevel; 3] = [VectorLevel::Best, VectorLevel::Avx2, VectorLevel::Portable];

/// Splats in several tiles, some of them over many blocks, seen by a picture whose size is no multiple of either.
fn scene() -> (Scene, Camera) {
    let scene = synthetic::random_gaussians(600, 7, 4.0);
    let camera = scene.default_camera(150, 101);
    (scene, camera)
}

/// Draws by the kernel and by vectors of every level, in every design.
fn all_agree(what: &str, draw: impl Fn(&Options, PaintEngine) -> Picture) {
    for design in DesignChoice::all() {
        for compositing in [Compositing::FrontToBack, Compositing::BackToFront] {
            let options = Options {
                rules: &Rules::EWA,
                compositing,
                design: &design,
                traversal: design.traversal,
            };
            let expected = draw(&options, PaintEngine::Scalar);
            let seen = expected
                .pixels
                .iter()
                .filter(|pixel| pixel[3] > 0.0)
                .count();
            assert!(seen > 5_000, "{what}: {seen} pixels");
            for level in LEVELS {
                let drawn = draw(&options, PaintEngine::Vectors(level));
                assert!(drawn == expected, "{what}, {}, {level:?}", design.name);
            }
        }
    }
}

#[test]
fn sheets_by_vectors_are_the_kernels() {
    let (scene, camera) = scene();
    for kind in KINDS {
        let plan = SheetPlan::new(kind, 0.5, &scene, &camera);
        all_agree(&format!("{kind:?}"), |options, engine| {
            fixed::sheets::draw(&scene, &camera, options, engine, &plan)
        });
    }
}

/// Sheets are drawn in units in which the scene's depths fill their range, and the spacing of samples is in scene
/// units; parts of a splat end where the whole one does, and what finishes a pixel may itself be left out.
#[test]
fn sheets_are_those_of_double_precision() {
    let (scene, camera) = scene();
    let design = DesignChoice::named("standard24").unwrap();
    for rules in [Rules::EWA, Rules::GAUSSIAN_3D] {
        let rules = rules.with_antialias(Antialias::Swan(0.2));
        for kind in KINDS {
            let options = Options {
                rules: &rules,
                compositing: Compositing::FrontToBack,
                design: &design,
                traversal: design.traversal,
            };
            let plan = SheetPlan::new(kind, 0.5, &scene, &camera);
            let drawn = fixed::sheets::draw(&scene, &camera, &options, PaintEngine::Scalar, &plan);
            let wanted = sheets::draw(&scene, &camera, &rules, &plan).picture;
            let pairs = drawn
                .pixels
                .iter()
                .flatten()
                .zip(wanted.pixels.iter().flatten());
            let differences = pairs.map(|(drawn, wanted)| (drawn - wanted).abs());
            let largest = differences.fold(0.0, f64::max);
            // Shares of a cut splat have 16 bits.
            assert!(largest < 1e-4, "{}, {kind:?}: {largest}", rules.name);
        }
    }
}

#[test]
fn the_deep_channel_by_vectors_is_the_kernels() {
    let (scene, camera) = scene();
    for width in [8, 24] {
        let representation = Representation::Transmittance;
        let channel = Channel::new(representation, ChannelRounding::Nearest, width).unwrap();
        all_agree(&format!("{width} bits"), |options, engine| {
            fixed::deep::draw(&scene, &camera, options, engine, channel)
        });
    }
}
