//! What is explored: frames, the design and the machine that all starts from, and what a point of a space makes of
//! these two.

use super::space::{Space, SpacePart};
use crate::design::{DesignChoice, out_of_range};
use crate::machine::area::Calibration;
use crate::machine::config::Config;
use crate::machine::energy::EnergyTable;
use crate::picture::Picture;
use crate::plan::{DesignVariant, Engine, Prepared};
use anyhow::{Context, Result};
use splatline::format::Traversal;
use std::sync::Arc;

/// What is explored: frames, and the design and the machine that everything starts from.
pub struct Subject {
    /// The frames, of one scene or many.
    pub frames: Vec<Arc<Prepared>>,
    /// Their pictures in double precision; none leaves errors out.
    pub references: Vec<Picture>,
    /// The design to start from.
    pub design: DesignChoice,
    /// The traversal, unless the space or the design says otherwise.
    pub traversal: Option<Traversal>,
    /// The machine to start from.
    pub machine: Config,
    /// Prices of area.
    pub calibration: Calibration,
    /// Energies of actions.
    pub energy: EnergyTable,
    /// Floating-point formats that stand beside the answer.
    pub formats: Vec<Engine>,
}

impl Subject {
    /// Frames with the design and the machine that the first one's plan has, and no references yet.
    pub fn new(frames: Vec<Arc<Prepared>>) -> Result<Subject> {
        let plan = &frames.first().context("there is no frame")?.plan;
        // Of several scenes, the one with most harmonics.
        let harmonics = frames
            .iter()
            .map(|frame| frame.plan.machine.harmonics_bytes);
        let machine = Config {
            harmonics_bytes: harmonics.max().unwrap_or(0),
            ..plan.machine
        };
        Ok(Subject {
            references: Vec::new(),
            design: plan.entry.design.clone(),
            traversal: None,
            machine,
            calibration: Calibration::default(),
            energy: EnergyTable::default(),
            formats: Vec::new(),
            frames,
        })
    }

    /// Draws the references, once for all that follows.
    pub fn draw_references(&mut self) -> Result<()> {
        for frame in &self.frames {
            let drawing = frame.draw_reference(Engine::Float, &|_, _| ())?;
            self.references.push(drawing.picture);
        }
        Ok(())
    }

    /// The design and the machine of a point.
    pub fn choice(&self, space: &Space, point: &[usize]) -> Result<Choice> {
        let variant = self.variant(space, point)?;
        let machine = self.machine(space, point)?;
        Ok(Choice { variant, machine })
    }

    /// The design of a point.
    pub fn variant(&self, space: &Space, point: &[usize]) -> Result<DesignVariant> {
        let settings = space.settings(point, |part| part == SpacePart::Design);
        let design = changed(&self.design, &settings)?;
        let swept = settings.iter().any(|(key, _)| *key == "traversal");
        let traversal = if swept { None } else { self.traversal };
        Ok(DesignVariant::new(design, traversal))
    }

    /// The machine of a point.
    pub fn machine(&self, space: &Space, point: &[usize]) -> Result<Config> {
        let mut machine = self.machine;
        let settings = space.settings(point, |part| part != SpacePart::Design);
        machine.set_all("space", &settings)?;
        for frame in &self.frames {
            frame.check_machine(&machine)?;
        }
        Ok(machine)
    }
}

/// A design by one traversal on a machine.
#[derive(Clone, Debug)]
pub struct Choice {
    /// The design and its traversal.
    pub variant: DesignVariant,
    /// The machine.
    pub machine: Config,
}

impl Choice {
    /// A point's choice; nothing where its widths exclude each other.
    pub fn designed(point: Result<Choice>) -> Result<Option<Choice>> {
        match point {
            Err(refused) if refused.is::<NoDesign>() => Ok(None),
            point => point.map(Some),
        }
    }

    /// The same, and nothing where its settings make no machine.
    pub fn possible(point: Result<Choice>) -> Result<Option<Choice>> {
        let choice = Choice::designed(point)?;
        Ok(choice.filter(|choice| choice.machine.check_together().is_ok()))
    }

    /// Are its pictures those of the other?
    pub fn draws_as(&self, other: &Choice) -> bool {
        let (own, other) = (&self.variant, &other.variant);
        own.traversal == other.traversal && own.design.widths == other.design.widths
    }
}

/// Widths of a point that exclude each other; the space has checked each by itself.
#[derive(Debug, thiserror::Error)]
#[error("the space has a point without a design ({0}): {1}")]
pub struct NoDesign(String, String);

/// A design with some of its keys set otherwise; `base` names another one to begin with, or its file.
fn changed(start: &DesignChoice, settings: &[(&str, &toml::Value)]) -> Result<DesignChoice> {
    if settings.is_empty() {
        return Ok(start.clone());
    }
    let base = settings.iter().find(|(key, _)| *key == "base");
    let start = match base.and_then(|(_, value)| value.as_str()) {
        Some(name) => DesignChoice::load(name)?,
        None => start.clone(),
    };
    let mut table: toml::Table = start.resolved().to_toml().parse()?;
    for (key, value) in settings.iter().filter(|(key, _)| *key != "base") {
        table.insert((*key).to_owned(), (*value).clone());
    }
    let design = DesignChoice::unchecked("space.toml", &table.to_string())?;
    let Err(excluded) = design.widths.check() else {
        return Ok(design);
    };
    let point = settings
        .iter()
        .map(|(key, value)| format!("{key} = {value}"));
    let point = point.collect::<Vec<_>>().join(", ");
    Err(NoDesign(point, out_of_range(&excluded)).into())
}
