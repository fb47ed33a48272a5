//! What the binary refuses with a message, before it draws or allocates: numbers without a picture, pictures without
//! memory, files that never end.

use super::shell::{Shell, said};
use std::process::Command;

/// Coordinates of which squares, sums or differences overflow: no camera can be placed, and nothing is drawn from none.
#[test]
fn absurd_coordinates_are_refused() {
    let shell = Shell::new();
    let header = "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\nproperty double z\nend_header\n";
    for huge in ["1e154", "1e160", "1e308"] {
        let cloud = format!("0 0 0\n{huge} 0 0\n0 {huge} 0\n-{huge} 1 1\n");
        shell.write("c.xyz", &cloud);
        shell.write("c.ply", format!("{header}{cloud}"));
        shell.write("h.csv", format!("0,{huge},0\n-{huge},0,0\n0,0,0\n"));
        for scene in ["c.xyz", "c.ply", "h.csv"] {
            for engine in ["fixed", "float"] {
                let line = format!("render {scene} --as surface --engine {engine} -o a.png");
                shell.refused(1, &line, scene);
            }
        }
    }
    shell.write("flat.csv", "0,1\n1,0\n");
    let spacing = "render flat.csv --as surface --spacing 1e154 -o a.png";
    shell.refused(1, spacing, "too large or too far apart");
    let printed = String::from_utf8(shell.run("info h.csv").stdout).unwrap();
    assert!(printed.contains("framed     no ball: "), "{printed}");
    assert!(!printed.contains("inf"), "{printed}");
}

/// Allowed numbers whose product no machine holds: refused with the estimate and the limit before anything is
/// allocated.
#[cfg(target_os = "linux")]
#[test]
fn what_does_not_fit_into_memory_is_refused() {
    let shell = Shell::new();
    let lanes = "--set lanes=64 --set layout=rows";
    shell.refuses(&format!(
        "1 vectors export --splats 4294967295 v => MB of memory
         1 vectors export --splats 100000 --size 16384x16384 v => MB of memory
         1 info random:10000000 --memory 500 => 10000000 splats of degree 0 would take
         1 info random:10000000 --memory 500 => MB of memory, of the 500 MB granted
         2 simulate random:9 --set raster_units=1024 --set row_fifo=65536 {lanes} \
           => raster_units = 1024: with these lanes and FIFOs the simulator would take"
    ));
    for line in [
        "render random:9 --size 16384x16384 -o a.png",
        "compare random:9 --size 8192x8192 -o v",
    ] {
        let limited = "ulimit -v 4000000; exec \"$0\" \"$@\"";
        let mut command = Command::new("sh");
        command.args(["-c", limited, env!("CARGO_BIN_EXE_splatline")]);
        command.args(line.split(' ')).current_dir(shell.path(""));
        let said = said(command);
        assert_eq!(said.code, Some(1), "{line}: {}", said.stderr);
        let expected = "MB are available: give a smaller --size";
        assert!(said.stderr.contains(expected), "{}", said.stderr);
    }
}

/// Every option that names a text: pipes and devices never end, and folders are no files.
#[cfg(unix)]
#[test]
fn pipes_and_devices_are_no_settings() {
    let shell = Shell::new();
    shell.write("s.toml", "[machine]\nlanes = [1]\n");
    let made = Command::new("mkfifo").arg(shell.path("pipe.toml")).status();
    assert!(made.unwrap().success());
    std::os::unix::fs::symlink("/dev/zero", shell.path("zero.toml")).unwrap();
    std::fs::create_dir(shell.path("folder.toml")).unwrap();
    for input in ["pipe.toml", "zero.toml", "folder.toml"] {
        for options in [
            "render random:9 -o out.png --camera",
            "render demo -o out.png --transfer",
            "render random:9 -o out.png --design",
            "simulate random:9 --machine",
            "simulate random:9 --calibration",
            "simulate --footprints",
            "sweep random:9 -o out.d --space",
            "render --as surface -o out.png",
            "render -o out.png",
        ] {
            shell.refused(1, &format!("{options} {input}"), "not a regular file");
        }
    }
}
