//! Tests over all loaders: real files, and the paths of the command line.

use std::path::{Path, PathBuf};

use proptest::prelude::*;

use super::damage_tests::assert_told;
use super::*;

/// A file of the shared data; tests that ask for one are ignored where the data were not at hand when they were built.
pub(crate) fn shared_data(file: &str) -> PathBuf {
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data")).join(file);
    assert!(path.exists(), "{file} is missing from the shared data");
    path
}

pub(crate) fn load_plain(path: &Path) -> Scene {
    load(path, &LoadOptions::default()).unwrap()
}

pub(crate) use super::view::tests::is_in_view;

#[test]
#[cfg_attr(not(has_data), ignore = "needs the shared data")]
fn infinite_logits_of_the_guitar_are_opacity_one() {
    let path = shared_data("gaussians/guitar.ply");
    let scene = load_plain(&path);
    assert_eq!(scene.splats.len(), 90_854);
    assert_eq!(scene.skipped, Skipped::default());
    let opaque = scene.splats.iter().filter(|splat| splat.weight == 1.0);
    assert_eq!(opaque.count(), 667);
    assert!(scene.harmonics.is_none());
}

#[test]
#[cfg_attr(not(has_data), ignore = "needs the shared data")]
fn playbot_has_degree_two_and_a_colour_that_depends_on_the_view() {
    let path = shared_data("gaussians/playbot_lod4.ply");
    let scene = load_plain(&path);
    assert_eq!(scene.splats.len(), 8406);
    let harmonics = scene.harmonics.as_ref().unwrap();
    assert_eq!(
        (harmonics.degree, harmonics.coefficients.len()),
        (2, 8 * 8406)
    );
    let here = scene.colours(&scene.default_camera(320, 240));
    assert!(here.iter().flatten().all(|channel| *channel >= 0.0));
    let plain: Vec<_> = scene.splats.iter().map(|splat| splat.colour).collect();
    assert_ne!(here, plain);
}

#[test]
#[cfg_attr(not(has_data), ignore = "needs the shared data")]
fn the_demo_is_the_brainsmall_file() {
    let demo = demo().unwrap();
    assert_eq!(demo, load_plain(Path::new("demo")));
    assert!(
        (100_000..350_000).contains(&demo.splats.len()),
        "{} splats",
        demo.splats.len()
    );
    let path = shared_data("volumes/brainsmall.nhdr");
    assert!(
        demo == load_plain(&path),
        "the embedded volume differs from the file"
    );
}

#[test]
#[cfg_attr(not(has_data), ignore = "needs the shared data")]
fn the_classic_volumes_load_with_moderate_counts_and_opacities() {
    let most = [
        ("aneurism", 160_000),
        ("fuel", 30_000),
        ("nucleon", 40_000),
        ("headsq", 200_000),
    ];
    for (name, most) in most {
        let path = shared_data(&format!("volumes/{name}.nhdr"));
        let scene = load_plain(&path);
        println!("{name}: {} splats", scene.splats.len());
        assert!(
            (1000..most).contains(&scene.splats.len()),
            "{name}: {} splats",
            scene.splats.len()
        );
        assert_eq!(scene.skipped, Skipped::default());
        let peak = scene
            .weights_for(&Rules::GAUSSIAN_3D)
            .into_iter()
            .fold(0.0, f64::max);
        assert!(peak < 0.12, "{name}: one splat reaches opacity {peak}");
    }
}

#[test]
fn named_scenes_load_without_files() {
    assert_eq!(
        load_plain(Path::new("random:50")),
        synthetic::random_gaussians(50, 1, 1.0)
    );
    assert_eq!(
        load_plain(Path::new("random:50:9")),
        synthetic::random_gaussians(50, 9, 1.0)
    );
    assert_eq!(
        load_plain(Path::new("deep-stack")).splats.len(),
        synthetic::DEEP_STACK_COUNT
    );
}

#[test]
fn messages_of_paths_name_the_file_and_the_fix() {
    let folder = tempfile::tempdir().unwrap();
    let unknown = folder.path().join("scene.fbx");
    std::fs::write(&unknown, "v 0 0 0").unwrap();
    let missing = folder.path().join("none.ply");
    let told = |path: &Path, expected: &str| {
        let refused = load(path, &LoadOptions::default()).unwrap_err();
        assert_told(refused.to_string(), expected);
    };
    told(&unknown, "scene.fbx: is of no known format; expected .ply");
    told(folder.path(), "is not a regular file; name a scene file");
    told(&missing, "none.ply: cannot be read: No such file");
    for arguments in ["", "0", "x", "5:x", "99999999999"] {
        let expected = "is not COUNT or COUNT:SEED; write for instance random:10000:1";
        told(Path::new(&format!("random:{arguments}")), expected);
    }
}

#[test]
fn content_decides_where_the_extension_is_unknown() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("volume");
    std::fs::write(&path, include_bytes!("../../assets/brainsmall.nrrd")).unwrap();
    assert!(!load_plain(&path).splats.is_empty());
}

#[test]
fn volume_options_are_refused_for_other_scenes() {
    let options = LoadOptions {
        light: Some([0.0, 0.0, -1.0]),
        ..LoadOptions::default()
    };
    let message = load(Path::new("random:5"), &options)
        .unwrap_err()
        .to_string();
    assert_eq!(
        message,
        "random:5: transfer function or light: this scene is no volume; leave these options out: its colours are stored"
    );
}

