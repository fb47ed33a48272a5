//! Evaluates all points of a space. Points are sorted so that work is shared: a picture per design, a workload per
//! design and tile, lane work per lane shape. Of several frames one after the other is walked, so that the rows of one
//! alone lie in memory; a point's line has its slowest frame, and the spread of its time over all.

use super::evaluator::{Evaluator, work_key};
use super::folder::Appender;
use super::space::Space;
use super::subject::{Choice, NoDesign};
use super::table::{RESULTS, ResultTable};
use anyhow::{Result, anyhow};

/// Runs all points that `done` does not hold yet. `progress` is called for every finished point.
pub fn run(
    evaluator: &Evaluator,
    space: &Space,
    done: &ResultTable,
    out: &Appender,
    progress: &(dyn Fn() + Sync),
) -> Result<()> {
    let append = |number: usize, results: Vec<String>| {
        let axes = space.texts(&space.points[number]);
        let fields = std::iter::once(number.to_string())
            .chain(axes)
            .chain(results);
        out.append(fields.collect())
            .map_err(|error| anyhow!("cannot append to the table: {error}"))?;
        progress();
        Ok(())
    };
    let points = space.points.iter().enumerate();
    let open = points.filter(|(number, _)| !done.rows.contains_key(number));
    evaluate(evaluator, space, open, &append)
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
            let results = RESULTS.map(|(_, field)| field(&reached));
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
    use super::Evaluator;
    use crate::explore::answer::tests::{space, subject, swept};

    const SPACE: &str = "[design]\nbase = [\"lean18\", \"standard24\"]\n[machine]\ntile_width = [8, 16]\nlanes = [1, 4]\n\
                         layout = [\"run\", \"quad\"]\nrow_cycles = [1, 3]\n";

    /// A table of 12 bits has more intervals than a radial index of 9 bits has steps.
    #[test]
    fn points_without_a_design_are_left_out() {
        let folder = tempfile::tempdir().unwrap();
        let evaluator = Evaluator::new(subject(&[1.0]), true);
        let swept =
            |name: &str, text: &str| swept(&evaluator, &space(text), &folder.path().join(name));
        let table = swept("all", "[design]\nradial = [9, 20]\ntable = [10, 12]\n").unwrap();
        assert_eq!(table.rows.len(), 4);
        let reasons: Vec<&str> = table.left_out().collect();
        let one = matches!(reasons[..], [reason] if reason.contains("radial = 9"));
        assert!(one, "{reasons:?}");
        let refused = swept("none", "[design]\nradial = [9]\ntable = [12]\n").unwrap_err();
        assert!(refused.to_string().contains("table = 12"), "{refused}");
    }

    #[test]
    fn a_resumed_sweep_gives_the_whole_sweep() {
        let folder = tempfile::tempdir().unwrap();
        let [whole, cut] = ["whole.csv", "cut.csv"].map(|name| folder.path().join(name));
        let evaluator = Evaluator::new(subject(&[1.0]), true);
        let swept = |path| swept(&evaluator, &space(SPACE), path).unwrap();
        let complete = swept(&whole);
        assert_eq!(complete.rows.len(), 32);
        let reasons = complete.left_out().collect::<Vec<_>>();
        assert_eq!(reasons.len(), 8, "quads of one lane");
        for reason in reasons {
            assert!(reason.contains("allowed with 2 or more lanes"), "{reason}");
        }
        let text = std::fs::read_to_string(&whole).unwrap();
        std::fs::write(&cut, &text[..text.len() / 2]).unwrap();
        assert_eq!(swept(&cut), complete);
    }
}
