//! The search beside the exhaustive sweep, which evaluates every point by a way of its own.

use super::*;
use crate::explore::answer_page;
use crate::explore::detail::detail;
use crate::explore::folder::{self, Appender};
use crate::explore::limits::{Quantity, tightest};
use crate::explore::subject::Choice;
use crate::explore::sweep;
use crate::explore::table::ResultTable;
use crate::plan::{DesignVariant, Plan, Prepared};
use crate::scene::synthetic;
use std::path::Path;
use std::sync::Arc;

const SPACE: &str = "[design]\nmantissa = [14, 16, 20, 24]\nalpha = [8, 10, 16, 24]\ncolour = [8, 12, 24]\n\
                     [machine]\ntile_width = [8, 16]\nlanes = [1, 2, 4]\nlayout = [\"run\", \"quad\"]\nrows_at_once = [1, 2]\n\
                     read_bandwidth = [2, 8]\n";

pub(in crate::explore) fn space(text: &str) -> Space {
    Space::from_toml("s.toml", text).unwrap()
}

/// The same scene by a camera or several.
pub(in crate::explore) fn subject(zooms: &[f64]) -> Subject {
    let scene = synthetic::random_gaussians(200, 1, 2.0);
    let (camera, rules) = (synthetic::camera(48, 32), scene.natural_rules);
    let design = DesignChoice::named("standard24").unwrap();
    let first = Prepared::of_splats(scene, camera.clone(), rules, design);
    let seen = |zoom: &f64| first.seen_by(camera.zoomed(*zoom).unwrap());
    of_frames(zooms.iter().map(seen).collect())
}

fn evaluator(zooms: &[f64]) -> Evaluator {
    Evaluator::new(subject(zooms), false)
}

fn of_frames(frames: Vec<Prepared>) -> Subject {
    let mut subject = Subject::new(frames.into_iter().map(Arc::new).collect()).unwrap();
    subject.machine.clock_mhz = 100;
    subject.draw_references().unwrap();
    subject
}

/// The table of a sweep that goes on from what is there.
pub(in crate::explore) fn swept(
    evaluator: &Evaluator,
    space: &Space,
    path: &Path,
) -> Result<ResultTable> {
    let (out, done) = Appender::open(path, space).unwrap();
    sweep::run(evaluator, space, &done, &out, &|| ())?;
    folder::table(path, space)
}

/// Errors, cycles and area of every point, by the sweep.
fn all_points(evaluator: &Evaluator, space: &Space) -> Vec<[f64; 5]> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("points.csv");
    let table = swept(evaluator, space, &path).unwrap();
    let place = |name: &str| table.column(name).unwrap();
    let places = ["max_abs", "cycles", "raster_luts", "around_luts", "area"].map(place);
    let value = |fields: &Vec<String>| {
        let numbers = places.map(|place| fields[place].parse().unwrap_or(f64::NAN));
        numbers[4].is_finite().then_some(numbers)
    };
    table.rows.values().filter_map(value).collect()
}

fn limit(quantity: Quantity, bound: f64) -> Limit {
    Limit::new(quantity, bound, "test")
}

/// For a mesh of limits, some of which nothing holds: the search ends at the cost of the cheapest point that the sweep
/// knows.
#[test]
fn the_search_finds_what_the_exhaustive_sweep_finds() {
    let (mut evaluator, space) = (evaluator(&[1.0]), space(SPACE));
    let swept = all_points(&evaluator, &space);
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
            let answer = optimize(&mut evaluator, &limits, &space, &|_| ()).unwrap();
            assert_eq!(answer.holds, cheapest.is_some(), "{allowed} {max_error}");
            let Some(cheapest) = cheapest else { continue };
            let costs: Vec<f64> = answer
                .found
                .iter()
                .map(|found| found.reached.cost())
                .collect();
            assert!(
                (costs[0] / cheapest - 1.0).abs() < 1e-5,
                "{allowed} {max_error}: {costs:?} {cheapest}"
            );
            assert!(costs.is_sorted_by(|a, b| a < b), "{costs:?}");
            held += 1;
        }
    }
    assert!(held >= 8, "{held}");
}

/// Limits that exclude each other: the one that misses least with all others held is told first, by what the sweep says
/// of it.
#[test]
fn the_limit_that_fails_first_is_named_by_how_much() {
    let (mut evaluator, space) = (evaluator(&[1.0]), space(SPACE));
    let swept = all_points(&evaluator, &space);
    let luts = |point: &[f64; 5]| point[2] + point[3];
    let cycles = swept.iter().map(|point| point[1]);
    let fastest = cycles.fold(f64::INFINITY, f64::min);
    let smallest = swept.iter().filter(|point| point[0] <= 5e-3).map(luts);
    let bound = smallest.fold(f64::INFINITY, f64::min);
    let limits = vec![
        limit(Quantity::FramesPerSecond, 100e6 / fastest),
        limit(Quantity::LargestError, 5e-3),
        limit(Quantity::Luts, bound),
    ];
    let answer = optimize(&mut evaluator, &limits, &space, &|_| ()).unwrap();
    assert!(!answer.holds);
    let within = swept.iter().filter(|p| p[0] <= 5e-3 && luts(p) <= bound);
    let slowest_rate = within.map(|point| fastest / point[1]).fold(0.0, f64::max);
    let off = answer.standings[0].missed_alone.unwrap() - (1.0 - slowest_rate);
    assert!(off.abs() < 1e-9, "{off} {slowest_rate}");
    let text = answer.text();
    for words in ["the first limit to fail is", "misses them least"] {
        assert!(text.contains(words), "{text}");
    }
}

