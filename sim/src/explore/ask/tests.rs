//! The search beside the exhaustive sweep, which evaluates every point by a way of its own.

use super::limits::{Limit, Quantity};
use super::*;
use crate::camera::Camera;
use crate::explore::folder::Appender;
use crate::explore::sweep::{self, Shard, SweepSubject};
use crate::explore::table::{ResultTable, heading};
use crate::machine::area::Calibration;
use crate::machine::energy::EnergyTable;
use crate::picture::Picture;
use crate::plan::Splats;
use crate::reference::float;
use crate::rules::Compositing;
use crate::scene::{Scene, synthetic};

const SPACE: &str = "[design]\nmantissa = [14, 16, 20, 24]\nalpha = [8, 10, 16, 24]\ncolour = [8, 12, 24]\n\
                     [machine]\ntile_width = [8, 16]\nlanes = [1, 2, 4]\nlayout = [\"run\", \"quad\"]\nrows_at_once = [1, 2]\n\
                     read_bandwidth = [2, 8]\n";

struct Subjects {
    scene: Scene,
    camera: Camera,
    reference: Picture,
}

impl Subjects {
    fn new() -> Subjects {
        let scene = synthetic::random_gaussians(200, 1, 2.0);
        let camera = synthetic::camera(48, 32);
        let order = Compositing::FrontToBack;
        let reference = float::draw(&scene, &camera, &scene.natural_rules, order).picture;
        Subjects {
            scene,
            camera,
            reference,
        }
    }

    fn splats<'a>(&'a self, camera: &'a Camera) -> Splats<'a> {
        Splats {
            scene: &self.scene,
            camera,
            rules: &self.scene.natural_rules,
            compositing: Compositing::FrontToBack,
            method: &crate::plan::SplatMethod::Composited,
        }
    }

    fn question(&self, limits: Vec<Limit>) -> Question<'_> {
        Question {
            frames: vec![self.splats(&self.camera)],
            references: vec![self.reference.clone()],
            design: DesignChoice::named("standard24").unwrap(),
            traversal: None,
            machine: machine(),
            calibration: Calibration::default(),
            limits,
            energy: EnergyTable::default(),
        }
    }

    /// Errors, cycles and area of every point, by the sweep.
    fn swept(&self, space: &Space) -> Vec<[f64; 5]> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("points.csv");
        let subject = SweepSubject {
            splats: self.splats(&self.camera),
            design: DesignChoice::named("standard24").unwrap(),
            traversal: None,
            machine: machine(),
            calibration: Calibration::default(),
            energy: EnergyTable::default(),
            reference: Some(&self.reference),
            more: Vec::new(),
        };
        let (out, _) = Appender::open(&path, &heading(space)).unwrap();
        let whole = Shard { index: 1, count: 1 };
        sweep::run(
            &subject,
            space,
            whole,
            &ResultTable::default(),
            &out,
            &|| (),
        )
        .unwrap();
        let table = ResultTable::from_csv(&std::fs::read_to_string(&path).unwrap()).unwrap();
        let place = |name: &str| table.column(name).unwrap();
        let places = ["max_abs", "cycles", "raster_luts", "around_luts", "area"].map(place);
        let value = |line: &String| {
            let fields: Vec<&str> = line.split(',').collect();
            let numbers = places.map(|place| fields[place].parse().unwrap_or(f64::NAN));
            numbers[4].is_finite().then_some(numbers)
        };
        table.lines.values().filter_map(value).collect()
    }
}

fn machine() -> Config {
    Config {
        clock_mhz: 100,
        ..Config::default()
    }
}

fn limit(quantity: Quantity, bound: f64) -> Limit {
    Limit::new(quantity, bound, "test")
}

/// For a mesh of limits, some of which nothing holds: the search ends at the cost of the cheapest point that the sweep knows.
#[test]
fn the_search_finds_what_the_exhaustive_sweep_finds() {
    let subjects = Subjects::new();
    let space = Space::from_toml("s.toml", SPACE).unwrap();
    let swept = subjects.swept(&space);
    let mut cycles: Vec<f64> = swept.iter().map(|point| point[1]).collect();
    cycles.sort_by(f64::total_cmp);
    let at = |part: f64| cycles[(part * (cycles.len() - 1) as f64) as usize] + 0.5;
    let mut held = 0;
    for allowed in [at(0.0), at(0.1), at(0.5), at(1.0), cycles[0] - 0.5] {
        for max_error in [2e-2, 5e-3, 1e-3] {
            let fits = |point: &&[f64; 5]| point[1] <= allowed && point[0] <= max_error;
            let cheapest = swept.iter().filter(fits).map(|point| point[4]);
            let cheapest = cheapest.min_by(f64::total_cmp);
            let limits = vec![
                limit(Quantity::FramesPerSecond, 100e6 / allowed),
                limit(Quantity::LargestError, max_error),
            ];
            let answer = ask(&subjects.question(limits), &space, &|_| ()).unwrap();
            assert_eq!(answer.holds, cheapest.is_some(), "{allowed} {max_error}");
            if let Some(cheapest) = cheapest {
                let cost = answer.found[0].reached.cost();
                assert!(
                    (cost / cheapest - 1.0).abs() < 1e-5,
                    "{allowed} {max_error}: {cost} {cheapest}"
                );
                assert!(
                    answer
                        .found
                        .windows(2)
                        .all(|two| two[0].reached.cost() < two[1].reached.cost())
                );
                held += 1;
            }
        }
    }
    assert!(held >= 8, "{held}");
}

