//! What a page shows of an answer's first machine beside the answer: its slowest frame in full, and what a change of
//! one setting would do.

use super::answer::{Answer, Found, place_of};
use super::evaluator::Evaluator;
use super::limits::{Limit, are_held};
use super::search::EXCHANGED;
use super::space::{Space, SpaceAxis};
use super::subject::Choice;
use crate::machine::energy::Energy;
use crate::machine::lanes::{LaneShape, LaneWork};
use crate::machine::simulate;
use crate::machine::timing::Timing;
use crate::report::machine::{Watched, watch};
use anyhow::{Context, Result};
use serde::Serialize;

/// The slowest frame of an answer's first machine.
pub struct Detail {
    /// Cycles and bytes.
    pub timing: Timing,
    /// What happened where and when.
    pub watched: Watched,
    /// Energy by unit.
    pub energy: Energy,
    /// Settings one step up and down.
    pub knobs: Vec<Knob>,
}

/// One setting changed: what it would do, as parts of what there is.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Knob {
    /// The setting.
    pub setting: String,
    /// Its value.
    pub from: String,
    /// What it would be.
    pub to: String,
    /// More area.
    pub cost: f64,
    /// More frames a second.
    pub frames_per_s: f64,
    /// More energy.
    pub energy: f64,
    /// Would all limits hold?
    pub holds: bool,
}

/// Of the first machine of an answer; nothing if it has none.
pub fn detail(
    evaluator: &Evaluator,
    limits: &[Limit],
    space: &Space,
    answer: &Answer,
) -> Result<Option<Detail>> {
    let Some(found) = answer.found.first() else {
        return Ok(None);
    };
    let choice = evaluator.subject.choice(space, &found.point)?;
    let costs = evaluator.on_all_frames(&choice)?;
    let by_cycles = |frame: &usize| costs[*frame].pace.cycles_per_frame;
    let slowest = (0..costs.len())
        .max_by_key(by_cycles)
        .context("there is no frame")?;
    let machine = &choice.machine;
    let workload = evaluator.workload(&choice, slowest)?;
    let work = LaneWork::new(&workload, LaneShape::from(machine));
    let timing = simulate(&workload, &work, machine);
    let watched = watch(&workload, &work, machine, &timing);
    let energy = evaluator.energy(&choice, &timing);
    let knobs = knobs(evaluator, limits, space, (&choice, found), slowest)?;
    Ok(Some(Detail {
        timing,
        watched,
        energy,
        knobs,
    }))
}

/// Each setting that costs or gains most, one step down and one up, on the slowest frame.
fn knobs(
    evaluator: &Evaluator,
    limits: &[Limit],
    space: &Space,
    (choice, found): (&Choice, &Found),
    frame: usize,
) -> Result<Vec<Knob>> {
    let (mut changed, mut choices) = (Vec::new(), Vec::new());
    let exchanged = |axis: &&SpaceAxis| EXCHANGED.contains(&axis.key.as_str());
    for axis in space.axes.iter().filter(exchanged) {
        let Some(place) = place_of(axis, &choice.variant.design, &choice.machine) else {
            continue;
        };
        let steps = [place.checked_sub(1), Some(place + 1)]
            .into_iter()
            .flatten();
        for to in steps.filter_map(|to| axis.values.get(to)) {
            let mut machine = choice.machine;
            machine.set("space", &axis.key, to)?;
            if machine.check_together().is_ok() {
                let variant = choice.variant.clone();
                choices.push(Choice { variant, machine });
                changed.push((&axis.key, axis.values[place].to_string(), to.to_string()));
            }
        }
    }
    let costs = evaluator.costs(&choices, &[frame], false)?;
    let before = &found.reached;
    let mut knobs = Vec::with_capacity(changed.len());
    for (((setting, from, to), choice), costs) in changed.into_iter().zip(&choices).zip(costs) {
        let reached = evaluator.reached(choice, before.error, &costs);
        knobs.push(Knob {
            setting: setting.clone(),
            from,
            to,
            cost: reached.cost() / before.cost() - 1.0,
            frames_per_s: reached.pace.frames_per_s / before.pace.frames_per_s - 1.0,
            energy: reached.millijoules / before.millijoules - 1.0,
            holds: are_held(limits, &reached),
        });
    }
    Ok(knobs)
}
