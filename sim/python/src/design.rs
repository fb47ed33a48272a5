//! Designs (widths of the datapath) and machines (units, memory and clock around it).

use crate::convert::{raise, record};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use splatline_sim::design::{DesignChoice, traversal_name};
use splatline_sim::machine::Config;
use splatline_sim::machine::config;
use std::path::Path;

/// TOML of a dictionary of numbers and words.
fn toml_of(settings: Option<&Bound<'_, PyDict>>) -> PyResult<toml::Table> {
    match settings {
        None => Ok(toml::Table::new()),
        Some(settings) => Ok(pythonize::depythonize(settings)?),
    }
}

/// Widths and rounding of a datapath, and how it walks a footprint.
///
/// `Design("lean18")`, `Design("mine.toml")`,
/// `Design("standard24", mantissa=20, rounding="truncate", traversal="box")`. The names are classic8, micro16, lean18,
/// standard24 and deep32; keys and ranges are those of a design file.
#[pyclass(frozen, eq, skip_from_py_object, module = "splatline")]
#[derive(Clone, PartialEq)]
pub struct Design(pub DesignChoice);

#[pymethods]
impl Design {
    #[new]
    #[pyo3(signature = (base="standard24", /, **changes))]
    fn new(base: &str, changes: Option<&Bound<'_, PyDict>>) -> PyResult<Design> {
        let start = raise(DesignChoice::load(base))?;
        let changes = toml_of(changes)?;
        if changes.is_empty() {
            return Ok(Design(start));
        }
        let mut table: toml::Table = raise(start.resolved().to_toml().parse())?;
        table.extend(changes);
        raise(DesignChoice::from_toml(&start.name, &table.to_string())).map(Design)
    }

    /// From the text of a design file.
    #[staticmethod]
    #[pyo3(signature = (text, name="design"))]
    fn from_toml(text: &str, name: &str) -> PyResult<Design> {
        raise(DesignChoice::from_toml(name, text)).map(Design)
    }

    /// The text of a design file.
    fn to_toml(&self) -> String {
        self.0.resolved().to_toml()
    }

    /// Its name.
    #[getter]
    fn name(&self) -> &str {
        &self.0.name
    }

    /// `spans` or `box`.
    #[getter]
    fn traversal(&self) -> &'static str {
        traversal_name(self.0.traversal)
    }

    /// Bits of every quantity by name.
    #[getter]
    fn widths<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        record(py, &self.0.resolved().widths)
    }

    /// Everything about it as reports state it.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        record(py, &self.0.resolved())
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, (String, String))> {
        let design = slf.get();
        let named = DesignChoice::named(&design.0.name).is_some_and(|named| named == design.0);
        if named {
            let make = slf.get_type().getattr("named")?;
            return Ok((make, (design.0.name.clone(), String::new())));
        }
        let make = slf.get_type().getattr("from_toml")?;
        Ok((make, (design.to_toml(), design.0.name.clone())))
    }

    /// One of the named designs; what pickling calls.
    #[staticmethod]
    #[pyo3(signature = (name, _rest=None))]
    fn named(name: &str, _rest: Option<&str>) -> PyResult<Design> {
        Design::new(name, None)
    }

    fn __repr__(&self) -> String {
        let widths = self.0.resolved().widths;
        let widths = widths.iter().map(|(key, bits)| format!("{key}={bits}"));
        let widths = widths.collect::<Vec<_>>().join(" ");
        format!("<Design {} by {}: {widths}>", self.0.name, self.traversal())
    }
}

/// A machine around the datapath: lanes, tiles, FIFOs, sorter, memory, clock.
///
/// `Machine()`, `Machine("primitive16")`, `Machine("mine.toml", lanes=8, layout="rows")`; keys and ranges are those of
/// a machine file.
#[pyclass(frozen, eq, skip_from_py_object, module = "splatline")]
#[derive(Clone, PartialEq)]
pub struct Machine(pub Config);

#[pymethods]
impl Machine {
    #[new]
    #[pyo3(signature = (base=None, /, **settings))]
    fn new(base: Option<&str>, settings: Option<&Bound<'_, PyDict>>) -> PyResult<Machine> {
        let named = base.map_or_else(|| Some(Config::default()), Config::named);
        let mut config = match (named, base) {
            (None, Some(file)) => raise(config::from_file(Path::new(file)))?,
            (named, _) => named.unwrap_or_default(),
        };
        for (key, value) in toml_of(settings)? {
            raise(config.set("Machine", &key, &value))?;
        }
        if let Err((key, value, allowed)) = config.check_together() {
            return raise(Err(anyhow::anyhow!("{key} = {value}: {allowed}")));
        }
        Ok(Machine(config))
    }

    /// From the text of a machine file.
    #[staticmethod]
    #[pyo3(signature = (text, name="machine"))]
    fn from_toml(text: &str, name: &str) -> PyResult<Machine> {
        raise(config::from_toml(name, text)).map(Machine)
    }

    /// The text of a machine file.
    fn to_toml(&self) -> String {
        config::to_toml(&self.0)
    }

    /// All settings.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        record(py, &self.0)
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, (String,))> {
        let make = slf.get_type().getattr("from_toml")?;
        Ok((make, (slf.get().to_toml(),)))
    }

    fn __repr__(&self) -> String {
        let (lanes, width, height) = (self.0.lanes, self.0.tile_width, self.0.tile_height);
        format!("<Machine {lanes} lanes, tiles of {width}x{height}>")
    }
}
