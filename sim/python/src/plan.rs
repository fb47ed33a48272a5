//! Plans: everything that decides a picture, and what can be asked of it.

use crate::camera::Camera;
use crate::convert::{array, raise, read, record, rows};
use crate::design::{Design, Machine};
use crate::scene::Scene;
use anyhow::{Context, Result, ensure};
use numpy::PyArray3;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use splatline_sim::cli;
use splatline_sim::explore::answer;
use splatline_sim::explore::evaluator::Evaluator;
use splatline_sim::explore::fit;
use splatline_sim::explore::limits::{Limit, limits_of_part, tightest};
use splatline_sim::explore::space::Space;
use splatline_sim::explore::subject::Subject;
use splatline_sim::machine::energy::EnergyTable;
use splatline_sim::machine::parts::Parts;
use splatline_sim::machine::record::{CostedMachine, Prices};
use splatline_sim::plan::FootprintLine;
use splatline_sim::plan::measure::{count_of_threads_or_runs, draw_alone};
use splatline_sim::plan::{
    self, DesignVariant, Effort, Engine, Prepared, Technique, all_entries, compare_all,
};
use splatline_sim::progress::ProgressMeter;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

/// A scene, from where it is seen, how and by whom it is drawn, and the machine whose cycles are counted: a plan file
/// with its scene loaded.
#[pyclass(frozen, skip_from_py_object, module = "splatline")]
#[derive(Clone)]
pub struct Plan {
    pub prepared: Arc<Prepared>,
    scene: Scene,
}

/// Pixels of a picture as an array.
type Drawing<'py> = Bound<'py, PyArray3<f64>>;

impl Plan {
    fn of_prepared(prepared: Prepared) -> Plan {
        let scene = Scene::of_plan(&prepared);
        let prepared = Arc::new(prepared);
        Plan { prepared, scene }
    }

    /// A plan whose scene is there already.
    fn of_scene(plan: plan::Plan, scene: &Scene) -> Plan {
        let prepared = Prepared::new(plan, Arc::clone(&scene.scene), Vec::new(), scene.seconds);
        Plan {
            prepared: Arc::new(prepared),
            scene: scene.clone(),
        }
    }

    fn effort(threads: Option<usize>, repeat: usize, vectors: Option<&str>) -> Result<Effort> {
        let vectors = vectors
            .map(|name| name.parse().map_err(anyhow::Error::msg))
            .transpose()?;
        for (what, count) in [("threads", threads.unwrap_or(1)), ("repeat", repeat)] {
            count_of_threads_or_runs(count)
                .map_err(|error| anyhow::anyhow!("{what} = {count}: {error}"))?;
        }
        Ok(Effort {
            vectors,
            ..Effort::new(threads, repeat)
        })
    }
}

/// Prices of area and energy, on a part if one is named.
pub fn prices(name: Option<&str>) -> Result<Prices> {
    let parts = Parts::default();
    let found = |name: &str| parts.find(name).map(|part| (name.to_owned(), part.clone()));
    let part = name.map(found).transpose().map_err(anyhow::Error::msg)?;
    let family = part.as_ref().map(|(_, part)| part.family);
    Ok(Prices {
        calibration: family.unwrap_or_default().calibration(),
        part,
        energy: EnergyTable::default(),
    })
}

/// Limits by quantity, as records name it.
fn limits(given: &Bound<'_, PyDict>) -> PyResult<Vec<Limit>> {
    let given: BTreeMap<String, f64> = pythonize::depythonize(given)?;
    let limit = |(name, bound): (String, f64)| -> Result<Limit> {
        let quantity = serde_json::from_value(name.clone().into()).context("limits")?;
        ensure!(
            bound.is_finite(),
            "limits: {name} is {bound}: expected a finite number"
        );
        Ok(Limit::new(quantity, bound, &name))
    };
    raise(given.into_iter().map(limit).collect())
}

#[pymethods]
impl Plan {
    /// The plan of these parts; `splatline.plan` gives each its usual value.
    #[new]
    fn new(
        scene: &Scene,
        camera: &Camera,
        technique: &Bound<'_, PyAny>,
        design: &Design,
        engine: &Bound<'_, PyAny>,
        reference: &Bound<'_, PyAny>,
        machine: &Machine,
    ) -> PyResult<Plan> {
        let technique: Technique = read(technique)?;
        let plan = plan::Plan {
            source: scene.source.clone(),
            camera: camera.0.clone(),
            technique,
            engine: read(engine)?,
            reference: read(reference)?,
            entry: DesignVariant::new(design.0.clone(), None),
            machine: machine.0,
        };
        let plan = Plan::of_scene(plan, scene);
        raise(plan.prepared.subject().map(drop))?;
        Ok(plan)
    }

