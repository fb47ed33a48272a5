//! What the binary refuses with a message, before it draws or allocates: numbers without a picture, pictures without memory, files that never end.

use super::command_line::{refused, splatline, stderr};
use std::process::Command;

/// Coordinates of which squares, sums or differences overflow: no camera can be placed, and nothing is drawn from none.
#[test]
fn absurd_coordinates_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).display().to_string();
    let picture = path("a.png");
    let header = "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\nproperty double z\nend_header\n";
    for huge in ["1e154", "1e160", "1e308"] {
        let cloud = format!("0 0 0\n{huge} 0 0\n0 {huge} 0\n-{huge} 1 1\n");
        std::fs::write(path("c.xyz"), &cloud).unwrap();
        std::fs::write(path("c.ply"), format!("{header}{cloud}")).unwrap();
        std::fs::write(path("h.csv"), format!("0,{huge},0\n-{huge},0,0\n0,0,0\n")).unwrap();
        for scene in ["c.xyz", "c.ply", "h.csv"].map(path) {
            for engine in ["fixed", "float"] {
                let output = splatline(&[
                    "render", &scene, "--as", "surface", "--engine", engine, "-o", &picture,
                ]);
                let printed = stderr(&output);
                assert_eq!(output.status.code(), Some(1), "{scene} {huge}: {printed}");
                assert!(printed.contains(&scene), "{scene}: {printed}");
            }
        }
    }
    std::fs::write(path("flat.csv"), "0,1\n1,0\n").unwrap();
    let spacing = [
        "render",
        &path("flat.csv"),
        "--as",
        "surface",
        "--spacing",
        "1e154",
        "-o",
        &picture,
    ];
    refused(1, &spacing, "too large or too far apart");
    let output = splatline(&["info", &path("h.csv")]);
    let printed = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(printed.contains("framed     no ball: "), "{printed}");
    assert!(!printed.contains("inf"), "{printed}");
}

/// Allowed numbers whose product no machine holds: refused with the estimate and the limit before anything is allocated.
#[cfg(target_os = "linux")]
#[test]
fn what_does_not_fit_into_memory_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("v").display().to_string();
    let picture = folder.path().join("a.png").display().to_string();
    refused(
        1,
        &["vectors", "export", "--splats", "4294967295", &out],
        "MB of memory",
    );
    refused(
        1,
        &[
            "vectors",
            "export",
            "--splats",
            "100000",
            "--size",
            "16384x16384",
            &out,
        ],
        "MB of memory",
    );
    refused(
        1,
        &["info", "random:10000000", "--memory", "500"],
        "10000000 splats of degree 0 would take",
    );
    let machine = [
        "raster_units=1024",
        "row_fifo=65536",
        "lanes=64",
        "layout=rows",
    ];
    let set = machine.iter().flat_map(|word| ["--set", word]);
    let model: Vec<&str> = ["simulate", "random:9"].into_iter().chain(set).collect();
    refused(
        2,
        &model,
        "raster_units = 1024: with these lanes and FIFOs the simulator would take",
    );
    for command in [
        &[
            "render",
            "random:9",
            "--size",
            "16384x16384",
            "-o",
            &picture,
        ][..],
        &["compare", "random:9", "--size", "8192x8192", "-o", &out],
    ] {
        let line = "ulimit -v 4000000; exec \"$0\" \"$@\"";
        let output = Command::new("sh")
            .args(["-c", line, env!("CARGO_BIN_EXE_splatline")])
            .args(command)
            .output()
            .unwrap();
        let printed = stderr(&output);
        assert_eq!(output.status.code(), Some(1), "{command:?}: {printed}");
        assert!(
            printed.contains("MB are available: give a smaller --size"),
            "{printed}"
        );
    }
}

/// Every option that names a text: pipes and devices never end, and folders are no files.
#[cfg(unix)]
#[test]
fn pipes_and_devices_are_no_settings() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).display().to_string();
    std::fs::write(path("s.toml"), "[machine]\nlanes = [1]\n").unwrap();
    assert!(
        Command::new("mkfifo")
            .arg(path("pipe.toml"))
            .status()
            .unwrap()
            .success()
    );
    std::os::unix::fs::symlink("/dev/zero", path("zero.toml")).unwrap();
    std::fs::create_dir(path("folder.toml")).unwrap();
    for input in ["pipe.toml", "zero.toml", "folder.toml"].map(path) {
        for options in [
            &["render", "random:9", "-o", "OUT.png", "--camera"][..],
            &["render", "demo", "-o", "OUT.png", "--transfer"],
            &["render", "random:9", "-o", "OUT.png", "--design"],
            &["simulate", "random:9", "--machine"],
            &["simulate", "random:9", "--calibration"],
            &["simulate", "--footprints"],
            &["sweep", "random:9", "-o", "OUT.d", "--space"],
            &["render", "--as", "surface", "-o", "OUT.png"],
            &["render", "-o", "OUT.png"],
        ] {
            let out = path("out");
            let options = options.iter().map(|option| option.replace("OUT", &out));
            let options: Vec<String> = options.chain([input.clone()]).collect();
            let options: Vec<&str> = options.iter().map(String::as_str).collect();
            refused(1, &options, "not a regular file");
        }
    }
}
