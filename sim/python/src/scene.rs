//! Scenes: a file's, or arrays.

use crate::convert::{raise, rows};
use anyhow::{Context, Result, bail, ensure};
use numpy::{
    Element, PyArray1, PyArray2, PyArray3, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2,
    PyReadonlyArray3, PyUntypedArrayMethods,
};
use pyo3::prelude::*;
use splatline_sim::plan::load::recognise;
use splatline_sim::plan::{AnyScene, Contents, Source};
use splatline_sim::rules::Rules;
use splatline_sim::scene::{self, Harmonics, Splat, Weight};
use std::path::PathBuf;
use std::sync::Arc;

/// Splats, or points of a surface.
///
/// Made by `splatline.load` (any format that the command line reads) or by `splatline.Scene.from_arrays`; arrays come
/// out again, as copies.
#[pyclass(frozen, skip_from_py_object, module = "splatline")]
#[derive(Clone)]
pub struct Scene {
    pub scene: Arc<AnyScene>,
    pub source: Source,
    pub seconds: f64,
    /// Can it be loaded again by its source?
    pub is_file: bool,
    notes: Vec<String>,
}

/// The numbers of an array of this shape, where they lie, all of them finite.
fn numbers<'a, T: Element + Copy + Into<f64>, D: numpy::ndarray::Dimension>(
    name: &str,
    array: &'a numpy::PyReadonlyArray<'_, T, D>,
    shape: &[usize],
) -> Result<&'a [T]> {
    ensure!(
        array.shape() == shape,
        "{name} has the shape {:?}: allowed is {shape:?}",
        array.shape()
    );
    let numbers = array
        .as_slice()
        .with_context(|| format!("{name}: not in rows"))?;
    let finite = |number: &T| (*number).into().is_finite();
    match numbers.iter().position(|number| !finite(number)) {
        None => Ok(numbers),
        Some(place) => {
            let each = shape[1..].iter().product::<usize>().max(1);
            bail!("{name}[{}] holds a number that is not finite", place / each)
        }
    }
}

/// The splats of arrays, one line of each for a splat. The only copy: a splat's numbers lie together, an array's apart.
fn splats_of(
    centres: &PyReadonlyArray2<f64>,
    axes: &PyReadonlyArray3<f64>,
    weights: &PyReadonlyArray1<f64>,
    colours: &PyReadonlyArray2<f64>,
) -> Result<Vec<Splat>> {
    let count = centres.shape()[0];
    let centres = numbers("centres", centres, &[count, 3])?;
    let axes = numbers("axes", axes, &[count, 3, 3])?;
    let weights = numbers("weights", weights, &[count])?;
    let colours = numbers("colours", colours, &[count, 3])?;
    let [centres, colours] = [centres, colours].map(|array| array.as_chunks::<3>().0);
    let axes = axes.as_chunks::<3>().0.as_chunks::<3>().0;
    let splat = |index: usize| Splat {
        centre: centres[index],
        axes: axes[index],
        weight: weights[index],
        colour: colours[index].map(|value| value.max(0.0)),
    };
    Ok((0..count).map(splat).collect())
}

/// Coefficients of view-dependent colour; the colours that came with them are its constant part.
fn harmonics(
    colours: &PyReadonlyArray2<f64>,
    found: Option<PyReadonlyArray3<f32>>,
) -> Result<Option<Harmonics>> {
    let Some(found) = found else {
        return Ok(None);
    };
    let &[_, each, _] = found.shape() else {
        bail!("harmonics must have three dimensions");
    };
    let degree = (1..=4u8).find(|degree| usize::from(*degree + 1).pow(2) - 1 == each);
    let degree = degree.with_context(|| {
        format!("harmonics has {each} coefficients per splat: allowed are 3, 8, 15 and 24, without the constant one")
    })?;
    let count = colours.shape()[0];
    let coefficients = numbers("harmonics", &found, &[count, each, 3])?;
    let colours = colours.as_array();
    let base = colours.rows().into_iter();
    let base = base.map(|row| [0, 1, 2].map(|channel| row[channel] as f32));
    Ok(Some(Harmonics {
        degree,
        coefficients: coefficients.as_chunks::<3>().0.to_vec(),
        base: base.collect(),
    }))
}

