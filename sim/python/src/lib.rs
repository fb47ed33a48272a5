//! The package `splatline` for Python: scenes, cameras, designs and machines as classes, pictures as NumPy arrays,
//! records as dictionaries.
//!
//! Nothing is computed here. A [`plan::Plan`] is a [`splatline_sim::plan::Prepared`] that Python holds; what its
//! methods return are the records that the command line writes, by the same serde. Pictures are handed over, not
//! copied, and Python's lock is released while anything is drawn, simulated or searched. What is more convenient to say
//! in Python is said there: `splatline/*.py`.

mod camera;
mod convert;
mod design;
mod kernel;
mod plan;
mod scene;
mod space;

use numpy::PyReadonlyArray3;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use splatline_sim::picture::{Backdrop, Depth, PictureFormat};
use splatline_sim::report::ErrorFacts;
use std::path::PathBuf;

/// Bits per channel of a PNG file.
fn depth(bits: u8) -> PyResult<Depth> {
    match bits {
        8 => Ok(Depth::Eight),
        16 => Ok(Depth::Sixteen),
        _ => convert::raise(Err(anyhow::anyhow!("depth = {bits}: allowed are 8 and 16"))),
    }
}

/// Errors of one picture against another, per channel group in units of 1.0, and FLIP.
#[pyfunction]
fn metrics_of<'py>(
    py: Python<'py>,
    picture: PyReadonlyArray3<f64>,
    reference: PyReadonlyArray3<f64>,
) -> PyResult<Bound<'py, PyAny>> {
    let (picture, reference) = (convert::picture(&picture)?, convert::picture(&reference)?);
    let errors = py.detach(|| ErrorFacts::between(&picture, &reference));
    convert::record(py, &convert::raise(errors)?)
}

/// A picture file's bytes: `png`, `npy` or `exr`.
#[pyfunction]
#[pyo3(signature = (picture, format, bits=8, background=None))]
fn encode<'py>(
    py: Python<'py>,
    picture: PyReadonlyArray3<f64>,
    format: &str,
    bits: u8,
    background: Option<[f64; 3]>,
) -> PyResult<Bound<'py, PyBytes>> {
    let picture = convert::picture(&picture)?;
    let found = PictureFormat::of(&PathBuf::from(format!("x.{format}")));
    let allowed = || format!("format '{format}': allowed are png, npy and exr");
    let format = convert::raise(found.ok_or_else(|| anyhow::Error::msg(allowed())))?;
    let backdrop = background.map_or(Backdrop::Transparent, Backdrop::Colour);
    let bytes = picture.encode(format, depth(bits)?, backdrop);
    Ok(PyBytes::new(py, &convert::raise(bytes)?))
}

/// The command line; its exit code.
#[pyfunction]
fn command_line(py: Python<'_>, arguments: Vec<String>) -> u8 {
    py.detach(|| splatline_sim::cli::run_from(arguments))
}

/// Native half of the package `splatline`.
#[pymodule]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    splatline_sim::threads::deepen_global_stacks();
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("Error", module.py().get_type::<convert::Error>())?;
    module.add_class::<scene::Scene>()?;
    module.add_class::<camera::Camera>()?;
    module.add_class::<design::Design>()?;
    module.add_class::<design::Machine>()?;
    module.add_class::<plan::Plan>()?;
    module.add_class::<kernel::Kernel>()?;
    module.add_class::<space::Space>()?;
    module.add_class::<space::Evaluation>()?;
    module.add_function(wrap_pyfunction!(metrics_of, module)?)?;
    module.add_function(wrap_pyfunction!(encode, module)?)?;
    module.add_function(wrap_pyfunction!(command_line, module)?)?;
    module.add_function(wrap_pyfunction!(plan::fit_widths, module)?)?;
    module.add_function(wrap_pyfunction!(plan::search_cheapest, module)?)?;
    module.add_function(wrap_pyfunction!(space::result_names, module)?)?;
    module.add_function(wrap_pyfunction!(space::identity, module)?)?;
    module.add_function(wrap_pyfunction!(space::sweep_pages, module)?)?;
    Ok(())
}
