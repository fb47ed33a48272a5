//! Between Rust's values and Python's: errors, records, pictures.

use numpy::{
    Element, PyArray1, PyArray2, PyArray3, PyArrayMethods, PyReadonlyArray3, PyUntypedArrayMethods,
};
use pyo3::create_exception;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyFloat};
use serde::Serialize;
use serde::de::DeserializeOwned;
use splatline_sim::cli;
use splatline_sim::picture::Picture;

create_exception!(
    splatline,
    Error,
    PyValueError,
    "What cannot be read, drawn or searched, in the words of the command line: the file, the field, and what is allowed."
);

/// An exception in the command line's words.
pub fn error(error: &anyhow::Error) -> PyErr {
    Error::new_err(cli::explain(error))
}

/// The same for every kind of error.
pub fn raise<T>(result: Result<T, impl Into<anyhow::Error>>) -> PyResult<T> {
    result.map_err(|problem| error(&problem.into()))
}

/// A record as a dictionary: what the command line writes as JSON, with infinities.
pub fn record<'py>(py: Python<'py>, record: &impl Serialize) -> PyResult<Bound<'py, PyAny>> {
    Ok(pythonize::pythonize(py, record)?)
}

/// From a dictionary, with the messages of a plan file.
pub fn read<T: DeserializeOwned>(value: &Bound<'_, PyAny>) -> PyResult<T> {
    if let Some(name) = beyond_json(value)? {
        let message = anyhow::anyhow!("{name} is not finite: leave it out for its usual value");
        return Err(error(&message));
    }
    let value: serde_json::Value = pythonize::depythonize(value)?;
    raise(serde_json::from_value(value))
}

/// The key of a number that JSON does not have, which would be taken for one that was left out.
fn beyond_json(value: &Bound<'_, PyAny>) -> PyResult<Option<String>> {
    let Ok(settings) = value.cast::<PyDict>() else {
        return Ok(None);
    };
    for (key, value) in settings {
        let is_beyond = value
            .cast::<PyFloat>()
            .is_ok_and(|number| !number.value().is_finite());
        if let Some(name) = is_beyond.then(|| key.to_string()).or(beyond_json(&value)?) {
            return Ok(Some(name));
        }
    }
    Ok(None)
}

/// Rows of as many numbers as an array of two dimensions.
pub fn rows<T: Element, const N: usize>(
    py: Python<'_>,
    rows: Vec<[T; N]>,
) -> PyResult<Bound<'_, PyArray2<T>>> {
    let shape = [rows.len(), N];
    PyArray1::from_vec(py, rows.into_flattened()).reshape(shape)
}

/// A picture as an array of height x width x 4, whose memory it becomes.
pub fn array(py: Python<'_>, picture: Picture) -> PyResult<Bound<'_, PyArray3<f64>>> {
    let shape = [picture.height, picture.width, 4];
    PyArray1::from_vec(py, picture.pixels.into_flattened()).reshape(shape)
}

/// An array of height x width x 4 as a picture.
pub fn picture(array: &PyReadonlyArray3<f64>) -> PyResult<Picture> {
    let &[height, width, 4] = array.shape() else {
        let shape = array.shape();
        return Err(error(&anyhow::anyhow!(
            "a picture's array has the shape {shape:?}: allowed is (height, width, 4), red, green, blue and alpha"
        )));
    };
    // Copied once: Python may write into its array while the lock is released.
    let pixels = array.as_slice()?.as_chunks::<4>().0.to_vec();
    Ok(Picture {
        width,
        height,
        pixels,
    })
}