impl Scene {
    /// The scene of a plan that was read from a file or from options.
    pub fn of_plan(prepared: &splatline_sim::plan::Prepared) -> Scene {
        Scene {
            scene: Arc::clone(&prepared.scene),
            source: prepared.plan.source.clone(),
            seconds: prepared.prepare_s,
            is_file: true,
            notes: Vec::new(),
        }
    }

    fn splats(&self) -> Result<&scene::Scene> {
        match &*self.scene {
            AnyScene::Splats(scene) => Ok(scene),
            AnyScene::Surface { scene, .. } => {
                bail!(
                    "{}: holds points of a surface and no splats: there are centres, colours, normals and frames",
                    scene.name
                )
            }
        }
    }

    /// Three numbers of each splat or point.
    fn triples<'py>(
        &self,
        py: Python<'py>,
        of_splat: impl Fn(&Splat) -> [f64; 3],
        of_point: impl Fn(&scene::points::SurfacePoint) -> [f64; 3],
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let values: Vec<[f64; 3]> = match &*self.scene {
            AnyScene::Splats(scene) => scene.splats.iter().map(of_splat).collect(),
            AnyScene::Surface { scene, .. } => scene.points.iter().map(of_point).collect(),
        };
        rows(py, values)
    }
}

#[pymethods]
impl Scene {
    /// Any file that the command line reads, or one of its scenes by name (demo, random:COUNT[:SEED], deep-stack).
    ///
    /// `contents` says what is in the file where that is not what it looks like: the `contents` of a plan file's
    /// source.
    #[staticmethod]
    #[pyo3(signature = (path, transfer=None, contents=None))]
    fn load(
        py: Python<'_>,
        path: PathBuf,
        transfer: Option<PathBuf>,
        contents: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Scene> {
        let contents: Option<Contents> = contents.map(crate::convert::read).transpose()?;
        let load = || -> Result<_> {
            let Some(contents) = contents else {
                let loaded = recognise(&path, transfer.clone())?;
                let contents = match &loaded.scene {
                    AnyScene::Splats(_) => Contents::splats(transfer),
                    AnyScene::Surface { .. } => Contents::surface(),
                };
                return Ok((Source { path, contents }, loaded));
            };
            let source = Source { path, contents };
            let loaded = source.load(&|_| ())?;
            Ok((source, loaded))
        };
        let (source, loaded) = raise(py.detach(load))?;
        Ok(Scene {
            scene: Arc::new(loaded.scene),
            source,
            seconds: loaded.seconds,
            is_file: true,
            notes: loaded.notes,
        })
    }

    /// Splats from arrays: see `splatline.Scene.from_arrays`, which takes scales and rotations as well.
    #[staticmethod]
    #[pyo3(
        signature = (centres, axes, weights, colours, harmonics=None, weight="opacity", up=[0.0, -1.0, 0.0], name="arrays"),
        text_signature = "(centres, axes, weights, colours, harmonics=None, weight='opacity', up=(0.0, -1.0, 0.0), name='arrays')"
    )]
    #[expect(clippy::too_many_arguments, reason = "keyword arguments of Python")]
    fn from_axes<'py>(
        centres: PyReadonlyArray2<'py, f64>,
        axes: PyReadonlyArray3<'py, f64>,
        weights: PyReadonlyArray1<'py, f64>,
        colours: PyReadonlyArray2<'py, f64>,
        harmonics: Option<PyReadonlyArray3<'py, f32>>,
        weight: &str,
        up: [f64; 3],
        name: &str,
    ) -> PyResult<Scene> {
        let natural_rules = match weight {
            "opacity" => Rules::GAUSSIAN_3D,
            "mass" => Rules::EWA,
            other => {
                let message = format!("weight = '{other}': allowed are opacity and mass");
                return raise(Err(anyhow::Error::msg(message)));
            }
        };
        let splats = raise(splats_of(&centres, &axes, &weights, &colours))?;
        let scene = scene::Scene {
            harmonics: raise(self::harmonics(&colours, harmonics))?,
            up,
            ..scene::Scene::of_splats(name, natural_rules, splats)
        };
        Ok(Scene {
            scene: Arc::new(AnyScene::Splats(scene)),
            source: Source::splats(PathBuf::from(name)),
            seconds: 0.0,
            is_file: false,
            notes: Vec::new(),
        })
    }

    fn __len__(&self) -> usize {
        self.scene.len()
    }

    /// File name without folders.
    #[getter]
    fn name(&self) -> &str {
        self.scene.name()
    }

    /// `splats` or `surface`.
    #[getter]
    fn kind(&self) -> &'static str {
        match &*self.scene {
            AnyScene::Splats(_) => "splats",
            AnyScene::Surface { .. } => "surface",
        }
    }

    /// What its file says that is drawn otherwise here, or what had to be made up.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.notes.clone()
    }

    /// Where it was loaded from.
    #[getter]
    fn path(&self) -> Option<PathBuf> {
        self.is_file.then(|| self.source.path.clone())
    }

    /// What its file's contents are, as a plan file says it.
    #[getter]
    fn contents<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        crate::convert::record(py, &self.source.contents)
    }

    /// Name of the rules of blending that this kind of scene is meant for.
    #[getter]
    fn natural_rules(&self) -> Option<&'static str> {
        self.splats().ok().map(|scene| scene.natural_rules.name)
    }

    /// The settings by which a surface is drawn unless others are given.
    fn usual_style<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let AnyScene::Surface { scene, .. } = &*self.scene else {
            let message = format!("{}: holds splats, which have no style", self.name());
            return raise(Err(anyhow::Error::msg(message)));
        };
        let style = splatline_sim::surface::Style::opaque(scene.usual_threshold());
        crate::convert::record(py, &style)
    }

    /// What `weights` are: `opacity` (peak, 0 to 1) or `mass` (extinction times volume, square scene units).
    #[getter]
    fn weight(&self) -> PyResult<&'static str> {
        Ok(match raise(self.splats())?.weight {
            Weight::Opacity => "opacity",
            Weight::Mass => "mass",
        })
    }

    /// Direction that is up.
    #[getter]
    fn up(&self) -> [f64; 3] {
        self.scene.up()
    }

    /// Centres in scene units, float64 of shape (n, 3).
    #[getter]
    fn centres<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.triples(py, |splat| splat.centre, |point| point.centre)
    }

    /// Linear RGB, float64 of shape (n, 3); of splats with harmonics their constant part, clamped at 0 from below.
    #[getter]
    fn colours<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.triples(py, |splat| splat.colour, |point| point.colour)
    }

    /// Three axes, each one standard deviation long, scene units; float64 of shape (n, 3, 3), an axis a row.
    #[getter]
    fn axes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let splats = &raise(self.splats())?.splats;
        let values: Vec<[[f64; 3]; 3]> = splats.iter().map(|splat| splat.axes).collect();
        let count = values.len();
        PyArray1::from_vec(py, values.into_flattened().into_flattened()).reshape([count, 3, 3])
    }

    /// Peak opacity or mass, float64 of shape (n,).
    #[getter]
    fn weights<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let splats = &raise(self.splats())?.splats;
        let weights = splats.iter().map(|splat| splat.weight);
        Ok(PyArray1::from_iter(py, weights))
    }

    /// View-dependent colour: its constant part before clamping, float32 of shape (n, 3), and the coefficients of
    /// degree 1 and up in the trainers' order, float32 of shape (n, k, 3); none if colours do not depend on the view.
    #[getter]
    fn harmonics<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<Option<(Bound<'py, PyArray2<f32>>, Bound<'py, PyArray3<f32>>)>> {
        let Some(harmonics) = &raise(self.splats())?.harmonics else {
            return Ok(None);
        };
        let count = harmonics.base.len();
        let each = harmonics.coefficients.len() / count.max(1);
        let array = |values: &[[f32; 3]]| PyArray1::from_slice(py, values.as_flattened());
        Ok(Some((
            array(&harmonics.base).reshape([count, 3])?,
            array(&harmonics.coefficients).reshape([count, each, 3])?,
        )))
    }

    /// Normals of a surface's points, float64 of shape (n, 3).
    #[getter]
    fn normals<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        match &*self.scene {
            AnyScene::Surface { .. } => self.triples(py, |_| [0.0; 3], |point| point.normal),
            AnyScene::Splats(scene) => {
                let name = &scene.name;
                raise(Err(anyhow::anyhow!("{name}: splats have no normals")))
            }
        }
    }

    fn __repr__(&self) -> String {
        let what = match &*self.scene {
            AnyScene::Splats(_) => "splats",
            AnyScene::Surface { .. } => "points of a surface",
        };
        format!("<Scene {}: {} {what}>", self.name(), self.scene.len())
    }
}
