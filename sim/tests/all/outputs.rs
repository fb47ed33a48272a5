//! No output of any command replaces a file that the command has read, whatever that file is called and however it came
//! to be read.

use super::hostile::seeds::{apart, seed};
use super::shell::{Shell, files_below, holds, said};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// A folder of scenes that consist of several files, and of settings.
fn scenes() -> Shell {
    let shell = Shell::new();
    let write = |name: &str, bytes: &[u8]| shell.write(name, bytes);
    let bundle = std::io::Cursor::new(seed("first.sog"));
    let mut bundle = zip::ZipArchive::new(bundle).unwrap();
    bundle.extract(shell.path("sg")).unwrap();
    write("scene.ply", &seed("binary.ply"));
    write("ve/splats.hex", &seed("binary.ply"));
    write("volume.mhd", &seed("volume.mhd"));
    write("volume.raw", &seed("volume.raw"));
    write("head.nhdr", &seed("detached.nhdr"));
    write("data", &[7; 60]);
    let [scene, buffer] = apart();
    write("scene.gltf", &scene);
    write("tiny.bin", &buffer);
    write("grid.csv", &seed("grid.csv"));
    write("d/front.csv", b"[machine]\nlanes = [1, 2]\n");
    write("d/answer.json", b"[machine]\nlanes = [1, 2]\n");
    write("d/timing.json", &seed("footprints.csv"));
    write("d/machine.toml", &seed("machine.toml"));
    write("d/action_counts.yaml", &seed("prices.toml"));
    write("path.toml", &seed("path.toml"));
    write("d/design.toml", b"base = \"lean18\"\n");
    shell
}

/// Every file below a folder.
fn contents(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let read = |path: PathBuf| (path.display().to_string(), std::fs::read(&path).unwrap());
    files_below(folder).into_iter().map(read).collect()
}

/// Commands; behind `|` the file that one reads and the name by which its output would meet that: a link where the
/// format wants another extension.
const CASES: &str = "
    render sg -o x.png --json sg/meta.json
    render sg -o link.png | sg/ml.webp link.png
    render sg/meta.json -o link.png | sg/q.webp link.png
    render scene.gltf -o link.png | tiny.bin link.png
    render volume.mhd -o link.png | volume.raw link.png
    render head.nhdr -o link.png | data link.png
    render grid.csv --as surface -o link.png | grid.csv link.png
    render sg --camera-path path.toml -o link.png | path.toml link-0002.png
    compare sg -o d | sg/meta.json d/report.json
    compare sg -o d --json sg/meta.json
    compare sg -o d --camera-path path.toml | path.toml d/frames.json
    footprints scene.gltf -o link.csv | tiny.bin link.csv
    footprints scene.ply --design d/design.toml -o link.csv | d/design.toml link.csv
    info sg --json sg/meta.json
    page sg -o link.html | sg/c.webp link.html
    profile sg --json sg/meta.json
    fit scene.ply --max-error 1 --design d/design.toml -o d/design.toml
    fit sg --max-error 1 -o link.toml | sg/s.webp link.toml
    simulate --footprints d/timing.json -o d
    simulate sg --machine d/machine.toml -o d
    simulate sg -o d --calibration d/action_counts.yaml
    simulate sg --machines -o d | sg/meta.json d/machines.json
    sweep sg --space d/front.csv -o d
    optimize sg --space d/answer.json --fps 1 -o d
    trace sg --format perfetto -o sg/meta.json
    vectors export ve --scene ve/splats.hex";

#[test]
fn no_command_replaces_what_it_reads() {
    let mut failed = Vec::new();
    for case in CASES.trim().lines() {
        let shell = scenes();
        let (line, link) = case.split_once('|').unwrap_or((case, ""));
        if let Some((file, name)) = link.trim().split_once(' ') {
            let name = shell.path(name);
            let _ = std::fs::remove_file(&name);
            std::fs::hard_link(shell.path(file), name).unwrap();
        }
        let before = contents(&shell.path(""));
        let said = shell.run(line);
        let refused =
            said.stderr.contains("would be destroyed") && matches!(said.code, Some(1 | 2));
        let changed =
            |(name, bytes): (&String, &Vec<u8>)| std::fs::read(name).ok().as_ref() != Some(bytes);
        if !refused || before.iter().any(changed) {
            failed.push(format!("{line}: {}", said.stderr));
        }
    }
    assert!(failed.is_empty(), "{}", failed.join("\n"));
}

/// Who repeats a command replaces its results; those of another one are told of, and never replaced.
#[test]
fn a_folder_of_another_commands_results_is_not_written_to_silently() {
    let shell = Shell::new();
    let scene = "random:9 --size 16x16";
    for _ in 0..2 {
        shell.results(&format!("simulate {scene} -o out"));
    }
    let timing = shell.bytes("out/timing.json");
    let said = shell.run(&format!("compare {scene} --only -o out"));
    let note = "note: 'out' also holds results of `simulate`, which stay as they are\n";
    assert_eq!((said.code, &*said.stderr), (Some(0), note));
    assert_eq!(shell.bytes("out/timing.json"), timing);
    let machine = shell.bytes("out/machine.toml");
    let question = format!("optimize {scene} --lut 200000 -o out");
    shell.refused(
        2,
        &question,
        "'machine.toml' there is a result of `simulate`",
    );
    assert_eq!(shell.bytes("out/machine.toml"), machine);
}

/// Linux names files by any bytes, and a report is text.
#[cfg(target_os = "linux")]
#[test]
fn a_name_that_no_report_can_state_is_shown_with_what_to_do() {
    use std::os::unix::ffi::OsStrExt;
    let shell = Shell::new();
    let name = std::ffi::OsStr::from_bytes(b"odd\xff.ply");
    std::fs::write(shell.path("").join(name), seed("gaussian.ply")).unwrap();
    let mut command = shell.command("render -o a.png --json a.json");
    command.arg(name);
    let said = said(command);
    assert_eq!(said.code, Some(1), "{}", said.stderr);
    holds(&said.stderr, &["odd\u{fffd}.ply: ", "rename it"]);
}