    /// The plan of a file, a plan's (TOML) or a report's (JSON); paths in it count from the working directory.
    #[staticmethod]
    fn from_file(py: Python<'_>, path: PathBuf) -> PyResult<Plan> {
        raise(py.detach(|| Prepared::from_file(&path, &|_| ()))).map(Plan::of_prepared)
    }

    /// The plan that the command line makes of these words, the options of `splatline compare`.
    #[staticmethod]
    fn from_options(py: Python<'_>, words: Vec<String>) -> PyResult<Plan> {
        raise(py.detach(|| cli::prepared(words))).map(Plan::of_prepared)
    }

    /// From the dictionary that `to_dict` gives; its scene is loaded unless one is given.
    #[staticmethod]
    #[pyo3(signature = (plan, scene=None))]
    fn from_dict(py: Python<'_>, plan: &Bound<'_, PyAny>, scene: Option<&Scene>) -> PyResult<Plan> {
        let plan: plan::Plan = read(plan)?;
        match scene {
            Some(scene) => Ok(Plan::of_scene(plan, scene)),
            None => raise(py.detach(|| Prepared::load(plan, &|_| ()))).map(Plan::of_prepared),
        }
    }

    /// All that decides the picture, as a report records it.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        record(py, &raise(serde_json::to_value(&self.prepared.plan))?)
    }

    fn __reduce__<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<(Bound<'py, PyAny>, (Bound<'py, PyAny>, Option<Scene>))> {
        let (py, plan) = (slf.py(), slf.get());
        let make = slf.get_type().getattr("from_dict")?;
        let scene = (!plan.scene.is_file).then(|| plan.scene.clone());
        Ok((make, (plan.to_dict(py)?, scene)))
    }

    /// The scene.
    #[getter]
    fn scene(&self) -> Scene {
        self.scene.clone()
    }

    /// The camera.
    #[getter]
    fn camera(&self) -> Camera {
        Camera(self.prepared.plan.camera.clone())
    }

    /// The design, with the traversal that walks it.
    #[getter]
    fn design(&self) -> Design {
        let entry = &self.prepared.plan.entry;
        let mut design = entry.design.clone();
        design.traversal = entry.traversal;
        Design(design)
    }

    /// The machine.
    #[getter]
    fn machine(&self) -> Machine {
        Machine(self.prepared.plan.machine)
    }

    /// The picture's pixels, float64 of shape (height, width, 4), premultiplied red, green, blue and alpha, and its
    /// report.
    #[pyo3(signature = (threads=None, repeat=1, vectors=None))]
    fn draw<'py>(
        &self,
        py: Python<'py>,
        threads: Option<usize>,
        repeat: usize,
        vectors: Option<&str>,
    ) -> PyResult<(Drawing<'py>, Bound<'py, PyAny>)> {
        let effort = raise(Plan::effort(threads, repeat, vectors))?;
        let drawn = py.detach(|| draw_alone(&self.prepared, None, &effort, &ProgressMeter::new(1)));
        let (measured, report) = raise(drawn)?;
        Ok((array(py, measured.picture)?, record(py, &report)?))
    }

    /// The pixels by the kernel and by the reference, and the record that `splatline compare` writes; `all_designs`
    /// adds the table of named designs, `formats` that of floating-point datapaths.
    #[pyo3(signature = (threads=None, repeat=1, all_designs=false, formats=false))]
    fn compare<'py>(
        &self,
        py: Python<'py>,
        threads: Option<usize>,
        repeat: usize,
        all_designs: bool,
        formats: bool,
    ) -> PyResult<(Drawing<'py>, Drawing<'py>, Bound<'py, PyAny>)> {
        let effort = raise(Plan::effort(threads, repeat, None))?;
        let prepared = &self.prepared;
        let others = if all_designs && prepared.has_traversals() {
            all_entries(&prepared.plan.entry.design)
        } else {
            Vec::new()
        };
        let compared = py.detach(|| {
            let mut comparison = compare_all(prepared, &effort, &others)?;
            if formats {
                comparison.add_formats(prepared)?;
            }
            anyhow::Ok(comparison)
        });
        let compared = raise(compared)?;
        let report = record(py, &compared.report)?;
        let [fixed, float] = [array(py, compared.fixed)?, array(py, compared.float)?];
        Ok((fixed, float, report))
    }

    /// Where every splat lands, float64 of shape (n, 12): u, v, depth, conic a, b, c, x0, y0, x1, y1, cutoff, opacity;
    /// NaN where it is culled.
    #[pyo3(signature = (engine="fixed"))]
    fn footprints<'py>(
        &self,
        py: Python<'py>,
        engine: &str,
    ) -> PyResult<Bound<'py, numpy::PyArray2<f64>>> {
        let prepared = &self.prepared;
        let engine: Engine = raise(serde_json::from_value(engine.into()))?;
        let found = py.detach(|| match engine {
            Engine::Fixed => prepared.fixed_footprints(&prepared.plan.entry),
            _ => prepared.float_footprints(),
        });
        let row = |line: Option<FootprintLine>| -> [f64; 12] {
            let Some(line) = line else {
                return [f64::NAN; 12];
            };
            let ([u, v], [a, b, c]) = (line.centre, line.conic);
            let [x0, y0, x1, y1] = line.bounds.map(|bound| bound as f64);
            let (cutoff, opacity) = (line.cutoff, line.opacity.unwrap_or(f64::NAN));
            [u, v, line.depth, a, b, c, x0, y0, x1, y1, cutoff, opacity]
        };
        rows(py, raise(found)?.into_iter().map(row).collect())
    }

    /// The record that `splatline simulate` writes: cycles and accounts, pace, area, energy.
    #[pyo3(signature = (part=None))]
    fn simulate<'py>(&self, py: Python<'py>, part: Option<&str>) -> PyResult<Bound<'py, PyAny>> {
        let prices = raise(prices(part))?;
        let prepared = &self.prepared;
        let found = py.detach(|| {
            let workload = prepared.workload()?;
            let plan = &prepared.plan;
            let costed = CostedMachine {
                widths: &plan.entry.design.widths,
                traversal: plan.entry.traversal,
                config: &plan.machine,
                prices: &prices,
            };
            anyhow::Ok(costed.picture(prepared.scene.name(), &workload))
        });
        record(py, &raise(found)?)
    }
}

