//! Tests of the automatic camera: everything framed is in the picture, whatever the kind, the picture's shape and the
//! field of view.

use super::*;
use crate::scene::synthetic::random_gaussians;
use crate::scene::tests::{is_in_view, load_plain, shared_data};

/// Does every place of the ball project into the picture, beyond the near plane?
fn all_in_view(places: &[Vector], camera: &Camera) -> bool {
    places.iter().all(|place| is_in_view(camera, *place))
}

fn centres(scene: &Scene) -> Vec<Vector> {
    scene.splats.iter().map(|splat| splat.centre).collect()
}

#[test]
fn every_centre_is_shown_in_any_picture_from_anywhere() {
    let mut scene = random_gaussians(2000, 3, 1.0);
    for splat in &mut scene.splats {
        splat.centre = [
            100.0 + splat.centre[0],
            7.0 * splat.centre[1],
            0.1 * splat.centre[2],
        ];
    }
    for weight in [Weight::Mass, Weight::Opacity] {
        scene.weight = weight;
        for up in [None, Some([0.0, 0.0, 1.0]), Some([1.0, 2.0, -3.0])] {
            let frame = FramingInput::of_scene(&scene, up);
            assert_eq!(frame.ball.strays, 0);
            for (width, height) in [(64, 64), (640, 48), (48, 640)] {
                for fov in [5.0, 45.0, 140.0] {
                    for orbit in [
                        None,
                        Some(Orbit {
                            azimuth: 130.0,
                            elevation: -60.0,
                        }),
                    ] {
                        let camera = frame.camera(orbit, fov, width, height).unwrap();
                        assert!(
                            all_in_view(&centres(&scene), &camera),
                            "{weight:?} {up:?} {width}x{height} {fov} {orbit:?}"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn the_ball_touches_the_margin_of_the_narrower_side() {
    let scene = random_gaussians(5000, 1, 1.0);
    let frame = FramingInput::of_scene(&scene, None);
    let camera = frame.camera(None, 45.0, 300, 200).unwrap();
    let rim = vector::add(
        frame.ball.centre,
        vector::scale(frame.ball.radius, camera.rotation[1]),
    );
    let [_, y, z] = camera.to_camera(rim);
    let v = camera.fy * y / z + camera.cy;
    assert!((185.0..200.0).contains(&v), "{v}");
}

#[test]
fn strays_are_counted_and_do_not_push_the_camera_away() {
    let mut scene = random_gaussians(1000, 1, 1.0);
    let before = FramingInput::of_scene(&scene, None).ball;
    for splat in scene.splats.iter_mut().take(10) {
        splat.centre = [1e6, -1e6, 1e6];
    }
    let after = FramingInput::of_scene(&scene, None).ball;
    assert_eq!((before.strays, after.strays), (0, 10));
    assert!((after.radius / before.radius - 1.0).abs() < 0.05);
}

/// A capture reaches both sides of its picture's narrower extent, all of it is seen, and faint floaters around it
/// change nothing.
#[test]
fn a_capture_fills_its_picture_whatever_floats_around_it() {
    let mut scene = random_gaussians(2000, 3, 1.0);
    scene.name = "capture.ply".to_owned();
    for splat in &mut scene.splats {
        splat.centre[1] *= 3.0;
        splat.axes = [[0.01, 0.0, 0.0], [0.0, 0.01, 0.0], [0.0, 0.0, 0.01]];
        splat.weight = 0.8;
    }
    let view = |scene: &Scene| {
        let frame = FramingInput::of_scene(scene, None);
        let ball = frame.camera(None, 45.0, 400, 300).unwrap();
        let (camera, outside) = frame.filled(ball.clone(), scene);
        (ball, camera, outside)
    };
    let (_, camera, outside) = view(&scene);
    let shown = centres(&scene);
    assert!(outside == 0 && all_in_view(&shown, &camera));
    let rows = shown.iter().map(|place| {
        let [_, y, z] = camera.to_camera(*place);
        camera.fy * y / z + camera.cy
    });
    let (least, most) = rows.fold((f64::INFINITY, 0.0_f64), |(least, most), v| {
        (least.min(v), most.max(v))
    });
    assert!(least < 15.0 && most > 285.0, "{least} {most}");
    for index in 0..60 {
        let mut floater = scene.splats[index];
        floater.centre = floater.centre.map(|place| 4.0 * place);
        floater.weight = 0.03;
        scene.splats.push(floater);
    }
    let (ball, again, outside) = view(&scene);
    let distance = |camera: &Camera| vector::length(camera.eye());
    assert!(distance(&ball) > 1.5 * distance(&again));
    assert!(all_in_view(&shown, &again) && outside > 0);
    let farther = distance(&again) / distance(&camera);
    assert!(farther < 1.5, "{farther}");
}

#[test]
fn one_splat_and_none_can_be_framed() {
    let mut scene = random_gaussians(1, 1, 1.0);
    scene.name = "capture.ply".to_owned();
    let view = |scene: &Scene| {
        let frame = FramingInput::of_scene(scene, None);
        let camera = frame.camera(None, 45.0, 8, 8).unwrap();
        frame.filled(camera, scene).0
    };
    assert!(all_in_view(&centres(&scene), &view(&scene)));
    scene.splats.clear();
    assert!(view(&scene).is_sound());
}

#[test]
fn orbits_keep_the_distance_and_turn_the_right_way() {
    let front = [0.0, -1.0, 0.0];
    let up = [0.0, 0.0, 1.0];
    let quarter = |azimuth, elevation| turned(front, up, Orbit { azimuth, elevation });
    let near = |a: Vector, b: Vector| vector::length(vector::subtract(a, b)) < 1e-12;
    // Seen from above, counter-clockwise from the south is the east.
    assert!(near(quarter(90.0, 0.0), [1.0, 0.0, 0.0]));
    assert!((quarter(0.0, 30.0)[2] - 0.5).abs() < 1e-12);
    let moved = |azimuth, elevation| {
        let orbit = Orbit { azimuth, elevation };
        orbited([3.0, 0.0, 4.0], [0.0; 3], up, orbit)
    };
    let eye = moved(180.0, 0.0);
    assert!(near(eye, [-3.0, 0.0, 4.0]), "{eye:?}");
    let pole = moved(0.0, 500.0);
    assert!((vector::length(pole) - 5.0).abs() < 1e-12 && pole[2] < 5.0);
}

/// Beyond 1e154 squares overflow: no distance can be measured there, and a picture from there would be empty.
#[test]
fn no_camera_is_placed_where_squares_overflow() {
    let frame = |centre, radius| FramingInput {
        ball: Ball {
            centre,
            radius,
            strays: 0,
        },
        up: [0.0, 0.0, 1.0],
        front: [0.0, -1.0, 0.0],
        elevation: 30.0,
        reason: "",
    };
    let placed = |centre, radius| {
        frame(centre, radius)
            .camera(None, USUAL_FOV, 64, 48)
            .is_ok()
    };
    assert!(placed([0.0; 3], 1.0) && placed([1e6, 0.0, 0.0], 1e6));
    for huge in [1e154, 1e160, 1e308, f64::INFINITY] {
        assert!(!placed([0.0; 3], huge), "radius {huge}");
        assert!(!placed([2.0 * huge, 0.0, 0.0], 1.0), "centre {huge}");
    }
}

/// The scenes of the issue, which the older views cut.
#[test]
#[cfg_attr(not(has_data), ignore = "needs the shared data")]
fn captured_scenes_are_shown_whole() {
    for file in [
        "gaussians/guitar.ply",
        "gaussians/playbot_lod4.ply",
        "volumes/headsq.nhdr",
        "volumes/fuel.nhdr",
    ] {
        let scene = load_plain(&shared_data(file));
        let frame = FramingInput::of_scene(&scene, None);
        let camera = frame.camera(None, USUAL_FOV, 512, 384).unwrap();
        let shown = centres(&scene)
            .iter()
            .filter(|place| all_in_view(&[**place], &camera))
            .count();
        println!(
            "{file}: {shown} of {} shown; {}",
            scene.splats.len(),
            frame.describe(USUAL_FOV)
        );
        assert_eq!(shown + frame.ball.strays, scene.splats.len(), "{file}");
    }
    let cloud = crate::scene::points::load(&shared_data("points/lion_takanawa.ply")).unwrap();
    let frame = FramingInput::of_surface(&cloud, false, None);
    let camera = frame.camera(None, USUAL_FOV, 512, 384).unwrap();
    let places: Vec<Vector> = cloud.points.iter().map(|point| point.centre).collect();
    assert_eq!(frame.ball.strays, 0);
    assert!(all_in_view(&places, &camera));
}

/// The two automatic cameras differ in distance and field of view, never in the way they look; what the older one
/// shows, a frame shows as well.
#[test]
fn a_frame_looks_the_way_of_the_default_camera_and_shows_no_less() {
    let mut capture = random_gaussians(2000, 3, 1.0);
    // Thinner along z, and by another name: synthetic scenes have a camera of their own.
    capture.name = "capture.ply".to_owned();
    for splat in &mut capture.splats {
        splat.centre = [
            3.0 * splat.centre[0],
            splat.centre[1],
            0.2 * splat.centre[2],
        ];
    }
    let mut volume = capture.clone();
    volume.weight = Weight::Mass;
    let demo = crate::scene::demo().unwrap();
    for scene in [&capture, &volume, &demo] {
        for (width, height) in [(320, 240), (64, 256)] {
            let usual = scene.default_camera(width, height);
            let frame = FramingInput::of_scene(scene, None);
            let framed = frame.camera(None, USUAL_FOV, width, height).unwrap();
            let rotations = [&usual, &framed].map(|camera| camera.rotation.as_flattened());
            for (a, b) in rotations[0].iter().zip(rotations[1]) {
                assert!((a - b).abs() < 1e-9, "{}: {usual:?} {framed:?}", scene.name);
            }
            assert!(all_in_view(&centres(scene), &framed), "{}", scene.name);
        }
    }
}

/// Turning a camera is the orbit that frames the scene anew; all the way round is back again.
#[test]
fn a_turned_camera_is_the_orbits() {
    let scene = random_gaussians(200, 3, 1.0);
    let up = Some([0.3, -1.0, 0.2]);
    let frame = FramingInput::of_scene(&scene, up);
    let raised = |azimuth| {
        let elevation = 20.0;
        let orbit = Orbit { azimuth, elevation };
        frame.camera(Some(orbit), 40.0, 64, 48).unwrap()
    };
    for azimuth in [0.0, 33.0, 180.0, 271.0, 360.0] {
        let turned = turned_camera(&raised(0.0), frame.ball.centre, frame.up, azimuth);
        let expected = raised(azimuth);
        let numbers =
            |camera: &Camera| [camera.rotation.as_flattened(), &camera.translation].concat();
        for (a, b) in numbers(&turned).iter().zip(numbers(&expected)) {
            assert!((a - b).abs() < 1e-9, "{azimuth}: {turned:?} {expected:?}");
        }
    }
}
