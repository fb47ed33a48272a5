//! Order-independent transparency: random order against sorted order, for different numbers of layers.

use super::{GalleryError, draw_both, draw_fixed, exhibit, on_paper};
use crate::gallery::Exhibit;
use splatline_sim::camera::Camera;
use splatline_sim::metrics::compare;
use splatline_sim::reference;
use splatline_sim::scene::points::SurfaceScene;
use splatline_sim::scene::points::synthetic::{Paint, scene, sheet, sphere};
use splatline_sim::surface::{Buffer, Style};

/// Layers that are tried; the scene has at most six.
const LAYERS: [usize; 5] = [1, 2, 3, 4, 8];
/// Depth threshold in radii: sheets closer than this are one surface, so it is the width of the band along a crossing.
const THRESHOLD: f64 = 2.0;
/// Random orders that are tried for each.
const ORDERS: u64 = 4;

/// Three sheets that cross each other inside a translucent sphere.
pub fn transparent() -> Result<Exhibit, GalleryError> {
    let crossing = crossing_surfaces();
    let camera = Camera::look_at([0.6, -5.0, 1.4], [0.0; 3], crossing.up, 32.0, 384, 384)?;
    let style = Style::layered(THRESHOLD * crossing.radius, 8);
    let mut exhibit = exhibit(
        "Semi-transparent surfaces in any order",
        "[SURF] section 6, eq. 12 (system 11)",
        "Three crossing sheets of opacity 0.5 in a sphere of opacity 0.25. Splats sorted by depth, against splats shuffled (4 orders): pixels that \
         differ in any bit. So many layers overlap at a pixel as it has samples that are pairwise farther apart than the threshold, by the \
         reference: no order of drawing ever has more fragments open. Where surfaces are steep, samples of one layer can open several \
         fragments before others join them; so fewer layers may be left at the end than overlap.",
    );
    let (drawing, _) = draw_both(
        &mut exhibit,
        "8 layers, sorted",
        &sorted(&crossing, &camera),
        &camera,
        &style,
    )?;
    exhibit.pictures.push((
        "8 layers, sorted by depth".to_owned(),
        on_paper(&drawing.picture),
    ));
    let unlimited = Style {
        buffer: Buffer::Layers(usize::MAX),
        ..style
    };
    let truth = reference::surface::draw(&crossing, &camera, &unlimited);
    let deepest = truth.fragments.iter().map(Vec::len).max().unwrap_or(0);
    exhibit.number("most layers of a pixel", deepest as f64, "");
    let overlapping = reference::surface::overlapping_layers(&crossing, &camera, &style);
    for layers in LAYERS {
        let buffer = Buffer::Layers(layers);
        let style = Style { buffer, ..style };
        let in_order = draw_fixed(&sorted(&crossing, &camera), &camera, &style);
        let errors = compare(&in_order.picture, &truth.picture)?;
        let psnr = errors.colour.psnr_db;
        exhibit.number(
            format!("{layers} layers: PSNR against unlimited layers"),
            psnr,
            "dB",
        );
        let mut differing = Differing::default();
        for order in 0..ORDERS {
            let random = draw_fixed(&shuffled(&crossing, order), &camera, &style);
            for (index, pixel) in random.pixels.iter().enumerate() {
                if *pixel != in_order.pixels[index] {
                    differing.all += 1;
                    differing.overlapping += usize::from(overlapping[index] <= layers);
                    differing.clusters += usize::from(truth.fragments[index].len() <= layers);
                }
            }
            if layers == 2 && order == 0 {
                let name = "2 layers, shuffled: not enough".to_owned();
                exhibit.pictures.push((name, on_paper(&random.picture)));
            }
            if layers == 8 && order == 0 {
                let name = "8 layers, shuffled: equal".to_owned();
                exhibit.pictures.push((name, on_paper(&random.picture)));
            }
        }
        let within = overlapping.iter().filter(|count| **count <= layers).count();
        let title = |what: &str| format!("{layers} layers: {what}");
        exhibit.number(title("pixels where no more overlap"), within as f64, "");
        exhibit.number(
            title("of these, different after shuffling"),
            differing.overlapping as f64,
            "",
        );
        exhibit.number(
            title("all pixels different after shuffling"),
            differing.all as f64,
            "",
        );
        exhibit.number(
            title("of these, with no more layers at the end"),
            differing.clusters as f64,
            "",
        );
    }
    Ok(exhibit)
}

/// Pixels, over all random orders, that are not the sorted drawing's in every bit.
#[derive(Default)]
struct Differing {
    all: usize,
    /// Where no more layers overlap than the buffer holds.
    overlapping: usize,
    /// Where no more layers than that are left when everything is drawn.
    clusters: usize,
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