/// Bounds are never above what the sweep simulates, whatever the point; and what they rule out is named, alone or with
/// the rate.
#[test]
fn bounds_lie_below_every_simulation_and_refuse_what_cannot_be() {
    let (mut evaluator, space) = (evaluator(&[1.0]), space(SPACE));
    for point in space.points.iter().step_by(7) {
        let choice = evaluator.subject.choice(&space, point).unwrap();
        if choice.machine.check_together().is_err() {
            continue;
        }
        let cost = &evaluator.on_all_frames(&choice).unwrap()[0];
        let reached = evaluator.reached(&choice, None, std::slice::from_ref(cost));
        let best = evaluator.at_best(&choice, &[0]).unwrap();
        assert!(best.pace.cycles_per_frame <= reached.pace.cycles_per_frame);
        assert!(best.pace.cycles_per_frame > reached.pace.cycles_per_frame / 20);
        assert!(best.millijoules <= reached.millijoules && best.millijoules > 0.0);
        assert!(best.pace.bytes_per_frame <= reached.pace.bytes_per_frame);
        assert_eq!(best.area, reached.area);
        use Quantity::{Flip, LargestError, Percentile99, PsnrDb, RmsError};
        for quantity in [PsnrDb, LargestError, RmsError, Percentile99, Flip] {
            let tight = if quantity.is_at_least() { 1e6 } else { 0.0 };
            assert_eq!(limit(quantity, tight).missed_by(&best), 0.0, "{quantity:?}");
        }
    }
    let refused = |limits: &[Limit]| {
        let answer = refusal(&evaluator, limits, &space, &|_| ()).unwrap();
        answer.map_or(Vec::new(), |answer| answer.ruled_out)
    };
    let [fast, small, modest] = [
        limit(Quantity::FramesPerSecond, 1e8),
        limit(Quantity::Luts, 100.0),
        limit(Quantity::FramesPerSecond, 1.0),
    ];
    assert_eq!(refused(std::slice::from_ref(&modest)), []);
    let both = refused(&[fast.clone(), small.clone()]);
    assert_eq!(both.len(), 2);
    assert!(both.iter().all(|out| out.with.is_empty()));
    assert!(both[0].best < 1e8 && both[1].best > 100.0);
    // The fastest machine alone holds the rate, the smallest one alone the area.
    let rate = |point: &[f64; 5]| 100e6 / point[1];
    let swept = all_points(&evaluator, &space);
    let fastest = swept.iter().map(rate).fold(0.0, f64::max);
    let luts = |point: &[f64; 5]| point[2] + point[3];
    let smallest = swept.iter().map(luts).fold(f64::INFINITY, f64::min);
    let pair = [
        limit(Quantity::FramesPerSecond, fastest),
        limit(Quantity::Luts, smallest),
    ];
    let ruled_out = refused(&pair);
    let answer = optimize(&mut evaluator, &pair, &space, &|_| ()).unwrap();
    assert!(!answer.holds && ruled_out.iter().all(|out| out.with == pair[..1]));
    let text = crate::explore::refusal::text(&both);
    assert!(text.contains("refused before any simulation") && text.contains("by area alone"));
}

/// The page's arrows carry every byte, its units all of the energy, and each change of a setting is what the machine so
/// changed reaches.
#[test]
fn the_page_shows_all_bytes_and_all_energy() {
    shows_all(&mut evaluator(&[1.0, 1.3]));
}

fn shows_all(evaluator: &mut Evaluator) {
    let space = space(SPACE);
    let limits = [limit(Quantity::FramesPerSecond, 2_000.0)];
    let answer = optimize(evaluator, &limits, &space, &|_| ()).unwrap();
    let detail = detail(evaluator, &limits, &space, &answer)
        .unwrap()
        .unwrap();
    let reached = &answer.found[0].reached;
    assert_eq!(detail.timing.total, reached.pace.cycles_per_frame);
    let bytes = detail.timing.bytes.all();
    assert_eq!(answer_page::bytes_shown(&detail.timing), bytes);
    assert_eq!(bytes, reached.pace.bytes_per_frame);
    let units = detail.energy.units.iter().map(|unit| unit.attojoules);
    assert_eq!(units.sum::<u64>(), detail.energy.attojoules);
    assert!(!detail.knobs.is_empty());
    for knob in &detail.knobs {
        let changes = knob.from != knob.to && knob.frames_per_s > -1.0;
        assert!(changes && knob.cost.is_finite(), "{knob:?}");
    }
    let page = answer_page::page("<random>", &answer, Some(&detail), "area of <nothing>");
    assert!(page.contains("&lt;random&gt;</h1>") && page.contains("area of &lt;nothing&gt;"));
    assert_eq!(page.matches("<svg").count(), 6);
    assert!(!page.contains("NaN") && !page.contains("inf "));
}

