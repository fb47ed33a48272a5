//! Surface splats: the reference against other ways to the same thing, and the kernel against the reference.

use splatline::format::Traversal;
use splatline_engine::camera::Camera;
use splatline_engine::design::DesignChoice;
use splatline_engine::metrics::compare;
use splatline_engine::scene::points::synthetic::{Paint, scene, sheet, sphere};
use splatline_engine::scene::points::{self, SurfacePoint, SurfaceScene};
use splatline_engine::surface::{Buffer, Style};
use splatline_engine::vector::Vector;
use splatline_engine::{fixed, vector};
use splatline_reference::engines::Culled;
use splatline_reference::engines::surface::{draw, project};
use std::path::Path;

/// Least PSNR (dB) and largest bias of colour and alpha against the reference, by design.
const BARS: [(&str, f64, f64); 3] = [
    ("lean18", 60.0, 5e-4),
    ("standard24", 90.0, 1e-5),
    ("deep32", 95.0, 1e-5),
];

/// A tinted ball through a translucent sheet.
fn ball_and_sheet() -> SurfaceScene {
    let ball = Paint {
        colour: [0.9, 0.4, 0.2],
        opacity: 0.6,
        material: 1,
    };
    let mut points = sphere([0.1, 0.0, 0.0], 0.8, 6_000, ball);
    let tilted = [[1.2, 0.3, 0.1], [0.0, 0.5, 1.0]];
    points.extend(sheet([0.0; 3], tilted, 0.05, |a, b| Paint {
        colour: [0.5 + 0.4 * a, 0.5 - 0.4 * b, 0.6],
        opacity: 0.5,
        material: 0,
    }));
    scene("ball and sheet", points)
}

fn camera(size: usize) -> Camera {
    Camera::look_at(
        [0.5, -4.0, 1.0],
        [0.0; 3],
        [0.0, 0.0, 1.0],
        35.0,
        size,
        size,
    )
    .unwrap()
}

fn parallel(size: usize) -> Camera {
    let perspective = camera(size);
    let pixels_per_unit = 0.35 * size as f64;
    Camera {
        orthographic: true,
        fx: pixels_per_unit,
        fy: pixels_per_unit,
        ..perspective
    }
}

