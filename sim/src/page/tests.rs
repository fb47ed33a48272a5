use super::*;
use crate::report::tests::loads_nothing;
use crate::rules::Rules;
use crate::scene::{Harmonics, Splat};

fn scene() -> Scene {
    let mut scene = crate::scene::synthetic::random_gaussians(40, 7, 1.0);
    scene.name = "a</script><b> & co".to_owned();
    scene
}

fn shown<'a>(scene: &'a Scene, camera: &'a Camera, design: &'a DesignChoice) -> Shown<'a> {
    Shown {
        scene,
        camera,
        options: Options::front_to_back(&scene.natural_rules, design),
        target: [0.0; 3],
        up: [0.0, -1.0, 0.0],
    }
}

fn rounded(splat: &Splat) -> Splat {
    let single = |value: f64| f64::from(value as f32);
    Splat {
        centre: splat.centre.map(single),
        axes: splat.axes.map(|axis| axis.map(single)),
        weight: single(splat.weight),
        colour: splat.colour.map(single),
    }
}

/// Rules as a page holds them, which has no name for them.
fn of_page(rules: Rules) -> Rules {
    let name = "page";
    Rules { name, ..rules }
}

#[test]
fn a_scene_comes_back_in_single_precision() {
    let mut scene = scene();
    scene.order = crate::scene::SortOrder::Distance;
    scene.harmonics = Some(Harmonics {
        degree: 2,
        coefficients: (0..40 * 8)
            .map(|i| [i as f32, 0.5 - i as f32, 1e-9])
            .collect(),
        base: (0..40).map(|i| [i as f32 / 7.0; 3]).collect(),
    });
    let bytes = bytes::encode(&scene, &scene.natural_rules);
    let (back, rules) = bytes::decode(&bytes).unwrap();
    let expected: Vec<Splat> = scene.splats.iter().map(rounded).collect();
    assert_eq!(back.splats, expected);
    assert_eq!(back.harmonics, scene.harmonics);
    assert_eq!(back.order, scene.order);
    assert_eq!(rules, of_page(scene.natural_rules));
    // The page weighs splats as the host has weighed them.
    assert_eq!(
        back.weights_for(&rules),
        expected.iter().map(|s| s.weight).collect::<Vec<_>>()
    );
}

#[test]
fn other_weights_and_kernels_come_back_too() {
    let scene = scene();
    let rules = Rules::EWA.with_kernel(crate::rules::Kernel::Disc);
    let (back, stated) = bytes::decode(&bytes::encode(&scene, &rules)).unwrap();
    assert_eq!(stated, of_page(rules));
    let weights = scene.weights_for(&rules);
    let expected: Vec<f64> = weights.iter().map(|w| f64::from(*w as f32)).collect();
    assert_eq!(back.weights_for(&stated), expected);
}

#[test]
fn bytes_cut_anywhere_are_refused() {
    let scene = scene();
    let bytes = bytes::encode(&scene, &scene.natural_rules);
    for length in 0..bytes.len() {
        assert!(bytes::decode(&bytes[..length]).is_none(), "{length}");
    }
    let mut claimed = bytes.clone();
    claimed[8..12].fill(0xff);
    assert!(bytes::decode(&claimed).is_none());
    claimed = bytes;
    claimed.push(0);
    assert!(bytes::decode(&claimed).is_none());
}

#[test]
fn the_page_is_one_file_that_loads_nothing() {
    let scene = scene();
    let camera = scene.default_camera(40, 30);
    let design = DesignChoice::named("lean18").unwrap();
    let page = html(&shown(&scene, &camera, &design)).unwrap();
    let still = page.split("<script").next().unwrap();
    assert!(still.contains("default-src 'none'"));
    loads_nothing(&page);
    assert!(page.contains("a&lt;/script&gt;&lt;b&gt; &amp; co"));
    // The four scripts and nothing that a name brought along.
    assert_eq!(page.matches("<script").count(), 4);
    assert_eq!(page.matches("</script>").count(), 4);
    let settings = page.split("id=\"settings\">").nth(1).unwrap();
    let settings = settings.split("</script>").next().unwrap();
    let settings: serde_json::Value = serde_json::from_str(settings).unwrap();
    assert_eq!(
        settings["widths"].as_array().unwrap().len(),
        WIDTH_RANGES.len()
    );
    assert_eq!(settings["order"].as_array().unwrap().len(), NAMES.len());
    let numbers: Vec<Option<f64>> = serde_json::from_value(settings["camera"].clone()).unwrap();
    let expected = camera_numbers(&camera).map(|n| n.is_finite().then_some(n));
    assert_eq!(numbers, expected);
}

#[test]
fn a_scene_too_large_is_refused_with_its_count() {
    let mut scene = scene();
    scene.splats = vec![scene.splats[0]; MOST_SPLATS + 1];
    let camera = scene.default_camera(8, 8);
    let design = DesignChoice::named("lean18").unwrap();
    let error = html(&shown(&scene, &camera, &design)).unwrap_err();
    assert!(error.to_string().contains("500001 splats"), "{error}");
}

/// A module that imported something would need a host that gives it: a generator's glue, or a library that binds
/// JavaScript.
#[test]
fn the_module_asks_its_host_for_nothing() {
    assert_eq!(&WASM[..8], b"\0asm\x01\0\0\0");
    let mut rest = &WASM[8..];
    let mut sections = Vec::new();
    while let Some((kind, after)) = rest.split_first() {
        let mut size = 0usize;
        let mut shift = 0;
        let mut at = 0;
        loop {
            size |= usize::from(after[at] & 0x7f) << shift;
            (shift, at) = (shift + 7, at + 1);
            if after[at - 1] & 0x80 == 0 {
                break;
            }
        }
        sections.push(*kind);
        rest = &after[at + size..];
    }
    const IMPORTS: u8 = 2;
    assert!(!sections.contains(&IMPORTS), "{sections:?}");
}
