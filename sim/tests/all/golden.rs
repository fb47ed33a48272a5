//! The golden table: every system of the papers as a plan, drawn to the committed bits and errors.

use super::shell::Shell;
use splatline_sim::plan::golden::{GoldenLine, lines, plans, table};
use splatline_sim::plan::{Plan, Prepared};
use splatline_sim::systems::SYSTEMS;
use std::path::{Path, PathBuf};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("plans")
}

#[test]
fn every_plan_draws_its_committed_bits_and_errors() {
    let lines = lines(&folder()).unwrap();
    let missed: Vec<&GoldenLine> = lines.iter().filter(|line| !line.meets_bars()).collect();
    assert!(missed.is_empty(), "{missed:?}");
    let found = table(&lines);
    let committed = std::fs::read_to_string(folder().join("golden.csv")).unwrap_or_default();
    if found != committed {
        let file = Path::new(env!("CARGO_TARGET_TMPDIR")).join("golden.csv");
        std::fs::write(&file, &found).unwrap();
        let changed: Vec<&str> = found
            .lines()
            .filter(|line| !committed.lines().any(|other| other == *line))
            .collect();
        panic!(
            "{} differs from sim/plans/golden.csv in\n{}",
            file.display(),
            changed.join("\n")
        );
    }
}

#[test]
fn every_system_has_a_plan_that_exercises_it() {
    for system in SYSTEMS.iter() {
        let prefix = format!("{:02}-", system.number);
        let own = plans(&folder()).unwrap().into_iter();
        let own: Vec<_> = own.filter(|(name, _)| name.starts_with(&prefix)).collect();
        assert!(!own.is_empty(), "{} {}", system.number, system.name);
        for (name, path) in own {
            let prepared = Prepared::from_file(&path, &|_| ()).unwrap();
            let verdicts = prepared.systems();
            let verdict = &verdicts[usize::from(system.number) - 1];
            assert!(verdict.used, "{name}: {}", verdict.reason);
        }
    }
}

/// What a report records of a plan is the plan, with what its picture settles of the machine.
#[test]
fn the_command_line_draws_every_plan_and_records_it() {
    let shell = Shell::new();
    for (name, path) in plans(&folder()).unwrap() {
        let plan = path.display();
        shell.succeed(&format!("render --plan {plan} -o x.png --json x.json"));
        let stated = Prepared::from_file(&path, &|_| ()).unwrap().plan;
        let recorded = Plan::from_report(&shell.read("x.json")).unwrap();
        assert_eq!(stated, recorded, "{name}");
    }
}

/// Numbers of rules that no rules have are refused with what is allowed, and drawn by nobody.
#[test]
fn a_plans_rules_are_in_their_ranges() {
    let shell = Shell::new();
    let plan = std::fs::read_to_string(folder().join("05-back-to-front.toml")).unwrap();
    for (key, value) in [
        ("low_pass", "NaN"),
        ("low_pass", "-1"),
        ("spacing", "inf"),
        ("cutoff", "-1"),
        ("alpha_max", "5"),
        ("alpha_min", "NaN"),
        ("minimum_transmittance", "2"),
    ] {
        let changed = format!("name = \"ewa\", {key} = {}", value.to_lowercase());
        let text = plan.replace("name = \"ewa\"", &changed);
        assert_ne!(text, plan);
        shell.write("p.toml", &text);
        let expected = format!("{key} = {value}: allowed is 0 to ");
        shell.refused(1, "render --plan p.toml -o x.png", &expected);
    }
}
