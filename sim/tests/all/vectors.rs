//! Vectors: a round trip, the first difference in words, and agreement of the stepped picture with the kernel's
//! painter.

use super::shell::holds;
use splatline::blend::Pixel;
use splatline::format::{Classic8, Deep32, Design, Lean18, Micro16, Standard24, Traversal};
use splatline::raster::Window;
use splatline::setup::setup;
use splatline::target::Target;
use splatline_sim::design::DesignChoice;
use splatline_sim::fixed::{TableMemory, kernel_compositing, kernel_rules};
use splatline_sim::rules::{Compositing, Rules};
use splatline_sim::vectors::{VectorSubject, compute, export, hard_cases, verify};
use std::fs;

/// Hard cases by a design under the rules of 3D Gaussians.
pub fn subject(design: &str, cases: usize, size: [u16; 2], seed: u32) -> VectorSubject {
    let (view, splats) = hard_cases(cases, size, seed);
    VectorSubject {
        design: DesignChoice::named(design).unwrap(),
        rules: Rules::GAUSSIAN_3D,
        compositing: Compositing::FrontToBack,
        view,
        splats,
        systems: false,
    }
}

fn small() -> VectorSubject {
    subject("lean18", 72, [80, 40], 3)
}

/// The picture by the painter, whole footprints at a time, by a type of constant widths.
fn painted<D: Design>(design: D, subject: &VectorSubject) -> Vec<[i64; 5]> {
    let (widths, rules) = (design.widths(), kernel_rules(&subject.rules));
    let table = TableMemory::new(&widths, &rules);
    let compositing = kernel_compositing(subject.compositing);
    let painter = table.painter(design, compositing, subject.design.traversal);
    let view = &subject.view;
    let mut footprints: Vec<_> = subject
        .splats
        .iter()
        .flat_map(|s| setup(design, view, &rules, s))
        .collect();
    footprints.sort_by_key(|footprint| footprint.depth);
    if subject.compositing == Compositing::BackToFront {
        footprints.reverse();
    }
    let window = Window {
        first: [0; 2],
        end: view.viewport,
    };
    let mut pixels = vec![Pixel::clear(&widths); 80 * 40];
    let mut target = Target::new(&mut pixels, window, 80).unwrap();
    for footprint in &footprints {
        painter.draw(footprint, &mut target);
    }
    let words = |p: &Pixel| {
        let [r, g, b] = p.colour.map(i64::from);
        [r, g, b, p.transmittance().into(), p.is_finished().into()]
    };
    pixels.iter().map(words).collect()
}

#[test]
fn the_stepped_picture_is_the_painted_one() {
    for design in ["classic8", "micro16", "lean18", "standard24", "deep32"] {
        for traversal in [Traversal::Box, Traversal::Spans] {
            for rules in [Rules::EWA, Rules::GAUSSIAN_3D] {
                for compositing in [
                    Compositing::FrontToBack,
                    Compositing::BackToFront,
                    Compositing::XRay,
                ] {
                    let mut subject = subject(design, 72, [80, 40], 3);
                    subject.design.traversal = traversal;
                    (subject.rules, subject.compositing) = (rules, compositing);
                    let stages = compute(&subject);
                    let tile = stages.iter().find(|stage| stage.name == "tile").unwrap();
                    let painted = match design {
                        "classic8" => painted(Classic8, &subject),
                        "micro16" => painted(Micro16, &subject),
                        "lean18" => painted(Lean18, &subject),
                        "standard24" => painted(Standard24, &subject),
                        _ => painted(Deep32, &subject),
                    };
                    assert!(
                        tile.records.iter().eq(painted.iter()),
                        "{design} {traversal:?} {} {compositing:?}",
                        rules.name
                    );
                }
            }
        }
    }
}