/// The frames of a question, with references where errors are asked for.
pub fn subject(frames: Vec<Arc<Prepared>>, errors: bool, part: Option<&str>) -> Result<Subject> {
    let mut subject = Subject::new(frames)?;
    let prices = prices(part)?;
    subject.calibration = prices.calibration;
    subject.energy = prices.energy;
    if errors {
        subject.draw_references()?;
    }
    Ok(subject)
}

/// The plans that Python handed over.
pub fn frames(plans: &[Bound<'_, Plan>]) -> Vec<Arc<Prepared>> {
    let prepared = |plan: &Bound<'_, Plan>| Arc::clone(&plan.get().prepared);
    plans.iter().map(prepared).collect()
}

/// The smallest design within limits on its errors: the record of `splatline fit`; its start is the first plan's
/// design.
#[pyfunction]
pub fn fit_widths<'py>(
    py: Python<'py>,
    plans: Vec<Bound<'py, Plan>>,
    limit: &Bound<'py, PyDict>,
) -> PyResult<Bound<'py, PyAny>> {
    let frames = frames(&plans);
    let limits = limits(limit)?;
    let found = py.detach(|| {
        ensure!(
            !limits.is_empty() && limits.iter().all(|limit| limit.quantity.is_error()),
            "limits: give one or more of psnr_db, largest_error, rms_error, percentile99 and flip, and no others"
        );
        let mut subject = subject(frames, true, None)?;
        subject.traversal = Some(subject.frames[0].plan.entry.traversal);
        let mut evaluator = Evaluator::within(subject, &limits);
        let (fitted, error) = fit::fit(&mut evaluator, &limits, &|_| ())?;
        fitted.with_context(|| fit::refusal(&evaluator.subject.design.name, &limits, &error))
    });
    record(py, &raise(found)?)
}

/// The cheapest design and machine that hold all limits: the answer of `splatline optimize`. `space` is the text of a
/// space file.
#[pyfunction]
#[pyo3(signature = (plans, limit, part=None, space=None))]
pub fn search_cheapest<'py>(
    py: Python<'py>,
    plans: Vec<Bound<'py, Plan>>,
    limit: &Bound<'py, PyDict>,
    part: Option<&str>,
    space: Option<&str>,
) -> PyResult<Bound<'py, PyAny>> {
    let frames = frames(&plans);
    let own = limits(limit)?;
    let found = py.detach(|| {
        let of_part = prices(part)?.part;
        let of_part = of_part.map(|(name, part)| limits_of_part(&name, &part));
        let limits = tightest([own, of_part.unwrap_or_default()].concat());
        let errors = limits.iter().any(|limit| limit.quantity.is_error());
        let measured = errors || frames.len() == 1;
        let subject = subject(frames, measured, part)?;
        let space = match space {
            Some(text) => Space::without_points("space", text)?,
            None => answer::usual_space(&subject.design, &subject.machine, errors)?,
        };
        let mut evaluator = Evaluator::within(subject, &limits);
        answer::optimize(&mut evaluator, &limits, &space, &|_| ())
    });
    record(py, &raise(found)?)
}