/// A surface's answer too.
#[test]
fn a_surface_is_answered_with_all_bytes_and_all_energy() {
    let plan: Plan = toml::from_str(include_str!("../../plans/11-layers.toml")).unwrap();
    let subject = of_frames(vec![Prepared::load(plan, &|_| ()).unwrap()]);
    assert!(subject.machine.surface_layers > 1);
    let mut evaluator = Evaluator::new(subject, false);
    shows_all(&mut evaluator);
    // A machine without its unit, or with another one, is refused.
    let space = space("[machine]\nsurface_layers = [1, 0]\n");
    for point in [[0], [1]] {
        let error = evaluator
            .subject
            .choice(&space, &point)
            .unwrap_err()
            .to_string();
        let expected = "it needs a machine with surface_layers";
        assert!(error.contains(expected), "{error}");
    }
}

/// An error below what the widest design makes is refused for that.
#[test]
fn an_error_beyond_every_width_is_refused() {
    let mut evaluator = evaluator(&[1.0]);
    let space = Space::without_points("s", "[design]\nmantissa = [14, 16]\n").unwrap();
    let limits = [limit(Quantity::LargestError, 1e-12)];
    let answer = optimize(&mut evaluator, &limits, &space, &|_| ()).unwrap();
    assert_eq!(answer.ruled_out.len(), 1);
    assert!(answer.ruled_out[0].best > 1e-12 && answer.found.is_empty() && answer.points == 0);
}

/// More frames than the search begins with, of which the others are nearer: the answer holds on each of them.
#[test]
fn an_answer_holds_on_every_frame() {
    let mut evaluator = evaluator(&[0.6, 0.8, 1.0, 1.2, 1.4, 1.6]);
    let limits = vec![
        limit(Quantity::FramesPerSecond, 6_000.0),
        limit(Quantity::LargestError, 5e-3),
    ];
    let answer = optimize(&mut evaluator, &limits, &space(SPACE), &|_| ()).unwrap();
    assert!(answer.holds, "{:?}", answer.standings);
    assert_eq!(answer.frames[1], 6);
    let found = &answer.found[0];
    let toml = found.design.to_toml();
    let choice = Choice {
        variant: DesignVariant::new(DesignChoice::from_toml("d.toml", &toml).unwrap(), None),
        machine: found.machine,
    };
    let costs = evaluator.on_all_frames(&choice).unwrap();
    for frame in 0..6 {
        let error = evaluator.error(&choice.variant, &[frame]).unwrap();
        let reached = evaluator.reached(&choice, error, &costs[frame..=frame]);
        assert!(are_held(&limits, &reached), "frame {frame}: {reached:?}");
    }
    let all = [0, 1, 2, 3, 4, 5];
    let error = evaluator.error(&choice.variant, &all).unwrap();
    assert_eq!(found.reached, evaluator.reached(&choice, error, &costs));
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
    let subject = Subject {
        design: design.clone(),
        machine,
        ..subject(&[1.0])
    };
    let choice = subject.choice(&space, &start(&subject, &space)).unwrap();
    assert_eq!(choice.variant.design.widths, design.widths);
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

/// A table with 12 bits needs a radial index with 10: the search goes around designs that are none, and a sweep says
/// which point is none.
#[test]
fn widths_that_exclude_each_other_end_no_search() {
    let mut one = evaluator(&[1.0]);
    // So many frames that the heaviest are asked for at the first point.
    let mut many = evaluator(&[1.0, 1.1, 1.2, 1.3, 1.4]);
    let few = "[design]\nradial = [8, 9, 20]\ntable = [6, 12]\n[machine]\nlanes = [1, 2]\n";
    // Every bit of a table is dear, and the search begins with 12 of them.
    let all = "[design]\nradial = { from = 8, to = 27 }\ntable = [12]\n";
    for (is_one, text, limit) in [
        (true, few, limit(Quantity::PsnrDb, 10.0)),
        (true, few, limit(Quantity::FramesPerSecond, 1.0)),
        (true, all, limit(Quantity::PsnrDb, 10.0)),
        (false, all, limit(Quantity::PsnrDb, 10.0)),
    ] {
        let evaluator = if is_one { &mut one } else { &mut many };
        let answer = optimize(evaluator, &[limit], &space(text), &|_| ()).unwrap();
        assert!(answer.holds, "{}", answer.text());
    }
    let refused = one
        .subject
        .choice(&space(all), &[0, 0])
        .unwrap_err()
        .to_string();
    assert!(
        refused.contains("radial = 8") && !refused.contains("toml"),
        "{refused}"
    );
}
