//! The hard cases of `splatline stability`, quickly: what holds today stays so.

use splatline_sim::design::DesignChoice;
use splatline_sim::stability::{BOUNDED, Extent, Line, measure, table};
use std::sync::OnceLock;

fn lines() -> &'static [Line] {
    static LINES: OnceLock<Vec<Line>> = OnceLock::new();
    LINES.get_or_init(|| measure(&DesignChoice::all(), Extent::QUICK))
}

#[test]
fn needles_are_ten_times_better_than_single_precision() {
    for (single, fixed) in table::pairs(lines()).filter(|(single, _)| single.needle) {
        let gain = table::needle_gain(&single.errors, &fixed.errors);
        assert!(gain >= 10.0, "{}: {gain:.1}", fixed.case);
    }
}

/// Formats with a fixed point are coarser than a float near 0: a small opacity, and radial indices far below 1. No picture shows it.
const COARSER: [(&str, &str); 3] = [
    ("peak", "opacity 1/255"),
    ("r", "larger than the screen by 1000"),
    ("r", "stack of 2000 of alpha 2^-16"),
];

#[test]
fn standard24_is_nowhere_worse_than_single_precision() {
    for (single, fixed) in table::pairs(lines()) {
        for (stage, of) in table::STAGES {
            let (error, yardstick) = (of(&fixed.errors), of(&single.errors));
            let coarser = COARSER.contains(&(stage, fixed.case.as_str()));
            assert!(
                error <= yardstick || coarser,
                "{}, {stage}: {error:e} against {yardstick:e}",
                fixed.case
            );
        }
    }
}

#[test]
fn every_step_stays_within_its_bound() {
    let with_bounds = ["lean18", "standard24", "deep32"];
    for line in lines() {
        if !with_bounds.contains(&line.engine.as_str()) {
            continue;
        }
        for (step, share) in BOUNDED.iter().zip(line.errors.shares) {
            assert!(
                share <= 1.0,
                "{} {}, {step}: {share:.2}",
                line.engine,
                line.case
            );
        }
    }
}

#[test]
fn nothing_visible_is_lost_by_standard24() {
    for line in lines().iter().filter(|line| line.engine == "standard24") {
        let e = &line.errors;
        assert_eq!(e.culled_wrongly, 0, "{}", line.case);
        assert!(e.centre <= 1e-7, "{}: centre {:e}", line.case, e.centre);
        assert!(e.picture <= 2e-5, "{}: picture {:e}", line.case, e.picture);
    }
}
