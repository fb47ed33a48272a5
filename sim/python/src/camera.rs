//! Cameras.

use crate::convert::{raise, record};
use crate::scene::Scene;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use splatline_sim::camera;
use splatline_sim::cameras;
use splatline_sim::framing::USUAL_FOV;
use std::path::PathBuf;

/// Pinhole or orthographic camera in double precision: x right, y down, z forward; pixel (i, j) is sampled at (i + 0.5,
/// j + 0.5).
///
/// Made by `look_at`, `load`, `load_all`, `framing` or `from_json`; sizes are (width, height) in pixels, angles in
/// degrees.
#[pyclass(frozen, eq, skip_from_py_object, module = "splatline")]
#[derive(Clone, PartialEq)]
pub struct Camera(pub camera::Camera);

#[pymethods]
impl Camera {
    /// A perspective camera at `eye` that looks at `target`, with `up` pointing up; `fov` is the vertical field of view
    /// in degrees.
    #[staticmethod]
    #[pyo3(signature = (eye, target, up, fov=USUAL_FOV, size=(512, 512)), text_signature = "(eye, target, up, fov=45.0, size=(512, 512))")]
    fn look_at(
        eye: [f64; 3],
        target: [f64; 3],
        up: [f64; 3],
        fov: f64,
        size: (usize, usize),
    ) -> PyResult<Camera> {
        let (width, height) = size;
        raise(camera::Camera::look_at(eye, target, up, fov, width, height)).map(Camera)
    }

    /// A camera that shows the whole of a scene, from its front: what the command line takes where none is named.
    #[staticmethod]
    #[pyo3(signature = (scene, fov=USUAL_FOV, size=(512, 512), up=None), text_signature = "(scene, fov=45.0, size=(512, 512), up=None)")]
    fn framing(
        scene: &Scene,
        fov: f64,
        size: (usize, usize),
        up: Option<[f64; 3]>,
    ) -> PyResult<Camera> {
        let frame = scene.scene.frame(up);
        let camera = raise(frame.camera(None, fov, size.0, size.1))?;
        Ok(Camera(match scene.scene.splats() {
            Some(splats) => frame.filled(camera, splats).0,
            None => camera,
        }))
    }

    /// The camera of a file, or the one of this name: our JSON, a report.json, a COLMAP folder, transforms.json,
    /// cameras.json.
    #[staticmethod]
    #[pyo3(signature = (path, name=None, size=None))]
    fn load(path: PathBuf, name: Option<&str>, size: Option<(usize, usize)>) -> PyResult<Camera> {
        let poses = raise(cameras::load(&path, size.map(|(w, h)| [w, h])))?;
        let chosen = cameras::choose(poses, name)
            .map_err(|problem| anyhow::anyhow!("camera file '{}' {problem}", path.display()));
        Ok(Camera(raise(chosen)?.camera))
    }

    /// All cameras of such a file, as pairs of name and camera in its order.
    #[staticmethod]
    #[pyo3(signature = (path, size=None))]
    fn load_all(path: PathBuf, size: Option<(usize, usize)>) -> PyResult<Vec<(String, Camera)>> {
        let poses = raise(cameras::load(&path, size.map(|(w, h)| [w, h])))?;
        let poses = poses.into_iter();
        Ok(poses.map(|pose| (pose.name, Camera(pose.camera))).collect())
    }

    /// From the text of a camera file.
    #[staticmethod]
    fn from_json(text: &str) -> PyResult<Camera> {
        raise(camera::Camera::from_json_str(text)).map(Camera)
    }

    /// The text of a camera file; reading it back gives the same bits.
    fn to_json(&self) -> String {
        self.0.to_json()
    }

    /// The same view in a picture of another size.
    fn resized(&self, width: usize, height: usize) -> PyResult<Camera> {
        raise(self.0.resized(width, height)).map(Camera)
    }

    /// The same view with focal lengths times `factor`.
    fn zoomed(&self, factor: f64) -> PyResult<Camera> {
        raise(self.0.zoomed(factor)).map(Camera)
    }

    /// Columns and rows of the picture.
    #[getter]
    fn size(&self) -> (usize, usize) {
        (self.0.width, self.0.height)
    }

    /// Focal lengths fx, fy in pixels.
    #[getter]
    fn focal(&self) -> (f64, f64) {
        (self.0.fx, self.0.fy)
    }

    /// Principal point cx, cy in pixels.
    #[getter]
    fn principal_point(&self) -> (f64, f64) {
        (self.0.cx, self.0.cy)
    }

    /// Its place in the world, float64 of shape (3,).
    #[getter]
    fn eye<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.0.eye())
    }

    /// World-to-camera matrix [R | t], float64 of shape (3, 4).
    #[getter]
    fn world_to_camera<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let rows = |i: usize| {
            let [x, y, z] = self.0.rotation[i];
            vec![x, y, z, self.0.translation[i]]
        };
        Ok(PyArray2::from_vec2(py, &[rows(0), rows(1), rows(2)])?)
    }

    /// Its fields as a dictionary, in the form of a camera file.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let fields: serde_json::Value = raise(serde_json::from_str(&self.0.to_json()))?;
        record(py, &fields)
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, (String,))> {
        let make = slf.get_type().getattr("from_json")?;
        Ok((make, (slf.get().to_json(),)))
    }

    fn __repr__(&self) -> String {
        let ((width, height), fx, [x, y, z]) = (self.size(), self.0.fx, self.0.eye());
        format!("<Camera {width}x{height} at ({x:.3}, {y:.3}, {z:.3}), fx {fx:.1}>")
    }
}
