//! Sweeps: resuming, and what is refused because it belongs to another sweep.

use super::*;
use crate::hostile::seeds::seed;
use std::process::Command;

#[test]
fn a_sweep_is_resumed_and_has_a_front() {
    let shell = Shell::new();
    let space = "[design]\nmantissa = [14, 18]\n[machine]\nlanes = [1, 4]\nrow_fifo = [2, 8]\n";
    shell.write("s.toml", space);
    let sweep = "explore SCENE --space s.toml -o whole";
    holds(&shell.results(sweep), &["8 points, 8 of them new"]);
    holds(&shell.results(sweep), &["8 points, 0 of them new"]);
    let page = shell.read("whole/front.html");
    assert!(page.contains("<title>point") && page.contains("Estimate of area for Xilinx 7"));
    shell.write("s.toml", "[machine]\nlanes = [2]\n");
    let refused = shell.refused(1, sweep, "holds another sweep");
    let difference = "space, line 1: '[design]' there, '[machine]' here";
    holds(&refused, &[difference]);
}

/// Several scenes by several cameras: each point says its slowest frame, the 95th percentile and the mean, as `model`
/// says them of that machine.
#[test]
fn a_sweep_over_frames_has_worst_percentile_and_mean() {
    let shell = Shell::new();
    let keys = "frames = 3\n[[key]]\neye = [0.0, 0.0, -9.0]\ntarget = [0.0, 0.0, 0.0]\nup = [0.0, -1.0, 0.0]\n\
                [[key]]\neye = [2.0, 0.0, -4.0]\ntarget = [0.0, 0.0, 0.0]\nup = [0.0, -1.0, 0.0]\n";
    shell.write("keys.toml", keys);
    shell.write(
        "s.toml",
        "[machine]\nlanes = [1, 4]\nlayout = [\"rows\", \"quad\"]\n",
    );
    let frames = "random:200:1 random:100:2 --size 32x24 --camera-path keys.toml";
    let sweep = format!("explore {frames} --space s.toml -o out");
    holds(&shell.results(&sweep), &["4 points, 4 of them new"]);
    let table = shell.read("out/points.csv");
    let heading: Vec<&str> = table.lines().next().unwrap().split(',').collect();
    let column = |line: &str, name: &str| {
        let place = heading.iter().position(|column| *column == name).unwrap();
        line.split(',').nth(place).unwrap().to_owned()
    };
    let line = table
        .lines()
        .find(|line| line.contains(",4,rows,"))
        .unwrap();
    assert_eq!(column(line, "frames"), "6");
    let machine = "--set lanes=4 --set layout=rows";
    let printed = shell.results(&format!("model {frames} {machine} -o model"));
    assert!(printed.contains("6 frames, the worst is"), "{printed}");
    let timing = shell.json("model/timing.json");
    let spread = &timing["over_frames"]["ms_per_frame"];
    for (name, key) in [
        ("ms_per_frame", "worst"),
        ("ms_per_frame_95", "percentile_95"),
        ("ms_per_frame_mean", "mean"),
    ] {
        assert_eq!(
            column(line, name),
            format!("{:.4}", spread[key].as_f64().unwrap()),
            "{name}"
        );
    }
    let errors: f64 = column(line, "max_abs").parse().unwrap();
    assert!(errors > 0.0);
    let none = table
        .lines()
        .find(|line| line.contains(",1,quad,"))
        .unwrap();
    assert!(none.contains("allowed with 2 or more lanes"), "{none}");
    // Another path is another sweep.
    shell.write("keys.toml", keys.replace("2.0", "2.5"));
    let refused = shell.refused(1, &sweep, "holds another sweep");
    holds(&refused, &["more_frames"]);
}

/// Designs that differ in their rounding alone have errors of their own: of three roundings no two are one design.
#[test]
fn a_sweep_tells_roundings_apart() {
    let shell = Shell::new();
    let roundings = "rounding = [\"nearest\", \"nearest-even\", \"truncate\"]";
    let space = format!("[design]\nbase = [\"lean18\"]\n{roundings}\n[machine]\nlanes = [1]\n");
    shell.write("s.toml", space);
    let sweep = "sweep random:300:1 --size 32x24 --space s.toml -o out";
    holds(&shell.results(sweep), &["3 points, 3 of them new"]);
    let table = shell.read("out/points.csv");
    let mut lines = table.lines().map(|line| line.split(','));
    let heading = lines.next().unwrap();
    let place = heading.clone().position(|column| column == "psnr_db");
    let mut errors: Vec<_> = lines.filter_map(|mut line| line.nth(place?)).collect();
    errors.sort_unstable();
    errors.dedup();
    assert_eq!(errors.len(), 3, "{table}");
}