/// Limits that exclude each other: the one that misses least with all others held is told first, by what the sweep says of it.
#[test]
fn the_limit_that_fails_first_is_named_by_how_much() {
    let subjects = Subjects::new();
    let space = Space::from_toml("s.toml", SPACE).unwrap();
    let swept = subjects.swept(&space);
    let luts = |point: &[f64; 5]| point[2] + point[3];
    let fastest = swept
        .iter()
        .map(|point| point[1])
        .fold(f64::INFINITY, f64::min);
    let smallest = swept.iter().filter(|point| point[0] <= 5e-3).map(luts);
    let bound = smallest.fold(f64::INFINITY, f64::min);
    let limits = vec![
        limit(Quantity::FramesPerSecond, 100e6 / fastest),
        limit(Quantity::LargestError, 5e-3),
        limit(Quantity::Luts, bound),
    ];
    let answer = ask(&subjects.question(limits), &space, &|_| ()).unwrap();
    assert!(!answer.holds);
    let within = swept.iter().filter(|p| p[0] <= 5e-3 && luts(p) <= bound);
    let slowest_rate = within.map(|point| fastest / point[1]).fold(0.0, f64::max);
    let missed = answer.standings[0].missed_alone.unwrap();
    assert!(
        (missed - (1.0 - slowest_rate)).abs() < 1e-9,
        "{missed} {slowest_rate}"
    );
    let text = answer.text(&Config::default());
    assert!(
        text.contains("the first limit to fail is") && text.contains("misses them least"),
        "{text}"
    );
}

/// More frames than the search begins with, of which the others are nearer: the answer holds on each of them.
#[test]
fn an_answer_holds_on_every_frame() {
    let subjects = Subjects::new();
    let cameras: Vec<Camera> = (0..6)
        .map(|step| subjects.camera.zoomed(0.6 + 0.2 * f64::from(step)).unwrap())
        .collect();
    let order = Compositing::FrontToBack;
    let rules = &subjects.scene.natural_rules;
    let draw = |camera| float::draw(&subjects.scene, camera, rules, order).picture;
    let limits = vec![
        limit(Quantity::FramesPerSecond, 6_000.0),
        limit(Quantity::LargestError, 5e-3),
    ];
    let question = Question {
        frames: cameras
            .iter()
            .map(|camera| subjects.splats(camera))
            .collect(),
        references: cameras.iter().map(draw).collect(),
        ..subjects.question(limits)
    };
    let space = Space::from_toml("s.toml", SPACE).unwrap();
    let answer = ask(&question, &space, &|_| ()).unwrap();
    assert!(
        answer.holds && answer.frames[1] == 6,
        "{:?}",
        answer.standings
    );
    let found = &answer.found[0];
    let toml = found.design.to_toml();
    let kept = Question {
        design: DesignChoice::from_toml("d.toml", &toml).unwrap(),
        machine: found.machine,
        ..question.about(&[0, 1, 2, 3, 4, 5])
    };
    let nothing = Space::without_points("s.toml", "").unwrap();
    for frame in 0..6 {
        let reached = on_frame(&kept, &nothing, &[], frame, &|_| ())
            .unwrap()
            .unwrap();
        assert!(kept.missed(&reached) <= 0.0, "frame {frame}: {reached:?}");
    }
    assert!(found.reached.ms_per_frame.mean < found.reached.ms_per_frame.worst);
}

/// Every width and every usual machine stands in the space, with what the search starts from.
#[test]
fn the_usual_space_holds_its_start() {
    let design = DesignChoice::named("lean18").unwrap();
    let machine = Config {
        lanes: 64,
        raster_units: 5,
        ..Config::default()
    };
    let space = usual_space(&design, &machine, true).unwrap();
    let subjects = Subjects::new();
    let question = Question {
        design: design.clone(),
        machine,
        ..subjects.question(Vec::new())
    };
    let evaluator = Evaluator::new(&question, &space, &|_| ());
    let choice = evaluator.choice(&start(&question, &space)).unwrap();
    assert_eq!(choice.design.widths, design.widths);
    assert_eq!(choice.machine, machine);
}

#[test]
fn of_two_limits_the_tighter_holds() {
    let all = vec![
        limit(Quantity::Luts, 100.0),
        limit(Quantity::FramesPerSecond, 30.0),
        limit(Quantity::Luts, 50.0),
        limit(Quantity::FramesPerSecond, 60.0),
        limit(Quantity::Luts, 70.0),
    ];
    let bounds: Vec<f64> = tightest(all).iter().map(|limit| limit.bound).collect();
    assert_eq!(bounds, [50.0, 60.0]);
}
