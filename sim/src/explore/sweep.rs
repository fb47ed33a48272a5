//! Evaluates all points of a space. Points are sorted so that work is shared: a picture per design, a workload per
//! design and tile, lane work per lane shape. Of several frames one after the other is walked, so that the rows of one
//! alone lie in memory; a point's line has its slowest frame, and the spread of its time over all.

use super::evaluator::{Evaluator, work_key};
use super::folder::Appender;
use super::space::Space;
use super::subject::{Choice, NoDesign, Subject};
use super::table::{RESULTS, ResultTable};
use anyhow::{Result, anyhow};

/// Runs all points that `done` does not hold yet. `progress` is called for every finished point.
pub fn run(
    subject: &Subject,
    space: &Space,
    done: &ResultTable,
    out: &Appender,
    progress: &(dyn Fn() + Sync),
) -> Result<()> {
    let evaluator = Evaluator::new(subject, true);
    let append = |number: usize, results: Vec<String>| {
        let axes = space.texts(&space.points[number]);
        let fields = std::iter::once(number.to_string())
            .chain(axes)
            .chain(results);
        out.append(&fields.collect::<Vec<_>>())
            .map_err(|error| anyhow!("cannot append to the table: {error}"))?;
        progress();
        Ok(())
    };
    let points = space.points.iter().enumerate();
    let open = points.filter(|(number, _)| !done.rows.contains_key(number));
    evaluate(&evaluator, space, open, &append)
}

/// Evaluates numbered points, those that share work side by side, and hands each one's results over as soon as they are
/// known. Points without a design or a machine are left out; where none has a design, a value of the space is mistaken.
pub fn evaluate<'a>(
    evaluator: &Evaluator,
    space: &Space,
    points: impl Iterator<Item = (usize, &'a Vec<usize>)>,
    take: &(dyn Fn(usize, Vec<String>) -> Result<()> + Sync),
) -> Result<()> {
    let frames: Vec<usize> = (0..evaluator.subject.frames.len()).collect();
    let mut open: Vec<(usize, Choice)> = Vec::new();
    let (mut without, mut designs) = (Vec::new(), 0);
    for (number, point) in points {
        let choice = match evaluator.subject.choice(space, point) {
            Err(refused) if refused.is::<NoDesign>() => {
                without.push((number, refused));
                continue;
            }
            choice => choice?,
        };
        designs += 1;
        match choice.machine.check_together() {
            Ok(()) => open.push((number, choice)),
            Err((key, value, allowed)) => {
                take(number, left_out(&format!("{key} = {value}: {allowed}")))?;
            }
        }
    }
    if designs == 0 && !without.is_empty() {
        return Err(without.swap_remove(0).1);
    }
    for (number, refused) in without {
        take(number, left_out(&refused.to_string()))?;
    }
    for group in open.chunk_by(|a, b| work_key(&a.1) == work_key(&b.1)) {
        let (numbers, choices): (Vec<usize>, Vec<Choice>) = group.iter().cloned().unzip();
        let error = evaluator.error(&choices[0].variant, &frames)?;
        evaluator.run(&choices, &frames, false, &|place, costs| {
            let reached = evaluator.reached(&choices[place], error, &costs);
            let results = RESULTS.map(|(.., field)| field(&reached));
            take(numbers[place], results.to_vec())
        })?;
    }
    Ok(())
}

/// The result columns of a point that was not run.
fn left_out(reason: &str) -> Vec<String> {
    let mut fields = vec![String::new(); RESULTS.len() - 1];
    fields.push(reason.replace([',', '\n', '"'], " "));
    fields
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::DesignChoice;
    use crate::explore::table::heading;
    use crate::plan::Prepared;
    use crate::scene::synthetic;

    const SPACE: &str = "[design]\nbase = [\"lean18\", \"standard24\"]\n[machine]\ntile_width = [8, 16]\nlanes = [1, 4]\n\
                         layout = [\"run\", \"quad\"]\nrow_cycles = [1, 3]\n";

    fn sweep(done: &ResultTable, path: &std::path::Path) {
        swept(SPACE, done, path).unwrap();
    }

    fn swept(space: &str, done: &ResultTable, path: &std::path::Path) -> Result<()> {
        let scene = synthetic::random_gaussians(300, 1, 2.0);
        let camera = synthetic::camera(48, 32);
        let space = Space::from_toml("s.toml", space).unwrap();
        let design = DesignChoice::named("standard24").unwrap();
        let rules = scene.natural_rules;
        let prepared = Prepared::of_splats(scene, camera, rules, design);
        let mut subject = Subject::new(vec![&prepared]).unwrap();
        subject.draw_references().unwrap();
        let (out, _) = Appender::open(path, &heading(&space)).unwrap();
        run(&subject, &space, done, &out, &|| ())
    }

    /// A table of 12 bits has more intervals than a radial index of 9 bits has steps.
    #[test]
    fn points_without_a_design_are_left_out() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("points.csv");
        let (none, space) = (
            ResultTable::default(),
            "[design]\nradial = [9, 20]\ntable = [10, 12]\n",
        );
        swept(space, &none, &path).unwrap();
        let table = ResultTable::from_csv(&std::fs::read_to_string(&path).unwrap()).unwrap();
        assert_eq!(table.rows.len(), 4);
        let reasons: Vec<&str> = table.left_out().collect();
        assert!(
            matches!(reasons[..], [reason] if reason.contains("radial = 9")),
            "{reasons:?}"
        );
        std::fs::remove_file(&path).unwrap();
        let refused = swept("[design]\nradial = [9]\ntable = [12]\n", &none, &path).unwrap_err();
        assert!(refused.to_string().contains("table = 12"), "{refused}");
    }

    #[test]
    fn a_resumed_sweep_gives_the_whole_sweep() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        let read = |name: &str| {
            ResultTable::from_csv(&std::fs::read_to_string(path(name)).unwrap()).unwrap()
        };
        sweep(&ResultTable::default(), &path("whole.csv"));
        let complete = read("whole.csv");
        assert_eq!(complete.rows.len(), 32);
        let left_out = complete
            .rows
            .values()
            .filter(|row| {
                row.iter()
                    .any(|f| f.contains("allowed with 2 or more lanes"))
            })
            .count();
        assert_eq!(left_out, 8, "quads of one lane");

        let text = std::fs::read_to_string(path("whole.csv")).unwrap();
        std::fs::write(path("cut.csv"), &text[..text.len() / 2]).unwrap();
        sweep(&read("cut.csv"), &path("cut.csv"));
        assert_eq!(read("cut.csv"), complete);
    }
}