#[test]
fn every_reason_for_culling_but_degenerate_occurs() {
    let mut subject = small();
    (subject.view, subject.splats) = hard_cases(600, [80, 40], 1);
    let stages = compute(&subject);
    let projected = stages
        .iter()
        .find(|stage| stage.name == "projected")
        .unwrap();
    let count = |reason: i64| projected.records.iter().filter(|r| r[0] == reason).count();
    let counts: Vec<usize> = (0..7).map(count).collect();
    for reason in [0, 1, 5, 6] {
        assert!(counts[reason] > 0, "{counts:?}");
    }
}

#[test]
fn what_is_exported_verifies() {
    let folder = tempfile::tempdir().unwrap();
    let manifest = export(folder.path(), &small()).unwrap();
    let verified = verify(folder.path()).unwrap();
    let expected: Vec<_> = manifest
        .stages
        .iter()
        .map(|s| (s.name.clone(), s.records))
        .collect();
    assert_eq!((verified.stages, verified.missing.len()), (expected, 0));
    assert!(manifest.stages.iter().all(|stage| stage.records > 0));
    fs::remove_file(folder.path().join("columns.hex")).unwrap();
    assert_eq!(verify(folder.path()).unwrap().missing, ["columns"]);
    let systems = VectorSubject {
        systems: true,
        ..small()
    };
    let folder = tempfile::tempdir().unwrap();
    let stages = export(folder.path(), &systems).unwrap().stages.len();
    assert_eq!(verify(folder.path()).unwrap().stages.len(), stages);
}

#[test]
fn a_design_from_a_file_verifies() {
    let folder = tempfile::tempdir().unwrap();
    let mut subject = small();
    subject.design =
        DesignChoice::from_toml("mine.toml", "base = \"lean18\"\nalpha = 15\n").unwrap();
    export(folder.path(), &subject).unwrap();
    verify(folder.path()).unwrap();
}

/// What verifying says after a line of a file has become what `change` makes of it.
fn message_after(file: &str, line: usize, change: impl Fn(&str) -> String) -> String {
    let folder = tempfile::tempdir().unwrap();
    export(folder.path(), &small()).unwrap();
    let file = folder.path().join(file);
    let text = fs::read_to_string(&file).unwrap();
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    lines[line] = change(&lines[line]);
    fs::write(&file, lines.join("\n")).unwrap();
    let message = verify(folder.path()).unwrap_err().to_string();
    message.replace(&folder.path().display().to_string(), "DIR")
}

#[test]
fn the_first_difference_is_named_in_words() {
    let flip_last = |line: &str| {
        let (rest, last) = line.split_at(line.len() - 1);
        let digit = u32::from_str_radix(last, 16).unwrap() ^ 1;
        format!("{rest}{digit:x}")
    };
    let told = |message: String, expected: &[&str]| {
        // In front of the first and behind the last there is nothing.
        holds(&format!("^{message}$"), expected);
    };
    let tile = "^DIR/tile.hex: stage tile, record 99, field red: expected ";
    told(message_after("tile.hex", 100, flip_last), &[tile]);
    let packet = "), field packet: expected 0 (0x0), got 1 (0x1)$";
    let runs = ["stage runs, record 0 (splat ", packet];
    told(message_after("runs.hex", 1, flip_last), &runs);
    let splats = "these are not the splats of these vectors";
    told(message_after("splats.hex", 1, flip_last), &[splats]);
    for (file, line, text, expected) in [
        (
            "pixels.hex",
            3,
            "0xq",
            "^DIR/pixels.hex: line 4: 'q' is not a hexadecimal digit",
        ),
        ("pixels.hex", 1, "", "stage pixels, record 0"),
        (
            "manifest.json",
            1,
            "\"format_version\": 9,",
            "format_version is 9, expected 6",
        ),
    ] {
        told(message_after(file, line, |_| text.to_owned()), &[expected]);
    }
}

#[test]
fn an_empty_folder_is_an_error_that_names_the_manifest() {
    let folder = tempfile::tempdir().unwrap();
    let message = verify(folder.path()).unwrap_err().to_string();
    assert!(message.contains("manifest.json"), "{message}");
}