#[test]
fn a_transfer_file_is_used_and_its_errors_name_file_and_line() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("dense.toml");
    let options = LoadOptions {
        transfer: Some(file.clone()),
        light: None,
    };
    let point = |at: f64, extinction: f64| {
        format!("[[value]]\nat = {at}\ncolour = [1, 1, 1]\nextinction = {extinction}\n")
    };
    std::fs::write(&file, point(150.0, 0.0) + &point(160.0, 0.5)).unwrap();
    let scene = load(Path::new("demo"), &options).unwrap();
    let count = scene.splats.len();
    assert!(count < 1000, "only the brightest voxels: {count}");
    let told = |expected: &str| {
        let refused = load(Path::new("demo"), &options).unwrap_err();
        assert_told(refused.to_string(), expected);
    };
    std::fs::write(&file, point(150.0, -1.0)).unwrap();
    told("dense.toml: transfer line 4, key 'value.extinction': it is -1");
    std::fs::write(&file, [0xff, 0xfe]).unwrap();
    told("dense.toml: cannot be read");
    std::fs::remove_file(&file).unwrap();
    told("dense.toml: cannot be read");
}

#[test]
fn weights_are_converted_by_the_mean_section() {
    let mut scene = synthetic::random_gaussians(200, 3, 1.0);
    let opacities = scene.weights_for(&Rules::GAUSSIAN_3D);
    let weights: Vec<f64> = scene.splats.iter().map(|splat| splat.weight).collect();
    assert_eq!(opacities, weights);
    // There and back again.
    let masses = scene.weights_for(&Rules::EWA);
    scene.weight = Weight::Mass;
    for (splat, mass) in scene.splats.iter_mut().zip(&masses) {
        splat.weight = *mass;
    }
    assert_eq!(scene.weights_for(&Rules::EWA), masses);
    let back = scene.weights_for(&Rules::GAUSSIAN_3D);
    for (back, opacity) in back.iter().zip(&opacities) {
        assert!((back - opacity).abs() < 1e-12);
    }
    // A sphere of deviation 2: 2 pi 4 = 25.13.
    scene.splats.truncate(1);
    scene.splats[0].axes = [[2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0]];
    scene.splats[0].weight = 5.0;
    assert!(
        (scene.weights_for(&Rules::GAUSSIAN_3D)[0] - 5.0 / 25.132_741_228_718_345).abs() < 1e-15
    );
    // Flat and weightless kernels have an opacity as well.
    scene.splats[0].axes = [[0.0; 3]; 3];
    assert_eq!(scene.weights_for(&Rules::GAUSSIAN_3D), [1.0]);
    scene.splats[0].weight = 0.0;
    assert_eq!(scene.weights_for(&Rules::GAUSSIAN_3D), [0.0]);
}

proptest! {
    /// Whatever follows a plausible beginning, loaders answer with a scene or an error.
    #[test]
    fn random_bytes_never_panic(
        tail in proptest::collection::vec(any::<u8>(), 0..400),
        words in "[ -~\\n]{0,200}",
        start in 0usize..6,
    ) {
        let starts = [
            "",
            "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty list uchar float x\n",
            "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nend_header\n",
            "NRRD0004\ntype: short\ndimension: 3\nendian: big\n",
            "NRRD0004\ntype: float\ndimension: 3\nendian: big\nsizes: 2 2 2\nencoding: raw\n\n",
            "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 2 2\nencoding: gzip\n\n\x1f",
        ];
        let bytes = [starts[start].as_bytes(), words.as_bytes(), &tail].concat();
        let _ = ply::load(&bytes, "x");
        let _ = nrrd::load(&bytes, None);
        let _ = spz::load(&bytes, "x");
        let _ = splat_file::load(&bytes, "x");
        let _ = Transfer::from_toml(&String::from_utf8_lossy(&bytes));
    }

    /// Volumes of any floats, NaN and infinities among them, give finite splats or an error.
    #[test]
    fn any_volume_gives_finite_splats(numbers in proptest::collection::vec(any::<f32>(), 24), spacing in 1e-12..1e12f64) {
        let header = format!(
            "NRRD0004\ntype: float\ndimension: 3\nendian: little\nsizes: 4 3 2\nspacings: {spacing} 1 2\nencoding: raw\n\n"
        );
        let data: Vec<u8> = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("any.nrrd");
        std::fs::write(&path, [header.as_bytes(), &data].concat()).unwrap();
        // Files that are refused are replaced by others; the test fails if fewer than a fifth are loaded.
        let Ok(scene) = load(&path, &LoadOptions::default()) else {
            return Err(TestCaseError::reject("refused"));
        };
        let finite = numbers.iter().filter(|number| number.is_finite()).count();
        prop_assert_eq!(scene.skipped.non_finite, numbers.len() - finite);
        for splat in &scene.splats {
            let Splat { centre, axes, weight, colour } = splat;
            let all = centre.iter().chain(axes.iter().flatten()).chain(colour).chain([weight]);
            prop_assert!(all.copied().all(f64::is_finite), "{:?}", splat);
            prop_assert!(*weight > 0.0 && colour.iter().all(|channel| (0.0..=1.0).contains(channel)));
        }
    }

    /// Gaussians of any floats at all are drawable or counted.
    #[test]
    fn any_gaussian_is_finite_or_counted(fields in proptest::collection::vec(any::<f32>(), 6..60)) {
        let records: Vec<u8> = fields.chunks_exact(6)
            .flat_map(|six| six.iter().flat_map(|field| field.to_le_bytes()).chain([9, 8, 7, 6, 5, 4, 3, 128]))
            .collect();
        match splat_file::load(&records, "x") {
            Ok(scene) => {
                prop_assert_eq!(scene.splats.len() + scene.skipped.non_finite, fields.len() / 6);
                for splat in &scene.splats {
                    prop_assert!(splat.axes.iter().flatten().chain(&splat.centre).copied().all(f64::is_finite));
                }
            }
            Err(error) => prop_assert!(error.to_string().contains("none is left")),
        }
    }
}