fn styles(threshold: f64) -> [(&'static str, Style); 4] {
    let opaque = Style::opaque(threshold);
    let light = Some([0.5, -1.0, 0.8]);
    [
        ("accumulation", opaque),
        (
            "edges",
            Style {
                edge: Some(0.4),
                ..opaque
            },
        ),
        ("shaded", Style { light, ..opaque }),
        (
            "layers",
            Style {
                light,
                ..Style::layered(threshold, 8)
            },
        ),
    ]
}

#[test]
fn the_kernel_is_near_the_reference() {
    let scene = ball_and_sheet();
    let mut table = String::new();
    for (view, camera) in [("perspective", camera(96)), ("orthographic", parallel(96))] {
        for (name, style) in styles(scene.usual_threshold()) {
            let float = draw(&scene, &camera, &style).picture;
            for (design, least, bias) in BARS {
                let choice = DesignChoice::named(design).unwrap();
                for traversal in [Traversal::Spans, Traversal::Box] {
                    let drawn = fixed::surface::draw(&scene, &camera, &style, &choice, traversal);
                    let errors = compare(&drawn.picture, &float).unwrap();
                    for error in [errors.colour, errors.alpha] {
                        let line = format!(
                            "{view} {name} {design} {traversal:?}: {:.1} dB, largest {:.1e}, bias {:.1e}\n",
                            error.psnr_db, error.max_abs, error.bias
                        );
                        assert!(error.psnr_db >= least && error.bias.abs() <= bias, "{line}");
                        table += &line;
                    }
                }
            }
        }
    }
    println!("{table}");
}

/// From far away, where points seen from their edges weigh less than any sum holds: they join no layers.
#[test]
fn layers_far_away_are_those_of_double_precision() {
    let scene = points::synthetic::named("glass").unwrap();
    let style = Style::layered(scene.usual_threshold(), 8);
    let (eye, up) = ([3.6, 0.0, 0.0], [0.0, 0.0, 1.0]);
    let camera = Camera::look_at(eye, [0.0; 3], up, 150.0, 96, 72).unwrap();
    let float = draw(&scene, &camera, &style).picture;
    let choice = DesignChoice::named("standard24").unwrap();
    let drawn = fixed::surface::draw(&scene, &camera, &style, &choice, Traversal::Spans);
    let error = compare(&drawn.picture, &float).unwrap().alpha;
    assert!(error.psnr_db >= 90.0, "{:.1} dB", error.psnr_db);
}

/// Covered samples that are brighter and darker than the reference, the mean of the differences over them, and the
/// mean's standard error.
///
/// Where a pixel's weights sum to little, at the silhouette, a sample is off by many units: single pixels move the
/// mean.
fn sides(scene: &SurfaceScene, style: &Style, design: &str) -> (usize, usize, f64, f64) {
    let camera = camera(128);
    let choice = DesignChoice::named(design).unwrap();
    let float = draw(scene, &camera, style).picture;
    let drawn = fixed::surface::draw(scene, &camera, style, &choice, Traversal::Spans).picture;
    let (mut bright, mut dark, mut samples) = (0, 0, 0);
    let (mut sum, mut squares) = (0.0, 0.0);
    for (a, b) in drawn.pixels.iter().zip(&float.pixels) {
        for channel in 0..3 {
            let difference = a[channel] - b[channel];
            if b[3] > 0.0 {
                bright += usize::from(difference > 0.0);
                dark += usize::from(difference < 0.0);
                sum += difference;
                squares += difference * difference;
                samples += 1;
            }
        }
    }
    let count = f64::from(samples);
    // A grey's three channels are one sample.
    let error = (3.0 * squares).sqrt() / count;
    (bright, dark, sum / count, error)
}

/// A surface of one colour: what its rounding does to all pixels alike shows as a map of one hue. With a colour's own
/// 24 bits the mean over the covered pixels was 3e-8 for 128/255, two units of the accumulator.
#[test]
fn errors_of_a_surface_have_no_side() {
    let paints = [128.0, 179.0, 77.0, 25.0].map(|grey| [grey / 255.0; 3]);
    let mut one_sided = false;
    for colour in [paints[0], paints[1], paints[2], paints[3], [0.9, 0.4, 0.2]] {
        let scene = scene("ball", sphere([0.0; 3], 1.0, 8_000, Paint::opaque(colour)));
        for light in [Some([0.5, -1.0, 0.8]), None] {
            let style = Style {
                light,
                ..Style::opaque(scene.usual_threshold())
            };
            for design in ["standard24", "deep32"] {
                let (bright, dark, mean, error) = sides(&scene, &style, design);
                let line = format!(
                    "{colour:?}, lit {}, {design}: {bright} bright, {dark} dark, {mean:+.1e} +- {error:.0e}",
                    light.is_some()
                );
                println!("{line}");
                one_sided |=
                    mean.abs() > 4.0 * error || 2 * bright > 3 * dark || 2 * dark > 3 * bright;
            }
        }
    }
    assert!(
        !one_sided,
        "a line above is beyond four standard errors, or three to two"
    );
}

/// A ball's back is left out by both engines alike, and its silhouette loses the fringe that the back's turned splats
/// made.
#[test]
fn backfaces_go_and_take_the_fringe_along() {
    let dark_side = Paint::opaque([0.8, 0.8, 0.8]);
    let scene = scene("ball", sphere([0.0; 3], 1.0, 4_000, dark_side));
    let camera = camera(96);
    let choice = DesignChoice::named("standard24").unwrap();
    let style = |cull_backfaces| Style {
        light: Some([0.5, -1.0, 0.8]),
        cull_backfaces,
        ..Style::opaque(scene.usual_threshold())
    };
    let [kept, culled] = [false, true].map(|cull| {
        let float = draw(&scene, &camera, &style(cull));
        let fixed = fixed::surface::draw(&scene, &camera, &style(cull), &choice, Traversal::Spans);
        let errors = compare(&fixed.picture, &float.picture).unwrap();
        assert!(
            errors.colour.psnr_db >= 90.0,
            "{cull}: {:.1} dB",
            errors.colour.psnr_db
        );
        assert_eq!(fixed.facts.backfaces, float.counts.culled(Culled::Backface));
        float
    });
    assert_eq!(kept.counts.culled(Culled::Backface), 0);
    // From 4 radii away the eye sees less than half of the ball.
    let share = culled.counts.culled(Culled::Backface) as f64 / scene.points.len() as f64;
    assert!((0.5..0.75).contains(&share), "{share}");
    // The same ball far finer is what both should look like inside its outline.
    let covered = |picture: &splatline_engine::picture::Picture| {
        picture.pixels.iter().filter(|p| p[3] > 0.0).count()
    };
    assert!(covered(&culled.picture) <= covered(&kept.picture));
    assert_ne!(culled.picture, kept.picture);
}

#[test]
fn constants_and_fields_give_the_same_bits() {
    let scene = ball_and_sheet();
    let style = Style::layered(scene.usual_threshold(), 3);
    for choice in DesignChoice::all() {
        let draw = |choice: &DesignChoice| {
            fixed::surface::draw(&scene, &camera(48), &style, choice, Traversal::Spans).pixels
        };
        assert_eq!(
            draw(&choice),
            draw(&choice.at_run_time()),
            "{}",
            choice.name
        );
    }
}

/// Where a place in camera space is seen, pixels.
fn seen_at([x, y, z]: Vector, camera: &Camera) -> [f64; 2] {
    let scale = if camera.orthographic { 1.0 } else { z };
    [
        camera.fx * x / scale + camera.cx,
        camera.fy * y / scale + camera.cy,
    ]
}

/// d(tangent coordinates)/d(pixel) at the splat's centre: rays through the pixel and its neighbours, cut with the
/// tangent plane (SURF 4). Columns are the change per column and per row, in standard deviations; none for a plane seen
/// edge-on.
fn inverse_jacobian(point: &SurfacePoint, camera: &Camera) -> Option<[[f64; 2]; 2]> {
    let centre = camera.to_camera(point.centre);
    let [s1, s2] = point
        .frame
        .map(|axis| vector::transform(&camera.rotation, axis));
    let normal = vector::cross(s1, s2);
    let foot = seen_at(centre, camera);
    let towards = |u: f64, v: f64| -> (Vector, Vector) {
        let (x, y) = ((u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy);
        if camera.orthographic {
            ([x, y, 0.0], [0.0, 0.0, 1.0])
        } else {
            ([0.0; 3], [x, y, 1.0])
        }
    };
    let cut = |du: f64, dv: f64| -> Option<[f64; 2]> {
        let (start, direction) = towards(foot[0] + du, foot[1] + dv);
        let along = vector::dot(normal, direction);
        let distance = vector::dot(normal, vector::subtract(centre, start)) / along;
        let hit = vector::add(start, vector::scale(distance, direction));
        let offset = vector::subtract(hit, centre);
        let coordinate = |s: Vector| vector::dot(offset, s) / vector::dot(s, s);
        let found = [coordinate(s1), coordinate(s2)];
        found.iter().all(|c| c.is_finite()).then_some(found)
    };
    // Central differences of a smooth map: the error falls with the square of the step.
    let step = 1e-4;
    let difference = |du: f64, dv: f64| -> Option<[f64; 2]> {
        let (ahead, behind) = (cut(du, dv)?, cut(-du, -dv)?);
        Some([0, 1].map(|k: usize| (ahead[k] - behind[k]) / (2.0 * step)))
    };
    Some([difference(step, 0.0)?, difference(0.0, step)?])
}

/// Depth of the true tangent plane at a place of the screen, by the ray: what the affine depth approximates.
fn exact_depth(point: &SurfacePoint, camera: &Camera, place: [f64; 2]) -> f64 {
    let centre = camera.to_camera(point.centre);
    let normal = vector::transform(&camera.rotation, point.normal);
    let x = (place[0] - camera.cx) / camera.fx;
    let y = (place[1] - camera.cy) / camera.fy;
    if camera.orthographic {
        centre[2] - (normal[0] * (x - centre[0]) + normal[1] * (y - centre[1])) / normal[2]
    } else {
        vector::dot(normal, centre) / vector::dot(normal, [x, y, 1.0])
    }
}

/// SURF 4: V' from M = J W S, and from the rays through neighbouring pixels, are inverse to each other.
#[test]
fn both_ways_to_the_ellipse_agree() {
    let scene = ball_and_sheet();
    for camera in [camera(96), parallel(96)] {
        let style = Style {
            low_pass: 1e-12,
            ..Style::opaque(1.0)
        };
        let mut compared = 0;
        for point in &scene.points {
            let Ok(splat) = project(point, &camera, &style) else {
                continue;
            };
            let normal = vector::transform(&camera.rotation, point.normal);
            let position = camera.to_camera(point.centre);
            let ray = if camera.orthographic {
                [0.0, 0.0, 1.0]
            } else {
                position
            };
            let cosine = vector::dot(normal, ray).abs() / vector::length(ray);
            if cosine < 0.1 {
                continue;
            }
            let [x, y] = inverse_jacobian(point, &camera).unwrap();
            let expected = [
                x[0] * x[0] + x[1] * x[1],
                x[0] * y[0] + x[1] * y[1],
                y[0] * y[0] + y[1] * y[1],
            ];
            let trace = expected[0] + expected[2];
            for (got, expected) in splat.conic.iter().zip(expected) {
                assert!(
                    (got - expected).abs() < 1e-6 * trace,
                    "{got} {expected} {trace}"
                );
            }
            compared += 1;
        }
        assert!(compared > 5_000, "{compared}");
    }
}

/// In parallel projection the affine depth is the plane's own.
#[test]
fn affine_depth_is_exact_without_perspective() {
    let scene = ball_and_sheet();
    let camera = parallel(96);
    let style = Style {
        low_pass: 1e-12,
        ..Style::opaque(1.0)
    };
    for point in scene.points.iter().step_by(7) {
        let Ok(splat) = project(point, &camera, &style) else {
            continue;
        };
        if splat.normal[2].abs() > 0.05 {
            let place = [splat.centre[0] + 0.7, splat.centre[1] - 1.3];
            let affine = splat.depth + 0.7 * splat.gradient[0] - 1.3 * splat.gradient[1];
            let exact = exact_depth(point, &camera, place);
            assert!((affine - exact).abs() < 1e-6, "{affine} {exact}");
        }
    }
}

/// Per pixel how many layers overlap: the largest number of its samples that are pairwise farther apart than the
/// threshold.
///
/// No order of drawing can have more fragments open than that, because open fragments are that far apart.
fn overlapping_layers(scene: &SurfaceScene, camera: &Camera, style: &Style) -> Vec<usize> {
    let mut depths = vec![Vec::new(); camera.width * camera.height];
    for splat in scene.points.iter().flat_map(|p| project(p, camera, style)) {
        let [a, b, c] = splat.conic;
        for y in splat.bounds.y0..splat.bounds.y1 {
            for x in splat.bounds.x0..splat.bounds.x1 {
                let dx = x as f64 + 0.5 - splat.centre[0];
                let dy = y as f64 + 0.5 - splat.centre[1];
                if a * dx * dx + 2.0 * b * dx * dy + c * dy * dy < style.cutoff {
                    let depth = splat.depth + splat.gradient[0] * dx + splat.gradient[1] * dy;
                    depths[y * camera.width + x].push(depth);
                }
            }
        }
    }
    let count = |mut depths: Vec<f64>| {
        depths.sort_by(f64::total_cmp);
        let mut last = f64::NEG_INFINITY;
        let apart = |depth: &f64| {
            let apart = *depth - last > style.threshold;
            last = if apart { *depth } else { last };
            apart
        };
        depths.iter().copied().filter(apart).count()
    };
    depths.into_iter().map(count).collect()
}

/// Where no more layers overlap than the buffer holds, more layers change nothing; elsewhere something is merged.
#[test]
fn layers_matter_only_where_they_overlap() {
    let scene = ball_and_sheet();
    let camera = camera(96);
    let style = Style::layered(scene.usual_threshold(), 2);
    let overlapping = overlapping_layers(&scene, &camera, &style);
    let few = draw(&scene, &camera, &style).picture;
    let all = draw(
        &scene,
        &camera,
        &Style {
            buffer: Buffer::Layers(99),
            ..style
        },
    )
    .picture;
    let mut different = 0;
    for (index, count) in overlapping.iter().enumerate() {
        if *count <= 2 {
            assert_eq!(few.pixels[index], all.pixels[index]);
        }
        different += usize::from(few.pixels[index] != all.pixels[index]);
    }
    assert!(different > 100, "{different}");
}

/// A closed, evenly sampled surface has no hole at any distance: minified to a few pixels or one splat many pixels
/// wide.
#[test]
fn a_ball_has_no_hole_near_and_far() {
    let ball = scene(
        "ball",
        sphere([0.0; 3], 1.0, 4_000, Paint::opaque([0.5; 3])),
    );
    let design = DesignChoice::named("standard24").unwrap();
    for distance in [1.6, 3.0, 10.0, 60.0] {
        let camera = Camera::look_at(
            [0.0, -distance, 0.0],
            [0.0; 3],
            [0.0, 0.0, 1.0],
            30.0,
            128,
            128,
        )
        .unwrap();
        let style = Style::opaque(ball.usual_threshold());
        let drawn = fixed::surface::draw(&ball, &camera, &style, &design, Traversal::Spans);
        let limit = 1.0 / (distance * distance - 1.0);
        for (index, pixel) in drawn.picture.pixels.iter().enumerate() {
            let slope = |c: usize, centre: f64| (c as f64 + 0.5 - centre) / camera.fx;
            let (x, y) = (slope(index % 128, camera.cx), slope(index / 128, camera.cy));
            if x * x + y * y < limit {
                assert!(
                    (pixel[3] - 1.0).abs() < 1e-6,
                    "{distance}: {index} {pixel:?}"
                );
                assert!(
                    (pixel[0] - 0.5).abs() < 1e-5,
                    "{distance}: {index} {pixel:?}"
                );
            }
        }
    }
}

#[test]
#[cfg_attr(
    not(has_data),
    ignore = "the shared data were not beside the project when this was built"
)]
fn scanned_clouds_load() {
    let folder = Path::new(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../../shared/data/points"
    ));
    let kitten = points::load(&folder.join("cgal_kitten.xyz")).unwrap();
    assert_eq!(
        (kitten.points.len(), kitten.skipped, kitten.coloured),
        (5_210, 0, false)
    );
    // It stands on its flat base; the lion has none, and its file says that z is up.
    assert_eq!(kitten.up, [0.0, 1.0, 0.0]);
    let lion = points::load(&folder.join("lion_takanawa.ply")).unwrap();
    assert_eq!(lion.up, [0.0, 0.0, 1.0]);
    assert_eq!(
        (lion.points.len(), lion.skipped, lion.coloured),
        (341_989, 0, true)
    );
    assert!((0.005..0.03).contains(&lion.radius), "{}", lion.radius);
}

