//! Order-independent transparency: random order against sorted order, for different numbers of layers.

use super::{GalleryError, draw_both, draw_fixed, exhibit};
use crate::camera::Camera;
use crate::gallery::Exhibit;
use crate::reference;
use crate::scene::points::SurfaceScene;
use crate::scene::points::synthetic::{Paint, scene, sheet, sphere};
use crate::surface::{Buffer, Style};

/// Layers that are tried; the scene has at most six.
const LAYERS: [usize; 5] = [1, 2, 3, 4, 8];
/// Random orders that are tried for each.
const ORDERS: u64 = 4;

/// Three sheets that cross each other inside a translucent sphere.
pub fn transparent() -> Result<Exhibit, GalleryError> {
    let crossing = crossing_surfaces();
    let camera = Camera::look_at([0.6, -5.0, 1.4], [0.0; 3], crossing.up, 32.0, 384, 384)?;
    let style = Style::layered(2.0 * crossing.radius, 8);
    let mut exhibit = exhibit(
        "Semi-transparent surfaces in any order",
        "[SURF] section 6, eq. 12 (system 11)",
        "Three crossing sheets of opacity 0.5 in a sphere of opacity 0.25. Splats sorted by depth, against splats shuffled: pixels that differ in any \
         bit, all of them and those where no more layers overlap than the buffer holds (counted by the reference with unlimited layers).",
    );
    let (drawing, _) = draw_both(
        &mut exhibit,
        "8 layers, sorted",
        &sorted(&crossing, &camera),
        &camera,
        &style,
    )?;
    exhibit
        .pictures
        .push(("transparent_8_layers".to_owned(), drawing.picture));
    let unlimited = Style {
        buffer: Buffer::Layers(usize::MAX),
        ..style
    };
    let truth = reference::surface::draw(&crossing, &camera, &unlimited);
    let most = truth.fragments.iter().map(Vec::len).max().unwrap_or(0);
    exhibit.number("layers at the deepest pixel", most as f64, "");
    for layers in LAYERS {
        let style = Style {
            buffer: Buffer::Layers(layers),
            ..style
        };
        let in_order = draw_fixed(&sorted(&crossing, &camera), &camera, &style);
        let (mut all, mut within) = (0, 0);
        for order in 0..ORDERS {
            let random = draw_fixed(&shuffled(&crossing, order), &camera, &style);
            let pixels = in_order
                .pixels
                .iter()
                .zip(&random.pixels)
                .zip(&truth.fragments);
            for ((sorted, shuffled), fragments) in pixels {
                all += usize::from(sorted != shuffled);
                within += usize::from(sorted != shuffled && fragments.len() <= layers);
            }
            if layers == 2 && order == 0 {
                exhibit
                    .pictures
                    .push(("transparent_2_layers_shuffled".to_owned(), random.picture));
            }
        }
        let deep = truth
            .fragments
            .iter()
            .filter(|fragments| fragments.len() > layers)
            .count();
        exhibit.number(
            format!("{layers} layers: pixels with more layers"),
            deep as f64,
            "",
        );
        exhibit.number(
            format!("{layers} layers: pixels that differ in {ORDERS} random orders"),
            all as f64,
            "",
        );
        exhibit.number(
            format!("{layers} layers: of these, with at most {layers} layers"),
            within as f64,
            "",
        );
    }
    Ok(exhibit)
}

fn crossing_surfaces() -> SurfaceScene {
    let glass = |colour: [f64; 3], opacity: f64| {
        move |_: f64, _: f64| Paint {
            colour,
            opacity,
            material: 0,
        }
    };
    let spacing = 0.025;
    let mut points = sheet(
        [0.0; 3],
        [[0.9, 0.0, 0.0], [0.0, 0.5, 0.7]],
        spacing,
        glass([0.9, 0.2, 0.15], 0.5),
    );
    points.extend(sheet(
        [0.0; 3],
        [[0.6, 0.6, 0.0], [0.2, -0.3, 0.8]],
        spacing,
        glass([0.15, 0.8, 0.25], 0.5),
    ));
    points.extend(sheet(
        [0.0, 0.1, 0.1],
        [[0.7, -0.5, 0.1], [0.1, 0.4, 0.8]],
        spacing,
        glass([0.2, 0.35, 0.95], 0.5),
    ));
    let shell = Paint {
        colour: [1.0, 0.95, 0.8],
        opacity: 0.25,
        material: 0,
    };
    points.extend(sphere([0.0; 3], 1.25, 36_000, shell));
    scene("crossing surfaces", points)
}

/// Nearest point first.
fn sorted(scene: &SurfaceScene, camera: &Camera) -> SurfaceScene {
    let mut sorted = scene.clone();
    let depth = |centre: [f64; 3]| camera.to_camera(centre)[2];
    sorted
        .points
        .sort_by(|a, b| depth(a.centre).total_cmp(&depth(b.centre)));
    sorted
}

/// Fisher-Yates by a 64-bit linear congruential generator (Knuth's MMIX constants).
fn shuffled(scene: &SurfaceScene, seed: u64) -> SurfaceScene {
    let mut shuffled = scene.clone();
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    for last in (1..shuffled.points.len()).rev() {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        let other = (state >> 33) as usize % (last + 1);
        shuffled.points.swap(last, other);
    }
    shuffled
}
