//! The vector bench of the co-simulation guide: a simulator reads exported runs, and what its lane computes is compared
//! with the kernel. Without Icarus Verilog it is ignored.

use splatline::format::Traversal;
use splatline_sim::design::DesignChoice;
use splatline_sim::rules::{Compositing, Rules};
use splatline_sim::vectors::{VectorSubject, compute, export, hard_cases};
use std::path::Path;
use std::process::Command;

#[test]
#[cfg_attr(
    not(has_iverilog),
    ignore = "Icarus Verilog is missing: apt-get install iverilog"
)]
fn a_simulator_steps_exported_runs_to_the_same_radial_indices() {
    let (view, splats) = hard_cases(72, [80, 40], 5);
    let subject = VectorSubject {
        design: DesignChoice::named("standard24").unwrap(),
        rules: Rules::GAUSSIAN_3D,
        compositing: Compositing::FrontToBack,
        view,
        splats,
        systems: false,
    };
    assert_eq!(subject.design.traversal, Traversal::Spans);
    let folder = tempfile::tempdir().unwrap();
    let manifest = export(folder.path(), &subject).unwrap();
    let runs = manifest
        .stages
        .iter()
        .find(|stage| stage.name == "runs")
        .unwrap();

    let sources = Path::new(env!("CARGO_MANIFEST_DIR")).join("capi/cosim");
    let compiled = Command::new("iverilog")
        .current_dir(folder.path())
        .args(["-g2012", "-s", "vectors_bench", "-o", "bench"])
        .arg(format!("-Pvectors_bench.COUNT={}", runs.records))
        .arg(format!("-Pvectors_bench.RECORD={}", runs.bits))
        .args([
            sources.join("vectors_bench.sv"),
            sources.join("run_lane.sv"),
        ])
        .output()
        .unwrap();
    assert!(
        compiled.status.success(),
        "{}",
        String::from_utf8_lossy(&compiled.stderr)
    );
    let ran = Command::new("vvp")
        .current_dir(folder.path())
        .arg("bench")
        .output()
        .unwrap();
    assert!(
        ran.status.success(),
        "{}",
        String::from_utf8_lossy(&ran.stdout)
    );

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