/// What vectors draw is the kernel's: whole drawings, word for word, one surface and layers, lit and not, with backs
/// and without, at an eye near enough to cull some points.
#[test]
fn surfaces_drawn_by_vectors_are_the_kernels() {
    use splatline_engine::fast::lanes::VectorLevel;
    use splatline_engine::fixed::PaintEngine;
    use splatline_engine::fixed::surface::{SurfaceOptions, draw_with};
    let scene = ball_and_sheet();
    let near = Camera::look_at([0.3, -0.9, -0.4], [0.0; 3], [0.0, -1.0, 0.0], 70.0, 157, 93);
    for camera in [camera(160), near.unwrap()] {
        let lit = Style {
            light: Some([0.4, 0.5, 1.0]),
            ..Style::opaque(0.1)
        };
        for (name, cull_backfaces, style) in [
            ("classic8", true, Style::layered(0.1, 4)),
            ("lean18", false, Style::opaque(0.0)),
            ("lean18", true, Style::layered(0.1, 1)),
            ("standard24", true, Style::layered(0.1, 4)),
            ("standard24", false, lit),
            ("deep32", false, Style::layered(0.1, 2)),
            ("deep32", true, Style::opaque(0.3)),
        ] {
            let design = DesignChoice::named(name).unwrap();
            let style = Style {
                cull_backfaces,
                ..style
            };
            let draw = |engine, counts| {
                let options = SurfaceOptions {
                    style: &style,
                    design: &design,
                    traversal: Traversal::Spans,
                    engine,
                    counts,
                };
                draw_with(&scene, &camera, &options)
            };
            let expected = draw(PaintEngine::Scalar, true);
            for choice in [VectorLevel::Best, VectorLevel::Avx2, VectorLevel::Portable] {
                let what = format!("{name}, {choice:?}");
                let uncounted = draw(PaintEngine::Vectors(choice), false);
                let drawn = draw(PaintEngine::Vectors(choice), true);
                for drawn in [&uncounted, &drawn] {
                    assert!(drawn.pixels == expected.pixels, "{what}");
                    assert!(drawn.weights == expected.weights, "{what}");
                }
                assert_eq!(drawn.facts.culled, expected.facts.culled, "{what}");
                assert_eq!(drawn.facts.backfaces, expected.facts.backfaces, "{what}");
                assert_eq!(drawn.facts.coverage, expected.facts.coverage, "{what}");
            }
        }
    }
}
