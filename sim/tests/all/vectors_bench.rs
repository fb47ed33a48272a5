//! The vector bench of the co-simulation guide: a simulator reads exported runs, and what its lane computes is compared
//! with the kernel. Without Icarus Verilog it is ignored.

use super::vectors::subject;
use splatline::format::Traversal;
use splatline_sim::vectors::{VectorSubject, compute, export};
use std::path::Path;
use std::process::Command;

#[test]
#[cfg_attr(
    not(has_iverilog),
    ignore = "Icarus Verilog is missing: apt-get install iverilog"
)]
fn a_simulator_steps_exported_runs_to_the_same_radial_indices() {
    let subject = subject("standard24", 72, [80, 40], 5);
    assert_eq!(subject.design.traversal, Traversal::Spans);
    let folder = tempfile::tempdir().unwrap();
    let manifest = export(folder.path(), &subject).unwrap();
    let runs = manifest
        .stages
        .iter()
        .find(|stage| stage.name == "runs")
        .unwrap();

    let sources = Path::new(env!("CARGO_MANIFEST_DIR")).join("capi/cosim");
    let run = |command: &mut Command| {
        command.current_dir(folder.path());
        let output = command.output().unwrap();
        assert!(output.status.success(), "{command:?}: {output:?}");
    };
    run(Command::new("iverilog")
        .args(["-g2012", "-s", "vectors_bench", "-o", "bench"])
        .arg(format!("-Pvectors_bench.COUNT={}", runs.records))
        .arg(format!("-Pvectors_bench.RECORD={}", runs.bits))
        .args(["vectors_bench.sv", "run_lane.sv"].map(|file| sources.join(file))));
    run(Command::new("vvp").arg("bench"));

    let got = std::fs::read_to_string(folder.path().join("radials.hex")).unwrap();
    assert_eq!(got, expected(&subject));
    assert!(got.lines().count() > 1000);
}

/// Two additions per pixel, in the lane's 32 bits.
fn expected(subject: &VectorSubject) -> String {
    let stages = compute(subject);
    let runs = stages.iter().find(|stage| stage.name == "runs").unwrap();
    let mut text = String::new();
    for record in &runs.records {
        let [_, _, _, length, radial, first, second] = record[..] else {
            panic!("a run has seven fields");
        };
        let (mut radial, mut first) = (radial as u32, first as u32);
        for _ in 0..length {
            text += &format!("{radial:08x}\n");
            radial = radial.wrapping_add(first);
            first = first.wrapping_add(second as u32);
        }
    }
    text
}
