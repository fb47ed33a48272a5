//! Sweeps point by point: a space's points, and what evaluates some of them.

use crate::convert::raise;
use crate::plan::{Plan, frames, prices, subject};
use anyhow::{Result, ensure};
use pyo3::prelude::*;
use rayon::ThreadPool;
use splatline_sim::explore::evaluator::Evaluator;
use splatline_sim::explore::front::{candidates, front, front_table};
use splatline_sim::explore::identity::Identity;
use splatline_sim::explore::plot;
use splatline_sim::explore::space;
use splatline_sim::explore::sweep;
use splatline_sim::explore::table::{RESULTS, ROW_DIGEST, ResultTable, row_digest};
use splatline_sim::machine::area::synthesis;
use splatline_sim::plan::Effort;
use splatline_sim::threads;
use std::sync::{Mutex, PoisonError};

/// The fields and values of a space file.
#[pyclass(frozen, skip_from_py_object, module = "splatline._native")]
pub struct Space {
    space: space::Space,
}

#[pymethods]
impl Space {
    #[new]
    #[pyo3(signature = (text, name="space", points=true))]
    fn new(text: &str, name: &str, points: bool) -> PyResult<Space> {
        let space = if points {
            space::Space::from_toml(name, text)
        } else {
            space::Space::without_points(name, text)
        };
        Ok(Space {
            space: raise(space)?,
        })
    }

    /// Axes, dearest first: key, values, and what they change (`design`, `tile`, `lanes`, `machine`).
    fn axes(&self, py: Python<'_>) -> PyResult<Vec<(String, Py<PyAny>, String)>> {
        let axis = |axis: &space::SpaceAxis| {
            let values = crate::convert::record(py, &axis.values)?.unbind();
            let part = format!("{:?}", axis.part).to_lowercase();
            Ok((axis.key.clone(), values, part))
        };
        self.space.axes.iter().map(axis).collect()
    }

    /// Points of a grid or a Latin hypercube, each an index into every axis's values.
    fn points(&self) -> Vec<Vec<usize>> {
        self.space.points.clone()
    }
}

/// Names of the results in their order.
#[pyfunction]
pub fn result_names() -> Vec<&'static str> {
    RESULTS.map(|(name, _)| name).to_vec()
}

/// Everything that decides the results, as JSON: scene, camera, rules, design, machine, prices, space.
#[pyfunction]
#[pyo3(signature = (plans, text, part=None))]
pub fn identity(
    py: Python<'_>,
    plans: Vec<Bound<'_, Plan>>,
    text: &str,
    part: Option<&str>,
) -> PyResult<String> {
    let frames = frames(&plans);
    let found = py.detach(|| Identity::new(&subject(frames, false, part)?, text, &[]));
    Ok(raise(found)?.to_text())
}

/// Texts of points.csv, front.csv and front.html for rows of axes' values and results.
#[pyfunction]
#[pyo3(signature = (title, axes, rows, part=None))]
pub fn sweep_pages(
    title: &str,
    axes: Vec<String>,
    rows: Vec<Vec<String>>,
    part: Option<&str>,
) -> PyResult<(String, String, String)> {
    let names = std::iter::once("point".to_owned()).chain(axes);
    let names = names.chain(RESULTS.map(|(name, _)| name.to_owned()));
    let numbered = rows.into_iter().enumerate().map(|(number, row)| {
        let mut fields = vec![number.to_string()];
        fields.extend(row);
        fields.push(row_digest(&fields));
        (number, fields)
    });
    let table = ResultTable {
        heading: names.chain([ROW_DIGEST.to_owned()]).collect(),
        rows: numbered.collect(),
    };
    let note = synthesis::statement(&raise(prices(part))?.calibration);
    let candidates = candidates(&table);
    let page = plot::page(title, &note, &table, &candidates);
    let front = front_table(&table, &front(&candidates));
    Ok((table.to_csv(), front.to_csv(), page))
}

/// Frames with their references, and what was drawn of them before, for points that come bit by bit.
#[pyclass(frozen, skip_from_py_object, module = "splatline._native")]
pub struct Evaluation {
    evaluator: Evaluator,
    space: space::Space,
    pool: ThreadPool,
}

#[pymethods]
impl Evaluation {
    #[new]
    #[pyo3(signature = (plans, text, errors=true, similarity=true, part=None, threads=None))]
    fn new(
        py: Python<'_>,
        plans: Vec<Bound<'_, Plan>>,
        text: &str,
        errors: bool,
        similarity: bool,
        part: Option<&str>,
        threads: Option<usize>,
    ) -> PyResult<Evaluation> {
        let frames = frames(&plans);
        let space = raise(space::Space::without_points("space", text))?;
        let pool = raise(threads::pool(Effort::new(threads, 1).threads))?;
        let subject = py.detach(|| pool.install(|| subject(frames, errors, part)));
        Ok(Evaluation {
            evaluator: Evaluator::new(raise(subject)?, similarity),
            space,
            pool,
        })
    }

    /// What points reach, in the order of `result_names`, as the tables of `splatline sweep` write it.
    fn run(&self, py: Python<'_>, points: Vec<Vec<usize>>) -> PyResult<Vec<Vec<String>>> {
        raise(py.detach(|| self.pool.install(|| self.evaluate(&points))))
    }
}

impl Evaluation {
    fn evaluate(&self, points: &[Vec<usize>]) -> Result<Vec<Vec<String>>> {
        let axes = &self.space.axes;
        for point in points {
            let mut values = point.iter().zip(axes);
            let fits =
                point.len() == axes.len() && values.all(|(index, axis)| *index < axis.values.len());
            ensure!(fits, "point {point:?} is none of the space's");
        }
        let found = Mutex::new(vec![Vec::new(); points.len()]);
        let keep = |place: usize, results| {
            found.lock().unwrap_or_else(PoisonError::into_inner)[place] = results;
            Ok(())
        };
        let points = points.iter().enumerate();
        sweep::evaluate(&self.evaluator, &self.space, points, &keep)?;
        Ok(found.into_inner().unwrap_or_else(PoisonError::into_inner))
    }
}