/// Edited files of one name, other options, another program's identity: not resumed, and the message says why.
#[test]
fn a_sweep_of_anything_else_is_not_resumed() {
    let shell = Shell::new();
    for (name, text) in [
        ("s.toml", "[machine]\nlanes = [1, 2]\n"),
        ("d.toml", "base = \"lean18\"\n"),
        ("m.toml", "[lanes]\nlanes = 1\n"),
        ("p.toml", "family = \"ecp5\"\n"),
    ] {
        shell.write(name, text);
    }
    let scene = seed("scene.splat");
    shell.write("a.splat", &scene);
    let files = "--design d.toml --machine m.toml --calibration p.toml --space s.toml";
    let sweep = format!("explore a.splat --size 16x16 {files} --no-error -o known");
    shell.succeed(&sweep);
    let refused = |expected: &str, more: &str| {
        let printed = shell.refused(1, &format!("{sweep} {more}"), "holds another sweep");
        holds(&printed, &[expected]);
    };
    let mut edited = scene.clone();
    edited[27] += 25; // A splat's opacity.
    shell.write("a.splat", edited);
    refused("scene.sha256", "");
    shell.write("a.splat", scene);
    for (name, role) in [
        ("d.toml", "design"),
        ("m.toml", "machine"),
        ("p.toml", "calibration"),
    ] {
        let before = shell.read(name);
        shell.write(name, format!("{before}# a comment \n"));
        refused(&format!("files_sha256.{role}"), "");
        shell.write(name, before);
    }
    refused("camera.", "--eye 0,0,-3 --target 0,0,0");
    refused("rules", "--kernel disc");
    refused("compositing", "--compositing x-ray");
    refused("machine, line", "--set row_fifo=3");
    // Tables of another version of the program.
    let text = shell.read("known/sweep.json");
    let start = text.find("sources_sha256").unwrap() + 18;
    let other = format!("{}0000{}", &text[..start], &text[start + 4..]);
    shell.write("known/sweep.json", other);
    refused("program.sources_sha256", "");
}

/// One of the alterations that the table's own tests try.
#[test]
fn an_altered_sweep_is_not_resumed() {
    let shell = Shell::new();
    shell.write("s.toml", "[machine]\nrow_fifo = [1, 2, 3, 4]\n");
    let sweep = "explore SCENE --space s.toml -o out";
    shell.results(sweep);
    let sound = shell.read("out/points.csv");
    let altered = |from: &str, to: &str, expected: &str| {
        shell.write("out/points.csv", sound.replacen(from, to, 1));
        let printed = shell.refused(1, sweep, "points.csv");
        holds(&printed, &[expected]);
    };
    altered(
        "\n2,3,",
        "\n2,4,",
        "row_fifo is '4', in the space it is '3'",
    );
    altered(
        "\n2,3,",
        "\n2,3,NaN",
        "point 2: row_digest is not that of its fields",
    );
    let row = sound.lines().nth(1).unwrap();
    altered(row, &format!("{row}\n{row}"), "a second time");
}

/// A scene that nobody sees is swept, and its rows are read again.
#[test]
fn a_sweep_of_nothing_can_be_resumed() {
    let shell = Shell::new();
    shell.write("s.toml", "[machine]\nlanes = [1, 2]\n");
    let away = "sweep SCENE --eye 0,0,900 --target 0,0,1000 --space s.toml -o out";
    holds(&shell.succeed(away), &["2 points, 2 of them new"]);
    holds(&shell.succeed(away), &["2 points, 0 of them new"]);
}

/// Stopped by Ctrl-C again and again, a sweep still ends with the rows of one that was left alone.
#[cfg(unix)]
#[test]
fn an_interrupted_sweep_goes_on() {
    let shell = Shell::new();
    let designs = "[design]\nmantissa = { from = 12, to = 27 }";
    shell.write(
        "s.toml",
        format!("{designs}\n[machine]\nlanes = [1, 4]\nrow_fifo = [2, 8]\n"),
    );
    // Large enough that it takes a while after its first rows.
    let large = "explore random:3000:1 --size 160x120 --space s.toml";
    let (whole, stopped) = (format!("{large} -o whole"), format!("{large} -o stopped"));
    shell.results(&whole);
    let table = shell.path("stopped/points.csv");
    let rows = || {
        let text = std::fs::read_to_string(&table).unwrap_or_default();
        text.lines().count()
    };
    let mut interrupted = 0;
    for _ in 0..3 {
        let before = rows();
        let mut child = shell.command(&stopped);
        let mut child = child.stdout(std::process::Stdio::null()).spawn().unwrap();
        // Until it has written something new.
        while child.try_wait().unwrap().is_none() && rows() < before + 2 {
            std::thread::sleep(std::time::Duration::from_millis(1));
        }
        // Not an interrupt: a shell starts its background jobs deaf to it, and whoever tests from one would find
        // nothing interrupted.
        let kill = format!("kill -TERM {}", child.id());
        let signal = Command::new("sh").args(["-c", &kill]).status();
        if signal.is_ok_and(|status| status.success()) && !child.wait().unwrap().success() {
            interrupted += 1;
        }
    }
    assert!(interrupted > 0, "the sweep was too fast to be interrupted");
    shell.results(&stopped);
    let sorted = |folder: &str| {
        let text = shell.read(&format!("{folder}/points.csv"));
        let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
        lines.sort();
        lines
    };
    assert_eq!(sorted("stopped"), sorted("whole"));
    assert_eq!(sorted("whole").len(), 65);
}
